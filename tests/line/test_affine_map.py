"""The wire as an affine map of the contact force: what the line tells before a step is what the step then gives."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from harness import Instance, refusal

SPEED = 250 / 3.6
LINE = {"line.spans": 4, "pantograph[1].start": 90.0, "pantograph[1].static_force": 120.0}
MAP = [f"pantograph[1].{name}" for name in ("free_height", "compliance", "compliance_previous")]
HEIGHT = "pantograph[1].wire_height"


def begun(catenary, exchange: str, size: float, **parameters: float) -> Instance:
    """At rest under 120 N; its communication step is `size` s."""
    line = {**LINE, "exchange": exchange, "exchange.step": size, "pantograph[1].force": 120.0, **parameters}
    return catenary({**line, "pantograph[1].speed": SPEED})


def force(n: int) -> float:
    """N, at the end of step n: smooth, from 120 N on."""
    return 120.0 + 25.0 * np.sin(0.13 * n)


@pytest.mark.parametrize("travel", ["Speed", "Position"])
@pytest.mark.parametrize("size", [0.5e-3, 1e-3, 7e-3])
@pytest.mark.parametrize("energies", [True, False])
def test_sequential_tells_the_height_of_every_force_at_the_end(catenary, travel, size, energies):
    """Also of forces far from those before; the step itself is that of a line which tells nothing."""
    moves = {"travel": travel, "pantograph[1].position": 90.0, "solver.energies": energies}
    lines = [begun(catenary, exchange, size, **moves) for exchange in ("Sequential", "Target")]
    largest = 0.0
    for n in range(1, 61):
        free, compliance, previous = lines[0].reals(MAP)
        begin, end = (120.0 if n == 1 else force(n - 1)), force(n) + (30.0 if n % 7 == 0 else 0.0)
        if n % 7 == 1 and n > 1:
            begin = force(n - 1) + (30.0 if (n - 1) % 7 == 0 else 0.0)
        for p in lines:
            p["pantograph[1].force"] = end
            if travel == "Position":
                p["pantograph[1].position"] = 90.0 + SPEED * size * n
            p.step(size)
        if n > 1 or travel == "Speed":  # before the first step a position does not tell the speed
            told = free + previous * begin + compliance * end
            largest = max(largest, abs(told - lines[0][HEIGHT]))
        assert lines[0].reals([HEIGHT, "energy.work"]) == pytest.approx(
            lines[1].reals([HEIGHT, "energy.work"]), abs=1e-13
        )
        assert compliance > 0 and (previous > 0) == (n == 1)
    assert largest < 1e-12  # m: no dropper changes its state


@pytest.mark.parametrize("size", [1e-3, 3e-3])
@pytest.mark.parametrize("energies", [True, False])
def test_parallel_tells_the_height_of_both_forces_to_come(catenary, size, energies):
    """Against a line in Target that is told each force at the end of its step: the map is a step ahead of it."""
    parallel, target = (begun(catenary, way, size, **{"solver.energies": energies}) for way in ("Parallel", "Target"))
    forces = [120.0, *(force(n) + (20.0 if n % 5 == 0 else 0.0) for n in range(1, 60))]
    heights, told = [target[HEIGHT]], []
    for n in range(1, 60):
        free, compliance, previous = parallel.reals(MAP)
        told.append(free + previous * forces[n - 1] + compliance * forces[n])
        parallel["pantograph[1].force"] = forces[n - 1]
        parallel.step(size)
        target["pantograph[1].force"] = forces[n]
        target.step(size)
        heights.append(target[HEIGHT])
    np.testing.assert_allclose(told, heights[1:], atol=1e-12)


@pytest.mark.parametrize("exchange", ["Sequential", "Parallel"])
@pytest.mark.parametrize("size", [1e-3, 4e-3])
def test_a_dropper_that_slackens_otherwise_than_foreseen_makes_the_step_anew(catenary, exchange, size):
    """Blows of 1500 N, and no force at all, under two pantographs: the line goes as one that foresees nothing."""
    two = {"pantograph[2].start": 30.0, "pantograph[2].static_force": 120.0, "pantograph[2].force": 120.0}
    quick = {"pantograph[2].speed": SPEED, "solver.energies": False}
    told, target = (begun(catenary, way, size, **two, **quick) for way in (exchange, "Target"))
    random = np.random.default_rng(3)
    forces = np.repeat([(120.0, 120.0), *(random.choice([0.0, 120.0, 400.0, 1500.0], size=2) for _ in range(80))], 2, 0)
    names, slack = [f"pantograph[{i}].force" for i in (1, 2)], set()
    for before, now in pairwise(forces):
        told.set(dict(zip(names, now if exchange == "Sequential" else before)))
        target.set(dict(zip(names, now)))
        for p in (told, target):
            p.step(size)
        if exchange == "Sequential" or (before == now).all():  # else Parallel has guessed wrong, and will correct it
            heights = [p.reals([HEIGHT, "pantograph[2].wire_velocity", "support.uplift[3]"]) for p in (told, target)]
            np.testing.assert_allclose(heights[0], heights[1], rtol=0, atol=1e-10)
        slack.add(target["droppers.slack"])
    assert len(slack) > 5


@pytest.mark.parametrize("exchange", ["Sequential", "Parallel"])
@pytest.mark.parametrize("alpha", [-0.05, -0.3])
def test_steps_of_any_lengths_in_turn_go_as_those_of_a_line_that_foresees_nothing(catenary, exchange, alpha):
    """Slivers included, of which HHT's memory takes no slope; each force is held for two steps."""
    lines = [begun(catenary, way, 1e-3, **{"solver.alpha": alpha}) for way in (exchange, "Target")]
    random = np.random.default_rng(5)
    before = 120.0
    for n in range(120):
        now = before if n % 2 else 120.0 + 20.0 * random.standard_normal()
        size = random.choice([1e-3, 1e-3, 2e-4, 1e-4, 1.5e-3])
        lines[0]["pantograph[1].force"] = now if exchange == "Sequential" else before
        lines[1]["pantograph[1].force"] = now
        for p in lines:
            p.step(size)
        if exchange == "Sequential" or now == before:
            a, b = (p.reals([HEIGHT, "pantograph[1].wire_velocity", "droppers.force_min"]) for p in lines)
            np.testing.assert_array_less(np.abs(a - b), [1e-12, 1e-10, 1e-8])
        before = now


