"""Instances: made and refused, what they log, the memory they keep, their outputs before the first step."""

from __future__ import annotations

import sys
from ctypes import byref
from pathlib import Path

import pytest
from fmpy.fmi2 import fmi2CoSimulation, fmi2Error, fmi2ModelExchange

from harness import Fmu, Message, Pantograph, callbacks_into, refusal


def instantiate(
    fmu: Fmu,
    log: list[Message],
    *,
    name: bytes = b"p",
    kind: int = fmi2CoSimulation,
    guid: str | None = None,
    location: bytes | None = b"",
    logging: bool = True,
):
    """Binding, its component (None if refused) and the callbacks, which must outlive it."""
    slave, callbacks = fmu.slave(), callbacks_into(log)
    guid = fmu.description.guid if guid is None else guid
    component = slave.fmi2Instantiate(name, kind, guid.encode(), location, byref(callbacks), 0, logging)
    return slave, component, callbacks


def test_a_wrong_guid_gives_no_instance_and_says_why(fmu):
    log: list[Message] = []
    _, component, _ = instantiate(fmu, log, guid="{00000000-0000-0000-0000-000000000000}")
    assert component is None
    assert "00000000-0000" in log[-1].text and fmu.description.guid in log[-1].text


@pytest.mark.parametrize(
    "options, named", [({"kind": fmi2ModelExchange}, "co-simulation"), ({"name": b""}, "name")]
)
def test_what_cannot_be_instantiated_is_refused_with_a_reason(fmu, options, named):
    log: list[Message] = []
    _, component, _ = instantiate(fmu, log, **options)
    assert component is None
    assert named in log[-1].text.lower()


def test_every_form_of_resource_location_is_accepted(fmu):
    resources = Path(fmu.folder, "resources")
    uri = resources.as_uri()
    for location in (
        None,
        "",
        uri,
        uri + "/",
        uri.replace("file:///", "file:/"),
        uri.replace("file:///", "file:////"),
        uri.replace("file:///", "file://localhost/"),
        uri.replace("%20", " "),
        str(resources),
    ):
        log: list[Message] = []
        slave, component, _ = instantiate(fmu, log, location=None if location is None else location.encode())
        assert component is not None and not log, location
        slave.fmi2FreeInstance(component)


@pytest.mark.parametrize(
    "name", ["%s%n%d", "100 %", "p" * 5000, "Stromabnehmer \N{GREEK SMALL LETTER ALPHA}"]
)
def test_instance_names_do_no_harm_in_the_log(pantograph, name):
    p = pantograph(name=name, logging=True)
    refusal(p.__setitem__, "m1", -1.0)
    assert "m1" in p.log[-1].text and p.log[-1].instance == name


def test_messages_are_plain_text_for_hosts_that_do_not_expand_directives(fmu):
    """The text itself is the message, not a format such as "%s" with arguments."""
    log: list[Message] = []
    slave, callbacks = fmu.slave(), callbacks_into(log, expand=False)
    slave.component = slave.fmi2Instantiate(
        b"p", fmi2CoSimulation, fmu.description.guid.encode(), b"", byref(callbacks), 0, 1
    )
    assert refusal(slave.setReal, [fmu.variables["m1"].valueReference], [-1.0]) == fmi2Error
    slave.freeInstance()
    assert "m1" in log[-1].text and "-1" in log[-1].text


def test_only_declared_categories_are_logged(fmu, pantograph):
    declared = {category.name for category in fmu.description.logCategories}
    p = pantograph({"drive": "Displacement", "solver.tangent": "Exact", "solver.max_iterations": 3})
    for n in range(20):
        p["head_displacement"] = 0.002 * (n % 5)
        if refusal(p.step, 0.002):
            break
    refusal(p.__setitem__, "m1", -1.0)
    assert len({m.category for m in p.log}) > 1
    assert {m.category for m in p.log} <= declared


def warn(p: Pantograph) -> None:
    """Make an instance warn: an input that the static state does not balance."""
    p.reset()
    p["uplift.head"] = 3.0
    p.initialize()
    p.step(0.01)


@pytest.mark.parametrize(
    "enabled, logged",
    [
        (["logStatusWarning"], True),
        (["logAll"], True),
        (["logSolver"], False),
        (["logStatusError", "logStatusDiscard"], False),
    ],
)
def test_only_enabled_categories_are_logged(pantograph, enabled, logged):
    p = pantograph(categories=enabled)
    warn(p)
    assert bool(p.log) == logged


def test_logging_can_be_switched_off_and_on_for_all_categories(pantograph):
    p = pantograph(logging=False)
    warn(p)
    assert p.log == []
    p.slave.fmi2SetDebugLogging(p.slave.component, 1, 0, None)
    warn(p)
    assert len(p.log) == 1
    p.slave.fmi2SetDebugLogging(p.slave.component, 0, 0, None)
    warn(p)
    assert len(p.log) == 1


def test_why_a_call_was_refused_is_logged_without_debug_logging_too(pantograph):
    p = pantograph(logging=False)
    refusal(p.__setitem__, "m1", -1.0)
    assert len(p.log) == 1


def test_an_unknown_log_category_is_refused_by_name(pantograph):
    p = pantograph()
    assert refusal(p.slave.setDebugLogging, True, ["logEverything"]) == fmi2Error
    assert "logEverything" in p.log[-1].text


def initializing(pantograph, parameters: dict) -> Pantograph:
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
    before = p.reals(
        ["zspring.theta", "zspring.k_locked", "zspring.k_free", "zspring.alpha", "zspring.force"]
    )
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
    assert [p[f"solver.{n}"] for n in ("iterations", "iterations_max", "steps", "refinements")] == [
        0,
        0,
        0,
        0,
    ]


def resident_kilobytes() -> int:
    """Memory now resident (Linux), else the most that ever was."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * 4
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak // 1024 if sys.platform == "darwin" else peak


def test_thousands_of_resets_instances_and_states_do_not_grow_memory(fmu):
    """An instance takes more than a kilobyte, so one leaked in each cycle would show as several megabytes."""
    log: list[Message] = []
    slave, callbacks = fmu.slave(), callbacks_into(log)
    guid = fmu.description.guid.encode()

    def cycles(count: int) -> None:
        for _ in range(count):
            slave.component = slave.fmi2Instantiate(b"p", fmi2CoSimulation, guid, b"", byref(callbacks), 0, 0)
            for _ in range(2):
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

    cycles(500)
    before = resident_kilobytes()
    cycles(4000)
    assert resident_kilobytes() - before < 1000
