"""Sines in noise: the frequency that was driven, amplitudes from period to period, and how far their mean is known.

IEEE 1057 (annex of sine-wave fitting) has the four-parameter fit; here with harmonics and a slope beside it, which else
would bend the frequency. Complex amplitudes A count as Re(A exp(i k omega t)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ..bench.responses import HARMONICS

Number = TypeVar("Number", float, np.ndarray)

MOST = HARMONICS[-1]  # harmonics that are told
MOST_ROUNDS = 30
FEWEST_PERIODS = 5  # whose scatter tells an error
DISTURBED = 3.0  # times the usual residual of a period
DEAD = 0.1  # times the same


def basis(time: np.ndarray, frequency: float, harmonics: int) -> np.ndarray:
    """Columns 1 and cos, -sin of each harmonic (n, 1 + 2 harmonics) at times (n,) in s."""
    turning = np.exp(2j * np.pi * frequency * time)
    powers = np.cumprod(np.broadcast_to(turning[:, None], (time.size, harmonics)), axis=1)
    return np.column_stack([np.ones_like(time), powers.real, -powers.imag])


def harmonics_within(rate: float, frequency: float) -> int:
    """How many harmonics a sampling rate in Hz tells, at most MOST, with a third of the values left for noise."""
    return int(min(MOST, 0.3 * rate / frequency))


def fit_frequency(time: np.ndarray, values: np.ndarray, guess: float, harmonics: int) -> float:
    """The frequency (Hz) of values (n,) at times (n,) in s by least squares, from a guess within 1 / (2 duration).

    Gauss-Newton as IEEE 1057 has it: the change of frequency is one more column of the linear fit.
    """
    time = time - time.mean()
    order = np.arange(1, harmonics + 1)
    frequency, scale = guess, max(np.ptp(time), np.finfo(float).tiny)
    for _ in range(MOST_ROUNDS):
        columns = np.column_stack([basis(time, frequency, harmonics), time / scale])
        amplitudes = solved(columns, values)
        real, imaginary = amplitudes[1 : harmonics + 1], amplitudes[harmonics + 1 : -1]
        # d/df of cos is 2 pi t k times -sin, that of -sin is minus 2 pi t k times cos.
        weights = np.concatenate([[0], -order * imaginary, order * real, [0]])
        slope = 2 * np.pi * time / scale * (columns @ weights)
        change = float(np.clip(solved(np.column_stack([columns, slope]), values)[-1], -0.25, 0.25)) / scale
        frequency += change
        if abs(change) * scale < 1e-9:
            break
    return frequency


def solved(columns: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Least squares by the normal equations: sines are nearly orthogonal."""
    return np.linalg.lstsq(columns.T @ columns, columns.T @ values, rcond=None)[0]


@dataclass(frozen=True)
class Periods:
    """Of one channel, the complex amplitudes of M periods, each fitted for itself."""

    amplitude: np.ndarray  # (M, harmonics); NaN where values are missing
    residual: np.ndarray  # (M,) rms of what is not periodic within the period
    mean: float  # of the channel
    slope: float  # of the channel, in its unit per s, taken off before
    clipped: bool = False  # somewhere


