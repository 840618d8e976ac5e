"""State get/set/serialise, reset, several instances and threads: always the same numbers, bit for bit."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from ctypes import byref, c_void_p, create_string_buffer

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Error

from harness import Pantograph, Signal, refusal

CASES = {
    "Force": ({"drive": "Force"}, {"contact_force": Signal.cubed_sines([60.0], [1.3], 120.0)}),
    "Displacement": (
        {"drive": "Displacement", "friction": "Coulomb"},
        {"head_displacement": Signal.cubed_sines([0.02], [1.3])},
    ),
    "Wire": ({"drive": "Wire", "contact.c": 50.0}, {"wire_height": Signal([(0.012, 25.0, 0.0)])}),
    "Bench": ({"drive": "Bench", "bench.acceleration": 3.0}, {}),
}
STEP, COUNT = 0.0037, 150


def drive_on(p: Pantograph, inputs: dict[str, Signal]) -> list[dict]:
    """Steps with input derivatives; every variable after some of them."""
    history = []
    for _ in range(3):
        p.run(STEP, COUNT // 3, ["head.z"], signals=inputs)
        history.append(p.all_values())
    return history


@pytest.mark.parametrize("case", CASES)
def test_a_restored_state_replays_bit_for_bit(pantograph, case):
    parameters, inputs = CASES[case]
    p = pantograph(parameters)
    drive_on(p, inputs)
    state, time, values = p.slave.getFMUstate(), p.time, p.all_values()
    first = drive_on(p, inputs)
    p.slave.setFMUstate(state)
    p.time = time
    assert p.all_values() == values
    assert drive_on(p, inputs) == first
    p.slave.freeFMUstate(state)


@pytest.mark.parametrize("case", CASES)
def test_a_serialised_state_continues_in_another_instance_bit_for_bit(pantograph, case):
    parameters, inputs = CASES[case]
    p, other = pantograph(parameters), pantograph()
    drive_on(p, inputs)
    state = p.slave.getFMUstate()
    data, other.time = p.slave.serializeFMUstate(state), p.time
    copy = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(copy)
    assert other.all_values() == p.all_values()
    assert drive_on(other, inputs) == drive_on(p, inputs)
    p.slave.freeFMUstate(state)
    other.slave.freeFMUstate(copy)


def test_input_values_and_their_derivatives_belong_to_the_state(pantograph):
    p = pantograph()
    p["contact_force"] = 130.0
    p.set_derivatives("contact_force", 7.0, -3.0)
    state = p.slave.getFMUstate()
    p.step(0.1)
    expected = p.all_values()
    p["contact_force"] = 50.0
    p.set_derivatives("contact_force", 0.0, 0.0)
    p.step(0.1)
    p.slave.setFMUstate(state)
    p.slave.doStep(0.0, 0.1)
    assert p.all_values() == expected
    p.slave.freeFMUstate(state)


def test_several_states_live_side_by_side_and_a_handle_can_be_reused(pantograph):
    p = pantograph()
    states, values = [], []
    for _ in range(4):
        states.append(p.slave.getFMUstate())
        values.append(p.all_values())
        p.run(STEP, 5, ["head.z"], signals=CASES["Force"][1])
    for state, expected in zip(reversed(states), reversed(values)):
        p.slave.setFMUstate(state)
        assert p.all_values() == expected
    before = states[0].value
    p.slave.fmi2GetFMUstate(p.slave.component, byref(states[0]))
    assert states[0].value == before
    for state in states:
        p.slave.freeFMUstate(state)


def test_a_state_can_be_taken_and_restored_before_the_first_step(pantograph):
    """Instantiated, or in Initialization Mode; parameters and the phase come back too."""
    p = pantograph({"m1": 8.0}, initialize=False)
    instantiated = p.slave.getFMUstate()
    p.slave.setupExperiment(startTime=2.0)
    p.slave.enterInitializationMode()
    p["static_force"] = p["contact_force"] = 100.0
    initializing, values = p.slave.getFMUstate(), p.all_values()
    p.slave.exitInitializationMode()
    p.slave.doStep(2.0, 0.1)
    p.slave.setFMUstate(initializing)
    assert p.all_values() == values
    p.slave.exitInitializationMode()
    p.slave.doStep(2.0, 0.1)
    p.slave.setFMUstate(instantiated)
    p.initialize()
    assert (p["m1"], p["static_force"]) == (8.0, 120.0)
    for state in (instantiated, initializing):
        p.slave.freeFMUstate(state)


def test_a_state_brings_its_mode_and_time_with_it(pantograph):
    """A stored state also revives an instance after an error or after terminate."""
    p = pantograph()
    p.step(0.3)
    state, values = p.slave.getFMUstate(), p.all_values()
    refusal(p.__setitem__, "m1", 1.0)
    p.slave.setFMUstate(state)
    assert p.all_values() == values
    p.step(0.1)
    p.slave.terminate()
    p.slave.setFMUstate(state)
    p.slave.doStep(0.3, 0.1)
    assert refusal(p.slave.doStep, 0.3, 0.1) == fmi2Error
    p.slave.freeFMUstate(state)


def test_a_freed_state_handle_is_null_and_null_can_be_freed(pantograph):
    p = pantograph()
    state = p.slave.getFMUstate()
    p.slave.fmi2FreeFMUstate(p.slave.component, byref(state))
    assert state.value is None
    p.slave.fmi2FreeFMUstate(p.slave.component, byref(c_void_p()))
    assert refusal(p.slave.setFMUstate, c_void_p()) == fmi2Error


def test_foreign_truncated_and_damaged_serialised_states_are_refused(pantograph):
    p = pantograph()
    p.step(0.1)
    state = p.slave.getFMUstate()
    data = p.slave.serializeFMUstate(state)
    p.slave.freeFMUstate(state)
    rng = np.random.default_rng(0)

    def flipped(at: int) -> bytes:
        return data[:at] + bytes([data[at] ^ (1 << int(rng.integers(8)))]) + data[at + 1 :]

    damaged = [
        data[:-1],
        data[: len(data) // 2],
        data[:4],
        data + b"\0",
        bytes(len(data)),
        rng.bytes(len(data)),
    ]
    damaged += [flipped(int(at)) for at in rng.integers(0, len(data), 60)] + [
        flipped(0),
        flipped(len(data) - 1),
    ]
    for bad in damaged:
        q = pantograph()
        values = q.all_values()
        q.log.clear()
        assert refusal(q.slave.deSerializeFMUstate, bad) == fmi2Error
        assert "state" in q.log[-1].text
        assert q.all_values() == values
        q.close()


def test_serialising_into_too_small_a_buffer_is_refused(pantograph):
    p = pantograph()
    state = p.slave.getFMUstate()
    size = len(p.slave.serializeFMUstate(state))
    buffer = create_string_buffer(size)
    assert refusal(p.slave.fmi2SerializeFMUstate, p.slave.component, state, buffer, size - 1) == fmi2Error
    p.slave.freeFMUstate(state)


@pytest.mark.parametrize("case", CASES)
def test_reset_equals_a_fresh_instance_bit_for_bit(pantograph, case):
    parameters, inputs = CASES[case]
    used, fresh = (
        pantograph({"m1": 9.0, "suspension": "LinearFree", "bench.frequency": 7.0}, start_time=3.0),
        pantograph(initialize=False),
    )
    used.run(STEP, 50, ["head.z"], signals=CASES["Force"][1])
    used.reset()
    for p in (used, fresh):
        p.slave.setupExperiment()
        p.slave.enterInitializationMode()
    assert used.all_values() == fresh.all_values()
    used.reset()
    fresh.reset()
    for p in (used, fresh):
        p.set(parameters)
        p.initialize()
    assert drive_on(used, inputs) == drive_on(fresh, inputs)
    states = [p.slave.getFMUstate() for p in (used, fresh)]
    assert used.slave.serializeFMUstate(states[0]) == fresh.slave.serializeFMUstate(states[1])
    for p, state in zip((used, fresh), states):
        p.slave.freeFMUstate(state)


def test_instances_do_not_disturb_each_other(pantograph):
    """Two different instances stepped in turns give what each gives alone."""

    def steps(p: Pantograph, inputs: dict[str, Signal]):
        for _ in range(COUNT):
            yield p.run(STEP, 1, ["head.z", "contact.force", "zspring.alpha"], signals=inputs).tolist()

    alone = [list(steps(pantograph(parameters), inputs)) for parameters, inputs in CASES.values()]
    together = list(zip(*(steps(pantograph(parameters), inputs) for parameters, inputs in CASES.values())))
    for n, one in enumerate(alone):
        assert [row[n] for row in together] == one


def test_instances_in_threads_give_what_they_give_in_sequence(pantograph):
    """Created in this thread, stepped in others, at the same time."""
    work = list(CASES.values()) * 2
    expected = [drive_on(pantograph(parameters), inputs) for parameters, inputs in work]
    instances = [pantograph(parameters) for parameters, _ in work]
    with ThreadPoolExecutor(len(work)) as pool:
        found = list(pool.map(drive_on, instances, [inputs for _, inputs in work]))
    assert found == expected


def test_one_instance_may_change_threads_between_steps(pantograph):
    parameters, inputs = CASES["Displacement"]
    expected = drive_on(pantograph(parameters), inputs)
    p, found = pantograph(parameters), []
    for _ in range(3):
        with ThreadPoolExecutor(1) as pool:
            pool.submit(p.run, STEP, COUNT // 3, ["head.z"], signals=inputs).result()
        found.append(p.all_values())
    assert found == expected
