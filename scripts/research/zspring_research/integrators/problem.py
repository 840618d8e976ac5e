"""What is integrated, its converged solution, and how far another solution is from that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from .model import UPPER_FRAME, bench_model, contact_force
from .peers import solve

SAMPLES = 200  # intervals of the last period, for the peers
FINE_SAMPLES = 4000  # the same for the reference


@dataclass(frozen=True)
class Errors:
    """Relative errors over the last period: H, and in the root mean square upper frame and contact force."""

    H: float
    frame: float
    force: float


class Problem:
    """One bench run from rest, the ramp's period and `periods` more, and its reference solution.

    parameters      the FMU's, calculated ones included
    frequency       of the bench in Hz; acceleration: peak of the head in m/s2
    The reference is Radau's (order 5) with a relative tolerance of 1e-10; `doubt` are the errors that CVODE
    (BDF, 1e-10) has by it.
    """

    def __init__(self, parameters: Mapping[str, float], frequency: float, acceleration: float, periods: int):
        self.model = bench_model(parameters, frequency, acceleration)
        self.frequency, self.end = frequency, (1 + periods) / frequency
        self.times = self._last_period(SAMPLES)
        fine = self._last_period(FINE_SAMPLES)
        states = solve("Radau", self.model, fine, 1e-10, 0.01).states
        force = contact_force(fine, states, self.model)
        self._frame = CubicSpline(fine, states[:, UPPER_FRAME])
        self._force = CubicSpline(fine, force)
        self.doubt = self.errors_of_states(solve("CVODE", self.model, self.times, 1e-10, 0.01).states)

    def _last_period(self, samples: int) -> np.ndarray:
        return self.end - np.arange(samples, -1, -1) / (samples * self.frequency)

    def receptance(self, times: np.ndarray, force: np.ndarray) -> complex:
        """H = -Z/F in m/N from the contact force over one period, by the trapezoidal rule as in the FMU."""
        turn = np.exp(-2j * np.pi * self.frequency * times)
        return 1j * self.model["peak"][0] / (2 * self.frequency * np.trapezoid(force * turn, times))

    def errors_of_states(self, states: np.ndarray) -> Errors:
        """Errors of the states (n, 8) at `times`."""
        force = contact_force(self.times, states, self.model)
        return self.errors(self.times, states[:, UPPER_FRAME], force, self.receptance(self.times, force))

    def errors(self, times: np.ndarray, frame: np.ndarray, force: np.ndarray, H: complex) -> Errors:
        """Errors of upper frame (m) and contact force less static force (N), at `times`, and of H (m/N).

        H is compared with that of the reference at the same times, so that only the integration is judged.
        """
        inside = np.clip(times, self._frame.x[0], self.end)  # rounding of the communication points

        def rms_error(values: np.ndarray, exact: CubicSpline) -> float:
            reference = exact(inside)
            return float(np.sqrt(np.mean((values - reference) ** 2) / np.mean(reference**2)))

        exact_H = self.receptance(times, self._force(inside))
        return Errors(float(abs(H / exact_H - 1)), rms_error(frame, self._frame), rms_error(force, self._force))
