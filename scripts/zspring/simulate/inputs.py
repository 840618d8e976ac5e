"""Inputs over time: files with columns "time [s]" and the names of the FMU's inputs, and interpolation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import Table, canonical, read_table
from ..units import conversion
from ..variables import Variables

NEGLIGIBLE = Decimal("1e-9")  # rounding of times, over the distance of rows
MOST_DECIMALS = 16  # of that distance in s


@dataclass(frozen=True)
class Inputs:
    """Rows of inputs from their first one on.

    start       s, what the file has as time of the first row
    rounding    s, of times that are even to within what a double can hold at that size: they are taken as even; else 0
    """

    time: np.ndarray  # (n,) s since the first row
    values: Mapping[str, np.ndarray]  # (n,) by the FMU's name and in its unit
    start: Decimal
    rounding: float

    def since_start(self, time: float) -> float:
        """A time as the file counts it, in s since the first row."""
        return float(Decimal(repr(time)) - self.start)


def read_inputs(path: Path, variables: Variables) -> Inputs:
    """The inputs of a file, at least two rows.

    A column is named NAME or NAME [UNIT]; without a unit it is in s or in the FMU's. Raises ZSpringError, with line
    and column, for an unknown column or unit, a gap, a value that is no finite number, and time that does not
    increase.
    """
    table = read_table(path)
    if len(table.lines) < 2:
        raise ZSpringError(f"{path}: needs a line of column names and at least two rows")
    known = {canonical(name): name for name in variables.names("input")}
    values = {}
    for column, content in table.columns.items():
        if column != "time" and column not in known:
            raise ZSpringError(f"{path}: column {content.label!r}: must be one of time, {', '.join(known.values())}")
        name = known.get(column, column)
        unit = "s" if column == "time" else variables[name].unit
        values[name] = table.numbers(column, *([unit] if content.unit is not None else []))
    if "time" not in values:
        raise ZSpringError(f"{path}: no column 'time [s]'")
    times, rounding = _evened(_exact_times(table), np.spacing(np.abs(values.pop("time")).max()))
    return Inputs(np.array([float(time - times[0]) for time in times]), values, times[0], float(rounding))


def _exact_times(table: Table) -> list[Decimal]:
    """Times in s as they are written: seconds since 1970 as doubles would be known to 0.2 us only."""
    column = table["time"]
    factor = Decimal(repr(conversion(column.unit, "s")[1])) if column.unit else Decimal(1)
    times = [factor * Decimal(cell.replace(",", ".")) for cell in column.cells]
    for line, cells, before, after in zip(table.lines[1:], zip(column.cells, column.cells[1:]), times, times[1:]):
        if after <= before:
            raise ZSpringError(f"{table.path}, line {line}: time = {cells[1]} after {cells[0]}: must increase")
    return times


def _evened(times: Sequence[Decimal], rounding: float) -> tuple[Sequence[Decimal], float]:
    """Even times by the roundest step, and their rounding in s, where that alone makes them uneven and it matters.

    Else the same times and 0.
    """
    first, steps = times[0], len(times) - 1
    mean = (times[-1] - first) / steps
    if rounding <= NEGLIGIBLE * mean or all(time == first + i * mean for i, time in enumerate(times)):
        return times, 0.0
    for decimals in range(MOST_DECIMALS):
        step = round(mean, decimals)
        even = [first + i * step for i in range(steps + 1)]
        if step and max(abs(a - b) for a, b in zip(times, even)) <= rounding:
            return even, rounding
    return times, 0.0


def interpolate(time: np.ndarray, values: np.ndarray, points: np.ndarray, kind: str) -> np.ndarray:
    """Values (n,) of an input at the communication points (n,) in s.

    time, values    (m,) the rows of the input
    kind            "linear", or "cubic": a spline, so velocity and acceleration of positions do not jump
    """
    if kind == "linear":
        return np.interp(points, time, values)
    from scipy.interpolate import CubicSpline  # slow to load

    return CubicSpline(time, values)(points)
