"""Where least squares begin: the best of a Sobol sequence, which goes on after an interruption.

Every cost that was computed is kept in a file. The sequence is deterministic, so a search begun again asks for
the same candidates in the same order, and finds those it has had in the file.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from ..interrupt import Interrupted
from ..records import Record
from .problem import Problem
from .settings import Search

Cost = tuple[tuple[float, ...], float]  # of an x

APART = 0.1  # of the range of any parameter: starts of which neither leads where the other does


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
    problem: Problem, settings: Search, record: Record[Cost], stop: threading.Event, progress: Callable[[float], None]
) -> list[np.ndarray]:
    """Where least squares begin: x (n,), the best first, apart from one another and from the start values.

    The sequence fills the space between the bounds evenly (Sobol 1967, scrambled by the seed).
    progress    is told the best cost so far after each candidate
    Raises Interrupted once `stop` is set; the costs so far are in the record.
    """
    known = dict(record.results)
    count = settings.candidates(problem.start.size)
    xs = qmc.Sobol(problem.start.size, rng=settings.seed).random_base2(count.bit_length() - 1)
    best = np.inf
    for x in xs:
        key = tuple(x.tolist())
        if key not in known:
            (cost,) = problem.costs([x])
            if stop.is_set():
                raise Interrupted(
                    f"interrupted; the search so far is kept in {record.path}; the same command goes on from there"
                )
            known[key] = float(cost)
            record.append((key, float(cost)))
        best = min(best, known[key])
        progress(best)
    starts: list[np.ndarray] = []
    for x in sorted(xs, key=lambda x: known[tuple(x.tolist())]):
        is_apart = all(np.max(np.abs(x - other)) > APART for other in (problem.start, *starts))
        if is_apart and len(starts) < settings.starts:
            starts.append(x)
    return starts
