"""Lines that are not as designed: their irregularities, that heads share them, what is told of differences."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.signal import periodogram
from scipy.stats import spearmanr, ttest_rel

from commands import PNG, in_process, table, zspring
from paths import ROOT
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line_file.design import read_line
from zspring.line_table import NEVER_PULLS, PROFILE, LineTable
from zspring.settings import tomllib
from zspring.study.compare import Runner, difference_table, differences
from zspring.study.coupled import CoupledQuantity
from zspring.study.design import make_cases
from zspring.study.files import StudyRecord, column_of
from zspring.study.head import first_start, study_head
from zspring.study.irregular import Irregularity, Roughness
from zspring.study.sensitivity import correlation_doubts, correlations
from zspring.study.settings import StudySettings, read_study
from zspring.study.workers import StudyPlugin

LINE = ROOT / "resources/lines/en-50318-2002.toml"
GRID = f'design = "grid"\n[couple]\nline = "{LINE.as_posix()}"\n'
Pair = tuple[Fmu, Fmu]


@pytest.fixture(scope="module")
def fmus() -> Iterator[Pair]:
    with Fmu() as pantograph, Fmu(installed_fmu(CATENARY)) as catenary:
        yield pantograph, catenary


@pytest.fixture(scope="module")
def design(fmus) -> LineTable:
    return read_line(LINE, fmus[1]).table


def study_of(text: str, fmus: Pair, folder: Path) -> StudySettings:
    (folder / "study.toml").write_text(text)
    return read_study(folder / "study.toml", *fmus)


# Realisations


def test_dropper_lengths_scatter_as_told_and_scale_from_study_to_study(design):
    """90 droppers of each of 40 lines: a standard deviation to 1 / sqrt(2 x 3600), which is 1.2 %; no mean."""
    lines = Irregularity(design, seed=3)
    errors = np.array([lines.line(n, {"dropper_length": 0.004}).droppers["length_error"] for n in range(1, 41)])
    assert errors.std() == pytest.approx(0.004, rel=0.05) and abs(errors.mean()) < 4 * 0.004 / 60
    assert len(np.unique(errors)) == errors.size
    twice = lines.line(7, {"dropper_length": 0.008}).droppers["length_error"]
    np.testing.assert_allclose(twice, 2 * errors[6], rtol=1e-15)
    other = Irregularity(design, seed=4).line(7, {"dropper_length": 0.004}).droppers["length_error"]
    assert not np.any(other == errors[6])
    unchanged = lines.line(7, {})
    assert unchanged.content == design.content and unchanged.digest == design.digest


def test_one_kind_of_irregularity_leaves_the_others_as_they_are(design):
    lines = Irregularity(design, seed=1)
    lengths = lines.line(5, {"dropper_length": 0.004}).droppers["length_error"]
    more = lines.line(5, {"dropper_length": 0.004, "missing": 0.2, "slack": 0.3, "slack_by": 0.02, "clamp_mass": 0.1})
    is_missing = more.droppers["length_error"] == NEVER_PULLS
    by = more.droppers["length_error"] - lengths
    is_slack = ~is_missing & (np.abs(by - 0.02) < 1e-12)
    assert is_slack.sum() > 10 and is_missing.sum() > 5
    np.testing.assert_allclose(by[~is_missing & ~is_slack], 0, atol=1e-15)
    for name in ("clamp_contact", "clamp_upper"):
        factor = more.droppers[name] / design.droppers[name]
        assert factor.std() == pytest.approx(0.1, rel=0.3) and np.all(np.abs(factor - 1) <= 0.3 + 1e-12)


def test_shares_and_tensions_are_those_told(design):
    lines = Irregularity(design, seed=1)
    numbers = range(1, 201)
    found = [lines.line(n, {"missing": 0.05}).droppers["length_error"] == NEVER_PULLS for n in numbers]
    assert np.mean(found) == pytest.approx(0.05, abs=4 * (0.05 * 0.95 / 18000) ** 0.5)
    tensions = [lines.tensions(n, {"contact_tension": 0.02, "messenger_tension": 0.03}) for n in numbers]
    both = np.array([[each[f"{wire}.tension"] for wire in ("contact_wire", "messenger")] for each in tensions])
    np.testing.assert_allclose(both.std(axis=0), [0.02, 0.03], rtol=0.2)
    assert np.abs(both - 1).max() <= 0.09 + 1e-12 and abs(np.corrcoef(both.T)[0, 1]) < 0.25


def test_a_contact_wire_has_the_spectrum_told(design):
    """Against the mean periodogram of 200 lines, summed over bands of 30 lines of the spectrum or more: to 6 %."""
    wavenumber = np.geomspace(1 / 60, 1 / 2, 300)
    spectrum = wavenumber**-2.0
    spectrum /= np.trapezoid(spectrum, wavenumber)
    lines = Irregularity(design, 1, Roughness(wavenumber, spectrum))
    profiles = [lines.line(n, {"contact_wire": 0.002}).profile for n in range(1, 201)]
    x = profiles[0]["x"]
    assert x[0] == 0 and x[-1] == pytest.approx(600)
    k, power = periodogram([each["height"][:-1] for each in profiles], fs=1 / (x[1] - x[0]), detrend=False)
    for low, high in ((1 / 50, 1 / 20), (1 / 20, 1 / 8), (1 / 8, 1 / 4), (1 / 4, 1 / 2.2)):
        inside = (k >= low) & (k < high)
        expected = 0.002**2 * np.interp(k[inside], wavenumber, spectrum).sum()
        assert power.mean(axis=0)[inside].sum() == pytest.approx(expected, rel=0.06), (low, high)
    heights = np.array([each["height"] for each in profiles])
    assert heights.std() == pytest.approx(0.002, rel=0.03)


@pytest.mark.parametrize("shortest, longest", [(310.0, 330.0), (1.0, 600.0), (590.0, 600.0)])
def test_a_contact_wire_has_the_deviation_told_whatever_its_waves(design, shortest, longest):
    """Also where few waves, or none, repeat after twice the line's length: to four errors of the mean of 400 lines."""
    wavenumber = np.geomspace(1 / longest, 1 / shortest, 400)
    spectrum = wavenumber**-2.0
    spectrum /= np.trapezoid(spectrum, wavenumber)
    lines = Irregularity(design, 1, Roughness(wavenumber, spectrum))
    squares = [np.mean(lines.line(n, {"contact_wire": 0.002}).profile["height"] ** 2) for n in range(1, 401)]
    error = np.std(squares) / len(squares) ** 0.5
    assert error < 0.06 * 0.002**2 and np.mean(squares) == pytest.approx(0.002**2, abs=4 * error)


