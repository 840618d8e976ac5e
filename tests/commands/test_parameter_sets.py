"""Parameter sets (SSV of SSP 1.0 and 2.0): what they hold, that other tools read them, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssv

from commands import head, in_process, receptances, zspring
from linear import PUBLISHED, LinearPantograph
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.parameter_sets import (
    LINES,
    PANTOGRAPHS,
    chosen_set,
    describe_set,
    find_set,
    packaged_sets,
    read_set,
    write_set,
)
from zspring.receptance import receptance

TABLES = {
    "dsa-380": "DSA-380",
    "dsa-250": "DSA-250",
    "en-50318-2002": "EN 50318:2002",
    "benchmark-2015": "2015 benchmark",
}
UNCERTAIN = {"benchmark-2015": {"c1", "c2", "c3"}}  # the test's own dampers differ from the set's


@pytest.fixture(scope="module")
def model():
    with Fmu() as model:
        yield model


@pytest.mark.parametrize("name", packaged_sets())
def test_another_tool_reads_the_set_and_finds_its_schema_kept(model, name):
    path = find_set(name)
    other = {p.name: p for p in read_ssv(str(path)).parameters}
    own = read_set(path, model)
    assert set(other) == set(own)
    for parameter, value in own.items():
        variable = model.variables[parameter]
        assert other[parameter].type == variable.type
        if variable.type == "Real":
            assert float(other[parameter].value) == value
            assert other[parameter].unit == variable.unit


@pytest.mark.parametrize("name, table", TABLES.items())
def test_the_linear_sets_have_the_published_numbers(model, name, table):
    values = read_set(find_set(name), model)
    assert values.pop("suspension") == model.variables.parse_assignments(["suspension=Linear"])["suspension"]
    assert set(values) == set(PUBLISHED[table])
    for parameter, number in PUBLISHED[table].items():
        if parameter not in UNCERTAIN.get(name, ()):
            assert values[parameter] == number, parameter


def test_the_z_spring_set_is_what_the_fmu_starts_with_and_complete(fmu, model):
    """But for the drive, the bench, the line, the solver, and k1, which the Z-spring replaces."""
    values = read_set(find_set("dsa-380-zspring"), model)
    elsewhere = re.compile(r"drive|k1|(bench|contact|solver)\..*")
    assert set(values) == {name for name in fmu.names("parameter") if not elsewhere.fullmatch(name)}
    assert values == {name: fmu.start(name) for name in values}


def test_every_set_tells_its_source_and_marks_what_is_not_published(model):
    for name in packaged_sets():
        description, remarks = describe_set(find_set(name))
        assert re.search(r"Wang et al\.|as quoted in papers", description, re.IGNORECASE), name
        if name in UNCERTAIN:
            assert set(remarks["unverified"]) == UNCERTAIN[name]
    _, remarks = describe_set(find_set("dsa-380-zspring"))
    assert set(remarks["synthetic"]) == {
        name for name in read_set(find_set("dsa-380-zspring"), model) if name.startswith("zspring.")
    }


def test_a_set_comes_back_bit_for_bit(model, tmp_path):
    values = model.variables.parse_assignments(
        ["zspring.k=12345.678901234567", "friction=Coulomb", "solver.max_iterations=7", "gravity=0.1"]
    )
    path = tmp_path / "set.ssv"
    write_set(path, model, values, "mine", "A < B & C", {"gravity": "elsewhere"})
    assert read_set(path, model) == values
    assert describe_set(path) == ("A < B & C", {"elsewhere": ["gravity"]})
    assert read_ssv(str(path)).name == "mine"


SSV = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="x">
  <ssv:Parameters>{}</ssv:Parameters>
  <ssv:Units>
    <ssc:Unit name="N/mm"><ssc:BaseUnit kg="1" s="-2" factor="1000"/></ssc:Unit>
    <ssc:Unit name="lb"><ssc:BaseUnit kg="1" factor="0.5"/></ssc:Unit>
    <ssc:Unit name="tared"><ssc:BaseUnit kg="1" factor="2" offset="3"/></ssc:Unit>
  </ssv:Units>
</ssv:ParameterSet>"""


