"""The command `zspring`, started as a user starts it."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from commands import PNG, head, in_process, receptances, start, table, zspring
from harness import bench_point
from linear import PUBLISHED, LinearPantograph
from zspring.cli import main
from zspring.errors import ZSpringError
from zspring.options import Pantograph, opened

SMALL = ["--amplitudes", "0.5,4", "--frequencies", "3,6.5:12.5:3", "--jobs", "1"]


def test_frf_writes_the_receptance_that_the_fmu_has(pantograph, tmp_path):
    """But for where on the sine the internal steps happen to lie, which stick and slip feel."""
    out, _ = zspring(tmp_path, "frf", *SMALL, "--tolerance", "1e-7", "--max-periods", "2000", "--output", "out")
    found = receptances(tmp_path / "out/frf.csv")
    assert sorted(found) == [(a, f) for a in (0.5, 4.0) for f in (3.0, 6.5, 9.5, 12.5)]
    for (amplitude, frequency), value in found.items():
        p = pantograph({"drive": "Bench", "solver.step": 5e-4})
        assert value == pytest.approx(bench_point(p, frequency, amplitude, settled=1e-8), rel=5e-3)
    assert (tmp_path / "out/frf.png").read_bytes().startswith(PNG)
    assert "resonances" in out and "points in" in out and "0.5" in out


def test_both_directions_are_those_of_two_runs(tmp_path):
    """Points, extremes and heads; the table says of which direction a row is."""
    runs = {}
    for direction in ("up", "down", "both"):
        arguments = ["--amplitudes", "2", "--frequencies", "4:7:0.5", "--set", "solver.step=0.002"]
        out, _ = zspring(tmp_path, "frf", *arguments, "--direction", direction, "--output", direction)
        runs[direction] = table(tmp_path / direction / "resonances.csv")
    assert "up and down differ by at most" in out
    for direction in ("up", "down"):
        for part in ("", "-refined"):
            alone = receptances(tmp_path / direction / f"frf{part}.csv")
            assert alone and alone == receptances(tmp_path / f"both/frf-{direction}{part}.csv")
        assert f"# direction: {direction}" in head(tmp_path / f"both/frf-{direction}.csv")
        rows = [row for row in runs[direction] if row["direction"]]
        assert rows and rows == [row for row in runs["both"] if row["direction"] == direction]


def test_the_head_of_the_file_has_every_parameter_with_its_unit(fmu, tmp_path):
    zspring(tmp_path, "frf", "--amplitudes", "1", "--frequencies", "5", "--set", "zspring.Mf=0.2", "--output", "out")
    text = "\n".join(head(tmp_path / "out/frf.csv"))
    for name in fmu.names("parameter"):
        if name.startswith("bench.") or name == "drive":
            continue
        assert f"# {name}: " in text, name
    assert "# zspring.Mf: 0.2 N.m" in text and "# solver.step: 0.0005 s" in text
    (synthetic,) = (line.split()[2:] for line in text.splitlines() if line.startswith("# synthetic:"))
    described = {name for name in fmu.names("parameter") if "(synthetic)" in fmu.variables[name].description}
    assert set(synthetic) == described - {"zspring.Mf"} and "zspring.k" in synthetic  # a value of one's own is not


def test_commands_run_at_half_a_millisecond_unless_told_otherwise(tmp_path):
    """What a set says goes before it, and --set before that; none for what sets the step itself."""
    own = tmp_path / "own.ssv"
    own.write_text(
        '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" '
        'name="own"><ssv:Parameters><ssv:Parameter name="solver.step"><ssv:Real value="0.001" unit="s"/>'
        '</ssv:Parameter><ssv:Parameter name="m2"><ssv:Real value="6"/></ssv:Parameter>'
        "</ssv:Parameters></ssv:ParameterSet>"
    )
    for parameter_set, assignments, step in (
        (None, [], 5e-4),
        ("dsa-250", ["m1=7"], 5e-4),
        (str(own), [], 1e-3),
        (str(own), ["solver.step=0.004"], 4e-3),
    ):
        with Pantograph(None, parameter_set, assignments).opened() as (_, parameters):
            assert parameters["solver.step"] == step
    with Pantograph(None, str(own), []).opened(("solver.step",)) as (_, parameters):
        assert parameters == {"m2": 6.0}


def test_a_coulomb_point_settles_where_2_ms_have_a_cycle_of_their_own(tmp_path):
    """At 5 Hz and 1 m/s2 the steps of 2 ms keep H from its limit for good; at the commands' step it has one."""
    point = ["frf", "--set", "friction=Coulomb", "--amplitudes", "1", "--frequencies", "5"]
    zspring(tmp_path, *point, "--output", "out")
    (row,) = table(tmp_path / "out/frf.csv")
    zspring(tmp_path, *point, "--set", "solver.step=1e-4", "--output", "fine")
    assert row["status"] == "settled"
    (fine,) = receptances(tmp_path / "fine/frf.csv").values()
    (found,) = receptances(tmp_path / "out/frf.csv").values()
    assert found == pytest.approx(fine, rel=3e-3)


