"""The bench's ramps and sums, against a trapezoidal rule of one's own and the smoothness of what it imposes."""

from __future__ import annotations

import numpy as np
import pytest

from harness import bench_point

FREQUENCY, ACCELERATION = 4.0, 2.0  # Hz, m/s2
HARMONICS = [f"bench.harmonic[{n}]" for n in range(2, 8)]


def test_tuned_again_within_the_ramp_the_acceleration_stays_continuous(pantograph):
    """Position, velocity and acceleration go on from where the first ramp was; jumps would be of its size."""
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    step, rows = 1e-4, []
    for tuned in ({}, {"bench.frequency": 6.0}, {"bench.acceleration": 4.0, "bench.frequency": 3.0}, {}):
        p.set(tuned)
        rows.append(p.run(step, 1000, ["head.z", "head.v", "head.a"]))
    z, v, a = np.vstack(rows).T
    changes = np.abs(np.diff(a))
    assert changes.max() < 3 * np.percentile(changes, 99)
    np.testing.assert_allclose(np.diff(v), step * (a[1:] + a[:-1]) / 2, atol=1e-4 * np.ptp(v))
    np.testing.assert_allclose(np.diff(z), step * (v[1:] + v[:-1]) / 2, atol=1e-4 * np.ptp(z))


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
def test_the_first_periods_receptance_and_harmonics_are_those_of_a_trapezoidal_rule_over_it(pantograph, friction):
    """From the nodes of period 1 and of period 2, one communication step for each internal one."""
    p = pantograph(
        {
            "drive": "Bench",
            "friction": friction,
            "bench.frequency": FREQUENCY,
            "bench.acceleration": ACCELERATION,
            "static_force": 120.0,
        }
    )
    count = p["bench.steps_per_period"]
    step = 1 / (FREQUENCY * count)
    p.run(step, count - 1, [])
    rows = p.run(step, 1, ["contact.force", "head.z"])  # the end of the ramp
    for period in (1, 2):
        rows = np.vstack([rows[-1:], p.run(step, count, ["contact.force", "head.z"])])
        assert p["bench.periods"] == period
        weights = np.exp(-2j * np.pi * np.outer(np.arange(8), np.arange(count + 1)) / count)
        weights[:, [0, -1]] *= 0.5
        force, z = weights @ (rows[:, 0] - 120.0), weights @ rows[:, 1]
        found = complex(*p.reals(["bench.H_re", "bench.H_im"]))
        assert found == pytest.approx(-z[1] / force[1], rel=1e-9)
        np.testing.assert_allclose(p.reals(HARMONICS), 2 / count * np.abs(force[2:]), rtol=1e-9)


def test_harmonics_of_the_last_whole_period_alone(pantograph):
    """0 before the first, those of it until the next one ends, and 0 again with every change."""
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    p.step(1.9 / FREQUENCY)
    assert not p.reals(HARMONICS).any()
    p.step(0.1 / FREQUENCY)
    first = p.reals(HARMONICS)
    assert first.all()
    p.step(0.9 / FREQUENCY)
    assert (p.reals(HARMONICS) == first).all()
    p.step(0.1 / FREQUENCY)
    assert (p.reals(HARMONICS) != first).all()
    p["bench.acceleration"] = 0.5 * ACCELERATION
    p.step(0.5 / FREQUENCY)
    assert not p.reals(HARMONICS).any()


@pytest.mark.parametrize(
    "frequency, acceleration, second, third",  # of the first harmonic
    [
        (4.9, 0.25, (0.001, 0.005), (0.0015, 0.0025)),  # the rods stick
        (4.9, 1.0, (0.001, 0.005), (0.14, 0.16)),  # they slide
        (6.0, 1.0, (0.005, 0.02), (0.16, 0.18)),
        (4.9, 4.0, (0.035, 0.045), (0.10, 0.12)),  # so far that the geometry shows
    ],
)
def test_friction_makes_odd_and_geometry_even_harmonics(pantograph, frequency, acceleration, second, third):
    p = pantograph({"drive": "Bench", "solver.step": 5e-4})
    H = bench_point(p, frequency, acceleration, settled=1e-6)
    ratio = p.reals(HARMONICS) * abs(H) * (2 * np.pi * frequency) ** 2 / acceleration
    assert second[0] < ratio[0] < second[1] and third[0] < ratio[1] < third[1]


def test_a_linear_pantograph_has_no_harmonics(pantograph):
    p = pantograph({"drive": "Bench", "suspension": "Linear", "solver.step": 5e-4})
    H = bench_point(p, FREQUENCY, ACCELERATION, settled=1e-12)
    force = ACCELERATION / (2 * np.pi * FREQUENCY) ** 2 / abs(H)
    assert p.reals(HARMONICS).max() < 1e-9 * force
