"""The stages of an identification: each shows a progress bar, writes to the log, and ends with Ctrl-C."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..bench.curves import Curve
from ..fmu import Fmu
from ..interrupt import Interrupted
from ..variables import Value
from .choice import Candidate, others
from .costs import Costs, cost_record
from .files import fit_head
from .fit import Fit, fit
from .posterior import Posterior, sample
from .problem import Answer, Model, Problem
from .profile import profile_interval
from .report import SHARE
from .search import search

PARTIAL = SEARCH, POSTERIOR = "search.partial.csv", "posterior.partial.csv"
FINE = 100  # points of a drawn curve
WORSE = 1.1  # times the cost: another minimum


class Log:
    """The log of the run: a file, with the time of each entry."""

    def __init__(self, path: Path):
        self._file = open(path, "w", encoding="utf-8", newline="\n")

    def write(self, text: str) -> None:
        """To the file alone."""
        time_of_day = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        self._file.write(f"{time_of_day}  {text}\n")
        self._file.flush()

    def say(self, text: str) -> None:
        """To the file and to standard output."""
        self._file.write(f"{text}\n")
        print(text)

    def __enter__(self) -> Log:
        return self

    def __exit__(self, *_) -> None:
        self._file.close()


@dataclass(frozen=True)
class Stages:
    """Of one identification; all raise Interrupted once `stop` is set.

    folder  of what goes on after an interruption
    """

    fmu: Fmu
    folder: Path
    stop: threading.Event
    log: Log

    def search(self, problem: Problem) -> np.ndarray:
        """Where to begin the fit.

        On a part of the points: the search, then least squares from the start values and from its best.
        """
        settings = problem.settings
        coarse = problem.thinned(settings.search.points)
        count = settings.search.candidates(problem.start.size)
        with self._costs(coarse, coarse.rough, SEARCH, count, "search") as costs:
            found = search(problem.start, settings.search, costs)
        names = ["the start values", *(f"start {i} of the search" for i in range(1, len(found) + 1))]
        fits = {
            name: self.fit(coarse, x, f"least squares on a part, from {name}")
            for name, x in zip(names, [problem.start, *found])
        }
        best = min(fits, key=lambda name: fits[name].cost)
        for name, other in fits.items():
            if other.cost > WORSE * fits[best].cost + 1e-9:
                self.log.say(
                    f"from {name} least squares end in a worse minimum (cost {other.cost:.4g}) than from {best} "
                    f"({fits[best].cost:.4g})"
                )
        return fits[best].x

    @contextmanager
    def _costs(self, problem: Problem, like: Answer | None, name: str, total: int, what: str) -> Iterator[Costs]:
        """Costs of so many candidates, kept in a file, with a progress bar."""
        record = cost_record(self.folder / name, fit_head(self.fmu, problem.settings), list(problem.settings.free))
        if record.results:
            print(f"going on after {len(record.results)} candidates in {record.path}")
        with record, tqdm(total=total, desc=what, unit=" candidates", disable=None) as bar:

            def progress(cost: float) -> None:
                bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
                bar.update()

            yield Costs(problem, like, record, self.stop, progress)

    def posterior(self, problem: Problem, result: Fit) -> Posterior:
        """Draws from the posterior."""
        settings = problem.settings.uncertainty
        with self._costs(problem, result.answer, POSTERIOR, settings.draws, "posterior") as costs:
            posterior = sample(problem, result, settings.draws, settings.seed, costs)
        self.log.write(f"posterior: effective sample size {posterior.effective:.3g} of {posterior.drawn} draws")
        return posterior

    def profiles(self, problem: Problem, result: Fit) -> list[tuple[float, float]]:
        """Intervals in x of all parameters by profile likelihood, with a progress bar."""
        intervals = []
        with tqdm(desc="profiles", unit=" evaluations", disable=None) as bar:

            def progress(cost: float) -> None:
                self._check()
                bar.update()

            for i, name in enumerate(problem.settings.free):
                intervals.append(profile_interval(problem, result, i, SHARE, progress))
                self._check()
                self.log.write(f"profile of {name}: {intervals[-1]} between its bounds")
        return intervals

    def others(self, problem: Problem, result: Fit, defaults: Mapping[str, Value], model: Model) -> list[Candidate]:
        """The other models, each fitted from where this one ended, or from its own start values."""
        found = []
        for name, settings in others(self.fmu, problem.settings, defaults).items():
            other = Problem(settings, model, problem.curves, problem.static)
            found_x = dict(zip(problem.settings.free, result.x))
            x = np.array([found_x.get(name, at) for name, at in zip(settings.free, other.start)])
            found.append(Candidate(name, other, self.fit(other, x, name)))
        return found

    def _check(self) -> None:
        """Raises Interrupted after Ctrl-C: answers are NaN from then on."""
        if self.stop.is_set():
            raise Interrupted("interrupted; the same command goes on after the search")

    def fit(self, problem: Problem, x: np.ndarray, name: str) -> Fit:
        """Least squares from x (n,), with a progress bar."""
        with tqdm(desc=name, unit=" evaluations", disable=None) as bar:

            def progress(cost: float) -> None:
                self._check()
                self.log.write(f"{name}: cost {cost:.6g}")
                bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
                bar.update()

            result = fit(problem, x, progress)
            self._check()  # answers of the last Jacobian may be NaN
            return result

    def drawn(self, problem: Problem, model: Model, result: Fit) -> list[Curve]:
        """What the fitted model has at and between the points. Raises Interrupted after Ctrl-C."""
        fine = [replace(curve, H=H).refined(FINE) for curve, H in zip(problem.curves, result.answer.curves)]
        between = [curve.at(np.isnan(curve.H)) for curve in fine]
        (answer,) = model.with_curves(between).answers([problem.settings.parameters(result.x)])
        self._check()
        for curve, H in zip(fine, answer.curves):
            curve.H[np.isnan(curve.H)] = H
        return fine
