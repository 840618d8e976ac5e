"""The irregularity of contact wires as a study's file gives it: a power law, a spectrum, or what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from ..errors import ZSpringError
from ..line_table import PROFILE
from ..tables import read_table
from .irregular import Roughness

POINTS = 200  # of a power law, evenly on the logarithmic scale: straight between them to 0.1 % of the variance


def roughness_of(table: Any) -> tuple[Roughness | None, float | None]:
    """With a standard deviation of 1 m, and the one, m, that its source has; None where it has none.

    table   [irregularity]
    """
    if table.spectrum:
        return _scaled(*_spectrum(table.spectrum))
    if table.profile:
        return _profile(table.profile)
    if table.wavelengths:
        shortest, longest = table.wavelengths
        wavenumber = np.geomspace(1 / longest, 1 / shortest, POINTS)
        rough, _ = _scaled(wavenumber, wavenumber**-table.exponent)
        return rough, None
    return None, None


def _scaled(wavenumber: np.ndarray, spectrum: np.ndarray) -> tuple[Roughness, float]:
    deviation = float(np.trapezoid(spectrum, wavenumber)) ** 0.5
    return Roughness(wavenumber, spectrum / deviation**2), deviation


def _spectrum(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Columns wavenumber [1/m] and spectrum [m3], one-sided."""
    table = read_table(path)
    wavenumber, spectrum = table.numbers("wavenumber", "1/m"), table.numbers("spectrum", "m3")
    _check_ascending(path, table.lines, "wavenumber", wavenumber)
    if wavenumber[0] < 0 or np.any(spectrum < 0) or not np.any(spectrum > 0):
        raise ZSpringError(f"{path}: wavenumber and spectrum: must be at least 0, and not 0 all along")
    return wavenumber, spectrum


def _profile(path: Path) -> tuple[Roughness, float]:
    """Columns position and height."""
    table = read_table(path)
    position, height = table.numbers("position", "m"), table.numbers("height", "m")
    _check_ascending(path, table.lines, "position", position)
    deviation = float(np.std(height))
    if not deviation > 0:
        raise ZSpringError(f"{path}: height: is the same all along")
    profile = np.zeros(len(position), PROFILE)
    profile["x"], profile["height"] = position, height / deviation
    profile["slope"] = CubicSpline(position, height / deviation)(position, 1)
    return Roughness(profile=profile), deviation


def _check_ascending(path: Path, lines: Any, name: str, values: np.ndarray) -> None:
    if len(values) < 2:
        raise ZSpringError(f"{path}: {len(values)} rows: must be 2 at least")
    for line, step in zip(lines[1:], np.diff(values)):
        if not step > 0:
            raise ZSpringError(f"{path}, line {line}: {name}: must be above that of the row before")
