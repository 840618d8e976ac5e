"""The FMU against an independent pantograph, written from the energy, for random parameters and inputs."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Fmu, Signal
from reference import Reference

MOTION = [
    "head.z",
    "head.v",
    "upper_frame.z",
    "upper_frame.v",
    "lower_frame.z",
    "lower_frame.v",
    "zspring.alpha",
    "zspring.beta",
    "zspring.force",
    "contact.force",
]
ENERGY = ["energy.kinetic", "energy.elastic", "energy.dissipated"]
UNTIL, POINTS = 0.6, 60
SCALED = [
    "m1",
    "m2",
    "m3",
    "c3",
    "k1",
    "k2",
    "zspring.k",
    "zspring.l0",
    "zspring.L1",
    "zspring.L2",
    "zspring.J1",
    "zspring.J2",
    "zspring.Mf",
    "static_force",
    "gravity",
]


def random_case(fmu: Fmu, drive: str, seed: int) -> tuple[dict, dict[str, Signal]]:
    """Parameters scaled by up to 1.25 either way, dampers, smooth friction, inputs."""
    rng = np.random.default_rng(seed)
    factors = 1.25 ** rng.uniform(-1, 1, len(SCALED))
    parameters = {name: fmu.start(name) * factor for name, factor in zip(SCALED, factors)}
    parameters |= {
        "drive": drive,
        "c1": rng.uniform(0, 30),
        "c2": rng.uniform(0, 30),
        "k3": rng.uniform(0, 200),
        "zspring.tau": rng.uniform(2, 8),
    }
    rods = parameters["zspring.L1"] + parameters["zspring.L2"] + parameters["zspring.l0"]
    parameters["zspring.d"] = rods * rng.uniform(0.97, 1.02)

    def tones(amplitude: float, offset: float = 0.0) -> Signal:
        return Signal.cubed_sines(amplitude * rng.uniform(-1, 1, 3), rng.uniform(0.5, 3, 3), offset)

    f0 = parameters["static_force"]
    inputs = {"uplift.head": tones(10), "uplift.upper_frame": tones(10), "uplift.lower_frame": tones(10)}
    match drive:
        case "Force":
            inputs["contact_force"] = tones(60, f0)
        case "Displacement":
            inputs["head_displacement"] = tones(0.02)
        case "Wire":
            parameters |= {"contact.k": rng.uniform(2e3, 1e4), "contact.c": rng.uniform(0, 100)}
            inputs["wire_height"] = tones(0.01)
    return parameters, inputs


def columns_and_scales(solution: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Reference values, shape (points, variables), and the range each variable runs through."""
    values = np.column_stack([solution[name] for name in MOTION + ENERGY])
    return values, np.ptp(values, axis=0)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire"])
def test_motion_converges_to_the_independent_solution_at_second_order(fmu, pantograph, drive, seed):
    parameters, inputs = random_case(fmu, drive, seed)
    times = np.linspace(0, UNTIL, POINTS + 1)[1:]
    exact, scale = columns_and_scales(Reference(fmu, parameters).solve(times, inputs))

    def computed(step: float) -> np.ndarray:
        p = pantograph(parameters | {"solver.step": step})
        every = round(times[0] / step)
        return p.run(step, every * POINTS, MOTION + ENERGY, signals=inputs)[every - 1 :: every]

    coarse, fine = computed(5e-4), computed(2.5e-4)
    coarse_error = np.max(np.abs(coarse - exact) / scale, axis=0)
    fine_error = np.max(np.abs(fine - exact) / scale, axis=0)
    imposed = {"Force": ["contact.force"], "Displacement": ["head.z", "head.v"], "Wire": []}[drive]
    # Half the step, a quarter of the error; what is left after removing the h^2 term is of higher order.
    extrapolated = np.max(np.abs((4 * fine - coarse) / 3 - exact) / scale, axis=0)
    for name, c, f, e in zip(MOTION + ENERGY, coarse_error, fine_error, extrapolated):
        if name not in imposed:
            assert 3.2 < c / f < 5, f"{name}: error {c:.1e} at h, {f:.1e} at h/2"
            assert e < 0.2 * f, f"{name}: error {f:.1e} at h/2, {e:.1e} extrapolated"
    assert fine_error.max() < 2e-3


def test_the_default_pantograph_with_the_steep_friction_law_agrees(fmu, pantograph):
    inputs = {"head_displacement": Signal.cubed_sines([0.02], [1.5])}
    times = np.linspace(0, UNTIL, POINTS + 1)[1:]
    exact, scale = columns_and_scales(Reference(fmu, {"drive": "Displacement"}).solve(times, inputs))
    p = pantograph({"drive": "Displacement", "solver.step": 2e-4})
    every = round(times[0] / 2e-4)
    error = np.abs(p.run(2e-4, every * POINTS, MOTION + ENERGY, signals=inputs)[every - 1 :: every] - exact) / scale
    assert error.max() < 5e-3


@pytest.mark.parametrize("drive", ["Force", "Displacement"])
def test_the_linear_suspension_agrees(fmu, pantograph, drive):
    parameters, inputs = random_case(fmu, drive, 7)
    parameters |= {"suspension": "Linear"}
    names = ["head.z", "head.v", "upper_frame.z", "lower_frame.z", "contact.force", "energy.elastic"]
    times = np.linspace(0, UNTIL, POINTS + 1)[1:]
    solution = Reference(fmu, parameters).solve(times, inputs)
    step = 1e-4
    p = pantograph(parameters | {"solver.step": step})
    every = round(times[0] / step)
    result = p.run(step, every * POINTS, names, signals=inputs)[every - 1 :: every]
    for name, column in zip(names, result.T):
        assert np.max(np.abs(column - solution[name])) < 5e-4 * np.ptp(solution[name]), name
