"""The command `zspring couple` and its files."""

from __future__ import annotations

import csv
import os
import re
import signal
import sys
import threading
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from zspring.cli import main
from zspring.couple.run import run_and_write
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.interrupt import Interrupted
from zspring.line.journey import Journey
from zspring.line.result import columns, read_result, write_result
from zspring.line.run import LineRun
from zspring.line.schemes import Coupling
from zspring.line.system import System
from zspring.parameter_sets import chosen_set

SHORT = ["--set-line", "line.spans=4", "--stop", "150", "--step", "0.002"]


@pytest.fixture
def zspring(tmp_path, monkeypatch, capsys) -> Callable[..., str]:
    """Runs `zspring couple` in tmp_path; what it prints, on standard error where it fails."""

    def run(*arguments: str, status: int = 0) -> str:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["zspring", "couple", *arguments])
        assert main() == status
        printed = capsys.readouterr()
        return printed.err if status else printed.out

    return run


def test_a_run_writes_series_with_units_and_a_figure(zspring, tmp_path):
    settings = ["--speed", "200", "--pantographs", "2", "--spacing", "35", "--start", "70"]
    settings += ["--set", "friction=Coulomb", "--tension", "22000", "18000", "--uplift", "28.8"]
    out = zspring(*SHORT, *settings, "--parquet", "--output", "out")
    assert "mean force" in out and "written: out/line.csv out/line.parquet out/line.png" in out
    result = read_result(tmp_path / "out/line.csv")
    assert result.position[:, 0] == pytest.approx(70 + 200 / 3.6 * result.time)
    assert result.position[:, 1] == pytest.approx(result.position[:, 0] - 35)
    assert list(result.support_position) == [60, 120, 180]
    assert result.moment.shape == (len(result.time), 2, 2)
    settings = result.settings
    assert settings["catenary contact_wire.tension"] == "22000 N"
    assert settings["catenary messenger.tension"] == "18000 N"
    assert settings["pantograph 2 friction"] == "Coulomb"
    assert settings["speed"] == "200 km/h" and settings["spacing"] == "35 m"
    assert settings["uplift"] == "28.8 N on upper_frame"
    assert settings["catenary FMU"].startswith("Catenary") and settings["pantograph 1 GUID"]
    assert (tmp_path / "out/line.png").read_bytes().startswith(b"\x89PNG")
    parquet = read_result(tmp_path / "out/line.parquet")
    assert parquet.contact_force == pytest.approx(result.contact_force, rel=1e-8)
    assert parquet.settings == settings


def test_each_pantograph_has_the_mean_force_that_is_asked_for(zspring, tmp_path):
    """0.00097 * 200^2 + 110 = 148.8 N over the spans that the summary names, by the mean of the rows there."""
    settings = ["--speed", "200", "--pantographs", "2", "--spacing", "35", "--start", "70", "--stop", "245"]
    settings += ["--set-line", "line.spans=6", "--step", "0.002", "--parameters", "benchmark-2015"]
    out = zspring(*settings, "--mean-force", "DC-3kV", "--output", "out").splitlines()
    assert out[0].startswith("mean force DC-3kV at 200 km/h: target 148.8 N, reached 148.")
    assert out[1] == "0-20 Hz, over span 4, 180 to 240 m and span 3, 120 to 180 m"
    result = read_result(tmp_path / "out/line.csv")
    uplifts = [float(text) for text in result.settings["uplift"].split(" N")[0].split(", ")]
    assert len(uplifts) == 2 and all(uplift > 148.8 - 120 + 1 for uplift in uplifts)  # k3 carries a part
    printed = re.findall(r"uplift of (\S+) N", out[0])
    assert [float(text) for text in printed] == pytest.approx(uplifts, abs=0.05)
    for i, begin in enumerate((180.0, 120.0)):
        inside = (result.position[:, i] >= begin) & (result.position[:, i] < begin + 60.0)
        assert result.contact_force[inside, i].mean() == pytest.approx(148.8, abs=0.5)


@pytest.fixture(scope="module")
def made() -> LineRun:
    """A run of two pantographs that ended early."""
    journey = Journey(60.0, 70.0, 100.0, 2e-3, 30.0)
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        pair = [{"zspring.Mf": 0.25}, {"zspring.Mf": 0.4}]
        with LineRun(System(catenary, pantograph, {"line.spans": 3}, pair, journey)) as run:
            run.finish()
            return run.result()


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_file_has_all_that_the_result_has(made, tmp_path, suffix):
    path = tmp_path / f"line.{suffix}"
    write_result(made, path)
    again = read_result(path)
    exact = {"rel": 0, "abs": 0} if suffix == "parquet" else {"rel": 1e-9, "abs": 1e-300}
    for name in "time", "position", "contact_force", "wire_height", "head_height", "support_position":
        assert getattr(again, name) == pytest.approx(getattr(made, name), **exact), name
    assert again.support_uplift == pytest.approx(made.support_uplift, **exact)
    assert again.moment == pytest.approx(made.moment, **exact)
    assert np.array_equal(again.slack_droppers, made.slack_droppers)
    assert again.settings == made.settings
    assert again.friction_bound == pytest.approx([0.25, 0.4])


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_file_has_the_positions_of_the_supports(made, tmp_path, suffix):
    """Those beyond 1 km too, and those that no short decimal number gives."""
    positions = np.array([60.0, 3 * 54.3])
    for position in (positions, positions + 1234.5678):
        path = tmp_path / f"line.{suffix}"
        write_result(replace(made, support_position=position), path)
        assert read_result(path).support_position == pytest.approx(position, rel=1e-9)
    assert "support uplift at 60 m [m]" in columns(made)


