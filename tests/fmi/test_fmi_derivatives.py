"""Output derivatives, and directional derivatives of a step, against differences."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Error

from harness import PRECISE, Pantograph, Signal, differences, refusal
from models import each_case_but

# Drive, its input, the size of the difference.
DRIVES = {
    "Force": ("contact_force", 1e-2),
    "Displacement": ("head_displacement", 1e-6),
    "Wire": ("wire_height", 1e-6),
    "Bench": (None, 0.0),
}


@pytest.fixture
def outputs(fmu) -> list[str]:
    """Every continuous Real output."""
    return fmu.continuous_outputs()


INPUTS = {
    "Force": {"contact_force": Signal.cubed_sines([40.0], [1.2], 120.0)},
    "Displacement": {"head_displacement": Signal.cubed_sines([0.01], [1.2])},
    "Wire": {"wire_height": Signal.cubed_sines([0.003], [1.2])},
    "Bench": {},
}


def in_motion(pantograph, parameters: dict) -> Pantograph:
    """An instance that has been moved about for a while."""
    p = pantograph(PRECISE | parameters)
    inputs = INPUTS[parameters["drive"]]
    p.run(0.005, 53, [], signals=inputs)
    for name in inputs:
        p.set_derivatives(name, 0.0, 0.0)
    return p


@pytest.mark.parametrize("wire", [0.0, 0.1])
@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire"])
def test_derivatives_before_the_first_step_are_those_of_the_state_of_rest(pantograph, outputs, drive, wire):
    """Of all outputs by all inputs of the drive, with the wire at the head and far above it."""
    p = pantograph({"drive": drive, "wire_height": wire}, initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    inputs = [DRIVES[drive][0], *(f"uplift.{m}" for m in ("head", "upper_frame", "lower_frame"))]

    references = [p.reference(name) for name in outputs]
    moved = 0
    for name in inputs:
        delta, value, ends = 1e-6, p[name], []
        for shifted in (value + delta, value - delta):
            p[name] = shifted
            ends.append(p.reals(outputs))
        p[name] = value
        expected = (ends[0] - ends[1]) / (2 * delta)
        found = p.slave.getDirectionalDerivative(references, [p.reference(name)], [1.0])
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6, err_msg=name)
        moved += np.any(expected != 0)
    assert moved >= 1
    if drive == "Wire":
        index = outputs.index("contact.force")
        by_height = p.slave.getDirectionalDerivative(references, [p.reference("wire_height")], [1.0])[index]
        assert by_height == (-p["contact.k"] if wire == 0.0 else 0.0)


@pytest.mark.parametrize("size", [0.001, 0.002, 0.05])
@pytest.mark.parametrize("friction", ["Regularized", "Coulomb", "Free", "Locked"])
@pytest.mark.parametrize("drive", DRIVES)
def test_directional_derivatives_of_a_step_are_its_differences(pantograph, outputs, drive, friction, size):
    """Up to 25 internal steps in a step; for the drive's own input and for each uplift.

    Springs and dampers are of a size that matters: k3 starts at 0.1 N/m, which no difference would show.
    """
    dampers = {"c1": 10.0, "c2": 20.0, "contact.c": 50.0, "k3": 2000.0}
    smooth = {"zspring.tau": 20.0, "bench.acceleration": 3.0}
    p = in_motion(pantograph, dampers | smooth | {"drive": drive, "friction": friction})
    own, delta = DRIVES[drive]
    knowns = {own: delta} if own else {}
    knowns |= {"uplift.head": 1e-2, "uplift.upper_frame": 1e-2, "uplift.lower_frame": 1e-2}
    expected = {name: differences(p, outputs, name, delta, size) for name, delta in knowns.items()}
    p.step(size)
    unknowns = [p.reference(name) for name in outputs]
    for name, columns in expected.items():
        found = p.slave.getDirectionalDerivative(unknowns, [p.reference(name)], [1.0])
        for output, f, e in zip(outputs, found, columns):
            noise = 1e-6 * abs(p[output]) / knowns[name] * 1e-4
            assert f == pytest.approx(e, rel=2e-3, abs=noise + 1e-12), f"d({output})/d({name})"


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire"])
@pytest.mark.parametrize("suspension", ["Linear", "LinearLocked", "LinearFree"])
def test_directional_derivatives_of_linear_suspensions_are_their_differences(pantograph, suspension, drive):
    p = in_motion(pantograph, {"drive": drive, "suspension": suspension})
    name, delta = DRIVES[drive]
    outputs = ["head.z", "head.v", "contact.force", "lower_frame.z"]
    expected = differences(p, outputs, name, delta, 0.02)
    p.step(0.02)
    found = p.slave.getDirectionalDerivative([p.reference(o) for o in outputs], [p.reference(name)], [1.0])
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-9)


def test_directional_derivatives_are_linear_in_the_direction(pantograph):
    p = in_motion(pantograph, {"drive": "Wire"})
    p.step(0.01)
    unknowns = [p.reference(n) for n in ("head.z", "contact.force")]
    knowns = [p.reference(n) for n in ("wire_height", "uplift.lower_frame")]
    columns = np.array([p.slave.getDirectionalDerivative(unknowns, [k], [1.0]) for k in knowns]).T
    np.testing.assert_allclose(p.slave.getDirectionalDerivative(unknowns, knowns, [0.3, -2.0]), columns @ [0.3, -2.0])


def test_inputs_of_other_drives_have_no_influence(pantograph):
    p = in_motion(pantograph, {"drive": "Force"})
    p.step(0.01)
    references = [p.reference(n) for n in ("wire_height", "head_displacement")]
    assert p.slave.getDirectionalDerivative([p.reference("head.z")] * 1, references, [1.0, 1.0]) == [0.0]


@each_case_but("Parallel")  # refuses, test_affine_map.py
def test_asking_for_derivatives_changes_nothing(model, instance, case):
    asked, left = instance(case.parameters), instance(case.parameters)
    output, force = asked.reference(model.moved), asked.reference(model.force)
    for _ in range(30):
        for p in (asked, left):
            p.run(0.01, 1, [], signals=case.inputs)
        asked.slave.getDirectionalDerivative([output], [force], [1.0])
        asked.slave.getRealOutputDerivatives([output], [1])
    assert asked.all_values() == left.all_values()


@pytest.mark.parametrize("drive", DRIVES)
def test_output_derivatives_are_the_slopes_of_the_outputs(pantograph, outputs, drive):
    """Against differences of a finely sampled smooth motion."""
    size = 1e-4
    smooth = {"zspring.tau": 3.0, "c1": 20.0, "contact.k": 5e3, "contact.c": 50.0, "bench.acceleration": 3.0}
    p = pantograph(PRECISE | smooth | {"drive": drive, "solver.step": size})
    p.run(size, 2600, [], signals=INPUTS[drive])
    references = [p.reference(name) for name in outputs]
    rows, slopes = [], []
    for _ in range(200):
        rows.append(p.run(size, 1, outputs, signals=INPUTS[drive])[0])
        slopes.append(p.slave.getRealOutputDerivatives(references, [1] * len(references)))
    rows, slopes = np.array(rows), np.array(slopes)
    expected = (rows[2:] - rows[:-2]) / (2 * size)
    for name, found, e in zip(outputs, slopes[1:-1].T, expected.T):
        assert np.max(np.abs(found - e)) <= 0.02 * np.max(np.abs(e)) + 1e-9, name


def test_the_slope_of_the_position_is_the_velocity(pantograph):
    p = in_motion(pantograph, {"drive": "Force"})
    p.step(0.01)
    slopes = p.slave.getRealOutputDerivatives([p.reference(n) for n in ("head.z", "head.v", "lower_frame.z")], [1] * 3)
    np.testing.assert_allclose(slopes, p.reals(["head.v", "head.a", "lower_frame.v"]), rtol=1e-12)


def test_what_does_not_vary_may_be_of_any_kind(pantograph):
    """OMSimulator names all dependencies of an unknown, enumerations among them, with a direction of 0."""
    p = pantograph({"drive": "Wire"})
    p.step(1e-3)
    force = [p.reference("contact.force")]
    known = [p.reference(name) for name in ("drive", "static_force", "wire_height", "solver.max_iterations")]
    alone = p.slave.getDirectionalDerivative(force, [known[2]], [1.0])
    assert p.slave.getDirectionalDerivative(force, known, [0.0, 0.0, 1.0, 0.0]) == alone
    assert refusal(p.slave.getDirectionalDerivative, force, known, [0.0, 1.0, 1.0, 0.0]) == fmi2Error
    assert "static_force: must be an input" in p.log[-1].text
