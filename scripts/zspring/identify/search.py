"""Global search by differential evolution, which goes on after an interruption.

Every cost that was computed is kept in a file. The search is deterministic, so a search begun again asks for
the same candidates in the same order, and finds those it has had in the file.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from ..interrupt import Interrupted
from .problem import Problem
from .settings import Search


class CostRecord:
    """Costs by x, on disk at once. A file with another head, or one that cannot be read, is begun anew."""

    def __init__(self, path: Path, head: Mapping[str, str]):
        self.path = path
        self._costs: dict[bytes, float] = {}
        self.is_stale = False
        lines = []
        if path.exists():
            try:
                first, *rest = path.read_text(encoding="utf-8").splitlines(keepends=True)
                self.is_stale = json.loads(first) != dict(head)
                if not self.is_stale:
                    lines = [json.loads(line) for line in rest if line.endswith("\n")]
                    self._costs = {np.array(x).tobytes(): cost for *x, cost in lines}
            except (ValueError, TypeError):  # somebody changed the file
                lines, self._costs, self.is_stale = [], {}, True
        self.found = len(self._costs)
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(".new")
        fresh.write_text("".join(json.dumps(line) + "\n" for line in [dict(head), *lines]), encoding="utf-8")
        os.replace(fresh, path)

    def costs(self, xs: list[np.ndarray], compute: Callable[[list[np.ndarray]], np.ndarray]) -> np.ndarray:
        """Costs (len(xs),) from the record, those it has not from `compute`."""
        missing = [x for x in xs if x.tobytes() not in self._costs]
        with open(self.path, "a", encoding="utf-8") as file:
            for x, cost in zip(missing, compute(missing) if missing else ()):
                self._costs[x.tobytes()] = float(cost)
                file.write(json.dumps([*x.tolist(), float(cost)]) + "\n")
        return np.array([self._costs[x.tobytes()] for x in xs])


def search(
    problem: Problem,
    settings: Search,
    record: CostRecord,
    stop: threading.Event,
    progress: Callable[[int, float], None],
) -> np.ndarray:
    """The best x (n,) after at most the given generations, the start values among the first candidates.

    progress    is told the generation and the best cost so far
    Raises Interrupted once `stop` is set; the costs so far are in the record.
    """

    def compute(xs: list[np.ndarray]) -> np.ndarray:
        costs = problem.costs(xs)
        if stop.is_set():
            raise Interrupted(
                f"interrupted; the global search so far is kept in {record.path}; the same command goes on from there"
            )
        return costs

    def report(intermediate_result) -> None:
        nonlocal generation
        generation += 1
        progress(generation, float(intermediate_result.fun))

    generation = 0
    size = problem.start.size
    result = differential_evolution(
        lambda x: 0.0,  # never called: the workers below compute whole generations
        [(0.0, 1.0)] * size,
        maxiter=settings.generations,
        popsize=settings.population,
        rng=settings.seed,
        x0=np.clip(problem.start, 0.0, 1.0),
        tol=1e-2,
        polish=False,
        updating="deferred",
        workers=lambda _, xs: record.costs([np.array(x) for x in xs], compute),
        callback=report,
    )
    return result.x