@pytest.mark.parametrize("wavenumber, told", [([1 / 601, 1], "601 m"), ([0, 1], "inf m")])
def test_waves_longer_than_the_line_are_refused(design, wavenumber, told):
    told = f"contact_wire: waves of up to {told}: must be no longer than the line, 600 m"
    with pytest.raises(ZSpringError, match=told):
        Irregularity(design, 1, Roughness(np.array(wavenumber), np.ones(2)))
    Irregularity(design, 1, Roughness(np.array([0, 1 / 600, 1]), np.array([0.0, 0.0, 1.0])))


def test_between_its_points_a_contact_wire_is_as_smooth_as_its_waves(design):
    """The cubic between two points against the wave through many: less than 1 % off where waves are shortest."""
    wavenumber = np.array([0.45, 0.5])
    lines = Irregularity(design, 1, Roughness(wavenumber, np.full(2, 20.0)))
    profile = lines.line(1, {"contact_wire": 0.001}).profile
    between = profile["x"][50:-50] + 0.37 * (profile["x"][1] - profile["x"][0])
    cubic = CubicHermiteSpline(profile["x"], profile["height"], profile["slope"])(between)
    smooth = CubicSpline(profile["x"], profile["height"])(between)
    assert np.abs(smooth).max() > 5e-4 and np.abs(cubic - smooth).max() < 0.02 * np.abs(smooth).max()


