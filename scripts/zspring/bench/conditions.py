"""Under what a frequency response was measured: static force, friction law and direction of the sweep.

The head of a measured file may say it, as those of `zspring frf` do:

    # static_force: 110 N
    # friction: Coulomb
    # direction: down
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import ZSpringError
from ..fmu import Fmu
from ..tables import canonical, read_table
from ..units import NONE, UnitError, conversion
from ..variables import Value, parse, with_unit

STATED = ("static_force", "friction")  # parameters of the FMU that tell of the bench, not of the pantograph
DIRECTIONS = ("up", "down", "rest")
FILE_ORDER = "file"  # the points were measured in the order in which they stand


@dataclass(frozen=True)
class Conditions:
    """What the heads of files say; what none of them says is missing."""

    parameters: Mapping[str, Value]
    direction: str | None
    sources: Mapping[str, Path]  # who says it
    silent: Mapping[str, list[Path]]  # who does not, where another does

    @property
    def remarks(self) -> list[str]:
        """Which files are taken to be measured as another one says."""
        return [
            f"{', '.join(path.name for path in paths)} does not say {name}: taken as {self.sources[name].name} says"
            for name, paths in self.silent.items()
            if paths
        ]

    def agreed(self, fmu: Fmu, given: Mapping[str, Value]) -> dict[str, Value]:
        """The given parameters and what the files say. Raises ZSpringError where they differ."""
        for name, value in self.parameters.items():
            if name in given and given[name] != value:
                variable = fmu.variables[name]
                raise ZSpringError(
                    f"{name}: {self.sources[name]} says {with_unit(variable, value)}, the settings "
                    f"{with_unit(variable, given[name])}: one of them is wrong"
                )
        return {**given, **self.parameters}

    def swept(self, direction: str | None) -> str:
        """The direction of the sweep, from settings or files. Raises ZSpringError where they differ."""
        if direction and self.direction and direction != self.direction:
            raise ZSpringError(
                f"direction: {self.sources['direction']} says {self.direction}, the settings {direction}: one of "
                "them is wrong"
            )
        return direction or self.direction or FILE_ORDER


def read_conditions(paths: Iterable[Path], fmu: Fmu) -> Conditions:
    """What the heads of measured files say; universal files say nothing of it.

    Raises ZSpringError for a value that is none, or two files that differ.
    """
    found: dict[str, Any] = {}
    sources: dict[str, Path] = {}
    silent: dict[str, list[Path]] = {name: [] for name in (*STATED, "direction")}
    for path in paths:
        if is_universal(path):
            for unsaid in silent.values():
                unsaid.append(path)
            continue
        head = {canonical(key): value for key, value in read_table(path).head.items()}
        for name in (*STATED, "direction"):
            text = head.get(canonical(name))
            if text is None:
                silent[name].append(path)
                continue
            value = _direction(path, text) if name == "direction" else _parameter(path, fmu, name, text)
            if found.setdefault(name, value) != value:
                raise ZSpringError(f"{path}: {name} = {text}: {sources[name]} says another; one fit takes one")
            sources.setdefault(name, path)
    direction = found.pop("direction", None)
    return Conditions(found, direction, sources, {name: unsaid for name, unsaid in silent.items() if name in sources})


def is_universal(path: Path) -> bool:
    """Whether this is a universal file, by its suffix."""
    return path.suffix.lower() in (".uff", ".unv", ".uf")


def _direction(path: Path, text: str) -> str:
    if text.lower() not in DIRECTIONS:
        raise ZSpringError(f"{path}: direction = {text!r}: must be one of {', '.join(DIRECTIONS)}")
    return text.lower()


def _parameter(path: Path, fmu: Fmu, name: str, text: str) -> Value:
    """A number with or without its unit, or the name of an enumeration's item."""
    variable = fmu.variables[name]
    number, _, unit = text.partition(" ")
    try:
        if variable.type != "Real":
            return parse(variable, text)
        value = float(parse(variable, number))
        return value if unit.strip() in NONE else value * conversion(unit.strip(), variable.unit)[1]
    except UnitError as error:
        raise ZSpringError(f"{path}: {name} = {text}: {error}") from None
    except ZSpringError as error:
        raise ZSpringError(f"{path}: {error}") from None
