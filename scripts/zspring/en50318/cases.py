"""The runs of cases: of an edition of the standard, or of a user's own pair of line and pantograph."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line.journey import FittedJourney, Journey, LineExtent, parameter_value
from ..line.quantities import band_of
from ..line.series import BAND
from ..line.statistics import SHORTEST, Section
from ..line.system import most_points
from ..line_file.chosen import ChosenLine, line_of
from .edition import Case, Edition
from .plan import Parameters, Run, pantograph_of, slug

# Bands above BAND need a finer mesh and finer steps; with these they are right to FINE_UNTIL (docs/en50318.md).
FINE_ELEMENT = 0.5  # m
FINE_STEP = 5e-4  # s, of communication and catenary; of the pantograph half of it
FINE_UNTIL = 100.0  # Hz


def reference_runs(edition: Edition, catenary: Fmu, pantograph: Fmu) -> list[Run]:
    """A run for each case of an edition. Raises ZSpringError where a set or the spans do not fit."""
    runs = []
    for case in edition.cases:
        parameters = {**pantograph_of(case.pantograph, pantograph), "static_force": case.static_force}
        runs.append(case_run("reference", edition.name, case, line_of(case.line, catenary), parameters))
    return runs


def case_run(group: str, of: str, case: Case, line: ChosenLine, pantograph: Parameters) -> Run:
    """The run of a case, whose series is kept. Raises ZSpringError where spans, points or bands do not fit."""
    catenary, extent = line.catenary, LineExtent.of(line.catenary, line.parameters)
    section = section_of(case, extent)
    journey = extent.complete(Journey(case.speed / 3.6, spacing=case.spacing or 0.0), 2 if case.spacing else 1)
    if case.spacing:
        _require_room(case, section, extent, journey)
    _require_told(case, catenary, extent, journey)
    target = case.target
    run = Run(
        group,
        case.title,
        of,
        case.speed,
        section,
        line.parameters,
        pantograph,
        uplift=0.0 if target is None else target - case.static_force,
        mean_force=target,
        spacing=case.spacing or 0.0,
        table=catenary.line,
        points=case.points,
        series=f"{slug(f'{of} {case.title}')}.csv",
    )
    return _finer(run, catenary) if is_fine(case.further) else run


def is_fine(figures: Iterable[str]) -> bool:
    """Whether values ask for a finer mesh and finer steps."""
    return any(high > BAND for _, high in filter(None, map(band_of, figures)))


def section_of(case: Case, extent: LineExtent) -> Section:
    """The evaluated spans of a case. Raises ZSpringError where the line has not so many."""
    first, last = case.first_span, case.last_span
    if not 2 <= first <= last <= extent.spans - 1:
        raise ZSpringError(
            f"{case.title}: spans {first} to {last}: must be in 2 .. {extent.spans - 1}, between the first and "
            f"the last span of the line"
        )
    return extent.section(first, last)


def _finer(run: Run, catenary: Fmu) -> Run:
    """The run for bands above BAND; what is finer already stays."""

    of_line = {"mesh.element": FINE_ELEMENT, "solver.step": FINE_STEP}
    line = {name: min(value, parameter_value(catenary, run.line, name)) for name, value in of_line.items()}
    step = min(FINE_STEP / 2, float(run.pantograph["solver.step"]))
    pantograph = {**run.pantograph, "solver.step": step}
    return replace(run, step=FINE_STEP, line={**run.line, **line}, pantograph=pantograph)


def _require_room(case: Case, section: Section, extent: LineExtent, journey: FittedJourney) -> None:
    """Raises ZSpringError where not both pantographs have started up before the section, or one has not left it."""
    low, high = journey.start + extent.run_up(journey.start), journey.stop - journey.spacing
    begin, end = section.bounds
    if begin < low or end > high:
        raise ZSpringError(
            f"{case.title}: {section}: with two pantographs {journey.spacing:g} m apart must be in {low:g} .. {high:g} "
            "m, where both have started up and before the first one leaves the line: take a longer line, or other spans"
        )


def _require_told(case: Case, catenary: Fmu, extent: LineExtent, journey: FittedJourney) -> None:
    """Raises ZSpringError for a point or a band of the case that a run does not tell."""
    if len(case.points) > (most := most_points(catenary)):
        raise ZSpringError(f"{case.title}: {len(case.points)} points with uplifts: must be at most {most}")
    for point in case.points:
        if not 0 < point < extent.length:
            raise ZSpringError(f"{case.title}: uplift at {point:g} m: must be in the line of {extent.length:g} m")
    duration = (journey.stop - journey.start) / journey.speed
    for low, high in filter(None, map(band_of, case.further)):
        if high > FINE_UNTIL:
            raise ZSpringError(
                f"{case.title}: band up to {high:g} Hz: must be at most {FINE_UNTIL:g} Hz, where mesh and step end"
            )
        if duration < (least := SHORTEST / (low or high)):
            raise ZSpringError(
                f"{case.title}: band of {low:g} to {high:g} Hz: the run of {duration:.3g} s is too short for it: "
                f"at least {least:.3g} s"
            )
