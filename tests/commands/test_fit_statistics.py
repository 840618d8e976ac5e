"""What a fit says of itself, on cases small enough for a pencil: standard errors, weights, doubts, tables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.curves import Curve, Harmonics
from zspring.bench.static_test import StaticTest
from zspring.fmu import Fmu
from zspring.identify.fit import Fit, statistics
from zspring.identify.problem import Answer, Problem
from zspring.identify.report import (
    correlation_table,
    doubts,
    magnitude_error,
    parameter_table,
    phase_error,
    residual_table,
)
from zspring.identify.settings import Free, Settings, Static

# A straight line a + b t through five points: five residuals, two parameters.
T = np.arange(5.0)
LINE = np.column_stack([np.ones(5), T])
FREQUENCY = np.array([1.0, 2.0, 4.0])
MASS = Free(start=5, min=0, max=10)
MEASURED = np.array([2e-4 - 1e-4j, 1e-4 - 3e-4j, -5e-5 - 2e-4j])
ERROR = np.array([[0.01, 0.02], [0.05, 0.01], [0.002, 0.004]])  # of magnitude and phase


class Exponential:
    """H = measured exp(m1 + 2i m2): logarithmic residuals that are linear in the parameters."""

    relative_step, tolerance, is_costly = 1e-3, 1e-9, False

    def __init__(self):
        self.asked = []

    def answers(self, candidates, like=None):
        self.asked.append((candidates, like))
        return [Answer([MEASURED * np.exp(p["m1"] / 10 + 2j * p["m2"] / 10)], None) for p in candidates]

    def with_curves(self, curves):
        return self


def problem_of(free=("m1", "m2"), static: StaticTest | None = None, **fields) -> Problem:
    """With parameters from 0 to 10 of these names, or others by their names; with standard errors where these weigh."""
    free = free if isinstance(free, dict) else dict.fromkeys(free, MASS)
    settings = Settings.model_construct(model="zspring", free=free, **fields)  # unchecked, as it has no file
    errors = ERROR if fields.get("weights") == "errors" else None
    curves = [Curve("1 m/s2", FREQUENCY, np.ones(3), MEASURED, errors)]
    return Problem(settings, Exponential(), curves, static)


def fit_of(problem: Problem, **fields) -> Fit:
    """A fit in the middle of the ranges, off by 3 % and 2 deg."""
    n = len(problem.settings.free)
    static = None if problem.static is None else problem.static.force
    return replace(
        Fit(
            x=np.full(n, 0.5),
            values=np.array([free.value(0.5) for free in problem.settings.free.values()]),
            answer=Answer([MEASURED], static),
            cost=0.0,
            is_converged=True,
            message="",
            evaluations=1,
            at_bound=np.zeros(n, bool),
            standard_error=np.full(n, 0.01),
            unbound_error=np.full(n, 0.01),
            correlation=np.eye(n),
            jacobian=np.zeros((6, n)),
        ),
        **fields,
    )


NONE_HELD = np.zeros(2, bool)


def test_the_standard_errors_of_a_straight_line_are_those_of_the_textbook():
    """s^2 = RSS / (5 - 2); var(a) = s^2 (1/5 + 2^2/10), var(b) = s^2 / 10, their correlation -2 / sqrt(6)."""
    rss = 12.0
    error, correlation = statistics(problem_of(), np.array([0.5, 0.5]), LINE, NONE_HELD, np.full(5, rss / 3))
    s = np.sqrt(rss / 3)
    np.testing.assert_allclose(error, 10 * s * np.sqrt([0.6, 0.1]), rtol=1e-12)  # 10: from x to the parameters
    np.testing.assert_allclose(correlation, [[1, -2 / np.sqrt(6)], [-2 / np.sqrt(6), 1]], rtol=1e-12)


def test_a_parameter_that_is_held_counts_as_known():
    """The slope alone, from the origin: s^2 = RSS / (5 - 1), var(b) = s^2 / 30."""
    error, correlation = statistics(problem_of(), np.array([1.0, 0.5]), LINE, np.array([True, False]), np.full(5, 2.0))
    assert np.isnan(error[0]) and error[1] == pytest.approx(10 * np.sqrt(2 / 30), rel=1e-12)
    assert (
        np.isnan(correlation[0]).all() and np.isnan(correlation[:, 0]).all() and correlation[1, 1] == pytest.approx(1)
    )
    error, correlation = statistics(problem_of(), np.array([1.0, 0.0]), LINE, np.array([True, True]), np.full(5, 2.0))
    assert np.isnan(error).all() and np.isnan(correlation).all()


def test_errors_on_a_logarithmic_scale_are_those_at_the_solution():
    """From 1 to 10^4: value = 10^(4 x), d value / dx = 4 ln(10) value."""
    free = {"zspring.tau": Free(start=10, min=1, max=1e4), "m2": MASS}
    error, _ = statistics(problem_of(free), np.array([0.25, 0.5]), LINE, NONE_HELD, np.ones(5))
    np.testing.assert_allclose(error, [4 * np.log(10) * 10 * np.sqrt(0.6), 10 * np.sqrt(0.1)], rtol=1e-12)


def test_as_many_residuals_as_parameters_do_not_divide_by_zero():
    error, _ = statistics(problem_of(), np.array([0.5, 0.5]), np.eye(2), NONE_HELD, np.full(2, 4.0))
    np.testing.assert_allclose(error, 10 * 2.0)


def test_what_the_residuals_do_not_tell_apart_has_no_finite_error():
    """Two equal columns are one direction only; a column of zeros is none, and leaves the other's error."""
    same = np.column_stack([T, 3 * T])
    error, correlation = statistics(problem_of(), np.array([0.5, 0.5]), same, NONE_HELD, np.ones(5))
    assert np.isinf(error).all() and np.isnan(correlation).all()
    nothing = np.column_stack([np.zeros(5), T])
    error, correlation = statistics(problem_of(), np.array([0.5, 0.5]), nothing, NONE_HELD, np.ones(5))
    assert np.isinf(error[0]) and error[1] == pytest.approx(10 * np.sqrt(1 / 30))
    assert np.isnan(correlation[0, 1]) and correlation[1, 1] == pytest.approx(1)