def test_an_interrupted_measurement_continues_to_the_same_file(tmp_path):
    arguments = ["frf", "--amplitudes", "1,2", "--frequencies", "4:12:0.5", "--set", "solver.step=5e-5", "--jobs", "2"]
    process = start(tmp_path, *arguments, "--output", "broken")
    partial = tmp_path / "broken/frf.partial.csv"
    deadline = time.monotonic() + 60
    while not (partial.exists() and len(table(partial)) >= 5):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in err
    kept = len(table(partial))
    assert 5 <= kept < 34
    out, _ = zspring(tmp_path, *arguments, "--output", "broken")
    assert f"{kept} of 34" in out
    assert not partial.exists()
    zspring(tmp_path, *arguments, "--output", "whole")
    assert table(tmp_path / "broken/frf.csv") == table(tmp_path / "whole/frf.csv")


def test_both_benches_agree(tmp_path):
    """The inner bench knows the head's acceleration, the outer one samples positions: equal to order h^2."""
    settings = [*SMALL, "--tolerance", "1e-5", "--set", "solver.step=5e-4"]
    for way in ("bench", "inputs"):
        zspring(tmp_path, "frf", *settings, "--through", way, "--output", way)
    inside, outside = (receptances(tmp_path / way / "frf.csv") for way in ("bench", "inputs"))
    assert inside.keys() == outside.keys()
    for key in inside:
        assert outside[key] == pytest.approx(inside[key], rel=5e-3), key


def test_sweeps_up_down_and_from_rest_agree_where_the_steady_state_is_unique(tmp_path):
    found = []
    for direction in ("up", "down", "rest"):
        zspring(
            tmp_path,
            "frf",
            *SMALL,
            "--tolerance",
            "1e-6",
            "--max-periods",
            "2000",
            "--direction",
            direction,
            "--set",
            "friction=Free",
            "--output",
            direction,
        )
        found.append(receptances(tmp_path / direction / "frf.csv"))
    for key, value in found[0].items():
        assert found[1][key] == pytest.approx(value, rel=1e-3)
        assert found[2][key] == pytest.approx(value, rel=1e-3)


def test_parallel_sweeps_give_the_same_file(tmp_path):
    for jobs in ("1", "3"):
        zspring(tmp_path, "frf", "--amplitudes", "0.5,1,4", "--frequencies", "3:9:2", "--jobs", jobs, "--output", jobs)
    assert table(tmp_path / "1/frf.csv") == table(tmp_path / "3/frf.csv")


def test_points_beyond_the_stroke_are_left_out_and_marked(tmp_path):
    out, _ = zspring(tmp_path, "frf", "--amplitudes", "8", "--frequencies", "0.5,1,2,3", "--output", "out")
    status = {float(row["frequency [Hz]"]): row["status"] for row in table(tmp_path / "out/frf.csv")}
    # 8 m/s2 needs 0.2 m at 1 Hz and 0.05 m at 2 Hz.
    assert [status[f] == "left out" for f in (0.5, 1.0, 2.0, 3.0)] == [True, True, False, False]
    assert "2 left out" in out