def test_a_measured_profile_is_laid_along_each_line_from_another_place(design):
    x = np.arange(0, 1850, 0.5)
    measured = np.zeros(len(x), PROFILE)
    measured["x"], measured["height"], measured["slope"] = x, np.sin(x / 9), np.cos(x / 9) / 9
    lines = Irregularity(design, 1, Roughness(profile=measured))
    first, second = (lines.line(n, {"contact_wire": 0.003}).profile for n in (1, 2))
    for profile in (first, second):
        assert profile["x"][0] <= 0 < profile["x"][1] and profile["x"][-2] < 600 <= profile["x"][-1]
        waves = np.column_stack([np.sin(profile["x"] / 9), np.cos(profile["x"] / 9), np.ones(len(profile))])
        (a, b, _), rest, *_ = np.linalg.lstsq(waves, profile["height"], rcond=None)
        assert np.hypot(a, b) == pytest.approx(0.003, rel=1e-9) and rest[0] < 1e-20
    assert abs(first["height"][3] - second["height"][3]) > 1e-5
    with pytest.raises(ZSpringError, match="profile: 1799 m: must be at least 3 times as long as the line, 1800 m"):
        Irregularity(design, 1, Roughness(profile=measured[x <= 1799]))
    told = "profile: 3.1 times as long as the line, 4 lines cut out of it overlap"
    assert not lines.doubts(3) and lines.doubts(4)[0].startswith(told)


# Studies


def test_lines_without_irregularity_are_the_line_of_the_parameters(fmus, tmp_path):
    """Also between: a case's own tensions reach the FMU."""
    same = 'design = "grid"\n[couple]\nline = "en-50318-2002"\nspans = [3, 3]\n[vary]\ncouple.speed = [300]\n'
    by_parameters, by_table = (
        study_of(same, fmus, tmp_path),
        study_of(
            same.replace('"en-50318-2002"', f'"{LINE.as_posix()}"') + "[irregularity]\nlines = 1\n", fmus, tmp_path
        ),
    )
    found = []
    for settings in (by_parameters, by_table):
        (quantity,), (case,) = settings.quantities, make_cases(settings)
        assert isinstance(quantity, CoupledQuantity)
        found.append(quantity.measure(*fmus, settings.parameters_of(case))[0])
    assert found[0].keys() == found[1].keys()
    for name, value in found[0].items():
        if isinstance(value, float):
            assert found[1][name] == pytest.approx(value, rel=1e-9, abs=1e-9, nan_ok=True), name


def test_each_of_the_compared_runs_along_the_same_lines(fmus, tmp_path):
    text = GRID + "spans = [3, 3]\n[vary]\ncouple.speed = [250]\n[irregularity]\nlines = 2\ndropper_length = 0.01\n"
    text += "contact_tension = 0.05\n[compare]\na = {}\nb = { k2 = 9000 }\n"
    settings = study_of(text, fmus, tmp_path)
    cases = make_cases(settings)
    assert [(case["irregularity.line"], case["compare"]) for case in cases] == [(1, 1), (1, 2), (2, 1), (2, 2)]
    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity)
    seen = []
    for case in cases:
        with quantity.on_line(fmus[1], settings.parameters_of(case)) as (catenary, parameters):
            assert catenary.line and (catenary.home / "resources/line.table").is_file()
            seen.append((catenary.line.digest, parameters["catenary.contact_wire.tension"]))
        assert not catenary.home.exists()
    assert seen[0] == seen[1] and seen[2] == seen[3] and seen[0] != seen[2]
    assert 17000 < seen[0][1] < 23000 and seen[0][1] != 20000
    given = settings.parameters_of(cases[0])
    with quantity.on_line(fmus[1], given) as (catenary, _):
        with quantity.on_line(fmus[1], given) as (beside, _):  # as another thread does
            assert beside.guid == catenary.guid
        assert (catenary.home / "resources/line.table").is_file()


def test_a_worker_with_two_threads_computes_what_one_thread_does(fmus, tmp_path):
    """Each case on a line of its own, whose table is in a folder of its own; the working folder stays."""
    text = GRID + "spans = [3, 3]\n[vary]\ncouple.speed = [300]\n[irregularity]\nlines = 4\ndropper_length = 0.01\n"
    settings = study_of(text, fmus, tmp_path)
    given = [settings.parameters_of(case) for case in make_cases(settings)]
    plugin = StudyPlugin("x", *(fmu.path.read_bytes() for fmu in fmus), settings.quantities)
    plugin.setup(SimpleNamespace(local_directory=str(tmp_path)))
    here = os.getcwd()
    with ThreadPoolExecutor(2) as pool:
        side_by_side = list(pool.map(plugin.run, given))
    in_turn = [plugin.run(case) for case in given]
    plugin.teardown(SimpleNamespace())
    assert os.getcwd() == here and not list(tmp_path.glob("zspring-*"))
    for each, other in zip(side_by_side, in_turn):
        assert each["status"] == "ok" and each["mean_force [N]"] == other["mean_force [N]"]
    assert len({each["mean_force [N]"] for each in in_turn}) == 4


