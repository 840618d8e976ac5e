"""The non-linear first-order FRF between its bounds: locked rods at small amplitude, free rods at large."""

from __future__ import annotations

import numpy as np
import pytest

from harness import PRECISE, Pantograph, bench_point
from linear import LinearPantograph, ZSpringLinear

AMPLITUDES = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0]
LAWS = ["Regularized", "Coulomb"]
SETTLED = 1e-6


def receptance(p: Pantograph, frequency: float, acceleration: float) -> complex:
    return bench_point(p, frequency, acceleration, settled=SETTLED)


def linear_bound(pantograph, suspension: str, frequency: float) -> complex:
    return receptance(pantograph({"drive": "Bench", "suspension": suspension}), frequency, 0.25)


@pytest.mark.parametrize("frequency", [3.0, 5.0, 8.0])
def test_stuck_rods_give_the_locked_bound(pantograph, frequency):
    """Coulomb law, an amplitude so small that nothing slips: only the geometry is left, of its order."""
    locked = linear_bound(pantograph, "LinearLocked", frequency)
    p = pantograph({"drive": "Bench", "friction": "Coulomb"})
    deviation = [abs(receptance(p, frequency, a) / locked - 1) for a in (1e-3, 1e-2)]
    assert deviation[0] < 1e-6
    assert deviation[1] < 1e-4
    assert p["energy.dissipated"] >= 0


@pytest.mark.parametrize("frequency", [3.0, 5.0, 8.0])
def test_creeping_rods_give_a_viscous_joint_at_small_amplitude(pantograph, frequency):
    """tanh(tau w) is tau w: the linear pantograph with a viscous moment Mf tau on each rod."""
    step = 2e-4
    p = pantograph(PRECISE | {"drive": "Bench", "solver.step": step})
    rods = p["zspring.J1"], p["zspring.J2"]
    damping = p["zspring.Mf"] * p["zspring.tau"]
    viscous = LinearPantograph.of(p, ZSpringLinear.of(p), rods=rods, rod_damping=damping)
    expected = viscous.receptance(frequency)
    assert abs(receptance(p, frequency, 1e-3) / expected - 1) < 1e-4
    assert abs(expected / linear_bound(pantograph, "LinearLocked", frequency) - 1) < 0.02


@pytest.mark.parametrize("friction", LAWS)
@pytest.mark.parametrize("frequency", [4.0, 7.0])
def test_the_frf_passes_from_the_locked_to_the_free_bound_as_the_amplitude_grows(pantograph, friction, frequency):
    locked, free = (linear_bound(pantograph, s, frequency) for s in ("LinearLocked", "LinearFree"))
    p = pantograph({"drive": "Bench", "friction": friction})
    curve = np.array([1 / receptance(p, frequency, a) for a in AMPLITUDES])
    from_locked, from_free = np.abs(curve * locked - 1), np.abs(curve * free - 1)
    assert np.all(np.diff(from_locked) > 0)
    assert np.all(np.diff(from_free) < 0)
    assert from_locked[0] < 0.15 * from_free[0]
    assert from_free[-1] < 0.15 * from_locked[-1]


@pytest.mark.parametrize("friction", LAWS)
def test_without_friction_bound_the_joints_are_free(pantograph, friction):
    """Mf -> 0: the distance to the free rods falls in proportion to Mf."""
    frequency, acceleration = 5.0, 2.0
    free = receptance(pantograph({"drive": "Bench", "friction": "Free"}), frequency, acceleration)

    def deviation(moment: float) -> float:
        p = pantograph({"drive": "Bench", "friction": friction, "zspring.Mf": moment})
        return abs(receptance(p, frequency, acceleration) / free - 1)

    assert deviation(0.0) < 10 * SETTLED
    large, small = deviation(0.03), deviation(0.003)
    assert 0 < small < 0.02
    assert large / small == pytest.approx(10, rel=0.15)


@pytest.mark.parametrize("friction", LAWS)
def test_with_a_huge_friction_bound_the_rods_are_locked(pantograph, friction):
    frequency, acceleration = 5.0, 2.0
    locked = receptance(pantograph({"drive": "Bench", "friction": "Locked"}), frequency, acceleration)
    p = pantograph({"drive": "Bench", "friction": friction, "zspring.Mf": 1e3})
    assert abs(receptance(p, frequency, acceleration) / locked - 1) < 1e-4


@pytest.mark.parametrize("suspension, friction", [("LinearLocked", "Locked"), ("LinearFree", "Free")])
def test_each_bound_is_the_linearisation_of_its_non_linear_head(pantograph, suspension, friction):
    """They differ by the geometry only, of second order in the amplitude for the first harmonic."""
    frequency = 5.0
    bound = linear_bound(pantograph, suspension, frequency)
    p = pantograph({"drive": "Bench", "friction": friction})
    small, large = (abs(bench_point(p, frequency, a) / bound - 1) for a in (0.5, 1.0))
    assert large < 2e-2
    assert large / small == pytest.approx(4, rel=0.2)


@pytest.mark.parametrize("acceleration", [0.25, 0.5])
def test_both_friction_laws_have_nearly_the_same_frf(pantograph, acceleration):
    """The regularised law differs from dry friction by its creep, in proportion to 1 / tau."""
    frequency = 6.0
    dry = receptance(pantograph({"drive": "Bench", "friction": "Coulomb"}), frequency, acceleration)

    def deviation(tau: float) -> float:
        p = pantograph({"drive": "Bench", "zspring.tau": tau})
        return abs(receptance(p, frequency, acceleration) / dry - 1)

    assert deviation(1e3) < 0.05
    assert deviation(1e3) / deviation(1e4) == pytest.approx(10, rel=0.1)
