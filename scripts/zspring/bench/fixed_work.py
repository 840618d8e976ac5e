"""A fixed amount of work over a figure: every point from rest through one communication step.

Unlike `measure`, which stops where the response is steady; so solvers and settings can be compared.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..fmu import Instance, StepDiscarded
from ..variables import Value
from .points import FrfSettings, sweeps

PERIODS = 30
COUNTERS = ["solver.steps", "solver.iterations", "solver.iterations_max", "solver.refinements"]

Point = tuple[float, float]  # amplitude in m/s2, frequency in Hz


@dataclass(frozen=True)
class Work:
    """What the points cost and gave."""

    H: np.ndarray  # (points,) in m/N, NaN where the step was discarded
    counts: np.ndarray  # (points, 4), as COUNTERS
    seconds: np.ndarray  # (points,)

    @property
    def discarded(self) -> np.ndarray:
        """(points,) whether the step was discarded."""
        return np.isnan(self.H)


def figure_points(settings: FrfSettings) -> list[Point]:
    """The points of a figure that its stroke allows."""
    return [(sweep.level, frequency) for sweep in sweeps(settings) for frequency in sweep.frequencies]


def run_points(instance: Instance, parameters: Mapping[str, Value], points: Iterable[Point]) -> Work:
    """Run PERIODS periods of every point on the bench of the FMU. Raises FmuError for a refused parameter."""
    fixed = {**parameters, **instance.variables.parse_assignments(["drive=Bench"])}
    H, counts, seconds = [], [], []
    for amplitude, frequency in points:
        begin = time.perf_counter()
        instance.start({**fixed, "bench.frequency": frequency, "bench.acceleration": amplitude})
        try:
            instance.step(0, PERIODS / frequency)
            H.append(complex(*instance.get(["bench.H_re", "bench.H_im"])))
        except StepDiscarded:
            H.append(complex(np.nan, np.nan))
        counts.append(instance.get(COUNTERS))
        seconds.append(time.perf_counter() - begin)
    return Work(np.array(H), np.array(counts), np.array(seconds))
