"""The command `zspring frf`."""

from __future__ import annotations

import click

from ..bench.control import CONTROLS
from ..bench.curves import SENSES, Source
from ..bench.measure import BENCH_PARAMETERS, BENCHES
from ..bench.points import FrfSettings
from ..bench.responses import QUANTITIES
from ..bench.steady import LOOK_PERIODS
from ..draws import read_draws
from ..options import (
    FILE,
    POSITIVE,
    choice,
    data_sets_option,
    draws_option,
    format_option,
    jobs_option,
    numbers,
    option,
    output_option,
    pantograph_options,
)
from ..records import claimed

STANDARD = FrfSettings()


@click.command()
@numbers(
    "--amplitudes",
    None,
    "Peak accelerations of the imposed sine in m/s2, e.g. 0.25,4.  [default: 0.25,0.5,1,2,4,8, or those of --measured]",
)
@choice(
    "--control",
    of=CONTROLS,
    default=STANDARD.control,
    help="What the bench holds at all frequencies: the peak of the imposed motion, or that of the contact force's "
    "first harmonic, for which the motion's is found by iteration.",
)
@numbers("--levels", None, "Levels of what is controlled, in m/s2, m/s, m or N, instead of --amplitudes.")
@numbers(
    "--frequencies",
    STANDARD.frequencies,
    "In Hz: numbers and ranges START:STOP:STEP, e.g. 1,2,3:13:0.1.  [default: 0.5:20:0.25]",
)
@choice(
    "--direction",
    of=["up", "down", "both", "rest"],
    help="Sweep the frequency up or down without stopping, both to compare, or begin each point in the static state.  "
    "[default: up, or as --measured says]",
)
@pantograph_options
@choice(
    "--quantity",
    of=QUANTITIES,
    default="receptance",
    help="In what to tell and draw the response: receptance H = -Z/F, mobility, accelerance, or their inverses dynamic "
    "stiffness, mechanical impedance, apparent mass.",
)
@output_option(
    described="results/frf-FRICTION-DIRECTION, and a code for the settings where they differ from the standard figure's"
)
@option(
    "--tolerance",
    default=STANDARD.tolerance,
    kind=POSITIVE,
    help="A point is settled when H differs by no more than this, relatively, from the period before, from "
    f"{LOOK_PERIODS} periods before, and from where its transient leads, told from how it decays.",
)
@option(
    "--min-periods",
    default=STANDARD.min_periods,
    kind=click.IntRange(min=1),
    help="Fewest periods of a point, not counting the ramp to it.",
)
@option(
    "--max-periods",
    default=STANDARD.max_periods,
    kind=click.IntRange(min=2 * LOOK_PERIODS),
    help="Most periods of a point; it is marked if it has not settled by then, or repeats only after several.",
)
@option(
    "--stroke",
    default=STANDARD.stroke,
    kind=POSITIVE,
    help="Largest displacement peak in m; points that need more are left out and marked.",
)
@choice(
    "--through",
    of=BENCHES,
    default=STANDARD.through,
    help="Use the FMU's own bench, or command the head step by step from outside (slower).",
)
@click.option(
    "--error-estimate",
    is_flag=True,
    help="Measure at half the internal step, too, and estimate the error of H; more than 1 % is warned of.",
)
@option(
    "--measured",
    kind=FILE,
    metavar="FILE",
    help="A measured response (CSV or universal file, see `zspring identify`) to lay over the model's and compare.",
)
@choice(
    "--measured-force",
    of=SENSES,
    default="specimen",
    help="Its force positive along the displacement, or pressing the head down.",
)
@option("--measured-amplitude", kind=POSITIVE, metavar="A", help="Its peak acceleration in m/s2, if it does not tell.")
@data_sets_option("--measured-data-sets")
@draws_option("only the points asked for are measured")
@click.option("--no-extremes", is_flag=True, help="Measure these frequencies only: no search for extremes, no table.")
@jobs_option("Sweeps at a time (amplitudes; single points from rest).")
@format_option
def frf(
    pantograph,
    quantity,
    output,
    error_estimate,
    measured,
    measured_force,
    measured_amplitude,
    measured_data_sets,
    draws_path,
    no_extremes,
    jobs,
    suffix,
    amplitudes,
    levels,
    direction,
    **settings,
) -> None:
    """Measure the first-order FRF by stepped sine with controlled response.

    Without options: the standard figure. Writes frf.csv, frf.png and cycle.png: loss per cycle, equivalent stiffness
    and damping, and harmonics 2 to 7 of the contact force.

    Resonances and antiresonances are measured between these frequencies until they are known, approached as the
    sweep does, some points at half the internal step: table resonances.csv, with the resonances by phase as well,
    figure backbone.png, further points frf-refined.csv.

    Ctrl-C keeps all finished points, and the same command goes on from there; with other settings it needs
    another folder.
    """
    if settings["max_periods"] < settings["min_periods"]:
        text = "{max_periods}: must not be below --min-periods {min_periods}".format(**settings)
        raise click.BadParameter(text, param_hint="--max-periods")
    if amplitudes and levels:
        raise click.BadParameter("must not be given with --amplitudes", param_hint="--levels")
    if settings["control"] != STANDARD.control and not levels:
        text = f"{settings['control']}: needs --levels, in {CONTROLS[settings['control']]}"
        raise click.BadParameter(text, param_hint="--control")
    amplitudes = levels or amplitudes
    if draws_path and (measured or error_estimate or settings["control"] == "force" or direction == "both"):
        text = "has no --measured, --error-estimate, --control force or --direction both"
        raise click.BadParameter(text, param_hint="--draws")
    from .bands import run_bands
    from .overlay import amplitudes_of, stated
    from .run import Wanted, default_folder, run_frf  # matplotlib is slow to load

    source = Source(measured, measured_amplitude, measured_force, data_sets=measured_data_sets) if measured else None
    with pantograph.opened(BENCH_PARAMETERS) as (fmu, parameters):
        if source:
            parameters, direction = stated(fmu, source, parameters, direction)
            amplitudes = amplitudes or amplitudes_of(source)
        settings |= {"amplitudes": amplitudes or STANDARD.amplitudes, "direction": direction or STANDARD.direction}
        frf_settings = FrfSettings(parameters=parameters, **settings)
        if draws_path:
            draws = read_draws(draws_path, fmu, BENCH_PARAMETERS, pantograph.assignments)
            folder = output or default_folder(fmu, frf_settings).with_name("bands")
            with claimed(folder):
                run_bands(fmu, frf_settings, draws, draws_path, folder, quantity, suffix, jobs, pantograph.named)
            return
        folder = output or default_folder(fmu, frf_settings)
        with claimed(folder):
            wanted = Wanted(pantograph.named, quantity, suffix, jobs, error_estimate, not no_extremes, source)
            run_frf(fmu, frf_settings, folder, wanted)
