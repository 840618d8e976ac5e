"""Levels of a measurement: what was driven with one nominal amplitude is one curve, as it was measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from zspring.bench.curves import Curve, Source
from zspring.bench.levels import levels_of
from zspring.bench.measured import read_curves

ORDERS = {"m": 2, "m/s": 1, "m/s2": 0}


@pytest.mark.parametrize("unit", ORDERS)
@pytest.mark.parametrize("step", [0.05, 0.5, 2.0])
@pytest.mark.parametrize("by_frequency", [False, True])
def test_reached_amplitudes_are_levels_of_what_was_held(unit, step, by_frequency):
    """Four levels, a factor 2 apart, with 4 % scatter; written as accelerations, by level or by frequency."""
    frequencies = np.arange(1.0, 15.0, step)
    frequency, nominal = np.tile(frequencies, 4), np.repeat([0.3, 0.6, 1.2, 2.4], frequencies.size)
    if by_frequency:
        order = np.argsort(frequency, kind="stable")
        frequency, nominal = frequency[order], nominal[order]
    scatter = np.random.default_rng(1).standard_normal(frequency.size)
    acceleration = nominal * (1 + 0.04 * scatter) * (2 * np.pi * frequency) ** ORDERS[unit]
    levels = levels_of(frequency, acceleration, acceleration, "m/s2")
    assert len(levels) == 4
    for level, value in zip(levels, (0.3, 0.6, 1.2, 2.4)):
        assert np.array_equal(level.points, np.flatnonzero(nominal == value))
        number, told = level.label.split()
        assert told == unit and float(number) == pytest.approx(value, rel=0.03)


def table(path: Path, columns: str, rows: list[tuple]) -> list[Curve]:
    text = "\n".join([columns, *(",".join(map(str, row)) for row in rows)]) + "\n"
    path.write_text(text, encoding="utf-8")
    return read_curves(Source(path))


COLUMNS = "frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]"


def test_points_keep_their_own_amplitude_and_the_order_of_the_file(tmp_path):
    """A sweep down and up again with an amplitude that is not quite reached."""
    rows = [(8, 0.98, 1e-4, -1e-5), (6, 1.03, 2e-4, -2e-5), (4, 1.01, 3e-4, -3e-5), (6, 0.97, 4e-4, -4e-5)]
    (curve,) = table(tmp_path / "bench.csv", COLUMNS, rows)
    frequency, acceleration, real, imaginary = np.transpose(rows)
    np.testing.assert_array_equal(curve.frequency, frequency)
    np.testing.assert_allclose(curve.acceleration, acceleration)
    np.testing.assert_allclose(curve.H, real + 1j * imaginary)
    assert curve.label == "0.995 m/s2"


def test_nominal_levels_that_lie_close_are_told_by_their_numbers(tmp_path):
    rows = [(f, a, 1e-4, -1e-5) for a in (1, 1.05, 1.1) for f in (2, 3, 4)]
    assert [curve.label for curve in table(tmp_path / "bench.csv", COLUMNS, rows)] == [
        "1 m/s2",
        "1.05 m/s2",
        "1.1 m/s2",
    ]


def test_a_column_may_tell_the_level(tmp_path):
    rows = [(f, a, 1e-4, -1e-5, name) for name, a in (("up", 1.0), ("down", 1.01)) for f in (2, 3, 4)]
    curves = table(tmp_path / "bench.csv", f"{COLUMNS},Level", rows)
    assert [curve.label for curve in curves] == ["up", "down"]
    assert [curve.frequency.size for curve in curves] == [3, 3]


def test_a_curve_is_refined_between_its_points_where_they_rise_or_fall():
    """Amplitudes in between on a logarithmic scale: 2 is half way from 1 to 4."""
    falling = Curve("", np.array([8.0, 6.0, 5.0]), np.array([1.0, 4.0, 4.0]), np.ones(3, complex))
    for points in (1, 4):
        fine = falling.refined(points)
        np.testing.assert_allclose(fine.frequency, [8, 7, 6, 5.5, 5])
        np.testing.assert_allclose(fine.acceleration, [1, 2, 4, 4, 4])
        np.testing.assert_array_equal(fine.H, [1, np.nan, 1, np.nan, 1])
    assert falling.refined(5).frequency.size == 7
    turning = Curve("", np.array([5.0, 6.0, 5.0]), np.ones(3), np.ones(3, complex))
    assert turning.refined(2) is turning