@pytest.mark.parametrize("through", ["bench", "inputs"])
def test_a_point_that_fails_has_no_numbers(tmp_path, through):
    """Neither its own nor those of the point before: only the smallest amplitude can be solved."""
    settings = ["solver.tangent=Exact", "solver.max_iterations=1", "solver.tolerance=1e-13"]
    hopeless = [word for setting in settings for word in ("--set", setting)]
    points = ["--amplitudes", "0.05,4", "--frequencies", "4,8", "--jobs", "1", "--through", through]
    _, err = zspring(tmp_path, "frf", *points, *hopeless, "--error-estimate", "--output", "out", status=1)
    assert "2 of 4 points could not be solved" in err
    *good, first, second = table(tmp_path / "out/frf.csv")
    assert all(row["status"] == "settled" and row["H_re [m/N]"] for row in good)
    for row in first, second:
        assert row["status"].startswith("failed: ") and row["periods"] == "0"
        for name in ("H_re [m/N]", "H_im [m/N]", "magnitude [m/N]", "change", "error_estimate"):
            assert row[name] == "", name
    assert (tmp_path / "out/frf.png").read_bytes().startswith(PNG)


def test_dynamic_stiffness_is_the_inverse_of_receptance(tmp_path):
    zspring(tmp_path, "frf", *SMALL, "--quantity", "stiffness", "--output", "out")
    for row in table(tmp_path / "out/frf.csv"):
        receptance = complex(float(row["H_re [m/N]"]), float(row["H_im [m/N]"]))
        assert float(row["magnitude [N/m]"]) == pytest.approx(1 / abs(receptance))


def test_the_error_estimate_covers_the_error(tmp_path):
    arguments = ["--amplitudes", "2", "--frequencies", "3,6.5", "--tolerance", "1e-7", "--max-periods", "2000"]
    out, _ = zspring(tmp_path, "frf", *arguments, "--error-estimate", "--output", "out")
    assert "error estimate" in out
    zspring(tmp_path, "frf", *arguments, "--set", "solver.step=1e-4", "--output", "fine")
    fine = receptances(tmp_path / "fine/frf.csv")
    for row in table(tmp_path / "out/frf.csv"):
        key = float(row["amplitude [m/s2]"]), float(row["frequency [Hz]"])
        value = complex(float(row["H_re [m/N]"]), float(row["H_im [m/N]"]))
        assert abs(value / fine[key] - 1) == pytest.approx(float(row["error_estimate"]), rel=0.5)


def test_simulate_moves_the_wire_by_a_file(fmu, tmp_path):
    (tmp_path / "wire.csv").write_text("time [s],wire_height [mm]\n0,0\n0.5,10\n1,10\n2,-5\n")
    zspring(
        tmp_path, "simulate", "--drive", "Wire", "--input", "wire.csv", "--set", "friction=Coulomb", "--output", "out"
    )
    rows = table(tmp_path / "out/simulation.csv")
    assert float(rows[0]["time [s]"]) == 0 and float(rows[-1]["time [s]"]) == 2
    for name in fmu.names("output"):
        unit = fmu.variables[name].unit
        assert (f"{name} [{unit}]" if unit else name) in rows[0]
    assert float(rows[-1]["head.z [m]"]) == pytest.approx(-0.005, abs=2e-3)
    assert min(float(row["contact.force [N]"]) for row in rows) >= 0
    assert (tmp_path / "out/simulation.png").read_bytes().startswith(PNG)


def test_simulate_tells_which_inputs_the_drive_does_not_use(tmp_path):
    (tmp_path / "wire.csv").write_text("time [s],wire_height [mm],uplift.head [N]\n0,0,0\n0.1,1,0\n")
    for drive, told in ("Force", True), ("Wire", False):
        _, err = zspring(tmp_path, "simulate", "--drive", drive, "--input", "wire.csv", "--output", drive)
        assert ("wire_height: has no effect with drive Force; see --drive" in err) is told
        assert "uplift.head" not in err


def test_simulate_gives_what_the_fmu_gives(pantograph, tmp_path):
    (tmp_path / "force.csv").write_text("time [s],contact_force [N]\n0,120\n0.1,130\n0.2,110\n")
    zspring(tmp_path, "simulate", "--input", "force.csv", "--step", "0.01", "--output", "out")
    p = pantograph({"solver.step": 5e-4})
    expected = []
    for n in range(20):
        t = 0.01 * n
        p["contact_force"] = float(np.interp(t, [0, 0.1, 0.2], [120, 130, 110]))
        p.set_derivatives("contact_force", 100.0 if n < 10 else -200.0)
        p.step(0.01)
        expected.append(p["head.z"])
    found = [float(row["head.z [m]"]) for row in table(tmp_path / "out/simulation.csv")[1:]]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize(
    "stop, step, steps", [("0.07", "0.01", 7), ("0.3", "0.1", 3), ("0.075", "0.01", 8), ("0.004", "0.01", 1)]
)
def test_simulate_ends_at_the_stop_with_no_step_of_no_length(tmp_path, stop, step, steps):
    """0.07 / 0.01 is a little more than 7 in binary numbers; only what is no multiple gets a shorter last step."""
    out, _ = zspring(tmp_path, "simulate", "--stop", stop, "--step", step, "--output", "out")
    times = [float(row["time [s]"]) for row in table(tmp_path / "out/simulation.csv")]
    assert times == pytest.approx([*(float(step) * n for n in range(steps)), float(stop)], abs=1e-12)
    assert out.startswith(f"{steps} communication steps from 0 s to {stop} s\n")


