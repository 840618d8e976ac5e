"""Line files: what they say reaches the table, like spans are the parameters' line, what they cannot say is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catenary_line import BENCHMARK_2015, EN_50318_2002
from paths import ROOT
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line_file.chosen import line_of
from zspring.line_file.design import Line, read_line
from zspring.line_file.statics import at_rest, elasticity
from zspring.parameter_sets import LINES, chosen_set

EXAMPLES = ROOT / "resources" / "lines"

SMALL = """
name = "small"
spans = 3
[contact_wire]
mass = 1.35
tension = 2e4
EI = 195
[messenger]
mass = 1.07
tension = 1.6e4
EI = 130
[damping]
mass = 0.0125
stiffness = 1e-4
[support]
encumbrance = 1.2
stiffness = 5e4
[dropper]
EA = 2e5
mass = 0.1
clamp_contact = 0.165
clamp_messenger = 0.195
[span]
length = 50
droppers = [5, 15, 25, 35, 45]
"""


@pytest.fixture(scope="module")
def catenary() -> Iterator[Fmu]:
    with Fmu(installed_fmu(CATENARY)) as fmu:
        yield fmu


def read(folder: Path, catenary: Fmu, text: str) -> Line:
    (folder / "line.toml").write_text(text, encoding="utf-8")
    return read_line(folder / "line.toml", catenary)


def test_defaults_and_exceptions_come_to_their_places(tmp_path, catenary):
    """Numbers by hand."""
    more = """