@pytest.mark.parametrize(
    "design, expected",
    [
        ('design = "grid"\n[vary]\nm1 = [7, 8]', [1, 2, 3, 1, 2, 3]),
        ('design = "list"\n[vary]\nm1 = [7, 8]', [1, 2, 3, 1, 2, 3]),
    ],
)
def test_which_line_a_case_runs_along(fmus, tmp_path, design, expected):
    text = f'{design}\n[couple]\nline = "{LINE.as_posix()}"\n[irregularity]\nlines = 3\n'
    assert [case["irregularity.line"] for case in make_cases(study_of(text, fmus, tmp_path))] == expected


@pytest.mark.parametrize("design, block", [("latin-hypercube", 1), ("sobol", 4)])
def test_lines_are_drawn_evenly_and_do_not_go_with_the_parameters(fmus, tmp_path, design, block):
    """Along each of 8 lines 16 blocks, whose first and second parameter are spread over most of their range."""
    text = f'design = "{design}"\nsamples = 128\n[vary]\nm1 = {{ from = 7, to = 8 }}\nm2 = {{ from = 7, to = 8 }}\n'
    text += f'[couple]\nline = "{LINE.as_posix()}"\n[irregularity]\nlines = 8\n'
    cases = make_cases(study_of(text, fmus, tmp_path))
    lines = np.array([case["irregularity.line"] for case in cases]).reshape(-1, block)
    assert np.all(lines == lines[:, :1]) and np.bincount(lines[:, 0]).tolist() == [0, *[16] * 8]
    for name in ("m1", "m2"):
        first = np.array([float(case[name]) for case in cases[::block]])
        assert min(np.ptp(first[lines[:, 0] == n]) for n in range(1, 9)) > 0.5


@pytest.mark.parametrize(
    "text, told",
    [
        ("lines = 0", r"lines = 0: must be a whole number of at least 1"),
        ("lines = 3\nmissing = 2", r"irregularity.missing = 2 1: must be at most 1"),
        ("lines = 3\nslack = 0.1", "slack and slack_by: one alone does nothing"),
        ("lines = 3\ncontact_wire = 0.001", "contact_wire: needs wavelengths and exponent, a spectrum or a profile"),
        ("lines = 3\nwavelengths = [1, 50]", "wavelengths and exponent: both make a spectrum"),
        ("lines = 3\nwavelengths = [1, 50]\nexponent = 2", "contact_wire is missing"),
        ("lines = 3\nwavelengths = [50, 1]\nexponent = 2", r"wavelengths = \[50, 1\]: must be \[shortest, longest\]"),
        ('lines = 3\nprofile = "bad.csv"', "bad.csv, line 3: position: must be above that of the row before"),
        ('lines = 3\nspectrum = "negative.csv"', "negative.csv: wavenumber and spectrum: must be at least 0"),
        ("lines = 3\nsag = 1", "unknown key 'sag'"),
        ("lines = 3\n[set]\nirregularity.contact_wire = 0.001", r"\[irregularity\] contact_wire: needs wavelengths"),
        ("lines = 3\n[set]\nirregularity.slack = 0.1", r"\[irregularity\] slack and slack_by: one alone"),
        ("lines = 3\n[compare]\na = {}\nb = { irregularity.contact_wire = 0.001 }", "b: contact_wire: needs wavele"),
        ("lines = 3\n[compare]\na = {}\nb = { irregularity.slack_by = 0.1 }", "b: slack and slack_by: one alone does"),
        ("lines = 3\n[vary]\nirregularity.line = [2]", "no parameter 'irregularity.line'"),
        ("lines = 3\n[set]\nirregularity.line = 2", "no parameter 'irregularity.line'"),
        ("lines = 3\n[compare]\na = { irregularity.line = 2 }", "no parameter 'irregularity.line'"),
    ],
)
def test_an_irregularity_that_cannot_be_meant_is_refused_in_one_line(fmus, tmp_path, text, told):
    (tmp_path / "bad.csv").write_text("position [m],height [mm]\n1,0\n1,1\n")
    (tmp_path / "negative.csv").write_text("wavenumber [1/m],spectrum [m3]\n0.1,1\n0.2,-1\n")
    with pytest.raises(ZSpringError, match=told) as refusal:
        study_of(f"{GRID}[irregularity]\n{text}\n", fmus, tmp_path)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    "text, told",
    [
        ("[vary]\nirregularity.slack = [0.1]", r"\[vary\] irregularity.slack: needs \[irregularity\]"),
        ("[vary]\nm1 = [7]\n[set]\nirregularity.missing = 0.1", r"\[set\] irregularity.missing: needs \[irreg"),
        ("[compare]\na = { irregularity.missing = 0.1 }", r"\[compare\] a: irregularity.missing: needs \[irregularity"),
    ],
)
def test_an_irregularity_of_no_lines_is_refused(fmus, tmp_path, text, told):
    with pytest.raises(ZSpringError, match=told):
        study_of(f"{GRID}{text}\n", fmus, tmp_path)


