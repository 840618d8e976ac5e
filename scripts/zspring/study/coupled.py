"""What a study computes of pantographs on a line. This runs on the workers, so it needs only fmpy, numpy and scipy."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line.evaluated import of_start_up, sections, stop_behind
from ..line.journey import MASSES, START_UPS, Journey, parameter_value
from ..line.limits import near_wave_speed, of_bands, of_series, untold_middles, untold_supports
from ..line.mean_force import STANDING, mean_force, run_aimed, static_uplifts
from ..line.quantities import FIGURES, described, points_of
from ..line.result import LineResult
from ..line.run import run_line
from ..line.schemes import SCHEMES, Coupling
from ..line.statistics import statistics
from ..line.system import System, watching
from ..line_table import LineTable
from ..variables import Value
from .irregular import Irregularity, of_case

# Before the names of the line's parameters, of what a run is given, and of how a line differs from its design.
PREFIXES = LINE, COUPLE, IRREGULARITY = "catenary.", "couple.", "irregularity."
# Texts that a run can be given, by name; a case has their number, counted from 1, as an enumeration's.
CHOICES: dict[str, tuple[str, ...]] = {
    "mean_force": tuple(STANDING),
    "uplift_law": tuple(STANDING),
    "static_law": tuple(STANDING),
    "uplift_on": MASSES,
    "start_up": START_UPS,
    "coupling": SCHEMES,
}
MIDSPAN = "midspan_uplift"
SPEED = 250.0  # km/h, as of `zspring couple`
SPACING = 100.0  # m, likewise
# Columns, with their units, of what a run was evaluated with.
ALONG = ("uplift_force", "N"), ("first_span", ""), ("last_span", "")
REMARKS = "remarks"  # column of what a run's result must not be read without
_WARNING = "warning: "


@dataclass(frozen=True)
class CoupledQuantity:
    """Figures of each pantograph's contact force.

    figures         by their names, see line/quantities.py
    pantographs     at most, of a case
    spans           evaluated; None: as of `zspring couple`
    line            in place of the parameters'; None: these count
    irregularity    of the lines about it; None: there is none
    """

    figures: Sequence[str]
    pantographs: int = 1
    spans: tuple[int, int] | None = None
    line: LineTable | None = None
    irregularity: Irregularity | None = None

    def column(self, figure: str, i: int) -> str:
        """The column of a value of pantograph i, counted from 0."""
        return self._column(figure, described(figure)[1], i)

    @property
    def scalars(self) -> list[str]:
        return [self.column(figure, i) for i in range(self.pantographs) for figure in self.figures]

    @property
    def columns(self) -> list[str]:
        more = [self._column(*each, i) for i in range(self.pantographs) for each in ALONG]
        return [REMARKS, *more, *self.scalars]

    def _column(self, name: str, unit: str, i: int) -> str:
        return f"{name}{f' {i + 1}' if self.pantographs > 1 else ''} [{unit or 1}]"

    def described(self) -> dict[str, str]:
        """Settings as text, by key."""
        spans = "{}:{}".format(*self.spans) if self.spans else "those of zspring couple"
        line = {"line table": self.line.digest} if self.line else {}
        return {"evaluated spans": spans, **line, **(self.irregularity.described() if self.irregularity else {})}

    def measure(
        self, pantograph: Fmu, catenary: Fmu, parameters: Mapping[str, Value]
    ) -> tuple[dict[str, Any], list[str]]:
        """Values by column. Raises ZSpringError where the run cannot be made or evaluated."""
        with self.on_line(catenary, parameters) as (catenary, parameters):
            return self._measure(pantograph, catenary, parameters), []

    @contextmanager
    def on_line(self, catenary: Fmu, parameters: Mapping[str, Value]) -> Iterator[tuple[Fmu, Mapping[str, Value]]]:
        """The catenary with the line of a case, and the case's parameters with its tensions."""
        table, tensions = self.line, dict[str, Value]()
        if self.irregularity:
            number, by = of_case(those_of(IRREGULARITY, parameters))
            table = self.irregularity.line(number, by)
            for name, factor in self.irregularity.tensions(number, by).items():
                tensions[LINE + name] = factor * parameter_value(catenary, those_of(LINE, parameters), name)
        if table is None:
            yield catenary, parameters
            return
        other = catenary.with_line(table)
        try:
            yield other, {**parameters, **tensions}
        finally:
            shutil.rmtree(other.home, ignore_errors=True)

    def _measure(self, pantograph: Fmu, catenary: Fmu, parameters: Mapping[str, Value]) -> dict[str, Any]:
        system, aim = system_of(pantograph, catenary, parameters)
        further = [figure for figure in self.figures if figure not in FIGURES]
        points, extent = points_of(further), system.extent
        if self.spans:
            asked = extent.section(*self.spans)
            points += asked.middles
            if system.journey.stop is None:
                behind = system.journey.spacing * (len(system.pantographs) - 1)
                stop = stop_behind(asked, extent, system.journey.speed, behind)
                system = replace(system, journey=replace(system.journey, stop=stop))
        system = system.changed(watching(catenary, points), {})
        uplifts, result = self._run(system, aim)
        chosen = sections(result, extent, self.spans)
        values: dict[str, Any] = {}
        remarks = [*of_bands(further), *near_wave_speed(catenary, system.line, system.journey.speed)]
        remarks += untold_supports(catenary, extent)
        for i, section in enumerate(chosen):
            series = result.series(i)
            found = statistics(series, section, further=further)
            values |= {self.column(figure, i): found[figure] for figure in self.figures}
            remarks += [*of_start_up(result, i, section, extent), *of_series(series, section)]
            if section and MIDSPAN in self.figures:
                remarks += untold_middles(series, section)
            where = (section.first, section.last) if section else ("", "")
            values |= {self._column(*each, i): value for each, value in zip(ALONG, (uplifts[i], *where))}
        return {**values, REMARKS: "; ".join(remark.removeprefix(_WARNING) for remark in remarks)}

    def _run(self, system: System, aim: float | None) -> tuple[Sequence[float], LineResult]:
        """The uplifts, N, and the run with them."""
        if aim is not None:
            uplifts, result, _ = run_aimed(system, aim, self.spans)
            return uplifts, result
        result = run_line(system)
        given = system.journey.uplift
        return [given] * len(system.pantographs) if isinstance(given, float) else given, result


