"""Which call is allowed when: the state machine of FMI 2.0, section 4.2.4."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import byref, c_double, c_void_p

import pytest
from fmpy.fmi2 import fmi2DoStepStatus, fmi2Error, fmi2LastSuccessfulTime, fmi2OK, fmi2Terminated

from harness import Instance, refusal
from models import Model


def instantiated(p: Instance) -> None:
    p.reset()


def initializing(p: Instance) -> None:
    p.reset()
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()


def stepping(p: Instance) -> None:
    p.reset()
    p.initialize()
    p.step(0.002)


def terminated(p: Instance) -> None:
    stepping(p)
    p.slave.terminate()


STATES = [instantiated, initializing, stepping, terminated]


def settable(causality: str, variability: str, state: Callable) -> bool:
    if causality not in ("parameter", "input"):
        return False
    return state in (instantiated, initializing) or (
        state is stepping and (causality == "input" or variability == "tunable")
    )


@pytest.mark.parametrize("state", STATES)
def test_each_variable_can_be_set_exactly_when_allowed(any_fmu, instance, state):
    p = instance(initialize=False)
    for v in any_fmu.variables.values():
        state(p)
        p.log.clear()
        value = any_fmu.start(v.name) if v.start is not None else 0
        expected = settable(v.causality, v.variability, state)
        status = refusal(p.__setitem__, v.name, value)
        assert status == (fmi2OK if expected else fmi2Error), v.name
        if not expected:
            assert p.log[-1].status == fmi2Error
            assert state is terminated or v.name in p.log[-1].text


@pytest.mark.parametrize("state", STATES[1:])
def test_every_variable_can_be_read_from_initialization_mode_on(instance, state):
    p = instance(initialize=False)
    state(p)
    p.all_values()


def _calls(p: Instance, model: Model) -> dict[str, Callable[[], object]]:
    s, force, moved = p.slave, p.reference(model.force), p.reference(model.moved)
    return {
        "setup": s.setupExperiment,
        "enter": s.enterInitializationMode,
        "exit": s.exitInitializationMode,
        "step": lambda: s.doStep(p.time, 0.002),
        "cancel": s.cancelStep,
        "terminate": s.terminate,
        "reset": s.reset,
        "set input derivative": lambda: s.setRealInputDerivatives([force], [1], [0.0]),
        "get output derivative": lambda: s.getRealOutputDerivatives([moved], [1]),
        "get state": lambda: s.freeFMUstate(s.getFMUstate()),
        "debug logging": lambda: s.setDebugLogging(True, ["logAll"]),
    }


ALLOWED = {
    instantiated: {"setup", "enter", "reset", "set input derivative", "get state", "debug logging"},
    initializing: {"exit", "reset", "set input derivative", "get state", "debug logging"},
    stepping: {
        "step",
        "terminate",
        "reset",
        "set input derivative",
        "get output derivative",
        "get state",
        "debug logging",
    },
    terminated: {"reset", "get output derivative", "get state", "debug logging"},
}


@pytest.mark.parametrize("state", STATES)
def test_calls_out_of_order_are_refused(model, instance, state):
    p = instance(initialize=False)
    for name, call in _calls(p, model).items():
        state(p)
        p.log.clear()
        assert refusal(call) == (fmi2OK if name in ALLOWED[state] else fmi2Error), name
        if name not in ALLOWED[state]:
            assert p.log and p.log[-1].category == "logStatusError", name


def test_initialization_without_an_experiment_starts_at_time_zero(instance):
    p = instance(initialize=False)
    p.slave.enterInitializationMode()
    p.slave.exitInitializationMode()
    p.step(0.01)


def test_after_a_refused_call_reset_makes_the_instance_usable_again(model, instance):
    p, fresh = instance(), instance()
    assert refusal(p.__setitem__, model.bounded[0], 5.0) == fmi2Error
    p.reset()
    p.initialize()
    for q in (p, fresh):
        q.step(0.1)
    assert p.all_values() == fresh.all_values()


def test_status_queries_answer_or_are_discarded(instance):
    p = instance()
    p.step(0.25)
    assert p.slave.getRealStatus(fmi2LastSuccessfulTime) == 0.25
    assert p.slave.getBooleanStatus(fmi2Terminated) is False
    for query, kind in (
        (p.slave.getStatus, fmi2DoStepStatus),
        (p.slave.getStringStatus, fmi2DoStepStatus),
        (p.slave.getIntegerStatus, fmi2Terminated),
        (p.slave.getRealStatus, fmi2Terminated),
    ):
        assert refusal(query, kind) in (fmi2OK, 2)


def test_null_instances_are_refused_not_dereferenced(instance):
    s = instance().slave
    s.fmi2FreeInstance(None)
    state = c_void_p()
    for name, arguments in (
        ("fmi2Reset", ()),
        ("fmi2Terminate", ()),
        ("fmi2EnterInitializationMode", ()),
        ("fmi2ExitInitializationMode", ()),
        ("fmi2DoStep", (0.0, 0.1, 1)),
        ("fmi2CancelStep", ()),
        ("fmi2SetupExperiment", (0, 0.0, 0.0, 0, 0.0)),
        ("fmi2GetReal", (None, 0, None)),
        ("fmi2GetFMUstate", (byref(state),)),
        ("fmi2GetRealStatus", (fmi2LastSuccessfulTime, byref(c_double()))),
    ):
        assert refusal(getattr(s, name), None, *arguments) == fmi2Error, name


def test_all_functions_of_fmi_2_co_simulation_are_exported(any_fmu):
    """fmpy binds each function by name and fails on a missing one: 25 common and 9 for co-simulation."""
    assert len(any_fmu.slave()._functions) == 34


def test_the_library_tells_its_platform_and_version(any_fmu):
    s = any_fmu.slave()
    assert s.getTypesPlatform() == "default"
    assert s.getVersion() == "2.0"