def test_forces_that_change_twice_leave_no_dropper_pushing(catenary):
    """Up to the force at which the weakest dropper would slacken, and beyond it in the next step; from many states."""
    size, names, tried = 1e-3, [HEIGHT, "pantograph[1].wire_velocity", "droppers.force_min"], 0
    start = {"line.spans": 3, "pantograph[1].start": 40.0, "pantograph[1].speed": 60.0}
    lines = [begun(catenary, way, size, **start) for way in ("Parallel", "Target")]

    def go(p: Instance, force: float) -> None:
        p["pantograph[1].force"] = force
        p.step(size)

    for n in range(900):
        usual, coming = (120.0 + 30.0 * np.sin(0.05 * k) for k in (n, n + 1))
        kept, now = [p.slave.getFMUstate() for p in lines], lines[0].time

        def follow(p: Instance, forces: list[float], kept=kept, now=now) -> np.ndarray:
            p.slave.setFMUstate(kept[lines.index(p)])
            p.time = now
            for force in forces:
                go(p, force)
            return p.reals(names)

        least = follow(lines[1], [usual, usual])[2]
        slope = follow(lines[1], [usual, usual + 1.0])[2] - least
        if least > 0 and 5e-3 < abs(slope) and least / abs(slope) < 3000:
            for first, second in ((0.5, 0.8), (0.9, 0.9), (0.98, 2.0)):
                one = usual - first * least / slope
                two = one - second * least / slope
                told, target = follow(lines[0], [usual, one, two, two]), follow(lines[1], [one, two, two, two])
                np.testing.assert_array_less(np.abs(told - target), [1e-10, 1e-8, 1e-6])
                tried += 1
        for p, state, force in zip(lines, kept, (usual, coming)):  # that of the begin, and that of the end
            follow(p, [])
            go(p, force)
            p.slave.freeFMUstate(state)
    assert tried > 15


