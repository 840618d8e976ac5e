"""Identification: parameters come back from synthetic measurements, with an honest uncertainty."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssv

from commands import receptances, start, table, zspring
from linear import PUBLISHED, LinearPantograph, ZSpringLinear
from zspring.bench.curves import Curve
from zspring.bench.model import BenchModel
from zspring.bench.static_test import StaticTest
from zspring.fmu import Fmu
from zspring.identify import run, stages
from zspring.identify.fit import fit
from zspring.identify.problem import Problem, ThreeMassModel, ZSpringModel
from zspring.identify.report import doubts
from zspring.identify.search import search
from zspring.identify.settings import Free, Search, Settings, read_settings
from zspring.interrupt import Interrupted
from zspring.parameter_sets import describe_set, read_set

AMPLITUDES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
NAMES = ("m1", "m2", "m3", "c1", "c2", "c3", "k1", "k2", "k3")
JOBS = 2
STEP = 0.002  # s, solver.step of the synthetic measurements


def noisy(values: np.ndarray, level: float, seed: int) -> np.ndarray:
    """With complex Gaussian noise of that relative standard deviation."""
    parts = np.random.default_rng(seed).standard_normal((2, *values.shape))
    return values * (1 + level * (parts[0] + 1j * parts[1]) / np.sqrt(2))


BENCH_FORCE = 110.0  # N, other than the pantograph's own 120 N


def write_measurement(
    path: Path,
    points: dict[tuple[float, float], complex],
    static_force: float = BENCH_FORCE,
    friction: str = "Regularized",
) -> None:
    lines = [f"# static_force: {static_force} N", f"# friction: {friction}"]
    lines += ["frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]"]
    lines += [f"{f},{a},{H.real},{H.imag}" for (a, f), H in sorted(points.items())]
    path.write_text("\n".join(lines) + "\n")


def linear_pantograph(name: str) -> tuple[dict[str, float], LinearPantograph]:
    values = dict(PUBLISHED[name])
    rest = {key: value for key, value in values.items() if key != "k1"}
    return values, LinearPantograph(head=values["k1"], **rest)


def linear_problem(
    free: dict[str, tuple[float, float, float]], truth: dict[str, float], frequency: np.ndarray, H: np.ndarray
) -> Problem:
    """Logarithmic error; start, minimum and maximum of the free parameters, the others as in `truth`."""
    settings = Settings.model_construct(  # unchecked, as the curves come from no file
        model="linear",
        free={name: Free(start=start, min=low, max=high) for name, (start, low, high) in free.items()},
        fixed={name: value for name, value in truth.items() if name not in free},
    )
    curves = [Curve("0.25 m/s2", frequency, np.full(frequency.shape, 0.25), H)]
    rods = {"zspring.J1": 0.0, "zspring.J2": 0.0}
    return Problem(settings, ThreeMassModel(curves, rods), curves)


def solve(problem: Problem):
    return fit(problem, problem.start, lambda cost: None)


@pytest.mark.parametrize("name", ["DSA-380", "DSA-250", "2015 benchmark"])
def test_all_nine_parameters_of_the_published_pantographs_come_back(tmp_path, name):
    """From exact data, through the command, from starts 50 % off; dampers that are 0 to 1e-4 N.s/m.

    In the same file a larger amplitude with other values, which the linear model must not look at.
    """
    values, linear = linear_pantograph(name)
    frequency = np.arange(0.5, 20.01, 0.25)
    points = {(0.25, float(f)): linear.receptance(f) for f in frequency}
    write_measurement(tmp_path / "bench.csv", points | {(2.0, f): 2 * H for (_, f), H in points.items()})
    bounds = {"m": (1.0, 20.0), "c": (0.0, 300.0), "k": (0.0, 40000.0)}
    free = [
        f"{key} = {{ start = {1.5 * value or 10.0}, min = {bounds[key[0]][0]}, max = {bounds[key[0]][1]} }}"
        for key, value in values.items()
    ]
    text = 'model = "linear"\n[[measurement]]\nfile = "bench.csv"\n[free]\n'
    (tmp_path / "fit.toml").write_text(text + "\n".join(free))
    zspring(tmp_path, "identify", "fit.toml", "--output", "out")
    with Fmu() as model:
        found = read_set(tmp_path / "out/fitted.ssv", model)
    for key, value in values.items():
        assert found[key] == pytest.approx(value, rel=1e-4, abs=0 if value else 1e-4), key


def test_the_stated_standard_errors_are_the_scatter_of_repeated_measurements():
    """200 repetitions: their scatter is known to 5 %, one standard deviation; the bound is three."""
    values, linear = linear_pantograph("DSA-250")
    frequency = np.arange(1.0, 15.0, 0.5)
    exact = np.array([linear.receptance(f) for f in frequency])
    free = {"m1": (7.0, 1, 20), "k1": (8000.0, 1000, 20000), "c3": (60.0, 0, 300), "m3": (5.0, 1, 20)}
    fits = [solve(linear_problem(free, values, frequency, noisy(exact, 0.02, seed))) for seed in range(200)]
    found, stated = (np.array([getattr(f, key) for f in fits]) for key in ("values", "standard_error"))
    truth = np.array([values[name] for name in free])
    np.testing.assert_allclose(stated.mean(axis=0), found.std(axis=0, ddof=1), rtol=0.15)
    assert np.all(np.abs(found.mean(axis=0) - truth) < 4 * stated.mean(axis=0) / np.sqrt(len(fits)))
    correlation = np.mean([f.correlation for f in fits], axis=0)
    np.testing.assert_allclose(correlation, np.corrcoef(found.T), atol=0.2)


def test_a_parameter_that_the_data_want_beyond_its_bound_is_exactly_there():
    values, linear = linear_pantograph("DSA-380")
    frequency = np.arange(1.0, 15.0, 0.5)
    H = np.array([linear.receptance(f) for f in frequency])
    free = {"k1": (8000.0, 1000, 9000.0), "m1": (6.0, 1, 20)}
    problem = linear_problem(free, values, frequency, H)
    result = solve(problem)
    assert result.values[0] == 9000.0
    assert result.at_bound.tolist() == [True, False]
    assert np.isnan(result.standard_error[0]) and np.isfinite(result.standard_error[1])
    assert any("k1 is at its bound 9000" in line for line in doubts(problem, result))
    # The other one is where it fits best with the first at its bound.
    mass = result.x[1]
    costs = problem.costs([np.array([1.0, x]) for x in (mass - 1e-3, mass, mass + 1e-3)])
    assert costs[1] < min(costs[0], costs[2])


def test_it_says_what_the_data_cannot_determine():
    """k3 = 80 N/m is nothing above 12 Hz; far below 1 Hz only the sum of the masses matters."""
    values, linear = linear_pantograph("DSA-250")
    frequency = np.arange(12.0, 20.0, 0.5)
    H = noisy(np.array([linear.receptance(f) for f in frequency]), 0.02, 1)
    for high in (1000, 10000):  # with these measurements k3 ends at the first bound, and before the second
        problem = linear_problem({"k3": (50.0, 0, high), "m1": (6.0, 1, 20)}, values, frequency, H)
        result = solve(problem)
        (line,) = doubts(problem, result)
        assert "the data do not determine k3" in line and ("at its bound" in line) == result.at_bound[0]

    low = np.arange(0.05, 0.5, 0.05)
    H = noisy(np.array([linear.receptance(f) for f in low]), 1e-4, 1)
    problem = linear_problem({"m2": (5.0, 1, 20), "m3": (5.0, 1, 20)}, values, low, H)
    assert any("m2 and m3 can hardly be told apart" in line for line in doubts(problem, solve(problem)))


def test_the_search_finds_what_least_squares_alone_miss():
    """From two springs far too soft least squares end in a wrong valley, with one of them at its bound."""
    values, linear = linear_pantograph("DSA-380")
    frequency = np.arange(1.0, 20.0, 0.5)
    H = np.array([linear.receptance(f) for f in frequency])
    free = dict.fromkeys(("k1", "k2"), (2000.0, 1000.0, 40000.0))
    problem = linear_problem(free, values, frequency, H)
    assert solve(problem).cost > 1
    starts = search(problem.start, Search(), problem.costs)
    found = min((fit(problem, x, lambda cost: None) for x in starts), key=lambda each: each.cost)
    np.testing.assert_allclose(found.values, [values["k1"], values["k2"]], rtol=1e-6)


def test_the_search_fills_the_space_and_gives_its_best_that_lie_apart():
    """64 points of a Sobol sequence in two dimensions: one in each field of a chessboard."""

    valleys, asked = np.array([[0.3, 0.3], [0.7, 0.2], [0.6, 0.9]]), []

    def costs(xs):
        asked.extend(xs)
        return np.min(np.sum((xs[:, None] - valleys) ** 2, axis=2), axis=1)

    starts = search(valleys[0], Search(samples=20, starts=2), costs)
    assert len(asked) == 64 and len({tuple(x) for x in np.floor(8 * np.array(asked)).tolist()}) == 64
    # Neither near the start values, which are tried anyway.
    places = sorted(starts, key=lambda x: x[0])
    np.testing.assert_allclose(places, [[0.6, 0.9], [0.7, 0.2]], atol=0.1)


def zspring_fit(folder: Path, free: str, extra: str = "") -> tuple[str, dict[str, float]]:
    """Output and fitted parameters of a fit to bench.csv in the folder."""
    text = f'model = "zspring"\n{extra}\n[[measurement]]\nfile = "bench.csv"\n[free]\n{free}\n'
    (folder / "fit.toml").write_text(text)
    same_step = ["--set", f"solver.step={STEP}"]  # as the measurements, so that the solver's error cancels
    options = ["--jobs", f"{JOBS}", "--output", "out", *same_step]
    out, _ = zspring(folder, "identify", "fit.toml", *options)
    with Fmu() as model:
        return out, read_set(folder / "out/fitted.ssv", model)


@pytest.fixture(scope="module")
def measurement(tmp_path_factory) -> dict[tuple[float, float], complex]:
    """Six amplitudes of the default pantograph, settled twice as well as the fit needs."""
    folder = tmp_path_factory.mktemp("measurement")
    frequencies = "0.5:20:0.75"
    step = ["--set", f"solver.step={STEP}"]
    settings = [*step, "--set", f"static_force={BENCH_FORCE}", "--tolerance", "1e-4"]
    zspring(folder, "frf", "--frequencies", frequencies, *settings, "--output", "out")
    return receptances(folder / "out/frf.csv")


def with_noise(measurement: dict, level: float, seed: int) -> dict:
    return dict(zip(measurement, noisy(np.array(list(measurement.values())), level, seed).tolist()))


START_50_PERCENT_OFF = """
zspring.k = { start = 19575, min = 5000, max = 40000 }
zspring.l0 = { start = 0.00855, min = 0.001, max = 0.019 }
zspring.Mf = { start = 0.45, min = 0.02, max = 2 }
"""


def test_the_z_spring_comes_back_from_noisy_measurements(fmu, measurement, tmp_path):
    """k, l0 and Mf within 1 % from 2 % noise and starts 50 % off.

    What the fit writes is a set that other tools read and that `zspring frf` takes.
    """
    write_measurement(tmp_path / "bench.csv", with_noise(measurement, 0.02, 2))
    out, found = zspring_fit(tmp_path, START_50_PERCENT_OFF, "search = { samples = 0 }")
    for name in ("zspring.k", "zspring.l0", "zspring.Mf"):
        assert found[name] == pytest.approx(fmu.start(name), rel=0.01)
    # The noise alone: 2 % in H is 1.4 % in its magnitude, from 26 points of an amplitude known to a fifth.
    rms = [float(value) for value in re.findall(r"m/s2 +\d+ +([\d.]+) %", out)]
    assert len(rms) == len(AMPLITUDES) and np.all(np.abs(np.array(rms) - 1.41) < 0.6)

    path = tmp_path / "out/fitted.ssv"
    assert {p.name for p in read_ssv(str(path)).parameters} == set(found)
    assert (tmp_path / "out/fit.png").read_bytes().startswith(b"\x89PNG\r\n")
    rows = table(tmp_path / "out/fit.csv")
    assert len(rows) == len(measurement)
    row = rows[40]
    options = ["--amplitudes", row["amplitude [m/s2]"], "--frequencies", row["frequency [Hz]"]]
    assert "static_force" not in found and "static force of 110 N" in describe_set(path)[0]
    assert f"as on the bench: --parameters {Path('out/fitted.ssv')} --set static_force=110" in out
    options += ["--set", f"static_force={BENCH_FORCE}", "--set", f"solver.step={STEP}", "--tolerance", "1e-4"]
    zspring(tmp_path, "frf", "--parameters", str(path), *options, "--output", "again")
    (H,) = receptances(tmp_path / "again/frf.csv").values()
    fitted = complex(float(row["fitted_re [m/N]"]), float(row["fitted_im [m/N]"]))
    assert H == pytest.approx(fitted, rel=5e-3)


def test_six_parameters_come_back_within_their_standard_errors(fmu, measurement, tmp_path):
    """Within 3 %, from starts 50 % off, and within four of their standard errors."""
    others = """
