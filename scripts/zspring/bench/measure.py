"""First-order FRF by stepped sine with controlled response: every point is run until it is steady.

H = -Z/F with Z and F the components at the drive frequency of head displacement and contact force. The head's
peak acceleration is the amplitude, so that its displacement peak is amplitude / (2 pi f)^2. It is given, follows from a
peak of velocity or displacement, or is found by iteration for a peak of the force (`control`).
"""

from __future__ import annotations

import cmath
import math
import queue
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TypeVar

from ..fmu import Fmu, StepDiscarded
from .control import JUMPS, STROKE, acceleration_at, holding
from .fmu_bench import FmuBench
from .input_bench import InputBench
from .points import FAILED, LEFT_OUT, NOT_HELD, NOT_SETTLED, REPEATS, SETTLED, FrfPoint, FrfSettings, Kept, Sweep
from .steady import LOOK_PERIODS, mean_response, repeats_after

Bench = FmuBench | InputBench
BENCHES: dict[str, type[Bench]] = {"bench": FmuBench, "inputs": InputBench}
BENCH_PARAMETERS = ("drive", "bench.frequency", "bench.acceleration")  # set by the measurement itself

Task = TypeVar("Task")
Result = TypeVar("Result")


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
        if settings.control == "force":
            if not state:
                bench.start(frequency, 0.0)
            point = _hold(bench, sweep.level, frequency, settings, stop)
        else:
            go = bench.tune if state else bench.start
            acceleration = acceleration_at(sweep.level, settings.unit, frequency)
            go(frequency, acceleration)
            point = settle(bench, acceleration, frequency, settings, stop)
        if point is None:
            return
        keep = settings.direction != "rest" and not point.status.startswith(FAILED)
        state = bench.save() if keep else None
        yield replace(point, level=sweep.level, unit=settings.unit), state


def _hold(
    bench: Bench, level: float, frequency: float, settings: FrfSettings, stop: threading.Event
) -> FrfPoint | None:
    """Settle with one acceleration after the other until the force has the level (N); None if stopped before.

    The first one is that of the point before, or, from rest, as if all masses moved alike. Where the force jumps over
    the level, the nearest state.
    """
    before, *masses = bench.instance.get(["bench.acceleration", "m1", "m2", "m3"])
    first = before or level / sum(masses)
    most = settings.stroke * (2 * math.pi * frequency) ** 2
    asking, tries, why = holding(level, first, most, settings.tolerance), [], ""
    try:
        acceleration = next(asking)
        while True:
            bench.tune(frequency, acceleration)
            point = settle(bench, acceleration, frequency, settings, stop)
            if point is None:
                return None
            tries.append(point)
            if point.status.startswith(FAILED):
                break
            acceleration = asking.send(point.force)
    except StopIteration as end:
        why = end.value
    point = tries[-1]
    if why == STROKE:
        point = FrfPoint(point.amplitude, frequency, LEFT_OUT)
    elif why:
        point = min(tries, key=lambda p: abs(math.log(p.force / level)))
        reason = f"{len(tries)} tries"
        if why == JUMPS:
            below, above = ([p.force for p in tries if (p.force > level) is larger][-1] for larger in (False, True))
            reason = f"the force jumps from {below:.3g} to {above:.3g} N"
        point = replace(point, status=f"{NOT_HELD}: {reason}")
    elif len(tries) > 1 and not point.status.startswith(FAILED):  # what is left of the way to the level, in H
        by_force = abs(cmath.log(point.H / tries[-2].H)) / abs(math.log(point.force / tries[-2].force))
        point = replace(point, remaining=point.remaining + by_force * abs(math.log(point.force / level)))
    used = {name: sum(getattr(p, name) for p in tries) for name in ("steps", "iterations", "refinements")}
    return replace(point, **used)


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
