"""Where least squares begin: the best of a Sobol sequence."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.stats import qmc

from .settings import Search

APART = 0.1  # of the range of any parameter: starts of which neither leads where the other does


def search(start: np.ndarray, settings: Search, costs: Callable[[np.ndarray], np.ndarray]) -> list[np.ndarray]:
    """The best x (n,), the first one before the second, apart from one another and from `start`.

    The sequence fills the space between the bounds evenly (Sobol 1967, scrambled by the seed).
    costs       of points (k, n)
    """
    count = settings.candidates(start.size)
    xs = qmc.Sobol(start.size, rng=settings.seed).random_base2(count.bit_length() - 1)
    starts: list[np.ndarray] = []
    for x in xs[np.argsort(costs(xs), kind="stable")]:
        is_apart = all(np.max(np.abs(x - other)) > APART for other in (start, *starts))
        if is_apart and len(starts) < settings.starts:
            starts.append(x)
    return starts
