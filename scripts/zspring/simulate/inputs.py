"""Inputs over time: files with columns "time [s]" and the names of the FMU's inputs, and interpolation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import canonical, read_table
from ..variables import Variables


def read_inputs(path: Path, variables: Variables) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Time (n,) in s and the inputs by name, each (n,) in the FMU's unit, n >= 2.

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
    time = values.pop("time")
    late = np.flatnonzero(np.diff(time) <= 0)
    if late.size:
        number, (before, after) = table.lines[late[0] + 1], time[late[0] : late[0] + 2]
        raise ZSpringError(f"{path}, line {number}: time = {after:g} s after {before:g} s: must increase")
    return time, values


def interpolate(time: np.ndarray, values: np.ndarray, points: np.ndarray, kind: str) -> np.ndarray:
    """Values (n,) of an input at the communication points (n,) in s.

    time, values    (m,) the rows of the input
    kind            "linear", or "cubic": a spline, so velocity and acceleration of positions do not jump
    """
    if kind == "linear":
        return np.interp(points, time, values)
    from scipy.interpolate import CubicSpline  # slow to load

    return CubicSpline(time, values)(points)
