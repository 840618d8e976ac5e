"""Inputs over time: files with columns "time [s]" and the names of the FMU's inputs, and interpolation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import finite_number, read_rows, split_label
from ..variables import Variables

TIME_UNITS = {"s": 1.0, "ms": 1e-3}


def read_inputs(path: Path, variables: Variables) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Time (n,) in s and the inputs by name, each (n,) in the FMU's unit, n >= 2.

    A column is named NAME or NAME [UNIT]; the unit may be the FMU's or one of its display units. Lines that
    begin with # are comments. Raises ZSpringError, with line and column, for an unknown column or unit, a
    gap, a value that is no finite number, and time that does not increase.
    """
    labels, rows = read_rows(path)
    if len(rows) < 2:
        raise ZSpringError(f"{path}: needs a line of column names and at least two rows")
    columns = [_column(path, label, variables) for label in labels]
    names = [name for name, _, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise ZSpringError(f"{path}: two columns {name}")
    if "time" not in names:
        raise ZSpringError(f"{path}: no column 'time [s]'")

    table = np.array([[finite_number(path, line, name, cell) for name, cell in zip(names, row)] for line, row in rows])
    values = {name: (column - offset) / factor for (name, factor, offset), column in zip(columns, table.T)}
    time = values.pop("time")
    late = np.flatnonzero(np.diff(time) <= 0)
    if late.size:
        number, (before, after) = rows[late[0] + 1][0], time[late[0] : late[0] + 2]
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


def _column(path: Path, label: str, variables: Variables) -> tuple[str, float, float]:
    """Name, and factor and offset of the unit, of a column "NAME" or "NAME [UNIT]"."""
    name, unit = split_label(label)
    try:
        if name == "time":
            if unit not in (None, *TIME_UNITS):
                raise ZSpringError(f"time [{unit}]: the unit must be {' or '.join(TIME_UNITS)}")
            return "time", 1 / TIME_UNITS[unit or "s"], 0.0
        known = variables.names("input")
        if name not in known:
            raise ZSpringError(f"column {name!r}: must be one of time, {', '.join(known)}")
        return (name, *variables.factor_and_offset(variables[name], unit or variables[name].unit))
    except ZSpringError as error:
        raise ZSpringError(f"{path}: {error}") from None