def test_each_of_the_compared_may_complete_an_irregularity(fmus, tmp_path):
    text = "[irregularity]\nlines = 1\nslack = 0.1\nwavelengths = [1, 50]\nexponent = 2\n[compare]\n"
    text += "".join(
        f"{n} = {{ irregularity = {{ slack_by = {x}, contact_wire = {x} }} }}\n" for n, x in (("a", 0.01), ("b", 0.02))
    )
    settings = study_of(GRID + text, fmus, tmp_path)
    given = [settings.parameters_of(case) for case in make_cases(settings)]
    assert [(each["irregularity.slack_by"], each["irregularity.contact_wire"]) for each in given] == [
        (0.01,) * 2,
        (0.02,) * 2,
    ]


def head_of(settings: StudySettings, fmus: Pair) -> dict[str, str]:
    cases = make_cases(settings)
    return study_head(settings, first_start(settings, cases, *fmus), *fmus, len(cases))


def test_compared_that_changed_places_are_another_study(fmus, tmp_path):
    """A difference would have the other sign."""
    text, entries = f"{GRID}[irregularity]\nlines = 2\n[compare]\n", ["a = { k2 = 8000 }\n", "b = { k2 = 9000 }\n"]
    there, swapped = (
        head_of(study_of(text + "".join(each), fmus, tmp_path), fmus) for each in (entries, entries[::-1])
    )
    rows, other = (
        [{"irregularity.line": line, "compare": name} for line in "12" for name in names] for names in ("ab", "ba")
    )
    path = tmp_path / "study.csv"
    with StudyRecord(path, there, rows, ["y"]) as record:
        record.append(record.row(1, {"status": "ok", "y": 1.0}))
    assert StudyRecord(path, there, rows, ["y"]).missing == [0, 2, 3]
    with pytest.raises(ZSpringError, match=r"of other settings \(compare 1: a: k2=8000, now b: k2=9000\)"):
        StudyRecord(path, swapped, other, ["y"])
    with pytest.raises(ZSpringError, match="is not as it was written"):
        StudyRecord(path, there, other, ["y"])


@pytest.mark.parametrize("names", ["a", "ab"])
def test_the_head_tells_what_the_cases_have(fmus, tmp_path, names):
    """Of what [compare] gives, alike for all, in place of the tables' own."""
    text = f"{GRID}speed = 250\n[irregularity]\nlines = 2\ndropper_length = 0.005\n[compare]\n"
    own = "couple.speed = 200, couple.spacing = 60, irregularity.dropper_length = 0.01, irregularity.missing = 0.02"
    settings = study_of(text + "".join(f"{name} = {{ {own} }}\n" for name in names), fmus, tmp_path)
    told = head_of(settings, fmus)
    for case in make_cases(settings):
        given = settings.parameters_of(case)
        for name in ("couple.speed", "couple.spacing", "irregularity.dropper_length", "irregularity.missing"):
            assert float(told[name.replace(".", " ")]) == given[name]
    assert (told["couple speed"], told["irregularity dropper_length"]) == ("200", "0.01")


def test_the_head_has_no_static_force_that_no_case_has(fmus, tmp_path):
    by_law = study_of(f'{GRID}static_law = "AC"\n[vary]\nm1 = [7]\n', fmus, tmp_path)
    bench = study_of(f'{GRID}static_law = "AC"\n[vary]\nm1 = [7]\n[static]\namplitudes = [0.01]\n', fmus, tmp_path)
    own = study_of(f"{GRID}[vary]\nm1 = [7]\n[set]\nstatic_force = 80\n", fmus, tmp_path)
    assert head_of(bench, fmus)["static_force"].endswith(" N")  # the bench knows no such law
    assert "static_force" not in head_of(by_law, fmus) and head_of(own, fmus)["static_force"] == "80 N"


