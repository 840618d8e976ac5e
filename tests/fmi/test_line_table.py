"""An FMU whose resources hold a line: found however hosts tell where they are; refused where damaged or another's."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Error
from test_fmi_instances import instantiate

from harness import Fmu, Instance, Message, forms_of, refusal

REPLACED = "line.", "dropper.", "support.", "steady_arm."


def line(
    *droppers: tuple[float, ...], supports=((0, 1.2, 0, 0, 0), (45, 1.2, 5e4, 0, 0), (100, 1.2, 0, 0, 0)), rest=()
):
    """The table's bytes; a dropper: x, whether on a stitch wire, height."""
    hangers = [(*d, 1e5, 0, 0, 0.2, 0.2, 0, 0) for d in droppers or ((20, 0, 0), (70, 0, 0))]
    numbers = [len(supports), *sum(supports, ()), 0, 0, len(hangers), *sum(hangers, ()), *(rest or (0, 0, 0))]
    return b"zspline1" + struct.pack(f"<{len(numbers)}d", *numbers)


@pytest.fixture
def with_line(fmu_catenary: Fmu, tmp_path: Path) -> Fmu:
    return fmu_catenary.with_line(line(), tmp_path / "Fahrleitung \N{LATIN SMALL LETTER U WITH DIAERESIS}ber 100 % #1")


def made(fmu: Fmu, location: str | None, **options) -> tuple[bool, str]:
    """Whether there is an instance, and what was logged."""
    log: list[Message] = []
    encoded = None if location is None else location.encode()
    guid = options.pop("guid", fmu.description.guid + fmu.told)
    slave, component, _ = instantiate(fmu, log, guid=guid, location=encoded, **options)
    if component is not None:
        slave.fmi2FreeInstance(component)
    return component is not None, "; ".join(message.text for message in log)


def test_the_table_is_found_in_every_form_that_hosts_tell(with_line):
    resources = with_line.folder / "resources"
    uri = resources.as_uri()
    plain = f"file://{resources}"  # hosts that encode nothing
    for location in (
        *forms_of(uri),
        uri.replace("%C3%BC", "%c3%bc"),
        plain,
        plain + "/",
        str(resources),
        f"{resources}/",
    ):
        assert made(with_line, location) == (True, ""), location


@pytest.mark.parametrize(
    "location, told",
    [
        (None, "fmuResourceLocation: must be given, as line.table in the resources is needed"),
        ("", "fmuResourceLocation: must be given, as line.table in the resources is needed"),
        ("file:///no/such/folder", "fmuResourceLocation = file:///no/such/folder: there is no line.table"),
        ("http://host/resources", "fmuResourceLocation = http://host/resources: must be a URI that begins with file:"),
    ],
)
def test_where_there_is_none_one_line_says_so(with_line, location, told):
    assert made(with_line, location) == (False, told)


@pytest.mark.parametrize("change", ["a bit", "cut", "another's", "none"])
def test_a_damaged_or_foreign_table_is_refused(with_line, change):
    path = with_line.folder / "resources" / "line.table"
    content = path.read_bytes()
    if change == "none":
        path.unlink()
    else:
        flipped = content[:50] + bytes([content[50] ^ 1]) + content[51:]
        path.write_bytes({"a bit": flipped, "cut": content[:-8], "another's": line((20, 0, 0.01))}[change])
    found, told = made(with_line, path.parent.as_uri())
    assert not found
    assert ("there is no line.table" if change == "none" else "line.table in the resources: is damaged") in told


def test_the_fmu_of_the_pantograph_knows_no_table(fmu):
    found, told = made(fmu, "", guid=fmu.description.guid + " line=0123456789abcdef")
    assert not found and "must be {" in told


