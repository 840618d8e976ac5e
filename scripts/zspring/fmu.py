"""An FMU from Python: find and unpack it once, run instances with parameters, inputs and outputs by name."""

from __future__ import annotations

import hashlib
import importlib.resources
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from copy import copy
from ctypes import byref, c_void_p
from pathlib import Path

import fmpy
import fmpy.fmi2
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ScalarVariable

from . import line_table
from .errors import ZSpringError
from .line_table import LineTable
from .variables import Value, Variables

PANTOGRAPH = "ZSpringPantograph"
CATENARY = "Catenary"

_SET = {"Real": "setReal", "Integer": "setInteger", "Enumeration": "setInteger", "Boolean": "setBoolean"}
_GET = {"Real": "getReal", "Integer": "getInteger", "Enumeration": "getInteger", "Boolean": "getBoolean"}


class FmuError(ZSpringError):
    """The FMU refused a call; the text is the FMU's own log message."""


class StepDiscarded(FmuError):
    """A communication step could not be solved; the instance is as before the step."""


def installed_fmu(model: str = PANTOGRAPH) -> Path:
    """The FMU of that model inside this package. Raises ZSpringError if there is none."""
    path = Path(str(importlib.resources.files(__package__) / f"{model}.fmu"))
    if not path.is_file():
        raise ZSpringError(f"no {path.name} in {path.parent}: install the package, or name an FMU with --fmu")
    return path


class Fmu:
    """An FMU unpacked into a temporary folder, a context manager that removes the folder.

    path        the .fmu file; None is the pantograph inside this package
    unpack_in   where to make the temporary folder; None is the system's place for them
    `warnings` collects, each once, the log lines of all instances that came without a refusal.
    Raises ZSpringError if the file is no FMU for co-simulation on this platform.
    """

    def __init__(self, path: Path | None = None, unpack_in: Path | None = None):
        self.path = Path(path) if path else installed_fmu()
        self.warnings: list[str] = []
        try:
            self.description = fmpy.read_model_description(str(self.path), validate=False)
        except OSError:
            raise
        except Exception as error:  # fmpy and its XML reader share no class of errors
            raise ZSpringError(f"{self.path} is no FMU: {error}") from None
        if self.description.fmiVersion != "2.0" or self.description.coSimulation is None:
            raise ZSpringError(f"{self.path} is no FMU for FMI 2.0 co-simulation")
        self.variables = Variables(self.description.modelVariables)
        # Windows keeps a library locked for a moment after it was unloaded.
        self._temporary = tempfile.TemporaryDirectory(prefix="zspring-", dir=unpack_in, ignore_cleanup_errors=True)
        self.folder = Path(self._temporary.name)
        fmpy.extract(self.path, self.folder)
        self.guid = self.description.guid
        self.home = self.folder  # with `resources`
        own = self.folder / "resources" / line_table.FILE
        self.line: LineTable | None = LineTable.read(own) if own.is_file() else None

    def with_line(self, line: LineTable) -> Fmu:
        """The same FMU, while it is open, with another line in its resources, as instances are told by their GUID.

        In a folder of its own, also where the line is the same: whoever has it can remove it.
        """
        other = copy(self)
        other.line, other.home = line, Path(tempfile.mkdtemp(prefix="line-", dir=self.folder))
        other.guid = line_table.guid(self.description.guid, line)
        line.write(other.home / "resources" / line_table.FILE)
        return other

    @property
    def identity(self) -> dict[str, str]:
        """Model, version and GUID, for the head of a file."""
        description = self.description
        return {"FMU": f"{description.modelName} {description.version}", "GUID": self.guid}

    @property
    def sha256(self) -> str:
        """Hash of the file, which tells two builds apart."""
        return hashlib.sha256(self.path.read_bytes()).hexdigest()

    @contextmanager
    def instances(self, count: int = 1) -> Iterator[list[Instance]]:
        """That many instances, freed at the end. Made in one thread: loading changes the working folder."""
        with ExitStack() as stack:
            instances = []
            for number in range(count):
                instance = Instance(self, f"zspring{number}", self.binary)
                stack.callback(instance.free)
                instances.append(instance)
            yield instances

    @property
    def parameter_names(self) -> list[str]:
        """Names of all parameters that count, calculated ones included: with a line's table, not those it replaces."""
        names, given = self.variables.names("parameter", "calculatedParameter"), self.variables.names("parameter")
        replaced = {name for name in given if line_table.replaces(name)} if self.line else set()
        return [name for name in names if name not in replaced]

    def used_parameters(self, parameters: Mapping[str, Value]) -> dict[str, Value]:
        """Instance.used_parameters of an instance that is started with these. Raises FmuError for a refused one."""
        with self.instances() as (instance,):
            instance.start(parameters)
            return instance.used_parameters()

    @property
    def binary(self) -> Path:
        """The shared library for this platform, in the folder of FMI 2.0 or of 2.0.5.

        Raises ZSpringError where there is none.
        """
        name = self.description.coSimulation.modelIdentifier + fmpy.sharedLibraryExtension
        for platform in (fmpy.platform_tuple, fmpy.platform):
            path = self.folder / "binaries" / platform / name
            if path.is_file():
                return path
        raise ZSpringError(f"{self.path} holds no library for this platform ({fmpy.platform_tuple})")

    def close(self) -> None:
        self._temporary.cleanup()

    def __enter__(self) -> Fmu:
        return self

    def __exit__(self, *_) -> None:
        self.close()


