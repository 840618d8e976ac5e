"""The overhead line at rest: closed forms, an independent finite-element line, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Discard, fmi2Error

from catenary_line import COMPLETE, Line, parameters_of
from harness import Fmu, refusal

G = 9.81
MASS, TENSION, EI = 1.35, 20e3, 195.0  # contact wire of EN 50318:2002
POINTS = [f"point.height[{i}]" for i in range(1, 9)]


def beam(x: float, at: float, length: float, tension: float, bending: float, terms: int = 20_000) -> float:
    """Deflection (m) at x of a tensioned beam, w = w'' = 0 at both ends, under 1 N at `at`: its modes."""
    k = np.arange(1, terms + 1) * np.pi / length
    return float(np.sum(2 / length * np.sin(k * x) * np.sin(k * at) / (tension * k**2 + bending * k**4)))


def own_sag(length: float, mass: float, tension: float, bending: float, terms: int = 20_000) -> float:
    """Sag (m) at the middle of the same beam under its own weight."""
    n = np.arange(1, terms + 1)
    k = n * np.pi / length
    load = 2 * mass * G / length * (1 - np.cos(n * np.pi)) / k
    return float(np.sum(load * np.sin(n * np.pi / 2) / (tension * k**2 + bending * k**4)))


def under(catenary, line: Line, forces: dict[float, float], points=(), **parameters):
    """An instance at rest under at most two forces (N) by position (m)."""
    loads = {}
    for i, (x, force) in enumerate(forces.items(), start=1):
        loads |= {f"pantograph[{i}].force": force, f"pantograph[{i}].start": x}
    positions = {f"point.position[{i}]": x for i, x in enumerate(points, start=1)}
    return catenary(parameters_of(line) | positions | loads | parameters)


# Closed forms


def test_the_bare_wire_deflects_as_a_tensioned_beam(catenary):
    line = Line(spans=1, span=50.0, dropper_position=(), dropper_sag=(), element=0.1)
    points = (5.0, 20.3, 33.0)
    loaded = under(catenary, line, {20.3: 150.0}, points)
    exact = [150.0 * beam(x, 20.3, 50.0, TENSION, EI) for x in points]
    found = loaded.reals([f"point.uplift[{i}]" for i in (1, 2, 3)])
    assert found[[0, 2]] == pytest.approx([exact[0], exact[2]], rel=1e-8)
    assert found[1] == pytest.approx(exact[1], rel=1e-4)  # under the load: the kink lies inside an element
    assert loaded["pantograph[1].uplift"] == found[1]


def test_two_forces_superpose_on_the_bare_wire(catenary):
    line = Line(spans=1, span=50.0, dropper_position=(), dropper_sag=(), element=0.5)
    both = under(catenary, line, {20.0: 150.0, 31.0: 90.0}, (20.0, 31.0))
    names = ["point.uplift[1]", "point.uplift[2]"]
    single = [under(catenary, line, load, (20.0, 31.0)).reals(names) for load in ({20.0: 150.0}, {31.0: 90.0})]
    assert both.reals(names) == pytest.approx(single[0] + single[1], rel=1e-12)
    assert single[0][1] / 150 == pytest.approx(single[1][0] / 90, rel=1e-10)  # Maxwell


def test_the_bare_wire_sags_as_a_tensioned_beam(catenary):
    line = Line(spans=1, span=50.0, dropper_position=(), dropper_sag=(), element=0.5)
    height = under(catenary, line, {}, (25.0,))["point.height[1]"]
    assert height == pytest.approx(-own_sag(50.0, MASS, TENSION, EI), rel=1e-6)


def test_between_level_droppers_the_wire_sags_as_a_clamped_tensioned_beam(catenary):
    """Droppers 6 m apart throughout, so that the slope is 0 at each far from the ends."""
    line = Line(dropper_position=np.arange(3.0, 60.0, 6.0), dropper_sag=(0.0,) * 10, element=0.1)
    level = under(catenary, line, {}, (300.0, 303.0, 306.0))
    q, d, kappa = MASS * G, 6.0, np.sqrt(TENSION / EI)
    sag = q * d**2 / (8 * TENSION) - q * d / (2 * TENSION * kappa) * np.tanh(kappa * d / 4)
    assert level.reals(POINTS[:3]) == pytest.approx([-sag, 0.0, -sag], rel=1e-4, abs=1e-12)


def test_the_droppers_carry_the_wire_and_its_clamps(catenary):
    """Level droppers 6 m apart: each carries 6 m of wire, a clamp, and half of itself; the ends differ."""
    line = Line(dropper_position=np.arange(3.0, 60.0, 6.0), dropper_sag=(0.0,) * 10, clamp_contact=0.165)
    level = under(catenary, line, {})
    middle = (6.0 * MASS + 0.165) * G
    assert level["droppers.force_max"] == pytest.approx(middle, rel=0.02)
    assert level["droppers.slack"] == 0
    heavy = under(catenary, replace(line, dropper_mass=0.1, encumbrance=5.0), {})
    longest = 0.1 * 5.0 / 2 * G
    gained = heavy["droppers.force_max"] - level["droppers.force_max"]
    assert 0.8 * longest < gained < longest


def test_pre_sag_is_met_at_the_droppers_and_unloads_them(catenary):
    """Without bending each carries the weight of its part, less tension times the change of slope there."""
    position, sag = np.arange(5.0, 60.0, 5.0), 0.055 * np.sin(np.pi * np.arange(5.0, 60.0, 5.0) / 60) ** 2
    line = Line(dropper_position=position, dropper_sag=sag, contact_wire=(MASS, TENSION, 0.1), element=0.1)
    sagged = under(catenary, line, {}, 240 + position[1:9])
    assert sagged.reals(POINTS) == pytest.approx(-sag[1:9], abs=1e-12)
    z = np.concatenate([[0.0], -sag, -sag[:1]])  # at x = 0, 5 .. 55, and 5 m into the next span
    x = np.concatenate([[0.0], position, [65.0]])
    force = MASS * G * (x[2:] - x[:-2]) / 2 - TENSION * np.diff(np.diff(z) / np.diff(x))
    assert sagged["droppers.force_min"] == pytest.approx(force.min(), rel=1e-3)


def test_one_dropper_joins_two_wires_in_parallel_until_it_slackens(catenary):
    """Stiffnesses of the wires at their middles in closed form; slack, the contact wire is alone."""
    line = Line(spans=1, dropper_position=(30.0,), dropper_sag=(0.0,), dropper_stiffness=2e4, element=0.1)
    kc = 1 / beam(30, 30, 60, TENSION, EI)
    km = 1 / beam(30, 30, 60, line.messenger[1], line.messenger[2])
    static = own_sag(60, MASS, TENSION, EI) * kc
    series = 1 / (1 / 2e4 + 1 / km)
    slackening = static * (1 + kc / series)
    at_rest = under(catenary, line, {})
    assert at_rest["droppers.force_max"] == pytest.approx(static, rel=2e-4)
    for force in (0.5 * slackening, 0.99 * slackening):
        taut = under(catenary, line, {30.0: force})
        uplift = force / (kc + series)
        assert taut["pantograph[1].uplift"] == pytest.approx(uplift, rel=1e-3)
        assert taut["droppers.force_min"] == pytest.approx(static - series * uplift, abs=1e-3 * static)
        assert taut["droppers.slack"] == 0
    for force in (1.01 * slackening, 2 * slackening):
        slack = under(catenary, line, {30.0: force})
        assert slack["pantograph[1].uplift"] == pytest.approx((force - static) / kc, rel=1e-3)
        assert (slack["droppers.slack"], slack["droppers.force_min"]) == (1, 0.0)


# The independent line

LINES = {
    "EN 50318:2002": Line(spans=4),
    "all parts": COMPLETE,
    "soft and uneven": Line(
        spans=3,
        dropper_position=(3.2, 21.0, 40.7),
        dropper_sag=(0.01, 0.03, 0.0),
        dropper_stiffness=2e3,
        support_stiffness=2e3,
        element=3.0,
    ),
}


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("force", [120.0, 600.0])
def test_any_line_has_the_statics_of_an_independent_one(catenary, name, force):
    """Elasticity, uplift of the supports, tensions, and which droppers are slack, at several places."""
    line = LINES[name]
    points = line.length * np.array([0.02, 0.3, 0.45, 0.5, 0.52, 0.6, 0.77, 0.9])
    supports = [f"support.uplift[{i}]" for i in range(2, line.spans + 1)]
    slack = 0
    for x in line.span * np.array([1.13, 1.5, 1.98, 2.0]):
        forces = {x: force, x - 0.7 * line.span: 0.5 * force}
        found = under(catenary, line, forces, points)
        u, _, tension = line.equilibrium(list(forces), list(forces.values()))
        at = line.wires[0].at
        close = {"rel": 1e-7, "abs": 1e-10}
        assert found["pantograph[1].wire_height"] == pytest.approx((at(x) @ (u + line.shape))[0], **close)
        assert found["pantograph[2].uplift"] == pytest.approx((at(x - 0.7 * line.span) @ u)[0], **close)
        assert found.reals(POINTS) == pytest.approx(at(points) @ (u + line.shape), **close)
        assert found.reals(supports) == pytest.approx(at(line.supports) @ u, **close)
        assert found["droppers.force_max"] == pytest.approx(tension.max(), rel=1e-7)
        assert found["droppers.force_min"] == pytest.approx(tension.min(), rel=1e-6, abs=1e-9)
        assert found["droppers.slack"] == np.sum(tension == 0)
        slack += np.sum(tension == 0)
    assert slack > 0 or force == 120


def test_a_force_at_an_anchor_moves_nothing_and_beside_it_little(catenary):
    """In the first and the last element, whose ends are held."""
    line = Line(spans=2)
    for place in (0.0, 1e-6, 0.1, 0.5, 0.9):
        for x in (place, line.length - place):
            found = under(catenary, line, {x: 120.0})
            u, _, _ = line.equilibrium([x], [120.0])
            height = (line.wires[0].at(x) @ (u + line.shape))[0]
            assert found["pantograph[1].wire_height"] == pytest.approx(height, rel=1e-7, abs=1e-10)
            assert found["support.uplift[1]"] == found["support.uplift[3]"] == 0.0
            assert abs(height) < 0.005


def test_a_force_that_runs_up_to_the_anchor_leaves_it_where_it_is(catenary):
    line = Line(spans=2)
    p = under(catenary, line, {90.0: 120.0}, **{"pantograph[1].speed": 50.0})
    found = p.run(0.001, 600, ["pantograph[1].wire_height", "support.uplift[3]"])
    assert p["pantograph[1].x"] == pytest.approx(line.length, rel=1e-9)
    assert np.all(found[:, 1] == 0.0)
    assert found[-1, 0] == pytest.approx(0.0, abs=1e-8)
    assert np.all(np.abs(np.diff(found[:, 0])) < 1e-3)


def test_the_line_has_the_length_of_its_spans_and_rests_at_its_static_height(catenary):
    line = Line(spans=7)
    p = under(catenary, line, {123.4: 0.0})
    assert p["line.length"] == 420.0
    assert p["pantograph[1].wire_height"] == pytest.approx(line.static_height(123.4)[0], rel=1e-9)
    assert p["pantograph[1].uplift"] == p["energy.elastic"] == p["energy.kinetic"] == 0.0


def test_elastic_energy_is_the_work_of_the_slowly_grown_force(catenary):
    """Integral of force over uplift, with droppers that slacken on the way."""
    line = LINES["EN 50318:2002"]
    force = np.linspace(0.0, 600.0, 41)
    states = [under(catenary, line, {90.0: f}) for f in force]
    uplift = [s["pantograph[1].uplift"] for s in states]
    assert states[-1]["droppers.slack"] > 0
    work = np.trapezoid(force, uplift)
    assert states[-1]["energy.elastic"] == pytest.approx(work, rel=1e-4)


# Refusals


@pytest.mark.parametrize(
    "parameters, complaint",
    [
        ({"dropper.sag[5]": 0.5}, "dropper"),
        ({"dropper.position[3]": 10.0}, "dropper.position"),
        ({"dropper.position[9]": 60.5}, "dropper.position"),
        ({"line.span": 0.0}, "line.span"),
        ({"contact_wire.tension": -1.0}, "contact_wire.tension"),
        ({"line.encumbrance": 0.5}, "encumbrance"),
        ({"pantograph[1].start": -1.0, "pantograph[1].force": 100.0}, "pantograph"),
    ],
)
def test_a_line_that_cannot_be_is_refused_with_one_line(catenary, parameters, complaint):
    p = catenary(initialize=False)
    for call in (lambda: p.set(parameters), p.slave.enterInitializationMode, p.slave.exitInitializationMode):
        if status := refusal(call):
            break
    assert status == fmi2Error
    assert len(p.log) == 1 and complaint in p.log[0].text and "\n" not in p.log[0].text


def test_a_force_beyond_the_line_is_refused_and_the_state_unharmed(catenary):
    line = Line(spans=2)
    moving = {"pantograph[1].speed": 100.0}
    p, twin = (under(catenary, line, {110.0: 120.0}, **moving) for _ in range(2))
    for instance in (p, twin):
        instance.run(0.01, 9, ["pantograph[1].x"])
    assert refusal(p.slave.doStep, p.time, 0.05) == fmi2Discard
    log = p.log + twin.log  # fmpy hands the lines of all instances to the newest
    assert len(log) == 1 and "pantograph[1].x" in log[0].text and "\n" not in log[0].text
    for instance in (p, twin):
        instance["pantograph[1].force"] = 0.0
        instance.step(0.01)  # the force ends with the line
        instance.step(0.1)
    assert p.all_values() == twin.all_values()
    assert p["pantograph[1].x"] == pytest.approx(130.0)


def test_defaults_are_the_reference_case(fmu_catenary: Fmu):
    """Numbers of EN 50318:2002 that all sources agree on."""
    start = fmu_catenary.start
    assert (start("line.spans"), start("line.span"), start("line.encumbrance")) == (10, 60.0, 1.2)
    assert (start("contact_wire.mass"), start("contact_wire.tension")) == (1.35, 20e3)
    assert (start("messenger.mass"), start("messenger.tension")) == (1.07, 16e3)
    assert (start("dropper.count"), start("dropper.stiffness")) == (9, 1e5)
    position = [start(f"dropper.position[{i}]") for i in range(1, 10)]
    assert position == [5, 10.5, 17, 23.5, 30, 36.5, 43, 49.5, 55]
