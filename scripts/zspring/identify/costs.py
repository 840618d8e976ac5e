"""Costs of many candidates, kept in a file.

Whoever asks is deterministic, so that after an interruption the same candidates are asked for in the same order, and
found in the file.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..interrupt import Interrupted
from ..records import Record
from .problem import Answer, Problem

Cost = tuple[tuple[float, ...], float]  # of an x


def cost_record(path: Path, head: Mapping[str, str], names: Sequence[str]) -> Record[Cost]:
    """Costs by x, the free parameters of these names between their bounds."""
    return Record(
        path,
        head,
        [*names, "cost"],
        lambda found: [*found[0], found[1]],
        lambda row: (tuple(float(row[name]) for name in names), float(row["cost"])),
    )


class Costs:
    """Those of a problem, as a function of points (k, n) that gives (k,).

    like        see Model.answers
    progress    is told the best cost so far after each candidate
    Raises Interrupted once `stop` is set; the costs so far are in the record.
    """

    def __init__(
        self,
        problem: Problem,
        like: Answer | None,
        record: Record[Cost],
        stop: threading.Event,
        progress: Callable[[float], None],
    ):
        self._problem, self._like, self._record = problem, like, record
        self._stop, self._progress = stop, progress
        self._known = dict(record.results)
        self._best = np.inf

    def __call__(self, xs: np.ndarray) -> np.ndarray:
        return np.array([self._cost(x) for x in xs])

    def _cost(self, x: np.ndarray) -> float:
        key = tuple(x.tolist())
        if key not in self._known:
            (cost,) = self._problem.costs([x], self._like)
            if self._stop.is_set():
                raise Interrupted(
                    f"interrupted; the costs are kept in {self._record.path}; the same command goes on from there"
                )
            self._known[key] = float(cost)
            self._record.append((key, float(cost)))
        self._best = min(self._best, self._known[key])
        self._progress(self._best)
        return self._known[key]