def test_irregular_lines_need_a_line_file(fmus, tmp_path):
    with pytest.raises(ZSpringError, match=r"\[irregularity\] needs a line file"):
        study_of('design = "grid"\n[couple]\n[irregularity]\nlines = 2\n', fmus, tmp_path)


# What is told of differences

COMPARING = """
[vary]
couple.speed = [200, 300]
m1 = [7, 8]
[irregularity]
lines = 12
[compare]
a = {}
b = { k2 = 9000 }
c = { k2 = 8000 }
"""


def rows_of(settings: StudySettings, value) -> dict[int, dict[str, str]]:
    """Rows with a standard deviation by case, as texts; NaN: none."""
    rows = {}
    for number, case in enumerate(make_cases(settings)):
        found = value(case)
        rows[number] = {"standard_deviation [N]": "" if np.isnan(found) else repr(float(found))}
        rows[number] |= {"compare": list(settings.compared)[case["compare"] - 1]}
    return rows


def test_differences_are_those_of_pairs_on_the_same_lines(fmus, tmp_path):
    """Student's interval of paired samples, by scipy; a case without a value takes its pair along."""
    settings = study_of(GRID + 'values = ["standard_deviation"]\n' + COMPARING, fmus, tmp_path)
    draws = np.random.default_rng(5)
    of_line, own = draws.normal(30, 5, 13), draws.normal(0, 1, (2, 2, 3, 13))

    def value(case) -> float:
        k, line, m = case["compare"] - 1, case["irregularity.line"], int(case["m1"] == 8)
        if (case["couple.speed"], k, line, m) == (300, 1, 4, 0):
            return np.nan
        return of_line[line] + own[int(case["couple.speed"] == 300), m, k, line] + 2 * k

    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity)
    found = differences(settings, quantity, make_cases(settings), rows_of(settings, value))
    assert [(d.condition, d.name, d.lines) for d in found] == [
        ((v, m), name, 11 if (v, m, name) == (300, 7, "b") else 12) for name in "bc" for v in (200, 300) for m in (7, 8)
    ]
    for each in found:
        speed, m = each.condition
        k = "abc".index(each.name)
        lines = [n for n in range(1, 13) if not (speed == 300 and m == 7 and n == 4 and k == 1)]
        a, b = (of_line[lines] + own[int(speed == 300), int(m == 8), i, lines] + 2 * i for i in (0, k))
        interval = ttest_rel(a, b).confidence_interval(0.95)
        assert each.runner == Runner(0, 1) and each.first == pytest.approx(a.mean())
        assert (each.mean - each.half_width, each.mean + each.half_width) == pytest.approx(tuple(interval))
    lines = difference_table(settings, found)
    assert "what a has more than the others" in lines[0] and "200 km/h, m1=7" in lines[1]
    assert f"as {sum(d.is_clear for d in found)} of 8 intervals" in lines[-1]


def test_along_one_line_cases_are_one_sample(fmus, tmp_path):
    """Starts are no parameters of a line: a grid without irregular lines has them as its samples, by speed."""
    text = 'design = "grid"\n[vary]\ncouple.speed = [200, 300]\ncouple.start = [30, 40, 50]\n[couple]\n'
    settings = study_of(text + 'values = ["standard_deviation"]\n[compare]\na = {}\nb = {}\n', fmus, tmp_path)
    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity)
    rows = rows_of(settings, lambda case: case["couple.start"] * case["compare"])
    found = differences(settings, quantity, make_cases(settings), rows)
    assert [(d.condition, d.lines, d.mean) for d in found] == [((200,), 3, -40), ((300,), 3, -40)]
    told = difference_table(settings, found)
    assert all(np.isnan(d.half_width) and not d.is_clear for d in found) and "\u00b1" not in "".join(told)
    assert told[0].endswith("no intervals: cases are not drawn by chance") and len(told) == 4


def test_cases_drawn_by_chance_along_one_line_have_intervals(fmus, tmp_path):
    text = 'design = "latin-hypercube"\nsamples = 6\n[vary]\nm1 = { from = 7, to = 8 }\n[couple]\n'
    settings = study_of(text + 'values = ["standard_deviation"]\n[compare]\na = {}\nb = {}\n', fmus, tmp_path)
    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity)
    rows = rows_of(settings, lambda case: float(case["m1"]) * case["compare"])
    (found,) = differences(settings, quantity, make_cases(settings), rows)
    m1 = np.array([float(case["m1"]) for case in make_cases(settings)[::2]])
    interval = ttest_rel(m1, 2 * m1).confidence_interval(0.95)
    assert found.half_width == pytest.approx((interval.high - interval.low) / 2)


