"""Linear head suspensions against the analytic complex receptance, and published anchors of the DSA-380."""

from __future__ import annotations

import numpy as np
import pytest

from harness import PRECISE, bench_point
from linear import PUBLISHED, STEP, LinearPantograph, ZSpringLinear, step_error

FREQUENCIES = [0.7, 2.0, 4.0, 6.4, 9.0, 12.0, 13.0, 20.0]


def published(name: str) -> LinearPantograph:
    table = dict(PUBLISHED[name])
    return LinearPantograph(head=table.pop("k1"), **table)


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_linear_pantographs_have_their_analytic_receptance(pantograph, name):
    linear = published(name)
    linear_bench = {"suspension": "Linear", "drive": "Bench", "solver.step": STEP}
    p = pantograph(PRECISE | PUBLISHED[name] | linear_bench)
    for frequency in FREQUENCIES:
        h = bench_point(p, frequency, 0.5)
        assert abs(h - linear.receptance(frequency)) < step_error(linear, frequency)


def test_the_massless_lower_frame_on_a_stiff_spring_is_the_two_mass_model_of_en_50318():
    """k3 = 1e9 N/m differs from a rigid base by k2 / k3."""
    two = PUBLISHED["EN 50318:2002"]
    for frequency in FREQUENCIES:
        s = 2j * np.pi * frequency
        suspension, base = two["k1"] + two["c1"] * s, two["k2"] + two["c2"] * s
        frame = two["m2"] * s**2 + base
        stiffness = two["m1"] * s**2 + suspension * frame / (suspension + frame)
        assert abs(published("EN 50318:2002").dynamic_stiffness(frequency) / stiffness - 1) < 1e-4


@pytest.mark.parametrize("inertia", [7.5e-4, 0.0])
@pytest.mark.parametrize("suspension", ["LinearLocked", "LinearFree"])
def test_both_linear_bounds_have_their_analytic_receptance(pantograph, suspension, inertia):
    """With a damper c1, which the published table lacks: undamped rods, at 64 Hz, would not settle."""
    rods = {"zspring.J1": inertia, "zspring.J2": inertia, "c1": 1000.0}
    p = pantograph(PRECISE | rods | {"suspension": suspension, "drive": "Bench", "solver.step": STEP})
    head = ZSpringLinear.of(p)
    if suspension == "LinearLocked":
        linear = LinearPantograph.of(p, head.k_locked)
    elif inertia == 0:
        linear = LinearPantograph.of(p, head.k_free)
    else:
        linear = LinearPantograph.of(p, head, rods=(inertia, inertia))
    for frequency in FREQUENCIES:
        h = bench_point(p, frequency, 0.25)
        assert abs(h - linear.receptance(frequency)) < step_error(linear, frequency)


@pytest.mark.parametrize(
    "k1, natural, head_fixed",
    [(9430.0, [0.012, 6.558, 12.307], [4.128, 11.995]), (4715.0, [0.012, 4.942, 11.548], [3.051, 11.476])],
)
def test_dsa_380_has_its_natural_frequencies(pantograph, k1, natural, head_fixed):
    """Both from the matrices and from the FMU's free vibration, undamped and at a small step.

    In free vibration x(t + T) + x(t - T) = A x(t) for any interval T; A has the eigenvalues 2 cos(omega T).
    """
    table = PUBLISHED["DSA-380"] | {"k1": k1}
    matrices = LinearPantograph(head=table.pop("k1"), **table)
    np.testing.assert_allclose(matrices.frequencies(), natural, atol=5e-4)
    np.testing.assert_allclose(matrices.frequencies(head_fixed=True), head_fixed, atol=5e-4)

    masses = ["head.z", "upper_frame.z", "lower_frame.z"]
    for drive, outputs, expected in (("Force", masses, natural), ("Displacement", masses[1:], head_fixed)):
        undamped = {"c3": 0.0, "solver.alpha": 0.0, "solver.step": 2e-4}
        p = pantograph(undamped | {"drive": drive, "suspension": "Linear", "k1": k1})
        p["uplift.lower_frame"] = 100.0
        p.step(0.05)
        p["uplift.lower_frame"] = 0.0
        interval = 0.02
        x = p.run(interval, 100, outputs)
        a = np.linalg.lstsq(x[1:-1], x[2:] + x[:-2], rcond=None)[0]
        found = np.sort(np.arccos(np.linalg.eigvals(a).real / 2)) / (2 * np.pi * interval)
        np.testing.assert_allclose(found, expected, atol=1e-3)


def test_hht_shifts_the_frequencies_of_dsa_380_as_much_as_its_theory_says(pantograph):
    """At alpha = -0.3 and 2 ms by -0.08 % at 6.5 Hz and -0.28 % at 12 Hz, with the square of the frequency.

    In free vibration the samples follow x(t + T) = A x(t) + B x(t - T); the eigenvalues are exp(i omega T).
    """
    interval, masses = 0.02, ["head.z", "upper_frame.z", "lower_frame.z"]
    p = pantograph(PRECISE | {"suspension": "Linear", "c3": 0.0})
    p["uplift.lower_frame"] = 100.0
    p.step(0.05)
    p["uplift.lower_frame"] = 0.0
    p.step(0.1)
    x = p.run(interval, 60, masses)
    a = np.linalg.lstsq(np.hstack([x[1:-1], x[:-2]]), x[2:], rcond=None)[0]
    companion = np.vstack([a.T, np.eye(3, 6)])
    found = np.angle(np.linalg.eigvals(companion)) / (2 * np.pi * interval)
    for frequency, stated, shift in zip(published("DSA-380").frequencies()[1:], (6.5, 12.0), (-0.08, -0.28)):
        nearest = found[np.argmin(np.abs(found - frequency))]
        percent = 100 * (nearest / frequency - 1)
        assert percent == pytest.approx(shift * (frequency / stated) ** 2, abs=0.006)


@pytest.mark.parametrize(
    "frequency, stiffness, digit", [(4.11, 25630, 10), (6.54, 2435, 1), (11.76, 46610, 10), (12.38, 19490, 10)]
)
def test_dsa_380_has_its_stationary_dynamic_stiffnesses(pantograph, frequency, stiffness, digit):
    """Value and place of each minimum and maximum, to the digits they are stated with."""
    linear = published("DSA-380")
    grid = frequency + np.arange(-5, 6) * 1e-2
    analytic = np.abs([linear.dynamic_stiffness(f) for f in grid])
    p = pantograph(PRECISE | {"suspension": "Linear", "drive": "Bench", "solver.step": 5e-5})
    computed = np.array([1 / abs(bench_point(p, f, 0.25)) for f in (frequency - 0.05, frequency, frequency + 0.05)])
    curvature = np.sign(stiffness - analytic[0])
    assert np.argmax(curvature * analytic) == 5
    assert np.argmax(curvature * computed) == 1
    assert abs(analytic[5] - stiffness) <= 0.6 * digit
    assert abs(computed[1] - stiffness) <= 0.6 * digit + abs(stiffness) * 1e-4
