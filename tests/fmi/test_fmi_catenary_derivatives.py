"""Derivatives of the catenary, of a step with respect to inputs and of outputs in time, against differences."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from harness import Instance, differences

LINE = {"line.spans": 3, "damping.mass": 0.02, "damping.stiffness": 1e-3, "steady_arm.mass": 0.5}
FORCES = {"pantograph[1].force": 250.0, "pantograph[2].force": 150.0}
TRAVELS = {
    "Speed": {"pantograph[1].start": 50.3, "pantograph[2].start": 101.2, "pantograph[1].speed": 60.0},
    "Position": {"travel": "Position", "pantograph[1].position": 50.3, "pantograph[2].position": 101.2},
}
# Size of the difference by the end of the input's name.
DELTAS = {"force": 1e-2, "speed": 1e-3, "position": 1e-5}


def inputs(travel: str) -> list[str]:
    kinds = ("force", "speed" if travel == "Speed" else "position")
    return [f"pantograph[{i}].{kind}" for i in (1, 2) for kind in kinds]


def in_motion(catenary, travel: str) -> Instance:
    """Forces that make droppers slack, one pantograph at constant speed, one that accelerates."""
    p = catenary(LINE | TRAVELS[travel] | FORCES)
    for n in range(1, 41):
        t = 0.005 * n
        p["pantograph[1].force"] = 250.0 + 150.0 * np.sin(30.0 * t)
        if travel == "Position":
            p["pantograph[1].position"] = 50.3 + 60.0 * t
            p["pantograph[2].position"] = 101.2 + 40.0 * t**2
        else:
            p["pantograph[2].speed"] = 80.0 * t
        p.step(0.005)
    assert p["droppers.slack"] > 0
    return p


def directional(slave: FMU2Slave, p: Instance, outputs: list[str], name: str) -> np.ndarray:
    return np.array(slave.getDirectionalDerivative([p.reference(o) for o in outputs], [p.reference(name)], [1.0]))


def compare(found: np.ndarray, expected: np.ndarray, values: np.ndarray, delta: float, what: str) -> None:
    """To 1e-5, and to the rounding of the differences."""
    noise = 1e-11 * (np.abs(values) + 1e-3) / delta
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_array_less(np.abs(found - expected), 1e-5 * np.abs(expected) + noise + 1e-12, what)


@pytest.mark.parametrize("rates", [False, True], ids=["targets", "input derivatives"])
@pytest.mark.parametrize("size", [0.001, 0.0005, 0.013])
@pytest.mark.parametrize("travel", TRAVELS)
def test_directional_derivatives_of_a_step_are_its_differences(catenary, fmu_catenary, travel, size, rates):
    p, outputs = in_motion(catenary, travel), fmu_catenary.continuous_outputs()
    if rates:
        p.set_derivatives("pantograph[1].force", 3000.0, 1e5)
        p.set_derivatives(inputs(travel)[1], 60.0 if travel == "Position" else 5.0)
    expected = {name: differences(p, outputs, name, DELTAS[name.rsplit(".")[-1]], size) for name in inputs(travel)}
    p.step(size)
    values = p.reals(outputs)
    for name, columns in expected.items():
        delta = DELTAS[name.rsplit(".")[-1]]
        compare(directional(p.slave, p, outputs, name), columns, values, delta, name)


@pytest.mark.parametrize("travel", TRAVELS)
@pytest.mark.parametrize("first, second", [(0.4, 179.3), (179.3, 0.4)])
def test_beside_the_anchors_derivatives_are_differences_too(catenary, fmu_catenary, travel, first, second):
    """In the line's first and last element, whose outer ends do not move."""
    p = catenary(LINE | {"mesh.element": 1.0}, initialize=False)
    kind = "start" if travel == "Speed" else "position"
    p.set({"travel": travel, f"pantograph[1].{kind}": first, f"pantograph[2].{kind}": second, **FORCES})
    p.initialize()
    speeds = {first: 3.0, second: -4.0}
    outputs, size, time = fmu_catenary.continuous_outputs(), 1e-3, 0.0
    for _ in range(20):
        time += size
        for i, begin in ((1, first), (2, second)):
            name, value = ("speed", speeds[begin]) if travel == "Speed" else ("position", begin + speeds[begin] * time)
            p[f"pantograph[{i}].{name}"] = value
        p.step(size)
    expected = {name: differences(p, outputs, name, DELTAS[name.rsplit(".")[-1]], size) for name in inputs(travel)}
    p.step(size)
    for name, columns in expected.items():
        compare(directional(p.slave, p, outputs, name), columns, p.reals(outputs), DELTAS[name.rsplit(".")[-1]], name)