m1 = { start = 10.7, min = 3, max = 20 }
k2 = { start = 7000, min = 3000, max = 40000 }
c3 = { start = 105, min = 0, max = 300 }
"""
    write_measurement(tmp_path / "bench.csv", with_noise(measurement, 0.02, 3))
    out, found = zspring_fit(tmp_path, START_50_PERCENT_OFF + others, "search = { samples = 0 }")
    for name in ("zspring.k", "zspring.l0", "zspring.Mf", "m1", "k2", "c3"):
        assert found[name] == pytest.approx(fmu.start(name), rel=0.03), name
        error = float(re.search(rf"^{re.escape(name)} +\S+ +(\S+)", out, re.MULTILINE)[1])
        assert abs(found[name] - fmu.start(name)) < 4 * error, name


def test_an_interrupted_search_goes_on_to_the_same_result(measurement, tmp_path):
    few = {k: H for k, H in measurement.items() if k[0] in (0.5, 4.0) and k[1] > 9}
    write_measurement(tmp_path / "bench.csv", few)
    text = 'model = "zspring"\n[[measurement]]\nfile = "bench.csv"\n'
    text += "[free]\nm1 = { start = 9, min = 3, max = 20 }\nk2 = { start = 9000, min = 3000, max = 40000 }\n"
    text += f"[search]\nsamples = 30\n[fixed]\nsolver.step = {STEP}\n"
    (tmp_path / "fit.toml").write_text(text)
    process = start(tmp_path, "identify", "fit.toml", "--output", "broken", "--jobs", f"{JOBS}")
    record = tmp_path / "broken/search.partial.csv"
    deadline = time.monotonic() + 60
    while not (record.exists() and len(record.read_text().splitlines()) > 20):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "the same command goes on" in err and "Traceback" not in err
    kept = len(table(record))
    out, _ = zspring(tmp_path, "identify", "fit.toml", "--output", "broken", "--jobs", f"{JOBS}")
    assert f"going on after {kept} candidates" in out and not record.exists()
    zspring(tmp_path, "identify", "fit.toml", "--output", "whole", "--jobs", "1")
    with Fmu() as model:
        broken, whole = (read_set(tmp_path / f"{name}/fitted.ssv", model) for name in ("broken", "whole"))
    assert broken == whole


def linear_fit(folder: Path, more: str = "") -> Path:
    """Settings of a fit of m1 and k2 to exact points of the linear model."""
    values, linear = linear_pantograph("DSA-380")
    points = {(0.25, float(f)): linear.receptance(f) for f in np.arange(1.0, 15.0)}
    write_measurement(folder / "bench.csv", points)
    free = "".join(f"{key} = {{ start = {values[key]}, min = 1, max = 40000 }}\n" for key in ("m1", "k2"))
    text = 'model = "linear"\n[[measurement]]\nfile = "bench.csv"\n[search]\nsamples = 4\nstarts = 1\n[free]\n'
    (folder / "fit.toml").write_text(text + free + more)
    return folder / "fit.toml"


@pytest.mark.parametrize("fits", [1, 2, 3])
def test_ctrl_c_in_the_last_jacobian_writes_nothing_and_keeps_the_search(tmp_path, monkeypatch, fits):
    """Answers are NaN from Ctrl-C on, so that standard errors from such a Jacobian would mean nothing.

    There are three fits: from the start values, from the best of the search, and that of all points.
    """
    path, out = linear_fit(tmp_path), tmp_path / "out"
    calls = []

    def fit_until_ctrl_c(*arguments):
        calls.append(fit(*arguments))
        if len(calls) == fits:
            os.kill(os.getpid(), signal.SIGINT)
        return calls[-1]

    with Fmu() as model:
        settings = read_settings(path, model)
        with monkeypatch.context() as patched:
            patched.setattr(stages, "fit", fit_until_ctrl_c)
            with pytest.raises(Interrupted, match="the same command goes on after the search"):
                run.identify(model, settings, path, out, "png", JOBS)
        assert sorted(path.name for path in out.iterdir()) == ["identify.log", "search.partial.csv"]
        run.identify(model, settings, path, out, "png", JOBS)
    assert (out / "fitted.ssv").exists() and not (out / "search.partial.csv").exists()


def test_ctrl_c_after_the_fit_keeps_what_was_fitted(tmp_path, monkeypatch):
    path, out = linear_fit(tmp_path, "[uncertainty]\nprofiles = true\n"), tmp_path / "out"

    def interrupted(*arguments):
        os.kill(os.getpid(), signal.SIGINT)
        return 0.0, 1.0

    with Fmu() as model:
        settings = read_settings(path, model)
        with monkeypatch.context() as patched:
            patched.setattr(stages, "profile_interval", interrupted)
            with pytest.raises(Interrupted, match=r"; written so far: \S+fitted.ssv, \S+fit.csv$"):
                run.identify(model, settings, path, out, "png", JOBS)
        kept = read_set(out / "fitted.ssv", model)
        run.identify(model, settings, path, out, "png", JOBS)
        assert read_set(out / "fitted.ssv", model) == kept


def test_a_candidate_that_cannot_be_simulated_costs_a_penalty_and_no_more(fmu):
    """Without weight and force an l0 longer than the gap between the rods leaves the spring slack."""
    frequency = np.array([3.0, 6.0])
    curves = [Curve("1 m/s2", frequency, np.ones(2), np.array([1e-4 - 1e-4j, 2e-4 - 1e-4j]))]
    settings = Settings.model_construct(
        model="zspring",
        free={"zspring.l0": Free(start=0.017, min=0.01, max=0.1)},
        fixed={"gravity": 0.0, "static_force": 0.0},
    )
    with Fmu() as model, model.instances(1) as instances:
        bench = BenchModel(instances, "up", threading.Event())
        problem = Problem(settings, ZSpringModel(bench, curves, None), curves)
        good, bad, again = problem.costs([problem.start, np.array([0.9]), problem.start])
        bench.close()
    assert good == again < bad
    assert bad == 0.5 * 4 * 10.0**2


def test_a_parameter_without_any_effect_is_named(fmu, tmp_path, measurement):
    """tau means nothing to Coulomb's law."""
    few = {k: H for k, H in measurement.items() if k[0] in (1.0, 4.0) and k[1] < 8}
    write_measurement(tmp_path / "bench.csv", few, friction="Coulomb")
    free = """
zspring.Mf = { start = 0.4, min = 0.1, max = 1 }
zspring.tau = { start = 900, min = 100, max = 5000 }
"""
    extra = "search = { samples = 0 }"
    out, found = zspring_fit(tmp_path, free, extra)
    assert "the data do not determine zspring.tau" in out
    assert "zspring.Mf:" not in out and found["zspring.Mf"] == pytest.approx(fmu.start("zspring.Mf"), rel=0.02)


