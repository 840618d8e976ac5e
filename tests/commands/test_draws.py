"""What commands make of draws of the pantograph's parameters."""

from __future__ import annotations

import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest

from commands import start, table, zspring
from linear import PUBLISHED, LinearPantograph

COUPLE = ["--set-line", "line.spans=4", "--stop", "200", "--step", "0.002"]


def draws(path: Path, *static_forces: float) -> str:
    path.write_text("static_force [N],k1 [N/m]\n" + "".join(f"{force},9430\n" for force in static_forces))
    return path.name


def test_a_line_is_run_for_each_draw(tmp_path):
    """Each row is that of a run of its own with these parameters; the interval is that of the rows."""
    forces = [100.0, 110.0, 120.0, 130.0, 140.0]
    linear = ["--set", "suspension=Linear", *COUPLE]
    options = ["--draws", draws(tmp_path / "d.csv", *forces), "--output", "all"]
    out, err = zspring(tmp_path, "couple", *linear, *options)
    assert "5 draws are too few for 95 %: the intervals are all that they span (39 would do)" in err
    rows = table(tmp_path / "all/draws.csv")
    assert [(row["draw"], row["pantograph"]) for row in rows] == [(f"{i}", "1") for i in range(6)]
    alone, _ = zspring(tmp_path, "couple", *linear, "--set", "static_force=140", "--output", "one")
    mean = [float(row["mean_force [N]"]) for row in rows]
    assert f"{mean[5]:.1f}" == re.search(r"mean force +(\S+)", alone)[1]
    assert mean[0] == mean[3]  # as given is 120 N
    np.testing.assert_allclose(np.diff(mean[1:]), 10, rtol=0.02)
    found = re.search(r"mean force +(\S+) +(\S+) \.\. (\S+) +(\S+) +N", out)
    low, high = min(mean), max(mean)  # five draws tell no more
    assert found.groups() == (f"{mean[0]:.1f}", f"{low:.1f}", f"{high:.1f}", f"{high - low:.2g}")
    assert "5 draws of d.csv" in out and (tmp_path / "all/draws.png").exists()


def test_runs_of_draws_go_on_after_an_interruption(tmp_path):
    name = draws(tmp_path / "d.csv", *range(100, 140))
    options = ["couple", *COUPLE, "--draws", name, "--output", "broken"]
    process = start(tmp_path, *options)
    record = tmp_path / "broken/draws.csv"
    while not (record.exists() and len(table(record)) > 2):
        assert process.poll() is None
    os.kill(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "the same command goes on from there" in err
    kept = len(table(record))
    assert 2 < kept < 41
    draws(tmp_path / "d.csv", 100)
    _, err = zspring(tmp_path, *options, status=1)
    assert "is of other settings (draws" in err
    draws(tmp_path / "d.csv", *range(100, 140))
    out, _ = zspring(tmp_path, *options)
    assert f"going on after {kept} of 41" in out and len(table(record)) == 41


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("drive [1]\n2\n", "d.csv: drive: must be a Real parameter"),
        ("solver.step [s]\n1e-3\n", "d.csv: solver.step: must be a Real parameter that the command does not set"),
        ("m1 [kg]\n-1\n", "m1 = -1 kg: must be at least"),
        ("c1 [N.s/m]\n5\n", "c1: is in d.csv and in --set: give one of them"),
    ],
)
def test_draws_that_cannot_be_run_are_refused(tmp_path, text, complaint):
    (tmp_path / "d.csv").write_text(text)
    _, err = zspring(tmp_path, "couple", *COUPLE, "--set", "c1=5", "--draws", "d.csv", status=1)
    assert complaint in err and len(err.strip().splitlines()) == 1


