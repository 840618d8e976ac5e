"""The command `zspring frf`."""

from __future__ import annotations

import click

from ..bench.measure import BENCH_PARAMETERS, BENCHES, LOOK_PERIODS, FrfSettings
from ..bench.responses import QUANTITIES
from ..options import (
    Numbers,
    chosen_parameters,
    fmu_option,
    format_option,
    jobs_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from ..records import claimed

STANDARD = FrfSettings()


@click.command()
@click.option(
    "--amplitudes",
    type=Numbers(),
    default=STANDARD.amplitudes,
    metavar="LIST",
    help="Peak accelerations of the imposed sine in m/s2, e.g. 0.25,4.  [default: 0.25,0.5,1,2,4,8]",
)
@click.option(
    "--frequencies",
    type=Numbers(),
    default=STANDARD.frequencies,
    metavar="LIST",
    help="In Hz: numbers and ranges START:STOP:STEP, e.g. 1,2,3:13:0.1.  [default: 0.5:20:0.25]",
)
@click.option(
    "--direction",
    type=click.Choice(["up", "down", "rest"]),
    default=STANDARD.direction,
    show_default=True,
    help="Sweep the frequency up or down without stopping, or begin each point in the static state.",
)
@parameters_option
@set_option
@click.option(
    "--quantity",
    type=click.Choice(list(QUANTITIES)),
    default="receptance",
    show_default=True,
    help="What to draw: receptance H = -Z/F or dynamic stiffness 1/H.",
)
@output_option(
    described="results/frf-FRICTION-DIRECTION, and a code for the settings where they differ from the standard figure's"
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0, min_open=True),
    default=STANDARD.tolerance,
    show_default=True,
    help="A point is settled when H differs by no more than this, relatively, from the period before "
    f"and from {LOOK_PERIODS} periods before.",
)
@click.option(
    "--min-periods",
    type=click.IntRange(min=1),
    default=STANDARD.min_periods,
    show_default=True,
    help="Fewest periods of a point, not counting the ramp to it.",
)
@click.option(
    "--max-periods",
    type=click.IntRange(min=2 * LOOK_PERIODS),
    default=STANDARD.max_periods,
    show_default=True,
    help="Most periods of a point; it is marked if it has not settled by then.",
)
@click.option(
    "--stroke",
    type=click.FloatRange(min=0, min_open=True),
    default=STANDARD.stroke,
    show_default=True,
    help="Largest displacement peak in m; points that need more are left out and marked.",
)
@click.option(
    "--through",
    type=click.Choice(list(BENCHES)),
    default=STANDARD.through,
    show_default=True,
    help="Use the FMU's own bench, or command the head step by step from outside (slower).",
)
@click.option(
    "--error-estimate",
    is_flag=True,
    help="Measure at half the internal step, too, and estimate the error of H from both.",
)
@jobs_option("Sweeps at a time (amplitudes; single points from rest).")
@format_option
@fmu_option
def frf(
    amplitudes,
    frequencies,
    direction,
    parameter_set,
    assignments,
    quantity,
    output,
    tolerance,
    min_periods,
    max_periods,
    stroke,
    through,
    error_estimate,
    jobs,
    suffix,
    fmu_path,
) -> None:
    """Measure the first-order FRF by stepped sine with controlled response.

    Without options: the standard figure. Writes frf.csv and frf.png, and prints resonances and
    antiresonances.

    Ctrl-C keeps all finished points, and the same command goes on from there; with other settings it needs
    another folder.
    """
    if max_periods < min_periods:
        raise click.BadParameter(
            f"{max_periods}: must not be below --min-periods {min_periods}", param_hint="--max-periods"
        )
    from .run import default_folder, run_frf  # matplotlib is slow to load

    with opened(fmu_path) as fmu:
        parameters = chosen_parameters(fmu, parameter_set, assignments, but_not=BENCH_PARAMETERS)
        settings = FrfSettings(
            amplitudes, frequencies, parameters, direction, through, tolerance, min_periods, max_periods, stroke
        )
        folder = output or default_folder(fmu, settings)
        with claimed(folder):
            run_frf(fmu, settings, folder, quantity, suffix, jobs, error_estimate)