def static_loop(amplitude: float) -> np.ndarray:
    """Displacements (n,) in m: up, down, up again by that amplitude."""
    up = np.linspace(0, amplitude, 40)
    return np.concatenate([up[1:], up[-2::-1], -up[1:], -up[-2::-1], up[1:]])


def test_the_static_test_follows_the_statics_of_the_z_spring(pantograph):
    """First stiffness K_locked, while the rods stick. Free rods stay on one line with the spring, so that

        force = m1 g - k (d / cos(theta) - L1 - L2 - l0) sin(theta),  tan(theta) = tan(theta0) - z / d;

    sliding rods turn with that line, and their moments add 2 Mf dtheta/dz = 2 Mf cos(theta)^2 / d, but for
    what the friction holds them off the line.
    """
    p = pantograph()
    head = ZSpringLinear.of(p)
    z = static_loop(0.02)
    with Fmu() as model, model.instances() as (instance,):

        def simulated(z: np.ndarray, friction: str) -> np.ndarray:
            test = StaticTest(z, np.zeros(z.shape), np.full(z.shape, 0.1))
            return test.simulated(instance, model.variables.parse_assignments([f"friction={friction}"]))

        first = simulated(2e-6 * np.arange(1, 9), "Coulomb")
        sliding, free = simulated(z, "Coulomb"), simulated(z, "Free")
    assert np.diff(first)[3:] / 2e-6 == pytest.approx(head.k_locked, rel=1e-3)
    theta = np.arctan(np.tan(head.theta) - z / head.d)
    tension = head.k * (head.d / np.cos(theta) - head.L1 - head.L2 - head.l0)
    expected = p["m1"] * p["gravity"] - tension * np.sin(theta)
    turns = [0, 38, 38 + 78]  # where free rods swing for a while
    calm = np.array([i for i in range(z.size) if not any(0 <= i - turn < 15 for turn in turns)])
    np.testing.assert_allclose(free[calm], expected[calm], atol=2e-3 * np.ptp(expected))
    moment = 2 * p["zspring.Mf"] * np.cos(theta) ** 2 / head.d
    rising, falling = np.arange(20, 38), np.arange(60, 110)
    np.testing.assert_allclose((sliding - free)[rising], moment[rising], rtol=0.05)
    np.testing.assert_allclose((sliding - free)[falling], -moment[falling], rtol=0.05)


