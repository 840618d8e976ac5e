"""How far the parameters may be from the fit: draws from the posterior, by importance sampling.

The prior is even between the bounds, on the scale on which the optimiser sees a parameter. Draws come from Student's t
about the fit with the covariance of the Jacobian, then from what the draws so far tell, and each weighs what the
posterior has there over what all these have (Cornuet, Marin, Mira, Robert, Adaptive multiple importance sampling,
Scandinavian Journal of Statistics 39, 2012).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.stats import multivariate_t

from ..draws import quantiles
from .fit import NOISE_FREE, Fit
from .problem import Problem

ROUNDS = 3
FREEDOM = 5  # of Student's t: heavier in its tails than what it stands for
PRIOR = 1 / 12  # variance of an even distribution from 0 to 1
FEWEST = 10_000  # draws of a proposal, which cost nothing, that tell how much of it is between the bounds
LEAST = 1e-9  # of a proposal's variance, where the draws so far are one


@dataclass(frozen=True)
class Posterior:
    """Draws, equally probable, and what they are worth."""

    x: np.ndarray  # (k, n) between the bounds
    effective: float  # number of independent draws that tell as much
    drawn: int  # how many were computed for it

    def interval(self, share: float) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper ends (n,) in x between which this share of the draws is, as much beyond either."""
        low, _, high = quantiles(self.x, share)
        return low, high


def sample(problem: Problem, fit: Fit, draws: int, seed: int, costs: Callable[[np.ndarray], np.ndarray]) -> Posterior:
    """The posterior about the fit from so many draws.

    costs       of points (k, n), in the order asked for, which is the same for the same arguments
    """
    rng = np.random.default_rng(seed)
    residuals = problem.residuals(fit.answer).size
    variance = problem.variance(fit.cost, residuals - fit.x.size)
    precision = fit.jacobian.T @ fit.jacobian / variance + np.eye(fit.x.size) / PRIOR
    mean, covariance = fit.x, np.linalg.inv(precision)
    xs, cost, weights, proposals = np.empty((0, fit.x.size)), np.empty(0), np.empty(0), []
    for part in range(ROUNDS):
        count = draws // ROUNDS + (part < draws % ROUNDS)
        proposal = multivariate_t(mean, covariance * (FREEDOM - 2) / FREEDOM, df=FREEDOM, seed=rng)
        new, share = _within(proposal, count)
        proposals.append((count / share, proposal))
        xs, cost = np.vstack([xs, new]), np.append(cost, costs(new))
        mixture = sum(n * np.exp(t.logpdf(xs)) for n, t in proposals)
        logarithm = _log_likelihood(problem, cost, residuals, variance) - np.log(mixture)
        weights = np.exp(logarithm - logarithm.max())
        weights /= weights.sum()
        mean = weights @ xs
        spread = (xs - mean).T * weights @ (xs - mean)
        covariance = spread + LEAST * np.eye(fit.x.size) * max(np.trace(spread), LEAST)
    effective = 1 / np.sum(weights**2)
    kept = max(1, int(effective))
    places = (np.arange(kept) + rng.random()) / kept  # systematic resampling
    chosen = np.minimum(np.searchsorted(np.cumsum(weights), places), len(weights) - 1)
    return Posterior(xs[rng.permutation(chosen)], float(effective), draws)


def _within(proposal, count: int) -> tuple[np.ndarray, float]:
    """So many draws (count, n) between the bounds, and the share of the proposal that is there."""
    found, drawn, kept = np.empty((0, proposal.dim)), 0, 0
    while kept < count or drawn < FEWEST:
        new = proposal.rvs(max(count, FEWEST)).reshape(-1, proposal.dim)
        inside = new[np.all((new >= 0) & (new <= 1), axis=1)]
        found, drawn, kept = np.vstack([found, inside]), drawn + len(new), kept + len(inside)
    return found[:count], kept / drawn


def _log_likelihood(problem: Problem, cost: np.ndarray, residuals: int, variance: float) -> np.ndarray:
    """Of these costs (k,), but for a constant.

    Gaussian; where the variance is known by the residuals alone, it is integrated out (Box and Tiao, Bayesian Inference
    in Statistical Analysis, 1973, section 2.3).
    """
    return -cost / variance if problem.is_weighted else -residuals / 2 * np.log(np.maximum(cost, NOISE_FREE))
