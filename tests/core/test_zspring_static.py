"""The Z-spring at rest: static angle, closed forms of both stiffnesses, geometries without stable rest."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Error

from harness import refusal
from linear import ZSpringLinear

SHAPES = [
    {},
    {"zspring.L1": 0.05, "zspring.L2": 0.1},
    {"static_force": 0.0},
    {"gravity": 0.0, "static_force": 250.0},
    {"zspring.d": 0.155},
    {"zspring.k": 40000.0, "zspring.l0": 0.0, "m1": 15.0},
]


@pytest.mark.parametrize("shape", SHAPES)
def test_at_the_static_angle_the_spring_carries_head_and_static_force(pantograph, shape):
    p = pantograph(shape)
    z = ZSpringLinear.of(p)
    load = p["m1"] * p["gravity"] + p["static_force"]
    assert z.tension > 0
    assert z.tension * np.sin(z.theta) == pytest.approx(load, rel=1e-10)
    assert p["zspring.alpha"] == p["zspring.beta"] == p["zspring.theta"]
    assert p["zspring.length"] == pytest.approx(z.length, rel=1e-12)
    assert p["zspring.force"] == pytest.approx(z.tension, rel=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
def test_both_stiffnesses_have_their_closed_form(pantograph, shape):
    p = pantograph(shape)
    z = ZSpringLinear.of(p)
    assert p["zspring.k_locked"] == pytest.approx(z.k_locked, rel=1e-9)
    assert p["zspring.k_free"] == pytest.approx(z.k_free, rel=1e-9)
    assert p["zspring.k_free"] <= p["zspring.k_locked"]


def test_the_default_head_is_as_stiff_as_the_published_one_when_locked_and_half_when_free(pantograph):
    p = pantograph()
    assert p["zspring.k_locked"] == pytest.approx(p["k1"], rel=0.005)
    assert p["zspring.k_free"] == pytest.approx(p["k1"] / 2, rel=0.005)


@pytest.mark.parametrize("friction, stiffness", [("Locked", "zspring.k_locked"), ("Free", "zspring.k_free")])
def test_a_slowly_moved_head_meets_the_closed_form_stiffness(pantograph, friction, stiffness):
    """Frames held by a stiff base: force over displacement, by differences of +/- 0.1 mm reached slowly."""
    held = {"k2": 1e10, "k3": 1e10, "c3": 0.0}
    force = {}
    for displacement in (-1e-4, 1e-4):
        p = pantograph(held | {"drive": "Displacement", "friction": friction, "solver.step": 1e-3})
        p["head_displacement"] = displacement
        p.step(1.0)
        force[displacement] = np.mean(p.run(1e-3, 600, ["contact.force"])[100:])
    measured = (force[-1e-4] - force[1e-4]) / 2e-4
    assert measured == pytest.approx(p[stiffness], rel=1e-3)


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire"])
@pytest.mark.parametrize("friction", ["Regularized", "Coulomb", "Locked", "Free"])
def test_the_static_state_is_at_rest(pantograph, drive, friction):
    p = pantograph({"drive": drive, "friction": friction})
    p.step(2.0)
    assert np.max(np.abs(p.reals(["head.z", "upper_frame.z", "lower_frame.z"]))) < 1e-9
    assert p["contact.force"] == pytest.approx(p["static_force"], abs=1e-5)


def test_the_linear_suspension_reports_no_z_spring(pantograph):
    p = pantograph({"suspension": "Linear"})
    assert [p["zspring.theta"], p["zspring.k_locked"], p["zspring.k_free"]] == [0, 0, 0]


@pytest.mark.parametrize(
    "shape",
    [
        {"gravity": 0.0, "static_force": 0.0, "zspring.d": 0.16},  # no load: the spring hangs slack
        {"gravity": 0.0, "static_force": 0.0, "zspring.d": 0.12},  # rods overlap
    ],
)
def test_a_geometry_without_stable_static_state_is_refused(pantograph, shape):
    p = pantograph(shape, initialize=False)
    p.slave.setupExperiment()
    status = refusal(p.slave.enterInitializationMode) or refusal(p.slave.exitInitializationMode)
    assert status == fmi2Error
    assert "zspring" in p.log[-1].text and "tension" in p.log[-1].text
