"""Levels of velocity, displacement and force: the motion that follows, and how a force is found and held."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable

import numpy as np
import pytest

from linear import PUBLISHED, LinearPantograph
from zspring.bench.control import JUMPS, STROKE, TOO_FEW, holding
from zspring.bench.curves import Source
from zspring.bench.measure import BENCHES, FmuBench, measure, run_sweep
from zspring.bench.measured import read_curves
from zspring.bench.points import LEFT_OUT, FrfPoint, FrfSettings, Sweep, sweeps
from zspring.cli import main
from zspring.fmu import Fmu

GO_ON = threading.Event()


@pytest.fixture(scope="module")
def own_fmu():
    with Fmu() as fmu:
        yield fmu


def points(fmu: Fmu, control: str, levels: tuple[float, ...], frequencies, parameters=(), **settings) -> list[FrfPoint]:
    chosen = fmu.variables.parse_assignments([*parameters, "solver.step=0.0005"])
    wanted = FrfSettings(levels, frequencies, chosen, control=control, **settings)
    return [point for point, _ in measure(fmu, wanted, sweeps(wanted), 1, GO_ON)]


def held(force: Callable[[float], float], level: float, first: float, most: float = 1e3) -> tuple[str, list[float]]:
    """Why it ended, and the accelerations that were tried."""
    asking, tries = holding(level, first, most, 1e-3), []
    try:
        tries.append(next(asking))
        while True:
            tries.append(asking.send(force(tries[-1])))
    except StopIteration as end:
        return end.value, tries


@pytest.mark.parametrize("power", [0.3, 1.0, 1.5, 3.0])
@pytest.mark.parametrize("first", [0.02, 4.0])
def test_a_force_that_rises_is_found(power, first):
    why, tries = held(lambda a: 3 * a**power, 5.0, first)
    assert not why and 3 * tries[-1] ** power == pytest.approx(5.0, rel=1.001e-3)
    assert len(tries) <= 20 and max(np.abs(np.diff(np.log(tries)))) < math.log(2) + 1e-12


def test_a_force_that_jumps_over_the_level_is_told():
    why, tries = held(lambda a: a if a < 1.2 else 2 * a, 1.5, 0.1)
    assert why == JUMPS and tries[-1] == pytest.approx(1.2, rel=1e-3)


def test_a_force_that_falls_is_passed_over_until_it_rises_again():
    """A fold: with the force held the falling branch is unstable, and a controller goes on to the rising one."""

    def force(a: float) -> float:
        return a if a < 1 else max(2 - a, 0.2 * a)

    why, tries = held(force, 0.9, 0.05)
    assert not why and tries[-1] == pytest.approx(0.9, rel=2e-3)
    why, tries = held(force, 1.2, 0.05)
    assert not why and tries[-1] == pytest.approx(6.0, rel=2e-3)


def test_a_force_beyond_the_stroke_is_told():
    assert held(lambda a: a, 5.0, 0.1, most=2.0)[0] == STROKE
    assert held(lambda a: a, 5.0, 50.0, most=2.0) == (STROKE, [2.0])


def test_a_force_that_never_settles_ends_the_tries():
    numbers = iter(np.random.default_rng(3).uniform(0.3, 3, 100))
    assert held(lambda a: next(numbers), 1.0, 1.0)[0] in (TOO_FEW, JUMPS)


@pytest.mark.parametrize("through", BENCHES)
def test_a_force_is_held_on_a_linear_pantograph(own_fmu, through):
    """Its motion is |H| F, by the closed form, over a resonance and an antiresonance."""
    values = dict(PUBLISHED["DSA-380"])
    exact = LinearPantograph(head=values.pop("k1"), **values)
    for point in points(own_fmu, "force", (5.0,), (4.0, 5.5, 6.5, 9.0), ["suspension=Linear"], through=through):
        H = exact.receptance(point.frequency)
        assert point.status == "settled" and point.force == pytest.approx(5.0, rel=1.1e-3)
        assert abs(point.H / H - 1) < 3e-3 and point.remaining < 3e-3
        assert point.displacement == pytest.approx(5.0 * abs(H), rel=4e-3)


def test_a_force_that_needs_too_much_stroke_is_left_out(own_fmu):
    left, reached = points(own_fmu, "force", (3.0,), (1.0, 9.0), stroke=1e-3)
    assert left.status == LEFT_OUT and np.isnan(left.H) and reached.status == "settled"


@pytest.mark.parametrize("control, power", [("velocity", 1), ("displacement", 2)])
def test_a_motion_is_held_by_the_acceleration_that_belongs_to_it(own_fmu, control, power):
    level, frequencies = (0.01, 0.001)[power - 1], (3.0, 6.0)
    for point in points(own_fmu, control, (level,), frequencies, direction="rest"):
        omega = 2 * np.pi * point.frequency
        assert point.amplitude == pytest.approx(level * omega**power)
        assert point.displacement == pytest.approx(level / omega ** (2 - power))
        (same,) = points(own_fmu, "acceleration", (point.amplitude,), (point.frequency,), direction="rest")
        assert (same.H, same.harmonics, same.loss) == (point.H, point.harmonics, point.loss)


@pytest.mark.parametrize("through", BENCHES)
def test_a_sweep_with_the_force_held_goes_on_from_a_saved_state(own_fmu, through):
    settings = FrfSettings((3.0,), (5.0, 5.5, 6.0), control="force", through=through)
    parameters = own_fmu.variables.parse_assignments(["solver.step=0.001"])
    with own_fmu.instances() as (instance,):
        bench = BENCHES[through](instance, parameters)
        whole = list(run_sweep(bench, Sweep(3.0, settings.frequencies), settings, GO_ON))
    with own_fmu.instances() as (instance,):
        bench = BENCHES[through](instance, parameters)
        rest = list(run_sweep(bench, Sweep(3.0, settings.frequencies[1:], whole[0][1]), settings, GO_ON))
    assert [p.H for p, _ in rest] == [p.H for p, _ in whole[1:]]


class Jumping:
    """A bench whose force is that of 1 N s2/m, and twice as much from 1.2 m/s2 on."""

    def __init__(self):
        self.instance, self.harmonics, self.change, self.acceleration, self.tried = self, (), 0.0, 0.0, []

    def get(self, names):
        return [{"m1": 10.0}.get(name, 0.0) for name in names]

    def start(self, _frequency, acceleration):
        assert acceleration == 0

    def tune(self, frequency, acceleration):
        force = acceleration if acceleration < 1.2 else 2 * acceleration
        self.tried.append(force)
        self.H, self.periods = complex(acceleration / (2 * np.pi * frequency) ** 2 / force), 0

    def run(self, periods):
        self.periods += periods

    def save(self):
        return {}


def test_a_point_at_a_jump_is_the_nearest_state_and_tells_both_forces():
    bench, settings = Jumping(), FrfSettings((1.5,), (5.0,), control="force")
    ((point, _),) = run_sweep(bench, Sweep(1.5, (5.0,)), settings, GO_ON)
    assert point.status == "not held: the force jumps from 1.2 to 2.4 N"
    assert point.force == pytest.approx(1.2, rel=1e-3) and point.amplitude == pytest.approx(1.2, rel=1e-3)
    assert point.place == (1.5, 5.0) and point.label == "1.5 N"
    assert bench.tried[0] == pytest.approx(0.15)  # as if all masses moved alike


def test_a_stopped_point_is_none(own_fmu):
    stop = threading.Event()
    stop.set()
    settings = FrfSettings((3.0,), (5.0,), control="force")
    with own_fmu.instances() as (instance,):
        assert not list(run_sweep(FmuBench(instance, {}), Sweep(3.0, (5.0,)), settings, stop))


def test_the_command_writes_levels_that_are_read_again(tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["frf", "--control", "force", "--levels", "2,5", "--frequencies", "5:7:0.5", "--output", str(out)]
    assert main([*arguments, "--no-extremes", "--jobs", "1"]) == 0
    curves = read_curves(Source(out / "frf.csv"))
    assert [curve.label for curve in curves] == ["2 N", "5 N"]
    for curve, force in zip(curves, (2.0, 5.0)):
        peak = curve.acceleration / (2 * np.pi * curve.frequency) ** 2
        np.testing.assert_allclose(peak / abs(curve.H), force, rtol=2e-3)


@pytest.mark.parametrize(
    "given, said",
    [
        (["--control", "force"], "needs --levels, in N"),
        (["--control", "velocity", "--amplitudes", "1"], "needs --levels, in m/s"),
        (["--levels", "1", "--amplitudes", "1"], "must not be given with --amplitudes"),
    ],
)
def test_levels_without_their_meaning_are_refused(capsys, given, said):
    assert main(["frf", *given]) == 1
    assert said in capsys.readouterr().err
