"""The command `zspring line`: what it prints and writes of a line is what the line is."""

from __future__ import annotations

import csv
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from catenary_line import BENCHMARK_2015
from commands import PNG
from paths import ROOT
from zspring.cli import main
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.system import System
from zspring.line_file.chosen import line_of

LINES = ROOT / "resources" / "lines"


@pytest.fixture
def zspring(tmp_path, monkeypatch, capsys) -> Callable[..., str]:
    """Runs `zspring` in tmp_path; what it prints, on standard error where it fails."""

    def run(*arguments: str, status: int = 0) -> str:
        monkeypatch.chdir(tmp_path)
        assert main(arguments) == status
        printed = capsys.readouterr()
        return printed.err if status else printed.out

    return run


def rows(path: Path) -> list[dict[str, str]]:
    lines = (line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    return list(csv.DictReader(lines))


def test_a_drawing_has_the_forces_and_the_elasticity_of_an_independent_line(zspring, tmp_path):
    """Of finite elements that share nothing with the FMU."""
    out = zspring("line", "draw", str(LINES / "benchmark-2015.toml"), "--spans", "5:6", "--output", "out")
    reference, folder = BENCHMARK_2015, tmp_path / "out"
    droppers = rows(folder / "dropper-forces.csv")
    for name, expected in ("force [N]", reference.T0), ("length [m]", reference.dropper_length):
        np.testing.assert_allclose([float(row[name]) for row in droppers], expected, rtol=1e-5)
    assert [(row["span"], row["dropper"]) for row in droppers[8:10]] == [("1", "9"), ("2", "1")]
    places = rows(folder / "elasticity.csv")
    assert (float(places[0]["position [m]"]), float(places[-1]["position [m]"])) == (220, 330)
    contact, found = reference.wires[0], {float(row["position [m]"]): float(row["elasticity [mm/N]"]) for row in places}
    for x in (220.0, 224.5, 247.5, 302.5):
        expected = (contact.at(x) @ reference.equilibrium([x], [100.0])[0])[0] / 100
        assert found[x] == pytest.approx(1e3 * expected, rel=1e-5)
    assert f"elasticity under 100 N, without the spans at the ends: {min(found.values()):.3f} to" in out
    assert (folder / "line.png").read_bytes().startswith(PNG) and b"<svg" in (folder / "line.svg").read_bytes()


def test_check_tells_what_was_read(zspring, tmp_path):
    text = (LINES / "stitched-synthetic.toml").read_text(encoding="utf-8")
    (tmp_path / "line.toml").write_text(text + "\n[[span_exception]]\nspans = 2\nmissing = 4\n", encoding="utf-8")
    out = zspring("line", "check", "line.toml").splitlines()
    assert out[0] == "Stitched, synthetic: 10 spans, 625 m, 70 droppers, 9 stitch wires, 1 point mass"
    assert any(line.split()[:5] == ["1,", "10", "65", "m", "7"] for line in out)
    (broken,) = (line for line in out if line.startswith("2 "))
    assert "0 to " in broken and broken.split()[-1] == "1"
    # 625 m of wires, 18 m of each of 9 stitch wires, clamps of 0.23 kg at 70 droppers and 0.6 kg at each stitch wire.
    assert "contact wire 675, messenger 375, stitch wires 50.22" in out[-1]
    assert f"clamps {70 * 0.23 + 9 * 0.6:.4g}, steady arms 7.2, point masses 0.9" in out[-1]


@pytest.mark.parametrize(
    "change, told",
    [
        (("sag = [0, 0.017, 0.028, 0.032,", "sag = [0, 0.017, 0.028, 0.6,"), "span 1, dropper 4, at 32.5 m: in the"),
        (("length = 18", "length = 80"), "span 2, at 90 m: a stitch wire from 90 m to 170 m: must be"),
        (("encumbrance = 1.6", "encumbrance = 0.4"), "the dropper would be"),
        (("spans = 10", "spans = x"), "line.toml: no TOML"),
    ],
)
def test_what_is_no_line_is_told_in_one_line_with_its_span(zspring, tmp_path, change, told):
    text = (LINES / "stitched-synthetic.toml").read_text(encoding="utf-8")
    assert change[0] in text
    (tmp_path / "line.toml").write_text(text.replace(*change), encoding="utf-8")
    error = zspring("line", "check", "line.toml", status=1)
    assert told in error and error.count("\n") == 1


def test_spans_that_the_line_has_not_are_told(zspring):
    error = zspring("line", "draw", str(LINES / "benchmark-2015.toml"), "--spans", "9:11", status=1)
    assert error == "zspring: --spans 9:11: must be in 1 .. 10\n"


def test_an_fmu_of_a_line_is_valid_and_runs_as_the_line_does(zspring, tmp_path):
    path = str(LINES / "stitched-synthetic.toml")
    zspring("line", "fmu", path, "made.fmu")
    assert validate_fmu("made.fmu") == []
    described = {v.name: v.description for v in read_model_description("made.fmu").modelVariables}
    assert described["line.span"] == described["dropper.sag[2]"] == "Not used: resources/line.table tells the line"
    assert described["messenger.tension"] == "Messenger wire: tension"
    with zipfile.ZipFile("made.fmu") as archive:
        assert archive.read("resources/line.toml") == Path(path).read_bytes()
    journey = Journey(60.0, 200.0, 320.0, step=2e-3)
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu(Path("made.fmu")) as made, Fmu() as pantograph:
        line = line_of(path, catenary)
        systems = (line.catenary, line.parameters), (made, {})
        one, other = (run_line(System(fmu, pantograph, given, [{}], journey)) for fmu, given in systems)
    np.testing.assert_array_equal(one.contact_force, other.contact_force)
    assert one.support_position.tolist() == [65, 130, 195, 255, 315, 370, 430, 495, 560]
    told = simulate_fmu(
        "made.fmu", stop_time=0.1, start_values={"point.position[1]": 460.0}, output=["point.height[1]"]
    )
    assert told["point.height[1]"][-1] == pytest.approx(-0.0375, abs=2e-3)


@pytest.mark.parametrize("options", [["--plain"], ["--flat"]])
def test_exports_and_archives_take_a_line_file(zspring, options):
    zspring("export", "folder", *options, "--line", str(LINES / "stitched-synthetic.toml"))
    with Fmu(installed_fmu(CATENARY)) as plain, Fmu(Path("folder", "Catenary.fmu")) as made:
        assert made.line is not None and made.line.boundaries[-1] == 625
        length = "line_length" if "--flat" in options else "line.length"
        with made.instances() as (instance,), plain.instances() as (other,):
            instance.start({})
            other.start({})
            assert (instance.get([length]), other.get(["line.length"])) == ([625.0], [600.0])


def test_a_parameter_of_the_spans_and_a_line_file_exclude_each_other(zspring):
    path = str(LINES / "benchmark-2015.toml")
    for given in "line.span=60", "dropper.stiffness=2e5":
        error = zspring("couple", "--line", path, "--set-line", given, status=1)
        assert error == f"zspring: {given.partition('=')[0]}: the line's table stands for it: change the line file\n"
