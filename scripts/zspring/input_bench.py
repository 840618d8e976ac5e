"""A bench outside the FMU: drive Displacement, commanded step by step, analysed here.

Value and input derivatives of orders 1 and 2 tell the FMU how the head moves in each communication step.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from ctypes import c_double, c_int, c_uint
from typing import Any

import numpy as np

from .fmu import Instance
from .variables import Value

FEWEST_STEPS_PER_PERIOD = 16


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
        self.H, self.change, self.periods = 0j, 1.0, 0

    def start(self, frequency: float, acceleration: float) -> None:
        """From the static state at rest; frequency in Hz, peak acceleration in m/s2."""
        self.instance.start(self._parameters)
        self._time, self._phase, self._frequency, self._peak = 0.0, 0.0, frequency, 0.0
        self.tune(frequency, acceleration)

    def tune(self, frequency: float, acceleration: float) -> None:
        """Go over to another frequency (Hz) and peak acceleration (m/s2) without stopping."""
        self._target = (frequency, acceleration / (2 * math.pi * frequency) ** 2)
        (largest_step,) = self.instance.get(["solver.step"])
        self._steps = max(FEWEST_STEPS_PER_PERIOD, math.ceil(1 / (frequency * largest_step) - 1e-9))
        self.H, self.change, self.periods = 0j, 1.0, 0

    def run(self, periods: int) -> None:
        """Run on for whole periods, with the ramp first after `start` and `tune`."""
        frequency, peak = self._target
        if (frequency, peak) != (self._frequency, self._peak):
            # In whole periods of the new frequency, about as long as one of the slower frequency.
            ramp_periods = max(1, round(frequency / self._frequency))
            self._drive(*self._ramp(ramp_periods))
            self._frequency, self._peak = frequency, peak
            periods = max(0, periods - ramp_periods)
        n = np.arange(self._steps + 1)
        phase = self._phase + 2 * math.pi * n / self._steps
        omega = 2 * math.pi * frequency
        position, velocity = peak * np.sin(phase), peak * omega * np.cos(phase)
        analyser = 2j / self._steps * np.exp(-1j * phase[1:])
        for _ in range(periods):
            force = analyser @ self._drive(position, velocity, -(omega**2) * position)
            H = complex(-peak / force)
            self.change = abs(H - self.H) / abs(H) if self.periods else 1.0
            self.H = H
            self.periods += 1

    def save(self) -> dict[str, Any]:
        """The state after `run`, fit for JSON."""
        return {"time": self._time, "phase": self._phase, "frequency": self._frequency, "peak": self._peak,
                "fmu": base64.b64encode(self.instance.save()).decode()}

    def load(self, state: Mapping[str, Any]) -> None:
        """Back to a saved state; what follows is the same to the last bit."""
        self.instance.start(self._parameters)
        self.instance.load(base64.b64decode(state["fmu"]))
        self._time, self._phase = state["time"], state["phase"]
        self._frequency, self._peak = state["frequency"], state["peak"]

    def _ramp(self, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position (m), velocity and acceleration that lead to the target within `periods`; moves the phase on.

        Frequency and displacement peak go over by the quintic with no slope and no curvature at its ends.
        """
        frequency, peak = self._target
        steps = self._steps * periods
        length = steps / (self._steps * frequency)
        x = np.arange(steps + 1) / steps
        p = x**3 * (10 - 15 * x + 6 * x**2)
        slope, curvature = 30 * x**2 * (1 - x) ** 2, 60 * x * (1 - 3 * x + 2 * x**2)
        integral = x**4 * (2.5 - 3 * x + x**2)

        rise, change = peak - self._peak, frequency - self._frequency
        X, dX, ddX = self._peak + rise * p, rise * slope / length, rise * curvature / length**2
        omega, d_omega = 2 * math.pi * (self._frequency + change * p), 2 * math.pi * change * slope / length
        phase = self._phase + 2 * math.pi * length * (self._frequency * x + change * integral)
        sine, cosine = np.sin(phase), np.cos(phase)
        self._phase = float(phase[-1]) % (2 * math.pi)
        return (X * sine, dX * sine + X * omega * cosine,
                (ddX - X * omega**2) * sine + (2 * dX * omega + X * d_omega) * cosine)

    def _drive(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Move the head along n + 1 positions (m, m/s, m/s2), one communication step from each to the next.

        Returns the contact force (n,) in N at the end of every step.
        """
        frequency, _ = self._target
        step = 1 / (self._steps * frequency)
        command = zip(position[:-1].tolist(), velocity[:-1].tolist(), acceleration[:-1].tolist())

        # Half the time goes into the calls, so the arguments are made once.
        fmu, variables = self.instance.slave, self.instance.variables
        component = fmu.component
        reference = variables["head_displacement"].valueReference
        head, head_twice = (c_uint * 1)(reference), (c_uint * 2)(reference, reference)
        contact = (c_uint * 1)(variables["contact.force"].valueReference)
        orders = (c_int * 2)(1, 2)
        value, derivatives, force = (c_double * 1)(), (c_double * 2)(), (c_double * 1)()
        forces = []
        with self.instance.refusals():
            for i, (value[0], derivatives[0], derivatives[1]) in enumerate(command):
                fmu.fmi2SetReal(component, head, 1, value)
                fmu.fmi2SetRealInputDerivatives(component, head_twice, 2, orders, derivatives)
                fmu.fmi2DoStep(component, self._time + i * step, step, 1)
                fmu.fmi2GetReal(component, contact, 1, force)
                forces.append(force[0])
        self._time += len(forces) * step
        return np.array(forces)
