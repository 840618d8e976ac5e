"""State get/set/serialise, reset, several instances and threads: always the same numbers, bit for bit."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from ctypes import addressof, byref, c_size_t, c_void_p, create_string_buffer

import numpy as np
from fmpy.fmi2 import fmi2Error

from harness import Instance, refusal
from models import MODELS, Case, Model, each_case

STEP, COUNT = 0.0037, 150


def drive_on(p: Instance, case: Case) -> list[dict]:
    """Steps with input derivatives; every variable after some of them."""
    history = []
    for _ in range(3):
        p.run(STEP, COUNT // 3, [], signals=case.inputs)
        history.append(p.all_values())
    return history


@each_case
def test_a_restored_state_replays_bit_for_bit(instance, case):
    p = instance(case.parameters)
    drive_on(p, case)
    state, time, values = p.slave.getFMUstate(), p.time, p.all_values()
    first = drive_on(p, case)
    p.slave.setFMUstate(state)
    p.time = time
    assert p.all_values() == values
    assert drive_on(p, case) == first
    p.slave.freeFMUstate(state)


@each_case
def test_a_serialised_state_continues_in_another_instance_bit_for_bit(instance, case):
    p, other = instance(case.parameters), instance()
    drive_on(p, case)
    state = p.slave.getFMUstate()
    data, other.time = p.slave.serializeFMUstate(state), p.time
    copy = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(copy)
    assert other.all_values() == p.all_values()
    assert drive_on(other, case) == drive_on(p, case)
    p.slave.freeFMUstate(state)
    other.slave.freeFMUstate(copy)


def test_input_values_and_their_derivatives_belong_to_the_state(model, instance):
    p = instance()
    p[model.force] = 130.0
    p.set_derivatives(model.force, 7.0, -3.0)
    state = p.slave.getFMUstate()
    p.step(0.1)
    expected = p.all_values()
    p[model.force] = 50.0
    p.set_derivatives(model.force, 0.0, 0.0)
    p.step(0.1)
    p.slave.setFMUstate(state)
    p.slave.doStep(0.0, 0.1)
    assert p.all_values() == expected
    p.slave.freeFMUstate(state)


def test_several_states_live_side_by_side_and_a_handle_can_be_reused(model, instance):
    p = instance(model.case.parameters)
    states, values = [], []
    for _ in range(4):
        states.append(p.slave.getFMUstate())
        values.append(p.all_values())
        p.run(STEP, 5, [], signals=model.case.inputs)
    for state, expected in zip(reversed(states), reversed(values)):
        p.slave.setFMUstate(state)
        assert p.all_values() == expected
    before = states[0].value
    p.slave.fmi2GetFMUstate(p.slave.component, byref(states[0]))
    assert states[0].value == before
    for state in states:
        p.slave.freeFMUstate(state)


def test_a_state_can_be_taken_and_restored_before_the_first_step(model, any_fmu, instance):
    """Instantiated, or in Initialization Mode; parameters and the phase come back too."""
    first, second = model.bounded
    other = 1.1 * any_fmu.start(first)
    p = instance({first: other}, initialize=False)
    instantiated = p.slave.getFMUstate()
    p.slave.setupExperiment(startTime=2.0)
    p.slave.enterInitializationMode()
    p[second] = 0.9 * any_fmu.start(second)
    initializing, values = p.slave.getFMUstate(), p.all_values()
    p.slave.exitInitializationMode()
    p.slave.doStep(2.0, 0.1)
    p.slave.setFMUstate(initializing)
    assert p.all_values() == values
    p.slave.exitInitializationMode()
    p.slave.doStep(2.0, 0.1)
    p.slave.setFMUstate(instantiated)
    p.initialize()
    assert (p[first], p[second]) == (other, any_fmu.start(second))
    for state in (instantiated, initializing):
        p.slave.freeFMUstate(state)


def test_a_state_brings_its_mode_and_time_with_it(model, instance):
    """A stored state also revives an instance after an error or after terminate."""
    p = instance()
    p.step(0.3)
    state, values = p.slave.getFMUstate(), p.all_values()
    refusal(p.__setitem__, model.bounded[0], 1.0)
    p.slave.setFMUstate(state)
    assert p.all_values() == values
    p.step(0.1)
    p.slave.terminate()
    p.slave.setFMUstate(state)
    p.slave.doStep(0.3, 0.1)
    assert refusal(p.slave.doStep, 0.3, 0.1) == fmi2Error
    p.slave.freeFMUstate(state)


def test_a_freed_state_handle_is_null_and_null_can_be_freed(instance):
    p = instance()
    state = p.slave.getFMUstate()
    p.slave.fmi2FreeFMUstate(p.slave.component, byref(state))
    assert state.value is None
    p.slave.fmi2FreeFMUstate(p.slave.component, byref(c_void_p()))
    assert refusal(p.slave.setFMUstate, c_void_p()) == fmi2Error


def test_foreign_truncated_and_damaged_serialised_states_are_refused(instance):
    p = instance()
    p.step(0.1)
    state = p.slave.getFMUstate()
    data = p.slave.serializeFMUstate(state)
    p.slave.freeFMUstate(state)
    rng = np.random.default_rng(0)

    def flipped(at: int) -> bytes:
        return data[:at] + bytes([data[at] ^ (1 << int(rng.integers(8)))]) + data[at + 1 :]

    damaged = [data[:-1], data[: len(data) // 2], data[:4], data + b"\0", bytes(len(data)), rng.bytes(len(data))]
    damaged += [flipped(int(at)) for at in rng.integers(0, len(data), 60)] + [flipped(0), flipped(len(data) - 1)]
    for bad in damaged:
        q = instance()
        values = q.all_values()
        q.log.clear()
        assert refusal(q.slave.deSerializeFMUstate, bad) == fmi2Error
        assert "state" in q.log[-1].text
        assert q.all_values() == values
        q.close()


def test_serialising_into_too_small_a_buffer_is_refused(instance):
    p = instance()
    state = p.slave.getFMUstate()
    size = len(p.slave.serializeFMUstate(state))
    buffer = create_string_buffer(size)
    assert refusal(p.slave.fmi2SerializeFMUstate, p.slave.component, state, buffer, size - 1) == fmi2Error
    p.slave.freeFMUstate(state)


@each_case
def test_reset_equals_a_fresh_instance_bit_for_bit(model, instance, case):
    used, fresh = instance(model.others, start_time=3.0), instance(initialize=False)
    used[model.force] = 100.0
    used.run(STEP, 50, [])
    used.reset()
    for p in (used, fresh):
        p.slave.setupExperiment()
        p.slave.enterInitializationMode()
    assert used.all_values() == fresh.all_values()
    used.reset()
    fresh.reset()
    for p in (used, fresh):
        p.set(case.parameters)
        p.initialize()
    assert drive_on(used, case) == drive_on(fresh, case)
    states = [p.slave.getFMUstate() for p in (used, fresh)]
    assert used.slave.serializeFMUstate(states[0]) == fresh.slave.serializeFMUstate(states[1])
    for p, state in zip((used, fresh), states):
        p.slave.freeFMUstate(state)


def test_instances_do_not_disturb_each_other(model, instance):
    """Different instances stepped in turns give what each gives alone."""

    def steps(case: Case):
        p = instance(case.parameters)
        for _ in range(COUNT):
            yield p.run(STEP, 1, [model.moved, "energy.work"], signals=case.inputs).tolist()

    cases = model.cases.values()
    alone = [list(steps(case)) for case in cases]
    assert list(zip(*alone)) == list(zip(*map(steps, cases)))


def test_both_fmus_live_in_one_process(fmus):
    """Stepped in turns they give what each gives alone."""

    def steps(model: Model):
        p = model.instance(fmus[model.name], model.case.parameters)
        for _ in range(COUNT):
            yield p.run(STEP, 1, [model.moved, "energy.work"], signals=model.case.inputs).tolist()
        p.close()

    alone = [list(steps(model)) for model in MODELS]
    assert list(zip(*alone)) == list(zip(*map(steps, MODELS)))


def test_instances_in_threads_give_what_they_give_in_sequence(model, instance):
    """Created in this thread, stepped in others, at the same time."""
    work = list(model.cases.values()) * 2
    expected = [drive_on(instance(case.parameters), case) for case in work]
    instances = [instance(case.parameters) for case in work]
    with ThreadPoolExecutor(len(work)) as pool:
        found = list(pool.map(drive_on, instances, work))
    assert found == expected


@each_case
def test_one_instance_may_change_threads_between_calls(instance, case):
    """Instantiated in one thread, initialised, stepped and freed in others."""
    expected = drive_on(instance(case.parameters), case)
    p, found = instance(case.parameters, initialize=False), []

    def elsewhere(call, *arguments, **options) -> None:
        with ThreadPoolExecutor(1) as pool:
            pool.submit(call, *arguments, **options).result()

    elsewhere(p.initialize)
    for _ in range(3):
        elsewhere(p.run, STEP, COUNT // 3, [], signals=case.inputs)
        found.append(p.all_values())
    elsewhere(p.close)
    assert found == expected


@each_case
def test_saving_the_state_before_every_step_changes_nothing(instance, case):
    """As masters do that may have to repeat a step."""
    saved, plain = instance(case.parameters), instance(case.parameters)
    for _ in range(COUNT):
        state = saved.slave.getFMUstate()
        for p in (saved, plain):
            p.run(STEP, 1, [], signals=case.inputs)
        saved.slave.freeFMUstate(state)
    assert saved.all_values() == plain.all_values()


def test_a_pointer_that_is_no_state_of_the_instance_is_left_alone(pantograph):
    """FMI4j stores into a pointer that it never initialised, fmusim frees a wrong one."""
    other, p = pantograph(), pantograph()  # the log of the last one is read
    memory = create_string_buffer(b"not a state of any instance", 64)
    before = memory.raw
    state = c_void_p(addressof(memory))
    p.slave.fmi2GetFMUstate(p.slave.component, byref(state))
    assert state.value != addressof(memory) and memory.raw == before
    theirs, size = other.slave.getFMUstate(), c_size_t()
    for wrong in (c_void_p(addressof(memory)), theirs):
        address = wrong.value
        for call, arguments in (
            (p.slave.fmi2SetFMUstate, [wrong]),
            (p.slave.fmi2FreeFMUstate, [byref(wrong)]),
            (p.slave.fmi2SerializedFMUstateSize, [wrong, byref(size)]),
        ):
            assert refusal(call, p.slave.component, *arguments) == fmi2Error
            assert "must be a state that this instance has given" in p.log[-1].text
        assert wrong.value == address and memory.raw == before
    p.slave.setFMUstate(state)
    p.slave.freeFMUstate(state)
    other.slave.freeFMUstate(theirs)
