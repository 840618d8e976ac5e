"""First-order FRF by stepped sine with controlled response: every point is run until it is steady.

H = -Z/F with Z and F the components at the drive frequency of head displacement and contact force. The head's
peak acceleration is the amplitude, so that its displacement peak is amplitude / (2 pi f)^2.
"""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from ..fmu import Fmu, StepDiscarded
from ..variables import Value, exact
from .fmu_bench import HARMONICS, FmuBench
from .input_bench import InputBench
from .steady import LOOK_PERIODS, mean_response, repeats_after

Bench = FmuBench | InputBench
BENCHES: dict[str, type[Bench]] = {"bench": FmuBench, "inputs": InputBench}
BENCH_PARAMETERS = ("drive", "bench.frequency", "bench.acceleration")  # set by the measurement itself

SETTLED, NOT_SETTLED, LEFT_OUT, FAILED = "settled", "not settled", "left out", "failed"
REPEATS = "period"  # with a number: steady, but it repeats only after so many periods of the drive


@dataclass(frozen=True)
class FrfSettings:
    """What to measure, by default the standard figure; everything here changes the numbers."""

    amplitudes: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)  # m/s2, peak acceleration
    frequencies: tuple[float, ...] = tuple(i / 4 for i in range(2, 81))  # Hz, ascending
    parameters: Mapping[str, Value] = field(default_factory=dict)  # of the FMU
    direction: str = "up"  # "up", "down", or "rest": each point from the static state; a plan may say "both"
    through: str = "bench"  # key of BENCHES
    tolerance: float = 1e-3  # largest relative distance of H from its steady state, see settle
    min_periods: int = 8
    max_periods: int = 400
    stroke: float = 0.1  # m, largest displacement peak

    def described(self) -> dict[str, str]:
        """All but the parameters as text, by key."""
        return {
            "H": "-Z/F, components at the drive frequency of head displacement Z and contact force F",
            "through": self.through,
            "direction": self.direction,
            "amplitudes": " ".join(map(exact, self.amplitudes)) + " m/s2",
            "frequencies": " ".join(map(exact, self.frequencies)) + " Hz",
            "tolerance": exact(self.tolerance),
            "periods": f"{self.min_periods} to {self.max_periods}",
            "stroke": f"{exact(self.stroke)} m",
        }


@dataclass(frozen=True)
class FrfPoint:
    """One point; H in m/N and what is told of it are NaN where nothing was measured, and where it failed.

    H and loss are of the last period, or of the last k together with the status "period k"; harmonics are of the last.
    """

    amplitude: float  # m/s2
    frequency: float  # Hz
    status: str
    H: complex = complex(math.nan, math.nan)
    periods: int = 0
    change: float = math.nan
    steps: int = 0  # internal steps, Newton iterations and step halvings this point took
    iterations: int = 0
    refinements: int = 0
    iterations_max: int = 0  # of the worst step since the sweep began
    remaining: float = math.nan  # estimated distance of H from its steady state, relative to H
    harmonics: tuple[float, ...] = (math.nan,) * len(HARMONICS)  # N, peaks of the contact force's
    loss: float = math.nan  # J, what the FMU dissipates in a cycle, pi Z^2 Im(1/H) in the steady state

    @property
    def displacement(self) -> float:
        """Peak displacement of the head in m."""
        omega = 2 * math.pi * self.frequency
        return self.amplitude / omega / omega  # whose square may be beyond what numbers can be

    @property
    def force(self) -> float:
        """Peak of the contact force's first harmonic in N."""
        return self.displacement / abs(self.H) if self.H else math.nan

    @property
    def stiffness(self) -> float:
        """Equivalent one of all that the head feels, inertia included, in N/m: k of 1/H = k + i omega c."""
        return (1 / self.H).real if self.H else math.nan

    @property
    def damping(self) -> float:
        """Equivalent one in N.s/m: c of 1/H, from the loss, which is known far better where inertia is all of 1/H."""
        return self.loss / (2 * math.pi**2 * self.frequency * self.displacement**2)


@dataclass(frozen=True)
class Sweep:
    """Points that one instance measures one after the other, from `state` of the bench or from rest."""

    amplitude: float
    frequencies: tuple[float, ...]
    state: Mapping[str, Any] | None = None


Kept = tuple[FrfPoint, Mapping[str, Any] | None]  # with the bench's state; None: the next point starts from rest
Task = TypeVar("Task")
Result = TypeVar("Result")


def differences(some: Sequence[FrfPoint], others: Sequence[FrfPoint]) -> dict[tuple[float, float], float]:
    """How far H of others is from that of some, relatively, by amplitude and frequency, where both have one."""
    H = {(p.amplitude, p.frequency): p.H for p in others}
    found = {(p.amplitude, p.frequency): abs(H.get((p.amplitude, p.frequency), math.nan) / p.H - 1) for p in some}
    return {place: difference for place, difference in found.items() if math.isfinite(difference)}


def left_out(settings: FrfSettings) -> list[FrfPoint]:
    """The points that need more stroke than there is."""
    points = (FrfPoint(a, f, LEFT_OUT) for a in settings.amplitudes for f in settings.frequencies)
    return [point for point in points if point.displacement > settings.stroke]


