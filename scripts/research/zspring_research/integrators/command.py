"""The command `zspring integrators`."""

from __future__ import annotations

import click

from zspring.errors import missing_extra
from zspring.options import POSITIVE, format_option, option, output_option, pantograph_options
from zspring.records import claimed

COUNT = click.IntRange(min=1)


@click.command()
@option("--frequency", default=5.0, kind=POSITIVE, help="Of the bench's sine, in Hz.")
@option("--acceleration", default=1.0, kind=POSITIVE, help="Peak of the head, in m/s2.")
@option("--periods", default=30, kind=COUNT, help="Length of the run in periods, not counting the ramp.")
@option(
    "--rounds",
    default=5,
    kind=COUNT,
    help="Timed runs of each variant; the fastest counts. Runs of more than 1 s are not repeated.",
)
@click.option("--quick", is_flag=True, help="A few variants only, to try it out.")
@pantograph_options
@output_option("results/integrators")
@format_option
def integrators(pantograph, frequency, acceleration, periods, rounds, quick, output, suffix) -> None:
    """Compare the FMU's HHT method with other solvers: error against CPU time.

    The same regularised model on the bench, from rest, by HHT in the FMU, Dormand-Prince 5(4) (RK45, what
    ode45 is), RK4, LSODA, Radau and CVODE, all compiled. Then time and step ratios against the rod inertia,
    beside the paper's; the stiff peers take their Jacobians by finite differences.

    Takes about two minutes. Writes integrators.csv, precision.png and inertia.png.

    Ctrl-C keeps all finished runs, and the same command goes on from there.
    """
    try:
        from .run import SET_BY_THE_STUDY, run_integrators
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in ("numba", "CyRK"):
            raise
        raise missing_extra([package], "research") from None
    with pantograph.opened(SET_BY_THE_STUDY) as (fmu, parameters), claimed(output):
        run_integrators(fmu, parameters, frequency, acceleration, periods, rounds, quick, output, suffix)
