"""Lines from a table: like spans as by parameters, closed forms, and an independent model on lines of every kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter

from any_line import LINES, STITCHED, UNLIKE, AnyLine, supported, table
from catenary_line import COMPLETE, parameters_of
from catenary_reference import Solver
from harness import Fmu, Instance
from zspring.line_table import LineTable

G = 9.81
WIRES = {
    "contact_wire.mass": 1.35,
    "contact_wire.tension": 22e3,
    "contact_wire.EI": 195.0,
    "messenger.mass": 1.08,
    "messenger.tension": 16e3,
    "messenger.EI": 131.7,
    "damping.mass": 0.0125,
    "damping.stiffness": 1e-4,
    "gravity": G,
    "mesh.element": 1.0,
}
HEIGHTS = [f"point.height[{i}]" for i in range(1, 9)]
UPLIFTS = [f"point.uplift[{i}]" for i in range(1, 9)]


@cache
def independent(name: str) -> AnyLine:
    return AnyLine(LINES[name], WIRES)


@pytest.fixture
def line_of(fmu_catenary: Fmu, tmp_path) -> Iterator[Callable[..., Instance]]:
    """Makes instances of a table: line_of(table, parameters)."""
    made = []

    def make(line: LineTable, parameters=None, **options) -> Instance:
        copy = fmu_catenary.with_line(line.content, tmp_path / f"line {line.digest} {len(made)}")
        made.append(Instance(copy, WIRES | (parameters or {}), **options))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


def loads(forces: dict[float, float], points=()) -> dict[str, float]:
    """At most two forces (N) by position (m), and up to eight points."""
    placed = {f"point.position[{i}]": x for i, x in enumerate(points, start=1)}
    for i, (x, force) in enumerate(forces.items(), start=1):
        placed |= {f"pantograph[{i}].force": force, f"pantograph[{i}].start": x}
    return placed


def test_like_spans_by_a_table_are_those_by_parameters(catenary, line_of):
    """To the last bit, in motion, with droppers that slacken."""
    span, n = COMPLETE.span, COMPLETE.spans
    sags, places = COMPLETE.dropper_sag, COMPLETE.dropper_position
    like = table(
        supported(*(span * np.arange(n + 1)), messenger=lambda x: COMPLETE.encumbrance),
        [(i * span + x, 0, -sag, {"EA": COMPLETE.dropper_EA}) for i in range(n) for x, sag in zip(places, sags)],
    )
    run = loads({0.8 * span: 200.0}, np.linspace(10, 150, 8)) | {"pantograph[1].speed": 60.0}
    outputs = [
        *UPLIFTS,
        *HEIGHTS,
        "pantograph[1].wire_height",
        "droppers.force_min",
        "energy.elastic",
        "energy.kinetic",
    ]
    targets = {"pantograph[1].force": lambda t: 250 + 200 * np.sin(30 * t)}
    by_parameters, by_table = (
        model.run(2e-3, 400, outputs, targets=targets)
        for model in (catenary(parameters_of(COMPLETE) | run), line_of(like, run))
    )
    np.testing.assert_array_equal(by_table, by_parameters)
    assert np.any(by_table[:, outputs.index("droppers.force_min")] == 0)


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("force", [0.0, 120.0, 700.0])
def test_any_line_has_the_statics_of_an_independent_one(line_of, name, force):
    line, reference = LINES[name], independent(name)
    points = np.array([5.0, 52.0, 77.3, 100.0, 131.0, 150.5, 178.0, 199.0])
    for x in (70.0, 113.0, 119.0, 170.0):
        forces = {x: force, x - 44.5: 0.5 * force}
        found = line_of(line, loads(forces, points))
        u, lifted, tension = reference.equilibrium(list(forces), list(forces.values()))
        at = reference.wires[0].at
        close = {"rel": 1e-6, "abs": 1e-8}
        assert found.reals(HEIGHTS) == pytest.approx(
            at(points) @ (u + reference.shape) + reference.irregularity(points), **close
        )
        assert found.reals(UPLIFTS) == pytest.approx(at(points) @ u, **close)
        upper = reference.wires[1].at(points) @ (lifted + reference.messenger_shape) + reference.above(points)
        assert found.reals([f"point.messenger_height[{i}]" for i in range(1, 9)]) == pytest.approx(upper, **close)
        nearest = [np.argmin(np.abs(line.droppers["x"] - p)) for p in points]
        places = found.reals([f"point.dropper_position[{i}]" for i in range(1, 9)])
        np.testing.assert_array_equal(places, line.droppers["x"][nearest])
        forces_there = found.reals([f"point.dropper_force[{i}]" for i in range(1, 9)])
        assert forces_there == pytest.approx(tension[nearest], rel=1e-6, abs=1e-9)
        assert found["droppers.force_max"] == pytest.approx(tension.max(), rel=1e-6)
        assert found["droppers.force_min"] == pytest.approx(tension.min(), rel=1e-5, abs=1e-9)
        assert found["droppers.slack"] == np.sum(tension == 0)
    assert (found["droppers.slack"] > 0) == (force == 700 or name == "irregular")


def test_points_move_between_steps_and_tell_of_all_wires(line_of):
    """The wires' whole shape at one time, eight places at once; a stitch wire under the messenger, the ends held."""
    p, reference = line_of(STITCHED), independent("stitched")
    places = np.linspace(0, reference.length, 160)
    outputs = [f"point.{name}[{i}]" for i in range(1, 9) for name in ("height", "messenger_height", "stitch_height")]
    shape = []
    for eight in places.reshape(-1, 8):
        p.set({f"point.position[{i}]": x for i, x in enumerate(eight, start=1)})
        shape.append(p.reals(outputs).reshape(8, 3))
    contact, messenger, stitch = np.concatenate(shape).T
    upper = reference.wires[1]
    inside = np.any([(places > s["begin"]) & (places < s["end"]) for s in STITCHED.stitches], axis=0)
    expected = upper.at(places[inside], "stitch") @ reference.messenger_shape + reference.above(places[inside])
    assert stitch[inside] == pytest.approx(expected, rel=1e-9)
    np.testing.assert_array_equal(stitch[~inside], messenger[~inside])
    assert np.all(stitch[inside] < messenger[inside]) and np.all(contact < stitch)
    assert (contact[0], contact[-1], messenger[0]) == (0.0, 0.0, 1.6)


