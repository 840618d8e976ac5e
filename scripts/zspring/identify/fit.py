"""Least squares with bounds, and what the Jacobian at the solution tells about the parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from .problem import Answer, Problem

AT_BOUND = 1e-3  # of the range, tried for being held at the bound
SINGULAR = 1e-9  # relative to the largest singular value of the scaled Jacobian
NOISE_FREE = 1e-12  # half the sum of squared residuals that is as good as none
MOST_EVALUATIONS = 100
SHORT = 1.0  # standard errors: a way at whose end the Jacobian is that of its begin
FORETOLD = 0.5  # of a change of the residuals: a Jacobian that misses more is made anew


@dataclass(frozen=True)
class Fit:
    """Solution x (n,) and its statistics; arrays over the free parameters in their order."""

    x: np.ndarray
    values: np.ndarray  # parameters, in the FMU's units
    answer: Answer
    cost: float  # half the sum of squared residuals
    is_converged: bool
    message: str
    evaluations: int
    at_bound: np.ndarray  # bool: held at a bound, where the residuals push it
    standard_error: np.ndarray  # in the FMU's units; NaN at a bound, inf where the data say nothing
    unbound_error: np.ndarray  # what it would be if none were held
    correlation: np.ndarray  # (n, n), NaN where there is no standard error
    jacobian: np.ndarray  # (m, n), of the residuals with respect to x


def fit(problem: Problem, x: np.ndarray, progress: Callable[[float], None]) -> Fit:
    """Least squares from x (n,) by a trust-region method.

    The method keeps all parameters off their bounds by a little. Those that come close to one are then held
    exactly at it while the others are fitted again, and stay there if the cost does not grow.
    `progress` is told the cost of each evaluation.
    """
    result, held = _solve(problem, x, np.zeros(x.size, bool), progress), np.zeros(x.size, bool)
    near = (result.x < AT_BOUND) | (result.x > 1 - AT_BOUND)
    if near.any():
        bounded = _solve(problem, np.where(near, result.x.round(), result.x), near, progress)
        bounded.evaluations += result.evaluations
        if bounded.cost <= result.cost * (1 + 1e-6) + NOISE_FREE:
            result, held = bounded, near
    jacobian = result.jacobian
    variances = problem.variances(result.answer, int(np.sum(~held)))
    error, correlation = statistics(problem, result.x, jacobian, held, variances)
    unbound_error, _ = statistics(problem, result.x, jacobian, np.zeros_like(held), variances)
    return Fit(
        x=result.x,
        values=np.array([free.value(at) for free, at in zip(problem.settings.free.values(), result.x)]),
        answer=result.answer,
        cost=result.cost,
        is_converged=result.is_converged,
        message=result.message,
        evaluations=result.evaluations,
        at_bound=held,
        standard_error=error,
        unbound_error=unbound_error,
        correlation=correlation,
        jacobian=jacobian,
    )


def statistics(
    problem: Problem, x: np.ndarray, jacobian: np.ndarray, held: np.ndarray, variances: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Standard errors (n,) and correlations (n, n) from the Jacobian (m, n) with respect to x.

    cov = K diag(s^2) K^T with K = (J^T J)^-1 J^T, for residuals that are independent, with variances s^2 (m,) by their
    kind, see Problem.variances; for one kind s^2 (J^T J)^-1 (Bates and Watts, Nonlinear Regression Analysis, 1988,
    section 2.2). A direction in which the residuals do not change makes the standard errors of its parameters infinite.
    """
    n = x.size
    error, correlation = np.full(n, np.nan), np.full((n, n), np.nan)
    kept = np.flatnonzero(~held)
    if not kept.size:
        return error, correlation
    J = jacobian[:, kept]
    scale = np.linalg.norm(J, axis=0)
    scale[scale == 0] = 1.0
    left, singular, directions = np.linalg.svd(J / scale, full_matrices=False)
    usable = singular > SINGULAR * singular[0]
    lost = np.any(np.abs(directions[~usable]) > 0.1, axis=0) | ~np.any(J, axis=0)
    inverse = directions[usable].T / singular[usable] @ left[:, usable].T / scale[:, None]
    covariance = inverse * variances @ inverse.T
    sigma = np.sqrt(np.diag(covariance))
    slopes = np.array([free.slope(at) for free, at in zip(problem.settings.free.values(), x)])[kept]
    error[kept] = np.where(lost, np.inf, sigma * slopes)
    with np.errstate(invalid="ignore", divide="ignore"):
        matrix = covariance / np.outer(sigma, sigma)
    matrix[lost, :] = matrix[:, lost] = np.nan
    correlation[np.ix_(kept, kept)] = matrix
    return error, correlation


