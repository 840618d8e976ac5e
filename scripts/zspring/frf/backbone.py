"""Resonances of a curve by phase, and how they belong to those by peak: what a backbone is drawn through.

By phase: where H passes -90 degrees falling, so that its real part changes from positive to negative as the frequency
rises. A strongly damped mode, or one on the flank of another, has a peak and no such place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ..bench.control import FORCE, acceleration_at
from ..bench.points import FrfPoint
from ..bench.refine import Extreme
from ..receptance import LinearModel
from .bounds import FINE


@dataclass(frozen=True)
class PhaseResonance:
    """With an estimate of the error; 0 where it is exact."""

    frequency: float  # Hz
    frequency_error: float
    magnitude: float  # m/N


@dataclass(frozen=True)
class Row:
    """Extremes of one curve, ascending: of a linear bound, or of a level swept in a direction."""

    curve: str
    direction: str
    extremes: Sequence[Extreme]
    phases: Sequence[PhaseResonance] = ()
    level: float = math.nan  # in `unit`; NaN of a bound
    unit: str = ""

    @property
    def highest(self) -> Extreme | None:
        """The resonance of the largest |H|."""
        return max((e for e in self.extremes if e.is_resonance), key=lambda e: e.magnitude, default=None)

    def by_phase(self, i: int) -> PhaseResonance | None:
        """The resonance by phase that belongs to extreme i: the nearest one between the antiresonances beside it."""
        if not self.extremes[i].is_resonance:
            return None
        low = max((e.frequency for e in self.extremes[:i] if not e.is_resonance), default=0.0)
        high = min((e.frequency for e in self.extremes[i + 1 :] if not e.is_resonance), default=math.inf)
        inside = [p for p in self.phases if low < p.frequency < high]
        return min(inside, key=lambda p: abs(p.frequency - self.extremes[i].frequency), default=None)

    def displacement(self, extreme: Extreme) -> float:
        """Peak displacement of the head there in m."""
        if self.unit == FORCE:
            return self.level * extreme.magnitude
        omega = 2 * math.pi * extreme.frequency
        return acceleration_at(self.level, self.unit, extreme.frequency) / omega**2 if self.unit else math.nan


def phase_resonances(points: Sequence[FrfPoint]) -> list[PhaseResonance]:
    """Those between points by ascending frequency, by cubics of the cosine of the phase and of log |H|.

    Its error: the difference to a parabola, and what the points' own errors make.
    """
    known = [p for p in points if math.isfinite(abs(p.H))]
    f, cosine = np.array([p.frequency for p in known]), np.array([p.H.real / abs(p.H) for p in known])
    level = np.log([abs(p.H) for p in known])
    found = []
    for i in np.flatnonzero((cosine[:-1] > 0) & (cosine[1:] <= 0)):
        near = slice(max(i - 1, 0), i + 3)
        cubic, parabola = (_zero(f[part], cosine[part], f[i], f[i + 1]) for part in (near, slice(near.start, i + 2)))
        slope = abs(cosine[i + 1] - cosine[i]) / (f[i + 1] - f[i])
        error = abs(cubic - parabola) + max(known[i].remaining, known[i + 1].remaining) / slope
        magnitude = math.exp(np.polynomial.Polynomial.fit(f[near], level[near], len(f[near]) - 1)(cubic))
        found.append(PhaseResonance(cubic, float(error), magnitude))
    return found


def _zero(x: np.ndarray, y: np.ndarray, low: float, high: float) -> float:
    """Between low and high, of the polynomial through all points (n,) with a change of sign there."""
    polynomial = np.polynomial.Polynomial.fit(x, y, len(x) - 1)
    if polynomial(low) * polynomial(high) > 0:  # by rounding, where a point is the zero
        return low if abs(polynomial(low)) < abs(polynomial(high)) else high
    return float(brentq(polynomial, low, high))


def exact_phase_resonances(model: LinearModel, band: tuple[float, float]) -> list[PhaseResonance]:
    """Those of a linear model within a band (Hz)."""

    def real(frequency: float) -> float:
        return float(model.receptance(np.array([frequency]))[0].real)

    f = np.linspace(*band, FINE)
    part = model.receptance(f).real
    zeros = [brentq(real, f[i], f[i + 1]) for i in np.flatnonzero((part[:-1] > 0) & (part[1:] <= 0))]
    return [PhaseResonance(zero, 0.0, float(abs(model.receptance(np.array([zero]))[0]))) for zero in zeros]
