"""A study's cases on a Dask cluster, whose workers may die."""

from __future__ import annotations

import copyreg
import pickle
import queue
import sys
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache

import cloudpickle
from distributed import CancelledError, Client, Future, KilledWorker, TimeoutError, get_worker
from distributed.diagnostics.plugin import WorkerPlugin

import zspring

from ..errors import ZSpringError
from ..fmu import Fmu
from .design import Case
from .evaluations import Quantity
from .workers import FAILED, Result, StudyPlugin

LOST = "lost"  # status of a case that took its worker with it, time and again
TASKS_PER_THREAD = 3  # sent ahead, so that no worker waits for the next one
TASK = 0.5  # s, aimed at by putting short cases together: each task costs Dask some ms of processor time
LOOK = 0.5  # s, between two looks for an interruption while no result comes


class Cluster:
    """A scheduler with workers.

    client      connected to it
    timeout     s, to wait for a scheduler or for workers
    """

    def __init__(self, client: Client, timeout: float):
        self.client, self.timeout = client, timeout

    @property
    def threads(self) -> int:
        """Cases that can run at a time."""
        return sum(self.client.nthreads().values())

    @contextmanager
    def study(self, fmu: Fmu, catenary: Fmu | None, quantities: Sequence[Quantity]) -> Iterator[str]:
        """FMUs and code on all workers, for as long as the study runs; the name to call it by.

        Raises ZSpringError if a worker cannot run it.
        """
        self._check_python()
        name = f"zspring-{uuid.uuid4().hex}"
        line = catenary.path.read_bytes() if catenary else None
        plugin = StudyPlugin(name, fmu.path.read_bytes(), line, quantities)
        try:
            try:
                self.client.register_plugin(_ByValue(plugin), name=name)
            except Exception as error:  # whatever went wrong over there
                raise ZSpringError(f"the workers cannot run the study: {type(error).__name__}: {error}") from None
            yield name
        finally:
            # A scheduler that is gone, and its workers, have forgotten it, too; or it never came there.
            with suppress(OSError, ValueError):
                self.client.unregister_worker_plugin(name)

    def run(self, study: str, cases: Mapping[int, Case], stop: threading.Event) -> Iterator[tuple[int, Result]]:
        """Results by number of the case, as they finish. Ends early once `stop` is set.

        Cases whose worker dies are run again on another one. After some deaths (Dask's setting
        `distributed.scheduler.allowed-failures`) each is run with no other case beside it, so that only the
        one at fault is given up, with status LOST.
        Raises ZSpringError if the scheduler is lost or stays without workers for `timeout`.
        """
        suspects: dict[int, Case] = {}
        for number, result in self._run(study, cases, stop, max(1, self.threads)):
            if "seconds" not in result:
                suspects[number] = cases[number]
            else:
                yield number, result
        for number, case in suspects.items():
            if not stop.is_set():
                yield from self._run(study, {number: case}, stop, 1)

    def _run(
        self, study: str, cases: Mapping[int, Case], stop: threading.Event, threads: int
    ) -> Iterator[tuple[int, Result]]:
        """Results of cases in tasks for that many threads; those of a task that failed fail together."""
        waiting = deque(cases)
        finished: queue.SimpleQueue[Future] = queue.SimpleQueue()
        under_way: dict[Future, list[int]] = {}
        run_cases = _run_cases(study)
        count, seconds = 0, 0.0  # cases so far, and the time they took

        def submit() -> None:
            fitting = TASK * count / seconds if seconds else 1
            most = max(1, int(min(fitting, len(waiting) / (2 * threads))))  # shorter tasks towards the end
            numbers = [waiting.popleft() for _ in range(min(most, len(waiting)))]
            if numbers:
                future = self.client.submit(run_cases, [cases[n] for n in numbers], pure=False, retries=1)
                under_way[future] = numbers
                future.add_done_callback(finished.put)

        for _ in range(TASKS_PER_THREAD * threads):
            submit()
        last_sign = time.monotonic()
        try:
            while under_way and not stop.is_set():
                try:
                    future = finished.get(timeout=LOOK)
                except queue.Empty:
                    last_sign = self._sign_of_life(last_sign)
                    continue
                results = _results(future)
                if results is None:
                    finished.put(future)
                    last_sign = self._sign_of_life(last_sign)
                    continue
                last_sign = time.monotonic()
                numbers = under_way.pop(future)
                if isinstance(results, list):
                    count += len(results)
                    seconds += sum(result["seconds"] for result in results)
                else:
                    results = [results] * len(numbers)
                submit()
                yield from zip(numbers, results)
        finally:
            with suppress(OSError):
                self.client.cancel(list(under_way))

    def _sign_of_life(self, last: float) -> float:
        """Time (s) of the last sign of life: now if there are workers. ZSpringError after the timeout."""
        try:
            connected = self.client.status == "running"
            if connected and self.threads:
                return time.monotonic()
        except OSError:
            connected = False
        if time.monotonic() - last > self.timeout:
            gone = "no worker is left" if connected else "the scheduler is gone"
            raise ZSpringError(f"{gone} (waited {self.timeout:g} s)")
        return last

    def _check_python(self) -> None:
        """Code shipped by value runs only on the same Python version."""
        here = ".".join(map(str, sys.version_info[:2]))
        for address, worker in self.client.get_versions()["workers"].items():
            there = ".".join(worker["host"]["python"].split(".")[:2])
            if there != here:
                raise ZSpringError(f"worker {address} runs Python {there}: needs {here}, as here")


# What code that travels by value may hold, and cloudpickle does not know: the lock of a cached_property (before
# Python 3.12), and functions with a cache, which it takes for those of an installed package.
copyreg.pickle(type(threading.RLock()), lambda lock: (threading.RLock, ()))
copyreg.pickle(type(lru_cache(len)), lambda function: (lru_cache, (function.__wrapped__,)))


class _ByValue(WorkerPlugin):
    """A plugin that takes this package's code along when it is pickled: workers need not have the package."""

    def __init__(self, plugin: WorkerPlugin):
        cloudpickle.register_pickle_by_value(zspring)
        try:
            self._pickled = cloudpickle.dumps(plugin)
        finally:
            cloudpickle.unregister_pickle_by_value(zspring)

    def __reduce__(self):
        return pickle.loads, (self._pickled,)


def _run_cases(study: str) -> Callable[[list[Case]], list[Result]]:
    """The task: cases by the plugin of that name. As a local function it is pickled by value."""

    def run_cases(cases: list[Case]) -> list[Result]:
        plugin = get_worker().plugins[study]
        return [plugin.run(case) for case in cases]

    return run_cases


def _results(future: Future) -> list[Result] | Result | None:
    """Results of a finished task's cases, or the one of a task that failed.

    None where they were lost with their worker before they were fetched: another one will make them again.
    """
    try:
        return future.result(timeout=LOOK)
    except TimeoutError:
        return None
    except CancelledError:
        raise ZSpringError("the scheduler is gone") from None
    except Exception:
        return _failure(future)


def _failure(future: Future) -> Result:
    """Status of a task that came to no end; unlike that of a case it says nothing on the time it took."""
    error = future.exception()
    if isinstance(error, KilledWorker):
        return {"status": LOST}
    return {"status": f"{FAILED}: {type(error).__name__}: {error}"}