@dataclass
class Solution:
    """Of least squares: x (n,), the answer there, and the Jacobian (m, n) there or a standard error away."""

    x: np.ndarray
    answer: Answer
    cost: float
    jacobian: np.ndarray
    message: str = ""
    is_converged: bool = False
    evaluations: int = 1


def _solve(problem: Problem, x: np.ndarray, held: np.ndarray, progress: Callable[[float], None]) -> Solution:
    """Least squares for the parameters that are not held, from x.

    The optimiser sees answers in as many periods as the one where it began took. At its end as many as are needed
    are taken again, and it goes on from there unless the way was short.
    """

    def at(x: np.ndarray) -> tuple[Answer, float]:
        (answer,) = problem.answers([x])
        cost = problem.cost(answer)
        progress(cost)
        return answer, cost

    answer, cost = at(x)
    found = Solution(x, answer, cost, problem.jacobian(x, answer, range(x.size)))
    while True:
        x, _, message, is_converged, count = descend(problem, found, held, progress)
        found = replace(found, message=message, is_converged=is_converged, evaluations=found.evaluations + count)
        answer, cost = at(x)
        if cost >= found.cost:
            return found
        is_near = _way(problem, found, x) < SHORT
        found = replace(found, x=x, answer=answer, cost=cost)
        if is_converged and problem.is_costly and is_near:
            return found
        found.jacobian = problem.jacobian(x, answer, range(x.size))
        if not is_converged or not problem.is_costly:
            return found


def _way(problem: Problem, found: Solution, x: np.ndarray) -> float:
    """From there to x (n,), in standard errors."""
    residuals = problem.residuals(found.answer)
    variance = max(problem.variance(found.cost, residuals.size - x.size), NOISE_FREE)
    return float(np.linalg.norm(found.jacobian @ (x - found.x)) / np.sqrt(variance))


def descend(
    problem: Problem, start: Solution, held: np.ndarray, progress: Callable[[float], None]
) -> tuple[np.ndarray, float, str, bool, int]:
    """scipy's least squares: its x, the cost there, its message, whether it converged, and its evaluations.

    Where a Jacobian is costly it is made up to date from the evaluations (Broyden, A class of methods for solving
    nonlinear simultaneous equations, 1965) as long as it foretells them.
    """
    kept = np.flatnonzero(~held)
    answers = {start.x[kept].tobytes(): start.answer}
    last: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None  # point, residuals, Jacobian

    def complete(part: np.ndarray) -> np.ndarray:
        whole = start.x.copy()
        whole[kept] = part
        return whole

    def function(part: np.ndarray) -> np.ndarray:
        key = part.tobytes()
        if key not in answers:
            (answers[key],) = problem.answers([complete(part)], start.answer)
        residuals = problem.residuals(answers[key])
        progress(0.5 * float(residuals @ residuals))
        return residuals

    def jacobian(part: np.ndarray) -> np.ndarray:
        nonlocal last
        answer = answers[part.tobytes()]
        residuals, J = problem.residuals(answer), start.jacobian[:, kept]
        if last is not None:
            point, before, J = last
            step, change = (part - point) * np.any(J, axis=0), residuals - before  # columns without effect keep none
            missed = change - J @ step
            if problem.is_costly and step.any() and np.linalg.norm(missed) < FORETOLD * np.linalg.norm(change):
                J = J + np.outer(missed, step) / (step @ step)
            else:
                J = problem.jacobian(complete(part), answer, kept)
        last = part.copy(), residuals, J
        return J

    result = least_squares(
        function,
        start.x[kept],
        jac=jacobian,
        bounds=(0.0, 1.0),
        method="trf",
        x_scale="jac",
        ftol=problem.tolerance,
        xtol=problem.tolerance,
        gtol=None,
        max_nfev=MOST_EVALUATIONS,
    )
    return complete(result.x), float(result.cost), result.message, bool(result.status > 0), result.nfev
