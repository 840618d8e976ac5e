"""One FRF from settings to result folder: measure with progress bar, write CSV and figure, print table."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from pathlib import Path

from ..bench.measure import BENCHES, FAILED, FrfPoint, FrfSettings, left_out, measure, sweeps
from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu
from ..parameter_sets import ACCURATE_STEP
from ..records import Record, fill, keep_others
from ..variables import Value, text
from . import report
from .files import Kept, frf_record, remaining, write_frf
from .plot import frf_figure

Points = dict[tuple[float, float], FrfPoint]  # by amplitude in m/s2 and frequency in Hz


def run_frf(
    fmu: Fmu, settings: FrfSettings, folder: Path, quantity: str, suffix: str, jobs: int, error_estimate: bool
) -> None:
    """Measure, going on where an interrupted run in the folder stopped, then write and print all results.

    quantity        "receptance" or "stiffness"
    suffix          of the figure, "png" or "svg"
    jobs            number of sweeps at a time
    error_estimate  measure at half the internal step, too
    Raises ZSpringError when there is no point to measure or points failed, Interrupted after Ctrl-C; finished
    points are kept.
    """
    if not sweeps(settings):
        raise ZSpringError(f"nothing to measure: all points need more stroke than {settings.stroke:g} m")
    parameters = all_parameters(fmu, settings)
    head = report.frf_head(fmu, settings, parameters, quantity)
    csv_path, figure_path = folder / "frf.csv", folder / f"frf.{suffix}"
    keep_others(csv_path, head)
    record = frf_record(folder / "frf.partial.csv", head, quantity)
    points, speed = _measure(fmu, settings, record, jobs, "step")
    records, errors = [record], None
    if error_estimate:
        finer = replace(settings, parameters={**settings.parameters, "solver.step": parameters["solver.step"] / 2})
        finer_head = report.frf_head(fmu, finer, all_parameters(fmu, finer), quantity)
        records.append(frf_record(folder / "frf.half-step.partial.csv", finer_head, quantity))
        finer_points, _ = _measure(fmu, finer, records[-1], jobs, "half step")
        estimates = {key: report.richardson(point.H, finer_points[key].H) for key, point in points.items()}
        errors = {key: error for key, error in estimates.items() if math.isfinite(error)}

    results = sorted([*points.values(), *left_out(settings)], key=lambda p: (p.amplitude, p.frequency))
    write_frf(csv_path, head, results, quantity, errors)
    suspension = text(fmu.variables["suspension"], parameters["suspension"])
    bounds = report.linear_bounds(settings, parameters, linear=suspension == "Linear")
    figure = frf_figure(results, bounds, quantity, settings.stroke, report.title(fmu, settings, parameters))
    save(figure, figure_path)
    for record in records:
        record.path.unlink()

    print(*report.resonance_table(results, bounds), speed, report.solver_line(points.values()), sep="\n")
    if errors:
        print(report.error_line(errors))
    print(f"written: {csv_path} {figure_path}")
    tell(report.doubtful_lines(results), csv_path)
    failed = sum(point.status.startswith(FAILED) for point in results)
    if failed:
        raise ZSpringError(f"{failed} of {len(points)} points could not be solved; the others are written")


def all_parameters(fmu: Fmu, settings: FrfSettings) -> dict[str, Value]:
    """All parameters that the FMU runs with, calculated ones included. Raises FmuError if it refuses one."""
    with fmu.instances() as (instance,):
        BENCHES[settings.through](instance, settings.parameters).start(settings.frequencies[0], settings.amplitudes[0])
        return instance.used_parameters()


def default_folder(fmu: Fmu, settings: FrfSettings) -> Path:
    """results/frf-<friction>-<direction>, with a hash of the settings if others are not standard."""
    friction = fmu.variables["friction"]
    value = settings.parameters.get("friction", int(friction.start))
    name = f"frf-{text(friction, value).lower()}-{settings.direction}"
    others = {"friction": value, "solver.step": ACCURATE_STEP}
    standard = replace(FrfSettings(), direction=settings.direction, parameters=others)
    used = replace(settings, parameters={**others, **settings.parameters})
    if used != standard:
        name += "-" + hashlib.sha256(repr(used).encode()).hexdigest()[:8]
    return Path("results") / name


def _measure(fmu: Fmu, settings: FrfSettings, record: Record[Kept], jobs: int, label: str) -> tuple[Points, str]:
    """All points of the settings, with a labelled progress bar, and a line on the time it took."""
    planned = sweeps(settings)
    todo = remaining(record, planned)
    total, missing = (sum(len(sweep.frequencies) for sweep in some) for some in (planned, todo))
    seconds = fill(record, total, missing, "points", lambda stop: measure(fmu, settings, todo, jobs, stop), label)
    points = {(point.amplitude, point.frequency): point for point, _ in record.results}
    count = f"{missing} of {total}" if missing < total else total
    keys = [(sweep.amplitude, frequency) for sweep in planned for frequency in sweep.frequencies]
    return (
        {key: points[key] for key in keys},
        f"{count} points in {seconds:.2f} s, {missing / max(seconds, 1e-9):.0f} points/s; "
        f"{len(left_out(settings))} left out: stroke > {1e3 * settings.stroke:g} mm",
    )
