"""Validation of a pantograph by its frequency response: errors by band, known by construction."""

from __future__ import annotations

import itertools
import threading
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.curves import Curve, Source
from zspring.en50318.frf import band_errors, compare_frf
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.receptance import receptance

FREQUENCY = np.arange(1.0, 20.5, 0.5)
EDGES = (0.5, 5.0, 20.0)


@pytest.fixture(scope="module")
def pantograph():
    with Fmu() as fmu:
        yield fmu


def linear_receptance(fmu: Fmu, **parameters: float) -> np.ndarray:
    """The three-mass model's, by linear algebra."""
    names = fmu.variables.names("parameter")
    with fmu.instances() as (instance,):
        instance.start({"suspension": 2, **parameters})
        return receptance(FREQUENCY, dict(zip(names, instance.get(names))), "linear")


def write_measured(path: Path, H: np.ndarray, amplitudes=(1.0, 4.0)) -> Path:
    lines = ["frequency [Hz],amplitude [m/s2],magnitude [mm/N],phase [deg]"]
    for amplitude in amplitudes:
        values = zip(FREQUENCY, 1e3 * np.abs(H), np.degrees(np.angle(H)))
        lines += [f"{f},{amplitude},{m:.9g},{p:.9g}" for f, m, p in values]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_errors_are_those_that_were_put_in():
    """Magnitude 10 % and phase 5 deg off below 5 Hz, the opposite above."""
    H = 1e-4 / (1 + 0.1j * FREQUENCY)
    low = FREQUENCY < 5
    off = np.where(low, 1.10 * np.exp(1j * np.radians(5)), 0.90 * np.exp(-1j * np.radians(5)))
    below, above = band_errors(Curve("1 m/s2", FREQUENCY, np.ones_like(FREQUENCY), H), H * off, EDGES)
    assert (below.band, below.points) == ((0.5, 5.0), int(low.sum()))
    assert (above.band, above.points) == ((5.0, 20.0), int((~low).sum()))
    for error, sign in ((below, 1), (above, -1)):
        for found in (error.magnitude_mean, error.magnitude_largest, sign * error.magnitude_rms):
            assert found == pytest.approx(0.10 * sign)
        for found in (error.phase_mean, error.phase_largest, sign * error.phase_rms):
            assert found == pytest.approx(5 * sign)


def test_points_that_failed_count_in_no_band():
    H = np.full(FREQUENCY.shape, 1e-4 + 0j)
    computed = np.where(FREQUENCY < 5, np.nan, 2 * H)
    (error,) = band_errors(Curve("1 m/s2", FREQUENCY, np.ones_like(FREQUENCY), H), computed, EDGES)
    assert error.band == (5.0, 20.0) and error.magnitude_mean == pytest.approx(1)


def test_the_linear_fmu_agrees_with_linear_algebra_at_every_amplitude(pantograph, tmp_path):
    """Within what HHT-alpha shifts frequencies at the step that comparisons take."""
    path = write_measured(tmp_path / "measured.csv", linear_receptance(pantograph))
    found = compare_frf(pantograph, Source(path), {"suspension": 2}, EDGES, "up", 2, threading.Event())
    assert [each.measured.label for each in found] == ["1 m/s2", "4 m/s2"]
    for each in found:
        for error in each.errors:
            assert error.magnitude_rms < 0.01 and error.phase_rms < 1.0


def test_a_wrong_model_shows_in_the_band_where_it_is_wrong(pantograph, tmp_path):
    """10 % more head mass: nothing at 1 to 2 Hz, where stiffness and frames rule, much near 6.5 Hz."""
    path = write_measured(tmp_path / "measured.csv", linear_receptance(pantograph), (1.0,))
    edges = (0.5, 2.0, 5.0, 8.0, 20.0)
    heavy = {"suspension": 2, "m1": 1.1 * 7.12}
    (found,) = compare_frf(pantograph, Source(path), heavy, edges, "up", 1, threading.Event())
    by_band = {error.band: error for error in found.errors}
    ratio = linear_receptance(pantograph, m1=1.1 * 7.12) / linear_receptance(pantograph)
    for low, high in itertools.pairwise(edges):
        inside = (low <= FREQUENCY) & ((high > FREQUENCY) | (high == FREQUENCY) & (high == edges[-1]))
        error = by_band[(low, high)]
        expected = np.sqrt(np.mean((np.abs(ratio[inside]) - 1) ** 2))
        assert error.magnitude_rms == pytest.approx(expected, rel=0.01)
        phase = np.degrees(np.sqrt(np.mean(np.angle(ratio[inside]) ** 2)))
        assert error.phase_rms == pytest.approx(phase, rel=0.01)
    assert by_band[(0.5, 2.0)].magnitude_rms < 0.03 and by_band[(5.0, 8.0)].magnitude_rms > 0.15


def test_bad_requests_are_refused(pantograph, tmp_path):
    path = write_measured(tmp_path / "measured.csv", np.full(FREQUENCY.shape, 1e-4 - 1e-5j))
    stop = threading.Event()
    with pytest.raises(ZSpringError, match="at least two edges"):
        compare_frf(pantograph, Source(path), {}, (5.0,), "up", 1, stop)
    with pytest.raises(ZSpringError, match="no data with 1 m/s2"):
        compare_frf(pantograph, Source(path), {}, (30.0, 40.0), "up", 1, stop)
    with pytest.raises(ZSpringError, match="m1"):
        compare_frf(pantograph, Source(path), {"m1": -1.0}, EDGES, "up", 1, stop)