@pytest.mark.parametrize(
    "table, told",
    [
        (line((45.0, 0, 0)), "span 2, at 45 m: a dropper must be after the one before it, between two supports"),
        (line((20, 0, 0), (19, 0, 0)), "span 1, at 19 m: a dropper must be after the one before it"),
        (line((20, 1, 0)), "span 1, at 20 m: a dropper on a stitch wire, where there is none"),
        (
            line((44, 0, 0), rest=(1, 39, 51, 2800, 0.3, 0, 0, 0)),
            "span 1, at 44 m: a dropper on the messenger would cross",
        ),
        (line(rest=(2, 39, 51, 2800, 0.3, 0, 50, 60, 2800, 0.3, 0, 0, 0)), "a stitch wire from 50 m to 60 m"),
        (line(rest=(0, 1, 20.0002, 0, 2, 0)), "span 1, at 20.0002 m: two places on the line 0.0002 m apart"),
        (line(rest=(0, 1, 20, 2, 2, 0)), "span 1, at 20 m: wire of the point mass = 2"),
        (line(supports=((0, 1.2, 0, 0, 0), (0.5, 1.2, 0, 0, 0))), "span 1, at 0 m: length of the span = 0.5 m"),
        (line(supports=((0, 1.2, 0, 0, 0),)), "line.table: 1 supports: must be at least 2"),
        (line(rest=(1e9, 0, 0)), "line.table: 1000000000 stitch wires: must be a whole number up to 401"),
        (line(rest=(float("nan"), 0, 0)), "line.table: holds a value that is not finite"),
        (line() + b"\0" * 8, "line.table: goes on after its last value"),
        (line()[:-8], "line.table: ends before all its values are there"),
        (b"line", "line.table: is no table of a line"),
    ],
)
def test_what_is_no_line_is_refused_with_the_place(fmu_catenary, tmp_path, table, told):
    fmu = fmu_catenary.with_line(table, tmp_path / "copy")
    found, text = made(fmu, (fmu.folder / "resources").as_uri())
    assert not found and told in text


@pytest.mark.parametrize(
    "table, told",
    [
        (
            line((20, 0, 0), (22, 0, 0.3)),
            "span 1, dropper 1, at 20 m: in the static state the dropper would have to push",
        ),
        (line((20, 0, 3.0)), "span 1, dropper 1, at 20 m: the dropper would be"),
        (line((60, 1, 0), rest=(1, 50, 70, 17e3, 0.3, 0, 0, 0)), "messenger.tension = 16000 N"),
    ],
)
def test_what_cannot_hang_is_refused_at_the_start(fmu_catenary, tmp_path, table, told):
    p = Instance(fmu_catenary.with_line(table, tmp_path / "copy"), initialize=False)
    assert refusal(p.initialize) == fmi2Error and told in p.log[-1].text
    p.close()


def test_what_the_table_stands_in_for_cannot_be_set(with_line):
    p = Instance(with_line, initialize=False)
    for v in with_line.variables.values():
        if v.causality != "parameter":
            continue
        start = with_line.start(v.name)
        p[v.name] = start
        if v.name.startswith(REPLACED) and v.name != "line.spans":
            assert refusal(p.__setitem__, v.name, start + 1) == fmi2Error
            assert "cannot be set, as this FMU has line.table in its place" in p.log[-1].text
    p["contact_wire.tension"] = 21e3
    p.initialize()
    assert p["line.length"] == 100.0
    p.close()


def test_states_go_back_and_are_those_of_their_line_alone(with_line, fmu_catenary, tmp_path):
    parameters = {"pantograph[1].start": 30.0, "pantograph[1].force": 120.0, "pantograph[1].speed": 50.0}
    other = fmu_catenary.with_line(line((20, 0, 0.01), (70, 0, 0)), tmp_path / "other")
    p, q, like = (Instance(fmu, parameters) for fmu in (with_line, other, fmu_catenary))
    outputs = ["pantograph[1].wire_height", "droppers.force_min", "energy.kinetic"]
    p.run(0.005, 20, [])
    state = p.slave.getFMUstate()
    kept = p.slave.serializeFMUstate(state)
    time, first = p.time, p.run(0.005, 20, outputs)
    again = p.slave.deSerializeFMUstate(kept)
    p.slave.setFMUstate(again)
    p.time = time
    np.testing.assert_array_equal(p.run(0.005, 20, outputs), first)
    for stranger in (q, like):
        assert refusal(stranger.slave.deSerializeFMUstate, kept) == fmi2Error
    assert "FMU state: is that of an FMU with another line.table, or none" in like.log[-1].text
    p.slave.freeFMUstate(state)
    p.slave.freeFMUstate(again)
    for instance in (p, q, like):
        instance.close()
