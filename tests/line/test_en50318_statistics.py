"""Statistics of a contact force against closed forms: gains, band variances, losses of contact, spans."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from zspring.errors import ZSpringError
from zspring.line.limits import untold_middles
from zspring.line.quantities import band_figure, described, is_figure, point_figure, points_of
from zspring.line.series import Series
from zspring.line.statistics import Section, low_pass, statistics

SPEED = 70.0  # m/s
MIDDLE = Section.alike(3, 8, 70.0)  # of 10 s at SPEED: 2 to 8 s


def gain(frequency: float, cutoff: float, rate: float = 1000.0) -> float:
    """Of the two passes of a bilinear Butterworth filter of order 4."""
    x = np.tan(np.pi * frequency / rate) / np.tan(np.pi * cutoff / rate)
    return 1 / (1 + x**8)


def series(force, rate: float = 1000.0, duration: float = 10.0, **others) -> Series:
    """A force given as a function of time in s."""
    time = np.arange(round(duration * rate) + 1) / rate
    values = np.broadcast_to(np.asarray(force(time), float), time.shape)
    return Series("test", time, values, SPEED * time, **others).check()


@pytest.mark.parametrize("frequency", [0.5, 2.0, 4.5, 5.0, 6.0, 12.0, 19.0, 20.0, 24.0])
def test_a_sine_comes_through_with_the_gain_of_its_frequency(frequency):
    found = statistics(series(lambda t: 120 + 30 * np.sin(2 * np.pi * frequency * t)), MIDDLE)
    deviation = 30 / np.sqrt(2)
    whole, low = gain(frequency, 20), gain(frequency, 5)
    assert found["mean_force"] == pytest.approx(120, abs=1e-3)
    assert found["standard_deviation"] == pytest.approx(deviation * whole, rel=1e-3)
    assert found["standard_deviation_0_2"] == pytest.approx(deviation * gain(frequency, 2), rel=2e-3, abs=0.02)
    assert found["standard_deviation_0_5"] == pytest.approx(deviation * low, rel=1e-3, abs=0.01)
    assert found["standard_deviation_5_20"] == pytest.approx(deviation * (whole - low), rel=1e-3, abs=0.02)
    assert found["statistical_maximum"] == pytest.approx(120 + 3 * deviation * whole, rel=1e-3)
    assert found["statistical_minimum"] == pytest.approx(120 - 3 * deviation * whole, rel=2e-3)
    assert found["actual_maximum"] == pytest.approx(120 + 30 * whole, rel=2e-3)
    assert found["actual_minimum"] == pytest.approx(120 - 30 * whole, rel=2e-3)


@pytest.mark.parametrize("band, frequency", [((0, 50), 35), ((20, 50), 22), ((20.5, 50), 60), ((50, 200), 90)])
def test_any_other_band_is_the_difference_of_two_filters(band, frequency):
    found = statistics(
        series(lambda t: 120 + 30 * np.sin(2 * np.pi * frequency * t)), MIDDLE, further=[band_figure(*band)]
    )
    low, high = (gain(frequency, cutoff) if cutoff else 0.0 for cutoff in band)
    assert list(found)[-1] == band_figure(*band) and is_figure(band_figure(*band))
    assert found[band_figure(*band)] == pytest.approx(30 / np.sqrt(2) * (high - low), rel=2e-3)


def test_bands_that_a_series_is_too_short_for_are_not_told_or_refused():
    """Five periods: of 2 Hz 2.5 s; a series of 2 s has those of 5 Hz."""
    short = series(lambda t: 100 + t, duration=2.0)
    found = statistics(short)
    assert np.isnan(found["standard_deviation_0_2"]) and not np.isnan(found["standard_deviation_0_5"])
    with pytest.raises(ZSpringError, match=r"too short for 1\.5 Hz: at least 3\.33333 s"):
        statistics(short, further=["standard_deviation_1.5_20"])
    with pytest.raises(ZSpringError, match=r"sample step 0\.001 s: must be below 0\.0008 s for 500 Hz"):
        statistics(short, further=["standard_deviation_20_500"])


@pytest.mark.parametrize(
    "name", ["standard_deviation_5_2", "standard_deviation_5", "uplift_at_", "uplift_at_-3", "mean"]
)
def test_other_names_are_no_figures(name):
    assert not is_figure(name)
    with pytest.raises(KeyError):
        described(name)


def test_the_filter_does_not_shift_the_phase():
    time = np.arange(10001) / 1000
    sine = np.sin(2 * np.pi * 12 * time)
    filtered = low_pass(sine, 1e-3)
    inside = slice(1000, -1000)
    assert filtered[inside] == pytest.approx(gain(12, 20) * sine[inside], abs=1e-6)


def test_variances_of_the_parts_add_up_for_tones_away_from_5_hz():
    found = statistics(
        series(lambda t: 100 + 20 * np.sin(2 * np.pi * 1.5 * t) + 15 * np.sin(2 * np.pi * 11 * t)), MIDDLE
    )
    parts = found["standard_deviation_0_5"] ** 2 + found["standard_deviation_5_20"] ** 2
    assert found["standard_deviation"] ** 2 == pytest.approx(parts, rel=2e-3)
    assert found["standard_deviation_0_5"] == pytest.approx(20 / np.sqrt(2), rel=1e-3)


def test_white_noise_keeps_the_power_in_the_band():
    """Noise bandwidth: the integral of the squared gain, against the whole band up to half the rate."""
    noise = np.random.default_rng(1).normal(0, 10, 400_001)
    found = statistics(Series("noise", np.arange(400_001) / 1000, noise))
    for name, cutoff in (("standard_deviation", 20.0), ("standard_deviation_0_5", 5.0)):
        bandwidth, _ = quad(lambda f, cutoff=cutoff: gain(f, cutoff) ** 2, 0, 60)
        assert found[name] == pytest.approx(10 * np.sqrt(bandwidth / 500), rel=0.03)


@pytest.mark.parametrize("rate", [120.0, 200.0, 500.0, 2000.0, 5000.0])
def test_figures_do_not_depend_on_the_sample_rate(rate):
    def force(t):
        return 110 + 20 * np.sin(2 * np.pi * 1.2 * t) + 12 * np.sin(2 * np.pi * 9 * t + 1)

    expected, found = statistics(series(force), MIDDLE), statistics(series(force, rate), MIDDLE)
    for name in ("mean_force", "standard_deviation", "standard_deviation_0_5", "standard_deviation_5_20"):
        assert found[name] == pytest.approx(expected[name], rel=2e-3), name
    for name in ("actual_maximum", "actual_minimum"):
        assert found[name] == pytest.approx(expected[name], abs=1.0), name


def test_a_constant_and_a_trend_stay_as_they_are_up_to_the_ends():
    time = np.arange(2001) / 1000
    for force in (np.full(2001, 130.0), 80 + 25 * time):
        assert low_pass(force, 1e-3) == pytest.approx(force, abs=1e-9)


def test_columns_are_filtered_one_by_one():
    both = np.random.default_rng(2).normal(100, 20, (3000, 2))
    columns = [low_pass(column, 1e-3) for column in both.T]
    assert low_pass(both, 1e-3) == pytest.approx(np.column_stack(columns), abs=1e-12)


def test_losses_are_counted_in_the_unfiltered_force():
    def force(t):
        lost = ((t >= 3) & (t < 3.012)) | ((t >= 5) & (t < 5.030)) | (t < 0.5)  # the last one outside
        return np.where(lost, 0.0, 100.0)

    found = statistics(series(force), MIDDLE)
    assert found["losses"] == 2
    assert found["longest_loss"] == pytest.approx(30)
    assert found["loss_of_contact"] == pytest.approx(100 * 42 / 6000)
    assert found["actual_minimum"] > 0  # the filter closes gaps this short
    whole = statistics(series(force))
    assert whole["losses"] == 3 and whole["longest_loss"] == pytest.approx(500)


def test_each_span_is_evaluated_for_itself():
    force = series(lambda t: 100.0 + 10 * np.floor(SPEED * t / 70 + 1e-9))
    for section in MIDDLE.single_spans():
        assert statistics(force, section)["mean_force"] == pytest.approx(90 + 10 * section.first, abs=0.2)
    assert statistics(force, MIDDLE)["mean_force"] == pytest.approx(145, abs=0.1)


def test_a_section_may_be_all_of_the_series_but_no_more():
    force = series(lambda t: 100.0 + 10 * (t >= 9))  # the tenth span of 70 m alone
    assert statistics(force, Section.alike(1, 10, 70.0))["mean_force"] == pytest.approx(101, abs=0.2)
    for section in Section.alike(1, 10, 70.0, start=-0.01), Section.alike(1, 10, 70.0, start=0.01):
        with pytest.raises(ZSpringError, match="the series has 0 to 700 m"):
            statistics(force, section)


def test_uplift_is_that_of_supports_in_the_section_and_its_ends():
    time = np.arange(10001) / 1000
    peaks = {"a": 0.090, "b": 0.040, "c": 0.055, "d": 0.080}
    places = {"a": 70.0, "b": 140.0, "c": 560.0, "d": 630.0}
    uplift = {name: peak * np.exp(-((SPEED * time - places[name]) ** 2) / 50) for name, peak in peaks.items()}
    height = 0.1 + 0.02 * np.sin(2 * np.pi * time)
    known = Series("test", time, np.full(10001, 100.0), SPEED * time, height, uplift, places)
    found = statistics(known, MIDDLE)
    assert found["support_uplift"] == pytest.approx(55)
    assert found["contact_point_range"] == pytest.approx(40, rel=1e-4)
    nowhere = Series("test", time, np.full(10001, 100.0), SPEED * time, None, uplift)
    assert statistics(nowhere, MIDDLE)["support_uplift"] == pytest.approx(90)
    assert np.isnan(statistics(nowhere, MIDDLE)["contact_point_range"])


def test_uplift_at_mid_span_and_at_points_is_that_of_the_wire_there():
    """Spans of 70 m from 140 m on, middles at 175, 245 ... m: 176.3 m is one of them, 176.5 m is not any more."""
    time = np.arange(10001) / 1000
    at = {100.0: 0.2, 176.3: 0.05, 176.5: 0.07, 245.0: 0.04, 300.0: 0.3}
    lifted = {x: peak * np.exp(-((SPEED * time - x) ** 2) / 50) for x, peak in at.items()}
    known = Series("test", time, np.full(10001, 100.0), SPEED * time, points=lifted)
    names = [point_figure(x) for x in (100.0, 300.0, 299.0)]
    assert points_of(names) == (100.0, 300.0, 299.0)
    found = statistics(known, MIDDLE, further=names)
    assert found["midspan_uplift"] == pytest.approx(50, abs=0.01)
    assert [found[name] for name in names] == pytest.approx([200, 300, np.nan], abs=0.01, nan_ok=True)
    moved = statistics(known.moved(10.0), Section.alike(3, 8, 70.0, 10.0), further=["uplift_at_310"])
    assert (moved["midspan_uplift"], moved["uplift_at_310"]) == pytest.approx((50, 300), abs=0.01)
    assert np.isnan(statistics(known)["midspan_uplift"])  # no section, no spans
    assert "is that of 2 of the 6 spans" in untold_middles(known, Section.alike(3, 8, 70.0))[0]
    assert not untold_middles(known, Section.alike(3, 4, 70.0))


def test_spans_outside_the_line_are_refused():
    force = series(lambda t: 100 + t)
    with pytest.raises(ZSpringError, match=r"spans 9 to 11, 560 to 770 m: the series has 0 to 700 m"):
        statistics(force, Section.alike(9, 11, 70.0))
    with pytest.raises(ZSpringError, match="-50 to 20 m: the series has 0"):
        statistics(force, Section.alike(1, 1, 70.0, start=-50))
    without = Series("test", force.time, force.force)
    with pytest.raises(ZSpringError, match="needs positions, or the speed"):
        statistics(without, MIDDLE)


@pytest.mark.parametrize(
    ("count", "step", "message"),
    [
        (100, 1e-3, "too short"),
        (249, 1e-3, "0.249 s are too short for 20 Hz: at least 0.25 s"),
        (1000, 0.03, "sample step"),
        (1000, 0.02, "sample step 0.02 s: must be below 0.02 s"),
    ],
)
def test_the_filter_refuses_what_it_cannot_filter(count, step, message):
    with pytest.raises(ZSpringError, match=message):
        low_pass(np.ones(count), step)


@pytest.mark.parametrize(("count", "step"), [(250, 1e-3), (1000, 0.0199)])
def test_the_filter_takes_what_is_just_enough(count, step):
    assert low_pass(np.full(count, 7.0), step) == pytest.approx(np.full(count, 7.0))
