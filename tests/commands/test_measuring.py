"""How responses are measured and read off: steady states, sweeps, the bench outside the FMU, peaks, phases."""

from __future__ import annotations

import contextlib
import threading
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from linear import PUBLISHED, LinearPantograph
from zspring.bench.fmu_bench import FmuBench
from zspring.bench.input_bench import InputBench
from zspring.bench.measure import measure, settle
from zspring.bench.measured import Curve
from zspring.bench.model import BenchModel
from zspring.bench.points import FrfSettings, left_out, sweeps
from zspring.bench.refine import LEAST_STEP, turns
from zspring.bench.responses import QUANTITIES, acceleration_of, as_quantity, phase_degrees, response_of
from zspring.fmu import Fmu, StepDiscarded
from zspring.study.evaluations import FrfQuantity

GO_ON = threading.Event()


@pytest.fixture(scope="module")
def own_fmu():
    with Fmu() as fmu:
        yield fmu


# Steady states


class Scripted:
    """A bench whose H after n whole periods is a given function; the first period of a run is the ramp."""

    def __init__(self, H, fails_at: int | None = None):
        self._H, self._fails_at = H, fails_at
        self.instance, self.periods, self.looks = self, -1, []

    def get(self, names):
        done = max(self.periods, 0)
        counts = {"solver.steps": 100, "solver.iterations": 150, "solver.refinements": 2, "energy.dissipated": 0.25}
        return [5 if name == "solver.iterations_max" else counts[name] * (done + 7) for name in names]

    def run(self, periods: int) -> None:
        self.periods += periods
        if self._fails_at is not None and self.periods >= self._fails_at:
            raise StepDiscarded("no solution")
        self.looks.append(self.periods)

    @property
    def H(self) -> complex:
        return self._H(self.periods)

    @property
    def harmonics(self) -> tuple[float, ...]:
        return (float(self.periods),) * 6

    @property
    def change(self) -> float:
        return abs(self._H(self.periods) - self._H(self.periods - 1)) / abs(self.H)


def settled(H, fails_at: int | None = None, **settings):
    bench = Scripted(H, fails_at)
    return settle(bench, 1.0, 4.0, FrfSettings(**settings), GO_ON), bench


def test_a_steady_answer_is_taken_at_the_fewest_periods():
    for fewest, taken in ((1, 8), (8, 8), (9, 12), (30, 32)):
        point, bench = settled(lambda n: 1e-4 - 1e-5j, min_periods=fewest)
        assert (point.status, point.periods, point.H) == ("settled", taken, 1e-4 - 1e-5j)
        assert point.remaining < 1e-12 and bench.looks == list(range(taken + 1))


def test_what_it_took_is_counted_from_the_begin_of_the_point():
    point, _ = settled(lambda n: 1.0, min_periods=12)
    assert (point.steps, point.iterations, point.refinements) == (1200, 1800, 24)
    assert (point.iterations_max, point.loss, point.harmonics) == (5, 0.25, (12.0,) * 6)
    assert point.displacement == pytest.approx(1.0 / (2 * np.pi * 4) ** 2)


@pytest.mark.parametrize("q", [0.8, 0.98, -0.98, 0.97 * np.exp(0.2j), 0.97 * np.exp(2j)])
def test_a_transient_is_waited_for_until_what_is_left_of_it_is_within_the_tolerance(q):
    """1 + Re q^n + i Im q^n / 2: of slow ones, and where a beat turns, the changes are within it far sooner."""
    tolerance = 1e-3

    def H(n):
        return 1 + np.real(q**n) + 0.5j * np.imag(q**n)

    def changes(n):
        return max(abs(H(n) - H(n - 1)), abs(H(n) - H(n - 4)))

    point, _ = settled(H, tolerance=tolerance, max_periods=1000)
    looks = range(8, 1000, 4)
    expected = next(n for n in looks if max(abs(H(n) - 1), changes(n)) <= tolerance * abs(H(n)))
    assert point.status == "settled" and point.periods == expected
    assert point.remaining == pytest.approx(abs(H(expected) - 1), rel=1e-3)
    assert point.change == pytest.approx(abs(H(expected) - H(expected - 1)), rel=1e-2)


