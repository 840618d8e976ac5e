"""A part of a record and the sine that was driven in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .signals import Record, Signal
from .sine import Periods, by_period, fit_frequency, undisturbed
from .steady import usual
from .track import Stretch


@dataclass(frozen=True)
class Window:
    """Values [first, last) of a record, and what was driven there."""

    record: Record
    first: int
    last: int
    frequency: float  # Hz
    harmonics: int  # that the sampling rate tells

    @property
    def begin(self) -> float:
        """Time in s from which periods and phases count."""
        return float(self.record.time[self.first])

    @property
    def order(self) -> np.ndarray:
        return np.arange(1, self.harmonics + 1)

    def values(self, signal: Signal, begin: float, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Times since `begin` and values of a channel within these times in s, without missing ones."""
        time = self.record.time[self.first : self.last]
        values, _ = signal.without_flat(slice(self.first, self.last), self.record.rate, self.frequency)
        inside = np.isfinite(values) & (time >= begin) & (time < end)
        return time[inside] - begin, values[inside]

    def periods(self, signal: Signal) -> Periods:
        """Amplitudes of the periods of a channel, its delay taken off."""
        part = slice(self.first, self.last)
        values, clipped = signal.without_flat(part, self.record.rate, self.frequency)
        found = by_period(self.record.time[part], values, self.frequency, self.harmonics)
        turned = found.amplitude * np.exp(2j * np.pi * self.frequency * self.order * signal.delay)
        return replace(found, amplitude=turned, clipped=clipped)

    def to_displacement(self, motion: str) -> np.ndarray:
        """Factors (harmonics,) from amplitudes of a motion, by its name, to displacement in m."""
        omega = 2 * np.pi * self.frequency * self.order
        return -1 / omega**2 if motion == "acceleration" else np.ones(self.harmonics)


def located(record: Record, hold: Stretch, motion: Signal, harmonics: int) -> Window:
    """The window of a hold, with the frequency that was driven.

    Its ends may reach into the neighbours: first the frequency is that of the middle, then that of all periods that
    are as usual.
    """
    first, last = map(int, np.searchsorted(record.time, [hold.begin, hold.end]))
    window = Window(record, first, last, hold.frequency, harmonics)
    length = hold.end - hold.begin
    begin, end = hold.begin + length / 4, hold.end - length / 4
    for _ in range(2):
        time, values = window.values(motion, begin, end)
        if time.size < 4 * (harmonics + 1):
            break
        window = replace(window, frequency=fit_frequency(time, values, window.frequency, harmonics))
        found = window.periods(motion)
        good = np.flatnonzero(undisturbed(found.residual, motion.step) & usual(found.amplitude[:, 0]))
        if good.size < 2:
            break
        begin, end = window.begin + np.array([good[0], good[-1] + 1]) / window.frequency
    first, last = np.searchsorted(record.time, [begin - 1e-6 / record.rate, end])
    return replace(window, first=int(first), last=int(last))
