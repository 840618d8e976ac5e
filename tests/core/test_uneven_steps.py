"""An imposed head and communication steps of very different lengths: what even steps of 1 ms give, and how near.

The motion is that of a bench, 10 mm at 2 and 6 Hz, known to rounding; its inertia is up to 70 N of the reaction.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from harness import Instance, Signal, differences

MOTION = Signal.cubed_sines([0.01], [2.0])
HEAD, OUTPUTS = "head_displacement", ["contact.force", "energy.work", "head.v", "head.z"]
PARAMETERS = {"drive": "Displacement", "solver.step": 5e-4}
END = 0.6


def steps_of(kind: str) -> list[float]:
    rng = np.random.default_rng(4)
    lengths = {
        "1 and 2 ms": lambda n: 1e-3 * (1 + n % 2),
        "2 ms and 1e-8 s": lambda n: 1e-8 if n % 10 == 9 else 2e-3,
        "1 and 20 ms": lambda n: 2e-2 if n % 30 == 29 else 1e-3,
        "0.1 to 4 ms": lambda n: 10 ** rng.uniform(-4, -2.4),
        "1e-15 s to 4 ms": lambda n: 10 ** rng.uniform(-15, -2.4),
        "1e-15 s to 0.1 s": lambda n: 10 ** rng.uniform(-15, -1),
        "even 50 ms": lambda n: 0.05,
    }[kind]
    steps: list[float] = []
    while (left := END - sum(steps)) > 1e-9:
        steps.append(min(lengths(len(steps)), left))
    return steps


def tell(p: Instance, orders: int, begin: float, end: float) -> None:
    """The target, or the value at the begin with derivatives up to this order."""
    p[HEAD] = MOTION(begin if orders else end)
    if orders:
        p.set_derivatives(HEAD, *(MOTION(begin, k) for k in range(1, orders + 1)))


def run(p: Instance, steps: list[float], orders: int) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) in s and OUTPUTS (n, 4) at the ends of the steps."""
    rows = []
    for step in steps:
        tell(p, orders, p.time, p.time + step)
        p.step(step)
        rows.append([p.time, *p.reals(OUTPUTS)])
    times, *values = np.array(rows).T
    return times, np.array(values)


@pytest.fixture(scope="module")
def even(fmu) -> CubicSpline:
    """OUTPUTS over time, from even steps of 0.5 ms with both derivatives."""
    p = Instance(fmu, PARAMETERS)
    times, values = run(p, [5e-4] * round(END / 5e-4), 2)
    p.close()
    start = [120.0, 0.0, 0.0, 0.0]
    return CubicSpline(np.append(0, times), np.column_stack([start, values]), axis=1)


# Largest error of the force in the root mean square (N) and of the work (J), each for targets, order 1, orders 1, 2.
NEAR = {
    "1 and 2 ms": ((0.1, 0.2, 0.1), (0.01, 0.02, 0.01)),
    "2 ms and 1e-8 s": ((0.1, 0.2, 0.1), (0.01, 0.02, 0.01)),
    "1 and 20 ms": ((3, 5, 5), (0.2, 1, 0.2)),
    "0.1 to 4 ms": ((0.5, 4, 1), (0.01, 0.3, 0.02)),
    "1e-15 s to 4 ms": ((1, 4, 1), (0.01, 0.3, 0.02)),
    "1e-15 s to 0.1 s": ((30, 60, 40), (3, 20, 30)),
    "even 50 ms": ((80, 200, 120), (10, 30, 10)),
}


@pytest.mark.parametrize("orders", [0, 1, 2])
@pytest.mark.parametrize("kind", NEAR)
def test_force_and_work_stay_near_those_of_even_steps(pantograph, even, kind, orders):
    """What costs are the longest steps, in which the head goes in a straight line: even ones do no better there."""
    times, found = run(pantograph(PARAMETERS), steps_of(kind), orders)
    force, work, velocity, position = np.abs(found - even(times))
    rms, joule = (limits[orders] for limits in NEAR[kind])
    assert np.sqrt(np.mean(force**2)) < rms
    assert work.max() < joule
    assert velocity.max() < 0.4 * (rms / 10) ** 0.5
    if orders == 0:
        assert position.max() < 1e-6  # that of the spline


def test_a_gap_left_by_a_long_step_is_not_closed_in_a_short_one(pantograph):
    """With derivatives a step of 20 ms ends 0.1 mm from where the motion is; 1e-8 s later the head was at 10 km/s."""
    p = pantograph(PARAMETERS)
    run(p, [0.02] * 10 + [1e-8], 2)
    assert p["head.v"] == pytest.approx(MOTION(p.time, 1), abs=0.1)
    run(p, [0.02], 2)
    assert p["head.z"] == pytest.approx(MOTION(p.time), abs=5e-4)


@pytest.mark.parametrize("orders", [0, 1, 2])
@pytest.mark.parametrize("length", [1e-7, 3e-4, 5e-3])
def test_derivatives_are_those_of_differences_after_uneven_steps(pantograph, orders, length):
    """Which samples count is a matter of their times, so that the motion stays linear in its values."""
    p = pantograph({**PARAMETERS, "suspension": "Linear"})
    run(p, steps_of("1e-15 s to 4 ms")[:600], orders)
    tell(p, orders, p.time, p.time + length)
    expected = differences(p, OUTPUTS, HEAD, 1e-5, length)
    p.step(length)
    found = p.slave.getDirectionalDerivative([p.reference(name) for name in OUTPUTS], [p.reference(HEAD)], [1.0])
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("orders", [0, 1, 2])
def test_uneven_steps_replay_bit_for_bit(pantograph, orders):
    p, steps = pantograph(PARAMETERS), steps_of("1e-15 s to 4 ms")
    run(p, steps[:500], orders)
    state, time = p.slave.getFMUstate(), p.time
    first = run(p, steps[500:700], orders)[1]
    p.slave.setFMUstate(state)
    p.slave.freeFMUstate(state)
    p.time = time
    assert (run(p, steps[500:700], orders)[1] == first).all()
