"""The command `zspring static`."""

from __future__ import annotations

import click

from ..bench.loops import SET_HERE
from ..options import format_option, numbers, output_option, pantograph_options
from ..records import claimed


@click.command()
@numbers("--amplitudes", "0.05,0.1,0.2,0.5,0.7,1,1.5,2,3,5,10,20", "Peaks of the head's motion in mm.")
@numbers("--rates", "0.01,0.1,1", "Speeds of the head in mm/s.")
@pantograph_options
@output_option("results/static")
@format_option
def static(pantograph, amplitudes, rates, output, suffix) -> None:
    """Load and unload the head suspension slowly: hysteresis and equivalent stiffness.

    The upper frame is clamped (k2 and k3 made very stiff), for a free one follows a slowly moved head without
    loading the suspension. The head goes to and fro at constant speed; force, without the head's inertia, is
    read against the compression frame minus head. Both friction laws.

    Small loops find the stiffness with locked rods, large ones come close to that with free rods. The
    regularised law creeps, so that its stiffness depends on the loading rate; Coulomb's does not. The internal step
    is a 400th of a loop, at most 20 ms: nothing in a slow test is faster.

    Writes stiffness.csv, loops.csv and static.png. After Ctrl-C the loops so far are kept.
    """
    with pantograph.opened(SET_HERE) as (fmu, parameters), claimed(output):
        from .run import run_static

        lengths, speeds = [1e-3 * a for a in amplitudes], [1e-3 * rate for rate in rates]
        run_static(fmu, parameters, lengths, speeds, output, suffix, pantograph.named)
