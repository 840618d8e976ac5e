"""Measured points as if their errors were independent: residuals in standard errors, without what neighbours share.

Generalised least squares (Aitken, Proceedings of the Royal Society of Edinburgh 55, 1935): with the covariance
C = L L^T of the errors, residuals L^-1 r are independent and have variance 1, so that all that holds for such ones
holds for them: sums of squares, covariance of the parameters, likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.spatial.distance import cdist

from ..bench.curves import REACH, Curve


class Whitening:
    """Of all points of curves that have standard errors."""

    def __init__(self, curves: Sequence[Curve], floor: float):
        """floor    relative standard error of each point beside what was measured: the model's own"""
        error = np.concatenate([curve.error for curve in curves if curve.error is not None])
        common = np.concatenate(
            [np.zeros(curve.frequency.size) if curve.common is None else curve.common for curve in curves]
        )
        self._error = np.hypot(error, floor)
        self._factors: list[np.ndarray] = []
        if common.any():
            shared = np.outer(common, common) * alike(curves)
            own = np.maximum(error.T**2 - common**2, 0) + floor**2
            self._factors = [cholesky(np.diag(variance) + shared, lower=True) for variance in own]

    def __call__(self, off: np.ndarray) -> np.ndarray:
        """Residuals (n, 2) of magnitude and phase, whose errors share as much, without what errors have in common."""
        if not self._factors:
            return off / self._error
        columns = [solve_triangular(factor, part, lower=True) for factor, part in zip(self._factors, off.T)]
        return np.column_stack(columns)


def alike(curves: Sequence[Curve]) -> np.ndarray:
    """Correlation (n, n) of what is common to the errors of all points."""
    places = np.log(
        np.column_stack([np.concatenate([getattr(c, k) for c in curves]) for k in ("frequency", "acceleration")])
    )
    return np.exp(-cdist(places / REACH, places / REACH))
