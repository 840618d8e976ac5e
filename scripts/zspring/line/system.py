"""Pantographs and the line they run along: both FMUs, their parameters, the journey and the coupling."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..fmu import Fmu
from ..variables import Value
from .journey import Journey, LineExtent, parameter_value
from .schemes import Coupling

POINT = "point.position"  # parameters of the catenary, numbered from 1


@dataclass(frozen=True)
class System:
    """What a run is made of.

    line            parameters of the catenary
    pantographs     parameters of each pantograph, the first one first
    """

    catenary: Fmu
    pantograph: Fmu
    line: Mapping[str, Value]
    pantographs: Sequence[Mapping[str, Value]]
    journey: Journey
    coupling: Coupling = field(default_factory=Coupling)

    @property
    def extent(self) -> LineExtent:
        return LineExtent.of(self.catenary, self.line)

    @property
    def watched(self) -> dict[int, float]:
        """Positions in m of the points on the contact wire that are watched, by their numbers in the FMU."""
        numbers = (int(name[len(POINT) + 1 : -1]) for name in self.line if name.startswith(f"{POINT}["))
        places = {number: float(self.line[f"{POINT}[{number}]"]) for number in sorted(numbers)}
        return {number: place for number, place in places.items() if 0 < place < self.extent.length}

    def of_each(self, parameter: str) -> list[Value]:
        """A parameter of each pantograph."""
        return [parameter_value(self.pantograph, given, parameter) for given in self.pantographs]

    def changed(self, line: Mapping[str, Value], pantographs: Mapping[str, Value], **fields: Any) -> System:
        """With these parameters of the line and of all pantographs, and other fields."""
        each = [{**given, **pantographs} for given in self.pantographs]
        return replace(self, line={**self.line, **line}, pantographs=each, **fields)


def most_points(catenary: Fmu) -> int:
    """How many points of the contact wire the FMU can watch."""
    return sum(name.startswith(f"{POINT}[") for name in catenary.variables.names("parameter"))


def watching(catenary: Fmu, points: Iterable[float]) -> dict[str, Value]:
    """Parameters with which the catenary watches points, m along the line: the first ones, as many as it can."""
    numbered = zip(range(1, most_points(catenary) + 1), dict.fromkeys(points))
    return {f"{POINT}[{number}]": place for number, place in numbered}
