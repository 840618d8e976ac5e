"""What runs on a Dask worker: the FMUs, unpacked once, and cases on them.

FMUs and code travel to the workers with the study, so that a worker needs only distributed, fmpy and numpy, for
[couple] scipy, and the same Python version (major, minor): cloudpickle ships the package's code by value.
"""

from __future__ import annotations

import hashlib
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from distributed import Worker
from distributed.diagnostics.plugin import WorkerPlugin

from ..errors import ZSpringError
from ..fmu import Fmu, Instance
from ..variables import Value
from .coupled import CoupledQuantity, pantograph_parameters
from .evaluations import Quantity

OK, FAILED = "ok", "failed"

Result = dict[str, Any]  # "status", "seconds" and "CPU", and values by column


class SharedFmu(Fmu):
    """An FMU for several threads, in which instances are made one after the other: it changes the working folder.

    making  held meanwhile, by all FMUs of a process
    """

    def __init__(self, path: Path, unpack_in: Path, making: threading.Lock):
        super().__init__(path, unpack_in)
        self._making = making

    @contextmanager
    def instances(self, count: int = 1) -> Iterator[list[Instance]]:
        with ExitStack() as stack:
            with self._making:
                made = stack.enter_context(super().instances(count))
            yield made


class StudyPlugin(WorkerPlugin):
    """One study on a worker; the scheduler gives it to each worker, those that come later included.

    pantograph, catenary    contents of the .fmu files; None: a study without a line
    quantities              what to compute
    Setting up raises ZSpringError if an FMU cannot run there.
    """

    def __init__(self, name: str, pantograph: bytes, catenary: bytes | None, quantities: Sequence[Quantity]):
        self.name = name
        self._contents = [content for content in (pantograph, catenary) if content is not None]
        self._quantities = tuple(quantities)

    def setup(self, worker: Worker) -> None:
        folder = Path(worker.local_directory)
        self._stack = ExitStack()
        self._fmus: list[Fmu] = []
        making = threading.Lock()
        for content in self._contents:
            path = folder / f"{hashlib.sha256(content).hexdigest()}.fmu"
            path.write_bytes(content)
            self._fmus.append(self._stack.enter_context(SharedFmu(path, folder, making)))
        self._free: list[Instance] = []
        self._lock = threading.Lock()
        self._running, self._is_over = 0, False
        for fmu in self._fmus:
            # Loads the library, so that a wrong platform shows here, and for good: each loading costs 70 kB that the
            # runtime library of C++ within it never gives back.
            self._stack.enter_context(fmu.instances())

    def teardown(self, worker: Worker) -> None:
        """Free all, now or, as a cancelled case runs on to its end, after that."""
        with self._lock:
            self._is_over = True
            if not self._running:
                self._stack.close()

    def run(self, parameters: Mapping[str, Value]) -> Result:
        """One case: a refusal or a step that cannot be solved is a result, too."""
        begin, begin_cpu = time.perf_counter(), time.thread_time()
        values: Result = {}
        problems: list[str] = []
        with self._busy():
            for quantity in self._quantities:
                try:
                    found, unsolved = self._measured(quantity, parameters)
                except ZSpringError as error:
                    problems.append(str(error))
                else:
                    values.update(found)
                    problems += unsolved
        # The same refusal may have met several quantities.
        status = f"{FAILED}: {'; '.join(dict.fromkeys(problems))}" if problems else OK
        times = {"seconds": time.perf_counter() - begin, "CPU": time.thread_time() - begin_cpu}
        return {"status": status, **times, **values}

    def _measured(self, quantity: Quantity, parameters: Mapping[str, Value]) -> tuple[Result, list[str]]:
        """Values of one quantity by column, and what could not be solved."""
        if isinstance(quantity, CoupledQuantity):
            pantograph, catenary = self._fmus
            return quantity.measure(pantograph, catenary, parameters)
        with self._lock:  # an instance serves one case after the other, each in one thread
            instance = self._free.pop() if self._free else self._stack.enter_context(self._fmus[0].instances())[0]
        try:
            return quantity.measure(instance, pantograph_parameters(parameters))
        finally:
            with self._lock:
                self._free.append(instance)

    @contextmanager
    def _busy(self) -> Iterator[None]:
        """The FMUs stay open for this case."""
        with self._lock:
            self._running += 1
        try:
            yield
        finally:
            with self._lock:
                self._running -= 1
                if self._is_over and not self._running:
                    self._stack.close()