def test_simulate_without_inputs_runs_the_experiment_of_the_fmu(fmu, tmp_path):
    experiment = fmu.description.defaultExperiment
    zspring(tmp_path, "simulate", "--output", "out")
    times = [float(row["time [s]"]) for row in table(tmp_path / "out/simulation.csv")]
    assert times[-1] == float(experiment.stopTime)
    assert np.diff(times) == pytest.approx(float(experiment.stepSize))


def test_inputs_may_begin_late_in_milliseconds_and_end_before_the_stop(tmp_path):
    (tmp_path / "force.csv").write_text("contact_force [N],time [ms]\n120,500\n130,600\n")
    zspring(tmp_path, "simulate", "--input", "force.csv", "--step", "0.05", "--output", "out")
    times = [float(row["time [s]"]) for row in table(tmp_path / "out/simulation.csv")]
    assert times == pytest.approx([0.5, 0.55, 0.6])
    _, err = zspring(tmp_path, "simulate", "--input", "force.csv", "--stop", "0.7", status=1)
    assert "--stop 0.7 s: the input file ends at 0.6 s" in err


def test_cubic_inputs_follow_a_cubic_exactly(tmp_path):
    """Between rows 0.1 s apart of a head displacement t^2 (1 - t) / 10; linear ones would cut the corners."""
    rows = [f"{t:.1f},{t * t * (1 - t) / 10:.9f}" for t in np.arange(11) / 10]
    (tmp_path / "z.csv").write_text("\n".join(["time [s],head_displacement [m]", *rows]) + "\n")
    for kind, error in (("cubic", 0.0), ("linear", 1e-4)):
        move = ["--drive", "Displacement", "--input", "z.csv", "--interpolation", kind, "--step", "0.05"]
        zspring(tmp_path, "simulate", *move, "--set", "solver.step=0.001", "--output", kind)
        t, z = np.array(
            [[float(row["time [s]"]), float(row["head.z [m]"])] for row in table(tmp_path / kind / "simulation.csv")]
        ).T
        largest = np.abs(z - t**2 * (1 - t) / 10).max()
        assert largest < 1e-9 if kind == "cubic" else error < largest < 1e-3


def test_the_phase_of_a_driving_point_is_written_between_its_bounds(tmp_path):
    """Of the linear three-mass model, damped so much that no phase is near the ends."""
    values = dict(PUBLISHED["DSA-380"]) | {"c1": 200.0, "c2": 200.0}
    linear = LinearPantograph(head=values.pop("k1"), **values)
    settings = ["--set", "suspension=Linear", "--set", "c1=200", "--set", "c2=200", "--set", "solver.step=2e-4"]
    points = ["--amplitudes", "1", "--frequencies", "2:14:1.5", "--tolerance", "1e-6", "--max-periods", "2000"]
    for quantity, unit, sign in (("receptance", "m/N", 1), ("stiffness", "N/m", -1)):
        zspring(tmp_path, "frf", *points, *settings, "--quantity", quantity, "--output", quantity)
        for row in table(tmp_path / quantity / "frf.csv"):
            f = float(row["frequency [Hz]"])
            value = linear.receptance(f) ** sign
            phase = np.degrees(np.arctan2(value.imag, value.real))
            assert 1 < -sign * phase < 179
            assert float(row["phase [deg]"]) == pytest.approx(phase, abs=0.1)
            assert float(row[f"magnitude [{unit}]"]) == pytest.approx(abs(value), rel=2e-3)
            assert float(row["displacement [m]"]) == pytest.approx(1 / (2 * np.pi * f) ** 2)


def test_warnings_of_the_fmu_are_told_when_the_command_fails(capsys):
    with pytest.raises(ZSpringError), opened(None) as fmu:
        fmu.warnings.append("the spring is slack")
        raise ZSpringError("no table")
    assert capsys.readouterr().err == "the FMU warns: the spring is slack\n"