def test_bands_of_a_linear_suspension_are_quantiles_of_its_receptance(tmp_path):
    """Of three masses with springs in a row, whose matrix is inverted here."""
    stiffness = np.linspace(9000.0, 10000.0, 9)
    (tmp_path / "d.csv").write_text("k1 [N/m]\n" + "\n".join(map(str, stiffness)) + "\n")
    options = ["--set", "suspension=Linear", "--set", "solver.step=1e-4", "--amplitudes", "1,2", "--frequencies", "3,5"]
    out, _ = zspring(tmp_path, "frf", *options, "--tolerance", "1e-4", "--draws", "d.csv", "--output", "bands")
    rows = table(tmp_path / "bands/bands.csv")
    assert [(row["level"], row["frequency [Hz]"]) for row in rows] == [
        (level, f) for level in ("1 m/s2", "2 m/s2") for f in ("3", "5")
    ]
    values = {name: value for name, value in PUBLISHED["DSA-380"].items() if name != "k1"}
    half: dict[str, float] = {}
    for row in rows:
        f = float(row["frequency [Hz]"])
        H = np.array([LinearPantograph(head=k, **values).receptance(f) for k in [9430.0, *stiffness]])
        magnitude = [f(np.abs(H[1:])) for f in (np.min, np.median, np.max)]  # nine draws tell no more
        found = [float(row[f"magnitude_{part} [m/N]"]) for part in ("low", "median", "high")]
        np.testing.assert_allclose(found, magnitude, rtol=1e-3)
        assert float(row["magnitude [m/N]"]) == pytest.approx(abs(H[0]), rel=1e-3)
        phase = np.degrees(np.angle(H[1:]))
        assert float(row["phase_median [deg]"]) == pytest.approx(np.median(phase), abs=0.05)
        half[row["frequency [Hz]"]] = 50 * (magnitude[2] - magnitude[0]) / magnitude[1]
    worst = max(half, key=half.__getitem__)
    assert out.count(f"±{half[worst]:.2g} % at {worst} Hz") == 2
    assert sorted(path.name for path in (tmp_path / "bands").iterdir()) == ["bands.csv", "bands.png"]


def test_draws_without_effect_are_told(tmp_path):
    """k1 is nothing to the Z-spring."""
    draws(tmp_path / "d.csv", 120, 120)
    _, err = zspring(tmp_path, "frf", "--amplitudes", "1", "--frequencies", "5", "--draws", "d.csv", "--output", "out")
    assert "the draws change nothing" in err


OTHERS = ["--error-estimate"], ["--direction", "both"], ["--control", "force", "--levels", "9"]


@pytest.mark.parametrize("other", OTHERS)
def test_bands_have_no_other_course(tmp_path, other):
    _, err = zspring(tmp_path, "frf", "--draws", draws(tmp_path / "d.csv", 100), *other, status=1)
    assert "Invalid value for --draws: has no" in err


STUDY = """design = "list"
draws = "d.csv"
[static]
amplitudes = [0.01]
"""


def test_a_study_has_a_case_for_each_draw(tmp_path):
    """The suspension alone is loaded: its stiffness is k1, at any static force."""
    (tmp_path / "d.csv").write_text("static_force [kN],k1 [N/mm]\n0.1,9\n0.13,8.5\n")
    (tmp_path / "s.toml").write_text(STUDY + '[set]\nsuspension = "Linear"\n')
    zspring(tmp_path, "study", "s.toml", "--output", "out")
    (path,) = (tmp_path / "out").glob("*.csv")
    rows = table(path)
    assert [(float(row["static_force [N]"]), float(row["k1 [N/m]"])) for row in rows] == [(100, 9000), (130, 8500)]
    column = next(name for name in rows[0] if name.startswith("static stiffness"))
    np.testing.assert_allclose([float(row[column]) for row in rows], [9000, 8500], rtol=1e-3)


@pytest.mark.parametrize(
    "old, new, complaint",
    [
        ('"list"', '"grid"', "draws: needs design list"),
        ("[static]", "[vary]\nk1 = [9000]\n[static]", "draws: must be given without [vary]"),
        ('draws = "d.csv"\n', "", "[vary]: needs at least one"),
        ('"d.csv"', '"e.csv"', "e.csv"),
    ],
)
def test_a_study_of_draws_is_clear(tmp_path, old, new, complaint):
    draws(tmp_path / "d.csv", 100)
    (tmp_path / "s.toml").write_text(STUDY.replace(old, new))
    _, err = zspring(tmp_path, "study", "s.toml", status=1)
    assert complaint in err and len(err.strip().splitlines()) == 1