class Instance:
    """One instance of the FMU; use it from one thread at a time.

    Every method raises FmuError with the FMU's own message when the FMU refuses.
    """

    def __init__(self, fmu: Fmu, name: str, library: Path):
        self.variables, self._parameter_names = fmu.variables, fmu.parameter_names
        self._warnings = fmu.warnings
        self._log: list[str] = []
        self._used = False
        callbacks = fmpy.fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(self._receive_log)
        callbacks.allocateMemory = fmpy.fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmpy.fmi2.defaultCallbacks.freeMemory
        try:
            self.slave = fmpy.fmi2.FMU2Slave(
                instanceName=name,
                guid=fmu.guid,
                unzipDirectory=str(fmu.home),
                modelIdentifier=fmu.description.coSimulation.modelIdentifier,
                libraryPath=str(library),
            )
            self.slave.instantiate(callbacks=callbacks)
        except Exception as error:  # fmpy raises nothing more specific when it cannot load or instantiate
            raise FmuError("; ".join(self._log) or str(error)) from None
        categories = [category.name for category in fmu.description.logCategories]
        self.slave.setDebugLogging(True, [name for name in categories if name.startswith("logStatus")])

    def start(
        self, parameters: Mapping[str, Value], inputs: Mapping[str, float] | None = None, start_time: float = 0.0
    ) -> None:
        """A new run from the static state: reset, set parameters and first inputs, initialise."""
        with self.refusals():
            if self._used:
                self.slave.reset()
            self._used = True
            self.set(parameters)
            self.slave.setupExperiment(startTime=start_time)
            self.slave.enterInitializationMode()
            self.set(inputs or {})
            self.slave.exitInitializationMode()

    def set(self, values: Mapping[str, Value]) -> None:
        """Set variables by name."""
        with self.refusals():
            for setter, group in self._by_call(_SET, values):
                getattr(self.slave, setter)(
                    [variable.valueReference for variable in group], [values[variable.name] for variable in group]
                )

    def set_slopes(self, slopes: Mapping[str, float]) -> None:
        """Set the first derivatives of Real inputs by name; nothing for an empty mapping."""
        if slopes:
            with self.refusals():
                self.slave.setRealInputDerivatives(
                    [self.variables[name].valueReference for name in slopes], [1] * len(slopes), list(slopes.values())
                )

    def get(self, names: Sequence[str]) -> list[Value]:
        """Values of variables by name."""
        values: dict[str, Value] = {}
        with self.refusals():
            for getter, group in self._by_call(_GET, names):
                numbers = getattr(self.slave, getter)([variable.valueReference for variable in group])
                values.update(zip((variable.name for variable in group), numbers))
        return [values[name] for name in names]

    def used_parameters(self) -> dict[str, Value]:
        """Values of Fmu.parameter_names as they are now."""
        return dict(zip(self._parameter_names, self.get(self._parameter_names)))

    def get_slopes(self, names: Sequence[str]) -> list[float]:
        """First time derivatives of Real outputs by name, at the last communication point."""
        with self.refusals():
            references = [self.variables[name].valueReference for name in names]
            return list(self.slave.getRealOutputDerivatives(references, [1] * len(references)))

    def step(self, time: float, size: float) -> None:
        """One communication step. Raises StepDiscarded if it could not be solved."""
        with self.refusals():
            self.slave.doStep(time, size)

    def derivatives(self, outputs: Sequence[str], inputs: Mapping[str, float]) -> list[float]:
        """Variation of Real outputs, by name, with that of the inputs held in the last communication step."""
        with self.refusals():
            unknowns = [self.variables[name].valueReference for name in outputs]
            knowns = [self.variables[name].valueReference for name in inputs]
            return list(self.slave.getDirectionalDerivative(unknowns, knowns, list(inputs.values())))

    def keep(self, state: c_void_p | None = None) -> c_void_p:
        """The complete state in the FMU's own memory, in that of `state` if given; give it back to forget()."""
        with self.refusals():
            state = c_void_p() if state is None else state
            self.slave.fmi2GetFMUstate(self.slave.component, byref(state))
            return state

    def go_back(self, state: c_void_p) -> None:
        """To a state that keep() made; it stays valid."""
        with self.refusals():
            self.slave.setFMUstate(state)

    def forget(self, state: c_void_p) -> None:
        """Free what keep() made."""
        self.slave.freeFMUstate(state)

    def save(self) -> bytes:
        """The complete state, serialised."""
        with self.refusals():
            state = self.slave.getFMUstate()
            try:
                return self.slave.serializeFMUstate(state)
            finally:
                self.slave.freeFMUstate(state)

    def load(self, data: bytes) -> None:
        """Back to a saved state."""
        with self.refusals():
            state = self.slave.deSerializeFMUstate(data)
            try:
                self.slave.setFMUstate(state)
            finally:
                self.slave.freeFMUstate(state)

    def free(self) -> None:
        self.slave.freeInstance()

    def _by_call(self, calls: Mapping[str, str], names: Iterable[str]) -> Iterable[tuple[str, list[ScalarVariable]]]:
        """The variables that one FMI call can handle together, by the name of that call."""
        groups: dict[str, list[ScalarVariable]] = {}
        for name in names:
            variable = self.variables[name]
            groups.setdefault(calls[variable.type], []).append(variable)
        return groups.items()

    def _receive_log(self, _environment, _name, status, _category, message) -> None:
        # FMUs double the signs of printf directives (%) and of references to variables (#, FMI 2.0.5, 2.1.5).
        line = message.decode("utf-8", "replace").replace("%%", "%").replace("##", "#")
        if status > fmpy.fmi2.fmi2Warning:
            self._log.append(line)
        elif line not in self._warnings:
            self._warnings.append(line)

    @contextmanager
    def refusals(self) -> Iterator[None]:
        """Turn a refused call into FmuError with what the FMU logged about it."""
        try:
            yield
        except FMICallException as error:
            message = "; ".join(self._log) or str(error)
            self._log.clear()
            discarded = error.status == fmpy.fmi2.fmi2Discard
            raise (StepDiscarded if discarded else FmuError)(message) from None
