"""Where the far end of a line begins to tell, what is evaluated before, and what the line's model is good for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from zspring.couple.report import summary
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.evaluated import evaluated, sections
from zspring.line.journey import FittedJourney, Journey, LineExtent
from zspring.line.limits import FAR_END, near_wave_speed, of_series
from zspring.line.result import LineResult
from zspring.line.run import run_line
from zspring.line.stated import UNDISTURBED, Stated
from zspring.line.statistics import Section, low_pass
from zspring.line.system import System
from zspring.line.waves import fastest, undisturbed_until, wave_speed
from zspring.parameter_sets import LINES, find_set, read_set


@pytest.fixture(scope="module")
def fmus() -> Iterator[tuple[Fmu, Fmu]]:
    """Catenary and pantograph."""
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        yield catenary, pantograph


def test_wave_speeds_are_those_of_strings(fmus):
    """sqrt(20 000 / 1.35) and sqrt(16 000 / 1.07); the faster wire counts."""
    assert wave_speed(fmus[0], {}, "contact_wire") == pytest.approx(121.716, abs=1e-3)
    assert fastest(fmus[0], {}) == wave_speed(fmus[0], {}, "messenger") == pytest.approx(122.283, abs=1e-3)
    assert fastest(fmus[0], {"contact_wire.tension": 24e3}) == pytest.approx(133.333, abs=1e-3)


@pytest.mark.parametrize("behind", [0.0, 45.0])
@pytest.mark.parametrize("speed, length", [(20.0, 240.0), (69.4, 600.0), (119.0, 600.0)])
def test_front_and_pantograph_are_at_one_place_at_one_time(speed, length, behind):
    """The front is at the end and back again when the pantograph is there."""
    journey = FittedJourney(speed, 70.0, length)
    place = undisturbed_until(LineExtent.alike(1, length), journey, behind, 120.0)
    assert place < length
    assert (length - 70.0 + length - place) / 120.0 == pytest.approx((place - 70.0 + behind) / speed)


@pytest.mark.parametrize("speed", [120.0, 150.0])
def test_a_pantograph_as_fast_as_the_wave_meets_it_at_the_end(speed):
    assert undisturbed_until(LineExtent.alike(1, 600.0), FittedJourney(speed, 70.0, 600.0), 0.0, 120.0) == 600.0


@pytest.mark.parametrize("name, kmh", [("en-50318-2002", 250.0), ("benchmark-2015", 160.0)])
def test_a_longer_line_changes_the_force_from_there_on_and_not_before(fmus, name, kmh):
    """0-20 Hz; the filter runs both ways and shows a little of it before the front is there."""
    catenary, pantograph = fmus
    line = read_set(find_set(name, LINES), catenary)
    short, long = (
        run_line(
            System(
                catenary,
                pantograph,
                {**line, "line.spans": spans},
                [{"suspension": 2}],
                Journey(kmh / 3.6, stop=4.5 * line["line.span"], step=2e-3),
            )
        )
        for spans in (5, 10)
    )
    (until,), position = short.undisturbed_until, short.position[:, 0]
    force, other = (low_pass(result.contact_force[:, 0], 2e-3) for result in (short, long))
    change = np.abs(force - other)
    assert change[position < until].max() < 0.2
    assert change[position > until].max() > 5
    first = position[np.argmax(change > 0.3)]
    assert until < first < until + 0.3 * line["line.span"]


def passage(begin: float, end: float, until: float) -> LineResult:
    """One pantograph at 50 m/s that feels the far end from `until` m on."""
    time = np.arange(round((end - begin) / 0.05) + 1) / 1000
    position = begin + 50 * time[:, None]
    nothing = np.zeros_like(position)
    settings = {UNDISTURBED.format(1): f"{until:.1f} m"}
    return LineResult(
        time, position, nothing + 100, nothing, nothing, np.array([]), nothing[:, :0], 0 * time, nothing, settings, 1.0
    )


LINE = LineExtent.alike(10, 50.0)


@pytest.mark.parametrize(
    "begin, end, until, spans",
    [
        (25.0, 475.0, 300.0, (5, 6)),
        (25.0, 475.0, 299.9, (4, 5)),
        (25.0, 475.0, 200.0, (3, 4)),
        (25.0, 475.0, 150.0, (3, 3)),
        (25.0, 475.0, 149.9, None),
        (25.0, 270.0, 300.0, (4, 5)),
        (60.0, 149.0, 300.0, None),
    ],
)
def test_what_is_evaluated_by_default_ends_before_the_far_end_tells(begin, end, until, spans):
    assert evaluated(passage(begin, end, until), 0, LINE) == (spans and Section.alike(*spans, 50.0))


def test_a_run_that_has_nothing_else_is_evaluated_where_it_is_asked_for_alone():
    result = passage(25.0, 475.0, 149.9)
    with pytest.raises(ZSpringError, match=r"no whole span between 75 m, a span after the start, and 149\.9 m"):
        sections(result, LINE, None)
    assert sections(result, LINE, (5, 6)) == [Section.alike(5, 6, 50.0)]
    assert sections(passage(60.0, 149.0, 300.0), LINE, None) == [None]


def test_the_summary_says_from_where_on_the_far_end_tells():
    told = f"from 300 m on {FAR_END}"
    assert summary(passage(25.0, 475.0, 300.0), [Section.alike(5, 6, 50.0)])[-1] == told
    assert told not in summary(passage(25.0, 299.0, 300.0), [None])


def test_sections_beyond_are_warned_of():
    series = passage(25.0, 475.0, 300.0).series(0)
    assert of_series(series, Section.alike(5, 6, 50.0)) == []
    for section, end in ((Section.alike(5, 7, 50.0), 350), (None, 475)):
        (line,) = of_series(series, section)
        assert f"goes to {end} m, but from 300 m on {FAR_END}" in line
    assert of_series(replace(series, stated=Stated()), None) == []


def test_speeds_near_the_wave_speed_and_large_uplifts_are_warned_of(fmus):
    """0.7 of 121.716 m/s are 306.7 km/h."""
    assert near_wave_speed(fmus[0], {}, 306 / 3.6) == []
    (line,) = near_wave_speed(fmus[0], {}, 308 / 3.6)
    assert "308 km/h is 0.70 of the contact wire's wave speed, 438.2 km/h" in line
    series = passage(25.0, 299.0, 300.0).series(0)
    assert of_series(replace(series, uplift={"a": np.array([0.0, 0.199])}), None) == []
    (line,) = of_series(replace(series, uplift={"a": np.array([0.0, 0.199]), "b": np.array([0.0, 0.201])}), None)
    assert "uplift of 201 mm at a support" in line and "up to 200 mm" in line
