"""A wire that gives way to the force at the end of the step: solved with contact, frame and rods."""

from __future__ import annotations

import numpy as np
import pytest

from harness import PRECISE, Pantograph, Signal, differences, refusal

WIRE = Signal.cubed_sines([0.012], [1.3])
HUMP = Signal.cubed_sines([0.12], [2.1])  # which the head loses
COMPLIANT = {"drive": "Wire", "wire.compliance": 2e-6}
MOVED = ["contact.force", "head.z", "head.v", "upper_frame.z", "zspring.alpha", "energy.work", "energy.dissipated"]


def run(p: Pantograph, heights: np.ndarray, size: float, **others: float) -> np.ndarray:
    """Outputs MOVED (n, 7) after each step, with that wire at its end."""
    rows = []
    for height in heights:
        p.set({"wire_height": height, **others})
        p.step(size)
        rows.append(p.reals(MOVED))
    return np.array(rows)


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("path", [WIRE, HUMP], ids=["wire", "hump"])
def test_a_wire_on_springs_is_a_softer_contact(pantograph, path, friction):
    """Springs in series: the same where a communication step is one internal step, contact lost or not."""
    size, compliance, k = 1e-3, 4e-5, 50000.0
    heights = np.array([path(size * (n + 1)) for n in range(900)])
    common = {"drive": "Wire", "friction": friction, "solver.step": size}
    stiff = pantograph(PRECISE | common | {"contact.k": k, "wire.compliance": compliance})
    soft = pantograph(PRECISE | common | {"contact.k": k / (1 + k * compliance)})
    found = run(stiff, heights - compliance * 120.0, size)
    expected = run(soft, heights, size)
    assert (expected[:, 0] == 0).any() == (path is HUMP)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("size", [0.5e-3, 5e-3])
@pytest.mark.parametrize("path", [WIRE, HUMP], ids=["wire", "hump"])
def test_the_wire_is_where_its_own_force_takes_it(pantograph, path, size):
    """Told as targets, the heights that follow from the forces at begin and end give the same run."""
    compliance, previous = 3e-6, 2e-6
    common = PRECISE | {"drive": "Wire", "friction": "Coulomb", "solver.step": 5e-4, "contact.c": 20.0}
    both = {"wire.compliance": compliance, "wire.compliance_previous": previous}
    p, plain = pantograph(common | both), pantograph(common)
    free = np.array([path(size * (n + 1)) for n in range(round(0.9 / size))]) - (compliance + previous) * 120.0
    found = run(p, free, size)
    forces = np.concatenate([[120.0], found[:, 0]])
    expected = run(plain, free + previous * forces[:-1] + compliance * forces[1:], size)
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-8)


def test_the_run_begins_in_the_static_state_whatever_the_wire_will_do(pantograph):
    p = pantograph({**COMPLIANT, "wire_height": 0.3}, initialize=False)
    p.initialize()
    assert p["contact.force"] == pytest.approx(120.0, abs=1e-12)
    assert p["head.a"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("size", [0.5e-3, 4e-3])
@pytest.mark.parametrize("wire", [0.0, -0.02, 0.1], ids=["pressed", "pressed more", "lost"])
def test_directional_derivatives_are_differences(pantograph, fmu, size, wire):
    """By the wire's height and both compliances, and by a force, with the wire giving way to it."""
    common = {"friction": "Regularized", "zspring.tau": 20.0, "contact.c": 20.0, "solver.step": 1e-3}
    p = pantograph(PRECISE | COMPLIANT | common | {"wire.compliance_previous": 1e-6})
    for n in range(40):
        p["wire_height"] = WIRE(size * (n + 1)) + (wire if n > 35 else 0.0) - 3e-6 * 120.0
        p.step(size)
    outputs = fmu.continuous_outputs()
    deltas = {"wire_height": 1e-6, "wire.compliance": 1e-9, "wire.compliance_previous": 1e-9, "uplift.head": 1e-2}
    expected = {name: differences(p, outputs, name, delta, size) for name, delta in deltas.items()}
    p.step(size)
    assert p["contact.closed"] == (wire != 0.1)
    references = [p.reference(name) for name in outputs]
    for name, column in expected.items():
        found = np.array(p.slave.getDirectionalDerivative(references, [p.reference(name)], [1.0]))
        noise = 1e-10 * (np.abs(p.reals(outputs)) + 1e-3) / deltas[name]
        assert np.all(np.abs(found - column) <= 2e-4 * np.abs(column) + noise), name


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Bench"])
@pytest.mark.parametrize("name", ["wire.compliance", "wire.compliance_previous"])
def test_no_other_drive_has_a_wire_that_gives_way(pantograph, drive, name):
    p = pantograph({"drive": drive})
    p[name] = 1e-6
    assert refusal(p.slave.doStep, p.time, 1e-3) != 0
    assert f"{name} = 1e-06 m/N: must be 0 but in drive Wire" in p.log[-1].text


def test_a_wire_does_not_come_to_meet_the_head(pantograph):
    p = pantograph(COMPLIANT)
    assert refusal(p.slave.setReal, [p.reference("wire.compliance")], [-1e-9]) != 0
    assert "wire.compliance = -1e-09 m/N: must be at least 0" in p.log[-1].text
