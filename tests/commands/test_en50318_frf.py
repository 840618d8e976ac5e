"""Validation of a pantograph by its frequency response: errors by band, known by construction."""

from __future__ import annotations

import itertools
import threading
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.compare import band_errors, compare_frf
from zspring.bench.curves import Curve, Source
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.receptance import receptance

FREQUENCY = np.arange(1.0, 20.5, 0.5)
EDGES = (0.5, 5.0, 20.0)
LINEAR = {"suspension": 2, "solver.step": 5e-4}


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


@pytest.mark.parametrize("turned", [-1.0, 1.0])
def test_angles_are_averaged_on_the_circle(turned):
    """A force of the wrong sign is 180 deg off, whatever side of it the scatter falls."""
    H = 1e-4 / (1 + 0.1j * FREQUENCY)
    scatter = np.where(np.arange(H.size) % 2, 1, -1) * np.radians(5) + turned * np.radians(1)
    curve = Curve("1 m/s2", FREQUENCY, np.ones_like(FREQUENCY), H)
    (error,) = band_errors(curve, -H * np.exp(1j * scatter), (0.5, 20.0))
    assert abs(error.phase_mean) == pytest.approx(179, abs=0.2) and error.phase_rms > 170


def test_points_that_failed_count_in_no_band():
    H = np.full(FREQUENCY.shape, 1e-4 + 0j)
    computed = np.where(FREQUENCY < 5, np.nan, 2 * H)
    (error,) = band_errors(Curve("1 m/s2", FREQUENCY, np.ones_like(FREQUENCY), H), computed, EDGES)
    assert error.band == (5.0, 20.0) and error.magnitude_mean == pytest.approx(1)


def test_the_linear_fmu_agrees_with_linear_algebra_at_every_amplitude(pantograph, tmp_path):
    """Within what HHT-alpha shifts frequencies at the commands' step."""
    path = write_measured(tmp_path / "measured.csv", linear_receptance(pantograph))
    found = compare_frf(pantograph, Source(path), LINEAR, EDGES, "up", 2, threading.Event()).levels
    assert [each.measured.label for each in found] == ["1 m/s2", "4 m/s2"]
    for each in found:
        for error in each.errors:
            assert error.magnitude_rms < 0.01 and error.phase_rms < 1.0


def test_a_wrong_model_shows_in_the_band_where_it_is_wrong(pantograph, tmp_path):
    """10 % more head mass: nothing at 1 to 2 Hz, where stiffness and frames rule, much near 6.5 Hz."""
    path = write_measured(tmp_path / "measured.csv", linear_receptance(pantograph), (1.0,))
    edges = (0.5, 2.0, 5.0, 8.0, 20.0)
    heavy = {**LINEAR, "m1": 1.1 * 7.12}
    (found,) = compare_frf(pantograph, Source(path), heavy, edges, "up", 1, threading.Event()).levels
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


def with_head(path: Path, head: str) -> Path:
    path.write_text(head + path.read_text(encoding="utf-8"), encoding="utf-8")
    return path


def test_the_bench_s_static_force_and_friction_are_those_of_the_head(pantograph, tmp_path):
    """With free rods at 70 N, as the head says, the response is that of the Z-spring linearised there."""
    H = receptance(FREQUENCY, pantograph.used_parameters({"static_force": 70.0, "suspension": 4}), "free")
    path = write_measured(tmp_path / "measured.csv", H, (1e-3,))
    head = "# static_force: 0.07 kN\n# friction: free\n# direction: down\n"
    stop = threading.Event()
    plain = compare_frf(pantograph, Source(path), {"suspension": 4}, EDGES, None, 1, stop)
    assert plain.direction == "file" and "does not say static_force and friction" in plain.remarks[0]
    assert max(error.magnitude_rms for error in plain.levels[0].errors) > 0.05
    told = compare_frf(pantograph, Source(with_head(path, head)), {"suspension": 4}, EDGES, None, 1, stop)
    assert (told.direction, told.remarks) == ("down", [])
    assert told.parameters["static_force"] == pytest.approx(70) and told.parameters["friction"] == 4
    assert max(error.magnitude_rms for error in told.levels[0].errors) < 0.01
    with pytest.raises(ZSpringError, match=r"static_force: .*measured.csv says 70 N, the settings 120 N: one of them"):
        compare_frf(pantograph, Source(path), {"static_force": 120.0}, EDGES, None, 1, stop)
    with pytest.raises(ZSpringError, match=r"direction: .*measured.csv says down, the settings up"):
        compare_frf(pantograph, Source(path), {}, EDGES, "up", 1, stop)


def test_a_force_of_the_wrong_sign_is_said(pantograph, tmp_path):
    path = write_measured(tmp_path / "measured.csv", -linear_receptance(pantograph), (1.0,))
    found = compare_frf(pantograph, Source(path), {"suspension": 2}, EDGES, None, 1, threading.Event())
    assert "positive imaginary part" in found.remarks[1] and "contact force" in found.remarks[1]
    assert all(abs(error.phase_mean) > 170 for error in found.levels[0].errors)


def test_points_of_the_model_that_do_not_settle_are_counted(pantograph, tmp_path):
    """A frame hardly damped, driven near its resonance at 12 Hz, not so at 5 Hz; and one well damped."""
    path = tmp_path / "bench.csv"
    path.write_text("frequency [Hz],amplitude [m/s2],magnitude [mm/N],phase [deg]\n5,1,0.1,-90\n12.2,1,0.1,-90\n")
    remarks = {}
    for c3 in (1.0, 200.0):
        compared = compare_frf(
            pantograph, Source(path), {**LINEAR, "c3": c3, "c1": 5.0 * c3}, EDGES, None, 1, threading.Event()
        )
        remarks[c3] = [remark for remark in compared.remarks if "settled" in remark]
    assert remarks == {1.0: ["1 points of the model had not settled after 400 periods"], 200.0: []}
