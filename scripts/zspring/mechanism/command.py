"""The command `zspring mechanism`."""

from __future__ import annotations

import click

from ..bench.measure import BENCH_PARAMETERS
from ..options import format_option, numbers, option, output_option, pantograph_options
from ..records import claimed


@click.command()
@option("--frequency", default=2.0, metavar="HZ", help="Of the imposed sine.")
@numbers(
    "--accelerations",
    "0.25,4",
    "Its peak accelerations in m/s2, one picture for each: a small one leaves the rods stuck.",
)
@pantograph_options
@output_option("results/mechanism")
@format_option
def mechanism(pantograph, frequency, accelerations, output, suffix) -> None:
    """Draw the linkage of the head suspension to scale: at rest, stuck and slipping.

    Rods L1 and L2 turn about joints on head and upper frame that are d apart; the spring lies between their
    ends. States are those of a steady cycle on the FMU's bench, drawn at rest and where the head is farthest
    below and above its static place on the frame. Lengths are to scale; a small motion is magnified as the
    picture says (all motion from the static state, angles included).

    Writes mechanism.csv, the figure, and mechanism.html, an animation that any browser opens without network.
    """
    with pantograph.opened(BENCH_PARAMETERS) as (fmu, parameters), claimed(output):
        from .run import run_mechanism

        run_mechanism(fmu, parameters, frequency, accelerations, output, suffix)
