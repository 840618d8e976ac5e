"""Tables and verdicts of the report on given figures: just inside and just outside of every limit."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.compare import LevelComparison, band_errors
from zspring.bench.curves import Curve
from zspring.en50318 import comparison, report, summary
from zspring.en50318.edition import judge, packaged_edition, read_edition
from zspring.en50318.files import BY_SPAN
from zspring.en50318.line_test import BY_PLACE, Comparison
from zspring.en50318.own_data import OwnData, series_chapter
from zspring.en50318.workers import Finished
from zspring.line.quantities import FIGURES
from zspring.line.series import Series
from zspring.line.statistics import Section, statistics
from zspring.page import BAD, GOOD, Cell, Table

FOUND = {
    "mean_force": 100.0,
    "standard_deviation": 29.0,
    "standard_deviation_0_2": 9.0,
    "standard_deviation_0_5": 12.0,
    "standard_deviation_5_20": 25.04,
    "statistical_maximum": 187.06,
    "statistical_minimum": 13.0,
    "actual_maximum": 170.0,
    "actual_minimum": 5.0,
    "support_uplift": 55.0,
    "midspan_uplift": 90.0,
    "contact_point_range": 80.0,
    "loss_of_contact": 0.126,
    "losses": 2.0,
    "longest_loss": 7.0,
}
EDITION = read_edition(packaged_edition("en-50318-2002"))  # which accepts 20 % of three figures


def rows_of(table: Table) -> dict[str, list[Cell]]:
    """Cells of each row behind its head."""
    return {first.text: rest for first, *rest in table.cells}


def texts(cells: list[Cell]) -> list[str]:
    return [cell.text for cell in cells]


@pytest.mark.parametrize(
    "value, said, look",
    [
        (26.0, "inside", GOOD),
        (31.0, "inside", GOOD),
        (25.99, "outside by -0.01", BAD),
        (31.01, "outside by +0.01", BAD),
        (math.nan, "not known", ""),
    ],
)
def test_a_figure_is_judged_at_the_ends_of_its_range(value, said, look):
    found = {**FOUND, "standard_deviation": value}
    judged = judge(found, {"standard_deviation": (26.0, 31.0)})
    row = rows_of(report.case_table(found, judged, 250.0, "x"))["standard deviation, 0-20 Hz, N"]
    shown = "-" if math.isnan(value) else f"{value:.1f}"
    assert texts(row) == [shown, "26 to 31", said] and row[-1].look == look


@pytest.mark.parametrize("deviation, said", [(30.0, "inside"), (30.001, "outside"), (1.0, "inside"), (59.0, "outside")])
def test_the_deviations_share_of_the_mean_is_judged_at_three_tenths(deviation, said):
    found = {**FOUND, "standard_deviation": deviation}
    table = report.case_table(found, judge(found, {"mean_force": (90, 110)}), 250.0, "x")
    (label,) = (row for row in rows_of(table) if row.startswith("standard deviation / mean force"))
    row = rows_of(table)[label]
    assert (
        texts(row) == [f"{deviation / 100:.3f}", "at most 0.3", said]
        and row[-1].look == {"inside": GOOD, "outside": BAD}[said]
    )


@pytest.mark.parametrize("mean", [0.0, -100.0])
def test_a_force_that_does_not_press_at_all_has_no_good_share(mean):
    found = {**FOUND, "mean_force": mean}
    rows = rows_of(report.case_table(found, judge(found, {"mean_force": (90, 110)}), 250.0, "x"))
    (label,) = (row for row in rows if row.startswith("standard deviation / mean force"))
    assert texts(rows[label]) == ["inf", "at most 0.3", "outside"]


def test_a_table_without_ranges_judges_nothing_and_has_every_figure():
    """The target mean force of AC lines is 0.00097 v^2 + 70 N, 130.6 N at 250 km/h."""
    table = report.case_table(FOUND, [], 250.0, "x")
    rows = rows_of(table)
    assert list(table.header) == ["", "found"] and {len(row) for row in rows.values()} == {1}
    assert len(rows) == len(FIGURES) + 2
    assert texts(rows["target mean force of AC lines, N"]) == ["130.6"]
    assert texts(rows["loss of contact, %"]) == ["0.13"] and texts(rows["number of losses of contact"]) == ["2"]
    assert "target mean force of AC lines, N" not in rows_of(report.case_table(FOUND, [], None, "x"))


def test_verdicts_count_and_name_what_is_outside():
    ranges = {"mean_force": (90.0, 110.0), "actual_minimum": (10.0, 20.0), "actual_maximum": (100.0, 150.0)}
    judged = {"slow": judge(FOUND, {"mean_force": (90.0, 110.0)}), "fast": judge(FOUND, ranges)}
    assert report.verdict("X", judged) == (
        "X: 2 of 4 values are outside their accepted ranges: actual minimum at fast by -5 N, "
        "actual maximum at fast by +20 N"
    )
    assert report.verdict("X", {"slow": judged["slow"]}) == "X: all 1 values are inside their accepted ranges"
    unknown = judge({**FOUND, "mean_force": math.nan}, ranges)
    assert "X: 2 of 2 values are outside" in report.verdict("X", {"fast": unknown})
    assert report.verdict("X", {"fast": unknown}).endswith("; 1 are not known")
    assert report.verdict("X", {"a": unknown[:1]}) == "X: none of the 1 values with accepted ranges is known"


def test_departures_count_choices_not_figures():
    """Of three choices one has two figures outside, one has one, one has none; the other case none of one."""
    ranges = {"mean_force": (90.0, 110.0), "actual_minimum": (0.0, 20.0)}

    def choice(mean: float, minimum: float):
        return judge({**FOUND, "mean_force": mean, "actual_minimum": minimum}, ranges)

    judged = {"slow": {"a": choice(120, -3), "b": choice(100, 21), "c": choice(90, 0)}, "fast": {"a": choice(100, 5)}}
    assert report.departures(judged).endswith("accepted range: 2 of 3 at slow, 0 of 1 at fast")


def test_the_sensitivity_marks_only_what_is_outside():
    other = {**FOUND, "mean_force": 111.0}
    ranges = {"mean_force": (90.0, 110.0), "actual_minimum": (0.0, 5.0)}
    judged = {"reference": judge(FOUND, ranges), "b": judge(other, ranges)}
    table = report.sensitivity_table(FOUND, {"b": other}, judged, "x")
    rows = rows_of(table)
    marked = {(name, table.header[i + 1]) for name, row in rows.items() for i, cell in enumerate(row) if cell.look}
    assert marked == {("b", "mean force, N")}
    assert texts(rows["reference"])[0] == "100.0" and texts(rows["b"])[0] == "111.0"


def test_spans_stand_beside_each_other_in_order():
    other = {**FOUND, "mean_force": 90.0}
    table = report.spans_table(FOUND, {"span 5": other, "span 6": FOUND}, "x")
    assert list(table.header) == ["", "span 5", "span 6", "all"]
    assert texts(rows_of(table)["mean force, N"]) == ["90.0", "100.0", "100.0"]


# The box on top


@pytest.mark.parametrize(
    "values, said, look",
    [
        ([], "none known", ""),
        ([100.0, 15.0], "2 of 2 inside", GOOD),
        ([89.0, 15.0], "1 of 2 inside", BAD),
        ([100.0, math.nan], "1 of 2 inside, 1 not known", BAD),
    ],
)
def test_the_box_counts_what_is_inside(values, said, look):
    ranges = dict(zip(("mean_force", "actual_minimum"), ((90.0, 110.0), (10.0, 20.0))))
    judged = judge({**FOUND, **dict(zip(ranges, values))}, dict(list(ranges.items())[: len(values)]))
    *_, ranges_cell, share = summary.row("x", "p", "l", 250.0, None, judged, FOUND)
    assert (ranges_cell.text, ranges_cell.look) == (said, look)
    assert (share.text, share.look) == ("0.290, inside", GOOD)


def test_the_limit_of_current_collection_is_told_apart_from_the_ranges():
    bad = {**FOUND, "standard_deviation": 30.6}
    *_, ranges, share = summary.row("x", "p", "l", None, Section.alike(5, 6, 60.0), None, bad)
    assert ranges.text == "not for this pantograph" and (share.text, share.look) == ("0.306, outside", BAD)
    assert summary.shares("X", {"slow": FOUND, "fast": bad}) == (
        "X: standard deviation / mean force, at most 0.3: 0.290, inside, at slow; 0.306, outside, at fast"
    )


# Heads


def heads(*by_start: tuple[float, ...]) -> dict[float, list[Finished]]:
    """Runs at 200 km/h whose figures are these in each span; over the section their mean."""
    made = []
    for spans in by_start:
        each = tuple(dict.fromkeys(BY_SPAN, value) for value in spans)
        mean = sum(spans) / len(spans)
        made.append(Finished("", (), dict.fromkeys(BY_SPAN, mean), each, 0.0, 1.0))
    return {200.0: made}


def test_differences_are_of_the_same_start_and_the_same_span():
    """In percent for standard deviations: start 1 from 10 to 11 and from 30 to 30, start 2 from 20 to 18 and 20."""
    linear, other = heads((10.0, 30.0), (20.0, 20.0))[200.0], heads((11.0, 30.0), (18.0, 20.0))[200.0]
    starts, spans = comparison.differences(other, linear, "standard_deviation")
    assert starts == pytest.approx([2.5, -5.0]) and spans == pytest.approx(np.array([[10, 0], [-10, 0]]))
    starts, spans = comparison.differences(other, linear, "actual_minimum")
    assert starts == pytest.approx([0.5, -1.0]) and spans == pytest.approx(np.array([[1, 0], [-2, 0]]))
    (alone, _) = comparison.differences(other[:1], linear, "actual_minimum")
    assert alone == pytest.approx([0.5])


@pytest.mark.parametrize(
    "others, said",
    [
        (((11.0, 31.0), (21.0, 21.0)), "higher from every start and over every span at 200 km/h"),
        (((12.0, 29.0), (21.0, 21.0)), "higher from every start at 200 km/h"),
        (((9.0, 29.0), (19.0, 19.0)), "lower from every start and over every span at 200 km/h"),
        (((9.0, 29.0), (21.0, 21.0)), "of either sign at 200 km/h"),
        (((10.0, 30.0), (20.0, 20.0)), "equal at 200 km/h"),
        (((10.0, 30.0), (19.0, 20.0)), "lower or equal from every start at 200 km/h"),
    ],
)
def test_only_what_holds_from_every_start_is_said(others, said):
    found = {"linear": heads((10.0, 30.0), (20.0, 20.0)), "other": heads(*others)}
    for line in comparison.supported(found, "other", "linear"):
        assert line.endswith(f"against linear: {said}")


def test_the_table_of_differences_has_mean_and_both_spreads():
    found = {"linear": heads((10.0, 30.0), (20.0, 20.0)), "other": heads((11.0, 30.0), (17.0, 20.0))}
    rows = [[cell.text for cell in row] for row in comparison.difference_table(found, "other", "linear").cells]
    assert rows[:3] == [
        ["standard deviation, 0-20 Hz, %", "-2.5"],
        ["    from start to start", "-7.5 .. +2.5"],
        ["    single spans", "-15.0 .. +10.0"],
    ]
    assert rows[6][1] == "-0.5" and rows[7][1] == "-1.5 .. +0.5"  # N
    levels = rows_of(comparison.level_table(found, "actual_minimum"))
    assert texts(levels["other"]) == ["19.5 (18.5 .. 20.5)"]


# Simulation against line test


def at_60_m_a_second(name: str, force: np.ndarray) -> Series:
    """A series of 1000 samples a second."""
    time = np.arange(force.size) / 1000
    return Series(name, time, force, 60 * time)


def compared(simulated, measured) -> Comparison:
    """Of these figures, over series that say nothing of them."""
    series = at_60_m_a_second("x", 100 + np.sin(np.arange(2001)))
    return Comparison(series, series, [None], [simulated], [measured], EDITION)


def test_sections_and_spans_are_compared_each_for_itself():
    """Spans of 60 m, a second each: means of 100 and 110, 120 and 100 N; the line test has 100 N throughout."""
    steps = np.repeat([100.0, 100.0, 110.0, 100.0, 100.0, 120.0, 100.0, 100.0], 1000)
    simulation, line_test = at_60_m_a_second("mine", steps), at_60_m_a_second("theirs", np.full(steps.size, 100.0))
    sections = [Section.alike(2, 3, 60.0), Section.alike(6, 7, 60.0)]
    figures = [[statistics(series, section) for section in sections] for series in (simulation, line_test)]
    made = Comparison(simulation, line_test, sections, *figures, EDITION)
    by_section, by_span = (rows_of(table) for table in made.place_tables(BY_PLACE))
    expected = {"spans 2 to 3": (105, 5), "spans 6 to 7": (110, 10)}
    for place, (mean, change) in expected.items():
        found = by_section[place][0].text
        assert found.endswith(f"(100.0) {change:+d} %") and float(found.split()[0]) == pytest.approx(mean, abs=0.5)
    assert list(by_span) == ["span 2", "span 3", "span 6", "span 7"]
    assert [float(row[0].text.split()[0]) for row in by_span.values()] == pytest.approx([100, 110, 120, 100], abs=0.9)
    tables = [block for block in made.chapter().blocks if isinstance(block, Table)]
    assert [table.caption for table in tables[:2]] == [f"Simulation and line test, {each}" for each in sections]
    assert list(made.judged) == list(expected)


def test_the_spectrum_has_a_sines_power_where_its_frequency_is():
    """20 N at 7.25 Hz: 20^2 / 2 N2, of which the window spreads all but a thousandth over 1 Hz."""
    time = np.arange(6000) / 1000
    series = at_60_m_a_second("sine", 100 + 20 * np.sin(2 * np.pi * 7.25 * time))
    frequency, density = Comparison(series, series, [Section.alike(2, 4, 60.0)], [FOUND], [FOUND], EDITION).spectrum(
        series
    )
    near = np.abs(frequency - 7.25) <= 1.0
    assert np.sum(density[near]) * frequency[1] == pytest.approx(200, rel=2e-3)
    assert np.sum(density[~near]) * frequency[1] < 0.5


@pytest.mark.parametrize(
    "factor, difference, said",
    [
        (1.199, "+19.9 %", "inside"),
        (0.801, "-19.9 %", "inside"),
        (1.21, "+21.0 %", "outside by +1"),
        (0.79, "-21.0 %", "outside by -1"),
    ],
)
def test_a_difference_is_judged_in_percent_of_the_line_test(factor, difference, said):
    simulated = {**FOUND, "support_uplift": factor * FOUND["support_uplift"]}
    chapter = compared(simulated, FOUND).chapter()
    (table,) = (block for block in chapter.blocks if isinstance(block, Table))
    rows = rows_of(table)
    assert texts(rows["largest uplift at a support, mm"])[2:] == [difference, "± 20 %", said]
    assert texts(rows["mean force, N"]) == ["100.0", "100.0", "", "", ""]
    sentence = chapter.blocks[1]
    if said == "inside":
        assert sentence == "Simulation against line test: all 3 values are inside their accepted ranges."
    else:
        assert "1 of 3 values are outside their accepted ranges: largest uplift at a support" in sentence
        assert sentence.endswith(f"by {said.removeprefix('outside by ')} %.")


@pytest.mark.parametrize("whose", ["simulated", "measured"])
@pytest.mark.parametrize("value", [0.0, math.nan])
def test_what_the_line_test_has_as_nothing_is_not_judged(whose, value):
    """Nor what one of both does not tell; a 0 of the simulation is 100 % too little."""
    given = {"simulated": dict(FOUND), "measured": dict(FOUND)}
    given[whose]["support_uplift"] = value
    chapter = compared(given["simulated"], given["measured"]).chapter()
    (table,) = (block for block in chapter.blocks if isinstance(block, Table))
    judged = texts(rows_of(table)["largest uplift at a support, mm"])[2:]
    if whose == "simulated" and value == 0.0:
        assert judged == ["-100.0 %", "± 20 %", "outside by -80"]
    else:
        assert judged == ["", "", ""] and "all 2 values are inside" in chapter.blocks[1]


def test_series_are_shown_side_by_side_with_dashes_for_what_they_do_not_tell():
    table = report.figures_table({"a": FOUND, "b": {**FOUND, "support_uplift": math.nan, "mean_force": 101.25}}, "x")
    rows = rows_of(table)
    assert list(table.header) == ["", "a", "b"]
    assert texts(rows["largest uplift at a support, mm"]) == ["55.0", "-"]
    assert texts(rows["mean force, N"]) == ["100.0", "101.2"]


@pytest.mark.parametrize("first, last, tables", [(2, 3, 2), (2, 2, 1)])
def test_a_series_is_told_span_by_span_where_there_are_several(first, last, tables):
    time = np.arange(4001) / 1000
    force = np.where(time < 2, 100.0, 120.0)  # span 2 from 1 to 2 s, span 3 from 2 to 3 s
    series = Series("mine", time, force, 50 * time)
    section = Section.alike(first, last, 50.0)
    chapter = series_chapter(series, [section], [statistics(series, section)], None, "Contact force")
    found = [block for block in chapter.blocks if isinstance(block, Table)]
    assert len(found) == tables
    assert chapter.blocks[0] == "mine: 4001 samples, one each 1 ms."
    assert texts(rows_of(found[0])["target mean force of AC lines, N"]) == ["101.4"]  # 180 km/h
    if tables == 2:
        means = [float(text) for text in texts(rows_of(found[1])["mean force, N"])]
        assert list(found[1].header) == ["", "span 2", "span 3", "all"]
        assert means == pytest.approx([100, 120, 110], abs=0.5)


def test_the_spans_asked_for_go_before_those_of_the_case():
    data = OwnData(Path("a"), None, EDITION, None, None, [(3, 4), (6, 6)], 65.0, 10.0, 1)
    assert data.sections(None, []) == [Section.alike(3, 4, 65.0, 10.0), Section.alike(6, 6, 65.0, 10.0)]
    assert Section.alike(3, 4, 65.0, 10.0).bounds == (140.0, 270.0)
    whole = OwnData(Path("a"), None, EDITION, None, None, [], 65.0, 10.0, 1)
    assert whole.sections(None, []) == []


@pytest.mark.parametrize("head, first_support", [("# first support: 12345 m\n", None), ("", 12345.0)])
def test_a_line_test_counts_from_the_simulations_first_support(head, first_support, tmp_path):
    """The simulation's head says 0 m; --first-support is for a file whose head says nothing."""
    for name, begin, says in ("a", 0, "# first support: 0 m\n"), ("b", 12345, head):
        rows = (f"{i / 500},{100 + i % 7},{begin + i / 10}\n" for i in range(600))
        text = "".join([says, "time [s],contact force [N],position [m]\n", *rows])
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    data = OwnData(tmp_path / "a.csv", tmp_path / "b.csv", EDITION, None, None, [(2, 2)], 20.0, first_support, 1)
    simulation, line_test = data.read().values()
    assert line_test.position == pytest.approx(simulation.position)
    assert data.sections(None, [simulation, line_test]) == [Section.alike(2, 2, 20.0)]


# Frequency responses


def test_errors_of_a_response_are_in_percent_and_degrees_with_their_signs():
    """Magnitude +3, -4 % in the first band: mean -0.5, rms 3.5 %; phase 1, -2 deg: mean -0.5, rms 1.6 deg.

    A point at the edge between two bands belongs to the upper one, the last edge to the last band.
    """
    frequency, H = np.array([1.0, 2.0, 5.0, 20.0]), np.full(4, 1e-4 - 1e-5j)
    off = np.array([1.03, 0.96, 1.10, 0.95]) * np.exp(1j * np.radians([1, -2, 5, 0]))
    curve = Curve("1 m/s2", frequency, np.ones(4), H)
    comparison = LevelComparison(curve, H * off, band_errors(curve, H * off, (1.0, 5.0, 20.0)))
    low, high = (texts(row) for row in report.frf_table([comparison]).cells)
    assert low == ["1 m/s2", "1 to 5 Hz", "2", "-0.5 %", "-4.0 %", "3.5 %", "-0.5 deg", "-2.0 deg", "1.6 deg"]
    assert high == ["1 m/s2", "5 to 20 Hz", "2", "+2.5 %", "+10.0 %", "7.9 %", "+2.5 deg", "+5.0 deg", "3.5 deg"]