@pytest.mark.parametrize("moves", ["position", "lengths", "slackening"])
@pytest.mark.parametrize("exchange", ["Sequential", "Parallel"])
def test_a_line_set_back_before_every_step_goes_bit_for_bit_as_one_that_is_not(catenary, exchange, moves):
    """What it has foreseen is no part of its state."""
    size = 3e-3 if moves == "slackening" else 1e-3
    settings = {"travel": "Position", "pantograph[1].position": 90.0} if moves == "position" else {}
    settings |= {"solver.energies": False} if moves == "slackening" else {}
    usual, set_back = (begun(catenary, exchange, size, **settings) for _ in range(2))
    names = [name for name in usual.fmu.names("output") if usual.fmu.variables[name].type == "Real"]
    random, time = np.random.default_rng(2), 0.0
    for n in range(150):
        force = 120.0 + (300.0 if moves == "slackening" else 30.0) * random.standard_normal()
        after = (n + 1) * size * (1.0 if moves != "lengths" else 1.0 / 3.0)
        kept = set_back.slave.getFMUstate()
        set_back.slave.setFMUstate(kept)
        set_back.slave.freeFMUstate(kept)
        for p in (usual, set_back):
            p["pantograph[1].force"] = max(0.0, force)
            if moves == "position":
                p["pantograph[1].position"] = 90.0 + SPEED * after
            p.step(after - time)
        time = after
        np.testing.assert_array_equal(usual.reals(names), set_back.reals(names))


@pytest.mark.parametrize("exchange", ["Sequential", "Parallel"])
def test_a_pantograph_that_comes_later_is_mapped_from_its_first_step_on(catenary, exchange):
    later = {"pantograph[2].start": 150.0, "pantograph[2].speed": 0.0}
    p = begun(catenary, exchange, 1e-3, **later)
    told = [f"pantograph[2].{name}" for name in ("compliance", "compliance_previous")]
    assert p.reals(told).tolist() == [0.0, 0.0]
    p.step(1e-3)
    p["pantograph[2].speed"] = SPEED
    p.step(1e-3)
    compliance, previous = p.reals(told)
    assert compliance > 0 and (previous > 0) == (exchange == "Parallel")


def test_a_state_brings_the_datum_of_its_heights_along(catenary):
    """Into an instance that knew another line, and whose position is not that of the start any more."""
    line = {"travel": "Position", "pantograph[1].position": 40.0}
    p = begun(catenary, "Sequential", 1e-3, **line)
    for n in range(1, 200):
        p["pantograph[1].position"] = 40.0 + 0.06 * n
        p.step(1e-3)
    state = p.slave.getFMUstate()
    data = p.slave.serializeFMUstate(state)
    p.slave.freeFMUstate(state)
    other = catenary({**LINE, **line, "line.spans": 5}, initialize=False)
    state = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(state)
    other.slave.freeFMUstate(state)
    assert other[HEIGHT] == p[HEIGHT]


@pytest.mark.parametrize("speed", [0.0, 30.0, 80.0])
def test_a_taut_string_gives_way_by_its_impedance(catenary, speed):
    """A force that grows to F in a step H moves a string under it by F H / (4 sqrt(T m)), at any speed below sqrt(T/m).

    With G = 1/(2 m c) for |x| < c t the displacement under a force that moves slower than c is the integral of
    F/(2 sqrt(T m)) over the time since. Wire alone, no bending stiffness, no damping; a step in which the waves pass
    many elements and no support.
    """
    tension, mass, size = 20000.0, 1.35, 0.02
    bare = {"dropper.count": 0, "contact_wire.EI": 0.0, "damping.mass": 0.0, "damping.stiffness": 0.0}
    fine = {"line.spans": 2, "mesh.element": 0.1, "solver.step": 2e-4, "solver.alpha": 0.0}
    p = begun(catenary, "Sequential", size, **bare, **fine, **{"pantograph[1].start": 29.0})
    p["pantograph[1].speed"] = speed
    p.step(size)
    compliance = size / (4 * np.sqrt(tension * mass))
    assert p["pantograph[1].compliance"] == pytest.approx(compliance, rel=0.02)  # the mesh disperses


