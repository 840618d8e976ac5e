"""A fit takes off what the errors of neighbouring points have in common; the truth is generalised least squares."""

from __future__ import annotations

import numpy as np
import pytest

from zspring.bench.curves import REACH, Curve
from zspring.identify.fit import fit
from zspring.identify.problem import Answer, Problem
from zspring.identify.settings import Free, Settings

SCATTER = 2e-4  # relative: the model's own
random = np.random.default_rng(13)
FREQUENCY = np.linspace(2.0, 9.0, 12)
LEVELS = (0.5, 1.0, 4.0)  # m/s2
H = (1e-4 - 2e-4j) * np.ones(12)
OWN = 0.002 * random.uniform(0.5, 2, (36, 2))
COMMON = 0.006 * random.uniform(0.5, 2, 36)
BASIS = random.standard_normal((36, 2)) + 1j * random.standard_normal((36, 2))


def covariance() -> np.ndarray:
    """Of the errors of magnitude, then phase, of all points (72, 72), written down number by number."""
    where = [(f, a) for a in LEVELS for f in FREQUENCY]
    C = np.zeros((72, 72))
    for part in range(2):
        for i, (f, a) in enumerate(where):
            for j, (g, b) in enumerate(where):
                apart = ((np.log(f / g) / REACH[0]) ** 2 + (np.log(a / b) / REACH[1]) ** 2) ** 0.5
                C[36 * part + i, 36 * part + j] = COMMON[i] * COMMON[j] * np.exp(-apart)
            C[36 * part + i, 36 * part + i] += OWN[i, part] ** 2 + SCATTER**2
    return C


class Linear:
    """log(H / measured) = BASIS @ (m1, m2)."""

    relative_step, tolerance, is_costly = 1e-6, 1e-14, False

    def answers(self, candidates, like=None):
        off = [BASIS @ [p["m1"], p["m2"]] for p in candidates]
        return [Answer(list((H[0] * np.exp(each)).reshape(3, 12)), None) for each in off]


def problem_of(off: np.ndarray, common: np.ndarray | None) -> Problem:
    """Measured points (36,) that are off by so much in their logarithm."""
    error = np.hypot(OWN, COMMON[:, None])
    curves = [
        Curve(
            f"{a} m/s2",
            FREQUENCY,
            np.full(12, a),
            H * np.exp(off[part]),
            error[part],
            None if common is None else common[part],
        )
        for a, part in zip(LEVELS, np.split(np.arange(36), 3))
    ]
    free = {name: Free(start=0.01, min=-1, max=1) for name in ("m1", "m2")}
    settings = Settings.model_construct(model="zspring", free=free, weights="errors")
    return Problem(settings, Linear(), curves)


def drawn(seed: int) -> np.ndarray:
    """Errors (36,) with that covariance."""
    parts = np.linalg.cholesky(covariance()) @ np.random.default_rng(seed).standard_normal(72)
    return parts[:36] + 1j * parts[36:]


def test_a_fit_is_that_of_generalised_least_squares():
    """Solution, covariance and cost of a linear problem by the textbook's formulas, without any factor of C."""
    off, inverse = drawn(1), np.linalg.inv(covariance())
    J, y = np.vstack([BASIS.real, BASIS.imag]), np.concatenate([off.real, off.imag])
    cov = np.linalg.inv(J.T @ inverse @ J)
    wanted = cov @ J.T @ inverse @ y
    problem = problem_of(off, COMMON)
    found = fit(problem, problem.start, lambda cost: None)
    np.testing.assert_allclose(found.values, wanted, rtol=1e-6)
    np.testing.assert_allclose(found.standard_error, np.sqrt(np.diag(cov)), rtol=1e-5)
    assert found.correlation[0, 1] == pytest.approx(cov[0, 1] / np.sqrt(cov[0, 0] * cov[1, 1]), rel=1e-4)
    rest = y - J @ wanted
    assert 2 * found.cost == pytest.approx(rest @ inverse @ rest, rel=1e-6)


def test_nothing_in_common_is_what_files_without_it_have():
    off = drawn(2)
    answer = problem_of(off, None).answers([np.array([0.5, 0.5])])[0]
    one, other = (problem_of(off, common).residuals(answer) for common in (None, np.zeros(36)))
    np.testing.assert_array_equal(one, other)