def test_info_lists_every_variable_of_the_catenary(fmu_catenary, tmp_path):
    out, _ = zspring(tmp_path, "info", "--catenary")
    assert set(fmu_catenary.variables) <= {line.split()[0] for line in out.splitlines()}


def test_info_lists_every_variable(fmu, tmp_path):
    out, _ = zspring(tmp_path, "info")
    listed = [line.split()[0] for line in out.splitlines()]
    assert set(fmu.variables) <= set(listed)
    out, _ = zspring(tmp_path, "info", "zspring.Mf")
    assert "N.m" in out and "0.3" in out and "synthetic" in out
    out, _ = zspring(tmp_path, "info", "--path")
    assert Path(out.strip()) == fmu.path


@pytest.mark.parametrize("catenary", [False, True])
def test_info_tells_start_values_and_bounds_as_the_model_description_has_them(fmu, fmu_catenary, tmp_path, catenary):
    """Column by column, below the head line's words; read from the XML itself."""
    out, _ = zspring(tmp_path, "info", *(["--catenary"] if catenary else []))
    header, *lines = out.splitlines()
    names = ("name", "causality", "unit", "start", "allowed", "description")
    begins = [header.index(name) for name in names]
    rows = {}
    for line in lines:
        cells = [line[begin:end].strip() for begin, end in zip(begins, [*begins[1:], None])]
        rows[cells[0]] = dict(zip(names, cells))
    root = ElementTree.fromstring(
        zipfile.ZipFile((fmu_catenary if catenary else fmu).path).read("modelDescription.xml")
    )
    items = {t.get("name"): [i.get("name") for i in t.iter("Item")] for t in root.iter("SimpleType")}
    variables = root.findall("ModelVariables/ScalarVariable")
    assert list(rows) == [variable.get("name") for variable in variables]
    for variable in variables:
        row, kind = rows[variable.get("name")], variable[0]
        tunable = "tunable " if variable.get("variability") == "tunable" else ""
        assert row["causality"] == tunable + variable.get("causality", "local")
        assert row["unit"] == kind.get("unit", "") and row["description"] == variable.get("description", "")
        start, low, high = (kind.get(name) for name in ("start", "min", "max"))
        if kind.tag == "Enumeration":
            choices = items[kind.get("declaredType")]
            assert row["allowed"] == " | ".join(choices)
            assert row["start"] == (choices[int(start) - 1] if start else "")
            continue
        assert row["allowed"] == (f"{low or '-inf'} .. {high or 'inf'}" if low or high else "")
        if kind.tag == "Boolean":
            assert row["start"] == (start or "")
        else:
            assert (float(row["start"]) == float(start)) if start else not row["start"]


def test_info_takes_patterns_and_names_what_fits_none(tmp_path):
    """In the order of the model description, each once."""
    out, _ = zspring(tmp_path, "info", "zspring.L?", "zspring.L1", "gravity")
    assert [line.split()[0] for line in out.splitlines()[1:]] == ["zspring.L1", "zspring.L2", "gravity"]
    _, err = zspring(tmp_path, "info", "gravity", "zspring.M?", "zspring.K?", status=1)
    assert "no variable 'zspring.K?' in the FMU" in err


