"""Runs along lines in processes of their own, each of which opens the FMUs once."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import ZSpringError
from ..fmu import Fmu
from ..interrupt import held_back
from ..line.journey import Journey
from ..line.mean_force import uplifts_for
from ..line.result import LineResult, write_result
from ..line.run import run_line
from ..line.schemes import Coupling
from ..line.statistics import Statistics, statistics
from ..line.system import System, watching
from .plan import Run


@dataclass(frozen=True)
class Finished:
    """What a run came to."""

    key: str  # of the run
    told: tuple[str, ...]  # group, of, label, speed in km/h, section
    statistics: Statistics  # of the leading pantograph, or the only one
    by_span: tuple[Statistics, ...]  # the same of each span of the section
    uplift: float  # N, as chosen for a mean force, or as given
    seconds: float  # of CPU
    trailing: Statistics | None = None  # of a trailing pantograph
    trailing_uplift: float = math.nan  # N


def run_all(
    runs: Sequence[Run], catenary: Path, pantograph: Path, folder: Path, jobs: int, stop: threading.Event
) -> Iterator[Finished]:
    """Runs as they finish, `jobs` at a time. Once `stop` is set none is begun, and those begun still finish.

    folder      where the series of the runs that keep theirs are written
    Raises ZSpringError with the name of a run that fails; others that were begun are lost.
    """
    waiting = list(runs)
    if not waiting:
        return
    jobs = min(jobs, len(waiting))
    context = multiprocessing.get_context("spawn")  # fork is not safe beside threads, and Windows has none
    with ProcessPoolExecutor(jobs, context, _open, (catenary, pantograph)) as pool:
        busy: set[Future[Finished]] = set()
        while busy or (waiting and not stop.is_set()):
            while waiting and len(busy) < jobs and not stop.is_set():
                with held_back():  # submitting starts processes, which are no business of Ctrl-C
                    busy.add(pool.submit(_execute, waiting.pop(0), folder))
            done, busy = wait(busy, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in done:
                try:
                    yield future.result()
                except BrokenProcessPool:
                    raise ZSpringError("a process of the runs was ended from outside") from None


OF_RUN = "run"  # in the head of a series: the key of the run that it is of
_fmus: list[Fmu] = []  # of this process: catenary, pantograph


def _open(catenary: Path, pantograph: Path) -> None:
    """Make ready a process. Ctrl-C, which reaches all processes, is the first one's business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _fmus[:] = Fmu(catenary), Fmu(pantograph)


def _execute(run: Run, folder: Path) -> Finished:
    """One run; its series goes to a file that is whole or not there. Raises ZSpringError naming the run."""
    catenary, pantograph = run.on(_fmus[0]), _fmus[1]
    count = 2 if run.spacing else 1
    line = {**run.line, **watching(catenary, (*run.points, *run.section.middles))}
    journey = Journey(run.speed / 3.6, run.start, run.stop, run.step, run.spacing, run.start_up)
    results: list[LineResult] = []
    found: list[Statistics] = []

    def means(uplifts: tuple[float, ...]) -> list[float]:
        lifted = replace(journey, uplift=uplifts)
        system = System(catenary, pantograph, line, [run.pantograph] * count, lifted, Coupling(run.scheme))
        results.append(run_line(system))
        found[:] = [statistics(results[-1].series(i), run.section) for i in range(count)]
        return [each["mean_force"] for each in found]

    try:
        uplift: tuple[float, ...] = (run.uplift,) * count
        if run.mean_force is None:
            means(uplift)
        else:
            uplift = uplifts_for(run.mean_force, uplift, means)
        series = results[-1].series(0)
        by_span = tuple(statistics(series, span) for span in run.section.single_spans())
    except ZSpringError as error:
        raise ZSpringError(f"{run.of}, {run.label}, {run.speed:g} km/h: {error}") from None
    if run.series:
        path = folder / run.series
        unfinished = path.with_name(f"unfinished-{path.name}")
        write_result(replace(results[-1], settings={**results[-1].settings, OF_RUN: run.key}), unfinished)
        os.replace(unfinished, path)
    told = run.group, run.of, run.label, repr(run.speed), str(run.section)
    seconds = sum(result.elapsed for result in results)
    trailing = (found[1], uplift[1]) if count > 1 else ()
    return Finished(run.key, told, found[0], by_span, uplift[0], seconds, *trailing)
