"""One FRF from settings to result folder: measure with progress bar, write CSV and figure, print table."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from ..bench.measure import FAILED, FrfSettings, sweeps
from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu
from ..parameter_sets import ACCURATE_STEP
from ..records import keep_others
from ..variables import text
from . import report
from .course import Course
from .files import write_frf, write_resonances
from .plot import frf_figure

BOTH = "up", "down"


def run_frf(
    fmu: Fmu,
    settings: FrfSettings,
    folder: Path,
    quantity: str,
    suffix: str,
    jobs: int,
    error_estimate: bool,
    find_extremes: bool,
) -> None:
    """Measure, going on where an interrupted run in the folder stopped, then write and print all results.

    quantity        "receptance" or "stiffness"
    suffix          of the figure, "png" or "svg"
    jobs            number of sweeps at a time
    error_estimate  measure at half the internal step, too
    find_extremes   measure further points around resonances and antiresonances
    Raises ZSpringError when there is no point to measure or points failed, Interrupted after Ctrl-C; finished
    points are kept.
    """
    ways = BOTH if settings.direction == "both" else (settings.direction,)
    courses = {}
    for way in ways:
        one = replace(settings, direction=way)
        if not sweeps(one):
            raise ZSpringError(f"nothing to measure: all points need more stroke than {settings.stroke:g} m")
        name = "frf" if len(ways) == 1 else f"frf-{way}"
        courses[name] = Course(fmu, one, folder, name, quantity, jobs)
        keep_others(folder / f"{name}.csv", courses[name].head)
    lines = []
    for course in courses.values():
        lines.append(course.measure())
        if find_extremes:
            lines.append(course.refine())
        if error_estimate:
            course.estimate_errors()

    (first, *_), sides = courses.values(), dict(zip(ways, courses.values()))
    linear = text(fmu.variables["suspension"], first.parameters["suspension"]) == "Linear"
    bounds = report.linear_bounds(first.parameters, linear)
    written = []
    for name, course in courses.items():
        written.append(write_frf(folder / f"{name}.csv", course.head, course.points, quantity, course.errors))
        if find_extremes:
            written.append(write_frf(folder / f"{name}-refined.csv", course.head, course.beside, quantity))
    if find_extremes:
        found = {way: course.extremes for way, course in sides.items()}
        rows = report.resonance_rows(found, bounds, (settings.frequencies[0], settings.frequencies[-1]))
        written.append(
            write_resonances(folder / "resonances.csv", {**first.head, "direction": settings.direction}, rows)
        )
        lines[:0] = report.resonance_table(rows)
    drawn = {way: (course.points, course.beside) for way, course in sides.items()}
    title = report.title(fmu, settings, first.parameters)
    written.append(folder / f"frf.{suffix}")
    save(frf_figure(drawn, bounds, quantity, settings.stroke, title), written[-1])
    for course in courses.values():
        course.forget()

    every = [point for course in courses.values() for point in (*course.points, *course.beside)]
    lines.append(report.solver_line(every))
    if len(sides) > 1:
        lines += report.difference_lines(sides["up"].points, sides["down"].points, settings.tolerance)
    lines += [report.error_line(course.errors) for course in courses.values() if course.errors]
    print(*lines, sep="\n")
    print("written:", *written)
    for name, course in courses.items():
        tell(report.doubtful_lines(course.points), folder / f"{name}.csv")
    failed = sum(point.status.startswith(FAILED) for point in every)
    if failed:
        raise ZSpringError(f"{failed} of {len(every)} points could not be solved; the others are written")


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
