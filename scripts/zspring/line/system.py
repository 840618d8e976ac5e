"""Pantographs and the line they run along: both FMUs, their parameters, the journey and the coupling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..fmu import Fmu
from ..variables import Value
from .journey import Journey, LineExtent, parameter_value
from .schemes import Coupling


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

    def of_each(self, parameter: str) -> list[Value]:
        """A parameter of each pantograph."""
        return [parameter_value(self.pantograph, given, parameter) for given in self.pantographs]

    def changed(self, line: Mapping[str, Value], pantographs: Mapping[str, Value], **fields: Any) -> System:
        """With these parameters of the line and of all pantographs, and other fields."""
        each = [{**given, **pantographs} for given in self.pantographs]
        return replace(self, line={**self.line, **line}, pantographs=each, **fields)
