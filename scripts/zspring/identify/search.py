"""Global search by differential evolution, which goes on after an interruption.

Every cost that was computed is kept in a file. The search is deterministic, so a search begun again asks for
the same candidates in the same order, and finds those it has had in the file.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from ..interrupt import Interrupted
from ..records import Record
from .problem import Problem
from .settings import Search

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


def search(
    problem: Problem,
    settings: Search,
    record: Record[Cost],
    stop: threading.Event,
    progress: Callable[[int, float], None],
) -> np.ndarray:
    """The best x (n,) after at most the given generations, the start values among the first candidates.

    progress    is told the generation and the best cost so far
    Raises Interrupted once `stop` is set; the costs so far are in the record.
    """

    known = dict(record.results)

    def compute(xs: list[np.ndarray]) -> np.ndarray:
        missing = [x for x in xs if tuple(x.tolist()) not in known]
        costs = problem.costs(missing) if missing else ()
        if stop.is_set():
            raise Interrupted(
                f"interrupted; the global search so far is kept in {record.path}; the same command goes on from there"
            )
        for x, cost in zip(missing, costs):
            known[tuple(x.tolist())] = float(cost)
            record.append((tuple(x.tolist()), float(cost)))
        return np.array([known[tuple(x.tolist())] for x in xs])

    generation = 0

    def report(intermediate_result) -> None:
        nonlocal generation
        generation += 1
        progress(generation, float(intermediate_result.fun))

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
        workers=lambda _, xs: compute([np.array(x) for x in xs]),
        callback=report,
    )
    return result.x
