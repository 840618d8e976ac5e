"""What a study computes of pantographs on a line. This runs on the workers, so it needs only fmpy, numpy and scipy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line.evaluated import sections, stop_behind
from ..line.journey import MASSES, START_UPS, Journey
from ..line.limits import near_wave_speed, of_series, untold_supports
from ..line.mean_force import STANDING, mean_force, run_aimed, static_uplifts
from ..line.result import LineResult
from ..line.run import run_line
from ..line.schemes import SCHEMES, Coupling
from ..line.statistics import FIGURES, statistics
from ..line.system import System
from ..variables import Value

LINE, COUPLE = "catenary.", "couple."  # before the names of the line's parameters, and of what a run is given
# Texts that a run can be given, by name; a case has their number, counted from 1, as an enumeration's.
CHOICES: dict[str, tuple[str, ...]] = {
    "mean_force": tuple(STANDING),
    "uplift_law": tuple(STANDING),
    "uplift_on": MASSES,
    "start_up": START_UPS,
    "coupling": SCHEMES,
}
SPEED = 250.0  # km/h, as of `zspring couple`
SPACING = 100.0  # m, likewise
# Columns, with their units, of what a run was evaluated with.
ALONG = ("uplift_force", "N"), ("first_span", ""), ("last_span", "")
REMARKS = "remarks"  # column of what a run's result must not be read without
_WARNING = "warning: "


@dataclass(frozen=True)
class CoupledQuantity:
    """Figures of each pantograph's contact force.

    figures         names of FIGURES
    pantographs     at most, of a case
    spans           evaluated; None: as of `zspring couple`
    """

    figures: Sequence[str]
    pantographs: int = 1
    spans: tuple[int, int] | None = None

    def column(self, figure: str, i: int) -> str:
        """The column of a figure of pantograph i, counted from 0."""
        return self._column(figure, FIGURES[figure][1], i)

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
        return {"evaluated spans": "{}:{}".format(*self.spans) if self.spans else "those of zspring couple"}

    def measure(
        self, pantograph: Fmu, catenary: Fmu, parameters: Mapping[str, Value]
    ) -> tuple[dict[str, Any], list[str]]:
        """Values by column. Raises ZSpringError where the run cannot be made or evaluated."""
        system, aim = system_of(pantograph, catenary, parameters)
        if self.spans and system.journey.stop is None:
            system = replace(system, journey=replace(system.journey, stop=self._stop(system)))
        uplifts, result = self._run(system, aim)
        chosen = sections(result, system.extent, self.spans)
        values: dict[str, Any] = {}
        remarks = near_wave_speed(catenary, system.line, system.journey.speed)
        remarks += untold_supports(catenary, system.extent)
        for i, section in enumerate(chosen):
            series = result.series(i)
            found = statistics(series, section)
            values |= {self.column(figure, i): found[figure] for figure in self.figures}
            remarks += of_series(series, section)
            where = (section.first, section.last) if section else ("", "")
            values |= {self._column(*each, i): value for each, value in zip(ALONG, (uplifts[i], *where))}
        return {**values, REMARKS: "; ".join(remark.removeprefix(_WARNING) for remark in remarks)}, []

    def _stop(self, system: System) -> float:
        """Where the run may end, m."""
        assert self.spans
        journey, extent = system.journey, system.extent
        behind = journey.spacing * (len(system.pantographs) - 1)
        return stop_behind(extent.section(*self.spans), extent, journey.speed, behind)

    def _run(self, system: System, aim: float | None) -> tuple[Sequence[float], LineResult]:
        """The uplifts, N, and the run with them."""
        if aim is not None:
            uplifts, result, _ = run_aimed(system, aim, self.spans)
            return uplifts, result
        result = run_line(system)
        given = system.journey.uplift
        return [given] * len(system.pantographs) if isinstance(given, float) else given, result


def system_of(pantograph: Fmu, catenary: Fmu, parameters: Mapping[str, Value]) -> tuple[System, float | None]:
    """The system of a case, and the mean force, N, that its uplifts are still to be found for; None: there is none.

    parameters      of the pantograph by name, those of the line and of the run with LINE and COUPLE before it
    Raises ZSpringError where they do not fit together.
    """

    def those_of(prefix: str) -> dict[str, Any]:
        return {name.removeprefix(prefix): value for name, value in parameters.items() if name.startswith(prefix)}

    given = {name: CHOICES[name][value - 1] if name in CHOICES else value for name, value in those_of(COUPLE).items()}
    kmh, count = given.pop("speed", SPEED), given.pop("pantographs", 1)
    supplies = {name: given.pop(name) for name in ("mean_force", "uplift_law") if name in given}
    if len(supplies) + ("uplift" in given) > 1:
        raise ZSpringError(f"{', '.join(supplies)}{' and uplift' if 'uplift' in given else ''}: give one of them")
    coupling = Coupling(given.pop("coupling", Coupling.scheme))
    journey = Journey(**{"speed": kmh / 3.6, "spacing": SPACING, **given})
    own = {name: value for name, value in parameters.items() if not name.startswith((LINE, COUPLE))}
    system = System(catenary, pantograph, those_of(LINE), [own] * count, journey, coupling)
    for name, supply in supplies.items():
        target = mean_force(supply, kmh)
        if name == "mean_force":
            return system, target
        system = replace(system, journey=replace(journey, uplift=static_uplifts(system, target)))
    return system, None
