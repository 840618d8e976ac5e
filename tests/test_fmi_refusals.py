"""Bad values: fmi2Error, the old value kept, one log line with variable, value and what is allowed."""

from __future__ import annotations

import math

import pytest
from fmpy.fmi2 import fmi2Error

from harness import Fmu, Pantograph, refusal


def refused(p: Pantograph, call, *arguments) -> str:
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
        return [math.nan, math.inf, -math.inf] + below + above
    if v.type == "Enumeration":
        return [0, len(v.declaredType.items) + 1, -1]
    return [int(v.min) - 1, int(v.max) + 1]


def test_every_bad_value_of_every_parameter_and_input_is_refused_by_name(fmu, pantograph):
    p = pantograph(initialize=False)
    for name in fmu.names("parameter") + fmu.names("input"):
        for value in bad_values(fmu, name):
            p.reset()
            text, v = refused(p, p.__setitem__, name, value), fmu.variables[name]
            said, _, allowed = text.partition(f"{name} = ")[2].partition(":")
            assert float(said.split()[0]) == pytest.approx(value, nan_ok=True), text
            if v.type == "Real":
                assert said.split()[1] == v.unit
            if v.type == "Real" and math.isfinite(value):
                bound = float(v.min) if v.min is not None and value < float(v.min) else float(v.max)
                assert float(allowed.split()[-1]) == pytest.approx(bound), text
            assert allowed.strip()
            p.reset()
            p.slave.setupExperiment()
            p.slave.enterInitializationMode()
            assert p[name] == fmu.start(name), name


def test_a_refused_value_leaves_the_others_of_the_same_call_alone_too(pantograph):
    p = pantograph(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    m1, m2 = p["m1"], p["m2"]
    text = refused(p, p.slave.setReal, [p.reference("m1"), p.reference("m2")], [9.0, -1.0])
    assert "m2" in text
    assert (p["m1"], p["m2"]) == (m1, m2)


def test_bad_values_are_refused_while_stepping(pantograph):
    for name, value in (("contact_force", math.nan), ("bench.frequency", -1.0), ("wire_height", math.inf)):
        p = pantograph()
        p.step(0.01)
        before = p[name]
        assert name in refused(p, p.__setitem__, name, value)
        assert p[name] == before


def test_unknown_value_references_are_refused(fmu, pantograph):
    unknown = 1 + max(v.valueReference for v in fmu.variables.values())
    for call in ("getReal", "getInteger", "getBoolean"):
        for reference in (unknown, 2**32 - 1):
            p = pantograph()
            assert str(reference) in refused(p, getattr(p.slave, call), [reference])
    for call, value in (("setReal", 1.0), ("setInteger", 1), ("setBoolean", 1)):
        p = pantograph(initialize=False)
        assert str(unknown) in refused(p, getattr(p.slave, call), [unknown], [value])


@pytest.mark.parametrize(
    "call, name",
    [
        ("getReal", "drive"),
        ("getReal", "contact.closed"),
        ("getReal", "solver.steps"),
        ("getInteger", "m1"),
        ("getInteger", "contact.closed"),
        ("getBoolean", "m1"),
        ("getBoolean", "drive"),
    ],
)
def test_reading_a_variable_with_the_wrong_type_is_refused(pantograph, call, name):
    p = pantograph()
    assert name in refused(p, getattr(p.slave, call), [p.reference(name)])


@pytest.mark.parametrize(
    "call, name, value",
    [
        ("setReal", "drive", 1.0),
        ("setReal", "solver.max_iterations", 5.0),
        ("setInteger", "m1", 5),
        ("setBoolean", "drive", 1),
    ],
)
def test_setting_a_variable_with_the_wrong_type_is_refused(pantograph, call, name, value):
    p = pantograph(initialize=False)
    assert name in refused(p, getattr(p.slave, call), [p.reference(name)], [value])


def test_there_are_no_strings(pantograph):
    p = pantograph(initialize=False)
    assert "String" in refused(p, p.slave.setString, [p.reference("m1")], ["5"])
    p = pantograph()
    assert "String" in refused(p, p.slave.getString, [p.reference("m1")])


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
def test_impossible_communication_steps_are_refused(pantograph, time, size, named):
    p = pantograph()
    before = p.all_values()
    text = refused(p, p.slave.doStep, time, size)
    assert named in text
    assert p.all_values() == before


def test_steps_past_the_stop_time_are_refused(pantograph):
    p = pantograph(stop_time=0.1)
    p.step(0.1)
    assert "0.1" in refused(p, p.step, 0.01)


def test_rounding_at_the_stop_time_is_tolerated(pantograph):
    p = pantograph(stop_time=1.0)
    for n in range(10):
        p.step(0.1 if n < 9 else 1.0 - p.time + 1e-15)


@pytest.mark.parametrize(
    "start, stop", [(0.0, -1.0), (1.0, 0.5), (math.nan, 1.0), (0.0, math.nan), (math.inf, None)]
)
def test_impossible_experiments_are_refused(pantograph, start, stop):
    p = pantograph(initialize=False)
    assert "time" in refused(p, lambda: p.slave.setupExperiment(startTime=start, stopTime=stop)).lower()


@pytest.mark.parametrize("tangent", ["Mean", "Secant", "Exact"])
def test_a_slope_of_the_friction_law_needs_a_smooth_law(pantograph, tangent):
    p = pantograph({"friction": "Coulomb", "solver.tangent": tangent}, initialize=False)
    p.slave.setupExperiment()
    status = refusal(p.slave.enterInitializationMode) or refusal(p.slave.exitInitializationMode)
    assert status == fmi2Error
    assert "solver.tangent" in p.log[-1].text and "friction" in p.log[-1].text


@pytest.mark.parametrize("order", [0, 3, -1])
def test_input_derivatives_of_other_orders_are_refused(pantograph, order):
    p = pantograph()
    text = refused(p, p.slave.setRealInputDerivatives, [p.reference("contact_force")], [order], [1.0])
    assert "contact_force" in text and str(order) in text


@pytest.mark.parametrize(
    "name, value", [("head.z", 1.0), ("m1", 1.0), ("contact_force", math.nan), ("wire_height", math.inf)]
)
def test_derivatives_of_what_is_no_input_and_numbers_that_are_none_are_refused(pantograph, name, value):
    p = pantograph()
    assert name in refused(p, p.slave.setRealInputDerivatives, [p.reference(name)], [1], [value])


@pytest.mark.parametrize("name, order", [("head.z", 2), ("head.z", 0), ("m1", 1), ("solver.steps", 1)])
def test_output_derivatives_that_do_not_exist_are_refused(pantograph, name, order):
    p = pantograph()
    p.step(0.01)
    assert name in refused(p, p.slave.getRealOutputDerivatives, [p.reference(name)], [order])


@pytest.mark.parametrize(
    "unknown, known",
    [("head.z", "m1"), ("m1", "contact_force"), ("head.z", "head.v"), ("solver.steps", "contact_force")],
)
def test_directional_derivatives_of_or_by_other_variables_are_refused(pantograph, unknown, known):
    p = pantograph()
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


def test_a_consistent_start_is_silent(pantograph):
    for drive in ("Force", "Displacement", "Wire", "Bench"):
        p = pantograph({"drive": drive})
        p.step(0.01)
        assert p.log == []
