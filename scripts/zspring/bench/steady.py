"""When a response is steady: H of successive periods, what is left of its transient, and after how many it repeats."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

LOOK_PERIODS = 4  # periods between two looks at the criterion
MOST_REPEAT = 4  # periods after which a steady state may repeat
ORDER, LEAST_ORDER = 6, 3  # decaying or turning parts of the transient that are told apart
WINDOW = 16  # values from which they are told
CLEAR = 10  # times what is left of the transient: a change within several periods that stays


def repeats_after(H: Sequence[complex], tolerance: float) -> tuple[int, float]:
    """The fewest periods, at most MOST_REPEAT, after which H repeats within the tolerance, and how far it is from that.

    It repeats after k periods if it differs by no more than the tolerance from that of k periods before and of 4 k
    before, and from its limit: the change alone is small where a transient decays slowly, and where a beat turns.
    Its limit must clearly not repeat after fewer: else a transient alternates that still decays.
    0 periods if it does not repeat; all distances relative, inf where there are too few periods to tell.
    """
    for k in range(1, MOST_REPEAT + 1):
        if len(H) > LOOK_PERIODS * k:
            allowed = tolerance * abs(H[-1])
            change = max(abs(H[-1] - H[-1 - lag]) for lag in (k, LOOK_PERIODS * k))
            if change <= allowed and (left := _distance(H, steady := limit(H, k))) <= tolerance:
                clear = max(allowed, CLEAR * left * abs(H[-1]))
                if all(np.abs(steady - np.roll(steady, fewer)).max() > clear for fewer in range(1, k)):
                    return k, left
    return 0, _distance(H, limit(H))


def limit(H: Sequence[complex], k: int = 1) -> np.ndarray:
    """Where the last k values (k,) of H lead if only every k-th period is seen; NaN for too few periods.

    Reduced rank extrapolation (Sidi, Vector Extrapolation Methods, 2017, chapter 2): exact where up to ORDER real
    factors (fewer for a short sequence), or half as many pairs of complex ones, tell how parts of the transient change
    from one value to the next, and an average where there is only noise.
    """
    count = min(len(H) // k, WINDOW)
    order = min(ORDER, count // 2 - 1)
    if order < LEAST_ORDER:
        return np.full(k, np.nan)
    blocks = np.array(H[len(H) - count * k :]).reshape(count, k)
    values = np.concatenate([blocks.real, blocks.imag], axis=1)
    differences = values[1:] - values[:-1]
    rows = count - 1 - order
    # The weights, of sum 1, under which the sum of ORDER + 1 successive differences is least.
    windows = np.stack([differences[i : i + rows].ravel() for i in range(order + 1)])
    weights = np.linalg.lstsq((windows[:-1] - windows[-1]).T, -windows[-1], rcond=1e-10)[0]
    return np.append(weights, 1 - weights.sum()) @ blocks[-order - 1 :]


def _distance(H: Sequence[complex], steady: np.ndarray) -> float:
    """Of the last values from their limit, relative."""
    distance = np.abs(steady - H[-len(steady) :]).max()
    return float(distance / abs(H[-1])) if H[-1] and np.isfinite(distance) else math.inf


def mean_response(H: Sequence[complex]) -> complex:
    """H of all these periods together: the motion is the same in each, so that forces, thus 1/H, are averaged."""
    return complex(H[0]) if len(H) == 1 else complex(1 / np.mean(1 / np.array(H)))
