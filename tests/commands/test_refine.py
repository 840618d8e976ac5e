"""Resonances and antiresonances are found, known as well as is said, and approached as the sweep does."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from linear import PUBLISHED, LinearPantograph
from zspring.bench.fmu_bench import FmuBench
from zspring.bench.measure import measure, run_sweep
from zspring.bench.points import FrfPoint, FrfSettings, sweeps
from zspring.bench.refine import JUMP, Extreme, Refinement, refine, refining
from zspring.fmu import Fmu
from zspring.frf.bounds import exact_extremes
from zspring.receptance import linear_model

GO_ON = threading.Event()
GRID = np.arange(2.0, 14.6, 0.25)


@pytest.fixture(scope="module")
def own_fmu():
    with Fmu() as fmu:
        yield fmu


def found(H: Callable[[float], complex], grid=GRID, status=lambda f: "settled", remaining=0.0):
    """Extremes of a curve that is measured where `refining` asks, and where that was."""

    def point(frequency: float) -> FrfPoint:
        return FrfPoint(1.0, float(frequency), status(frequency), complex(H(frequency)), remaining=remaining)

    asking, asked = refining([point(f) for f in grid]), []
    try:
        frequency, _ = next(asking)
        while True:
            asked.append(frequency)
            frequency, _ = asking.send(point(frequency))
    except StopIteration as end:
        return end.value, asked


def true_extremes(H: Callable[[float], complex], low: float, high: float) -> list[tuple[bool, float, float]]:
    """Is it a maximum, frequency and magnitude of all extremes of a smooth curve, by search on a fine grid."""
    grid = np.linspace(low, high, 5001)
    level = np.log(np.abs([H(f) for f in grid]))
    extremes = []
    for i in range(1, len(grid) - 1):
        if (level[i] - level[i - 1]) * (level[i + 1] - level[i]) < 0:
            sign = -1 if level[i] > level[i - 1] else 1
            best = minimize_scalar(
                lambda f, sign=sign: sign * np.log(abs(H(f))),
                bounds=(grid[i - 1], grid[i + 1]),
                method="bounded",
                options={"xatol": 1e-10},
            )
            extremes.append((sign < 0, best.x, abs(H(best.x))))
    return extremes


def published(**changes: float) -> LinearPantograph:
    values = {**PUBLISHED["DSA-380"], **changes}
    return LinearPantograph(head=values.pop("k1"), **values)


@pytest.mark.parametrize("c3", [10.0, 70.0, 200.0])
@pytest.mark.parametrize("step, offset", [(0.25, 0.0), (0.5, 0.1)])
def test_extremes_of_a_linear_pantograph_are_its_closed_forms(c3, step, offset):
    """On grids that miss its peaks by up to a quarter of a hertz, to 2e-4 Hz."""
    pantograph = published(c3=c3)
    extremes, asked = found(pantograph.receptance, np.arange(2 + offset, 14.6, step))
    truth = true_extremes(pantograph.receptance, 2 + offset, 14.5)
    assert [e.is_resonance for e in extremes] == [is_maximum for is_maximum, _, _ in truth]
    for e, (_, frequency, magnitude) in zip(extremes, truth):
        assert abs(e.frequency - frequency) < 2e-4 and abs(e.magnitude / magnitude - 1) < 1e-5
        assert e.frequency_error < 1e-3 and e.magnitude_error < 1e-4 * magnitude
        assert not e.doubt
    assert len(asked) < 130


def test_errors_of_the_points_are_part_of_what_is_said():
    """Random ones of 0.03 %: two thirds of the extremes are within the error, nearly all within three times that."""
    pantograph, random = published(), np.random.default_rng(7)
    truth = true_extremes(pantograph.receptance, 2, 14.5)
    ratios = []
    for _ in range(12):
        extremes, _ = found(lambda f: pantograph.receptance(f) * (1 + 3e-4 * random.normal()), remaining=3e-4)
        assert len(extremes) == len(truth)
        for e, (_, frequency, magnitude) in zip(extremes, truth):
            ratios += [
                abs(e.frequency - frequency) / e.frequency_error,
                abs(e.magnitude - magnitude) / e.magnitude_error,
            ]
    assert np.mean(np.array(ratios) < 1) > 0.6 and np.mean(np.array(ratios) < 3) > 0.95


def test_a_pair_between_two_points_of_the_grid_is_found():
    """A mode of little mass at 9.1 Hz, whose valley and peak are 0.1 Hz apart."""
    pantograph = published()

    def H(f):
        return pantograph.receptance(f) + 2e-6 / (1 - (f / 9.1) ** 2 + 0.005j)

    truth = true_extremes(H, 2, 14.5)
    pair = [frequency for _, frequency, _ in truth if 8.9 < frequency < 9.3]
    assert len(pair) == 2 and pair[1] - pair[0] < 0.2
    extremes, _ = found(H)
    np.testing.assert_allclose([e.frequency for e in extremes], [frequency for _, frequency, _ in truth], atol=1e-3)


def test_an_extreme_at_a_jump_says_so():
    """A peak that breaks off at 5.3 Hz, as of a spring that softens: no curve has its maximum there."""

    def H(f):
        return np.exp(-7 + f) if f < 5.3 else np.exp(-4 - f / 5)

    (peak,), asked = found(H, np.arange(2.0, 9.0, 0.25))
    assert peak.is_resonance and peak.doubt == JUMP
    assert 5.29 < peak.frequency < 5.3 and peak.frequency_error < 0.01
    assert peak.magnitude == pytest.approx(H(peak.frequency)) and len(asked) < 40


def test_an_extreme_of_points_that_did_not_settle_says_so():
    pantograph = published()
    extremes, _ = found(
        pantograph.receptance, status=lambda f: "not settled" if 6 < f < 7 else "settled", remaining=0.01
    )
    assert [e.doubt for e in extremes] == ["", "not settled", "", ""]
    assert extremes[1].magnitude_error == pytest.approx(0.01 * extremes[1].magnitude)


def test_points_without_a_response_divide_the_curve():
    pantograph = published()
    extremes, asked = found(lambda f: np.nan if 5.9 < f < 6.1 else pantograph.receptance(f))
    assert [round(e.frequency, 2) for e in extremes] == [4.11, 6.54, 11.76, 12.38]
    assert not [f for f in asked if 5.75 < f < 6.25]
    assert found(pantograph.receptance, [3.0]) == ([], []) == found(pantograph.receptance, [3.0, 4.0])


def test_an_extreme_on_a_point_of_the_grid_is_measured_about_it():
    """Symmetric, so that the vertex of every parabola is that point: it is asked for once, by the grid."""
    (peak,), asked = found(lambda f: np.exp(-((f - 5.0) ** 2)), np.arange(3.0, 7.1, 0.25))
    assert peak.frequency == pytest.approx(5.0, abs=1e-9) and peak.magnitude == pytest.approx(1.0, rel=1e-9)
    assert len(asked) == len(set(asked)) and 5.0 not in asked


def test_extremes_of_the_linear_models_are_exact(own_fmu):
    """Against a search in an independent receptance."""
    with own_fmu.instances() as (instance,):
        instance.start({"c3": 50.0})
        parameters = instance.used_parameters()
    exact = exact_extremes(linear_model(parameters, "linear"), (0.5, 20.0))
    truth = true_extremes(published(c3=50.0).receptance, 0.5, 20.0)
    for e, (is_maximum, frequency, magnitude) in zip(exact, truth, strict=True):
        assert e.is_resonance is is_maximum and e.frequency_error == e.magnitude_error == 0
        assert e.frequency == pytest.approx(frequency, rel=1e-7) and e.magnitude == pytest.approx(magnitude, rel=1e-9)


def test_the_error_of_the_step_is_added():
    """Parabolas of log |H| at 0.5 and 0.25 ms: of what is between them the step makes four thirds."""

    def about(vertex: float, level: float) -> list[FrfPoint]:
        return [
            FrfPoint(1, f, "settled", complex(np.exp(level - (f - vertex) ** 2)), remaining=0) for f in (4.9, 5, 5.1)
        ]

    coarse = Extreme(True, 5.02, 0.001, np.exp(-8), 1e-7, about=tuple(about(5.02, -8)))
    checked = coarse.checked(about(5.005, -7.99))
    assert checked.frequency_error == pytest.approx(0.001 + 4 / 3 * 0.015)
    assert checked.magnitude_error == pytest.approx(1e-7 + 4 / 3 * (np.exp(-7.99) - np.exp(-8)))
    doubtful = coarse.checked([replace(p, status="not settled") for p in about(5, -8)])
    assert doubtful.doubt == "not settled"


# On the bench


def refined(fmu: Fmu, settings: FrfSettings):
    sweep = list(measure(fmu, settings, sweeps(settings), 1, GO_ON))
    with fmu.instances() as (instance,):
        beside = list(refine(FmuBench(instance, settings.parameters), Refinement(sweep), settings, GO_ON))
    return sweep, beside


@pytest.mark.parametrize("direction", ["up", "down"])
def test_extremes_with_friction_are_those_of_a_dense_sweep(own_fmu, direction):
    """At 1 m/s2 the rods begin to slip within the resonance: a second peak beside it, hidden from a grid of 0.25 Hz."""
    parameters = own_fmu.variables.parse_assignments(["solver.step=0.0005"])
    settings = FrfSettings((1.0,), tuple(np.arange(6.0, 7.6, 0.25)), parameters, direction)
    extremes = Refinement(*refined(own_fmu, settings)).extremes()
    dense = replace(settings, frequencies=tuple(np.arange(6.5, 7.2, 0.01).round(3)), tolerance=1e-4)
    points = sorted((p for p, _ in measure(own_fmu, dense, sweeps(dense), 1, GO_ON)), key=lambda p: p.frequency)
    frequency, magnitude = np.array([(p.frequency, abs(p.H)) for p in points]).T
    tops = [i for i in range(1, len(points) - 1) if (magnitude[i] - magnitude[[i - 1, i + 1]]).min() > 0]
    assert [e.is_resonance for e in extremes] == [True, False, True]
    peaks = [extremes[0], extremes[2]]
    np.testing.assert_allclose([e.frequency for e in peaks], frequency[tops], atol=0.012)
    np.testing.assert_allclose([e.magnitude for e in peaks], magnitude[tops], rtol=2e-3)
    between = slice(*tops)
    assert extremes[1].magnitude == pytest.approx(magnitude[between].min(), rel=2e-3)


def test_an_interrupted_search_goes_on_to_the_same_bits(own_fmu):
    settings = FrfSettings(
        (1.0,), (6.0, 6.25, 6.5, 6.75, 7.0), own_fmu.variables.parse_assignments(["friction=Coulomb"])
    )
    sweep, beside = refined(own_fmu, settings)
    assert len(beside) > 5
    with own_fmu.instances() as (instance,):
        bench = FmuBench(instance, settings.parameters)
        rest = list(refine(bench, Refinement(sweep, beside[:4]), settings, GO_ON))
    assert rest == beside[4:]


class Branches:
    """A bench with two steady states between 5 and 6 Hz: the one it comes from. Its state is the branch."""

    def __init__(self):
        self.instance, self.branch, self.begun, self.harmonics = self, None, [], ()

    def get(self, names):
        return [0] * len(names)

    def start(self, frequency, _acceleration):
        self.branch = "low" if frequency < 5.5 else "high"
        self.tune(frequency, 1.0)

    def tune(self, frequency, _acceleration):
        self.begun.append((self.branch, frequency))
        if not 5 <= frequency <= 6:
            self.branch = "low" if frequency < 5 else "high"
        self.H = complex(np.exp((frequency if self.branch == "low" else 2 - frequency / 3) - 10))
        self.periods, self.change = 0, 0.0

    def run(self, periods):
        self.periods += periods

    def save(self):
        return {"branch": self.branch}

    def load(self, state):
        self.branch = state["branch"]


@pytest.mark.parametrize("direction, edge", [("up", 6.0), ("down", 5.0)])
def test_each_point_is_approached_as_the_sweep_does(direction, edge):
    """So that the peak is where the branch ends on which the sweep comes."""
    bench, settings = Branches(), FrfSettings((1.0,), tuple(np.arange(3.1, 8.0, 0.25)), direction=direction)
    (sweep,) = (list(run_sweep(bench, each, settings, GO_ON)) for each in sweeps(settings))
    beside = list(refine(bench, Refinement(sweep), settings, GO_ON))
    (peak,) = Refinement(sweep, beside).extremes()
    assert peak.doubt == JUMP and peak.is_resonance and abs(peak.frequency - edge) < 0.01
