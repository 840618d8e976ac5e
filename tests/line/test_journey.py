"""Where pantographs start and stop, what fits the line to its ends, and how many steps that makes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey, LineExtent
from zspring.line.run import LineRun
from zspring.line.system import System

LINE = LineExtent.alike(4, 60.0)  # 240 m
RUN = {"speed": 50.0, "start": 30.0, "stop": 210.0}


def test_a_line_has_its_supports_between_the_anchors():
    assert LINE.length == 240
    np.testing.assert_array_equal(LINE.supports, [60, 120, 180])


def test_runs_go_from_half_a_span_inside_to_half_a_span_inside():
    """The last pantograph, too: the first one then starts so much later."""
    one = LINE.complete(Journey(50.0, spacing=7.0), 1)
    assert (one.start, one.stop, one.spacing) == (30, 210, 0)
    two = LINE.complete(Journey(50.0, spacing=40.0), 2)
    assert (two.start, two.stop, two.spacing) == (70, 210, 40)
    own = LINE.complete(Journey(50.0, 45.0, 90.0, spacing=40.0), 2)
    assert (own.start, own.stop) == (45, 90)


UNLIKE = LineExtent(np.array([0.0, 50.0, 115.0, 170.0, 230.0]))


def test_unlike_spans_count_with_their_own_lengths():
    """Margins are half of the spans at the ends, a run starts up over the span it starts in."""
    assert (UNLIKE.spans, UNLIKE.length) == (4, 230)
    assert [UNLIKE.span_of(x) for x in (0.0, 49.9, 50.0, 114.9, 170.0, 230.0)] == [1, 1, 2, 2, 4, 4]
    assert [UNLIKE.run_up(x) for x in (0.0, 50.0, 120.0, 229.0)] == [50, 65, 55, 60]
    found = UNLIKE.complete(Journey(50.0, spacing=10.0), 2)
    assert (found.start, found.stop) == (35, 200)
    assert UNLIKE.whole_spans(50.0, 229.9) == (2, 3)
    assert UNLIKE.whole_spans(51.0, 114.0) == (3, 1)
    assert UNLIKE.whole_spans(0.0, 230.0) == (1, 4)


def test_sections_of_unlike_spans_end_at_their_supports():
    section = UNLIKE.section(2, 3)
    assert section.bounds == (50, 170) and section.span is None
    assert [one.bounds for one in section.single_spans()] == [(50, 115), (115, 170)]
    assert [str(one) for one in section.moved(5.0).single_spans()] == ["span 2, 55 to 120 m", "span 3, 120 to 175 m"]
    for wrong in (0, 2), (3, 2), (4, 5):
        with pytest.raises(ZSpringError, match=r"must be in 1 \.\. 4, the spans of the line"):
            UNLIKE.section(*wrong)


@pytest.mark.parametrize(
    "changed, count",
    [
        ({"stop": 240.0}, 1),
        ({"start": 0.0}, 1),
        ({"start": 40.0, "spacing": 40.0}, 2),
        ({"stop": 30.05, "step": 1e-3}, 1),
        ({"stop": 31.0, "step": 0.02}, 1),
        ({"uplift": -50.0}, 1),
    ],
)
def test_the_ends_of_what_is_allowed_are_allowed(changed, count):
    found = LINE.complete(Journey(**{**RUN, **changed}), count)
    for name, value in changed.items():
        assert getattr(found, name) == ((value,) if name == "uplift" else value)


@pytest.mark.parametrize(
    "changed, count, told",
    [
        ({"stop": 240.001}, 1, "stop = 240.001 m: must be above the start"),
        ({"stop": 30.0}, 1, "stop = 30 m: must be above the start, 30 m"),
        ({"start": -0.001}, 1, "start = -0.001 m"),
        ({"start": 240.0, "stop": 240.0}, 1, "start = 240 m: must be in 0 .. 240 m"),
        ({"start": 39.999, "spacing": 40.0}, 2, "with a pantograph 40 m behind"),
        ({"spacing": 0.0}, 2, "spacing = 0 m"),
        ({"stop": 30.049, "step": 1e-3}, 1, "is longer than the run"),
        ({"speed": -50.0}, 1, "speed = -50 m/s: must be above 0"),
        ({"step": math.inf}, 1, "step = inf s"),
        ({}, 0, "0 pantographs: must be 1 or 2"),
        ({"uplift": (1.0, 2.0)}, 1, "2 uplifts for 1 pantographs"),
        ({"uplift": (1.0, math.inf), "start": 90.0, "spacing": 40.0}, 2, "uplift = inf N"),
    ],
)
def test_what_is_just_beyond_them_is_not(changed, count, told):
    with pytest.raises(ZSpringError) as error:
        LINE.complete(Journey(**{**RUN, **changed}), count)
    assert told in str(error.value)


@pytest.mark.parametrize("way, step, steps", [(0.7, 0.01, 7), (0.75, 0.01, 7), (0.3, 0.01, 3), (0.1, 0.01, 1)])
def test_as_many_steps_are_made_as_fit_whole(way, step, steps):
    """At 10 m/s; 30.7 - 30 is a little less than seven tenths in binary numbers."""
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        journey = Journey(10.0, 30.0, 30.0 + way, step)
        with LineRun(System(catenary, pantograph, {"line.spans": 2}, [{}], journey)) as run:
            assert run.steps == steps
            run.finish()
            result = run.result()
    np.testing.assert_allclose(result.time, step * np.arange(steps + 1))
    np.testing.assert_allclose(result.position[:, 0], 30 + 10 * result.time)