def test_residuals_of_two_sizes_have_standard_errors_by_each_one_s_scatter():
    """A mean of 10 values with scatter 2 and of 40 with none, all alike in weight: var = 10 * 4 / 50^2, whatever 40 is.

    Pooled, 40 values that say nothing of the scatter of the first would halve the error.
    """
    J = np.ones((50, 1))
    error, _ = statistics(problem_of(["m1"]), np.array([0.5]), J, NONE_HELD[:1], np.r_[np.full(10, 4.0), np.zeros(40)])
    assert error[0] == pytest.approx(10 * np.sqrt(40) / 50, rel=1e-12)


def test_variances_go_by_kind_of_residual():
    """Points that are off by chance alone in their standard errors, and a static test that is off by its own."""
    force = np.array([3.0, -1.0, 4.0, -6.0, 10.0])
    problem = problem_of(static=StaticTest(force, force, force), weights="errors")
    static = Static.model_construct(path=Path("static.csv"), weight=1.0)
    problem.settings = problem.settings.model_copy(update={"static": static})
    answer = Answer([MEASURED * np.exp(np.array([0.01, -0.05, 0.002]))], 1.1 * force)
    residuals = problem.residuals(answer)
    found = problem.variances(answer, 2)
    np.testing.assert_array_equal(found[:6], 1.0)
    np.testing.assert_allclose(found[6:], residuals[6:] @ residuals[6:] / (5 * (1 - 2 / 11)))
    # In standard errors of the points, of which the median is 1 %: 10 % off are ten for each point.
    assert residuals[6:] @ residuals[6:] == pytest.approx(3 * 10**2, rel=1e-9)


# Residuals


def test_logarithmic_residuals_are_the_errors_of_magnitude_and_phase():
    problem = problem_of()
    off = np.array([0.1 + 0.2j, -0.3 + 0.1j, 0.05 - 0.4j])
    np.testing.assert_allclose(
        problem.residuals(Answer([MEASURED * np.exp(off)], None)), [0.1, -0.3, 0.05, 0.2, 0.1, -0.4], atol=1e-12
    )