def by_period(time: np.ndarray, values: np.ndarray, frequency: float, harmonics: int) -> Periods:
    """The amplitudes in the whole periods from the first time on; phases count from there.

    values  (n,) with NaN for missing ones
    A drift, which within a period looks like a sine, is taken off: its slope is the usual one between the means of
    undisturbed periods that are half of their number apart.
    """
    time = time - time[0]
    count = int(np.floor(time[-1] * (1 + 1 / max(time.size - 1, 1)) * frequency + 1e-9))
    ends = np.searchsorted(np.floor(time * frequency + 1e-9), np.arange(count + 1))
    columns = basis(time, frequency, harmonics)
    both = np.column_stack([values, time])
    missing = ~np.isfinite(values)
    found = np.full((count, columns.shape[1], 2), np.nan)
    for m, block in enumerate(map(slice, ends, ends[1:])):
        if block.stop - block.start > columns.shape[1] and not missing[block].any():
            found[m] = solved(columns[block], both[block])

    def residuals(slope: float) -> tuple[np.ndarray, np.ndarray]:
        weights, rms = found[..., 0] - slope * found[..., 1], np.full(count, np.nan)
        for m, block in enumerate(map(slice, ends, ends[1:])):
            if np.isfinite(weights[m, 0]):
                rest = values[block] - slope * time[block] - columns[block] @ weights[m]
                rms[m] = math.sqrt(float(rest @ rest) / (rest.size - columns.shape[1]))
        return weights, rms

    slope = _slope(found[undisturbed(residuals(0.0)[1])][:, 0])
    weights, residual = residuals(slope)
    amplitude = weights[:, 1 : harmonics + 1] + 1j * weights[:, harmonics + 1 :]
    mean = float(np.nanmedian(found[:, 0, 0])) if np.isfinite(found).any() else math.nan
    return Periods(amplitude, residual, mean, slope)


def undisturbed(residual: np.ndarray, floor: float = 0.0) -> np.ndarray:
    """Which periods (M,) have the usual residual: missing values, dropouts, knocks and dead channels have not.

    floor   rms that rounding alone makes
    """
    there = np.isfinite(residual)
    if not there.any():
        return there
    usual = np.median(residual[there])
    with np.errstate(invalid="ignore"):
        return (residual <= DISTURBED * max(usual, floor)) & (residual >= DEAD * usual - floor)


def _slope(means: np.ndarray) -> float:
    """The usual slope between values and times (M, 2) that are half of their number apart."""
    far = len(means) // 2
    steps = means[far:] - means[: len(means) - far]
    return float(np.median(steps[:, 0] / steps[:, 1])) if far else 0.0


def variance_of_mean(values: np.ndarray, trend: bool = False) -> tuple[float, int]:
    """Variance of the mean of values (M,) in the order of time, which may hang together, and how many numbers tell it.

    trend   take off a straight line: it is no noise

    From the slowest B cosine transforms, equally weighted (Lazarus, Lewis, Stock, Watson 2018): the noise near the
    frequency itself counts, not that of the whole period. With B = M - 1 it is the scatter's usual formula. B numbers
    tell it. NaN for fewer than FEWEST_PERIODS.
    """
    from scipy.fft import dct  # slow to load

    count = values.size
    if count < FEWEST_PERIODS + trend:
        return math.nan, 0
    values = without_trend(values) if trend else values
    told = min(count - 1 - trend, max(6, round(count ** (2 / 3) / 1.5)))
    slowest = dct(values, type=2, norm="ortho")[1 + trend : told + 1 + trend]
    return float(np.mean(slowest**2) / count), told


def error_of_mean(values: np.ndarray, trend: bool = False) -> float:
    """Standard error of the mean of values (M,), see variance_of_mean."""
    return math.sqrt(students(*variance_of_mean(values, trend)))


def students(variance: Number, freedom: Number) -> Number:
    """Variance of what so many numbers tell the variance of: that of Student's distribution (JCGM 101:2008, 6.4.9).

    +- 1.96 of its root is a 95 % interval, for few numbers as for many.
    """
    return variance * freedom / (freedom - 2)


def without_trend(values: np.ndarray) -> np.ndarray:
    """Values (M,) without the straight line through them, but with their mean."""
    place = np.arange(values.size) - (values.size - 1) / 2
    return values - place * (place @ values) / (place @ place)


def errors_of_means(amplitudes: np.ndarray) -> np.ndarray:
    """Standard errors (K,) of the real and imaginary parts of the means of complex amplitudes (M, K), both as one."""
    parts = [[error_of_mean(part) for part in (column.real, column.imag)] for column in amplitudes.T]
    return np.sqrt(np.mean(np.square(parts), axis=1))