def test_a_line_that_rises_ends_where_it_is_held(line_of):
    p = line_of(UNLIKE, loads({}, [0.0, 215.0]))
    assert p.reals(HEIGHTS[:2]) == pytest.approx([0.0, 0.215], abs=1e-12)
    assert p.reals(["point.messenger_height[1]", "point.messenger_height[2]"]) == pytest.approx([1.3, 1.515], rel=1e-9)


@pytest.mark.parametrize("name", LINES)
def test_any_line_moves_as_an_independent_one(line_of, name):
    """Under two forces that run along it and slacken droppers."""
    line, reference = LINES[name], independent(name)
    step, begin, speed = 2e-3, np.array([60.0, 25.0]), np.array([70.0, 55.0])
    points = np.array([30.0, 48.0, 61.0, 80.5, 113.0, 120.0, 140.0, 170.0])

    def force(t: float) -> np.ndarray:
        return np.array([250 + 200 * np.sin(40 * t), 150 - 150 * np.cos(25 * t)])

    expected = Solver(reference, step, -0.1, points=points).run(500, lambda t: begin + speed * t, force)
    given = loads(dict(zip(begin, force(0.0))), points) | {f"pantograph[{i + 1}].speed": v for i, v in enumerate(speed)}
    p = line_of(line, given | {"solver.step": step, "solver.alpha": -0.1})
    outputs = ["pantograph[1].wire_height", "pantograph[2].wire_height", *UPLIFTS, "energy.kinetic", "energy.elastic"]
    found = p.run(
        step, 500, outputs, targets={f"pantograph[{i}].force": lambda t, i=i: force(t)[i - 1] for i in (1, 2)}
    )
    for column, value in zip(found.T, np.column_stack([expected.wire, expected.points, expected.energy])[1:].T):
        np.testing.assert_allclose(column, value, atol=1e-7 * np.abs(value).max())
    assert np.sum(expected.tension == 0, axis=1).max() > 1


def test_a_stitched_messenger_without_bending_stiffness_is_that_of_beams_to_half_a_percent(line_of):
    """Elasticity with a fine mesh, against beams with the messenger's bending stiffness along the stitch as well."""
    wires = WIRES | {"mesh.element": 0.5}
    reference, places = AnyLine(STITCHED, wires, strings=False), [113.0, 117.4, 120.0, 129.0, 150.0]
    found = [line_of(STITCHED, wires | loads({x: 100.0}))["pantograph[1].uplift"] for x in places]
    uplift = [(reference.wires[0].at(x) @ reference.equilibrium([x], [100.0])[0])[0] for x in places]
    assert found == pytest.approx(uplift, rel=5e-3)


