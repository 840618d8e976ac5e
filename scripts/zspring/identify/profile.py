"""Intervals by profile likelihood: how far one parameter may go before the others can no longer make up for it.

Bates and Watts, Nonlinear Regression Analysis, 1988, section 6.1: at the end of the interval the least cost that the
others leave has grown by half the quantile of chi-squared, in units of the variance.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.stats import norm

from .fit import Fit, Solution, descend
from .problem import Problem

FLAT = 0.3  # of the growth that a parabola has: the data hardly hold the parameter


def profile_interval(
    problem: Problem, fit: Fit, i: int, share: float, progress: Callable[[float], None]
) -> tuple[float, float]:
    """Ends in x of the interval of parameter i with this share, no farther than its bounds.

    One secant step from where the Jacobian has the end. Raises nothing: where the cost hardly grows it is a bound.
    """
    quantile = float(norm.ppf((1 + share) / 2))
    variance = problem.variance(fit.cost, problem.residuals(fit.answer).size - fit.x.size)
    held = fit.at_bound.copy()
    held[i] = False
    covariance = np.zeros((fit.x.size, fit.x.size))
    J = fit.jacobian[:, ~held]
    covariance[np.ix_(~held, ~held)] = variance * np.linalg.pinv(J.T @ J)
    error, ends = np.sqrt(covariance[i, i]), []
    held[i] = True
    for bound, sign in ((0.0, -1), (1.0, 1)):
        at = float(np.clip(fit.x[i] + sign * quantile * error, 0.0, 1.0))
        if at == fit.x[i]:
            ends.append(bound)
            continue
        x = np.clip(fit.x + covariance[:, i] / covariance[i, i] * (at - fit.x[i]), 0.0, 1.0)
        x[i] = at
        growth = 2 * max(_least(problem, fit, x, held, progress) - fit.cost, 0.0) / variance
        reached = np.sqrt(growth) / quantile  # 1 at the end of the interval
        way = (at - fit.x[i]) / max(reached, FLAT)
        ends.append(float(np.clip(fit.x[i] + way, 0.0, 1.0)) if reached > FLAT else bound)
    return ends[0], ends[1]


def _least(problem: Problem, fit: Fit, x: np.ndarray, held: np.ndarray, progress: Callable[[float], None]) -> float:
    """Least cost with some parameters held as in x (n,)."""
    (answer,) = problem.answers([x], fit.answer)
    cost = problem.cost(answer)
    if held.all():
        return cost
    _, least, *_ = descend(problem, Solution(x, answer, cost, fit.jacobian), held, progress)
    return min(cost, least)
