"""The command `zspring mechanism`."""

from __future__ import annotations

import click

from ..options import (
    Numbers,
    chosen_parameters,
    fmu_option,
    format_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from ..records import claimed


@click.command()
@click.option("--frequency", type=float, default=2.0, show_default=True, metavar="HZ", help="Of the imposed sine.")
@click.option(
    "--accelerations",
    type=Numbers(),
    default="0.25,4",
    show_default=True,
    metavar="LIST",
    help="Its peak accelerations in m/s2, one picture for each: a small one leaves the rods stuck.",
)
@parameters_option
@set_option
@output_option("results/mechanism")
@format_option
@fmu_option
def mechanism(frequency, accelerations, parameter_set, assignments, output, suffix, fmu_path) -> None:
    """Draw the linkage of the head suspension to scale: at rest, stuck and slipping.

    Rods L1 and L2 turn about joints on head and upper frame that are d apart; the spring lies between their
    ends. States are those of a steady cycle on the FMU's bench, drawn at rest and where the head is farthest
    below and above its static place on the frame. Lengths are to scale; a small motion is magnified as the
    picture says (all motion from the static state, angles included).

    Writes mechanism.csv, the figure, and mechanism.html, an animation that any browser opens without network.
    """
    with opened(fmu_path) as fmu, claimed(output):
        parameters = chosen_parameters(
            fmu, parameter_set, assignments, but_not=("drive", "bench.frequency", "bench.acceleration")
        )
        from .run import run_mechanism

        run_mechanism(fmu, parameters, frequency, accelerations, output, suffix)