def test_weighted_residuals_count_in_standard_errors_of_each_point():
    """The model's own scatter, 2e-4, joins them: of a point that is known to 0.2 % it takes 0.5 %."""
    problem = problem_of(weights="errors")
    off = np.array([0.01 + 0.02j, -0.05 + 0.01j, 0.004 - 0.004j])
    residuals = problem.residuals(Answer([MEASURED * np.exp(off)], None))
    np.testing.assert_allclose(residuals, [1, -1, 2, 1, 1, -1], rtol=0.006)
    assert residuals[2] == pytest.approx(2 / np.hypot(1, 0.1), rel=1e-9)


@pytest.mark.parametrize("weights", ["equal", "errors"])
def test_harmonics_count_over_the_first_one_or_in_standard_errors(weights):
    """Of orders 3 and 5 alone. The first one is displacement over receptance."""
    peak = np.arange(18.0).reshape(3, 6)
    problem = problem_of(harmonics=(3, 5), weights=weights)
    curve = replace(problem.curves[0], harmonics=Harmonics(peak, np.full((3, 6), 0.5)))
    problem.curves = [curve]
    computed = peak + np.array([9.0, 1.0, 9.0, -2.0, 9.0, 9.0])
    residuals = problem.residuals(Answer([MEASURED], None, None, [computed]))[6:]
    first = 1 / (2 * np.pi * FREQUENCY) ** 2 / np.abs(MEASURED)
    scale = first if weights == "equal" else np.hypot(0.5, 2e-4 * first)
    np.testing.assert_allclose(residuals, np.outer(1 / scale, [1.0, -2.0]).ravel(), rtol=1e-12)


def test_standard_errors_of_weighted_residuals_are_widened_by_a_misfit_and_never_narrowed():
    problem = problem_of(weights="errors")
    assert [problem.variance(cost, 4) for cost in (0.5, 2.0, 8.0)] == [1, 1, 4]
    assert [problem_of().variance(cost, 4) for cost in (0.5, 2.0, 8.0)] == [0.25, 1, 4]


@pytest.mark.parametrize("quantity, wanted", [("receptance", MEASURED), ("stiffness", 1 / MEASURED)])
def test_linear_residuals_are_differences_over_the_root_mean_square(quantity, wanted):
    problem = problem_of(error="linear", quantity=quantity)
    off = np.array([1 + 2j, -3 + 1j, 0.5 - 4j]) * np.abs(wanted).max()
    answer = wanted + off if quantity == "receptance" else 1 / (wanted + off)
    scale = np.sqrt((np.abs(wanted) ** 2).sum() / 3)
    expected = np.concatenate([off.real, off.imag]) / scale
    np.testing.assert_allclose(problem.residuals(Answer([answer], None)), expected, rtol=1e-9)


@pytest.mark.parametrize("weight", [1.0, 0.25])
def test_a_static_test_that_is_wholly_off_weighs_as_much_as_all_points_of_the_curves(weight):
    """As the points do with residuals of 1; the zero of either load cell does not matter."""
    force = np.array([3.0, -1.0, 4.0, -6.0, 10.0])
    problem = problem_of(static=StaticTest(force, force, force))
    static = Static.model_construct(path=Path("static.csv"), weight=weight)
    problem.settings = problem.settings.model_copy(update={"static": static})
    for simulated, square in ((2 * force + 7, 1.0), (1.5 * force, 0.25), (force - 3, 0.0)):
        residuals = problem.residuals(Answer([MEASURED], simulated))
        assert residuals.size == 2 * 3 + 5 and np.all(residuals[:6] == 0)
        assert residuals[6:] @ residuals[6:] == pytest.approx(weight * 3 * square, abs=1e-12)
    centred = force - force.mean()
    expected = np.sqrt(weight * 3 / (centred @ centred)) * centred
    np.testing.assert_allclose(problem.residuals(Answer([MEASURED], 2 * force))[6:], expected)


