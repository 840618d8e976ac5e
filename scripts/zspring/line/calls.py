"""FMI calls prepared once, for loops over many steps: fmpy builds new arrays at each call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import Array, byref, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import partial

from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Warning

from ..fmu import Instance


class PreparedCalls:
    """What a master repeats with one initialised instance; a context manager that frees the saved state.

    Every call raises FmuError with the FMU's own message when the FMU refuses it, StepDiscarded for a step.
    """

    def __init__(self, instance: Instance):
        self._instance = instance
        self._component = c_void_p(instance.slave.component)
        self._begin, self._size, self._state = c_double(), c_double(), c_void_p()
        self._do_step = self.prepare("fmi2DoStep", self._begin, self._size, c_int(0))
        self.save = self.prepare("fmi2GetFMUstate", byref(self._state))
        self.restore = self.prepare("fmi2SetFMUstate", self._state)

    def step(self, time: float, size: float) -> None:
        """One communication step from `time` s, of `size` s."""
        self._begin.value, self._size.value = time, size
        self._do_step()

    def reals(self, names: Sequence[str]) -> Reals:
        return Reals(self, names)

    def integers(self, names: Sequence[str]) -> Callable[[], Array[c_int]]:
        """A function that gets these Integer variables, always into the same array."""
        values = (c_int * len(names))()
        get = self.prepare("fmi2GetInteger", self.references(names), c_size_t(len(names)), values)
        return lambda: get() or values

    def references(self, names: Sequence[str]):
        variables = self._instance.variables
        return (c_uint * len(names))(*(variables[name].valueReference for name in names))

    def prepare(self, name: str, *arguments) -> Callable[[], None]:
        """A function that makes one FMI call with these arguments, whose values may change between calls."""
        function = partial(self._instance.slave.dll[name], self._component, *arguments)

        def call() -> None:
            status = function()
            if status > fmi2Warning:
                with self._instance.refusals():
                    raise FMICallException(name, status)

        return call

    def __enter__(self) -> PreparedCalls:
        return self

    def __exit__(self, *_) -> None:
        if self._state:
            self.prepare("fmi2FreeFMUstate", byref(self._state))()


class Reals:
    """Some Real variables of an instance."""

    def __init__(self, calls: PreparedCalls, names: Sequence[str]):
        self.values = (c_double * len(names))()
        self.slopes = (c_double * len(names))()
        references, count = calls.references(names), c_size_t(len(names))
        orders = (c_int * len(names))(*[1] * len(names))
        self._get = calls.prepare("fmi2GetReal", references, count, self.values)
        self._set = calls.prepare("fmi2SetReal", references, count, self.values)
        self._set_slopes = calls.prepare("fmi2SetRealInputDerivatives", references, count, orders, self.slopes)

    def get(self) -> Array[c_double]:
        """Their values, always in the same array."""
        self._get()
        return self.values

    def set(self, values: Sequence[float]) -> None:
        self.values[:] = [*values]
        self._set()

    def set_slopes(self, slopes: Sequence[float]) -> None:
        """First time derivatives of inputs, for the next step."""
        self.slopes[:] = [*slopes]
        self._set_slopes()


class Jacobian:
    """Directional derivatives of outputs at the end of the last step by inputs of that step."""

    def __init__(self, calls: PreparedCalls, outputs: Sequence[str], inputs: Sequence[str]):
        self._columns, one = [], (c_double * 1)(1.0)
        unknowns, count = calls.references(outputs), c_size_t(len(outputs))
        for name in inputs:
            column = (c_double * len(outputs))()
            known = calls.references([name])
            call = calls.prepare("fmi2GetDirectionalDerivative", unknowns, count, known, c_size_t(1), one, column)
            self._columns.append((column, call))

    def get(self) -> list[Array[c_double]]:
        """By input the derivatives of all outputs, always in the same arrays."""
        for _, call in self._columns:
            call()
        return [column for column, _ in self._columns]