def parameter(name: str, typed: str) -> str:
    return f'<ssv:Parameter name="{name}"><ssv:{typed}/></ssv:Parameter>'


def test_units_are_converted_by_definition_or_by_the_fmus_display_units(model, tmp_path):
    path = tmp_path / "units.ssv"
    parameters = [
        parameter("zspring.k", 'Real value="13" unit="N/mm"'),
        parameter("m1", 'Real value="14" unit="lb"'),
        parameter("m2", 'Real value="1.5" unit="tared"'),
        parameter("zspring.d", 'Real value="170" unit="mm"'),
        parameter("c3", 'Real value="70"'),
        parameter("friction", 'Enumeration value="Coulomb"'),
    ]
    path.write_text(SSV.format("".join(parameters)))
    values = read_set(path, model)
    expected = {"zspring.k": 13e3, "m1": 7.0, "m2": 6.0, "zspring.d": 0.17, "c3": 70.0, "friction": 2}
    assert values == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    "text, complaint",
    [
        (SSV.format(parameter("zspring.kk", 'Real value="1"')), "no parameter 'zspring.kk'.*did you mean"),
        (SSV.format(parameter("contact_force", 'Real value="1"')), "has no parameter but inputs: contact_force"),
        (SSV.format(parameter("m1", 'Real value="1" unit="N/mm"')), r"m1 \[N/mm\].*convertible to kg"),
        (SSV.format(parameter("m1", 'Real value="1" unit="stone"')), r"m1: unit \[stone\]: must be one of kg"),
        (SSV.format(parameter("m1", 'Real value="heavy"')), "m1 = 'heavy': must be a number"),
        (SSV.format(parameter("m1", 'Real value="NaN"')), "m1 = nan: must be finite"),
        (SSV.format(parameter("m1", 'String value="1"')), "m1 is String: must be Real"),
        (SSV.format(parameter("friction", 'Enumeration value="Dry"')), "friction = 'Dry': must be one of"),
        (SSV.format(2 * parameter("m1", 'Real value="1"')), "two parameters 'm1'"),
        (SSV.format(parameter("m1", 'Float64 value="1 2"')), "m1 = '1 2': must be a number"),
        (SSV.format(parameter("m1", 'Int32 value="7"')), "m1 is Int32: must be Real"),
        (SSV.format(parameter("m1", "Real")), "m1 has 0 values: must be one"),
        (SSV.format(""), "has no parameter"),
        (SSV.replace("ssv:Parameters", "Parameters"), r"element Parameters \(without namespace\) in ssv:ParameterSet"),
        (SSV.format('<Parameter name="m1"><Real value="7"/></Parameter>'), r"element Parameter \(without namespace\)"),
        (
            SSV.replace("ssc:Unit ", "Unit ").replace("ssc:Unit>", "Unit>"),
            r"element Unit \(without .*: must be .*ssc:Unit",
        ),
        (SSV.replace('version="1.0" n', 'version="3.0" n'), "version = '3.0': must be 1.0 or 2.0"),
        (SSV.replace('factor="0.5"', 'factor="half"'), "a unit's definition: could not convert"),
        (SSV.replace('"UTF-8"', '"UTF-99"'), "no XML"),
        ("<a/>", "no parameter set of SSP"),
        ("m1 = 7", "no XML"),
    ],
)
def test_a_bad_set_is_refused_with_its_file_and_parameter(model, tmp_path, text, complaint):
    path = tmp_path / "bad.ssv"
    path.write_text(text)
    with pytest.raises(ZSpringError, match=f"bad.ssv: .*{complaint}") as error:
        read_set(path, model)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_types_of_ssp_2_are_those_of_fmi_2(model, tmp_path, version):
    path = tmp_path / "set.ssv"
    parameters = [
        parameter("m1", 'Float64 value="7.5"'),
        parameter("zspring.k", 'Float32 value="13" unit="N/mm"'),
        parameter("solver.max_iterations", 'Int64 value="7"'),
        parameter("friction", 'Int8 value="2"'),
        '<ssv:Parameter name="drive"><ssv:Enumeration><ssv:Value value="Wire"/></ssv:Enumeration></ssv:Parameter>',
    ]
    path.write_text(SSV.format("".join(parameters)).replace('version="1.0" n', f'version="{version}" n'))
    expected = {"m1": 7.5, "zspring.k": 13e3, "solver.max_iterations": 7, "friction": 2, "drive": 3}
    assert read_set(path, model) == expected
    path.write_text(path.read_text().replace('<ssv:Value value="Wire"/>', 2 * '<ssv:Value value="Wire"/>'))
    with pytest.raises(ZSpringError, match="drive has 2 values: must be one"):
        read_set(path, model)


