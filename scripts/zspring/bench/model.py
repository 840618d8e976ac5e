"""The FMU's answer to a measurement: its own bench at the measured frequencies and amplitudes."""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from ..fmu import FmuError, Instance, StepDiscarded
from ..variables import Value
from .conditions import FILE_ORDER
from .curves import Curve
from .fmu_bench import FmuBench
from .measure import settle
from .points import FAILED, FrfSettings
from .responses import HARMONICS
from .static_test import StaticTest

Periods = tuple[int, ...]  # for each point of a curve

# How far a point may be from its steady state: far below any measurement.
SETTLED = FrfSettings(tolerance=2e-4)


@dataclass(frozen=True)
class Simulated:
    """Of one curve; NaN where it failed."""

    H: np.ndarray  # (n,) m/N
    harmonics: np.ndarray  # (n, 6) N, peaks of HARMONICS of the contact force
    periods: Periods  # that it took


class BenchModel:
    """Measures candidates, each curve on an instance of its own, as many at a time as there are instances.

    direction   "file": the points of a curve as they stand, "up" or "down" by frequency, or "rest": each from
                the static state
    Once `stop` is set, nothing is measured any more and all answers are NaN.
    """

    def __init__(self, instances: Sequence[Instance], direction: str, stop: threading.Event):
        self._direction, self._stop = direction, stop
        self._idle: queue.SimpleQueue[Instance] = queue.SimpleQueue()
        for instance in instances:
            self._idle.put(instance)
        self._pool = ThreadPoolExecutor(len(instances))

    def check(self, parameters: Mapping[str, Value]) -> None:
        """Raises FmuError when the FMU refuses the parameters."""
        instance = self._idle.get()
        try:
            FmuBench(instance, parameters).start(1.0, 0.0)
        finally:
            self._idle.put(instance)

    def receptances(
        self,
        candidates: Sequence[Mapping[str, Value]],
        curves: Sequence[Curve],
        periods: Sequence[Periods] | None = None,
    ) -> list[list[Simulated]]:
        """For each candidate what it has for each curve.

        periods     of each curve: run every point for so many instead of until it is steady. The answer then
                    depends smoothly on the parameters, which differences need.
        """
        schedule: Sequence[Periods | None] = periods or [None] * len(curves)
        tasks = [
            [self._pool.submit(self._sweep, parameters, *item) for item in zip(curves, schedule)]
            for parameters in candidates
        ]
        return [[task.result() for task in row] for row in tasks]

    def static_forces(self, candidates: Sequence[Mapping[str, Value]], test: StaticTest) -> list[np.ndarray]:
        """For each candidate the forces (n,) in N of a static test, NaN if it failed."""
        tasks = [self._pool.submit(self._static, parameters, test) for parameters in candidates]
        return [task.result() for task in tasks]

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)

    def _sweep(self, parameters: Mapping[str, Value], curve: Curve, periods: Periods | None) -> Simulated:
        H, used = np.full(curve.frequency.shape, math.nan + 0j), [0] * curve.frequency.size
        harmonics = np.full((len(used), len(HARMONICS)), math.nan)
        order = np.argsort(curve.frequency, kind="stable")[:: -1 if self._direction == "down" else 1]
        if self._direction == FILE_ORDER:
            order = np.arange(len(used))
        instance = self._idle.get()
        try:
            bench, is_running = FmuBench(instance, parameters), False
            for i in order.tolist():
                frequency, acceleration = float(curve.frequency[i]), float(curve.acceleration[i])
                (bench.tune if is_running else bench.start)(frequency, acceleration)
                if periods and periods[i]:
                    is_running = self._run(bench, periods[i])
                    if is_running:
                        H[i], used[i], harmonics[i] = bench.H, bench.periods, bench.harmonics
                else:
                    point = settle(bench, acceleration, frequency, SETTLED, self._stop)
                    if point is None:
                        break
                    is_running = not point.status.startswith(FAILED)
                    if is_running:
                        H[i], used[i], harmonics[i] = point.H, point.periods, bench.harmonics
                if self._stop.is_set():
                    break
                is_running = is_running and self._direction != "rest"
        except FmuError:  # refused parameters
            pass
        finally:
            self._idle.put(instance)
        return Simulated(H, harmonics, tuple(used))

    def _run(self, bench: FmuBench, periods: int) -> bool:
        """For so many whole periods; False if it failed."""
        try:
            while not bench.periods:
                bench.run(1)  # the ramp
            if bench.periods < periods:
                bench.run(periods - bench.periods)
        except StepDiscarded:
            return False
        return True

    def _static(self, parameters: Mapping[str, Value], test: StaticTest) -> np.ndarray:
        instance = self._idle.get()
        try:
            if self._stop.is_set():
                raise FmuError("stopped")
            return test.simulated(instance, parameters)
        except FmuError:
            return np.full(test.force.shape, math.nan)
        finally:
            self._idle.put(instance)
