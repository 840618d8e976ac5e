"""Editions of the standard: what their files say, how they are checked, and how figures are judged."""

from __future__ import annotations

import math
import re
import shutil
from pathlib import Path

import pytest

from zspring.en50318.edition import Judgement, agreement, judge, packaged_edition, read_edition
from zspring.errors import ZSpringError
from zspring.line.quantities import FIGURES

GOOD = """
edition = "X"
source = "a book"
[[case]]
title = "fast"
line = "en-50318-2002"
pantograph = "dsa-380"
speed = 300
first_span = 5
last_span = 6
static_force = 120
[case.ranges]
mean_force = [110, 120]
[agreement]
standard_deviation = 20
"""


def edition(folder: Path, text: str):
    path = folder / "x.toml"
    path.write_text(text, encoding="utf-8")
    return read_edition(path)


def test_the_edition_of_2002_has_16_ranges_and_says_that_they_are_second_hand():
    found = read_edition(packaged_edition("en-50318-2002"))
    assert [case.speed for case in found.cases] == [250, 300]
    assert sum(len(case.ranges) for case in found.cases) == 16
    assert "second-hand" in found.source and "unverified" in found.source
    assert found.cases[0].ranges["standard_deviation"] == (26, 31)
    assert found.cases[1].ranges["support_uplift"] == (55, 65)


def test_the_benchmark_takes_its_mean_force_from_the_law_for_ac_lines():
    found = read_edition(packaged_edition("benchmark-2015"))
    for case in found.cases:
        assert case.static_force == pytest.approx(0.00097 * case.speed**2 + 70)
        assert not case.ranges


def test_the_example_has_no_number_and_reads_when_its_blanks_are_filled(tmp_path):
    path = tmp_path / "edition.toml"
    shutil.copy(packaged_edition("example"), path)
    text = path.read_text(encoding="utf-8")
    assert not [line for line in text.splitlines() if re.match(r"[^#]*= *[-\d\[]", line)]
    with pytest.raises(ZSpringError, match="case 1: speed is missing"):
        read_edition(path)
    for key, value in {"speed": 270, "first_span": 5, "last_span": 6, "spacing": 200, "static_force": 70}.items():
        text = re.sub(rf"^# {key} =(?= |$)", f"{key} = {value}", text, flags=re.MULTILINE)
    path.write_text(re.sub(r"^# (\S+) = \[ , \]", r"\1 = [1, 2]", text, flags=re.MULTILINE), encoding="utf-8")
    with pytest.raises(ZSpringError, match="source is empty: say where the numbers are from"):
        read_edition(path)
    path.write_text(path.read_text("utf-8").replace('source = ""', 'source = "EN 50318:2018, table 9"'), "utf-8")
    cases = read_edition(path).cases
    assert [case.title for case in cases] == ["AC simple", "AC stitched", "DC simple"]
    assert {*FIGURES, "uplift_at_132.5"} == set(cases[0].ranges) and cases[0].further == ("uplift_at_132.5",)
    assert all(case.trailing_ranges.keys() <= FIGURES.keys() and case.spacing == 200 for case in cases)
    assert cases[0].line == str(tmp_path / "ac-simple.ssv")


def test_a_target_is_the_supplys_the_given_one_or_none(tmp_path):
    """0.00097 v^2 + 70 N at 300 km/h are 157.3 N; beside it a static force may be given."""
    for given, target, static in (
        ("static_force = 120", None, 120),
        ('supply = "AC"', 157.3, 157.3),
        ("mean_force = 140", 140, 140),
        ("mean_force = 140\nstatic_force = 70", 140, 70),
    ):
        (case,) = edition(tmp_path, GOOD.replace("static_force = 120", given)).cases
        assert (case.target, case.static_force) == (target and pytest.approx(target), pytest.approx(static))