@pytest.mark.parametrize("travel", TRAVELS)
def test_derivatives_before_the_first_step_are_those_of_the_equilibrium(catenary, fmu_catenary, travel):
    p, outputs = catenary(LINE | TRAVELS[travel] | FORCES, initialize=False), fmu_catenary.continuous_outputs()
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    values = p.reals(outputs)
    for name in inputs(travel):
        delta, value, ends = DELTAS[name.rsplit(".")[-1]], p[name], []
        for shifted in (value + delta, value - delta):
            p[name] = shifted
            ends.append(p.reals(outputs))
        p[name] = value
        compare(directional(p.slave, p, outputs, name), (ends[0] - ends[1]) / (2 * delta), values, delta, name)


def test_inputs_of_the_other_travel_have_no_influence(catenary, fmu_catenary):
    for travel, other in (("Speed", "pantograph[1].position"), ("Position", "pantograph[1].speed")):
        p = in_motion(catenary, travel)
        assert not directional(p.slave, p, fmu_catenary.continuous_outputs(), other).any()


def test_directional_derivatives_are_linear_in_the_direction(catenary):
    p = in_motion(catenary, "Speed")
    outputs, knowns = ["pantograph[1].wire_height", "energy.work", "droppers.force_max"], inputs("Speed")
    columns = np.array([directional(p.slave, p, outputs, name) for name in knowns]).T
    direction = [0.3, -2.0, 1.0, 0.7]
    found = p.slave.getDirectionalDerivative(
        [p.reference(o) for o in outputs], [p.reference(k) for k in knowns], direction
    )
    np.testing.assert_allclose(found, columns @ direction, rtol=1e-12)


@pytest.mark.parametrize("travel", TRAVELS)
def test_output_derivatives_are_the_slopes_of_the_outputs(catenary, fmu_catenary, travel):
    """Against central differences of 400 finely sampled points of smooth motion without slack droppers."""
    size, outputs = 1e-4, fmu_catenary.continuous_outputs()
    gentle = {"pantograph[1].force": 0.0, "pantograph[2].force": 0.0, "solver.step": size, "solver.alpha": 0.0}
    p = catenary(LINE | TRAVELS[travel] | gentle | {"damping.stiffness": 0.01})
    references = [p.reference(name) for name in outputs]
    rows, slopes = [], []
    for n in range(1, 1201):
        t = n * size
        p["pantograph[1].force"] = 40.0 * np.sin(np.pi * t / 0.12) ** 4
        if travel == "Position":
            p["pantograph[1].position"] = 50.3 + 20.0 * t
        p.step(size)
        if n > 800:
            rows.append(p.reals(outputs))
            slopes.append(p.slave.getRealOutputDerivatives(references, [1] * len(references)))
    assert p["droppers.slack"] == 0
    rows, slopes = np.array(rows), np.array(slopes)
    expected = (rows[2:] - rows[:-2]) / (2 * size)
    for name, found, e in zip(outputs, slopes[1:-1].T, expected.T):
        wrong = np.abs(found - e) > 0.005 * np.max(np.abs(e)) + 1e-9
        # Kinks: a contact passes a node of the mesh, another dropper becomes the one with the least force.
        kinks = 4 if name.startswith("droppers.") or name.endswith("wire_velocity") else 0
        assert np.sum(wrong) <= kinks, name
