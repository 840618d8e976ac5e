"""Receptance and dynamic stiffness: units, conversion, phase."""

from __future__ import annotations

import numpy as np

QUANTITIES = {"receptance": "m/N", "stiffness": "N/m"}


def as_quantity(H: complex | np.ndarray, quantity: str) -> complex | np.ndarray:
    """Receptance H in m/N, or dynamic stiffness 1/H in N/m."""
    with np.errstate(invalid="ignore"):  # of NaN, a point that was left out
        return H if quantity == "receptance" else 1 / H


def phase_degrees(value: complex | np.ndarray, quantity: str) -> float | np.ndarray:
    """Phase in degrees, cut far from where a driving point has it: -180 to 0 (receptance), 0 to 180."""
    sign = -1 if quantity == "receptance" else 1
    return sign * ((sign * np.degrees(np.angle(value)) + 90) % 360 - 90)
