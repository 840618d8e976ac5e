"""Which periods of a hold count: with the usual motion, and settled; and whether they are all alike."""

from __future__ import annotations

import numpy as np

from .sine import FEWEST_PERIODS, by_period, errors_of_means

AMPLITUDE_OFF = 0.10  # relative distance of a period's motion from the usual one
OUTLYING = 6.0  # times the median distance from the middle
UNSTEADY = 6.0  # distance of the last third of the periods from the first, in errors
SLIGHT = 1e-3  # relative change that counts for nothing
REPEATS = (2, 3, 4)  # periods after which a response may repeat
SUBHARMONIC = 0.01  # of the fundamental: less is not told
CLEAR = 8.0  # standard errors, of one in some dozens of components


def usual(amplitude: np.ndarray) -> np.ndarray:
    """Which complex amplitudes (M,) are near to the middle of all: within AMPLITUDE_OFF, or what most of them leave."""
    if not np.isfinite(amplitude).any():
        return np.zeros(amplitude.size, bool)
    middle = np.nanmedian(amplitude.real) + 1j * np.nanmedian(amplitude.imag)
    off = np.abs(amplitude - middle)
    near = np.clip(OUTLYING * np.nanmedian(off), SLIGHT * abs(middle), AMPLITUDE_OFF * abs(middle))
    with np.errstate(invalid="ignore"):
        return off <= near


def settled(ratio: np.ndarray) -> tuple[int, float]:
    """From which of the complex values (M,) on they are settled, and their relative change where they are not.

    As long as the first and the last third differ by more than their scatter explains, the first quarter is left out.
    The test is so strict that it does not choose what looks steady by chance.
    """
    begin = 0
    while True:
        values = ratio[begin:]
        third = values.size // 3
        if third < 2:
            return begin, 0.0
        first, last = values[:third], values[-third:]
        middle = abs(values.mean())
        change, changed = last.mean() - first.mean(), False
        for part in (np.real, np.imag):
            scatter = np.sqrt((part(first).var(ddof=1) + part(last).var(ddof=1)) / third)
            changed |= abs(part(change)) > max(UNSTEADY * scatter, SLIGHT * middle)
        if not changed:
            return begin, 0.0
        if values.size - values.size // 4 < 2 * FEWEST_PERIODS:
            return begin, float(abs(change) / middle)
        begin += values.size // 4


def repeats_after(time: np.ndarray, values: np.ndarray, frequency: float, harmonics: int) -> tuple[int, float]:
    """Periods after which values (n,) at times (n,) repeat, and how large what does so is beside the fundamental.

    1 and 0 where no component at multiples of a half, third or quarter of the frequency exceeds SUBHARMONIC and, over
    blocks of so many periods, its scatter; too few of them tell none.
    """
    found = 1, 0.0
    for repeat in REPEATS if harmonics > 1 else ():
        amplitude = by_period(time, values, frequency / repeat, min(harmonics, 3) * repeat).amplitude
        amplitude = amplitude[np.isfinite(amplitude[:, 0])]
        if len(amplitude) < FEWEST_PERIODS:
            break
        size = np.abs(amplitude.mean(0))
        between = np.flatnonzero(np.arange(1, 2 * repeat) % repeat)
        clear = size[between] > np.maximum(
            CLEAR * errors_of_means(amplitude[:, between]), SUBHARMONIC * size[repeat - 1]
        )
        largest = float(size[between].max() / size[repeat - 1])
        if clear.any() and largest > found[1]:
            found = repeat, largest
    return found