def test_a_unit_of_a_parameter_without_one_may_be_defined(model, tmp_path):
    path = tmp_path / "set.ssv"
    percent = '<ssc:Unit name="%"><ssc:BaseUnit factor="0.01"/></ssc:Unit>'
    text = SSV.format(parameter("solver.alpha", 'Real value="-25" unit="%"'))
    path.write_text(text.replace("<ssv:Units>", f"<ssv:Units>{percent}"))
    assert read_set(path, model) == {"solver.alpha": -0.25}


def test_a_prefix_chooses_one_component_of_a_systems_set(model, tmp_path):
    path = tmp_path / "system.ssv"
    names = {"train.pantograph.zspring.k": 9000, "train.pantograph.m1": 7, "line.m1": 99}
    path.write_text(SSV.format("".join(parameter(name, f'Real value="{v}"') for name, v in names.items())))
    assert chosen_set(f"{path}#train.pantograph", model) == {"zspring.k": 9000.0, "m1": 7.0}
    assert chosen_set(f"{path}#line", model) == {"m1": 99.0}
    told = (
        f"no parameter 'train.pantograph.zspring.k' in the FMU; to read those of 'train.pantograph' give {path}#train"
    )
    with pytest.raises(ZSpringError, match=re.escape(told)):
        chosen_set(str(path), model)
    with pytest.raises(ZSpringError, match=r"system\.ssv: no parameter whose name begins with panto\."):
        chosen_set(f"{path}#panto", model)
    with pytest.raises(ZSpringError, match=r"no parameter 'pantograph\.zspring\.k' in the FMU"):
        chosen_set(f"{path}#train", model)
    hash_in_name = path.rename(tmp_path / "a#line.ssv")
    with pytest.raises(ZSpringError, match=r"a#line\.ssv#train\.pantograph$"):
        chosen_set(str(hash_in_name), model)


def test_a_set_of_which_the_command_uses_nothing_is_refused(model, tmp_path):
    path = tmp_path / "set.ssv"
    write_set(path, model, model.variables.parse_assignments(["drive=Wire", "bench.frequency=3"]), "mine", "")
    status, _, err = in_process("frf", "--parameters", path, "--output", tmp_path / "out")
    assert (status, err) == (
        1,
        f"zspring: {path}: the command itself sets drive, bench.frequency: nothing of the set is used\n",
    )
    assert not (tmp_path / "out").exists()


def test_frf_takes_a_set_by_name_and_an_assignment_before_it(tmp_path):
    options = ["--amplitudes", "1", "--frequencies", "1.5,3", "--set", "solver.step=2e-4", "--set", "m2=6"]
    zspring(tmp_path, "frf", "--parameters", "dsa-250", *options, "--tolerance", "1e-5", "--output", "out")
    table = dict(PUBLISHED["DSA-250"]) | {"m2": 6.0}
    linear = LinearPantograph(head=table.pop("k1"), **table)
    for (_, frequency), value in receptances(tmp_path / "out/frf.csv").items():
        assert abs(value / linear.receptance(frequency) - 1) < 1e-3
    assert "# k1: 8380 N/m" in head(tmp_path / "out/frf.csv")


