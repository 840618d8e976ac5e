"""Variances from few periods, by what those of the other points of a record tell.

A variance from some six numbers is often half or twice of what it should be; a fit that weighs by it trusts the points
that were lucky. What all points of a record have in common makes it better: empirical Bayes (Smyth, Linear models and
empirical Bayes methods for assessing differential expression in microarray experiments, Statistical Applications in
Genetics and Molecular Biology 3, 2004).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .points import Point

FEWEST_POINTS = 8  # whose scatter tells how far they are alike


def moderated(points: Sequence[Point]) -> list[Point]:
    """The points of one record, the used ones with variances and their freedom by what all of them tell.

    What a record has in common is the ratio of the scatter to what white noise would make of it: that noise is known
    point by point, from all values within the periods.
    """
    result = list(points)
    there = [i for i, point in enumerate(points) if not point.left_out and min(*point.variance, point.white) > 0]
    if len(there) < FEWEST_POINTS:
        return result
    variance, freedom = (np.array([getattr(points[i], name) for i in there]) for name in ("variance", "freedom"))
    white = np.array([points[i].white for i in there])
    parts = [shrunk(own / white, told) for own, told in zip(variance.T, freedom.T)]
    for i, noise, variances, freedoms in zip(there, white, *(np.array(each).T for each in zip(*parts))):
        result[i] = replace(points[i], variance=noise * variances, freedom=freedoms)
    return result


def shrunk(variance: np.ndarray, freedom: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Variances (n,) that `freedom` (n,) numbers each tell, moved towards each other, and how many tell them then.

    The true ones scatter as s0^2 over chi-squared / d0 with d0 degrees of freedom; both are from mean and variance of
    the logarithms (Smyth, section 6.2). Then the variance is (d0 s0^2 + d s^2) / (d0 + d), with d0 + d degrees of
    freedom, but no more than all points together have. Logarithms that scatter no more than by chance: all are one.
    """
    from scipy.optimize import brentq  # slow to load
    from scipy.special import digamma, polygamma

    logarithm = np.log(variance) - digamma(freedom / 2) + np.log(freedom / 2)
    excess = logarithm.var(ddof=1) - polygamma(1, freedom / 2).mean()
    pooled = freedom @ variance / freedom.sum()
    if excess <= polygamma(1, freedom.sum() / 2):
        return np.full_like(variance, pooled), np.full_like(variance, freedom.sum())
    half = np.exp(brentq(lambda x: float(np.log(polygamma(1, np.exp(x)) / excess)), -20, 20))
    prior, usual = 2 * half, np.exp(logarithm.mean() + digamma(half) - np.log(half))
    return (prior * usual + freedom * variance) / (prior + freedom), np.minimum(prior + freedom, freedom.sum())
