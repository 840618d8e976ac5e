"""Bad values: fmi2Error, the old value kept, one log line with variable, value and what is allowed."""

from __future__ import annotations

import math

import pytest
from fmpy.fmi2 import fmi2Error

from harness import Fmu, Instance, refusal
from models import each_case


def refused(p: Instance, call, *arguments) -> str:
    """The single log line with which a call is refused."""
    p.log.clear()
    assert refusal(call, *arguments) == fmi2Error
    assert len(p.log) == 1 and p.log[0].category == "logStatusError" and p.log[0].status == fmi2Error
    assert p.log[0].text and not p.log[0].text.endswith("\n")
    return p.log[0].text


def bad_values(fmu: Fmu, name: str) -> list[float | int]:
    v = fmu.variables[name]
    if v.type == "Real":
        below = [float(v.min) - 1.0] if v.min is not None else []
        above = [float(v.max) + 1.0] if v.max is not None else []
        return [math.nan, math.inf, -math.inf, *below, *above]
    if v.type == "Enumeration":
        return [0, len(v.declaredType.items) + 1, -1]
    if v.type == "Boolean":
        return []
    return [int(v.min) - 1, int(v.max) + 1]


def test_every_bad_value_of_every_parameter_and_input_is_refused_by_name(any_fmu, instance):
    p = instance(initialize=False)
    for name in any_fmu.names("parameter") + any_fmu.names("input"):
        for value in bad_values(any_fmu, name):
            p.reset()
            text, v = refused(p, p.__setitem__, name, value), any_fmu.variables[name]
            said, _, allowed = text.partition(f"{name} = ")[2].partition(":")
            assert float(said.split()[0]) == pytest.approx(value, nan_ok=True), text
            if v.type == "Real":
                assert said.split()[1:] == [v.unit] * (v.unit != "1")
            if v.type == "Real" and math.isfinite(value):
                bound = float(v.min) if v.min is not None and value < float(v.min) else float(v.max)
                assert float(allowed.split()[-1]) == pytest.approx(bound), text
            assert allowed.strip()
            p.reset()
            p.slave.setupExperiment()
            p.slave.enterInitializationMode()
            assert p[name] == any_fmu.start(name), name


