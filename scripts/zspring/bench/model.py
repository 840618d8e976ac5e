"""The FMU's answer to a measurement: its own bench at the measured frequencies and amplitudes."""

from __future__ import annotations

import math
import queue
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from ..fmu import FmuError, Instance
from ..variables import Value
from .conditions import FILE_ORDER
from .curves import Curve
from .fmu_bench import FmuBench
from .measure import FAILED, FrfSettings, settle
from .static_test import StaticTest

Periods = tuple[int, ...]  # for each point of a curve

# How far a point may be from its steady state: far below any measurement.
SETTLED = FrfSettings(tolerance=2e-4)


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
    ) -> list[list[tuple[np.ndarray, Periods]]]:
        """For each candidate and each curve: H (n,) in m/N, NaN where it failed, and the periods it took.

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

    def _sweep(
        self, parameters: Mapping[str, Value], curve: Curve, periods: Periods | None
    ) -> tuple[np.ndarray, Periods]:
        H, used = np.full(curve.frequency.shape, math.nan + 0j), [0] * curve.frequency.size
        order = np.argsort(curve.frequency, kind="stable")[:: -1 if self._direction == "down" else 1]
        if self._direction == FILE_ORDER:
            order = np.arange(len(used))
        instance = self._idle.get()
        try:
            bench, is_running = FmuBench(instance, parameters), False
            for i in order.tolist():
                frequency, acceleration = float(curve.frequency[i]), float(curve.acceleration[i])
                (bench.tune if is_running else bench.start)(frequency, acceleration)
                settings = SETTLED
                if periods:
                    settings = replace(SETTLED, tolerance=math.inf, min_periods=periods[i])
                point = settle(bench, acceleration, frequency, settings, self._stop)
                if point is None:
                    break
                failed = point.status.startswith(FAILED)
                is_running = self._direction != "rest" and not failed
                if not failed:
                    H[i], used[i] = point.H, point.periods
        except FmuError:  # refused parameters
            pass
        finally:
            self._idle.put(instance)
        return H, tuple(used)

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
