"""Measured frequency responses, one curve for each amplitude, whatever file they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError


@dataclass(frozen=True)
class Curve:
    """Receptance measured with one amplitude."""

    label: str  # of the amplitude, with its unit
    frequency: np.ndarray  # (n,) Hz, increasing
    acceleration: np.ndarray  # (n,) m/s2, peak
    H: np.ndarray  # (n,) m/N, complex

    def within(self, band: tuple[float, float]) -> Curve:
        """The points with frequencies in the band (Hz)."""
        return self.at((self.frequency >= band[0]) & (self.frequency <= band[1]))

    def at(self, points: np.ndarray) -> Curve:
        """Only some points, by index or by mask."""
        return replace(self, frequency=self.frequency[points], acceleration=self.acceleration[points], H=self.H[points])


@dataclass(frozen=True)
class Source:
    """A file of measured responses and what the file does not tell."""

    path: Path
    amplitude: float | None = None  # m/s2, peak
    force: str = "specimen"  # positive along the displacement, or "contact": positive pressing the head down
    fixture_mass: float = 0.0  # kg, of what moves between load cell and head
    data_sets: tuple[int, ...] = ()  # of a universal file, those to read, from 1; empty: those of its driving point

    def corrected(self, curve: Curve) -> Curve:
        """With this sign of the force, and without the inertia of the fixture: F_head = F_cell - m a."""
        H = -curve.H if self.force == "contact" else curve.H
        stiffness = 1 / H + self.fixture_mass * (2 * np.pi * curve.frequency) ** 2
        return replace(curve, H=1 / stiffness)


def in_band(curves: Sequence[Curve], band: tuple[float, float]) -> list[Curve]:
    """The curves within a frequency band (Hz). Raises ZSpringError if one has no point there."""
    kept = [curve.within(band) for curve in curves]
    for before, after in zip(curves, kept):
        if not after.frequency.size:
            low, high = before.frequency[[0, -1]]
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
        'gave energy out: is the force counted as contact force (force = "contact"), or the phase reversed?'
    )