def test_noise_below_the_tolerance_is_steady():
    noise = np.random.default_rng(1).normal(size=(500, 2)) @ [1e-4, 1e-4j]
    point, _ = settled(lambda n: 1 + noise[n])
    assert (point.status, point.periods) == ("settled", 8) and 1e-6 < point.remaining < 1e-3


@pytest.mark.parametrize("k", [2, 3, 4])
def test_a_state_that_repeats_after_several_periods_is_named_and_its_forces_averaged(k):
    """Its own transient falls by 0.7 a period. H = 1/F of all k periods together."""
    forces = 1 + 0.1 * np.cos(2 * np.pi * np.arange(k) / k + 0.3)
    point, _ = settled(lambda n: 1 / (forces[n % k] + 0.7**n))
    assert point.status == f"period {k}" and point.periods < 60
    assert point.H == pytest.approx(1 / forces.mean(), rel=1e-3) and point.change > 0.02


def test_a_beat_of_more_than_a_few_periods_never_settles():
    """Of 5 periods, and of no whole number of them: that passes through turns in which it hardly changes."""
    for turn in (2 * np.pi / 5, 0.6):
        point, _ = settled(lambda n, turn=turn: 1 + 0.01 * np.cos(turn * n), max_periods=200)
        assert point.status == "not settled" and point.periods == 200 and 1e-3 < point.remaining < 0.02


def test_a_beat_is_noticed_in_its_turns():
    """It turns between the periods 7 and 8, where it is the same; not so at the look before, at 4."""

    def H(n):
        return 1 + 0.01 * np.cos(2 * np.pi * (n - 7.5) / 24)

    assert abs(H(8) - H(7)) < 1e-9 < 1e-3 < abs(H(8) - H(4))
    point, _ = settled(H, max_periods=9)
    assert point.status == "not settled" and point.periods == 9


def test_the_most_periods_end_a_point_that_drifts():
    point, _ = settled(lambda n: 1 + 0.1 * n, max_periods=20)
    assert (point.status, point.periods) == ("not settled", 20)
    assert point.H == pytest.approx(3.0) and point.change == pytest.approx(0.1 / 3)


def test_a_light_damper_is_waited_for(own_fmu):
    """Frame damped by 2 N s/m: at 8.25 Hz its free vibration near 12 Hz almost alternates for long."""
    parameters = own_fmu.variables.parse_assignments(["suspension=Linear", "c3=2", "c1=4", "solver.step=0.0002"])
    settings = FrfSettings((1.0,), (8.25,), parameters=parameters)
    with own_fmu.instances() as (instance,):
        bench = FmuBench(instance, parameters)
        bench.start(8.25, 1.0)
        point = settle(bench, 1.0, 8.25, settings, GO_ON)
    values = {**PUBLISHED["DSA-380"], "c3": 2.0, "c1": 4.0}
    exact = LinearPantograph(head=values.pop("k1"), **values).receptance(8.25)
    assert point.status == "settled" and point.periods > 100
    assert 2e-4 < abs(point.H / exact - 1) < 1e-3


def test_rods_without_friction_may_answer_every_second_period(own_fmu):
    """Unlike rods, driven hard: the force itself at the ends of the periods alternates, for good."""
    rods = ["friction=Free", "c1=10", "zspring.k=16515", "zspring.J1=0.005", "zspring.J2=0.02", "solver.step=0.0005"]
    forces = []
    with own_fmu.instances() as (instance,):
        bench = FmuBench(instance, own_fmu.variables.parse_assignments(rods))
        bench.start(4.717, 30.0)
        point = settle(bench, 30.0, 4.717, FrfSettings(tolerance=1e-5), GO_ON)
        for _ in range(6):
            bench.run(1)
            forces += instance.get(["contact.force"])
    assert point.status == "period 2" and point.change > 0.1
    np.testing.assert_allclose(forces[2:], forces[:-2], rtol=1e-3)
    assert np.all(np.abs(np.diff(forces)) > 0.02 * np.mean(forces))


