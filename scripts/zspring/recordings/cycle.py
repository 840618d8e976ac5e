"""A hold's steady periods laid over each other, to look at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .points import Point
from .settings import Settings
from .signals import Record
from .sine import basis, harmonics_within
from .window import Window

FINE = 400  # points of a smooth period
MOST_SHOWN = 20_000  # values


@dataclass(frozen=True)
class Cycle:
    """Force of the head about its mean, over the phase in turns; the motion rises through its middle at 0."""

    phase: np.ndarray  # (n,) of values
    force: np.ndarray  # (n,) N, as measured, without the inertia of the fixture
    at: np.ndarray  # (n,) m, displacement then
    smooth_phase: np.ndarray  # (FINE + 1,)
    smooth_force: np.ndarray  # N, of the harmonics
    fundamental: np.ndarray  # N
    displacement: np.ndarray  # m


def cycle_of(record: Record, point: Point, settings: Settings) -> Cycle:
    """Of a point of that record that is used."""
    first, last = map(int, np.searchsorted(record.time, [point.begin, point.end]))
    window = Window(record, first, last, point.frequency, harmonics_within(record.rate, point.frequency))
    name, motion = next(iter(record.motions.items()))
    z = np.nanmean(window.periods(motion).amplitude, axis=0) * window.to_displacement(name)
    forces = window.periods(record.force)
    inertia = settings.fixture_mass * (2 * np.pi * point.frequency * window.order) ** 2 * z
    f = np.nanmean(forces.amplitude, axis=0) - inertia

    def over(time: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
        columns = basis(time, point.frequency, window.harmonics)[:, 1:]
        return columns @ np.concatenate([amplitudes.real, amplitudes.imag])

    time, values = window.values(record.force, window.begin, point.end)
    thin = slice(None, None, max(1, values.size // MOST_SHOWN))
    values = (values - forces.mean - forces.slope * (time - time.mean()))[thin]
    time = time[thin] - record.force.delay
    start = -0.25 - np.angle(z[0]) / (2 * np.pi)  # turns, where the fundamental of the motion rises through 0
    turns = np.linspace(0, 1, FINE + 1)
    smooth = (turns + start) / point.frequency
    return Cycle(
        phase=(time * point.frequency - start) % 1,
        force=values - over(time, inertia),
        at=over(time, z),
        smooth_phase=turns,
        smooth_force=over(smooth, f),
        fundamental=over(smooth, f * (window.order == 1)),
        displacement=over(smooth, z),
    )
