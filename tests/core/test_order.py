"""HHT-alpha is of second order: in head position and in contact force, in every drive."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Signal, bench_point, fitted_order

STEPS = [4e-3, 2e-3, 1e-3, 5e-4]
FINEST = 3.125e-5
GRID = 0.02  # s, times at which errors are taken; every step divides it
POINTS = 40
SETTLED = 4  # grid points left out: HHT forgets the start of a motion over some steps
SMOOTH = {"zspring.tau": 3.0, "c1": 20.0}  # rods creep over many steps rather than stick and slip
OUTPUTS = ["head.z", "contact.force", "lower_frame.z"]

FORCE = {"contact_force": Signal.cubed_sines([40.0], [1.2], 120.0)}
LIFT = {"uplift.head": Signal.cubed_sines([40.0], [1.2])}
HEAD = {"head_displacement": Signal.cubed_sines([0.01], [1.2])}
WIRE = {"wire_height": Signal.cubed_sines([0.006], [1.2])}
SOFT = {"drive": "Wire", "contact.k": 5e3}
DAMPED = SOFT | {"contact.c": 100.0}
# Parameters; how the inputs are given; inputs; the outputs they impose.
DRIVES = {
    "Force": ({"drive": "Force"}, "signals", FORCE, ["contact.force"]),
    "Uplift": ({"drive": "Force"}, "signals", LIFT, ["contact.force"]),
    "Displacement, derivatives": ({"drive": "Displacement"}, "signals", HEAD, ["head.z"]),
    "Displacement, targets": ({"drive": "Displacement"}, "targets", HEAD, ["head.z"]),
    "Wire": (SOFT, "signals", WIRE, []),
    "Wire, targets": (SOFT, "targets", WIRE, []),
    "Wire, damped": (DAMPED, "signals", WIRE, []),
    "Wire, damped, targets": (DAMPED, "targets", WIRE, []),
}


def history(pantograph, drive: str, step: float, **options: float) -> np.ndarray:
    """OUTPUTS at multiples of GRID, with communication step = internal step; shape (POINTS, 3)."""
    parameters, kind, inputs, _ = DRIVES[drive]
    p = pantograph(SMOOTH | parameters | {"solver.step": step} | options)
    every = round(GRID / step)
    return p.run(step, every * POINTS, OUTPUTS, **{kind: inputs})[every - 1 :: every]


@pytest.mark.parametrize("alpha", [-0.3])
@pytest.mark.parametrize("drive", DRIVES)
def test_error_falls_with_the_square_of_the_step(pantograph, drive, alpha):
    def solution(step: float) -> np.ndarray:
        return history(pantograph, drive, step, **{"solver.alpha": alpha})[SETTLED:]

    exact = solution(FINEST)
    errors = np.array([np.max(np.abs(solution(h) - exact), axis=0) for h in STEPS])
    for name, column in zip(OUTPUTS, errors.T):
        if name in DRIVES[drive][3]:
            # What the host imposes is only interpolated, and better than to second order.
            assert np.all(column < 1e-12) or fitted_order(STEPS, column) > 2.5
        else:
            assert fitted_order(STEPS, column) == pytest.approx(2, abs=0.15), f"{name}: {column}"


@pytest.mark.parametrize("alpha", [0.0, -0.1, -1 / 3])
@pytest.mark.parametrize(
    "drive", ["Force", "Displacement, derivatives", "Displacement, targets", "Wire, damped, targets"]
)
def test_every_alpha_is_of_second_order(pantograph, drive, alpha):
    test_error_falls_with_the_square_of_the_step(pantograph, drive, alpha)


@pytest.mark.parametrize("drive", DRIVES)
def test_steps_of_changing_size_are_of_second_order_too(pantograph, drive):
    """Communication steps of 0.7 h and 1.3 h in turn, each one internal step; values every 0.1 s."""
    parameters, kind, inputs, imposed = DRIVES[drive]

    def solution(step: float) -> np.ndarray:
        p, rows = pantograph(SMOOTH | parameters | {"solver.step": 1.3 * step}), []
        for n in range(1, round(0.8 / (2 * step)) + 1):
            p.run(0.7 * step, 1, [], **{kind: inputs})
            row = p.run(1.3 * step, 1, OUTPUTS, **{kind: inputs})[0]
            if n % round(0.05 / step) == 0:
                rows.append(row)
        return np.array(rows)

    steps = [2.5e-3, 1.25e-3, 6.25e-4]
    exact = history(pantograph, drive, FINEST)[4::5]
    errors = np.array([np.max(np.abs(solution(h) - exact), axis=0) for h in steps])
    for name, column in zip(OUTPUTS, errors.T):
        if name not in imposed:
            assert fitted_order(steps, column) == pytest.approx(2, abs=0.2), f"{name}: {column}"


def test_bench_receptance_and_force_are_of_second_order(pantograph):
    frequency, acceleration, steps = 3.0, 1.0, [4e-3, 2e-3, 1e-3, 5e-4]

    def point(step: float) -> tuple[complex, float]:
        p = pantograph(SMOOTH | {"drive": "Bench", "solver.step": step})
        h = bench_point(p, frequency, acceleration)
        return h, p["contact.force"]

    (exact_h, exact_force), points = point(FINEST), [point(h) for h in steps]
    # The grid has a whole number of steps per period: the step that is really taken, not the one asked for.
    taken = [1 / (frequency * np.ceil(1 / (frequency * h))) for h in steps]
    assert fitted_order(taken, [abs(h - exact_h) for h, _ in points]) == pytest.approx(2, abs=0.15)
    assert fitted_order(taken, [abs(f - exact_force) for _, f in points]) == pytest.approx(2, abs=0.15)


def test_many_internal_steps_per_communication_step_are_of_second_order_too(pantograph):
    """A quadratic input is followed exactly, so one long step must give the motion of many short ones."""

    def force_and_position(step: float) -> np.ndarray:
        p = pantograph(SMOOTH | {"drive": "Force", "solver.step": step})
        p.set_derivatives("contact_force", 100.0, -400.0)
        p.step(0.5)
        return p.reals(["head.z", "lower_frame.z", "zspring.alpha"])

    exact = force_and_position(FINEST)
    errors = np.array([np.abs(force_and_position(h) - exact) for h in STEPS])
    for column in errors.T:
        assert fitted_order(STEPS, column) == pytest.approx(2, abs=0.15)