def test_every_figure_can_have_a_range(tmp_path):
    ranges = "\n".join(f"{name} = [0, 1]" for name in FIGURES)
    found = edition(tmp_path, GOOD.replace("mean_force = [110, 120]", ranges))
    assert set(found.cases[0].ranges) == set(FIGURES)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('edition = "X"', "", "edition is missing"),
        ('source = "a book"', 'source = " "', "source is empty"),
        ("mean_force = [110, 120]", "mean_force = [120, 110]", r"case 1: ranges.mean_force = \[120, 110\]:"),
        ("mean_force = [110, 120]", "mean_force = 110", r"ranges.mean_force = 110: must be \[lowest, highest\]"),
        ("mean_force = [110, 120]", "mean_force = [nan, 1]", "must be .lowest, highest."),
        ("mean_force =", "mean_farce =", "unknown value 'mean_farce'; did you mean mean_force"),
        ("standard_deviation = 20", "standard_deviation = -20", "agreement: standard_deviation = -20: must be"),
        ("standard_deviation = 20", "sigma = 20", "agreement: unknown value 'sigma'"),
        ("speed = 300", 'speed = "300"', "case 1: speed = '300': must be a number"),
        ("speed = 300", "speed = 3000", "speed = 3000 km/h: must be at most 600"),
        ("speed = 300", "speeed = 300", "case 1: speed is missing"),
        ("last_span = 6", "last_span = 4", "last_span = 4: must be a whole number of at least 5"),
        ("first_span = 5", "first_span = 0", "first_span = 0: must be a whole number of at least 1"),
        ("static_force = 120", "", "case 1: static_force is missing"),
        ("static_force = 120", 'supply = "AD"', "supply = 'AD': must be one of AC"),
        ("static_force = 120", 'mean_force = 120\nsupply = "AC"', "supply and mean_force: give one"),
        ("static_force = 120", "static_force = 120\nspacing = 0", "spacing = 0: must be a number above 0"),
        (
            "[agreement]",
            "[case.trailing_ranges]\nmean_force = [1, 2]\n[agreement]",
            "need a trailing pantograph, spacing",
        ),
        ("mean_force =", "standard_deviation_20_5 =", "unknown value 'standard_deviation_20_5'"),
        ("mean_force =", "uplift_at_x =", "unknown value 'uplift_at_x': free ones are standard_deviation_LOW_HIGH"),
        ("static_force = 120", "static_force = 120\nvalues = ['uplift']", "unknown value 'uplift'"),
        ("static_force = 120", "static_force = 120\nuplift = 3", "case 1: unknown key 'uplift'"),
        ("[[case]]", "[case]", "case"),
        ("[agreement]", "[agrement]", "unknown key 'agrement'; did you mean agreement"),
        ("speed = 300", "speed = ", "no TOML"),
        ("speed = 300", "speed = true", "case 1: speed = True: must be a number"),
        ("speed = 300", "speed = inf", "case 1: speed = inf: must be a finite number"),
        ("first_span = 5", "first_span = 5.0", "case 1: first_span = 5.0: must be a whole number"),
        ("static_force = 120", "static_force = 0", "case 1: static_force = 0: must be a number above 0"),
        ("static_force = 120", "static_force = 1\nsuply = 2", "case 1: unknown key 'suply'; did you mean supply"),
        ("[110, 120]", "[110, true]", r"case 1: ranges.mean_force = \[110, True\]: must be .lowest, highest."),
        ('title = "fast"', "title = 3", "case 1: title = 3: must be a text"),
        ("standard_deviation = 20", "standard_deviation = nan", "agreement: standard_deviation = nan: must be a"),
    ],
)
def test_bad_files_are_refused_in_one_line(old, new, message, tmp_path):
    assert old in GOOD
    with pytest.raises(ZSpringError, match=message) as refusal:
        edition(tmp_path, GOOD.replace(old, new))
    assert str(refusal.value).startswith(str(tmp_path / "x.toml"))
    assert "\n" not in str(refusal.value)


def test_two_cases_of_one_title_and_a_file_without_cases_are_refused(tmp_path):
    case = GOOD[GOOD.index("[[case]]") : GOOD.index("[agreement]")]
    with pytest.raises(ZSpringError, match="two cases 'fast'"):
        edition(tmp_path, GOOD.replace("[agreement]", f"{case}[agreement]"))
    with pytest.raises(ZSpringError, match="at least one"):
        edition(tmp_path, GOOD.replace(case, ""))


@pytest.mark.parametrize(
    ("value", "outside"), [(110, 0), (115, 0), (120, 0), (109.5, -0.5), (122, 2), (math.nan, math.nan)]
)
def test_a_figure_is_inside_or_tells_how_far_outside(value, outside):
    (found,) = judge({"mean_force": value}, {"mean_force": (110, 120)})
    assert found.outside == pytest.approx(outside, nan_ok=True)
    assert found.is_inside == (outside == 0)


def test_agreement_is_relative_to_the_line_test():
    limits = {"standard_deviation": 20.0, "support_uplift": 20.0}
    simulated = {"standard_deviation": 24.0, "support_uplift": 39.0}
    measured = {"standard_deviation": 20.0, "support_uplift": 50.0}
    inside, outside = agreement(simulated, measured, limits)
    assert inside == Judgement("standard_deviation", pytest.approx(20), (-20, 20))
    assert outside.value == pytest.approx(-22) and outside.outside == pytest.approx(-2)


def test_an_unknown_case_tells_which_there_are(tmp_path):
    with pytest.raises(ZSpringError, match=r"slow: no case of X \(there are fast\)"):
        edition(tmp_path, GOOD).case("slow")
