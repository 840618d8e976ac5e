"""Communication steps below a millionth of `solver.step`, which hosts that add up their times make: time passes in
them and nothing else; a target set for one waits for the next step.
"""

from __future__ import annotations

import numpy as np
import pytest

from harness import Instance
from models import Case, each_case, each_case_but

LENGTH = 0.002


def outputs(p: Instance) -> dict:
    return {name: p[name] for name in p.fmu.names("output")}


def set_targets(p: Instance, case: Case, time: float) -> None:
    for name, signal in case.inputs.items():
        p[name] = signal(time)


@each_case
def test_nothing_but_time_passes_and_the_target_is_reached_in_the_next_step(instance, case):
    """The next step is longer by the leftover, so that it ends as without one but for that."""
    p, even = instance(case.parameters), instance(case.parameters)
    for n in range(40):
        for run in (p, even):
            set_targets(run, case, (n + 1) * LENGTH)
        for leftover in (1e-300, 1e-15, 1e-14, 1e-11)[: n % 5]:
            before = outputs(p)
            p.step(leftover)
            assert outputs(p) == before
        for run in (p, even):
            run.step(LENGTH)
    for name, value in outputs(even).items():
        assert p[name] == pytest.approx(value, rel=1e-6, abs=1e-8), name


def test_the_leftover_of_a_run_moves_neither_force_nor_work(pantograph):
    """A target 1 mm on, set for a whole step, was reached within 1e-14 s: 13 407 N instead of 127 N."""
    p = pantograph({"drive": "Displacement"})
    for n in range(500):
        p["head_displacement"] = 0.01 * np.sin(2 * np.pi * 2 * (n + 1) * LENGTH) ** 3
        p.step(LENGTH)
    force, work = p["contact.force"], p["energy.work"]
    p["head_displacement"] = p["head.z"] + 0.001
    p.step(1e-14)
    assert (p["contact.force"], p["energy.work"], p["head.z"]) == (force, work, p["head.z"])
    p.step(LENGTH)
    assert p["head_displacement"] == p["head.z"]


@each_case
def test_leftovers_add_up_to_a_step(any_fmu, instance, case):
    """No time is lost: two of 0.6 millionths are a step, which counts once."""
    p = instance(case.parameters)
    set_targets(p, case, LENGTH)
    p.step(LENGTH)
    state, length = p.slave.getFMUstate(), 0.6e-6 * any_fmu.start("solver.step")
    p.step(length)
    p.step(length)
    twice = outputs(p)
    p.slave.setFMUstate(state)
    p.slave.doStep(LENGTH, 2 * length)
    assert twice == outputs(p)
    p.slave.freeFMUstate(state)


@each_case
def test_the_time_that_waits_belongs_to_the_state(any_fmu, instance, case):
    """Saved after a leftover, in the FMU's memory or as bytes; a reset forgets it."""
    length = 0.6e-6 * any_fmu.start("solver.step")
    p, other = instance(case.parameters), instance(case.parameters)
    for run in (p, other):
        set_targets(run, case, LENGTH)
        run.step(LENGTH)
    p.step(length)
    state = p.slave.getFMUstate()
    copy = other.slave.deSerializeFMUstate(p.slave.serializeFMUstate(state))
    other.slave.setFMUstate(copy)
    other.time = p.time
    p.step(length)
    other.step(length)
    first = outputs(p)
    assert outputs(other) == first
    p.slave.setFMUstate(state)
    p.time -= length
    p.step(length)
    assert outputs(p) == first
    p.slave.setFMUstate(state)
    for run, made in ((p, state), (other, copy)):
        run.slave.freeFMUstate(made)
    fresh = instance(case.parameters)
    p.reset()
    p.set(case.parameters)
    p.initialize()
    for run in (p, fresh):
        run.step(length)
        run.step(LENGTH)
    assert p.all_values() == fresh.all_values()


@each_case_but("Parallel")  # which has no derivatives
def test_outputs_do_not_vary_with_what_is_held_in_a_leftover(any_fmu, instance, case):
    """As differences over the leftover have it; the slopes in time stay those of the instant."""
    p = instance(case.parameters)
    set_targets(p, case, LENGTH)
    p.step(LENGTH)
    reals = [name for name in any_fmu.names("output") if any_fmu.variables[name].type == "Real"]
    references = [p.reference(name) for name in reals if not name.startswith("bench.")]
    slopes = p.slave.getRealOutputDerivatives(references, [1] * len(references))
    p.step(1e-14)
    for name in case.inputs:
        derivatives = p.slave.getDirectionalDerivative(references, [p.reference(name)], [1.0])
        assert derivatives == [0.0] * len(references)
    assert p.slave.getRealOutputDerivatives(references, [1] * len(references)) == slopes