def test_simulate_takes_a_set_from_a_file(model, tmp_path):
    values = model.variables.parse_assignments(["suspension=Linear", "m3=4.5", "drive=Displacement"])
    write_set(tmp_path / "mine.ssv", model, values, "mine", "")
    zspring(tmp_path, "simulate", "--parameters", "mine.ssv", "--stop", "0.1", "--output", "out")
    lines = head(tmp_path / "out/simulation.csv")
    assert {"# m3: 4.5 kg", "# suspension: Linear", "# drive: Displacement"} <= set(lines)


def test_info_lists_the_sets_and_an_unknown_one_is_refused_with_them(tmp_path):
    out, _ = zspring(tmp_path, "info", "--sets")
    _, err = zspring(tmp_path, "frf", "--parameters", "dsa380", status=1)
    assert len(err.splitlines()) == 1 and "did you mean dsa-380" in err
    assert all(name in err for name in packaged_sets())
    for name in [*packaged_sets(), *packaged_sets(LINES)]:
        assert re.search(rf"^  {name}$", out, re.MULTILINE)


@pytest.mark.parametrize(
    ("name", "kind", "more"), [("dsa-380", PANTOGRAPHS, []), ("benchmark-2015", LINES, ["--catenary"])]
)
def test_info_writes_a_set_to_edit_and_keeps_what_is_there(tmp_path, name, kind, more):
    path = tmp_path / "mine.ssv"
    command = ["info", "--sets", name, "--write", path, *more]
    assert in_process(*command) == (0, f"written: {path}\n", "")
    assert path.read_bytes() == packaged_sets(kind)[name].read_bytes()
    path.write_text("edited")
    assert in_process(*command) == (1, "", f"zspring: {path} exists and is kept: name another file\n")
    assert path.read_text() == "edited"


@pytest.mark.parametrize("names", [[], ["dsa-380", "dsa-250"], ["mine"], ["--catenary", "dsa-380"]])
def test_info_writes_one_set_that_there_is(tmp_path, names):
    status, _, err = in_process("info", "--sets", *names, "--write", tmp_path / "mine.ssv")
    assert status == 1 and err.startswith("zspring: --write: needs --sets and the name of one set of ")
    assert in_process("info", "dsa-380", "--write", tmp_path / "mine.ssv")[2] == err or "--catenary" in names
    assert list(tmp_path.iterdir()) == []


def test_info_describes_the_sets_that_are_named(tmp_path):
    status, out, _ = in_process("info", "--sets", "dsa-250")
    assert status == 0 and out.splitlines()[:2] == ["Pantographs, for --parameters", "  dsa-250"] and "Lines" not in out
    assert in_process("info", "--sets", "dsa250")[2].startswith("zspring: no set 'dsa250'; did you mean dsa-250")


def test_the_two_mass_set_is_the_two_mass_model(model):
    """Against the closed form of two masses, as good as the stiff spring stands for the base: k2 / k3."""
    values = read_set(find_set("en-50318-2002"), model)
    rods = {f"zspring.J{i}": 0.0 for i in (1, 2)}
    frequency = np.array([0.7, 2.5, 6.0, 15.0])
    s = 2j * np.pi * frequency
    head_part, base = values["k1"] + values["c1"] * s, values["k2"] + values["c2"] * s
    frame = values["m2"] * s**2 + base
    exact = 1 / (values["m1"] * s**2 + head_part * frame / (head_part + frame))
    found = receptance(frequency, {**values, **rods}, "linear")
    np.testing.assert_allclose(found, exact, rtol=1e-4)