def test_rank_correlations_are_spearmans_and_their_intervals_hold_as_often_as_they_say(fmus, tmp_path):
    text = 'design = "latin-hypercube"\nsamples = 60\n[vary]\nm1 = { from = 7, to = 8 }\nm2 = { from = 5, to = 6 }\n'
    settings = study_of(f"{text}[couple]\n", fmus, tmp_path)
    draws, inside, rho = np.random.default_rng(2), 0, 0.6
    names = [column_of(settings.variables[name]) for name in ("m1", "m2")]
    truth = 6 / np.pi * np.arcsin(rho / 2)  # Spearman's of a normal pair
    for _ in range(400):
        x, noise, other = draws.normal(size=(3, 60))
        y = rho * x + (1 - rho**2) ** 0.5 * noise
        rows = {n: {names[0]: str(x[n]), names[1]: str(other[n]), "y": str(y[n])} for n in range(60)}
        (found,) = correlations(settings, ["m1", "m2"], ["y"], rows)
        inside += found.low[0] <= truth <= found.high[0]
    assert found.value[0] == pytest.approx(spearmanr(x, y).statistic, rel=1e-12)
    assert 0.92 < inside / 400 < 0.98
    assert correlation_doubts([found])[0].startswith("1 of 2 rank correlations are smaller")
    assert correlation_doubts([replace(found, value=np.array([0.6, 0.9]), low=found.low, high=found.high)]) == []


def test_an_item_of_a_list_counts_once_however_many_its_lines(fmus, tmp_path):
    """8 items, each with a figure of its own that does not go with m1, on 30 lines: intervals hold 0 as they say."""
    numbers = [round(7 + n / 10, 1) for n in range(8)]
    text = f'design = "list"\n[vary]\nm1 = {numbers}\n[couple]\nline = "{LINE.as_posix()}"\n'
    settings = study_of(f"{text}[irregularity]\nlines = 30\n[compare]\na = {{}}\nb = {{}}\n", fmus, tmp_path)
    cases, name = make_cases(settings), column_of(settings.variables["m1"])
    draws, inside = np.random.default_rng(4), 0
    for _ in range(150):
        of_item, of_line = dict(zip(numbers, draws.normal(size=8))), draws.normal(size=31)
        y = {n: of_item[case["m1"]] + of_line[case["irregularity.line"]] for n, case in enumerate(cases)}
        rows = {n: {name: str(cases[n]["m1"]), "y": str(y[n])} for n in y if cases[n]["compare"] == 2}
        (found,) = correlations(settings, ["m1"], ["y"], rows)
        inside += found.low[0] <= 0 <= found.high[0]
        assert found.samples == 8
        assert found.value[0] == pytest.approx(spearmanr(numbers, list(of_item.values())).statistic, abs=1e-12)
    assert inside / 150 > 0.9
    rows[1]["y"] = ""  # the first item lacks a line, and the last one a row
    del rows[len(cases) - 1]
    (found,) = correlations(settings, ["m1"], ["y"], rows)
    assert found.samples == 6
    assert found.value[0] == pytest.approx(spearmanr(numbers[1:-1], list(of_item.values())[1:-1]).statistic)


