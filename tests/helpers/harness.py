"""A built FMU as a host sees it: variables by name, one communication step at a time, its log.

Everything goes through fmpy's FMI 2.0 binding, which raises FMICallException with the status on Discard and
Error.
"""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from fmpy import calloc, free, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2OK,
)
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelDescription, ScalarVariable

Value = float | int | bool | str

# For measurements finer than Newton's default tolerance.
PRECISE = {"solver.tolerance": 1e-12}


@dataclass(frozen=True)
class Message:
    """One line of an instance's log."""

    instance: str
    status: int
    category: str
    text: str


@dataclass(frozen=True)
class Fmu:
    """The extracted FMU: its folder and its model description."""

    path: Path
    folder: Path
    told: str = ""  # to the library by the GUID of a copy

    @cached_property
    def description(self) -> ModelDescription:
        return read_model_description(str(self.path))

    @cached_property
    def variables(self) -> dict[str, ScalarVariable]:
        return {v.name: v for v in self.description.modelVariables}

    def start(self, name: str) -> Value:
        """Start value of a variable as the model description has it."""
        v = self.variables[name]
        if v.type == "Boolean":
            return v.start == "true"
        return float(v.start) if v.type == "Real" else int(v.start)

    def names(self, causality: str) -> list[str]:
        return [v.name for v in self.description.modelVariables if v.causality == causality]

    def continuous_outputs(self) -> list[str]:
        """Those that have derivatives: no counts, switches, averages, nor what is told for the next step."""
        outputs = (v for v in self.description.modelVariables if v.causality == "output" and v.type == "Real")
        return [v.name for v in outputs if v.variability != "discrete"]

    def with_line(self, table: bytes, folder: Path) -> Fmu:
        """A copy in `folder` whose resources hold this table of a line."""
        shutil.copytree(self.folder, folder)
        (folder / "resources").mkdir(exist_ok=True)
        (folder / "resources" / "line.table").write_bytes(table)
        digest = 14695981039346656037  # FNV-1a
        for byte in table:
            digest = (digest ^ byte) * 1099511628211 % 2**64
        return Fmu(self.path, folder, f" line={digest:016x}")

    def slave(self, name: str = "instance") -> FMU2Slave:
        """A binding that has loaded the library but has no instance yet."""
        return FMU2Slave(
            guid=self.description.guid + self.told,
            unzipDirectory=str(self.folder),
            instanceName=name,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )


def forms_of(uri: str) -> list[str]:
    """The URI of a folder, file:///..., as hosts write it: other slashes, a host, capitals, blanks as they are."""
    begins = "file:///", "file:/", "file:////", "file://localhost/", "FILE:///"
    return [*(uri.replace("file:///", begin) for begin in begins), uri + "/", uri.replace("%20", " ")]


def callbacks_into(log: list[Message], *, expand: bool = True) -> fmi2CallbackFunctions:
    """FMI callbacks that append to `log`; `expand`: expand printf directives first, as hosts do.

    fmpy expands for the callbacks made last only: with several instances, look at the log of the last one.
    """

    def logger(_environment, instance, status, category, text):
        log.append(Message(*(s.decode() if isinstance(s, bytes) else s for s in (instance, status, category, text))))

    functions = fmi2CallbackFunctions()
    functions.logger = fmi2CallbackLoggerTYPE(logger)
    functions.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    functions.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    if expand:
        addLoggerProxy(ctypes.byref(functions))
    return functions