def test_a_refused_value_leaves_the_others_of_the_same_call_alone_too(model, instance):
    p = instance(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    good, bad = model.bounded
    before = p[good], p[bad]
    text = refused(p, p.slave.setReal, [p.reference(good), p.reference(bad)], [1.1 * before[0], -1.0])
    assert bad in text and good not in text
    assert (p[good], p[bad]) == before


def test_bad_values_are_refused_while_stepping(any_fmu, instance):
    for name in any_fmu.names("input"):
        for value in (math.nan, math.inf):
            p = instance()
            p.step(0.01)
            before = p[name]
            assert name in refused(p, p.__setitem__, name, value)
            assert p[name] == before


def test_a_tunable_parameter_keeps_its_bounds_while_stepping(pantograph):
    p = pantograph()
    p.step(0.01)
    assert "bench.frequency" in refused(p, p.__setitem__, "bench.frequency", -1.0)
    assert p["bench.frequency"] == 5.0


def test_unknown_value_references_are_refused(any_fmu, instance):
    unknown = 1 + max(v.valueReference for v in any_fmu.variables.values())
    for call in ("getReal", "getInteger", "getBoolean"):
        for reference in (unknown, 2**32 - 1):
            p = instance()
            assert str(reference) in refused(p, getattr(p.slave, call), [reference])
    for call, value in (("setReal", 1.0), ("setInteger", 1), ("setBoolean", 1)):
        p = instance(initialize=False)
        assert str(unknown) in refused(p, getattr(p.slave, call), [unknown], [value])


CALLS = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"}


def test_reading_a_variable_with_the_wrong_type_is_refused(any_fmu, instance):
    """Every variable, with each call of another type; enumerations count as Integers."""
    p = instance()
    for v in any_fmu.variables.values():
        for kind in {"Real", "Integer", "Boolean"} - {CALLS[v.type]}:
            assert v.name in refused(p, getattr(p.slave, f"get{kind}"), [v.valueReference])


def test_setting_a_variable_with_the_wrong_type_is_refused(any_fmu, instance):
    p = instance(initialize=False)
    for name in any_fmu.names("parameter") + any_fmu.names("input"):
        for kind in {"Real", "Integer", "Boolean"} - {CALLS[any_fmu.variables[name].type]}:
            value = 1.0 if kind == "Real" else 1
            assert name in refused(p, getattr(p.slave, f"set{kind}"), [p.reference(name)], [value])


def test_there_are_no_strings(model, instance):
    p = instance(initialize=False)
    reference = p.reference(model.bounded[0])
    assert "String" in refused(p, p.slave.setString, [reference], ["5"])
    p = instance()
    assert "String" in refused(p, p.slave.getString, [reference])


def test_calls_without_variables_are_allowed(instance):
    """Hosts loop over types and call with none."""
    p = instance()
    for call in (p.slave.getReal, p.slave.getInteger, p.slave.getBoolean, p.slave.getString):
        assert list(call([])) == []
    for call in (p.slave.setReal, p.slave.setInteger, p.slave.setBoolean, p.slave.setString):
        call([], [])
    assert p.log == []


@pytest.mark.parametrize(
    "time, size, named",
    [
        (0.0, 0.0, "communicationStepSize = 0 s"),
        (0.0, -0.01, "communicationStepSize = -0.01 s"),
        (0.0, math.nan, "communicationStepSize = nan s"),
        (0.0, math.inf, "communicationStepSize = inf s"),
        (math.nan, 0.01, "currentCommunicationPoint = nan s"),
        (0.5, 0.01, "currentCommunicationPoint = 0.5 s"),
        (-0.01, 0.01, "currentCommunicationPoint = -0.01 s"),
    ],
)
def test_impossible_communication_steps_are_refused(instance, time, size, named):
    p = instance()
    before = p.all_values()
    text = refused(p, p.slave.doStep, time, size)
    assert named in text
    assert p.all_values() == before


def test_steps_past_the_stop_time_are_refused(instance):
    p = instance(stop_time=0.1)
    p.step(0.1)
    assert "0.1" in refused(p, p.step, 0.01)


def test_rounding_at_the_stop_time_is_tolerated(instance):
    p = instance(stop_time=1.0)
    for n in range(10):
        p.step(0.1 if n < 9 else 1.0 - p.time + 1e-15)


@pytest.mark.parametrize("start, stop", [(0.0, -1.0), (1.0, 0.5), (math.nan, 1.0), (0.0, math.nan), (math.inf, None)])
def test_impossible_experiments_are_refused(instance, start, stop):
    p = instance(initialize=False)
    assert "time" in refused(p, lambda: p.slave.setupExperiment(startTime=start, stopTime=stop)).lower()


@pytest.mark.parametrize("tangent", ["Mean", "Secant", "Exact"])
def test_a_slope_of_the_friction_law_needs_a_smooth_law(pantograph, tangent):
    p = pantograph({"friction": "Coulomb", "solver.tangent": tangent}, initialize=False)
    p.slave.setupExperiment()
    status = refusal(p.slave.enterInitializationMode) or refusal(p.slave.exitInitializationMode)
    assert status == fmi2Error
    assert "solver.tangent" in p.log[-1].text and "friction" in p.log[-1].text


@pytest.mark.parametrize("order", [0, 3, -1])
def test_input_derivatives_of_other_orders_are_refused(model, instance, order):
    p = instance()
    text = refused(p, p.slave.setRealInputDerivatives, [p.reference(model.force)], [order], [1.0])
    assert model.force in text and str(order) in text


def test_derivatives_of_what_is_no_input_and_numbers_that_are_none_are_refused(model, instance):
    for name, value in (
        (model.moved, 1.0),
        (model.bounded[0], 1.0),
        (model.choice, 1.0),
        (model.force, math.nan),
        (model.force, math.inf),
    ):
        p = instance()
        assert name in refused(p, p.slave.setRealInputDerivatives, [p.reference(name)], [1], [value])


def test_output_derivatives_that_do_not_exist_are_refused(model, instance):
    for name, order in ((model.moved, 2), (model.moved, 0), (model.bounded[0], 1), ("solver.steps", 1)):
        p = instance()
        p.step(0.01)
        assert name in refused(p, p.slave.getRealOutputDerivatives, [p.reference(name)], [order])


def test_directional_derivatives_of_or_by_other_variables_are_refused(model, instance):
    for unknown, known in (
        (model.moved, model.bounded[0]),
        (model.bounded[0], model.force),
        (model.moved, "energy.work"),
        ("solver.steps", model.force),
    ):
        p = instance()
        p.step(0.01)
        text = refused(p, p.slave.getDirectionalDerivative, [p.reference(unknown)], [p.reference(known)], [1.0])
        assert unknown in text or known in text


def test_an_input_that_does_not_fit_the_static_state_is_reported_once_and_accepted(pantograph):
    p = pantograph({"static_force": 150.0, "contact_force": 120.0})
    p.log.clear()
    p.step(0.01)
    p.step(0.01)
    lines = [m for m in p.log if m.category == "logStatusWarning"]
    assert len(lines) == 1
    assert "contact_force" in lines[0].text and "120" in lines[0].text and "150" in lines[0].text


@each_case
def test_a_consistent_start_is_silent(instance, case):
    p = instance(case.parameters)
    p.step(0.01)
    assert p.log == []