@pytest.mark.parametrize("fails_at", [4, 8])
def test_a_point_that_fails_keeps_no_number(fails_at):
    point, _ = settled(lambda n: 1.0, fails_at)
    assert point.status == "failed: no solution" and np.isnan(point.H) and np.isnan(point.change)


def test_a_stopped_point_is_none():
    stop = threading.Event()
    stop.set()
    assert settle(Scripted(lambda n: 1.0), 1.0, 4.0, FrfSettings(), stop) is None


# Sweeps


def test_a_sweep_has_the_points_that_the_stroke_allows_in_its_direction():
    """8 m/s2 at 1 Hz is 203 mm; 0.2 m/s2 just 5.07 mm."""
    settings = FrfSettings((0.2, 8.0), (1.0, 2.0, 3.0), stroke=0.0507)
    assert [(s.level, s.frequencies) for s in sweeps(settings)] == [(0.2, (1, 2, 3)), (8, (2, 3))]
    (missing,) = left_out(settings)
    assert (missing.amplitude, missing.frequency, missing.status) == (8, 1, "left out")
    assert np.isnan(missing.H) and np.isnan(missing.change)
    counts = missing.periods, missing.steps, missing.iterations, missing.refinements, missing.iterations_max
    assert counts == (0, 0, 0, 0, 0)
    assert [s.frequencies for s in sweeps(replace(settings, direction="down"))] == [(3, 2, 1), (3, 2)]
    rest = sweeps(replace(settings, direction="rest"))
    assert [(s.level, *s.frequencies) for s in rest] == [(0.2, 1), (0.2, 2), (0.2, 3), (8, 2), (8, 3)]
    assert [s.level for s in sweeps(replace(settings, stroke=0.02))] == [0.2]


def test_the_standard_figure_doubles_its_amplitudes_over_half_a_hertz_to_twenty():
    settings = FrfSettings()
    np.testing.assert_array_equal(settings.amplitudes, 0.25 * 2.0 ** np.arange(6))
    np.testing.assert_array_equal(settings.frequencies, np.arange(0.5, 20.1, 0.25))
    # 100 mm of stroke: 8 m/s2 from 1.42 Hz on, 4 from 1.01, 2 from 0.71, 1 from 0.50 Hz on.
    assert [(p.amplitude, p.frequency) for p in left_out(settings)] == [
        (1, 0.5),
        *((2, f) for f in (0.5,)),
        *((4, f) for f in (0.5, 0.75, 1.0)),
        *((8, f) for f in (0.5, 0.75, 1.0, 1.25)),
    ]


@pytest.mark.parametrize("direction", ["up", "down", "rest"])
def test_a_model_of_a_measurement_sweeps_in_its_direction(own_fmu, direction):
    """As `zspring frf` does; what is left of the transients tells the directions apart."""
    frequency = np.array([4.0, 4.75, 5.5])
    curve = Curve("2 m/s2", frequency, np.full(3, 2.0), np.ones(3))
    with own_fmu.instances() as instances:
        model = BenchModel(instances, direction, GO_ON)
        ((answer,),) = model.receptances([{}], [curve])
        ((again,),) = model.receptances([{}], [curve], [answer.periods])
        model.close()
    found = {}
    for way in ("up", "down", "rest"):
        settings = FrfSettings((2.0,), tuple(frequency), direction=way, tolerance=2e-4)
        points = {point.frequency: point for point, _ in measure(own_fmu, settings, sweeps(settings), 1, GO_ON)}
        found[way] = np.array([points[f].H for f in frequency])
    np.testing.assert_array_equal(answer.H, found[direction])
    np.testing.assert_allclose(again.H, answer.H, rtol=1e-12)  # in one communication step
    for way in found.keys() - {direction}:
        assert 1e-9 < np.abs(answer.H / found[way] - 1).max() < 5e-3


# The bench outside the FMU