class Instance:
    """One instance of an FMU.

    `parameters` (by name; enumerations by item name) are set before initialization. With `initialize` False the
    instance stays instantiated. `time` is the communication point reached.
    """

    def __init__(
        self,
        fmu: Fmu,
        parameters: Mapping[str, Value] | None = None,
        *,
        initialize: bool = True,
        start_time: float = 0.0,
        stop_time: float | None = None,
        name: str = "instance",
        logging: bool = True,
        categories: Sequence[str] = (),
    ):
        self.fmu = fmu
        self.log: list[Message] = []
        self.slave = fmu.slave(name)
        self.slave.instantiate(callbacks=callbacks_into(self.log), loggingOn=logging)
        if categories:
            self.slave.setDebugLogging(True, categories)
        self.time = start_time
        self.set(parameters or {})
        if initialize:
            self.initialize(start_time, stop_time)

    def initialize(self, start_time: float = 0.0, stop_time: float | None = None) -> None:
        self.slave.setupExperiment(startTime=start_time, stopTime=stop_time)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.time = start_time

    def reset(self) -> None:
        self.slave.reset()
        self.time = 0.0

    def close(self) -> None:
        """Free the instance and unload the library; a second call does nothing."""
        if self.slave.component is not None:
            self.slave.freeInstance()
            self.slave.component = None

    # Values by name

    def reference(self, name: str) -> int:
        return self.fmu.variables[name].valueReference

    def set(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            self[name] = value

    def __setitem__(self, name: str, value: Value) -> None:
        variable = self.fmu.variables[name]
        if variable.type == "Real":
            self.slave.setReal([variable.valueReference], [value])
        elif variable.type == "Boolean":
            self.slave.setBoolean([variable.valueReference], [value])
        else:
            if isinstance(value, str):
                value = next(int(i.value) for i in variable.declaredType.items if i.name == value)
            self.slave.setInteger([variable.valueReference], [value])

    def __getitem__(self, name: str) -> Value:
        variable = self.fmu.variables[name]
        if variable.type == "Real":
            return self.slave.getReal([variable.valueReference])[0]
        if variable.type == "Boolean":
            return bool(self.slave.getBoolean([variable.valueReference])[0])
        return self.slave.getInteger([variable.valueReference])[0]

    def reals(self, names: Sequence[str]) -> np.ndarray:
        """Values of Real variables, shape (len(names),)."""
        return np.array(self.slave.getReal([self.reference(n) for n in names]))

    def all_values(self) -> dict[str, Value]:
        """Every variable of the FMU, for comparison bit for bit."""
        return {name: self[name] for name in self.fmu.variables}

    def set_derivatives(self, name: str, *derivatives: float) -> None:
        """Time derivatives of an input, from order 1 on."""
        orders = range(1, len(derivatives) + 1)
        self.slave.setRealInputDerivatives([self.reference(name)] * len(derivatives), list(orders), derivatives)

    # Time

    def step(self, size: float) -> None:
        self.slave.doStep(self.time, size)
        self.time += size

    def run(
        self,
        step: float,
        count: int,
        outputs: Sequence[str],
        *,
        signals: Mapping[str, Signal] = {},
        targets: Mapping[str, Callable[[float], float]] = {},
    ) -> np.ndarray:
        """`count` communication steps; returns the outputs after each, shape (count, len(outputs)).

        `signals` are set at the begin of each step, with both derivatives; `targets` as the value at its end.
        """
        references = [self.reference(n) for n in outputs]
        result = np.empty((count, len(outputs)))
        begin = self.time
        for n in range(count):
            now, end = begin + n * step, begin + (n + 1) * step
            for name, signal in signals.items():
                self[name] = signal(now)
                self.set_derivatives(name, signal(now, 1), signal(now, 2))
            for name, signal in targets.items():
                self[name] = signal(end)
            self.slave.doStep(now, end - now)
            result[n] = self.slave.getReal(references)
        self.time = begin + count * step
        return result


class Pantograph(Instance):
    """One of the pantograph: contact_force follows static_force unless given."""

    def __init__(self, fmu: Fmu, parameters: Mapping[str, Value] | None = None, **options):
        parameters = dict(parameters or {})
        if "static_force" in parameters:
            parameters.setdefault("contact_force", parameters["static_force"])
        super().__init__(fmu, parameters, **options)


class Signal:
    """offset + sum of amplitude sin(omega t + phase), with derivatives."""

    def __init__(self, tones: Sequence[tuple[float, float, float]], offset: float = 0.0):
        self.amplitude, self.omega, self.phase = np.array(tones, float).reshape(-1, 3).T
        self.offset = offset

    def __call__(self, t: float, order: int = 0) -> float:
        """The `order`-th time derivative at time `t`."""
        value = self.amplitude * self.omega**order @ np.sin(self.omega * t + self.phase + order * np.pi / 2)
        return float(value + (self.offset if order == 0 else 0.0))

    @classmethod
    def cubed_sines(cls, amplitudes: Sequence[float], frequencies: Sequence[float], offset: float = 0.0) -> Signal:
        """Sum of amplitude sin(2 pi f t)^3: leaves the offset at t = 0 with velocity and acceleration 0."""
        tones = []
        for amplitude, frequency in zip(amplitudes, frequencies):
            omega = 2 * np.pi * frequency
            tones += [(0.75 * amplitude, omega, 0.0), (-0.25 * amplitude, 3 * omega, 0.0)]
        return cls(tones, offset)


def refusal(call, *arguments) -> int:
    """Status with which an FMI call is refused; fmi2OK if it is not."""
    try:
        call(*arguments)
    except FMICallException as error:
        return error.status
    return fmi2OK


def bench_point(
    p: Pantograph, frequency: float, acceleration: float, *, settled: float = 1e-9, longest: float = 120.0
) -> complex:
    """Receptance (m/N) at one point of drive Bench, once it has changed less than `settled` three times."""
    p.set({"bench.frequency": frequency, "bench.acceleration": acceleration})
    looks, begin = 0, p.time
    while looks < 3:
        assert p.time - begin < longest, f"no steady state at {frequency} Hz: change {p['bench.change']:.1e}"
        p.step(max(3, np.ceil(frequency / 2)) / frequency)
        looks = looks + 1 if p["bench.change"] < settled else 0
    return complex(*p.reals(["bench.H_re", "bench.H_im"]))


def differences(p: Instance, outputs: list[str], name: str, delta: float, size: float) -> np.ndarray:
    """Central differences of `outputs` after a step of `size` s, with respect to the input held in it."""
    state, value = p.slave.getFMUstate(), p[name]
    ends = []
    for shifted in (value + delta, value - delta):
        p.slave.setFMUstate(state)
        p[name] = shifted
        p.slave.doStep(p.time, size)
        ends.append(p.reals(outputs))
    p.slave.setFMUstate(state)
    p.slave.freeFMUstate(state)
    return (ends[0] - ends[1]) / (2 * delta)


def fitted_order(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log(error) against log(step)."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
