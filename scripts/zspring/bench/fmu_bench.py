"""The bench inside the FMU: drive Bench imposes a sine on the head and analyses the response."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..fmu import Instance
from ..variables import Value
from .responses import HARMONICS


class FmuBench:
    """Response-controlled bench of the FMU itself: one communication step covers any number of periods.

    After `run`: `H` = -Z/F in m/N over the last whole period, `change` of H against the period before
    (relative), `periods` = whole periods since the bench was tuned.
    """

    H: complex
    change: float
    periods: int

    def __init__(self, instance: Instance, parameters: Mapping[str, Value]):
        self.instance = instance
        self._parameters = {**parameters, **instance.variables.parse_assignments(["drive=Bench"])}
        self._time = 0.0
        self._frequency = 0.0
        self._forget()

    def start(self, frequency: float, acceleration: float) -> None:
        """From the static state at rest; frequency in Hz, peak acceleration in m/s2."""
        self._time, self._frequency = 0.0, frequency
        self._forget()
        self.instance.start({**self._parameters, **_settings(frequency, acceleration)})

    def tune(self, frequency: float, acceleration: float) -> None:
        """Go over to another frequency (Hz) and peak acceleration (m/s2) without stopping."""
        self._frequency = frequency
        self._forget()
        self.instance.set(_settings(frequency, acceleration))

    def run(self, periods: int) -> None:
        """Run on for whole periods; after `start` and `tune` they begin with the ramp."""
        duration = periods / self._frequency
        self.instance.step(self._time, duration)
        self._time += duration
        if self.periods:
            self.periods += periods
        else:  # the ramp may take some of them
            self.periods = int(*self.instance.get(["bench.periods"]))
        real, imaginary, self.change = self.instance.get(["bench.H_re", "bench.H_im", "bench.change"])
        self.H = complex(real, imaginary)

    def watch(self, names: Sequence[str]) -> np.ndarray:
        """One more period: values (n, len(names)) at the ends of its n internal steps."""
        count = int(*self.instance.get(["bench.steps_per_period"]))
        step, rows = 1 / (self._frequency * count), []
        for i in range(count):
            self.instance.step(self._time + i * step, step)
            rows.append(self.instance.get(names))
        self._time += count * step
        self.periods += 1
        return np.array(rows)

    @property
    def harmonics(self) -> tuple[float, ...]:
        """Peaks of HARMONICS in N over the last whole period, 0 before the first."""
        return tuple(self.instance.get([f"bench.harmonic[{n}]" for n in HARMONICS]))

    def save(self) -> dict[str, Any]:
        """The state after `run`, fit for JSON."""
        return {"time": self._time, "fmu": base64.b64encode(self.instance.save()).decode()}

    def load(self, state: Mapping[str, Any]) -> None:
        """Back to a saved state; what follows is the same to the last bit."""
        self.instance.start(self._parameters)
        self.instance.load(base64.b64decode(state["fmu"]))
        self._time = state["time"]

    def _forget(self) -> None:
        """The point before: its numbers would else be those of a point whose first step fails."""
        self.H, self.change, self.periods = 0j, 1.0, 0


def _settings(frequency: float, acceleration: float) -> dict[str, Value]:
    return {"bench.frequency": frequency, "bench.acceleration": acceleration}