class Recorder:
    """An FMU with only a spring, F = -k z, that answers `lag` steps late; keeps targets and times."""

    STIFFNESS = 5e3

    def __init__(self, lag: int = 0, step: float = 0.002):
        self._lag, self._step = lag, step
        self.slave = self.variables = self
        self.component, self.targets, self.calls = None, [], []

    def parse_assignments(self, _assignments):
        return {}

    def __getitem__(self, name: str):
        self.valueReference = {"head_displacement": 1, "contact.force": 2}[name]
        return self

    def start(self, _parameters) -> None:
        self.targets.clear()
        self.calls.clear()

    def set(self, values) -> None:
        self._frequency = values["bench.frequency"]

    def get(self, names):
        """Internal steps in a period: as few as the step allows, but 16 at least."""
        assert names == ["bench.steps_per_period"]
        return [max(16, int(np.ceil(1 / (self._frequency * self._step) - 1e-9)))]

    refusals = contextlib.nullcontext

    def fmi2SetReal(self, _component, references, _count, values) -> None:
        assert references[0] == 1
        self.targets.append(values[0])

    def fmi2DoStep(self, _component, time, size, _flag) -> None:
        self.calls.append((time, size))

    def fmi2GetReal(self, _component, references, _count, values) -> None:
        assert references[0] == 2
        values[0] = -self.STIFFNESS * self.targets[-1 - self._lag] if len(self.targets) > self._lag else 0.0


def quintic(x):
    return 6 * x**5 - 15 * x**4 + 10 * x**3


@pytest.mark.parametrize("lag", [0, 3])
def test_the_outside_bench_starts_by_the_quintic_and_reads_magnitude_and_phase(lag):
    """4.6 Hz in steps of at most 2 ms: 109 of them in a period. A late answer turns the phase ahead of -Z/F."""
    recorder = Recorder(lag)
    bench = InputBench(recorder, {})
    bench.start(4.6, 3.0)
    bench.run(4)
    peak, x = 3.0 / (2 * np.pi * 4.6) ** 2, np.arange(1, 4 * 109 + 1) / 109
    expected = peak * np.where(x < 1, quintic(x), 1) * np.sin(2 * np.pi * x)
    np.testing.assert_allclose(recorder.targets, expected, atol=1e-12 * peak)
    times, sizes = np.array(recorder.calls).T
    np.testing.assert_allclose(sizes, 1 / (109 * 4.6))
    np.testing.assert_allclose(times, (x - x[0]) / 4.6, atol=1e-12)
    assert bench.periods == 3 and bench.change < 1e-12
    assert bench.H == pytest.approx(np.exp(2j * np.pi * lag / 109) / Recorder.STIFFNESS, rel=1e-12)


