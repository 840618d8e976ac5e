"""Profiles and posteriors of problems whose answers have closed forms, and draws as files."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.curves import Curve
from zspring.draws import quantiles, read_draws, write_draws
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.identify.costs import Costs, cost_record
from zspring.identify.fit import fit
from zspring.identify.posterior import sample
from zspring.identify.problem import Answer, Problem
from zspring.identify.profile import profile_interval
from zspring.identify.settings import Free, Settings
from zspring.interrupt import Interrupted

FREQUENCY = np.arange(1.0, 21.0)
SIGMA = 0.01  # of magnitude (relative) and phase (rad)
MEASURED = np.full(20, 1e-4 - 2e-4j)
ERROR = np.full((20, 2), SIGMA)


class Log:
    """Answers of which log(H / measured) at each frequency is a function of the parameters m1, m2."""

    relative_step, tolerance, is_costly = 1e-6, 1e-12, False

    def __init__(self, logarithm):
        self.logarithm = logarithm

    def answers(self, candidates, like=None):
        return [Answer([MEASURED * np.exp(self.logarithm(p["m1"], p["m2"]))], None) for p in candidates]


def problem_of(logarithm, noise: int | None = None, weights: str = "errors", **bounds) -> Problem:
    """Free m1 and m2 from -1 to 1, or between other bounds; the measurement with noise of this seed."""
    free = {
        name: Free(start=0.1 if high > 0.1 else -0.1, min=low, max=high)
        for name, (low, high) in ({"m1": (-1, 1), "m2": (-1, 1)} | bounds).items()
    }
    settings = Settings.model_construct(model="zspring", free=free, weights=weights)
    parts = np.zeros((2, 20)) if noise is None else SIGMA * np.random.default_rng(noise).standard_normal((2, 20))
    curves = [Curve("1 m/s2", FREQUENCY, np.ones(20), MEASURED * np.exp(parts[0] + 1j * parts[1]), ERROR)]
    return Problem(settings, Log(logarithm), curves)


def fitted(problem: Problem):
    return fit(problem, problem.start, lambda cost: None)


def line(a: float, b: float) -> np.ndarray:
    """Linear in both: the magnitude goes with a, the phase with b and a little of a."""
    return a * (FREQUENCY / 20) + 1j * (b + 0.3 * a)


def covariance_of_line() -> np.ndarray:
    """Of a and b, from the normal equations; with the model's own scatter of 2e-4."""
    J = np.vstack([np.column_stack([FREQUENCY / 20, np.zeros(20)]), np.column_stack([np.full(20, 0.3), np.ones(20)])])
    return (SIGMA**2 + 2e-4**2) * np.linalg.inv(J.T @ J)


def test_the_posterior_of_a_linear_problem_is_its_normal_distribution():
    """Of 3000 draws the standard error of a standard deviation is 1.3 %, that of a mean 1.8 % of it."""
    problem = problem_of(line, noise=8)
    found = fitted(problem)
    posterior = sample(problem, found, 3000, 1, problem.costs)
    assert 0.6 * 3000 < posterior.effective <= 3000 and len(posterior.x) == int(posterior.effective)
    values = 2 * posterior.x - 1
    truth = covariance_of_line()
    sigma = np.sqrt(np.diag(truth))
    np.testing.assert_allclose((values.mean(axis=0) - found.values) / sigma, 0, atol=0.08)
    np.testing.assert_allclose(np.cov(values.T) / np.outer(sigma, sigma), truth / np.outer(sigma, sigma), atol=0.08)
    low, high = (2 * end - 1 for end in posterior.interval(0.95))
    np.testing.assert_allclose((high - low) / sigma, 2 * 1.96, rtol=0.06)


def test_without_known_errors_the_posterior_has_student_s_t():
    """Variance by the residuals alone: 38 degrees of freedom, intervals of 2.024 estimated standard errors."""
    problem = problem_of(line, noise=4, weights="equal")
    found = fitted(problem)
    posterior = sample(problem, found, 3000, 1, problem.costs)
    low, high = (2 * end - 1 for end in posterior.interval(0.95))
    np.testing.assert_allclose((high - low) / found.standard_error, 2 * 2.024, rtol=0.06)


def test_the_posterior_ends_at_the_bounds():
    """b at most -0.001, one standard error below what the data want: a normal distribution without its upper part."""
    problem = problem_of(lambda a, b: line(0, b) + 1e-5 * a, m2=(-0.5, -0.00224))
    found = fitted(problem)
    posterior = sample(problem, found, 4000, 1, problem.costs)
    b = -0.5 + 0.49776 * posterior.x[:, 1]
    assert b.max() <= -0.00224
    sigma = SIGMA / np.sqrt(20)  # 0.00224
    # Mean beyond one standard deviation: phi(1) / Phi(-1) = 1.525 (tables).
    assert b.mean() / sigma == pytest.approx(-1.525, abs=0.03)
    a = posterior.x[:, 0]  # which nothing determines: even between its bounds
    assert (a.mean(), a.std()) == (pytest.approx(0.5, abs=0.03), pytest.approx(12**-0.5, rel=0.1))