@pytest.mark.parametrize("x", [[0.5, 0.2], [1.0, 0.5], [0.0, 1.0]])
def test_the_jacobian_is_that_of_the_residuals_inside_and_at_the_bounds(x):
    """Differences do not leave the bounds, and their answers are asked for as alike the one at x."""
    problem = problem_of()
    x = np.array(x)
    (answer,) = problem.answers([x])
    expected = np.column_stack([np.repeat([1.0, 0.0], 3), np.repeat([0.0, 2.0], 3)])
    np.testing.assert_allclose(problem.jacobian(x, answer, range(2)), expected, atol=1e-9)
    np.testing.assert_allclose(problem.jacobian(x, answer, [1]), expected[:, 1:], atol=1e-9)
    _, (shifted, like), _ = problem._model.asked
    assert like is answer and len(shifted) == 2
    for name, at, candidate in zip(("m1", "m2"), 10 * x, shifted):
        assert 0 <= candidate[name] <= 10 and candidate[name] != at
        # A thousandth of the value, but no less than of a thousandth of the range.
        assert abs(candidate[name] - at) == pytest.approx(1e-3 * max(at, 0.01))


def test_costs_are_half_the_sums_of_squares():
    problem = problem_of()
    costs = problem.costs([np.zeros(2), np.array([0.3, 0.0]), np.array([0.0, 0.1])])
    np.testing.assert_allclose(costs, [0, 0.5 * 3 * 0.3**2, 0.5 * 3 * 0.2**2], atol=1e-12)


def test_a_thinned_problem_keeps_the_ends_and_steps_of_two_milliseconds():
    frequency = np.arange(1.0, 12.0)
    curves = [Curve("1 m/s2", frequency, frequency / 10, frequency * 1e-4 * (1 - 1j)) for _ in range(2)]
    for given, used in ((5e-4, 2e-3), (3e-3, 3e-3)):
        settings = problem_of(fixed={"solver.step": given, "k1": 7.0}).settings
        thinned = Problem(settings, Exponential(), curves).thinned(3)
        assert thinned.settings.fixed == {"solver.step": used, "k1": 7.0}
        for curve in thinned.curves:
            np.testing.assert_array_equal(curve.frequency, [1, 6, 11])
            np.testing.assert_allclose(curve.acceleration, [0.1, 0.6, 1.1])
    assert Problem(settings, Exponential(), curves).thinned(50).curves[1].frequency.size == 11


# What is said


def lines_about(**fields) -> list[str]:
    problem = problem_of()
    return doubts(problem, fit_of(problem, **fields))


def test_a_good_fit_leaves_no_doubt():
    close = np.array([[1, 0.979], [0.979, 1]])
    assert lines_about(unbound_error=np.array([4.9, 4.9]), correlation=close) == []


@pytest.mark.parametrize("sign", [-1, 1])
def test_doubts_begin_just_beyond_their_limits(sign):
    """Half the range is 5; a correlation of 0.98 either way."""
    (line,) = lines_about(correlation=np.array([[1, sign * 0.981], [sign * 0.981, 1]]))
    assert line == f"m1 and m2 can hardly be told apart: correlation {sign * 0.981:.3f}"
    (line,) = lines_about(unbound_error=np.array([0.1, 5.1]))
    assert line.startswith("the data do not determine m2: its standard error 5.1 is more than half the range")


def test_each_doubt_names_its_parameter_and_where_it_is():
    held = {"at_bound": np.array([False, True]), "values": np.array([5.0, 10.0])}
    assert lines_about(**held) == ["m2 is at its bound 10: the data want it there or beyond"]
    (line,) = lines_about(**held, unbound_error=np.array([0.1, np.inf]))
    assert line == "the data do not determine m2, at its bound 10: no effect of its own on the fit"
    (line,) = lines_about(is_converged=False, message="too many evaluations")
    assert line == "least squares did not converge: too many evaluations"
    lost = np.array([MEASURED[0], np.nan, np.nan])
    assert lines_about(answer=Answer([lost], None))[0].startswith("2 points could not be computed")


