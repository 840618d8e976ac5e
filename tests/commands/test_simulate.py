"""`zspring simulate`: times of any size, runs that are none, the estimate of the step's error, and what is drawn."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from commands import head, table, zspring
from zspring.figures import save
from zspring.fmu import Fmu
from zspring.simulate import estimate
from zspring.simulate.inputs import read_inputs
from zspring.simulate.plot import simulation_figure

EPOCH = 1_700_000_000
HEIGHTS = 0.01 * np.sin(2 * np.pi * 2 * np.arange(51) * 0.002) ** 3


def write_wire(path: Path, times: list[str], heights: np.ndarray = HEIGHTS) -> Path:
    rows = [f"{time},{height!r}" for time, height in zip(times, heights.tolist())]
    path.write_text("\n".join(["time [s],wire_height [m]", *rows]) + "\n")
    return path


def test_seconds_since_1970_give_the_same_bits(tmp_path):
    """Written to the last digit, or as a double holds them, known to 0.24 us; times are written as the input's."""
    exact = [Decimal(i) * Decimal("0.002") for i in range(51)]
    write_wire(tmp_path / "zero.csv", [str(time) for time in exact])
    write_wire(tmp_path / "exact.csv", [str(EPOCH + time) for time in exact])
    write_wire(tmp_path / "rounded.csv", [f"{EPOCH + float(time):.17g}" for time in exact])
    rows = {}
    for name in ("zero", "exact", "rounded"):
        run = ["simulate", "--drive", "Wire", "--input", f"{name}.csv", "--output", name]
        out, _ = zspring(tmp_path, *run)
        rows[name] = table(tmp_path / name / "simulation.csv")
        assert (f"time is 0 at {EPOCH} s of the input" in out) is (name != "zero")
        assert ("taken as even" in out) is (name == "rounded")
    times = {name: [Decimal(row.pop("time [s]")) for row in rows[name]] for name in rows}
    assert times["exact"] == times["rounded"] == [EPOCH + time for time in times["zero"]] == [EPOCH + x for x in exact]
    assert rows["zero"] == rows["exact"] == rows["rounded"]


def test_times_that_are_not_even_stay_as_they_are_written(tmp_path):
    with Fmu() as fmu:
        for times in (["0", "0.1", "0.25"], ["1700000000", "1700000000.1", "1700000000.25"], ["5,0", "5,1", "5,25"]):
            text = "\n".join(["time [s];wire_height [m]", *(f"{time};0" for time in times)])
            (tmp_path / "uneven.csv").write_text(text)
            read = read_inputs(tmp_path / "uneven.csv", fmu.variables)
            assert read.time.tolist() == [0.0, 0.1, 0.25] and read.rounding == 0


@pytest.mark.parametrize(
    "options, named",
    [
        (["--stop", "1e12"], ["5e+14 communication steps", "at most 1e+07"]),
        (["--stop", "1e300"], ["communication steps", "at most 1e+07"]),
        (["--step", "1e-300"], ["communication steps", "at most 1e+07"]),
        (["--stop", "nan"], ["nan", "finite"]),
        (["--stop", "1e12", "--step", "1e11"], ["1e9 internal steps"]),
        (["--input", "wire.csv", "--stop", "1700000009.25"], ["1700000009.25 s", "ends at 1700000000.1 s"]),
        (["--input", "wire.csv", "--stop", "0.05"], ["from 1700000000 s to 0.05 s"]),
    ],
)
def test_what_is_no_run_gets_one_line(tmp_path, options, named):
    write_wire(tmp_path / "wire.csv", [f"1700000000.{i:03d}" for i in range(0, 101, 2)])
    _, err = zspring(tmp_path, "simulate", *options, "--output", "out", status=1)
    assert len(err.strip().splitlines()) == 1 and err.startswith("zspring: ")
    assert all(word in err for word in named), err