def sweeps(settings: FrfSettings) -> list[Sweep]:
    """All sweeps of the figure: one for each amplitude, or one for each point with direction "rest"."""
    result = []
    for amplitude in settings.amplitudes:
        frequencies = tuple(
            f for f in settings.frequencies if FrfPoint(amplitude, f, "").displacement <= settings.stroke
        )
        if settings.direction == "rest":
            result += [Sweep(amplitude, (frequency,)) for frequency in frequencies]
        elif frequencies:
            result.append(Sweep(amplitude, frequencies if settings.direction == "up" else frequencies[::-1]))
    return result


def measure(fmu: Fmu, settings: FrfSettings, todo: list[Sweep], jobs: int, stop: threading.Event) -> Iterator[Kept]:
    """The points of all these sweeps as they get ready, see `at_a_time`."""
    return at_a_time(run_sweep, fmu, settings, todo, jobs, stop)


def at_a_time(
    run: Callable[[Bench, Task, FrfSettings, threading.Event], Iterator[Result]],
    fmu: Fmu,
    settings: FrfSettings,
    todo: list[Task],
    jobs: int,
    stop: threading.Event,
) -> Iterator[Result]:
    """The points of all tasks as they get ready.

    `jobs` tasks run at a time, each on an instance of its own. Ends early once `stop` is set.
    Raises FmuError when the FMU refuses a parameter.
    """
    waiting: queue.SimpleQueue = queue.SimpleQueue()
    finished: queue.SimpleQueue = queue.SimpleQueue()
    for task in todo:
        waiting.put(task)

    def work(bench: Bench) -> None:
        try:
            while not stop.is_set():
                for result in run(bench, waiting.get_nowait(), settings, stop):
                    finished.put(result)
        except queue.Empty:
            pass
        except BaseException as error:
            finished.put(error)
        finally:
            finished.put(None)

    jobs = max(1, min(jobs, len(todo)))
    with fmu.instances(jobs) as instances, ThreadPoolExecutor(jobs) as pool:
        for instance in instances:
            pool.submit(work, BENCHES[settings.through](instance, settings.parameters))
        try:
            running = jobs
            while running:
                result = finished.get()
                if result is None:
                    running -= 1
                elif isinstance(result, BaseException):
                    raise result
                else:
                    yield result
        except BaseException:
            stop.set()
            raise


def run_sweep(bench: Bench, sweep: Sweep, settings: FrfSettings, stop: threading.Event) -> Iterator[Kept]:
    """The points of one sweep, until `stop` is set; after a failed one it goes on from rest."""
    state = sweep.state
    if state:
        bench.load(state)
    for frequency in sweep.frequencies:
        go = bench.tune if state else bench.start
        go(frequency, sweep.amplitude)
        point = settle(bench, sweep.amplitude, frequency, settings, stop)
        if point is None:
            return
        keep = settings.direction != "rest" and not point.status.startswith(FAILED)
        state = bench.save() if keep else None
        yield point, state


def settle(
    bench: Bench, amplitude: float, frequency: float, settings: FrfSettings, stop: threading.Event
) -> FrfPoint | None:
    """Run until H is steady or the most periods allowed have passed; None if stopped before.

    Steady: H repeats within the tolerance, see `repeats_after`, seldom after some periods of the drive only.
    """
    counters = ("solver.steps", "solver.iterations", "solver.refinements")
    before = bench.instance.get(counters)
    fewest = max(settings.min_periods, 2 * LOOK_PERIODS)
    status, repeat, value, change, left = NOT_SETTLED, 0, complex(math.nan, math.nan), math.nan, math.nan
    harmonics, loss = FrfPoint.harmonics, math.nan
    H: list[complex] = []  # by period, after the ramp
    dissipated: list[float] = []  # J, at the ends of periods, of those of the ramp as well
    try:
        while not repeat and len(H) < settings.max_periods:
            if stop.is_set():
                return None
            bench.run(1)
            dissipated += bench.instance.get(["energy.dissipated"])
            if bench.periods:
                H.append(bench.H)
            if len(H) == settings.max_periods or (len(H) >= fewest and len(H) % LOOK_PERIODS == 0):
                repeat, left = repeats_after(H, settings.tolerance)
        if repeat:
            status = SETTLED if repeat == 1 else f"{REPEATS} {repeat}"
        last = max(1, repeat)
        value, change = mean_response(H[-last:]), bench.change
        harmonics, loss = bench.harmonics, (dissipated[-1] - dissipated[-1 - last]) / last
    except StepDiscarded as error:
        status, left = f"{FAILED}: {error}", math.nan
    steps, iterations, refinements = (int(b - a) for a, b in zip(before, bench.instance.get(counters)))
    (worst,) = map(int, bench.instance.get(["solver.iterations_max"]))
    point = FrfPoint(amplitude, frequency, status, value, bench.periods, change, steps, iterations, refinements)
    return replace(point, iterations_max=worst, remaining=left, harmonics=harmonics, loss=loss)
