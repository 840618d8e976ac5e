"""Where in a record the bench holds one frequency and one amplitude.

The motion's phase is followed through the whole record (analytic signal); in a hold its whole turns come at even
times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

FEWEST_TURNS = 6  # of a hold
OUTLYING = 5.0  # standard deviations
APART = 0.02  # of a turn, from the line through all so far: where noise leaves it, the frequency is another
MOST_APART = 0.1  # of a turn: more noise than this hides the steps
FINE = 12  # values in a period of the band's highest frequency, at least
NEARBY = 15  # turns that tell the noise
AMPLITUDE_APART = 0.1  # relative, where noise leaves it


@dataclass(frozen=True)
class Turns:
    """Times (n,) in s at which the motion has completed a turn, and its amplitude (n,) over the one that follows."""

    time: np.ndarray
    amplitude: np.ndarray

    @property
    def noise(self) -> np.ndarray:
        """Standard deviation of single times in turns (n,), from second differences nearby."""
        if self.time.size < 2 * FEWEST_TURNS:
            return np.full(self.time.size, np.inf)
        from scipy.ndimage import median_filter

        step = np.diff(self.time)
        bent = np.abs(np.diff(step) / step[1:])
        return np.pad(1.4826 / np.sqrt(6) * median_filter(bent, NEARBY, mode="nearest"), 1, mode="edge")


@dataclass(frozen=True)
class Stretch:
    """A part of a record with one frequency."""

    begin: float  # s
    end: float
    frequency: float  # Hz, roughly
    amplitude: float  # of the motion as it was followed


def turns_of(start: float, rate: float, motion: np.ndarray, band: tuple[float, float]) -> Turns:
    """The turns of a motion (n,), evenly sampled from `start` in s at `rate` in Hz, within a band in Hz.

    A displacement comes as its slope: driven at one acceleration it is so much larger at low frequencies that what
    their holds leave in the filters would hide the others.
    """
    from scipy.fft import next_fast_len
    from scipy.signal import butter, hilbert, sosfiltfilt

    together = max(1, int(rate / (FINE * band[1])))  # values that are one
    motion = motion[: motion.size // together * together].reshape(-1, together).mean(1)
    start, rate = start + (together - 1) / (2 * rate), rate / together
    band = band[0], min(band[1], 0.45 * rate)
    if band[0] >= band[1] or motion.size < 40:
        return Turns(np.empty(0), np.empty(0))
    pad = min(motion.size - 1, int(3 * rate / band[0]))
    extended = np.pad(motion - motion.mean(), pad, mode="reflect")
    analytic = hilbert(extended, next_fast_len(extended.size))[: extended.size]
    sos = butter(2, band, "bandpass", fs=rate, output="sos")
    analytic = (sosfiltfilt(sos, analytic.real) + 1j * sosfiltfilt(sos, analytic.imag))[pad : pad + motion.size]
    # Noise alone would turn back and forth: only what exceeds all before counts.
    turn = np.maximum.accumulate(np.unwrap(np.angle(analytic)) / (2 * np.pi))
    whole = np.floor(turn)
    at = np.flatnonzero(np.diff(whole) > 0)
    if at.size < 2:
        return Turns(np.empty(0), np.empty(0))
    part = (whole[at + 1] - turn[at]) / (turn[at + 1] - turn[at])
    size = np.add.reduceat(np.abs(analytic), at + 1) / np.diff([*(at + 1), motion.size])
    return Turns(start + (at + part) / rate, size)


def holds_of(turns: Turns) -> list[Stretch]:
    """The stretches with one frequency and one amplitude, in order."""
    apart = np.clip(OUTLYING * turns.noise, APART, MOST_APART)
    found, first = [], 0
    while first + FEWEST_TURNS < turns.time.size:
        last = _last_of_hold(turns, first, float(apart[first + FEWEST_TURNS]))
        if last is None:
            first += 1
            continue
        # The first turns may still be of the way to the hold and end it early.
        for later in range(first + 1, min(first + FEWEST_TURNS, last - FEWEST_TURNS) + 1):
            end = _last_of_hold(turns, later, float(apart[later + FEWEST_TURNS]))
            if end is not None and end > last + 2:
                first, last = later, end
        period = (turns.time[last] - turns.time[first]) / (last - first)
        size = float(np.median(turns.amplitude[first:last]))
        found.append(Stretch(float(turns.time[first]), float(turns.time[last]), float(1 / period), size))
        first = last
    return _joined(found)


def _last_of_hold(turns: Turns, first: int, apart: float) -> int | None:
    """The last turn of the hold that begins with `first`; None where none does."""
    last = first + FEWEST_TURNS
    time, number = turns.time[first : last + 1], np.arange(FEWEST_TURNS + 1)
    slope, offset = np.polyfit(number, time, 1)
    size = np.median(turns.amplitude[first:last])
    # The noise that turns the phase by a radian makes the amplitude as much larger.
    alike = np.abs(turns.amplitude - size) <= max(AMPLITUDE_APART, 2 * np.pi * apart if apart > APART else 0.0) * size
    if np.abs(time - offset - slope * number).max() > apart * slope or not alike[first:last].all():
        return None
    # Sums for the line through all turns so far.
    n, sx, sy = number.size, float(number.sum()), float((time - time[0]).sum())
    sxx, sxy = float((number**2).sum()), float((number * (time - time[0])).sum())
    while last + 1 < turns.time.size:
        slope = (n * sxy - sx * sy) / (n * sxx - sx * sx)
        x, y = last + 1 - first, turns.time[last + 1] - turns.time[first]
        off = y - (sy - slope * sx) / n - slope * x
        if abs(off) > apart * slope or not alike[last]:
            break
        n, sx, sy, sxx, sxy = n + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
        last += 1
    return last


def _joined(holds: Sequence[Stretch]) -> list[Stretch]:
    """Holds that a disturbance of the motion has cut are one again: of one frequency, in phase, and near."""
    joined: list[Stretch] = []
    for hold in holds:
        if joined:
            before = joined[-1]
            gap = (hold.begin - before.end) * before.frequency
            turns = min(each.frequency * (each.end - each.begin) for each in (before, hold))
            alike = abs(hold.frequency / before.frequency - 1) < 2 * APART / turns
            alike &= abs(hold.amplitude / before.amplitude - 1) < AMPLITUDE_APART
            if alike and 0 <= gap < FEWEST_TURNS and abs(gap - round(gap)) < 2 * APART:
                joined[-1] = replace(before, end=hold.end)
                continue
        joined.append(hold)
    return joined
