"""Instances: made and refused, what they log, the memory they keep, their outputs before the first step."""

from __future__ import annotations

import sys
from ctypes import byref, c_char_p, create_string_buffer
from pathlib import Path

import pytest
from fmpy.fmi2 import (
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
    fmi2Error,
    fmi2ModelExchange,
)

from harness import Fmu, Instance, Message, callbacks_into, forms_of, refusal


def instantiate(
    fmu: Fmu,
    log: list[Message],
    *,
    name: bytes = b"p",
    kind: int = fmi2CoSimulation,
    guid: str | None = None,
    location: bytes | None = b"",
    logging: bool = True,
    expand: bool = True,
):
    """Binding, its component (None if refused) and the callbacks, which must outlive it."""
    slave, callbacks = fmu.slave(), callbacks_into(log, expand=expand)
    guid = fmu.description.guid if guid is None else guid
    component = slave.fmi2Instantiate(name, kind, guid.encode(), location, byref(callbacks), 0, logging)
    return slave, component, callbacks


def test_a_wrong_guid_gives_no_instance_and_says_why(any_fmu):
    log: list[Message] = []
    _, component, _ = instantiate(any_fmu, log, guid="{00000000-0000-0000-0000-000000000000}")
    assert component is None
    assert "00000000-0000" in log[-1].text and any_fmu.description.guid in log[-1].text


@pytest.mark.parametrize("options, named", [({"kind": fmi2ModelExchange}, "co-simulation"), ({"name": b""}, "name")])
def test_what_cannot_be_instantiated_is_refused_with_a_reason(any_fmu, options, named):
    log: list[Message] = []
    _, component, _ = instantiate(any_fmu, log, **options)
    assert component is None
    assert named in log[-1].text.lower()


def test_every_form_of_resource_location_is_accepted(any_fmu):
    resources = Path(any_fmu.folder, "resources")
    uri = resources.as_uri()
    for location in (
        None,
        "",
        *forms_of(uri),
        str(resources),
        uri.replace("file:///", "file:///C:/"),
        "file:///no/such/folder%",
    ):
        log: list[Message] = []
        slave, component, _ = instantiate(any_fmu, log, location=None if location is None else location.encode())
        assert component is not None and not log, location
        slave.fmi2FreeInstance(component)


@pytest.mark.parametrize("name", ["%s%n%d", "100 %", "p" * 5000, "Stromabnehmer \N{GREEK SMALL LETTER ALPHA}"])
def test_instance_names_do_no_harm_in_the_log(model, instance, name):
    p = instance(name=name, logging=True)
    refusal(p.__setitem__, model.bounded[0], -1.0)
    assert model.bounded[0] in p.log[-1].text and p.log[-1].instance == name


def test_messages_are_plain_text_for_hosts_that_do_not_expand_directives(model, any_fmu):
    """The text itself is the message, not a format such as "%s" with arguments."""
    log: list[Message] = []
    slave, callbacks = any_fmu.slave(), callbacks_into(log, expand=False)
    slave.component = slave.fmi2Instantiate(
        b"p", fmi2CoSimulation, any_fmu.description.guid.encode(), b"", byref(callbacks), 0, 1
    )
    name = model.bounded[0]
    assert refusal(slave.setReal, [any_fmu.variables[name].valueReference], [-1.0]) == fmi2Error
    slave.freeInstance()
    assert name in log[-1].text and "-1" in log[-1].text


@pytest.mark.parametrize("text", ["100 % done", "%s%s%s%n", "#r1# and #"])
def test_directives_and_references_in_what_the_host_gave_reach_the_log_as_text(any_fmu, text):
    """Hosts expand a message as a printf format, and #r1# as a variable: both signs are doubled."""
    for expand in (True, False):
        log: list[Message] = []
        _, component, _ = instantiate(any_fmu, log, guid=text, expand=expand)
        assert component is None
        doubled = text.replace("#", "##")
        assert (doubled if expand else doubled.replace("%", "%%")) in log[-1].text


def test_categories_are_declared_and_named_in_every_message(model, any_fmu, instance):
    """Hosts crash on a NULL category, and refuse undeclared ones."""
    declared = {category.name for category in any_fmu.description.logCategories}
    p = instance(model.discarded[0])
    p.step(0.002)
    p[model.force] = model.discarded[1]
    assert refusal(p.slave.doStep, p.time, 0.1)
    refusal(p.__setitem__, model.bounded[0], -1.0)
    p.slave.terminate()
    assert {"logStatusDiscard", "logStatusError", "logSolver"} <= {m.category for m in p.log} <= declared


@pytest.mark.parametrize(
    "enabled, logged",
    [
        (["logSolver"], True),
        (["logAll"], True),
        (["logStatusWarning"], False),
        (["logStatusError", "logStatusDiscard"], False),
    ],
)
def test_only_enabled_categories_are_logged(instance, enabled, logged):
    """The end of a run is a message of logSolver."""
    p = instance(categories=enabled)
    p.step(0.01)
    p.slave.terminate()
    assert bool(p.log) == logged


def test_logging_can_be_switched_off_and_on_for_all_categories(instance):
    p = instance(logging=False)

    def run() -> None:
        p.reset()
        p.initialize()
        p.step(0.01)
        p.slave.terminate()

    run()
    assert p.log == []
    p.slave.fmi2SetDebugLogging(p.slave.component, 1, 0, None)
    run()
    assert len(p.log) == 1
    p.slave.fmi2SetDebugLogging(p.slave.component, 0, 0, None)
    run()
    assert len(p.log) == 1


def test_why_a_call_was_refused_is_logged_without_debug_logging_too(model, instance):
    p = instance(logging=False)
    refusal(p.__setitem__, model.bounded[0], -1.0)
    assert len(p.log) == 1


