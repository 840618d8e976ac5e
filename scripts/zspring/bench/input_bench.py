"""A bench outside the FMU: drive Displacement, commanded step by step, analysed here.

The commanded position is a target that the head reaches at the end of the communication step. The FMU
derives velocity and acceleration from the positions, where its own bench knows them, so that both agree to
second order in the step.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from ctypes import c_double, c_uint
from typing import Any

import numpy as np

from ..fmu import Instance
from ..variables import Value
from .responses import HARMONICS


class InputBench:
    """The same bench as `FmuBench`, but it moves the head through `head_displacement`.

    Every communication step is one internal step, a whole number of them in each period.
    """

    def __init__(self, instance: Instance, parameters: Mapping[str, Value]):
        self.instance = instance
        self._parameters = {**parameters, **instance.variables.parse_assignments(["drive=Displacement"])}
        self._time = self._phase = 0.0  # s; rad, at the begin of the next period
        self._frequency = self._peak = 0.0  # Hz, m; reached
        self._target = (0.0, 0.0)
        self._force = np.zeros(0)  # N, at the ends of the steps of the last period
        self.H, self.change, self.periods = 0j, 1.0, 0

    def start(self, frequency: float, acceleration: float) -> None:
        """From the static state at rest; frequency in Hz, peak acceleration in m/s2."""
        self.instance.start(self._parameters)
        self._time, self._phase, self._frequency, self._peak = 0.0, 0.0, frequency, 0.0
        self.tune(frequency, acceleration)

    def tune(self, frequency: float, acceleration: float) -> None:
        """Go over to another frequency (Hz) and peak acceleration (m/s2) without stopping."""
        self._target = (frequency, acceleration / (2 * math.pi * frequency) ** 2)
        # The FMU's own bench is not used here, but its grid is, and it keeps the acceleration in its state.
        self.instance.set({"bench.frequency": frequency, "bench.acceleration": acceleration})
        self._steps = int(*self.instance.get(["bench.steps_per_period"]))
        self._force = np.zeros(self._steps)
        self.H, self.change, self.periods = 0j, 1.0, 0

    def run(self, periods: int) -> None:
        """Run on for whole periods, with the ramp first after `start` and `tune`."""
        frequency, peak = self._target
        if (frequency, peak) != (self._frequency, self._peak):
            # In whole periods of the new frequency, about as long as one of the slower frequency.
            ramp_periods = max(1, round(frequency / self._frequency))
            self._drive(self._ramp(ramp_periods))
            self._frequency, self._peak = frequency, peak
            periods = max(0, periods - ramp_periods)
        phase = self._phase + 2 * math.pi * np.arange(1, self._steps + 1) / self._steps
        targets, analyser = peak * np.sin(phase), 2j / self._steps * np.exp(-1j * phase)
        for _ in range(periods):
            self._force = self._drive(targets)
            H = complex(-peak / (analyser @ self._force))
            self.change = abs(H - self.H) / abs(H) if self.periods else 1.0
            self.H = H
            self.periods += 1

    @property
    def harmonics(self) -> tuple[float, ...]:
        """Peaks of HARMONICS in N over the last whole period, 0 before the first."""
        spectrum = 2 / self._steps * np.abs(np.fft.rfft(self._force))
        return tuple(spectrum[list(HARMONICS)].tolist())

    def save(self) -> dict[str, Any]:
        """The state after `run`, fit for JSON."""
        return {
            "time": self._time,
            "phase": self._phase,
            "frequency": self._frequency,
            "peak": self._peak,
            "fmu": base64.b64encode(self.instance.save()).decode(),
        }

    def load(self, state: Mapping[str, Any]) -> None:
        """Back to a saved state; what follows is the same to the last bit."""
        self.instance.start(self._parameters)
        self.instance.load(base64.b64decode(state["fmu"]))
        self._time, self._phase = state["time"], state["phase"]
        self._frequency, self._peak = state["frequency"], state["peak"]

    def _ramp(self, periods: int) -> np.ndarray:
        """Positions (n,) in m at the ends of the n steps that lead to the target; moves the phase on.

        Frequency and displacement peak go over by the quintic with no slope and no curvature at its ends.
        """
        frequency, peak = self._target
        steps = self._steps * periods
        x = np.arange(1, steps + 1) / steps
        p, integral = x**3 * (10 - 15 * x + 6 * x**2), x**4 * (2.5 - 3 * x + x**2)
        turns = periods / frequency * (self._frequency * x + (frequency - self._frequency) * integral)
        phase = self._phase + 2 * math.pi * turns
        self._phase = float(phase[-1]) % (2 * math.pi)
        return (self._peak + (peak - self._peak) * p) * np.sin(phase)

    def _drive(self, targets: np.ndarray) -> np.ndarray:
        """Move the head to n positions (m), one communication step to each: contact force (n,) in N at their ends."""
        frequency, _ = self._target
        step = 1 / (self._steps * frequency)
        forces = move_head(self.instance, self._time, step, targets)
        self._time += len(forces) * step
        return forces


def move_head(instance: Instance, time: float, step: float, positions: np.ndarray) -> np.ndarray:
    """Move the head to n positions (m), one communication step (s) to each, from a time in s on; drive Displacement.

    Returns the contact force (n,) in N at the end of every step.
    """
    # Half the time goes into the calls, so their arguments are made once.
    fmu, variables = instance.slave, instance.variables
    head = (c_uint * 1)(variables["head_displacement"].valueReference)
    contact = (c_uint * 1)(variables["contact.force"].valueReference)
    target, force = (c_double * 1)(), (c_double * 1)()
    forces = []
    with instance.refusals():
        for i, target[0] in enumerate(positions.tolist()):
            fmu.fmi2SetReal(fmu.component, head, 1, target)
            fmu.fmi2DoStep(fmu.component, time + i * step, step, 1)
            fmu.fmi2GetReal(fmu.component, contact, 1, force)
            forces.append(force[0])
    return np.array(forces)
