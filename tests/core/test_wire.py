"""Drive Wire: unilateral penalty contact, its loss and its return."""

from __future__ import annotations

import numpy as np
import pytest

from harness import PRECISE, Pantograph, Signal

OUTPUTS = ["head.z", "head.v", "contact.force"]
SHAKEN = Signal([(0.012, 2 * np.pi * 7.0, 0.0)])  # the head, with its upper frame, cannot follow this


def shaken(
    pantograph, step: float = 5e-4, count: int = 4000, **parameters
) -> tuple[Pantograph, np.ndarray, np.ndarray]:
    """A wire shaken so hard that contact is lost again and again; OUTPUTS and closed, after each step."""
    p = pantograph({"drive": "Wire", "solver.step": step} | parameters)
    rows, closed = [], []
    for _n in range(count):
        rows.append(p.run(step, 1, OUTPUTS, signals={"wire_height": SHAKEN})[0])
        closed.append(p["contact.closed"])
    return p, np.array(rows), np.array(closed)


@pytest.mark.parametrize("damping", [0.0, 100.0])
@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
def test_contact_is_lost_and_regained_and_never_pulls(pantograph, friction, damping):
    _, rows, closed = shaken(pantograph, friction=friction, **{"contact.c": damping})
    force = rows[:, 2]
    assert np.all(force >= 0)
    assert np.all(force[~closed] == 0)
    assert np.all(closed[force > 0])
    changes = np.diff(closed.astype(int))
    assert np.sum(changes == -1) >= 3 and np.sum(changes == 1) >= 3


@pytest.mark.parametrize("damping", [0.0, 100.0])
def test_the_penalty_law_holds_at_every_communication_point(pantograph, damping):
    """force = max(0, static_force + k (z - wire) + c (v - wire')), with the outputs' own z and v.

    The wire is a chain of parabolas without gaps, so that its position and velocity are known exactly.
    """
    step = 5e-4
    p = pantograph(PRECISE | {"drive": "Wire", "contact.c": damping, "solver.step": step})
    wire, rate, open_steps = 0.0, 0.0, 0
    for n in range(2000):
        curvature = SHAKEN(n * step, 2)
        p["wire_height"] = wire
        p.set_derivatives("wire_height", rate, curvature)
        p.step(step)
        wire, rate = wire + rate * step + curvature * step**2 / 2, rate + curvature * step
        z, v, force = p.reals(OUTPUTS)
        law = p["static_force"] + p["contact.k"] * (z - wire) + damping * (v - rate)
        assert force == pytest.approx(max(0.0, law), abs=1e-8)
        assert p["contact.closed"] == (force > 0)
        open_steps += law < 0
    assert 100 < open_steps < 1900


def test_a_wire_pulled_away_leaves_the_pantograph_as_with_no_contact_force(pantograph):
    """Free rise: the motion of drive Force under contact_force = 0, but for the moment of parting."""
    free, lost = pantograph({"contact_force": 0.0}), pantograph({"drive": "Wire"})
    lost["wire_height"] = 5.0
    outputs = ["head.v", "lower_frame.z", "lower_frame.v", "contact.force"]
    histories = [p.run(1e-3, 1000, outputs) for p in (free, lost)]
    assert np.all(histories[1][1:, 3] == 0)
    assert not lost["contact.closed"]
    assert np.max(np.abs(histories[1] - histories[0])[1:, :3] / np.ptp(histories[0][:, :3], axis=0)) < 0.02


def test_a_free_head_rises_by_the_closed_form(pantograph):
    """Nothing ties the pantograph to the base and no wire is near: a constant uplift accelerates its centre.

    Momentum is uplift times time; the centre of gravity rises by uplift t^2 / 2 over the total mass.
    """
    p = pantograph(
        {
            "drive": "Wire",
            "friction": "Free",
            "c3": 0.0,
            "k3": 0.0,
            "contact.k": 0.0,
            "static_force": 0.0,
            "wire_height": 10.0,
        }
    )
    p["uplift.upper_frame"] = 50.0
    p.step(1.0)
    masses = np.array([p["m1"], p["m2"], p["m3"]])
    momentum = masses @ p.reals(["head.v", "upper_frame.v", "lower_frame.v"])
    centre = masses @ p.reals(["head.z", "upper_frame.z", "lower_frame.z"]) / masses.sum()
    assert p["contact.force"] == 0
    assert momentum == pytest.approx(50.0, rel=1e-6)
    assert centre == pytest.approx(0.5 * 50.0 / masses.sum(), rel=1e-6)


def test_the_mean_contact_force_of_a_fixed_wire_is_the_static_force(pantograph):
    p = pantograph({"drive": "Wire"})
    p["uplift.head"] = 10.0
    p.step(0.05)
    p["uplift.head"] = 0.0
    p.step(60.0)
    assert p["contact.force"] == pytest.approx(p["static_force"], rel=1e-3)
    assert p["contact.closed"]


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Bench"])
def test_other_drives_always_report_closed_contact(pantograph, drive):
    p = pantograph({"drive": drive})
    p.step(0.1)
    assert p["contact.closed"]


def test_contact_restored_from_the_air_converges_with_the_step(pantograph):
    """Loss and return happen inside steps; the motion still converges as the step is reduced."""

    def motion(step: float) -> np.ndarray:
        every = round(5e-3 / step)
        p = pantograph({"drive": "Wire", "friction": "Free", "contact.k": 5e3, "c1": 50.0, "solver.step": step})
        return p.run(step, 60 * every, ["head.z", "lower_frame.z"], signals={"wire_height": SHAKEN})[every - 1 :: every]

    exact = motion(2.5e-5)
    coarse, fine = (np.max(np.abs(motion(h) - exact)) for h in (1e-3, 2.5e-4))
    assert fine < 0.35 * coarse
    assert fine < 1e-4
