"""The command `zspring integrators`."""

from __future__ import annotations

import click

from zspring.errors import missing_extra
from zspring.options import (
    chosen_parameters,
    fmu_option,
    format_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from zspring.records import claimed

POSITIVE = click.FloatRange(min=0, min_open=True)


@click.command()
@click.option("--frequency", type=POSITIVE, default=5.0, show_default=True, help="Of the bench's sine, in Hz.")
@click.option("--acceleration", type=POSITIVE, default=1.0, show_default=True, help="Peak of the head, in m/s2.")
@click.option(
    "--periods",
    type=click.IntRange(min=1),
    default=30,
    show_default=True,
    help="Length of the run in periods, not counting the ramp.",
)
@click.option(
    "--rounds",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    help="Timed runs of each variant; the fastest counts. Runs of more than 1 s are not repeated.",
)
@click.option("--quick", is_flag=True, help="A few variants only, to try it out.")
@parameters_option
@set_option
@output_option("results/integrators")
@format_option
@fmu_option
def integrators(
    frequency, acceleration, periods, rounds, quick, parameter_set, assignments, output, suffix, fmu_path
) -> None:
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
    with opened(fmu_path) as fmu, claimed(output):
        parameters = chosen_parameters(fmu, parameter_set, assignments, but_not=SET_BY_THE_STUDY)
        run_integrators(fmu, parameters, frequency, acceleration, periods, rounds, quick, output, suffix)