def test_a_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "line.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ZSpringError, match=r"line\.csv: no text in UTF-8"):
        read_result(path)


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "other.csv"
    path.write_text("# elapsed: 1 s\ntime [s],position 1 [m]\n0,1\n")
    with pytest.raises(ZSpringError, match=r"other.csv: .*contact force 1 \[N\]"):
        read_result(path)


def test_ctrl_c_keeps_the_rows_so_far():
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        fine = {"solver.step": 1e-4}
        with LineRun(System(catenary, pantograph, fine, [fine], Journey(50.0, step=1e-4))) as run:
            threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
            with pytest.raises(Interrupted, match=r"interrupted at 0\.\d+ s"):
                run.finish()
            rows = run.result()
            assert 50 <= len(rows.time) < run.steps
            assert rows.position[-1, 0] == pytest.approx(30 + 50 * rows.time[-1])


def test_a_run_that_cannot_go_on_keeps_its_rows_in_the_file(tmp_path):
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        system = System(catenary, pantograph, {}, [{}], Journey(70.0), Coupling("implicit", max_iterations=1))
        with pytest.raises(ZSpringError, match=r"converge.*; the rows so far are kept in .*line\.csv"):
            run_and_write(system, tmp_path, "png", parquet=False)
    assert len(read_result(tmp_path / "line.csv").time) >= 1


def test_results_of_other_settings_are_kept(zspring, tmp_path):
    """The series, the comparison of steps and the archive; the same settings may come again."""
    short = ["--set-line", "line.spans=2", "--start", "20", "--step", "0.002"]
    (tmp_path / "out").mkdir()
    for target in ["--output", "out"], ["--ssp", "out/line.ssp"], ["--compare-steps", "--output", "steps"]:
        for _ in range(2):
            zspring(*short, *target)
        before = {path: path.read_bytes() for path in tmp_path.glob("*/*")}
        assert "is of other settings" in zspring(*short, "--uplift", "3", *target, status=1)
        assert {path: path.read_bytes() for path in tmp_path.glob("*/*")} == before


def test_steps_are_compared(zspring, tmp_path):
    out = zspring(*SHORT[:4], "--parameters", "en-50318-2002", "--compare-steps", "--output", "out")
    lines = (tmp_path / "out/steps.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [(row["scheme"], float(row["step [s]"])) for row in rows] == [
        ("implicit", 5e-4),
        *((scheme, step) for scheme in ("sequential", "parallel") for step in (5e-4, 1e-3, 2e-3, 5e-3)),
        *(("implicit", step) for step in (1e-3, 2e-3, 5e-3)),
        *((scheme, step) for scheme in ("explicit", "jacobi") for step in (5e-4, 1e-3, 2e-3, 5e-3)),
    ]
    errors = {(row["scheme"], row["step [s]"]): float(row["rms [N]"]) for row in rows}
    assert errors["implicit", "0.001"] < 0.5 < errors["explicit", "0.001"] < 3 < errors["jacobi", "0.001"]
    assert "reference" in out and "written: out/steps.csv out/steps.png" in out


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--stop", "601"], "stop = 601 m: must be above the start, 30 m, and in the line of 600 m"),
        (["--uplift", "3", "--mean-force", "AC"], "--uplift 3 and --mean-force AC: give one of them"),
        (["--set-line", "travel=Position"], "travel=Position"),
        (["--set-line", "dropper.cont=3"], "did you mean dropper.count"),
        (["--tension", "0", "16000"], "contact_wire.tension = 0 N: must be at least 1"),
        (["--coupling", "jacobi", "--drive", "Force"], "needs drive Wire"),
        (["--line", "nowhere"], "nowhere: no such file, and no set of that name"),
        (["--step", "-1"], "step = -1 s: must be above 0"),
        (
            ["--compare-steps", "--speed", "180", "--stop", "90"],
            "stop = 90 m: with --compare-steps must be at least 90.25 m, one step of 0.005 s more than a "
            "span of 60 m after the start, 30 m",
        ),
    ],
)
def test_bad_settings_get_one_line(zspring, tmp_path, arguments, message):
    lines = zspring(*arguments, status=1).strip().splitlines()
    assert len(lines) == 1 and message in lines[0]
    assert not (tmp_path / "results").exists()


def test_the_archive_is_written_with_the_settings(zspring, tmp_path, capsys):
    """The pantograph's set in it is one for --parameters; its inputs are passed over."""
    out = zspring(*SHORT, "--set", "zspring.Mf=0.3", "--uplift", "20", "--ssp", "line.ssp")
    assert out == "written: line.ssp\n"
    assert (tmp_path / "line.ssp").stat().st_size > 100_000
    with zipfile.ZipFile(tmp_path / "line.ssp") as archive:
        path = Path(archive.extract("resources/pantograph.ssv", tmp_path))
    with Fmu() as pantograph:
        used = chosen_set(str(path), pantograph, but_not=("drive",))
    assert used == {"solver.step": 5e-4, "zspring.Mf": 0.3}
    assert capsys.readouterr().err == f"{path}: inputs are passed over: contact_force, uplift.upper_frame\n"