def test_a_name_that_is_no_text_is_refused(tmp_path):
    """A byte of Latin-1 where names are UTF-8: results could not name it."""
    status, _, err = in_process("linearize", "--output", tmp_path / "Pr\udcfcfstand")
    assert status == 1 and "is not in the encoding of this system's file names: rename it" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_names_that_the_terminal_cannot_show_are_no_failure(tmp_path, encoding):
    """Neither in results nor in a refusal; what there is no letter for is shown as its code."""
    name = "Łódź Prüfstand"
    shown = name.encode(encoding, "backslashreplace")
    for arguments, status, stream in (
        (["linearize", "--output", str(tmp_path / name)], 0, "stdout"),
        (["frf", "--parameters", name], 1, "stderr"),
    ):
        terminal = io.TextIOWrapper(io.BytesIO(), encoding)
        redirect = contextlib.redirect_stdout if stream == "stdout" else contextlib.redirect_stderr
        with redirect(terminal):
            assert main(arguments) == status
        terminal.flush()
        assert shown in terminal.buffer.getvalue()
    assert (tmp_path / name / "linear-free.npz").exists()


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["frf", "--set", "zspring.Mf=-1"], ["zspring.Mf", "-1"]),
        (["frf", "--set", "zspring.mf=0.1"], ["zspring.mf", "zspring.Mf"]),
        (["frf", "--set", "friction=Sticky"], ["friction", "Sticky", "Coulomb"]),
        (["frf", "--set", "m1"], ["m1", "="]),
        (["frf", "--set", "m1=heavy"], ["m1", "heavy"]),
        (["frf", "--set", "head.z=0"], ["head.z"]),
        (["frf", "--set", "drive=Force"], ["drive"]),
        (["frf", "--set", "zspring.d=0.1", "--set", "gravity=0", "--set", "static_force=0"], ["zspring", "tension"]),
        (["frf", "--set", "friction=Coulomb", "--set", "solver.tangent=Mean"], ["solver.tangent", "friction"]),
        (["frf", "--frequencies", "1:0:1"], ["frequencies", "1:0:1"]),
        (["frf", "--frequencies", "0"], ["frequencies", "0"]),
        (["frf", "--amplitudes", "x"], ["amplitudes", "x"]),
        (["frf", "--amplitudes", "nan"], ["amplitudes", "nan"]),
        (["frf", "--direction", "sideways"], ["direction", "up", "down"]),
        (["frf", "--max-periods", "3"], ["max-periods", "3"]),
        (["frf", "--fmu", "absent.fmu"], ["absent.fmu"]),
        (["simulate", "--drive", "Rope"], ["drive", "Rope", "Wire"]),
        (["simulate", "--input", "absent.csv"], ["absent.csv"]),
        (["simulate", "--step", "0"], ["0"]),
        (["simulate", "--stop", "-1"], ["-1"]),
        (["simulate", "--step", "inf"], ["--step", "inf", "finite"]),
        (["simulate", "--step", "nan"], ["--step", "nan", "finite"]),
        (["simulate", "--stop", "inf"], ["--stop", "inf", "finite"]),
        (["info", "zspring.x"], ["zspring.x"]),
        (["info", "--catenary", "--fmu", "some.fmu"], ["some.fmu", "--catenary"]),
        (["fly"], ["fly"]),
    ],
)
def test_bad_options_get_one_clear_line(tmp_path, arguments, named):
    _, err = zspring(tmp_path, *arguments, status=1)
    assert len(err.strip().splitlines()) == 1 and err.startswith("zspring: ")
    assert all(word in err for word in named), err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "text, named",
    [
        ("time [s],wire_heigth [m]\n0,0\n1,0\n", ["wire_heigth", "wire_height"]),
        ("time [s],wire_height [kg]\n0,0\n1,0\n", ["wire_height", "kg"]),
        ("time [s],wire_height [m]\n0,0\n1,high\n", ["line 3", "wire_height", "high"]),
        ("time [s],wire_height [m]\n0,0\n1,nan\n", ["line 3", "wire_height", "nan"]),
        ("time [s],wire_height [m]\n0,0\n1,0\n1,0\n", ["line 4", "time"]),
        ("time [s],wire_height [m]\n0,0\n1\n", ["line 3"]),
        ("wire_height [m]\n0\n1\n", ["time"]),
        ("time [s],m1 [kg]\n0,7\n1,7\n", ["m1", "contact_force"]),
        ("", ["bad.csv"]),
    ],
)
def test_bad_input_files_get_one_clear_line(tmp_path, text, named):
    (tmp_path / "bad.csv").write_text(text)
    _, err = zspring(tmp_path, "simulate", "--drive", "Wire", "--input", "bad.csv", status=1)
    assert len(err.strip().splitlines()) == 1 and err.startswith("zspring: ")
    assert all(word in err for word in named), err


def test_names_that_the_output_cannot_hold_do_not_stop_a_command(tmp_path):
    """A pipe or file on Windows takes the characters of its code page only."""
    command = [sys.executable, "-m", "zspring", "info", "--sets", "dsa-380", "--write", "Łódź.ssv"]
    variables = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    done = subprocess.run(command, cwd=tmp_path, env=variables, capture_output=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.decode("cp1252").split() == ["written:", r"\u0141\xf3d\u017a.ssv".replace(r"\xf3", "ó")]
    assert (tmp_path / "Łódź.ssv").is_file()