@pytest.mark.parametrize("frequency, acceleration, ramp", [(9.0, 2.0, 2), (2.0, 2.0, 1), (4.6, 8.0, 1), (15.3, 0.5, 3)])
def test_the_outside_bench_goes_over_to_another_point_without_a_jump(frequency, acceleration, ramp):
    """Frequency and peak follow the quintic over whole periods, about as long as one of the slower sine."""
    recorder = Recorder()
    bench = InputBench(recorder, {})
    bench.start(4.6, 3.0)
    bench.run(4)
    before = len(recorder.targets)
    bench.tune(frequency, acceleration)
    assert (bench.H, bench.change, bench.periods) == (0, 1.0, 0)
    bench.run(ramp + 2)
    assert bench.periods == 2
    found = np.array(recorder.targets[before:])
    steps = len(found) // (ramp + 2)
    assert steps == max(16, np.ceil(500 / frequency)) and len(found) == steps * (ramp + 2)
    old, new = 3.0 / (2 * np.pi * 4.6) ** 2, acceleration / (2 * np.pi * frequency) ** 2
    duration = ramp / frequency

    def speed(t: float) -> float:
        return 4.6 + (frequency - 4.6) * quintic(min(t / duration, 1.0))

    for i in (0, steps // 3, steps, steps * ramp - 1, steps * ramp + 5, len(found) - 1):
        t = (i + 1) / (steps * frequency)
        turns = quad(speed, 0, min(t, duration))[0] + frequency * max(t - duration, 0)
        peak = old + (new - old) * quintic(min(t / duration, 1.0))
        assert found[i] == pytest.approx(peak * np.sin(2 * np.pi * turns), abs=1e-9 * max(old, new))
    assert bench.H == pytest.approx(1 / Recorder.STIFFNESS)


def test_the_outside_bench_looks_at_changes_between_periods():
    """A spring that stiffens by a tenth from the third period on."""
    recorder = Recorder()
    bench = InputBench(recorder, {})
    bench.start(4.0, 1.0)
    bench.run(2)
    assert (bench.periods, bench.change) == (1, 1.0)
    recorder.STIFFNESS = 1.1 * Recorder.STIFFNESS
    bench.run(1)
    assert bench.periods == 2 and bench.change == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("kind", [FmuBench, InputBench])
def test_a_bench_goes_on_from_a_saved_state_as_if_nothing_had_been(own_fmu, kind):
    """The next point begins with the ramp from the last one, wherever that is done."""
    with own_fmu.instances(2) as instances:
        whole, broken = (kind(instance, {"solver.step": 2e-3}) for instance in instances)
        whole.start(5.0, 4.0)
        whole.run(3)
        state = whole.save()
        broken.load(state)
        for bench in (whole, broken):
            bench.tune(7.3, 2.0)
            bench.run(5)
        assert broken.H == whole.H != 0 and broken.change == whole.change and broken.save() == whole.save()


# Peaks


@pytest.mark.parametrize("height, count", [(0.9 * LEAST_STEP, 1), (1.1 * LEAST_STEP, 2)])
def test_ripple_is_no_resonance(height, count):
    """A dent of that height on the flank beyond the peak, a level of log|H|."""
    level = np.array([0.0, 1.0, 2.0, 1.5, 1.0, 0.5, 0.5 + height, 0.1, -1.0])
    assert turns(level) == [2, 5, 6][: 2 * count - 1]


@pytest.mark.parametrize("band, index", [((0.5, 20.0), 1), ((8.0, 20.0), 2), ((3.0, 8.0), 1)])
def test_the_highest_resonance_is_looked_for_within_the_band(own_fmu, band, index):
    """The published three-mass DSA-380 has peaks near 6.6 and 12.3 Hz, the first one much the higher."""
    values = dict(PUBLISHED["DSA-380"])
    linear = LinearPantograph(head=values.pop("k1"), **{**values, "c1": 30.0})
    fine = np.arange(5.5, 14, 0.001)
    magnitude = np.abs([linear.receptance(f) for f in fine])
    tops = [i for i in range(1, len(fine) - 1) if magnitude[i - 1] < magnitude[i] > magnitude[i + 1]]
    frequencies = tuple(np.arange(5.5, 14, 0.25).tolist())
    quantity = FrfQuantity(FrfSettings((1.0,), frequencies, tolerance=1e-4), band)
    assignments = ["suspension=Linear", "c1=30", "solver.step=2e-4"]
    with own_fmu.instances() as (instance,):
        found, problems = quantity.measure(instance, own_fmu.variables.parse_assignments(assignments))
    assert not problems and len(tops) == 2
    assert found["resonance 1 m/s2 [Hz]"] == pytest.approx(fine[tops[index - 1]], rel=2e-4)
    assert found["peak 1 m/s2 [m/N]"] == pytest.approx(magnitude[tops[index - 1]], rel=1e-3)


def test_a_band_without_a_peak_has_no_resonance(own_fmu):
    quantity = FrfQuantity(FrfSettings((1.0,), (8.0, 9.0, 10.0, 11.0)), (8.0, 10.0))
    with own_fmu.instances() as (instance,):
        found, _ = quantity.measure(instance, {"suspension": 2})
    assert np.isnan(found["resonance 1 m/s2 [Hz]"]) and np.isnan(found["peak 1 m/s2 [m/N]"])
    assert "H_re 1 m/s2 11 Hz [m/N]" in found  # measured all the same


# Kinds and phases

UNITS = {  # derivatives of the displacement, factor to SI, whether force over motion
    "m/N": (0, 1, False),
    "mm/N": (0, 1e-3, False),
    "um/N": (0, 1e-6, False),
    "N/m": (0, 1, True),
    "kN/m": (0, 1e3, True),
    "N/mm": (0, 1e3, True),
    "m/(N.s)": (1, 1, False),
    "(m/s)/N": (1, 1, False),
    "(mm/s)/N": (1, 1e-3, False),
    "N.s/m": (1, 1, True),
    "N/(m/s)": (1, 1, True),
    "(m/s2)/N": (2, 1, False),
    "1/kg": (2, 1, False),
    "kg": (2, 1, True),
    "N/(m/s2)": (2, 1, True),
}


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_of_a_response_comes_back_to_the_receptance(unit):
    frequency, H = np.array([0.7, 5.0, 13.0]), np.array([3e-4 - 1e-4j, -1e-5 - 2e-4j, 4e-6 - 1e-7j])
    derivatives, factor, inverse = UNITS[unit]
    moved = H * (2j * np.pi * frequency) ** derivatives
    value = (1 / moved if inverse else moved) / factor
    np.testing.assert_allclose(response_of(unit).receptance(frequency, value), H, rtol=1e-12)


@pytest.mark.parametrize(
    "unit, power, factor",
    [("m/s2", 0, 1), ("mm/s2", 0, 1e-3), ("m/s", 1, 1), ("mm/s", 1, 1e-3), ("m", 2, 1), ("mm", 2, 1e-3)],
)
def test_every_unit_of_an_amplitude_becomes_an_acceleration(unit, power, factor):
    frequency = np.array([0.7, 5.0])
    expected = 3 * factor * (2 * np.pi * frequency) ** power
    np.testing.assert_allclose(acceleration_of(unit, frequency, np.array([3.0, 3.0])), expected, rtol=1e-12)


@pytest.mark.parametrize("quantity, unit", QUANTITIES.items())
def test_every_quantity_is_what_its_unit_says_and_its_phase_is_cut_a_right_angle_beyond_a_driving_point(quantity, unit):
    """Back to the receptance by what reads files; a little noise does not throw a phase a turn away."""
    frequency = np.array([0.7, 5.0, 12.0])
    bounds = {"receptance": -180, "stiffness": 0, "mobility": -90, "impedance": -90, "accelerance": 0, "mass": -180}
    for degrees in (-269.0, -180.5, -180.0, -179.5, -90.0, -0.5, 0.0, 0.5, 89.0):
        H = 1e-4 * np.exp(1j * np.radians(degrees)) * np.array([1, 2, 3])
        value = as_quantity(H, quantity, frequency)
        np.testing.assert_allclose(response_of(unit).receptance(frequency, value), H, rtol=1e-12)
        phase = phase_degrees(value, quantity)
        np.testing.assert_allclose(np.exp(1j * np.radians(phase)), value / abs(value), rtol=1e-9)
        inside = np.abs(phase - bounds[quantity] - 90)
        np.testing.assert_allclose(inside, abs(degrees + 90), atol=1e-9)  # of receptance from its middle
    assert np.isnan(as_quantity(complex(np.nan, np.nan), quantity, 5.0))


def test_what_quantities_of_a_single_mass_are():
    """Of 3 kg that hang on nothing: H = 1/(m s^2)."""
    f = np.array([0.5, 4.0])
    H = -1 / (3.0 * (2 * np.pi * f) ** 2) + 0j
    np.testing.assert_allclose(as_quantity(H, "mass", f), 3.0)
    np.testing.assert_allclose(as_quantity(H, "accelerance", f), 1 / 3)
    np.testing.assert_allclose(as_quantity(H, "impedance", f), 3.0 * 2j * np.pi * f)
    np.testing.assert_allclose(as_quantity(H, "stiffness", f), -3.0 * (2 * np.pi * f) ** 2)
    np.testing.assert_allclose(phase_degrees(as_quantity(H, "mass", f), "mass"), 0.0, atol=1e-12)