@pytest.mark.parametrize("exchange", ["Sequential", "Parallel"])
def test_forces_at_the_start_are_not_asked_for_before_they_are_known(catenary, exchange):
    """What a tool with a loop at the start would have to iterate for, and what others leave at 0."""
    told = []
    for start in (0.0, 120.0, 300.0):
        p = catenary({**LINE, "exchange": exchange, "pantograph[1].speed": SPEED}, initialize=False)
        p.slave.setupExperiment()
        p.slave.enterInitializationMode()
        p["pantograph[1].force"] = start
        told.append(p.reals([*MAP, HEIGHT]).tolist())
        p.slave.exitInitializationMode()
        p["pantograph[1].force"] = 120.0
        p.step(1e-3)
        told[-1] += p.reals([*MAP, HEIGHT, "energy.work"]).tolist()
    assert told[0] == told[1] == told[2]
    free, compliance, previous = told[0][:3]
    assert free + (compliance + previous) * 120.0 == pytest.approx(0.0, abs=1e-4)


def test_heights_count_from_the_wire_under_the_static_forces(catenary):
    forces = {"pantograph[1].static_force": 120.0, "pantograph[2].static_force": 90.0, "pantograph[2].start": 150.0}
    plain = catenary({"line.spans": 4, "pantograph[1].start": 90.0, "pantograph[2].start": 150.0})
    told = catenary({"line.spans": 4, "pantograph[1].start": 90.0, **forces})
    for p in (plain, told):
        p.step(1e-3)
    names = [f"pantograph[{i}].wire_height" for i in (1, 2)]
    static = catenary(
        {"line.spans": 4, "pantograph[1].start": 90.0, **forces, "pantograph[1].force": 120.0}
        | {"pantograph[2].force": 90.0}
    )
    np.testing.assert_allclose(static.reals(names), 0.0, atol=1e-15)
    lift = static.reals([f"pantograph[{i}].uplift" for i in (1, 2)])
    np.testing.assert_allclose(plain.reals(names) - told.reals(names), lift, atol=1e-12)


def test_another_step_than_was_told_is_said_once(catenary):
    p = begun(catenary, "Sequential", 1e-3)
    for size in (1e-3, 1e-3, 2e-3, 1e-3, 1e-3):
        p.step(size)
    lines = [message.text for message in p.log if message.category == "logStatusWarning"]
    assert len(lines) == 1 and "a communication step of 0.002 s: the affine map was told for one of 0.001 s" in lines[0]


@pytest.mark.parametrize("exchange", ["Target", "Sequential", "Parallel"])
def test_a_map_that_is_not_told_is_said_once_to_who_reads_it(catenary, exchange):
    p = begun(catenary, exchange, 1e-3)
    p.reals([HEIGHT, "pantograph[1].free_height"])
    assert not [m for m in p.log if m.category == "logStatusWarning"]
    for _ in range(2):
        p.reals(["pantograph[1].compliance", "pantograph[2].compliance_previous"])
    lines = [m.text for m in p.log if m.category == "logStatusWarning"]
    assert len(lines) == (exchange == "Target")
    assert all(line.startswith("pantograph[1].compliance: 0") and "exchange Target" in line for line in lines)


def test_parallel_has_no_directional_derivatives(catenary):
    p = begun(catenary, "Parallel", 1e-3)
    p.step(1e-3)
    assert (
        refusal(p.slave.getDirectionalDerivative, [p.reference(HEIGHT)], [p.reference("pantograph[1].force")], [1.0])
        != 0
    )
    assert "exchange = Parallel: has no directional derivatives" in p.log[-1].text
