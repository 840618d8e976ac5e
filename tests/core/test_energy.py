"""Energy bookkeeping: kinetic + elastic + dissipated = work, and friction only ever takes energy away."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Signal, fitted_order

BALANCE = ["energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work"]
INPUTS = {
    "Force": {
        "contact_force": Signal.cubed_sines([60.0], [1.3], 120.0),
        "uplift.upper_frame": Signal.cubed_sines([30.0], [1.7]),
    },
    "Displacement": {
        "head_displacement": Signal.cubed_sines([0.02], [1.3]),
        "uplift.lower_frame": Signal.cubed_sines([30.0], [1.7]),
    },
    "Wire": {"wire_height": Signal.cubed_sines([0.004], [1.3]), "uplift.head": Signal.cubed_sines([15.0], [1.7])},
    "Bench": {},
}
FRICTION = ["Regularized", "Coulomb", "Locked", "Free"]


def energies(pantograph, parameters: dict, step: float, until: float = 1.0) -> np.ndarray:
    """Kinetic, elastic, dissipated, work (J) every 0.02 s; shape (points, 4)."""
    p = pantograph(parameters | {"solver.step": step, "bench.frequency": 3.0, "bench.acceleration": 4.0})
    every = round(0.02 / step)
    return p.run(step, round(until / step), BALANCE, signals=INPUTS[parameters["drive"]])[every - 1 :: every]


def imbalance(history: np.ndarray) -> float:
    return np.max(np.abs(history[:, :3].sum(axis=1) - history[:, 3]))


@pytest.mark.parametrize("suspension", ["ZSpring", "Linear", "LinearLocked", "LinearFree"])
@pytest.mark.parametrize("drive", INPUTS)
def test_energy_balances_at_second_order_on_smooth_motion(pantograph, drive, suspension):
    parameters = {
        "drive": drive,
        "suspension": suspension,
        "zspring.tau": 3.0,
        "contact.k": 5e3,
        "contact.c": 50.0,
        "c1": 20.0,
    }
    steps = [4e-3, 2e-3, 1e-3, 5e-4]
    histories = [energies(pantograph, parameters, h) for h in steps]
    errors = [imbalance(history) for history in histories]
    assert errors[-1] < 1e-3 * np.ptp(histories[-1][:, 3])
    assert fitted_order(steps, errors) > 1.7


@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("drive", INPUTS)
def test_energy_balances_with_every_friction_law(pantograph, drive, friction):
    """Stick and slip are not smooth: the balance holds within a small share of the work done."""
    history = energies(pantograph, {"drive": drive, "friction": friction}, 5e-4)
    assert imbalance(history) < 5e-3 * np.ptp(history[:, 3])
    assert imbalance(energies(pantograph, {"drive": drive, "friction": friction}, 2.5e-4)) < 0.75 * imbalance(history)


def test_an_undamped_pantograph_keeps_its_energy(pantograph):
    """No damper, no friction, trapezoidal rule: once the inputs are static again nothing is lost or won."""
    p = pantograph({"friction": "Free", "c3": 0.0, "solver.alpha": 0.0, "solver.step": 5e-4})
    p["contact_force"] = 150.0
    p.step(0.1)
    p["contact_force"] = 120.0
    history = p.run(0.01, 300, BALANCE)
    stored = history[:, 0] + history[:, 1]
    assert np.all(history[:, 2] == 0)
    assert np.ptp(stored - (history[:, 3] - history[0, 3])) < 1e-3 * stored.max()


def test_the_trapezoidal_rule_keeps_the_energy_of_a_linear_pantograph_exactly(pantograph):
    undamped = {"suspension": "LinearFree", "c3": 0.0, "solver.alpha": 0.0, "solver.tolerance": 1e-12}
    p = pantograph(undamped)
    p["uplift.lower_frame"] = 100.0
    p.step(0.1)
    p["uplift.lower_frame"] = 0.0
    history = p.run(0.01, 500, BALANCE)
    total = history[:, 0] + history[:, 1] - (history[:, 3] - history[0, 3])
    assert np.ptp(total) < 1e-9 * (history[:, 0] + history[:, 1]).max()


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("drive", INPUTS)
def test_dissipated_energy_never_decreases(pantograph, drive, friction):
    p = pantograph({"drive": drive, "friction": friction, "bench.acceleration": 4.0})
    history = p.run(0.002, 1000, ["energy.dissipated"], signals=INPUTS[drive])
    assert np.all(np.diff(history[:, 0]) >= 0)
    assert history[-1, 0] > 1e-3


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("drive", INPUTS)
def test_friction_opposes_the_motion_of_the_rods(pantograph, drive, friction):
    """Moment times rod velocity is never negative; the velocity comes from the output derivative."""
    p = pantograph({"drive": drive, "friction": friction, "bench.acceleration": 4.0})
    rods = [p.reference(f"zspring.{rod}") for rod in ("alpha", "beta")]
    moments = ["zspring.moment_alpha", "zspring.moment_beta"]
    power = []
    for _n in range(500):
        for name, signal in INPUTS[drive].items():
            p[name] = signal(p.time)
            p.set_derivatives(name, signal(p.time, 1), signal(p.time, 2))
        p.step(0.002)
        power.append(np.array(p.slave.getRealOutputDerivatives(rods, [1, 1])) * p.reals(moments))
    assert np.min(power) >= 0
    assert np.max(power) > 0