def test_an_unknown_log_category_is_refused_by_name(instance):
    p = instance()
    assert refusal(p.slave.setDebugLogging, True, ["logEverything"]) == fmi2Error
    assert "logEverything" in p.log[-1].text


def test_a_null_log_category_is_refused(instance):
    p = instance()
    names = (c_char_p * 2)(b"logAll", None)
    assert refusal(p.slave.fmi2SetDebugLogging, p.slave.component, 1, 2, names) == fmi2Error
    assert refusal(p.slave.fmi2SetDebugLogging, p.slave.component, 1, 1, None) == fmi2Error
    assert len(p.log) == 2


def test_the_callbacks_are_copied_and_only_the_logger_is_used(any_fmu):
    """The others may be NULL, and so may the logger; name and callbacks may be overwritten after the call."""
    log: list[Message] = []
    kept, guid = callbacks_into(log), any_fmu.description.guid.encode()
    given, name = fmi2CallbackFunctions.from_buffer_copy(kept), create_string_buffer(b"p")
    given.allocateMemory, given.freeMemory = fmi2CallbackAllocateMemoryTYPE(), fmi2CallbackFreeMemoryTYPE()
    first, silent = any_fmu.slave(), any_fmu.slave()
    first.component = first.fmi2Instantiate(name, fmi2CoSimulation, guid, b"", byref(given), 0, 1)
    given.logger, name.value = fmi2CallbackLoggerTYPE(), b"q"
    silent.component = silent.fmi2Instantiate(b"q", fmi2CoSimulation, guid, b"", byref(given), 0, 1)
    for slave in (first, silent):
        assert refusal(slave.doStep, 0.0, 0.1) == fmi2Error
        slave.freeInstance()
    assert [message.instance for message in log] == ["p"]


def initializing(pantograph, parameters: dict) -> Instance:
    p = pantograph(parameters, initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    return p


def test_outputs_answer_to_inputs_already_in_initialization_mode(pantograph):
    p = initializing(pantograph, {"drive": "Force"})
    assert (p["contact.force"], p["head.a"]) == (120, pytest.approx(0, abs=1e-12))
    p["contact_force"] = 150.0
    p["uplift.head"] = 5.0
    assert p["contact.force"] == 150
    assert p["head.a"] == pytest.approx((120 - 150 + 5) / p["m1"], rel=1e-9)

    p = initializing(pantograph, {"drive": "Displacement"})
    p["uplift.head"] = 5.0
    assert p["contact.force"] == pytest.approx(125, rel=1e-9)
    assert p["head.a"] == 0

    p = initializing(pantograph, {"drive": "Wire"})
    p["wire_height"] = -0.001
    assert p["contact.force"] == pytest.approx(120 + p["contact.k"] * 0.001, rel=1e-9)
    p["wire_height"] = 0.1
    assert p["contact.force"] == 0 and not p["contact.closed"]
    assert p["head.a"] == pytest.approx(120 / p["m1"], rel=1e-9)


def test_calculated_parameters_answer_to_parameters_set_in_initialization_mode(pantograph):
    p = initializing(pantograph, {})
    before = p.reals(["zspring.theta", "zspring.k_locked", "zspring.k_free", "zspring.alpha", "zspring.force"])
    p["zspring.k"] = 20000.0
    after = p.reals(["zspring.theta", "zspring.k_locked", "zspring.k_free", "zspring.alpha", "zspring.force"])
    assert all(before != after)
    direct = pantograph({"zspring.k": 20000.0})
    assert direct["zspring.theta"] == after[0] and direct["zspring.k_free"] == after[2]


def test_outputs_before_the_first_step_are_those_of_the_static_state(pantograph):
    p = pantograph()
    zero = [
        "head.z",
        "head.v",
        "upper_frame.z",
        "upper_frame.v",
        "lower_frame.z",
        "lower_frame.v",
        "energy.kinetic",
        "energy.elastic",
        "energy.dissipated",
        "energy.work",
        "zspring.moment_alpha",
        "zspring.moment_beta",
    ]
    assert list(p.reals(zero)) == pytest.approx([0] * len(zero), abs=1e-12)
    assert p["contact.force"] == p["static_force"] and p["contact.closed"]
    assert [p[f"solver.{n}"] for n in ("iterations", "iterations_max", "steps", "refinements")] == [0, 0, 0, 0]


def resident_kilobytes() -> int:
    """Memory now resident (Linux), else the most that ever was."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * 4
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak // 1024 if sys.platform == "darwin" else peak


def test_thousands_of_resets_instances_and_states_do_not_grow_memory(model, any_fmu):
    """An instance takes more than a kilobyte, so one leaked in each cycle would show as megabytes."""
    log: list[Message] = []
    slave, callbacks = any_fmu.slave(), callbacks_into(log)
    guid = any_fmu.description.guid.encode()

    references = [any_fmu.variables[name].valueReference for name in model.smallest]
    values = list(model.smallest.values())

    def cycles(count: int) -> None:
        for _ in range(count):
            slave.component = slave.fmi2Instantiate(b"p", fmi2CoSimulation, guid, b"", byref(callbacks), 0, 0)
            for _ in range(2):
                slave.setInteger(references, values)
                slave.enterInitializationMode()
                slave.exitInitializationMode()
                slave.doStep(0.0, 0.004)
                state = slave.getFMUstate()
                copy = slave.deSerializeFMUstate(slave.serializeFMUstate(state))
                slave.setFMUstate(copy)
                slave.freeFMUstate(state)
                slave.freeFMUstate(copy)
                slave.reset()
            slave.fmi2FreeInstance(slave.component)

    cycles(300)
    before = resident_kilobytes()
    cycles(2000)
    assert resident_kilobytes() - before < 1000