def test_a_dropper_on_a_stitch_wire_pulls_that_and_the_messenger(line_of):
    """Closed form: a contact wire that hardly has a tension, on one stiff dropper in the middle of a stitch wire.

    Under F the stitch wire of tension Ts rises by F L / (4 Ts) over its clamps, L apart, and each clamp, where the
    messenger has T outside and stays level between them, by F / 2 times its distance from the anchor over T.
    """
    length, begin, end, T, Ts, F = 40.0, 14.0, 26.0, 16e3, 2800.0, 1.0
    line = table(
        supported(0, length, messenger=lambda x: 1.5),
        [(20.0, 1.0, 0.0, {"stiffness": 1e9, "mass": 0.0, "clamp_contact": 30.0})],
        stitches=[(begin, end, Ts, 0.31, 0.0)],
    )
    wires = {"contact_wire.tension": 1.0, "contact_wire.EI": 0.0, "contact_wire.mass": 0.01, "messenger.EI": 0.0}
    found = line_of(line, wires | loads({20.0: F}))["pantograph[1].uplift"]
    assert found == pytest.approx(F * (end - begin) / (4 * Ts) + F / 2 * begin / T, rel=2e-3)


def test_a_wave_meets_a_point_mass_as_on_a_string(line_of):
    """What comes as f(t) makes y' = 2 T / (c m) (f - y) of the mass: y goes on, y - f comes back."""
    T, mass, m, c = 20e3, 1.35, 8.0, np.sqrt(20e3 / 1.35)
    line = table(supported(0, 240, arm=(0, 0)), masses=[(108.0, 0, m)])
    string = {"contact_wire.tension": T, "contact_wire.mass": mass, "contact_wire.EI": 1e-3}
    still = {"damping.mass": 0.0, "damping.stiffness": 0.0, "gravity": 0.0, "mesh.element": 0.25}
    at = {"travel": "Position", "pantograph[1].position": 100.0, "solver.step": 2.5e-4, "solver.alpha": 0.0}
    p = line_of(line, string | still | at | {"point.position[1]": 104.0, "point.position[2]": 116.0})
    step, F, duration, fine = 1e-3, 100.0, 0.1, 2000
    found = p.run(
        step,
        360,
        UPLIFTS[:2],
        targets={"pantograph[1].force": lambda t: F * np.sin(np.pi * t / duration) ** 4 if t < duration else 0.0},
    )
    t = np.arange(0, 0.36, step / fine * 20)
    force = np.where(t < duration, F * np.sin(np.pi * np.minimum(t, duration) / duration) ** 4, 0.0)
    sent = np.cumsum(force) * (t[1] - t[0]) * c / (2 * T)
    kappa = 2 * T / (c * m)
    decay = np.exp(-kappa * (t[1] - t[0]))
    followed = lfilter([1 - decay], [1, -decay], sent)

    def later(wave: np.ndarray, distance: float) -> np.ndarray:
        return np.interp(step * np.arange(1, 361) - distance / c, t, wave, left=0.0)

    exact = np.column_stack([later(sent, 4.0) + later(followed - sent, 12.0), later(followed, 16.0)])
    np.testing.assert_allclose(found, exact, atol=3e-3 * exact.max())
    assert np.abs(exact[:, 0] - later(sent, 4.0)).max() > 0.2 * exact.max()


def test_elasticity_over_unlike_spans_is_that_of_a_string_on_springs(line_of):
    """A contact wire without droppers on its steady arms: the springs' forces from the string's influence function."""
    T, L, arms = 20e3, 160.0, np.array([37.0, 62.0, 121.0])
    stiffness = np.array([400.0, 900.0, 250.0])
    inner = [(x, 1.3, 5e5, 0.0, k) for x, k in zip(arms, stiffness)]
    line = table([(0.0, 1.3, 0, 0, 0), *inner, (L, 1.3, 0, 0, 0)])

    def influence(x, at):
        return np.minimum(x, at) * (L - np.maximum(x, at)) / (T * L)

    string = {"contact_wire.tension": T, "contact_wire.EI": 1e-3, "mesh.element": 0.1}
    for x in (20.0, 50.0, 62.0, 90.0, 140.0):
        to_arms = influence(x, arms)
        held = np.linalg.solve(np.diag(1 / stiffness) + influence(arms[:, None], arms), to_arms)
        found = line_of(line, string | loads({x: 100.0}))["pantograph[1].uplift"] / 100
        assert found == pytest.approx(influence(x, x) - to_arms @ held, rel=3e-3)
