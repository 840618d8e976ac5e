"""Slow loading of the head suspension against the closed form of a bilinear hysteresis.

Rods that slip turn by cos(theta)^2 / d for each metre of compression, so that by virtual work two joints
with the moment Mf resist with F = 2 Mf cos(theta)^2 / d. Stuck rods give k_locked, slipping ones k_free; slip
begins at x = F / (k_locked - k_free). For small motions that is Masing's bilinear loop: beyond x the secant
stiffness is k_free + F / X and a cycle costs 4 F (X - x).
"""

from __future__ import annotations

import signal

import numpy as np
import pytest
from matplotlib.axes import Axes

from commands import PNG, head, table, zspring
from zspring.bench.loops import POINTS, Loop, measure_loop
from zspring.fmu import Fmu
from zspring.interrupt import Interrupted
from zspring.static import run as static_run
from zspring.static.plot import LAW_STYLES, static_figure


@pytest.fixture(scope="module")
def slow():
    """The measuring function, and the parameters of the FMU with F and x of the closed form."""
    with Fmu() as fmu, fmu.instances() as (instance,):
        p = fmu.used_parameters({})
        ratio = np.cos(p["zspring.theta"]) ** 2 / p["zspring.d"]
        p["turn"], p["F"] = ratio, 2 * p["zspring.Mf"] * ratio
        p["x"] = p["F"] / (p["zspring.k_locked"] - p["zspring.k_free"])
        yield lambda law, rate, amplitude: measure_loop(instance, {}, law, rate, amplitude), p


@pytest.mark.parametrize("part", [0.1, 0.5, 0.95])
def test_below_the_onset_of_slip_the_suspension_is_that_with_locked_rods(slow, part):
    """Without loss. The geometry's curvature changes a secant from peak to peak with the square of X / d."""
    measure, p = slow
    loop = measure("Coulomb", 1e-4, part * p["x"])
    assert loop.stiffness == pytest.approx(p["zspring.k_locked"], rel=1e-4)
    assert abs(loop.area) < 1e-12 and loop.dissipated < 1e-12


@pytest.mark.parametrize("amplitude", [1e-3, 2e-3, 5e-3])
def test_beyond_it_stiffness_and_loss_are_those_of_the_bilinear_loop(slow, amplitude):
    """To first order in the amplitude over d, 3 % at most, of the friction's part."""
    measure, p = slow
    loop = measure("Coulomb", 1e-4, amplitude)
    friction_part = loop.stiffness - p["zspring.k_free"]
    assert friction_part == pytest.approx(p["F"] / amplitude, rel=amplitude / p["zspring.d"])
    assert loop.dissipated == pytest.approx(4 * p["F"] * (amplitude - p["x"]), rel=amplitude / p["zspring.d"])


def test_the_large_amplitude_static_stiffness_is_about_half_the_small_amplitude_one(slow):
    """F / X is left of the friction at X = 20 mm, 3 % of k_free."""
    measure, _p = slow
    small, large = (measure("Coulomb", 1e-3, amplitude).stiffness for amplitude in (1e-4, 2e-2))
    assert 0.5 <= large / small < 0.5 * 1.04


@pytest.mark.parametrize("rate", [1e-5, 3e-5, 1e-4, 3e-4])
def test_the_regularised_law_resists_a_slow_motion_by_tanh_of_its_rate(slow, rate):
    """A rod turns at the rate times cos(theta)^2 / d, and the joint resists with Mf tanh(tau w)."""
    measure, p = slow
    amplitude = 5e-3
    friction = p["F"] * np.tanh(p["zspring.tau"] * p["turn"] * rate)
    part = measure("Regularized", rate, amplitude).stiffness - p["zspring.k_free"]
    assert part == pytest.approx(friction / amplitude, rel=amplitude / p["zspring.d"])


def test_the_stiffness_depends_on_the_rate_with_the_regularised_law_only(slow):
    measure, p = slow
    stiffness = {
        law: np.array([measure(law, rate, 0.9 * p["x"]).stiffness for rate in (1e-5, 1e-4, 1e-3)])
        for law in ("Regularized", "Coulomb")
    }
    assert np.ptp(stiffness["Coulomb"]) < 1e-4 * p["zspring.k_locked"]
    slowest, _, fastest = stiffness["Regularized"]
    assert np.all(np.diff(stiffness["Regularized"]) > 0)
    assert slowest < 1.1 * p["zspring.k_free"] and fastest > 0.95 * p["zspring.k_locked"]