def test_the_parameter_table_has_the_digits_that_the_errors_leave():
    problem = problem_of()
    fit = fit_of(problem, values=np.array([5.12345, 8.0]), standard_error=np.array([0.0321, np.nan]))
    fit = replace(fit, at_bound=np.array([False, True]))
    with Fmu() as fmu:
        _, first, second = (line.split("  ") for line in parameter_table(fmu, problem, fit))
    assert [cell.strip() for cell in first if cell] == ["m1", "5.123", "0.032 (0.63 %)", "kg", "5", "0 .. 10"]
    assert [cell.strip() for cell in second if cell] == ["m2", "8", "-", "kg", "5", "0 .. 10", "at the bound"]


def test_the_correlation_table_is_the_lower_triangle():
    free = ["m1", "m2", "m3"]
    correlation = np.array([[1, 0.12, np.nan], [0.12, 1, -0.34], [np.nan, -0.34, 1]])
    problem = problem_of(free)
    rows = [line.split() for line in correlation_table(problem, fit_of(problem, correlation=correlation))]
    assert rows == [["correlation", "m1", "m2"], ["m2", "0.120"], ["m3", "-", "-0.340"]]
    assert correlation_table(problem_of(free[:1]), fit_of(problem_of(free[:1]))) == []


def test_the_residual_table_has_rms_and_the_worst_with_its_frequency():
    """Magnitude +3, -4, 0 %: rms 5 / sqrt(3); phase 0, 1, -2 deg: rms sqrt(5 / 3)."""
    force = np.array([3.0, -1.0, -2.0])
    problem = problem_of(static=StaticTest(force, force, force))
    off = np.array([1.03, 0.96, 1.0]) * np.exp(1j * np.radians([0, 1, -2]))
    answer = Answer([MEASURED * off], force + np.array([0.5, -0.5, 0.0]) + 20)
    _, row, static = residual_table(problem, fit_of(problem, answer=answer))
    cells = [cell.strip() for cell in row.split("  ") if cell]
    assert cells == ["1 m/s2", "3", "2.89 %", "-4.0 % (2 Hz)", "1.29 deg", "-2.0 deg (4 Hz)"]
    assert static == "static test: rms 0.408 N of 2.16 N, largest 0.5 N"


def test_the_residual_table_leaves_out_what_was_not_computed():
    problem = problem_of()
    off = np.array([1.03, np.nan, 0.99])
    _, row = residual_table(problem, fit_of(problem, answer=Answer([MEASURED * off], None)))
    assert [cell.strip() for cell in row.split("  ") if cell][1:4] == ["2", "2.24 %", "3.0 % (1 Hz)"]
    _, row = residual_table(problem, fit_of(problem, answer=Answer([np.full(3, np.nan + 0j)], None)))
    assert row.split() == ["1", "m/s2", "0", "-", "-", "-", "-"]


# Bounds


@pytest.mark.parametrize(
    "low, high, is_logarithmic", [(1, 10, False), (1, 10.1, True), (2, 30, True), (0, 100, False), (-1, 90, False)]
)
def test_wide_positive_ranges_are_searched_on_a_logarithmic_scale(low, high, is_logarithmic):
    free = Free(start=low, min=low, max=high)
    assert free.is_logarithmic is is_logarithmic
    middle = np.sqrt(low * high) if is_logarithmic else (low + high) / 2
    assert free.value(0.5) == pytest.approx(middle, rel=1e-12) and free.x(middle) == pytest.approx(0.5)
    assert (free.value(0), free.value(1), free.value(-0.1), free.value(1.1)) == (low, high, low, high)
    assert (free.value(0.5001) - free.value(0.4999)) / 2e-4 == pytest.approx(free.slope(0.5), rel=1e-6)


def test_errors_that_are_written_are_those_of_the_fit_against_the_measurement():
    curve = problem_of().curves[0]
    fitted = MEASURED * np.array([1.03, 0.96, 1.0]) * np.exp(1j * np.radians([0, 1, -2]))
    np.testing.assert_allclose(magnitude_error(curve, fitted), [0.03, -0.04, 0], atol=1e-12)
    np.testing.assert_allclose(phase_error(curve, fitted), [0, 1, -2], atol=1e-12)
