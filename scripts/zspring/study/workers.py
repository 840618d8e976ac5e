"""What runs on a Dask worker: the FMU, unpacked once, and cases on it.

FMU and code travel to the workers with the study, so that a worker needs only distributed, fmpy and numpy,
and the same Python version (major, minor): cloudpickle ships the package's functions and classes by value.
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
from .evaluations import Quantity

OK, FAILED = "ok", "failed"

Result = dict[str, Any]  # "status", "seconds", and values by column


class StudyPlugin(WorkerPlugin):
    """One study on a worker; the scheduler gives it to each worker, those that come later included.

    content     the .fmu file
    common      parameters that all cases have in common
    quantities  what to compute
    Setting up raises ZSpringError if the FMU cannot run there.
    """

    def __init__(self, name: str, content: bytes, common: Mapping[str, Value], quantities: Sequence[Quantity]):
        self.name = name
        self._content, self._common, self._quantities = content, dict(common), tuple(quantities)

    def setup(self, worker: Worker) -> None:
        folder = Path(worker.local_directory)
        path = folder / f"{hashlib.sha256(self._content).hexdigest()}.fmu"
        path.write_bytes(self._content)
        self._stack = ExitStack()
        self._fmu = self._stack.enter_context(Fmu(path, unpack_in=folder))
        self._free: list[Instance] = []
        self._lock = threading.Lock()
        self._running, self._is_over = 0, False
        with self._instance():
            pass  # loads the library, so that a wrong platform shows here

    def teardown(self, worker: Worker) -> None:
        """Free all, now or, as a cancelled case runs on to its end, after that."""
        with self._lock:
            self._is_over = True
            if not self._running:
                self._stack.close()

    def run(self, case: Mapping[str, Value]) -> Result:
        """One case: a refusal or a step that cannot be solved is a result, too."""
        begin = time.perf_counter()
        values: dict[str, float] = {}
        problems: list[str] = []
        with self._instance() as instance:
            for quantity in self._quantities:
                try:
                    found, unsolved = quantity.measure(instance, {**self._common, **case})
                except ZSpringError as error:
                    problems.append(str(error))
                else:
                    values.update(found)
                    problems += unsolved
        # The same refusal may have met several quantities.
        status = f"{FAILED}: {'; '.join(dict.fromkeys(problems))}" if problems else OK
        return {"status": status, "seconds": round(time.perf_counter() - begin, 4), **values}

    @contextmanager
    def _instance(self) -> Iterator[Instance]:
        """An instance for one thread at a time."""
        with self._lock:
            instance = self._free.pop() if self._free else self._stack.enter_context(self._fmu.instances())[0]
            self._running += 1
        try:
            yield instance
        finally:
            with self._lock:
                self._free.append(instance)
                self._running -= 1
                if self._is_over and not self._running:
                    self._stack.close()
