"""The line that a command's options choose: a set of parameters, or a line file."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line_table import replaces
from ..options import chosen_parameters
from ..parameter_sets import LINES, chosen_set
from ..variables import Value
from .design import read_line

SUFFIX = ".toml"


@dataclass(frozen=True)
class ChosenLine:
    """The catenary with the line's table, if it has one, parameters, and its name; empty for the FMU's own line."""

    catenary: Fmu
    parameters: dict[str, Value]
    name: str = ""


def line_of(name_or_file: str | None, catenary: Fmu, but_not: Container[str] = ()) -> ChosenLine:
    """A set in this package by name, an SSV file or a line file.

    but_not     parameters that the command sets itself: passed over in a set
    Raises ZSpringError as chosen_set and read_line.
    """
    if not name_or_file:
        return ChosenLine(catenary, {})
    path = Path(name_or_file)
    if path.suffix.lower() != SUFFIX:
        return ChosenLine(catenary, chosen_set(name_or_file, catenary, LINES, but_not), path.stem)
    if not path.is_file():
        raise ZSpringError(f"{path}: no such file")
    line = read_line(path, catenary)
    own = {name: value for name, value in line.parameters.items() if name not in but_not}
    return ChosenLine(catenary.with_line(line.table), own, line.title)


def chosen_line(
    name_or_file: str | None,
    catenary: Fmu,
    assignments: Iterable[str],
    but_not: Sequence[str] = (),
    settable: Sequence[str] = ("parameter",),
) -> ChosenLine:
    """line_of, and over its parameters those of --set-line; see chosen_parameters in options.py.

    Raises ZSpringError as these do, and for an assignment of what the table of a line stands for.
    """
    line = line_of(name_or_file, catenary, but_not)
    given = chosen_parameters(line.catenary, None, assignments, but_not, LINES, settable)
    for name in filter(replaces, given if line.catenary.line else ()):
        raise ZSpringError(f"{name}: the line's table stands for it: change the line file")
    return ChosenLine(line.catenary, {**line.parameters, **given}, line.name)
