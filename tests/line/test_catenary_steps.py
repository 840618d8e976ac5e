"""Communication steps of any length on the line: slivers, many lengths in turn, jumps of the force, the line's end."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Discard, fmi2Terminated

from catenary_line import Line, parameters_of
from harness import Instance, fitted_order, refusal

POINTS = [f"point.uplift[{i}]" for i in range(1, 5)]
# Few long elements, whose waves the steps resolve.
LINE = Line(spans=2, element=6.0, damping_mass=0.1, damping_stiffness=1e-3)


def standing(catenary: Callable[..., Instance], step: float, alpha: float = -0.1) -> Instance:
    """A line under one pantograph that stays at 30 m."""
    points = {f"point.position[{i}]": x for i, x in enumerate((10.0, 30.0, 55.0, 75.0), start=1)}
    return catenary(
        parameters_of(LINE)
        | points
        | {"travel": "Position", "pantograph[1].position": 30.0, "solver.step": step, "solver.alpha": alpha}
    )


def hump(t: float) -> float:
    """N, smooth, for 0.4 s."""
    return 80.0 * np.sin(np.pi * t / 0.4) ** 4 if 0 < t < 0.4 else 0.0


def follow(p: Instance, lengths: Sequence[float]) -> np.ndarray:
    """The points' uplifts (m) after each of these steps (s), under the hump."""
    rows = []
    for length in lengths:
        p["pantograph[1].force"] = hump(p.time + length)
        p.step(length)
        rows.append(p.reals(POINTS))
    return np.array(rows)


def test_slivers_among_usual_steps_change_nothing(catenary):
    """Of 10 ns among 1 ms, as a host makes them whose grid meets an event."""
    even = follow(standing(catenary, 1e-3), [1e-3] * 400)
    uneven = follow(standing(catenary, 1e-3), [1e-3, 1e-8] * 400)[::2]
    np.testing.assert_allclose(uneven, even, atol=1e-4 * np.abs(even).max())


def test_many_lengths_in_turn_give_the_motion_of_even_steps(catenary):
    """More than the FMU keeps factors of, three times around the order of the lengths."""
    lengths = [1e-3, 0.9e-3, 0.8e-3, 0.7e-3, 0.6e-3, 0.5e-3]
    turns = 80
    even = follow(standing(catenary, 1e-3), [sum(lengths) / 6] * 6 * turns)[5::6]
    uneven = follow(standing(catenary, 1e-3), lengths * turns)[5::6]
    np.testing.assert_allclose(uneven, even, atol=1e-3 * np.abs(even).max())


@pytest.mark.parametrize("alpha", [-0.1, -0.3])
def test_steps_of_changing_size_are_of_second_order(catenary, alpha):
    """Long and short steps in turn, 3 to 1, against steps that are much finer."""
    reference = follow(standing(catenary, 1.25e-4, alpha), [1.25e-4] * 3840)[159::160]
    steps, errors = [1 / 50, 1 / 100, 1 / 200], []
    for step in steps:
        pairs = round(0.04 / step / 2)
        found = follow(standing(catenary, step, alpha), [1.5 * step / 2, 0.5 * step / 2] * pairs * 12 * 2)
        every = len(found) // 24
        errors.append(np.abs(found[every - 1 :: every] - reference).max())
    assert fitted_order(steps, errors) > 1.8


@pytest.mark.parametrize("alpha", [-0.1, -0.3])
def test_a_force_that_jumps_costs_no_order(catenary, alpha):
    """On at 0 s and off at 0.2 s, between two steps each time: held by input derivatives of 0.

    Waves that the coarser steps hardly resolve cost a part of the second order.
    """

    def motion(count: int) -> np.ndarray:
        p = standing(catenary, 0.02 / count, alpha)
        rows = []
        for n in range(20):
            p["pantograph[1].force"] = 80.0 if n < 10 else 0.0
            p.set_derivatives("pantograph[1].force", 0.0)
            for _ in range(count):
                p.step(0.02 / count)
            rows.append(p.reals(POINTS))
        return np.array(rows)

    counts = [8, 16, 32]
    reference = motion(512)
    errors = [np.abs(motion(n) - reference).max() for n in counts]
    assert fitted_order([1 / n for n in counts], errors) > 1.6


@pytest.mark.parametrize("steps", [1, 3])
def test_a_pantograph_that_runs_off_the_line_is_discarded_with_its_end(catenary, steps):
    """Also in a communication step of a single internal one."""
    p = catenary(
        {"line.spans": 2, "pantograph[1].start": 119.97, "pantograph[1].speed": 50.0, "pantograph[1].force": 100.0}
    )
    assert refusal(p.slave.doStep, 0.0, 1e-3 * steps) == fmi2Discard
    assert p.slave.getBooleanStatus(fmi2Terminated)
    assert p["pantograph[1].x"] == 119.97
