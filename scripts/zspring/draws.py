"""Draws of parameters: a table of equally probable sets, as an identification leaves them."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from .errors import ZSpringError
from .fmu import Fmu
from .tables import read_table, write_table
from .variables import Value

SHARE = 0.95  # of the draws, in an interval


def write_draws(
    path: Path, fmu: Fmu, names: Sequence[str], rows: Iterable[Sequence[Value]], head: Mapping[str, str]
) -> Path:
    """One row for each draw, a column with its unit for each of these parameters."""
    columns = [f"{name} [{fmu.variables[name].unit or 1}]" for name in names]
    return write_table(path, {**fmu.identity, **head}, columns, rows, digits=None)


def head_of(path: Path) -> dict[str, str]:
    """For the head of what is made of these draws."""
    return {"draws": f"{path.name} {hashlib.sha256(path.read_bytes()).hexdigest()}"}


def read_draws(
    path: Path, fmu: Fmu, but_not: Sequence[str] = (), assignments: Sequence[str] = ()
) -> list[dict[str, Value]]:
    """Parameters of each draw, in the FMU's units.

    but_not     parameters that the command sets itself
    assignments NAME=VALUE, those of --set
    Raises ZSpringError, with file and column, for one that is no Real parameter, a unit of another kind, a cell that is
    no number, and a file without a row.
    """
    table, given = read_table(path), {assignment.partition("=")[0].strip() for assignment in assignments}
    columns: dict[str, list[float]] = {}
    for column in table.columns:
        name = table[column].name
        try:
            variable = fmu.variables.settable(name)
        except ZSpringError as error:
            raise ZSpringError(f"{path}: {error}") from None
        if variable.type != "Real" or name in but_not or name.startswith("solver."):
            raise ZSpringError(f"{path}: {name}: must be a Real parameter that the command does not set itself")
        if name in given:
            raise ZSpringError(f"{name}: is in {path.name} and in --set: give one of them")
        columns[name] = table.numbers(column, variable.unit or "1").tolist()
    if not table.lines:
        raise ZSpringError(f"{path}: has no draw")
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def doubts(count: int, width: float) -> list[str]:
    """What to say of so many draws, if they are too few for an interval, or if none has any width."""
    needed = math.ceil(2 / (1 - SHARE)) - 1
    lines = []
    if count < needed:
        text = f"{count} draws are too few for {100 * SHARE:g} %: the intervals are all that they span"
        lines.append(f"{text} ({needed} would do)")
    if width == 0 and count > 1:
        lines.append("the draws change nothing: does the pantograph have what they draw (suspension, --parameters)?")
    return lines


def quantiles(values: np.ndarray, share: float = SHARE) -> np.ndarray:
    """Lower end of the interval, median and upper end (3, ...) of values (draws, ...).

    Between its ends a further draw is with a probability of `share`; of too few draws, between the smallest and the
    largest (Hyndman, Fan, Sample quantiles in statistical packages, American Statistician 50, 1996, definition 6).
    """
    return np.quantile(values, [(1 - share) / 2, 0.5, (1 + share) / 2], axis=0, method="weibull")
