"""Which runs the validation makes, span by span and choice by choice, and what a line's report looks at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zspring.couple.report import summary
from zspring.en50318.cases import reference_runs, section_of
from zspring.en50318.edition import packaged_edition, read_edition
from zspring.en50318.own_pantograph import OwnPantograph
from zspring.en50318.plan import CHOICES, HEADS, STARTS, Run, head_runs, sensitivity_runs, slug
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.evaluated import evaluated, sections
from zspring.line.journey import LineExtent
from zspring.line.result import LineResult
from zspring.line.statistics import Section


@pytest.fixture(scope="module")
def fmus():
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        yield catenary, pantograph


@pytest.fixture(scope="module")
def references(fmus) -> list[Run]:
    return reference_runs(read_edition(packaged_edition("en-50318-2002")), *fmus)


def test_the_reference_runs_are_the_cases_of_the_edition(references):
    assert [(run.label, run.speed, run.group, run.of) for run in references] == [
        ("250 km/h", 250, "reference", "EN 50318:2002"),
        ("300 km/h", 300, "reference", "EN 50318:2002"),
    ]
    for run in references:
        assert run.section == Section.alike(5, 6, 60.0) and run.section.bounds == (240.0, 360.0)
        assert (
            run.pantograph["static_force"] == 120
            and run.pantograph["solver.step"] == 5e-4
            and run.line["contact_wire.tension"] == 20000
        )
        assert (run.uplift, run.step, run.scheme, run.start_up, run.start) == (0, 1e-3, "sequential", "ramp", None)
    assert [run.series for run in references] == [f"en-50318-2002-{v}-km-h.csv" for v in (250, 300)]


def test_each_choice_changes_what_it_names_and_nothing_else_and_stops_behind_what_is_evaluated(fmus, references):
    runs = sensitivity_runs(references, fmus[0])
    assert len(runs) == 2 * len(CHOICES) == len({run.key for run in runs})
    named = ("group", "label", "of", "series")
    for reference, own in ((references[0], runs[: len(CHOICES)]), (references[1], runs[len(CHOICES) :])):
        for run, choice in zip(own, CHOICES):
            assert (run.group, run.label, run.series) == ("sensitivity", choice.label, "")
            assert run.of == f"EN 50318:2002, {reference.label}"
            changed = {n for n, value in run.line.items() if reference.line.get(n) != value}
            assert (
                changed == {n for n, v in choice.line.items() if reference.line.get(n) != v} != set() or not choice.line
            )
            for name, value in choice.line.items():
                assert run.line[name] == value
            for name, value in choice.run.items():
                assert getattr(run, name) == value != getattr(reference, name)
            spans = choice.spans or (5, 6)
            assert run.section == Section.alike(*spans, 60.0)
            assert run.stop == pytest.approx(spans[1] * 60.0 + 0.4 * reference.speed / 3.6)
            left = {name: getattr(reference, name) for name in (*named, "line", "section", "stop", *choice.run)}
            assert replace(run, **left) == reference


def test_anything_that_changes_the_numbers_changes_the_key(references):
    run = references[0]
    others = [
        replace(run, speed=251.0),
        replace(run, uplift=1.0),
        replace(run, step=2e-3),
        replace(run, section=Section.alike(4, 6, 60.0)),
        replace(run, line={**run.line, "gravity": 9.8}),
        replace(run, pantograph={**run.pantograph, "m1": 7.0}),
    ]
    assert len({run.key, *(other.key for other in others)}) == 7
    assert replace(run).key == run.key


def test_all_heads_run_with_the_mean_force_of_the_law_from_places_over_the_first_span(fmus):
    """70 N at a stand, and 0.00097 v^2 more from the uplift; the forces are kept of the last speed's first start."""
    runs = head_runs(*fmus, (200.0, 275.0))
    assert [(run.speed, run.label) for run in runs] == [
        (speed, head.label) for speed in (200, 275) for head in HEADS for _ in range(STARTS if head.every_start else 1)
    ]
    for run in runs:
        assert run.pantograph["static_force"] == 70
        assert run.uplift == pytest.approx(0.00097 * run.speed**2)
        assert (run.group, run.of) == ("heads", "benchmark-2015")
        assert bool(run.series) <= (run.speed == 275 and run.start == 0)
    assert sum(bool(run.series) for run in runs) == sum(head.is_drawn for head in HEADS)
    linear = [run.start for run in runs if run.label == HEADS[0].label and run.speed == 200]
    assert linear == pytest.approx([0, 6.875, 13.75, 20.625, 27.5, 34.375, 41.25, 48.125])
    kept = [run.series for run in head_runs(*fmus, (300.0, 350.0)) if run.series]
    assert len(kept) == 4 and all(name.endswith("-300-km-h.csv") for name in kept)
    first = {run.label: run.pantograph for run in runs}
    laws = [(first[head.label]["suspension"], first[head.label].get("friction")) for head in HEADS]
    assert laws == [(2, None), (1, 1), (4, 1), (1, 2), (3, 1)]