def test_the_interval_of_a_linear_problem_is_that_of_its_standard_error():
    problem = problem_of(line, noise=5)
    found = fitted(problem)
    sigma = np.sqrt(np.diag(covariance_of_line()))
    for i in range(2):
        low, high = (2 * end - 1 for end in profile_interval(problem, found, i, 0.95, lambda cost: None))
        np.testing.assert_allclose([low, high], found.values[i] + 1.96 * sigma[i] * np.array([-1, 1]), rtol=1e-3)


def test_the_interval_of_a_curved_problem_is_not_symmetric():
    """a + 8 a^2 is measured, and b for itself: its interval is that of y = a + 8 a^2, whose ends are a(y)."""

    def curved(a: float, b: float) -> np.ndarray:
        return np.full(20, a + 8 * a * a) + 1j * b

    problem = problem_of(curved, m1=(0.0, 1.0))
    found = fitted(problem)
    problem.curves = [Curve("1 m/s2", FREQUENCY, np.ones(20), MEASURED * np.exp(0.03), ERROR)]
    found = fitted(problem)
    sigma = np.hypot(SIGMA, 2e-4) / np.sqrt(20)
    ends = 0.03 + 1.96 * sigma * np.array([-1, 1])
    expected = (np.sqrt(1 + 32 * ends) - 1) / 16
    low, high = profile_interval(problem, found, 0, 0.95, lambda cost: None)
    by_error = found.values[0] + 1.96 * found.standard_error[0] * np.array([-1, 1])
    np.testing.assert_allclose([low, high], expected, rtol=2e-3)
    assert np.abs([low, high] - expected).max() < 0.2 * np.abs(by_error - expected).max()


def test_the_interval_of_what_the_data_do_not_tell_is_between_its_bounds():
    problem = problem_of(lambda a, b: line(0, b) + 1e-4 * a, noise=6)
    assert profile_interval(problem, fitted(problem), 0, 0.95, lambda cost: None) == (0.0, 1.0)


def test_draws_go_on_where_an_interruption_left_them(tmp_path):
    problem = problem_of(line, noise=7)
    found, stop, asked = fitted(problem), threading.Event(), []

    def until_interrupted(cost: float) -> None:
        asked.append(cost)
        if len(asked) == 40:
            stop.set()

    def drawn(stop: threading.Event, progress):
        record = cost_record(tmp_path / "posterior.csv", {}, ["m1", "m2"])
        with record:
            return sample(problem, found, 90, 2, Costs(problem, None, record, stop, progress)), len(record.results)

    with pytest.raises(Interrupted, match=r"kept in .*posterior.csv; the same command goes on"):
        drawn(stop, until_interrupted)
    posterior, kept = drawn(threading.Event(), lambda cost: None)
    assert kept == 90
    np.testing.assert_array_equal(posterior.x, sample(problem, found, 90, 2, problem.costs).x)


def test_draws_are_read_as_they_were_written(tmp_path):
    rows = [[12000.123456789, 1.5e-2], [13000.0, 1.6e-2]]
    with Fmu() as fmu:
        path = write_draws(tmp_path / "draws.csv", fmu, ["zspring.k", "zspring.l0"], rows, {"made": "by hand"})
        assert read_draws(path, fmu) == [dict(zip(("zspring.k", "zspring.l0"), row)) for row in rows]


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("zspring.k [N/mm]\n12\n", None),
        ("zspring.q [N/m]\n12\n", "draws.csv: no parameter 'zspring.q'"),
        ("zspring.k [N]\n12\n", r"column 'zspring.k': unit \[N\]: must be one of N/m"),
        ("zspring.k\n12\n", "column 'zspring.k' needs its unit"),
        ("friction [1]\n2\n", "friction: must be a Real parameter"),
        ("solver.step [s]\n2\n", "solver.step: must be a Real parameter that the command does not set itself"),
        ("zspring.k [N/m]\n", "draws.csv: has no draw"),
        ("zspring.k [N/m]\nmuch\n", "line 2: zspring.k = 'much': must be a finite number"),
    ],
)
def test_draws_of_others_are_read_by_unit_or_refused(tmp_path: Path, text, complaint):
    (tmp_path / "draws.csv").write_text(text)
    with Fmu() as fmu:
        if complaint is None:
            assert read_draws(tmp_path / "draws.csv", fmu) == [{"zspring.k": 12000.0}]
            return
        with pytest.raises(ZSpringError, match=complaint):
            read_draws(tmp_path / "draws.csv", fmu, ["solver.step"])


@pytest.mark.parametrize("count", [79, 200])
def test_intervals_hold_a_further_draw_as_often_as_they_say(count):
    """Of 4000 samples: the share is known to 0.3 %."""
    values = np.random.default_rng(1).standard_normal((count + 1, 4000))
    low, middle, high = quantiles(values[:-1])
    assert np.mean((low <= values[-1]) & (values[-1] <= high)) == pytest.approx(0.95, abs=0.01)
    assert np.mean(middle) == pytest.approx(0, abs=0.01)
