"""Joint friction: true sticking, creep of the regularised law, and the degenerate parameters."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Signal

RODS = ["zspring.alpha", "zspring.beta"]
MOMENTS = ["zspring.moment_alpha", "zspring.moment_beta"]
SHAKE = {"head_displacement": Signal.cubed_sines([0.012], [2.0])}


def test_a_stuck_rod_does_not_move_at_all(pantograph):
    """Coulomb law, below the bound: not one bit, although the head moves and the joints carry moments."""
    p = pantograph({"drive": "Displacement", "friction": "Coulomb"})
    start = p.reals(RODS)
    history = p.run(
        0.01, 200, RODS + MOMENTS + ["head.z"], signals={"head_displacement": Signal.cubed_sines([3e-4], [2.0])}
    )
    bound = p["zspring.Mf"]
    assert np.all(history[:, :2] == start)
    assert 0.05 * bound < np.max(np.abs(history[:, 2:4])) < bound
    assert np.ptp(history[:, 4]) > 5e-4


def test_dry_friction_keeps_its_law_at_every_communication_point(pantograph):
    """A slipping rod has its moment at the bound, against the motion; a stuck one holds at most as much."""
    p = pantograph({"drive": "Displacement", "friction": "Coulomb"})
    bound, rods = p["zspring.Mf"], [p.reference(rod) for rod in RODS]
    slipped = stuck = 0
    for _ in range(500):
        moments = p.run(0.002, 1, MOMENTS, signals=SHAKE)[0]
        for rate, moment in zip(p.slave.getRealOutputDerivatives(rods, [1, 1]), moments):
            if rate == 0:
                assert abs(moment) <= bound
                stuck += 1
            else:
                assert moment == pytest.approx(np.sign(rate) * bound, rel=1e-12)
                slipped += 1
    assert slipped > 100 and stuck > 100


def test_a_slipped_rod_sticks_again_where_it_stops(pantograph):
    p = pantograph({"drive": "Displacement", "friction": "Coulomb", "c3": 2000.0, "c2": 500.0})
    start = p.reals(RODS)
    p.run(0.002, 250, RODS, signals={"head_displacement": Signal.cubed_sines([0.012], [0.5])})
    p.set_derivatives("head_displacement", 0.0, 0.0)
    p.step(30.0)
    stopped = p.reals(RODS)
    p.step(10.0)
    assert np.all(np.abs(stopped - start) > 1e-4)
    assert np.all(p.reals(RODS) == stopped)


@pytest.mark.parametrize("share", [0.25, 0.5])
def test_the_regularised_law_creeps_at_its_stated_rate(pantograph, share):
    """Under a held moment M a rod turns at atanh(M / Mf) / tau: 0.55 mrad/s at half the bound."""
    held = {"k2": 1e10, "k3": 1e10}
    p = pantograph(held | {"drive": "Displacement", "solver.step": 1e-3})
    p["head_displacement"] = 0.0
    slope = _moment_per_displacement(pantograph, held)
    p["head_displacement"] = share * p["zspring.Mf"] / slope
    p.step(0.1)
    before = np.concatenate([p.reals(RODS), p.reals(MOMENTS)])
    p.step(0.002)
    after = np.concatenate([p.reals(RODS), p.reals(MOMENTS)])
    rate = (after - before)[:2] / 0.002
    moment = (after + before)[2:] / 2
    expected = np.arctanh(moment / p["zspring.Mf"]) / p["zspring.tau"]
    assert np.all(np.abs(moment) > 0.8 * share * p["zspring.Mf"])
    np.testing.assert_allclose(rate, expected, rtol=1e-3)


def _moment_per_displacement(pantograph, parameters: dict) -> float:
    """Moment that holds a locked alpha rod, per head displacement (N)."""
    p = pantograph(parameters | {"drive": "Displacement", "friction": "Locked"})
    p["head_displacement"] = 1e-5
    p.step(0.5)
    return abs(p["zspring.moment_alpha"]) / 1e-5


def test_a_steeper_regularised_law_tends_to_dry_friction(pantograph):
    def positions(friction: str, tau: float = 1000.0) -> np.ndarray:
        p = pantograph({"drive": "Displacement", "friction": friction, "zspring.tau": tau, "solver.step": 5e-4})
        return p.run(0.002, 500, ["zspring.alpha", "zspring.beta"], signals=SHAKE)

    dry = positions("Coulomb")
    errors = [np.max(np.abs(positions("Regularized", tau) - dry)) for tau in (1e2, 1e3, 1e4)]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]
    assert errors[2] < 2e-2 * np.ptp(dry)


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb", "Free"])
def test_rods_without_inertia_are_the_limit_of_light_rods(pantograph, friction):
    def force(inertia: float) -> np.ndarray:
        p = pantograph(
            {
                "drive": "Displacement",
                "friction": friction,
                "zspring.J1": inertia,
                "zspring.J2": inertia,
                "solver.step": 5e-4,
            }
        )
        return p.run(0.002, 500, ["contact.force"], signals=SHAKE)

    massless = force(0.0)
    errors = [np.mean(np.abs(force(inertia) - massless)) for inertia in (1e-6, 1e-8)]
    assert errors[0] < 1e-3 * np.ptp(massless)
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
def test_no_friction_bound_is_free_rods(pantograph, friction):
    def motion(parameters: dict) -> np.ndarray:
        p = pantograph({"drive": "Displacement"} | parameters)
        return p.run(0.002, 300, [*RODS, "contact.force"], signals=SHAKE)

    np.testing.assert_allclose(
        motion({"friction": friction, "zspring.Mf": 0.0}), motion({"friction": "Free"}), rtol=1e-5
    )


@pytest.mark.parametrize(
    "absent",
    [
        {"zspring.J1": 0.0, "zspring.J2": 0.0},
        {"zspring.Mf": 0.0},
        {"c1": 0.0, "c2": 0.0, "c3": 0.0},
        {"k3": 0.0},
        {"m3": 0.0, "k3": 1e9, "c3": 0.0},
        {"zspring.J1": 0.0, "zspring.J2": 0.0, "zspring.Mf": 0.0, "c1": 0.0, "c2": 0.0, "c3": 0.0, "k3": 0.0},
    ],
)
@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire", "Bench"])
def test_parameters_that_vanish_leave_a_model_that_works(pantograph, drive, friction, absent):
    """It runs, converges without halving, keeps the energy balance, and responds to its drive."""
    p = pantograph(absent | {"drive": drive, "friction": friction, "solver.step": 1e-3})
    inputs = {
        "Force": {"contact_force": Signal.cubed_sines([20.0], [2.0], 120.0)},
        "Displacement": SHAKE,
        "Wire": {"wire_height": Signal.cubed_sines([2e-3], [2.0])},
        "Bench": {},
    }[drive]
    names = ["energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work", "contact.force"]
    history = p.run(0.002, 500, names, signals=inputs)
    assert np.all(np.isfinite(history))
    assert p["solver.refinements"] == 0
    work = np.ptp(history[:, 3])
    assert np.max(np.abs(history[:, :3].sum(axis=1) - history[:, 3])) < 0.02 * work
    assert np.ptp(history[:, 4]) > 1.0


def test_the_lower_frame_rises_when_the_contact_force_is_too_small(pantograph):
    """k3 of 0.1 N/m hardly holds it: it climbs at about (static_force - contact_force) / c3."""
    p = pantograph()
    p["contact_force"] = 106.0
    p.step(10.0)
    assert p["lower_frame.v"] == pytest.approx(14.0 / p["c3"], rel=0.05)
    assert p["head.v"] == pytest.approx(p["lower_frame.v"], rel=0.05)
