"""The bench's ramps and sums, against a trapezoidal rule of one's own and the smoothness of what it imposes."""

from __future__ import annotations

import numpy as np
import pytest

FREQUENCY, ACCELERATION = 4.0, 2.0  # Hz, m/s2


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
def test_the_first_periods_receptance_is_that_of_a_trapezoidal_rule_over_it(pantograph, friction):
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
        weights = np.exp(-2j * np.pi * np.arange(count + 1) / count)
        weights[[0, -1]] *= 0.5
        force, z = weights @ (rows[:, 0] - 120.0), weights @ rows[:, 1]
        found = complex(*p.reals(["bench.H_re", "bench.H_im"]))
        assert found == pytest.approx(-z / force, rel=1e-9)