gradient = 0.002
sag = [0, 0.01, 0.02, 0.01, 0]
[steady_arm]
mass = 1.5
length = 1.25
radial_load = 500
[stitch]
length = 14
tension = 3000
mass = 0.3
clamp = 0.4
[[span_exception]]
spans = [2]
length = 40
gradient = -0.001
droppers = [5, 20, 36]
dropper_length = [1.1, 1.0, 1.15]
length_error = [0, 0.005, 0]
missing = 3
dropper = { stiffness = 1e5, clamp_contact = [0.1, 0.2, 0.3] }
[[support_exception]]
after_spans = [0, 2]
encumbrance = 1.4
[[support_exception]]
after_spans = 2
stitch = { tension = 2500 }
steady_arm = { stiffness = 250 }
[[support_exception]]
after_spans = 1
stitch = false
stiffness = 1e5
[[point_mass]]
span = 3
at = 10
wire = "messenger"
mass = 7
[[point_mass]]
span = 1
at = 30
wire = "contact_wire"
mass = 4
"""
    line = read(tmp_path, catenary, SMALL + more)
    table = line.table
    np.testing.assert_allclose(table.supports["x"], [0, 50, 90, 140])
    np.testing.assert_allclose(table.supports["messenger"], [1.4, 0.1 + 1.2, 0.06 + 1.4, 0.16 + 1.2])
    assert table.supports[["stiffness", "arm_mass", "arm_stiffness"]].tolist() == [
        (0, 0, 0), (1e5, 1.5, 400), (5e4, 1.5, 250), (0, 0, 0)
    ]  # fmt: skip
    np.testing.assert_allclose(table.ends, [0, 0.16])
    np.testing.assert_allclose(table.droppers["x"], [5, 15, 25, 35, 45, 55, 70, 86, 95, 105, 115, 125, 135])
    np.testing.assert_allclose(table.droppers["upper"], [0] * 7 + [1, 1, 0, 0, 0, 0])
    heights = [0.01, 0.02, 0.03, 0.06, 0.09, 0.095, 0.08, 0.064, 0.07, 0.08, 0.09, 0.12, 0.15]
    np.testing.assert_allclose(table.droppers["height"], heights)
    np.testing.assert_allclose(table.droppers["EA"], [2e5] * 5 + [0] * 3 + [2e5] * 5)
    np.testing.assert_allclose(table.droppers["stiffness"], [0] * 5 + [1e5] * 3 + [0] * 5)
    np.testing.assert_allclose(table.droppers["clamp_contact"], [0.165] * 5 + [0.1, 0.2, 0.3] + [0.165] * 5)
    np.testing.assert_allclose(table.droppers["clamp_upper"], 0.195)
    np.testing.assert_allclose(table.droppers["length"], [0] * 5 + [1.1, 1.0, 1.15] + [0] * 5)
    np.testing.assert_allclose(table.droppers["length_error"], [0] * 6 + [0.005, 10] + [0] * 5)
    assert table.stitches.tolist() == [(83, 97, 2500, 0.3, 0.4)]
    assert table.masses.tolist() == [(30, 0, 4), (100, 1, 7)]
    assert line.first_droppers == [0, 5, 8, 13]


def test_two_contact_wires_are_one_with_both_their_properties(tmp_path, catenary):
    one = read(tmp_path, catenary, SMALL).parameters
    two = read(tmp_path, catenary, "contact_wires = 2\n" + SMALL).parameters
    for name, value in one.items():
        assert two[name] == (2 if name.startswith("contact_wire.") else 1) * value


@pytest.mark.parametrize(
    "name, reference", [("en-50318-2002", EN_50318_2002), ("benchmark-2015", BENCHMARK_2015)], ids=["2002", "2015"]
)
def test_like_spans_by_file_are_the_parameters_line(catenary, name, reference):
    """Bit for bit, under a force that moves; and its elasticity is that of independent finite elements."""
    line, parameters = line_of(str(EXAMPLES / f"{name}.toml"), catenary), chosen_set(name, catenary, LINES)
    start = {"pantograph[1].start": 100.0}, {"pantograph[1].speed": 70.0, "pantograph[1].force": 150.0}
    outputs = ["pantograph[1].wire_height", "pantograph[1].uplift", "support.uplift[3]", "droppers.force_max"]
    found = []
    for fmu, given in (line.catenary, line.parameters), (catenary, parameters):
        with fmu.instances() as (instance,):
            instance.start({**given, **start[0]}, start[1])
            for i in range(200):
                instance.step(i * 5e-3, 5e-3)
            found.append([*instance.get(outputs), instance.get(["line.length"])])
    assert found[0] == found[1]
    places = [4 * reference.span, 4.5 * reference.span, 4.7 * reference.span]
    contact = reference.wires[0]
    expected = [(contact.at(x) @ reference.equilibrium([x], [100.0])[0])[0] / 100 for x in places]
    np.testing.assert_allclose(elasticity(line.catenary, line.parameters, places), expected, rtol=1e-9)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_examples_are_lines_that_the_fmu_takes(catenary, path):
    line = line_of(str(path), catenary)
    with line.catenary.instances() as (instance,):
        instance.start(line.parameters)
        assert instance.get(["droppers.slack"]) == [0]


def with_change(old: str, new: str) -> str:
    assert old in SMALL
    return SMALL.replace(old, new)


EXCEPTION = "[[span_exception]]\nspans = 2\n"


@pytest.mark.parametrize(
    "text, told",
    [
        (SMALL.replace("spans = 3", ""), "spans is missing: their number, up to 400"),
        (with_change("spans = 3", "spans = 401"), "spans = 401: must be at most 400"),
        (with_change("EI = 195", "EI = 195\nEA = 1e7"), "[contact_wire]: EA: the wires' tension is constant"),
        (with_change("EI = 195", ""), "[contact_wire]: EI is missing"),
        (with_change("tension = 2e4", "tension = -1"), "[contact_wire] tension = -1: must be a number above 0"),
        (with_change("stiffness = 5e4", "stiffness = 5e4\ndamping = 100"), "[support]: damping: damping is Rayleigh's"),
        (with_change("EA = 2e5", ""), "span 1: [dropper] stiffness or EA is missing"),
        (with_change("EA = 2e5", "EA = 0"), "span 1, dropper 1: stiffness or EA = 0: must be above 0"),
        (with_change("EA = 2e5", "EA = 2e5\nstiffness = 1e5"), "[dropper]: EA and stiffness: give one of both"),
        (with_change("mass = 0.1\n", "mass = [0.1]\n"), "span 1: mass: 1 values for 5 droppers"),
        (with_change("mass = 0.1\n", "mass = [0.1, -1]\n"), "[dropper] mass = [0.1, -1]: must be a number of 0"),
        (with_change("length = 50\n", ""), "span 1: length is missing"),
        (SMALL + "sag = 0.1\ndropper_length = 1", "[span]: dropper_length and sag: give one of both"),
        (SMALL + "dropper_length = 0", "span 1: dropper_length = 0: must be above 0"),
        (SMALL + "encumbrance = 1", "[span]: encumbrance: it is told of supports"),
        (SMALL + "dropers = 1", "[span]: unknown key 'dropers'; did you mean droppers"),
        (SMALL + "missing = 6", "span 1: missing = 6: must be in 1 .. 5"),
        (SMALL + f"{EXCEPTION}length = 30", "span 2, dropper 4: at 35 m: must be after the dropper before"),
        (SMALL + f"{EXCEPTION}droppers = [5, 5]", "span 2, dropper 2: at 5 m: must be after"),
        (SMALL + f"{EXCEPTION}sag = [0, 0]", "span 2: sag: 2 values for 5 droppers"),
        (SMALL + f"{EXCEPTION}sag = 0\n{EXCEPTION}sag = 1", "[[span_exception]] spans = 2: sag is told twice"),
        (SMALL + "[[span_exception]]\nspans = [4]\nsag = 0", "[[span_exception]] spans = 4: must be in 1 .. 3"),
        (SMALL + "[[support_exception]]\nafter_spans = 4", "[[support_exception]] after_spans = 4: must be in 0 .. 3"),
        (SMALL + "[[support_exception]]\nafter_spans = 0\nstiffness = 1", "after span 0: stiffness: an anchor has"),
        (SMALL + "[stitch]\nlength = 14\nmass = 1", "stitch wire after span 1: tension is missing"),
        (SMALL + "[steady_arm]\nlength = 1", "[steady_arm]: length and radial_load: the stiffness is made of both"),
        (SMALL + '[[point_mass]]\nspan = 4\nat = 1\nwire = "messenger"\nmass = 1', "[[point_mass]] span = 4: must be"),
        (SMALL + '[[point_mass]]\nspan = 3\nat = 51\nwire = "messenger"\nmass = 1', "span 3: [[point_mass]] at = 51 m"),
        (f'parameters = "no-such"\n{SMALL}', "no-such: no such file, and no set of that name"),
    ],
)  # fmt: skip
def test_what_a_line_file_cannot_say_is_told_in_one_line(tmp_path, catenary, text, told):
    with pytest.raises(ZSpringError) as error:
        read(tmp_path, catenary, text)
    assert str(error.value).startswith(f"{tmp_path / 'line.toml'}: ")
    assert told in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text, told",
    [
        (SMALL + "sag = [0, 0.5, 0, 0.5, 0]", "span 1, dropper 2, at 15 m: in the static state the dropper would have"),
        (SMALL + "[stitch]\nlength = 60\nmass = 0.3\ntension = 3e3", "a stitch wire from 70 m to 130 m"),
        (SMALL + "[stitch]\nlength = 14\nmass = 0.3\ntension = 2e4", "tension"),
        (SMALL + "[stitch]\nlength = 14.001\nmass = 0.3\ntension = 3e3\n[[point_mass]]\nspan = 1\nat = 43\n"
         'wire = "messenger"\nmass = 1', "places on the line"),
        (SMALL.replace("encumbrance = 1.2", "encumbrance = 0.2"), "the dropper would be"),
    ],
)  # fmt: skip
def test_what_no_line_can_be_the_fmu_tells_with_its_span(tmp_path, catenary, text, told):
    line = read(tmp_path, catenary, text)
    with pytest.raises(ZSpringError) as error:
        catenary.with_line(line.table).used_parameters(line.parameters)
    assert told in str(error.value) and "\n" not in str(error.value)


def test_a_parameter_that_the_table_stands_for_cannot_be_set(tmp_path, catenary):
    line = line_of(str(EXAMPLES / "benchmark-2015.toml"), catenary)
    with pytest.raises(ZSpringError, match=r"line\.span"):
        line.catenary.used_parameters({**line.parameters, "line.span": 50.0})


# Tables of what was measured


def measured(folder: Path, catenary: Fmu, rows: str, settings: str) -> np.ndarray:
    (folder / "found.csv").write_text(rows, encoding="utf-8")
    return read(folder, catenary, f'{SMALL}\n[measured]\nfile = "found.csv"\n{settings}').table.droppers


def test_measured_heights_take_the_place_of_the_design_s(tmp_path, catenary):
    rows = "span;dropper;height [mm]\n1;2;5290,5\n3;5;5302\n2;1;\n"
    found = measured(tmp_path, catenary, rows, "datum = 5.3")
    expected = np.zeros(15)
    expected[[1, 14]] = -0.0095, 0.002
    np.testing.assert_allclose(found["height"], expected, atol=1e-12)
    assert not found["length"].any()


def test_measured_lengths_make_the_heights(tmp_path, catenary):
    rows = "span,dropper,length [m],height [m]\n2,3,1.05,5.3\n"
    found = measured(tmp_path, catenary, rows, 'use = "lengths"\nlengths = "unstretched"')
    assert found["length"].tolist() == [0] * 7 + [1.05] + [0] * 7


def test_installed_lengths_are_those_under_load(tmp_path, catenary):
    """What the droppers of a line with length errors measure, read as installed, gives that line back."""
    wrong = np.random.default_rng(5).normal(0, 0.003, 15)
    straight = read(tmp_path, catenary, SMALL)
    droppers = straight.table.droppers.copy()
    droppers["length_error"] = wrong
    built = replace(straight.table, droppers=droppers)
    lengths = at_rest(catenary.with_line(built), straight.parameters, droppers["x"]).dropper_length
    rows = "span,dropper,length [m]\n" + "\n".join(
        f"{i // 5 + 1},{i % 5 + 1},{x!r}" for i, x in enumerate(lengths.tolist())
    )
    found = measured(tmp_path, catenary, rows, 'lengths = "installed"')
    again = replace(straight.table, droppers=found)
    rest = [at_rest(catenary.with_line(table), straight.parameters, np.arange(1, 150.0)) for table in (built, again)]
    np.testing.assert_allclose(rest[1].contact_wire, rest[0].contact_wire, atol=1e-5)
    assert np.ptp(rest[0].contact_wire) > 5e-3
    with pytest.raises(
        ZSpringError, match=r"span 2, dropper 3: 1\.5 m long under load: no dropper between these wires is"
    ):
        measured(tmp_path, catenary, "span,dropper,length [m]\n2,3,1.5\n", 'lengths = "installed"')


@pytest.mark.parametrize(
    "rows, settings, told",
    [
        ("span,dropper,height [m]\n1,1,5.3", "", "[measured] datum is missing"),
        ("span,dropper,length [m]\n1,1,1.3", "", "[measured] lengths is missing"),
        (
            "span,dropper,height [m]\n1,1,5.3",
            "datum = 5.3\n[[span_exception]]\nspans = 2\nlength_error = 0.02",
            "[measured] heights are those of the contact wire at rest, which dropper_length, length_error and missing",
        ),
        ("span,dropper,length [m],height [m]\n1,1,1.3,5", "", 'has heights and lengths, of which one makes the other'),
        ("span,dropper,height [m]\n1,1,5", 'use = "lengths"', "no column 'length'"),
        ("span,dropper\n1,1", "", "no column 'height' and no column 'length'"),
        ("span,dropper,height\n1,1,5", "datum = 5", "column 'height' needs its unit"),
        ("span,dropper,height [m]\n4,1,5", "datum = 5", "line 2: span = 4: must be in 1 .. 3"),
        ("span,dropper,height [m]\n2,6,5", "datum = 5", "line 2: dropper = 6: must be in 1 .. 5"),
        ("span,dropper,height [m]\n2,1.5,5", "datum = 5", "line 2: dropper = 1.5: must be in 1 .. 5"),
        ("span,dropper,height [m]\n2,1,5\n2,1,5", "datum = 5", "line 3: span 2, dropper 1 comes twice"),
        ("span,dropper,length [m]\n2,1,-5", 'lengths = "unstretched"', "line 2: length = -5 m: must be above 0"),
    ],
)  # fmt: skip
def test_a_table_of_measured_values_that_could_mean_two_things_is_asked_about(tmp_path, catenary, rows, settings, told):
    with pytest.raises(ZSpringError) as error:
        measured(tmp_path, catenary, rows, settings)
    assert told in str(error.value) and "\n" not in str(error.value)


def profile(folder: Path, catenary: Fmu, x: np.ndarray, height: np.ndarray) -> np.ndarray:
    rows = "\n".join(f"{a!r},{b!r}" for a, b in zip(x.tolist(), height.tolist()))
    (folder / "profile.csv").write_text(f"position [m],height [mm]\n{rows}\n", encoding="utf-8")
    return read(folder, catenary, f'{SMALL}\n[irregularity]\nfile = "profile.csv"').table.profile


def test_an_irregularity_is_as_smooth_as_what_was_measured(tmp_path, catenary):
    """Slopes of a sine are its cosine."""
    x = np.arange(-2.0, 153.0, 0.25)
    found = profile(tmp_path, catenary, x, 5 * np.sin(2 * np.pi * x / 7))
    inner = (x > 5) & (x < 145)
    np.testing.assert_allclose(found["height"], 5e-3 * np.sin(2 * np.pi * x / 7), atol=1e-15)
    expected = 5e-3 * 2 * np.pi / 7 * np.cos(2 * np.pi * x / 7)
    np.testing.assert_allclose(found["slope"][inner], expected[inner], atol=7e-8)  # (k h)^4 / 180 of it


def test_an_irregularity_within_the_line_begins_and_ends_level(tmp_path, catenary):
    x = np.linspace(40, 60, 21)
    found = profile(tmp_path, catenary, x, 5 * np.sin(np.pi * (x - 40) / 20) ** 2)
    np.testing.assert_allclose(found["slope"][[0, -1]], 0, atol=1e-15)
    for wrong, told in ((5 + 0 * x, "height = 0.005 m at 40 m, an end within the line"), (x[:1], "1 rows")):
        with pytest.raises(ZSpringError, match=told):
            profile(tmp_path, catenary, x, wrong)
    with pytest.raises(ZSpringError, match=r"line 3: position: must be above that of the row before"):
        profile(tmp_path, catenary, np.array([1.0, 1.0, 2.0]), np.zeros(3))


def test_pantographs_meet_an_irregularity_whatever_the_elements_are(tmp_path, catenary):
    """Waves of 0.7 m under elements of 1 m: what comes to the wire is the sine, at any place."""
    x = np.arange(-2.0, 153.0, 0.05)
    profile(tmp_path, catenary, x, 2 * np.sin(2 * np.pi * x / 0.7))
    line = read_line(tmp_path / "line.toml", catenary)
    without = replace(line.table, profile=line.table.profile[:0])
    places = np.linspace(1, 149, 333)
    one, other = (
        at_rest(catenary.with_line(table), line.parameters, places).contact_wire for table in (line.table, without)
    )
    np.testing.assert_allclose(one - other, 2e-3 * np.sin(2 * np.pi * places / 0.7), atol=1e-6)


def test_rates_under_a_pantograph_that_runs_over_an_irregularity(tmp_path, catenary):
    """Velocity of the wire, and the slopes of height and velocity that the FMU tells, against central differences."""
    x, step, speed = np.arange(-2.0, 153.0, 0.05), 1e-4, 50.0
    profile(tmp_path, catenary, x, 2 * np.sin(8 * x))
    line = read_line(tmp_path / "line.toml", catenary)
    names, rows = ["pantograph[1].wire_height", "pantograph[1].wire_velocity"], []
    inputs = {"pantograph[1].force": 120.0, "pantograph[1].speed": speed}
    with catenary.with_line(line.table).instances() as (instance,):
        instance.start({**line.parameters, "pantograph[1].start": 60.02, "solver.step": step}, inputs)
        for i in range(190):  # within one element, whose ends are corners of the curvature
            instance.step(i * step, step)
            rows.append([*instance.get(names), *instance.get_slopes(names)])
    height, velocity, of_height, of_velocity = np.array(rows)[20:].T
    for rate, of, most in (velocity, height, 0.8), (of_height, height, 0.8), (of_velocity, velocity, 320.0):
        assert np.abs(rate).max() == pytest.approx(most, rel=0.2)  # 2 mm times 8 / m and 50 m/s, once or twice
        np.testing.assert_allclose(rate[1:-1], (of[2:] - of[:-2]) / (2 * step), atol=5e-3 * most)