def those_of(prefix: str, parameters: Mapping[str, Value]) -> dict[str, Any]:
    """What a case says with this prefix, without it."""
    return {name.removeprefix(prefix): value for name, value in parameters.items() if name.startswith(prefix)}


def pantograph_parameters(parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Those of a case that are the pantograph's."""
    return {name: value for name, value in parameters.items() if not name.startswith(PREFIXES)}


def system_of(pantograph: Fmu, catenary: Fmu, parameters: Mapping[str, Value]) -> tuple[System, float | None]:
    """The system of a case, and the mean force, N, that its uplifts are still to be found for; None: there is none.

    parameters      of the pantograph by name, those of the line and of the run with LINE and COUPLE before it
    Raises ZSpringError where they do not fit together.
    """
    of_run = those_of(COUPLE, parameters)
    given = {name: CHOICES[name][value - 1] if name in CHOICES else value for name, value in of_run.items()}
    kmh, count = given.pop("speed", SPEED), given.pop("pantographs", 1)
    supplies = {name: given.pop(name) for name in ("mean_force", "uplift_law", "static_law") if name in given}
    if len(supplies) + ("uplift" in given) > 1:
        raise ZSpringError(f"{', '.join(supplies)}{' and uplift' if 'uplift' in given else ''}: give one of them")
    coupling = Coupling(given.pop("coupling", Coupling.scheme))
    journey = Journey(**{"speed": kmh / 3.6, "spacing": SPACING, **given})
    own = pantograph_parameters(parameters)
    system = System(catenary, pantograph, those_of(LINE, parameters), [own] * count, journey, coupling)
    for name, supply in supplies.items():
        target = mean_force(supply, kmh)
        if name == "mean_force":
            return system, target
        if name == "static_law":
            system = system.changed({}, {"static_force": target})
        else:
            system = replace(system, journey=replace(journey, uplift=static_uplifts(system, target)))
    return system, None