@pytest.mark.parametrize("speed, spans", [(150.0, (3, 4)), (200.0, (3, 6)), (250.0, (4, 7)), (350.0, (5, 8))])
def test_heads_are_evaluated_before_the_far_end_is_felt(fmus, speed, spans):
    """Spans of 55 m, waves of 127.66 m/s: at 200 km/h the front is met after 2 * 550 / (127.66 + 55.56) s, 333.5 m."""
    run = head_runs(*fmus, (speed,))[0]
    assert run.section == Section.alike(*spans, 55.0)
    until = speed / 3.6 * 2 * 550 / ((22000 / 1.35) ** 0.5 + speed / 3.6)
    assert run.section.bounds[1] <= until < run.section.bounds[1] + 55
    assert run.stop > run.section.bounds[1]


def test_an_own_pantograph_runs_as_the_reference_does_but_for_itself(references):
    """Its own static force goes before the case's; a target mean force stays the same."""
    own = OwnPantograph("mine", {"m1": 6.0}).runs(references)
    for run, reference in zip(own, references):
        assert run.pantograph == {"static_force": 120, "m1": 6.0} and run.group == "own pantograph"
        left = {"pantograph": reference.pantograph, "group": "reference", "series": reference.series}
        assert replace(run, **left) == reference and run.series != reference.series
    aimed = [replace(run, mean_force=150.0) for run in references]
    for run in OwnPantograph("mine", {"static_force": 70.0}).runs(aimed):
        assert run.pantograph["static_force"] == 70 and (run.uplift, run.mean_force) == (80, 150)


@pytest.mark.parametrize("spans, fits", [((2, 9), True), ((2, 2), True), ((1, 2), False), ((8, 10), False)])
def test_the_first_and_the_last_span_of_a_line_are_not_evaluated(spans, fits):
    case = read_edition(packaged_edition("en-50318-2002")).cases[0]
    case = case.model_copy(update={"first_span": spans[0], "last_span": spans[1]})
    if fits:
        assert section_of(case, LineExtent.alike(10, 60.0)) == Section.alike(*spans, 60.0)
    else:
        with pytest.raises(ZSpringError, match=rf"spans {spans[0]} to {spans[1]}: must be in 2 \.\. 9"):
            section_of(case, LineExtent.alike(10, 60.0))


def test_names_of_files_are_plain():
    assert slug("EN 50318:2002, 250 km/h") == "en-50318-2002-250-km-h"


# Of one run along a line


def passage(begin: float, end: float, second: float = 0.0) -> LineResult:
    """Two pantographs at 50 m/s with constant forces of 100 and 110 N, the second one `second` m behind."""
    time = np.arange(round((end - begin) / 0.05) + 1) / 1000
    position = begin + 50 * time[:, None] - [0.0, second]
    forces = np.broadcast_to([100.0, 110.0], position.shape)
    height = 0.01 * np.sin(np.pi * position / 50)  # 20 mm from peak to peak in each two spans
    uplift = np.full((len(time), 2), 0.033)
    moments = np.zeros((*position.shape, 2))
    return LineResult(
        time, position, forces, height, height, np.array([50.0, 100.0]), uplift, time * 0, moments, {}, 1.0
    )


@pytest.mark.parametrize("spans, middle", [(4, (2, 3)), (5, (3, 3)), (6, (3, 4)), (7, (4, 4))])
def test_the_middle_spans_are_evaluated(spans, middle):
    result = passage(0.0, 50.0 * spans)
    assert evaluated(result, 0, LineExtent.alike(spans, 50.0)) == Section.alike(*middle, 50.0)


def test_a_pantograph_that_has_not_run_through_the_middle_is_evaluated_over_its_last_whole_spans():
    """The first span after the start does not count; None: there is no whole one."""
    line = LineExtent.alike(6, 50.0)  # the middle is from 100 to 200 m
    for begin, end, second, first, other in (
        (40.0, 210.0, 0.0, (3, 4), (3, 4)),
        (50.0, 200.0, 0.0, (3, 4), (3, 4)),
        (51.0, 210.0, 0.0, (4, 4), (4, 4)),
        (40.0, 199.0, 0.0, (3, 3), (3, 3)),
        (40.0, 210.0, 20.0, (3, 4), (3, 3)),
        (51.0, 199.0, 0.0, None, None),
    ):
        result = passage(begin, end, second)
        expected = [spans and Section.alike(*spans, 50.0) for spans in (first, other)]
        assert [evaluated(result, i, line) for i in (0, 1)] == expected


def test_the_summary_has_the_figures_of_each_pantograph():
    result = passage(40.0, 210.0, 20.0)
    lines = summary(result, sections(result, LineExtent.alike(6, 50.0), None))
    assert lines[0] == "0-20 Hz, over spans 3 to 4, 100 to 200 m and span 3, 100 to 150 m"
    rows = {line[:27].strip(): line[27:].split() for line in lines[1:]}
    assert rows["mean force"] == ["100.0", "110.0", "N"]
    assert rows["largest uplift at a support"] == ["33.0", "33.0", "mm"]
    assert rows["loss of contact"] == ["0.00", "0.00", "%"]
    assert rows["range of the contact point"] == ["20.0", "10.0", "mm"]