@pytest.mark.parametrize("law", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("amplitude", [1e-3, 2e-2])
def test_the_area_of_the_loop_is_what_the_fmu_counts_as_dissipated(slow, law, amplitude):
    measure, _ = slow
    loop = measure(law, 3e-4, amplitude)
    assert loop.area == pytest.approx(loop.dissipated, rel=5e-3)


def test_the_command_writes_its_files_and_says_where_friction_ends(tmp_path):
    arguments = ["static", "--amplitudes", "0.2,2", "--rates", "0.1,1", "--output", "out"]
    out, _ = zspring(tmp_path, *arguments)
    rows = table(tmp_path / "out/stiffness.csv")
    assert len(rows) == 8
    assert "Coulomb, 1 mm/s" in out and "largest change with the rate" in out
    listed = {line[2:].partition(":")[0] for line in head(tmp_path / "out/stiffness.csv")}
    assert {"m1", "zspring.Mf", "clamped frame"} <= listed
    assert not {"drive", "friction", "k2", "k3", "solver.step"} & listed  # which each loop has its own of
    loops = table(tmp_path / "out/loops.csv")
    for row in rows:
        own = [r for r in loops if all(r[key] == row[key] for key in ("friction", "rate [m/s]", "amplitude [m]"))]
        compression, force = np.array([[float(r["compression [m]"]), float(r["force [N]"])] for r in own]).T
        secant = np.ptp(force) / np.ptp(compression)
        assert secant == pytest.approx(float(row["stiffness [N/m]"]), rel=0.01)
    assert (tmp_path / "out/static.png").read_bytes().startswith(PNG)


def test_every_amplitude_asked_for_is_drawn():
    """At every rate and with both laws, in a panel that names it."""
    x, amplitudes = np.cos(np.linspace(0, 2 * np.pi, POINTS + 1)), (5e-5, 2e-3, 7e-3, 2e-2)
    loops = [
        Loop(law, rate, a, a * x, 1e4 * a * x, 0.0) for law in LAW_STYLES for rate in (1e-4, 1e-3) for a in amplitudes
    ]
    figure = static_figure(loops, {"zspring.k_locked": 9e3, "zspring.k_free": 5e3}, "title")
    panels = {axes.get_title(): axes.lines for axes in figure.findobj(Axes)}
    for a in amplitudes:
        drawn = panels[f"{1e3 * a:g} mm"]
        assert len(drawn) == 4 and all(max(line.get_xdata()) == pytest.approx(1e3 * a) for line in drawn)
    assert set(panels) == {"equivalent stiffness", *(f"{1e3 * a:g} mm" for a in amplitudes)}


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["--amplitudes", "0"], ["'0'", "positive"]),
        (["--set", "friction=Coulomb"], ["friction", "sets"]),
        (["--set", "suspension=Linear"], ["suspension", "ZSpring"]),
        (["--rates", "1e12"], ["solver.step"]),
        (["--set", "zspring.L1=-1"], ["zspring.L1", "-1"]),
    ],
)
def test_bad_settings_get_one_clear_line(tmp_path, arguments, named):
    _, err = zspring(tmp_path, "static", *arguments, status=1)
    lines = [line for line in err.splitlines() if line.startswith("zspring: ")]
    assert len(lines) == 1 and all(word in lines[0] for word in named), err


def test_an_interrupted_run_keeps_its_loops(tmp_path, monkeypatch):
    """Ctrl-C while the second of eight loops is measured."""

    def measure(instance, parameters, law, rate, amplitude):
        if amplitude == 2e-3:
            signal.raise_signal(signal.SIGINT)
        return measure_loop(instance, parameters, law, rate, amplitude)

    monkeypatch.setattr(static_run, "measure_loop", measure)
    with Fmu() as fmu, pytest.raises(Interrupted, match="2 of 8 loops"):
        static_run.run_static(fmu, {}, [1e-3, 2e-3, 3e-3, 4e-3], [1e-3], tmp_path, "png")
    assert [row["amplitude [m]"] for row in table(tmp_path / "stiffness.csv")] == ["0.001", "0.002"]