def test_a_static_test_alone_with_one_response_determines_the_friction(fmu, measurement, tmp_path):
    """Smallest amplitude, at which the rods stick: only the static loop knows Mf."""
    few = {k: H for k, H in measurement.items() if k[0] == 0.25 and k[1] > 7}
    write_measurement(tmp_path / "bench.csv", few)
    displacement = static_loop(0.01)
    with Fmu() as model, model.instances() as (instance,):
        test = StaticTest(displacement, np.zeros(displacement.shape), np.full(displacement.shape, 0.05))
        force = (
            test.simulated(instance, {"solver.step": STEP, "static_force": BENCH_FORCE}) + 3.0
        )  # the load cell's zero
    noise = np.random.default_rng(5).standard_normal(force.shape)
    lines = ["time [s],displacement [mm],force [N]"]
    lines += [
        f"{0.05 * (i + 1)!r},{1e3 * z!r},{float(f + 0.2 * e)!r}"
        for i, (z, f, e) in enumerate(zip(displacement.tolist(), force, noise))
    ]
    (tmp_path / "static.csv").write_text("\n".join(lines) + "\n")
    extra = 'static = { file = "static.csv" }\nsearch = { samples = 0 }'
    out, found = zspring_fit(tmp_path, "zspring.Mf = { start = 0.45, min = 0.02, max = 2 }", extra)
    assert found["zspring.Mf"] == pytest.approx(fmu.start("zspring.Mf"), rel=0.02)
    assert float(re.search(r"static test: rms ([\d.]+) N", out)[1]) == pytest.approx(0.2, rel=0.2)
    assert (tmp_path / "out/static.png").exists()


def test_start_values_that_the_fmu_refuses_are_told_at_once(measurement, tmp_path):
    write_measurement(tmp_path / "bench.csv", measurement, static_force=0)
    text = 'model = "zspring"\n[[measurement]]\nfile = "bench.csv"\n[free]\n'
    (tmp_path / "fit.toml").write_text(text + "zspring.l0 = { start = 0.09, min = 0.01, max = 0.1 }\n")
    _, err = zspring(tmp_path, "identify", "fit.toml", "--set", "gravity=0", status=1)
    assert len(err.splitlines()) == 1 and "tension" in err


def test_the_example_is_never_overwritten(tmp_path):
    """That it runs, README shows."""
    zspring(tmp_path, "identify", "--example", "mine")
    (tmp_path / "mine/bench.csv").unlink()
    _, err = zspring(tmp_path, "identify", "--example", "mine", status=1)
    assert "exists and is kept" in err