def test_the_error_estimate_is_that_of_a_run_at_a_sixteenth_of_the_step(tmp_path):
    """Smooth friction, so that the method is of second order; communication steps of one internal step each."""
    write_wire(tmp_path / "wire.csv", [repr(i * 0.002) for i in range(51)])
    run = ["simulate", "--drive", "Wire", "--input", "wire.csv", "--set", "zspring.tau=3"]
    out, err = zspring(tmp_path, *run, "--set", "solver.step=0.004", "--error-estimate", "--output", "out")
    zspring(tmp_path, *run, "--set", "solver.step=0.000125", "--output", "fine")
    coarse, fine = (table(tmp_path / name / "simulation.csv") for name in ("out", "fine"))
    found = {row["output"]: row for row in table(tmp_path / "out/errors.csv")}
    assert "# half the internal step: 0.001 s" in head(tmp_path / "out/errors.csv")
    for name, unit in ("contact.force", "N"), ("head.z", "m"), ("zspring.alpha", "rad"):
        values = np.array([[float(row[f"{name} [{unit}]"]) for row in rows] for rows in (coarse, fine)])
        error, row = np.abs(values[0] - values[1]), found[name]
        assert float(row["rms"]) == pytest.approx(np.sqrt(np.mean(error**2)), rel=0.1)
        assert float(row["largest"]) == pytest.approx(error.max(), rel=0.15)
        assert float(row["range"]) == pytest.approx(np.ptp(values[0]))
        assert name in out
    assert "exceeds" not in err


def test_an_error_beyond_the_limit_is_warned_of_in_one_line(tmp_path):
    """Steps of 20 ms have no part of a head that rings at 6 Hz."""
    write_wire(tmp_path / "wire.csv", [repr(i * 0.002) for i in range(51)])
    run = ["--drive", "Wire", "--input", "wire.csv", "--set", "solver.step=0.02", "--step", "0.02"]
    _, err = zspring(tmp_path, "simulate", *run, "--error-estimate", "--output", "out")
    (line,) = [line for line in err.splitlines() if "exceeds 1 % of the range" in line]
    assert "contact.force" in line
    point = ["frf", "--amplitudes", "1", "--frequencies", "12,14", "--set", "solver.step=0.004", "--error-estimate"]
    _, err = zspring(tmp_path, *point, "--output", "frf")
    (line,) = [line for line in err.splitlines() if "exceeds 1 %" in line]
    assert "at 2 of 2 points" in line


@pytest.mark.parametrize("solver, step", [(5e-4, 1e-3), (5e-4, 3e-4), (2e-3, 5e-3), (1e-3, 1e-3)])
def test_half_the_internal_step_is_half_of_what_the_fmu_takes(pantograph, solver, step):
    p, finer = (pantograph({"solver.step": s}) for s in (solver, estimate.half_step(solver, step)))
    for run in (p, finer):
        run.step(step)
    assert finer["solver.steps"] == 2 * p["solver.steps"]


def test_the_wire_is_drawn_axes_begin_at_the_data_and_angles_have_no_offset(tmp_path):
    """Rods that stick near 30 degrees, which matplotlib would tell as a number beside the axis."""
    time = np.linspace(3.0, 4.0, 50)
    names = ("head.z", "upper_frame.z", "lower_frame.z", "contact.force", "zspring.moment_alpha", "zspring.moment_beta")
    columns = {"time": time, **{name: np.sin(time) for name in names}}
    columns |= {name: 0.5 + 1e-9 * np.sin(9 * time) for name in ("zspring.alpha", "zspring.beta")}
    for wire in (None, np.cos(time)):
        figure = simulation_figure(columns | ({} if wire is None else {"wire_height": wire}), 0.3, "what was run")
        save(figure, tmp_path / "figure.png")
        first, *_ = figure.axes
        drawn = {line.get_label(): line.get_ydata() for line in first.get_lines()}
        assert ("wire" in drawn) is (wire is not None)
        if wire is not None:
            np.testing.assert_allclose(drawn["wire"], 1e3 * wire)
        for axes in figure.axes:
            assert axes.get_xlim() == (3.0, 4.0) and axes.yaxis.get_offset_text().get_text() == ""
