"""What a bench holds over the frequencies: motion, whose amplitude follows from the level, or force, by iteration."""

from __future__ import annotations

import math
from collections.abc import Generator

from .responses import AMPLITUDES

CONTROLS = {"acceleration": "m/s2", "velocity": "m/s", "displacement": "m", "force": "N"}  # unit of a level, a peak
FORCE = CONTROLS["force"]

MOST_TRIES = 25
CLOSE = 1e-4  # of the logarithm of two accelerations: between closer ones the force jumps, if it
NOISE = 10  # changes by more than so many tolerances
LEAST_SLOPE, MOST_SLOPE = 0.4, 2.5  # of log force over log acceleration, taken for the next try
FARTHEST = math.log(2)  # by which a try may be off the one before

JUMPS, TOO_FEW, STROKE = "jumps", "tries", "stroke"  # why a force is not held


def acceleration_at(level: float, unit: str, frequency: float) -> float:
    """Peak acceleration in m/s2 of a motion with this peak in `unit`; NaN for a force, from which none follows."""
    if unit == FORCE:
        return math.nan
    omega = 2 * math.pi * frequency
    return level if unit == "m/s2" else level * omega ** (2 - AMPLITUDES[unit])


def holding(level: float, first: float, most: float, tolerance: float) -> Generator[float, float, str]:
    """Asks for one peak acceleration (m/s2) after the other, as a controller that raises it where the force is small.

    level       of the force in N, to be held within the relative `tolerance`
    first       acceleration to begin with
    most        largest one that the stroke allows
    It is to be sent the force at each; returns "" once that is held, or why it cannot be.
    """
    low, high = -math.inf, math.log(most)  # of log acceleration: with a smaller and a larger force
    y_low = y_high = math.nan
    x, slope = min(math.log(first), high), 1.0
    x_before = y_before = math.nan
    for _ in range(MOST_TRIES):
        y = math.log((yield math.exp(x)) / level)
        if abs(y) <= tolerance:
            return ""
        if y < 0:
            if x >= math.log(most):
                return STROKE
            low, y_low = x, y
        else:
            high, y_high = x, y
        if high - low < CLOSE and math.isfinite(y_high):
            return JUMPS if y_high - y_low > NOISE * tolerance else ""
        if math.isfinite(y_before) and x != x_before:
            slope = min(max((y - y_before) / (x - x_before), LEAST_SLOPE), MOST_SLOPE)
        step = min(max(-y / slope, -FARTHEST), FARTHEST)
        x_before, y_before = x, y
        x += step
        if not low < x < high:
            x = (low + high) / 2 if math.isfinite(y_low + y_high) else min(x, high)
    return TOO_FEW
