"""Measured frequency responses, one curve for each level of the amplitude, whatever file they come from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError

SENSES = {"specimen": 1, "contact": -1}  # a force along the displacement; one that presses the head down
AT_END = 1e-3  # relative distance of a frequency from the end of a band that it still belongs to
# Distance of frequencies and of levels, in their logarithms, at which points share 1/e of what is common to their
# errors. The harmonics of a shaker's motion, of phases that nobody knows, change H in a pattern that turns its sign
# within a third of an octave. Errors taken as one over all points leave no room for it: worse than independent ones.
REACH = 0.2, 1.0
WRONG_SIGN = 'is it counted as contact force (force = "contact")?'


@dataclass(frozen=True)
class Harmonics:
    """Of the contact force, of orders 2 to 7; NaN where one was not measured."""

    peak: np.ndarray  # (n, 6) N
    error: np.ndarray  # (n, 6) N, standard errors; NaN where they are not known

    def at(self, points: np.ndarray) -> Harmonics:
        return Harmonics(self.peak[points], self.error[points])


@dataclass(frozen=True)
class Curve:
    """Receptance measured at one level of the amplitude, in the order of the file."""

    label: str  # of the level, with its unit
    frequency: np.ndarray  # (n,) Hz
    acceleration: np.ndarray  # (n,) m/s2, peak, of each point its own
    H: np.ndarray  # (n,) m/N, complex
    error: np.ndarray | None = None  # (n, 2) standard errors: of the magnitude, relative, and of the phase, rad
    common: np.ndarray | None = None  # (n,) the part of either that neighbouring points share, relative
    harmonics: Harmonics | None = None

    @property
    def displacement(self) -> np.ndarray:
        """Peaks (n,) in m."""
        return self.acceleration / (2 * np.pi * self.frequency) ** 2

    def within(self, band: tuple[float, float]) -> Curve:
        """The points with frequencies in the band (Hz), those included that a bench drove a little beside its ends."""
        return self.at((self.frequency >= band[0] * (1 - AT_END)) & (self.frequency <= band[1] * (1 + AT_END)))

    def refined(self, points: int) -> Curve:
        """With as many places between two points as it takes to that many, and at least one.

        Amplitudes are in between, H is not known there: NaN. As it is where the frequencies do not all rise or all
        fall.
        """
        steps = np.diff(self.frequency)
        if not steps.size or not (np.all(steps > 0) or np.all(steps < 0)):
            return self
        parts = max(2, math.ceil(points / steps.size))
        places, known = np.arange(steps.size * parts + 1) / parts, np.arange(self.frequency.size)
        acceleration = np.exp(np.interp(places, known, np.log(self.acceleration)))
        H = np.full(places.shape, np.nan + 0j)
        H[::parts] = self.H
        return Curve(self.label, np.interp(places, known, self.frequency), acceleration, H)

    def at(self, points: np.ndarray) -> Curve:
        """Only some points, by index or by mask."""
        return Curve(
            self.label,
            self.frequency[points],
            self.acceleration[points],
            self.H[points],
            None if self.error is None else self.error[points],
            None if self.common is None else self.common[points],
            self.harmonics and self.harmonics.at(points),
        )


@dataclass(frozen=True)
class Source:
    """A file of measured responses and what the file does not tell."""

    path: Path
    amplitude: float | None = None  # m/s2, peak
    force: str = "specimen"  # of SENSES
    fixture_mass: float = 0.0  # kg, of what moves between load cell and head
    data_sets: tuple[int, ...] = ()  # of a universal file, those to read, from 1; empty: those of its driving point

    def corrected(self, curve: Curve) -> Curve:
        """With this sign of the force, and without the inertia of the fixture: F_head = F_cell - m a."""
        H = SENSES[self.force] * curve.H
        stiffness = 1 / H + self.fixture_mass * (2 * np.pi * curve.frequency) ** 2
        factor = 1 / stiffness / H
        common = None if curve.common is None else np.abs(factor) * curve.common
        return replace(curve, H=1 / stiffness, error=_turned(curve.error, factor), common=common)


def _turned(error: np.ndarray | None, factor: np.ndarray) -> np.ndarray | None:
    """Errors (n, 2) of a logarithm that is multiplied by complex factors (n,): d ln(1/D) = -dD/D, dD being the same."""
    if error is None:
        return None
    real, imaginary = factor.real**2, factor.imag**2
    magnitude, phase = error.T**2
    return np.sqrt(np.column_stack([real * magnitude + imaginary * phase, imaginary * magnitude + real * phase]))


def in_band(curves: Sequence[Curve], band: tuple[float, float]) -> list[Curve]:
    """The curves within a frequency band (Hz). Raises ZSpringError if one has no point there."""
    kept = [curve.within(band) for curve in curves]
    for before, after in zip(curves, kept):
        if not after.frequency.size:
            low, high = before.frequency.min(), before.frequency.max()
            raise ZSpringError(
                f"band {band[0]:g} to {band[1]:g} Hz: no data with {before.label}, which was measured from "
                f"{low:g} to {high:g} Hz"
            )
    return kept


def sign_warning(curves: Sequence[Curve]) -> str | None:
    """What to say if most points give energy out, which no passive pantograph does."""
    imaginary = np.concatenate([curve.H.imag for curve in curves])
    wrong = int(np.sum(imaginary > 0))
    if 2 * wrong <= imaginary.size:
        return None
    return (
        f"at {wrong} of {imaginary.size} points the receptance has a positive imaginary part, as if the head "
        f"gave energy out: is the phase of the force reversed, or {WRONG_SIGN}"
    )
