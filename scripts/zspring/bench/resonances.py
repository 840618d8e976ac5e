"""Resonances and antiresonances of a sampled receptance."""

from __future__ import annotations

import numpy as np

Extreme = tuple[float, float]  # frequency in Hz, magnitude in the unit of the FRF

LEAST_STEP = 0.03  # of log |H| between neighbouring extremes; smaller ones are ripple, not resonances


def extremes(frequency: np.ndarray, H: np.ndarray) -> tuple[list[Extreme], list[Extreme]]:
    """Resonances (maxima of |H|) and antiresonances (minima), in ascending frequency.

    frequency   (n,) in Hz, ascending; H (n,) complex, NaN where there is no point
    Located by the parabola through three neighbours of log |H|. A maximum and a minimum beside each other
    that differ by less than LEAST_STEP are both left out.
    """
    level = np.log(np.abs(H))
    maxima: list[Extreme] = []
    minima: list[Extreme] = []
    for i in turns(level):
        (maxima if level[i] > level[i - 1] else minima).append(_vertex(frequency, level, i))
    return maxima, minima


def turns(level: np.ndarray) -> list[int]:
    """Where levels (n,) of log |H| are extreme, but for those that differ from a neighbouring one by < LEAST_STEP."""
    slopes = np.sign(np.diff(level))
    found = [i for i in range(1, len(level) - 1) if slopes[i - 1] * slopes[i] < 0]
    while len(found) > 1:
        steps = np.abs(np.diff(level[found]))
        smallest = int(np.argmin(steps))
        if steps[smallest] >= LEAST_STEP:
            break
        del found[smallest : smallest + 2]
    return found


def _vertex(frequency: np.ndarray, level: np.ndarray, i: int) -> Extreme:
    """Frequency and magnitude at the vertex of the parabola through three neighbours."""
    x = frequency[i - 1 : i + 2] - frequency[i]
    curvature, slope, _ = np.polyfit(x, level[i - 1 : i + 2], 2)
    shift = -slope / (2 * curvature)
    return float(frequency[i] + shift), float(np.exp(level[i] + slope * shift / 2))