def test_a_study_of_irregular_lines_writes_its_tables_and_figures(tmp_path):
    text = GRID + 'spans = [3, 3]\nvalues = ["standard_deviation"]\n[vary]\ncouple.speed = [280, 300]\n[irregularity]\n'
    text += "lines = 3\ndropper_length = 0.01\n[compare]\nZ = {}\nlocked = { suspension = 'LinearLocked' }\n"
    (tmp_path / "study.toml").write_text(text)
    out, err = zspring(tmp_path, "study", "study.toml", "--output", "out", "--workers", "2")
    zspring(tmp_path, "study", "study.toml", "--output", "out", "--line-of", "10")
    rows, told = table(tmp_path / "out/study.csv"), table(tmp_path / "out/differences.csv")
    assert len(rows) == 12 and {row["status"] for row in rows} == {"ok"} and not err
    for each in told:
        own = [row for row in rows if row["couple.speed [km/h]"] == each["couple.speed [km/h]"]]
        a, b = (
            [float(row["standard_deviation [N]"]) for row in own if row["compare"] == name] for name in ("Z", "locked")
        )
        assert float(each["difference"]) == pytest.approx(np.mean(a) - np.mean(b), rel=1e-4)
        assert each["lines"] == "3" and each["compare"] == "locked"
    run = ["--line-fmu", "out/line-10.fmu", "--speed", "300", "--stop", "214", "--spans", "3:3", "--output", "run"]
    couple, _ = zspring(tmp_path, "couple", *run)
    assert rows[10]["couple.speed [km/h]"] == "300" and rows[10]["irregularity.line"] == "3"
    assert f"deviation, 0-20 Hz   {float(rows[10]['standard_deviation [N]']):.1f}   N" in couple
    assert len(told) == 2 and "of 2 intervals of all values are" in out
    for name in ("sweep", "differences", "distribution"):
        assert (tmp_path / f"out/{name}.png").read_bytes().startswith(PNG)


def test_what_goes_exactly_with_a_parameter_has_an_interval_that_ends_there(fmus, tmp_path):
    text = 'design = "latin-hypercube"\nsamples = 9\n[vary]\nm1 = { from = 7, to = 8 }\n[couple]\n'
    settings = study_of(text, fmus, tmp_path)
    rows = {n: {column_of(settings.variables["m1"]): str(7 + n / 9), "y": str(-n)} for n in range(9)}
    (found,) = correlations(settings, ["m1"], ["y"], rows)
    assert (found.value[0], found.low[0]) == (pytest.approx(-1), found.value[0]) and -1 < found.high[0] < 0


# The example


def test_the_examples_can_be_read_where_they_were_copied_to(fmus, tmp_path):
    assert in_process("study", "--example", tmp_path)[0] == 0
    settings = read_study(tmp_path / "study-friction.toml", *fmus)
    cases = make_cases(settings)
    assert len(cases) == 5 * 2 * 30 * 5 and next(iter(settings.compared)) == "Z-spring"
    first = settings.parameters_of(cases[0])
    assert (first["couple.speed"], first["couple.pantographs"], first["irregularity.line"]) == (200, 1, 1)
    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity) and quantity.line and len(quantity.line.boundaries) == 14
    assert read_study(tmp_path / "study.toml", *fmus).design == "sobol"


def test_the_matched_head_is_what_least_squares_make_of_the_z_spring_on_the_regular_line(tmp_path):
    """Its force, by the head's balance, on stroke and rate, of the pantograph alone under the wire of a run."""
    with open(ROOT / "resources/examples/study-friction.toml", "rb") as file:
        matched = tomllib.load(file)["compare"]["matched and damped"]
    speed, m1 = 250, 7.12
    target = f"static_force={0.00097 * speed**2 + 70}"
    options = ["--line", "benchmark-2015", "--speed", str(speed), "--stop", "400", "--set", target]
    in_process("couple", *options, "--output", tmp_path / "run")
    rows = table(tmp_path / "run/line.csv")
    wire = np.array([float(row["wire height 1 [m]"]) for row in rows])
    lines = (f"{row['time [s]']},{height}\n" for row, height in zip(rows, wire - wire[0]))
    (tmp_path / "wire.csv").write_text("time [s],wire_height [m]\n" + "".join(lines))
    options = ["--drive", "Wire", "--input", tmp_path / "wire.csv", "--step", "0.001", "--set", target]
    in_process("simulate", *options, "--output", tmp_path / "alone")
    alone = table(tmp_path / "alone/simulation.csv")

    def column(name: str) -> np.ndarray:
        return np.array([float(row[name]) for row in alone])

    position = np.array([float(row["position 1 [m]"]) for row in rows])[: len(alone)]
    inside = (position > 3 * 55) & (position < 7 * 55)
    stroke, rate = (column(f"head.{x}") - column(f"upper_frame.{x}") for x in ("z [m]", "v [m/s]"))
    force = column("contact.force [N]") + m1 * column("head.a [m/s2]")
    on = np.column_stack([stroke, rate, np.ones(len(alone))])[inside]
    stiffness, damping, _ = np.linalg.lstsq(on, -force[inside], rcond=None)[0]
    assert matched["k1"] == pytest.approx(stiffness, rel=0.04)
    assert matched["c1"] == pytest.approx(damping, rel=0.25)
