"""Work of Newton's method by tangent, over the points of a figure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from zspring.bench.fixed_work import Point, run_points
from zspring.fmu import Instance
from zspring.variables import Value


@dataclass(frozen=True)
class TangentWork:
    """Sums over the points of one amplitude, or over all (amplitude None)."""

    law: str
    tangent: str
    tau: float  # s
    amplitude: float | None  # m/s2
    points: int
    steps: int
    iterations: int
    iterations_max: int  # of one step
    halvings: int  # steps that did not converge and were halved
    discards: int  # points that were given up
    seconds: float

    @property
    def iterations_per_step(self) -> float:
        return self.iterations / self.steps if self.steps else math.nan

    @property
    def halved_percent(self) -> float:
        return 100 * self.halvings / self.steps if self.steps else math.nan


def tangent_work(
    instance: Instance, parameters: Mapping[str, Value], law: str, tangent: str, tau: float, points: Sequence[Point]
) -> list[TangentWork]:
    """Work by amplitude, ascending; law and tangent by name, tau in s. Points are sorted by amplitude."""
    chosen = instance.variables.parse_assignments([f"friction={law}", f"solver.tangent={tangent}"])
    result = []
    for amplitude, group in groupby(points, key=lambda point: point[0]):
        work = run_points(instance, {**parameters, **chosen, "zspring.tau": tau}, group)
        steps, iterations, _, halvings = (int(n) for n in work.counts.sum(axis=0))
        result.append(
            TangentWork(
                law,
                tangent,
                tau,
                amplitude,
                len(work.H),
                steps,
                iterations,
                int(work.counts[:, 2].max()),
                halvings,
                int(work.discarded.sum()),
                float(work.seconds.sum()),
            )
        )
    return result


def total(works: Sequence[TangentWork]) -> TangentWork:
    """All amplitudes of one tangent together."""
    first = works[0]
    return TangentWork(
        first.law,
        first.tangent,
        first.tau,
        None,
        sum(w.points for w in works),
        sum(w.steps for w in works),
        sum(w.iterations for w in works),
        max(w.iterations_max for w in works),
        sum(w.halvings for w in works),
        sum(w.discards for w in works),
        sum(w.seconds for w in works),
    )
