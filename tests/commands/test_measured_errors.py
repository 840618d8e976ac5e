"""Standard errors and harmonics of measured responses: how they are read, and when they count."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from zspring.bench.curves import Curve, Harmonics, Source
from zspring.bench.measured import read_curves
from zspring.errors import ZSpringError
from zspring.identify.settings import Free, Settings, Static, Uncertainty
from zspring.identify.targets import settled_targets

HEAD = "frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]"
ERRORS = "magnitude_error [%],phase_error [deg]"
ROWS = ["2,1,3e-4,-4e-4", "4,1,0,-2e-4", "6,2,-1e-4,0"]


def table(path: Path, columns: str, *cells: str) -> Path:
    rows = [f"{row},{cell}" for row, cell in zip(ROWS, cells)]
    path.write_text("\n".join([f"{HEAD},{columns}", *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "columns, factor",
    [
        ("magnitude_error [m/N],phase_error [rad]", (1, 1)),
        ("magnitude_error [mm/N],phase_error [deg]", (1e3, 180 / np.pi)),
    ],
)
def test_standard_errors_go_with_their_points_whatever_their_unit(tmp_path, columns, factor):
    errors = [(5e-6, 0.01), (4e-6, 0.02), (1e-6, 0.03)]
    text = HEAD.replace("m/N", columns.split("[")[1].split("]")[0])
    scale = 1e3 if "mm" in columns else 1
    rows = [[float(cell) for cell in row.split(",")] for row in ROWS]
    lines = [
        ",".join(map(repr, [f, a, scale * re, scale * im, m * factor[0], p * factor[1]]))
        for (f, a, re, im), (m, p) in zip(rows, errors)
    ]
    (tmp_path / "a.csv").write_text("\n".join([f"{text},{columns}", *lines]) + "\n")
    first, second = read_curves(Source(tmp_path / "a.csv"))
    np.testing.assert_allclose(first.error, [[0.01, 0.01], [0.02, 0.02]], rtol=1e-12)
    np.testing.assert_allclose(second.error, [[0.01, 0.03]], rtol=1e-12)
    assert first.harmonics is None


def test_errors_in_percent_are_relative(tmp_path):
    path = table(tmp_path / "a.csv", "magnitude_error [%],phase_error [deg]", "2,1", "1,1", "0.5,1")
    first, second = read_curves(Source(path))
    np.testing.assert_allclose(first.error[:, 0], [0.02, 0.01])
    np.testing.assert_allclose(second.error[:, 0], [0.005])


def test_the_fixture_turns_errors_of_magnitude_and_phase_into_one_another():
    """Against the scatter of 20 000 noisy responses whose fixture is taken off."""
    H, f, mass, error = 3e-4 - 4e-4j, 4.0, 2.0, np.array([[0.02, 0.005]])
    noise = np.random.default_rng(1).standard_normal((2, 20_000))
    noisy = H * np.exp(error[0, 0] * noise[0] + 1j * error[0, 1] * noise[1])
    free = np.log(1 / (1 / noisy + mass * (2 * np.pi * f) ** 2))
    curve = Curve("", np.array([f]), np.ones(1), np.array([H]), error)
    found = Source(Path(), fixture_mass=mass).corrected(curve).error
    np.testing.assert_allclose(found[0], [free.real.std(), free.imag.std()], rtol=0.03)


def test_what_neighbours_share_goes_with_its_points(tmp_path):
    """Common errors go with their points through choices of points, and through the fixture's turn."""
    cells = ("2,1.5,0.004", "1,1,0.003", "0.5,1,0")
    first, second = read_curves(Source(table(tmp_path / "a.csv", f"{ERRORS},common_error [1]", *cells)))
    np.testing.assert_allclose(first.common, [0.004, 0.003])
    np.testing.assert_allclose(second.common, [0.0])
    np.testing.assert_allclose(first.at(np.array([1])).common, [0.003])
    (percent, _) = read_curves(Source(table(tmp_path / "b.csv", f"{ERRORS},common_error [%]", *cells)))
    np.testing.assert_allclose(percent.common, [4e-5, 3e-5])
    assert read_curves(Source(table(tmp_path / "c.csv", ERRORS, "2,1", "1,1", "0.5,1")))[0].common is None
    mass = 2.0
    taken = Source(Path(), fixture_mass=mass).corrected(first)
    shift = 1e-5 * np.exp(0.3j)
    moved = Source(Path(), fixture_mass=mass).corrected(replace(first, H=first.H * np.exp(shift)))
    np.testing.assert_allclose(np.abs(np.log(moved.H / taken.H)) / 1e-5, taken.common / first.common, rtol=1e-4)


