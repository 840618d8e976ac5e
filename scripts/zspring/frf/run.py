"""One FRF from settings to result folder: measure with progress bar, write CSV and figure, print table."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from ..bench.compare import FrfComparison, compare_frf, write_comparison
from ..bench.curves import Source
from ..bench.points import FAILED, FrfSettings, sweeps
from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu
from ..interrupt import Interrupted, stop_on_interrupt
from ..parameter_sets import ACCURATE_STEP
from ..records import keep_others
from ..variables import text
from . import report
from .backbone_plot import backbone_figure
from .bounds import linear_bounds
from .course import Course
from .cycle_plot import cycle_figure
from .files import write_resonances
from .overlay import distance_lines
from .plot import frf_figure

BOTH = "up", "down"


@dataclass(frozen=True)
class Wanted:
    """What is wanted of a figure beside its points.

    pantograph      in words, for the title
    quantity        of QUANTITIES
    suffix          of the figure, "png" or "svg"
    jobs            number of sweeps at a time
    error_estimate  the points at half the internal step, too
    extremes        further points around resonances and antiresonances
    measured        a response to compare with
    """

    pantograph: str
    quantity: str
    suffix: str
    jobs: int
    error_estimate: bool
    extremes: bool
    measured: Source | None


def run_frf(fmu: Fmu, settings: FrfSettings, folder: Path, wanted: Wanted) -> None:
    """Measure, going on where an interrupted run in the folder stopped, then write and print all results.

    Raises ZSpringError when there is no point to measure or points failed, Interrupted after Ctrl-C; finished
    points are kept.
    """
    if not sweeps(settings):
        raise ZSpringError(f"nothing to measure: all points need more stroke than {settings.stroke:g} m")
    ways = BOTH if settings.direction == "both" else (settings.direction,)
    courses = {}
    for way in ways:
        name = "frf" if len(ways) == 1 else f"frf-{way}"
        courses[way] = Course(fmu, replace(settings, direction=way), folder, name, wanted.quantity, wanted.jobs)
        keep_others(courses[way].path, courses[way].head)
    first = courses[ways[0]]
    head, table = {**first.head, "direction": settings.direction}, folder / "resonances.csv"
    keep_others(table, head)
    comparison = _compared(fmu, settings, wanted)
    lines = []
    for course in courses.values():
        lines.append(course.measure())
        if wanted.extremes:
            lines.append(course.refine())
        if wanted.error_estimate:
            course.estimate_errors()

    linear = text(fmu.variables["suspension"], first.parameters["suspension"]) == "Linear"
    bounds = linear_bounds(first.parameters, linear)
    written = [path for course in courses.values() for path in course.write()]
    if wanted.extremes:
        found = {way: course.extremes for way, course in courses.items()}
        phases = {way: course.phases for way, course in courses.items()}
        rows = report.resonance_rows(found, phases, bounds, _band(settings), settings.unit)
        written.append(write_resonances(table, head, rows))
        lines[:0] = report.resonance_table(rows)
    if comparison and wanted.measured:
        written.append(write_comparison(folder / "measured.csv", fmu, wanted.measured, comparison.levels))
    drawn = {way: (course.points, course.beside) for way, course in courses.items()}
    title = report.title(fmu, settings, first.parameters, wanted.pantograph)
    levels = comparison.levels if comparison else ()
    written.append(folder / f"frf.{wanted.suffix}")
    save(frf_figure(drawn, levels, bounds, wanted.quantity, settings.stroke, title), written[-1])
    written.append(folder / f"cycle.{wanted.suffix}")
    save(cycle_figure({way: points for way, (points, _) in drawn.items()}, title), written[-1])
    if wanted.extremes and len(settings.amplitudes) > 1:
        written.append(folder / f"backbone.{wanted.suffix}")
        save(backbone_figure(rows, f"Resonances by level: {title}"), written[-1])
    for course in courses.values():
        course.forget()

    every = [point for course in courses.values() for point in (*course.points, *course.beside)]
    lines.append(report.solver_line(every))
    if len(ways) > 1:
        lines += report.difference_lines(courses["up"].points, courses["down"].points, settings.tolerance)
    lines += distance_lines(levels)
    lines += [report.error_line(course.errors, settings.unit) for course in courses.values() if course.errors]
    print(*lines, sep="\n")
    print("written:", *written)
    if comparison:
        tell([remark.replace('force = "contact"', "--measured-force contact") for remark in comparison.remarks], table)
    for course in courses.values():
        tell([*report.error_warnings(course.errors), *report.doubtful_lines(course.points)], course.path)
    failed = sum(point.status.startswith(FAILED) for point in every)
    if failed:
        raise ZSpringError(f"{failed} of {len(every)} points could not be solved; the others are written")


def _compared(fmu: Fmu, settings: FrfSettings, wanted: Wanted) -> FrfComparison | None:
    """The model at the points of the measured response, in its order."""
    if not wanted.measured:
        return None
    with stop_on_interrupt() as stop:
        result = compare_frf(fmu, wanted.measured, settings.parameters, _band(settings), None, wanted.jobs, stop)
    if stop.is_set():
        raise Interrupted("interrupted before the first point")
    return result


def _band(settings: FrfSettings) -> tuple[float, float]:
    return settings.frequencies[0], settings.frequencies[-1]


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