def test_harmonics_are_those_that_have_a_column(tmp_path):
    path = table(tmp_path / "a.csv", "harmonic_3 [N],harmonic_5 [kN],harmonic_3_error [N]", "1,2,3", "4,5,6", "7,8,9")
    first, second = read_curves(Source(path))
    unknown = np.nan
    expected = [[unknown, 1, unknown, 2000, unknown, unknown], [unknown, 4, unknown, 5000, unknown, unknown]]
    np.testing.assert_allclose(first.harmonics.peak, expected)
    np.testing.assert_allclose(second.harmonics.error, [[unknown, 9, *[unknown] * 4]])
    assert first.error is None and first.at(np.array([1])).harmonics.peak[0, 1] == 4


@pytest.mark.parametrize(
    "columns, cells, complaint",
    [
        ("magnitude_error [m/N]", "1", "magnitude_error alone: needs magnitude_error and phase_error"),
        ("phase_error [deg]", "1", "phase_error alone"),
        ("magnitude_error,phase_error [deg]", "1,1", "column 'magnitude error' needs its unit"),
        ("magnitude_error [N],phase_error [deg]", "1,1", r"unit \[N\]"),
        ("magnitude_error [%],phase_error [deg]", "0,1", "line 2: magnitude_error = 0: must be positive"),
        ("magnitude_error [%],phase_error [deg]", "1,", "line 2: phase_error = '': must be a finite number"),
        ("harmonic_3 [m]", "1", r"column 'harmonic_3': unit \[m\]: must be one of N"),
        (f"{ERRORS},common_error [1]", "1,1,0.02", r"line 2: common_error = 2 %: .* part of .* so 0 to 1 %"),
        (f"{ERRORS},common_error [1]", "9,1,0.02", r"line 2: common_error = 2 %: .* part of .* so 0 to 1.74533 %"),
        (f"{ERRORS},common_error [%]", "1,1,-0.1", r"line 2: common_error = -0.1 %: must be a part of magnitude_error"),
        ("common_error [1]", "0.01", r"line 2: common_error = 1 %: must be a part of magnitude_error and phase_error$"),
        (f"{ERRORS},common_error [m/N]", "1,1,1e-6", r"column 'common_error': unit \[m/N\]"),
    ],
)
def test_what_tells_no_error_is_refused(tmp_path, columns, cells, complaint):
    path = table(tmp_path / "a.csv", columns, cells, cells, cells)
    with pytest.raises(ZSpringError, match=complaint) as error:
        read_curves(Source(path))
    assert "\n" not in str(error.value)


BARE = Curve("1 m/s2", np.array([2.0, 4.0]), np.ones(2), np.array([1e-4 - 1e-4j, 2e-4j]))
PEAK = np.ones((2, 6))
TOLD = replace(BARE, label="2 m/s2", error=np.full((2, 2), 0.01), harmonics=Harmonics(PEAK, np.full((2, 6), np.nan)))


def settings(**fields) -> Settings:
    free = {"zspring.k": Free(start=1, min=0, max=2)}
    return Settings.model_construct(model="zspring", free=free, **fields)


@pytest.mark.parametrize(
    "curves, fields, weights",
    [
        ([BARE], {}, "equal"),
        ([TOLD], {}, "errors"),
        ([TOLD], {"weights": "equal"}, "equal"),
        ([TOLD], {"error": "linear"}, "equal"),
        ([TOLD, BARE], {"weights": "equal"}, "equal"),
        ([TOLD], {"weights": "equal", "harmonics": (3,)}, "equal"),
    ],
)
def test_errors_count_where_all_files_tell_them(curves, fields, weights):
    assert settled_targets(settings(**fields), curves).weights == weights


@pytest.mark.parametrize(
    "curves, fields, complaint",
    [
        ([TOLD, BARE], {}, '1 m/s2 has no standard errors, other .* weights = "equal" counts all points alike'),
        ([TOLD, BARE], {"weights": "errors"}, "1 m/s2 has none: needs the columns magnitude_error"),
        ([TOLD], {"weights": "errors", "error": "linear"}, 'needs error = "log"'),
        ([TOLD, BARE], {"weights": "equal", "harmonics": (3,)}, "harmonics: 3: 1 m/s2 has no harmonic_3"),
        (
            [BARE],
            {"compare_models": True, "static": Static.model_construct(path=Path("s.csv"))},
            r"compare_models: needs a likelihood, which \[static\] beside the points do not have",
        ),
        (
            [TOLD],
            {"weights": "equal", "harmonics": (3,), "uncertainty": Uncertainty(draws=9)},
            "draws: needs a likelihood, which harmonics without standard errors beside the points do not have",
        ),
        ([TOLD], {"harmonics": (3,)}, r"harmonics: 3: 2 m/s2 has no harmonic_3_error \[N\] above 0 at every point"),
    ],
)
def test_weights_and_harmonics_that_no_file_tells_are_refused(curves, fields, complaint):
    with pytest.raises(ZSpringError, match=complaint):
        settled_targets(settings(**fields), curves)
