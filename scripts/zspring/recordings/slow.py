"""A slow continuous sweep: one point from each stretch of some turns.

Within a stretch time is bent so that the sweep is a steady sine in it: then it is a hold along which H changes evenly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import ZSpringError
from .evaluate import evaluate, told
from .points import Point
from .settings import Settings, Sweep
from .signals import Record, Signal
from .track import Stretch, Turns

OFF = 0.2  # relative distance of the rate that was found from the one that was told
LAGS = 0.02  # relative share of the sweep's rate in H that is marked
NEAR, QUIET = 0.1, LAGS / 4  # relative distance in frequency; relative noise of that share


@dataclass(frozen=True)
class Rate:
    """How the frequency goes: by `linear` in Hz/s, or by `growth` in 1/s of what it is; negative downward."""

    linear: float = 0.0
    growth: float = 0.0

    def at(self, frequency: float) -> float:
        """Its change in Hz/s."""
        return self.linear + self.growth * frequency

    def bent(self, time: np.ndarray, frequency: float) -> np.ndarray:
        """Times (n,) in s, about 0, as a sine with the frequency that there is at 0 would have them."""
        if self.growth:
            return np.expm1(self.growth * time) / self.growth
        return time + self.linear / frequency * time**2 / 2


def swept_points(record: Record, parts: Sequence[Turns], settings: Settings) -> list[Point]:
    """The points of a record whose parts have these turns.

    Raises ZSpringError where there are too few turns, or their rate is not the one of the settings.
    """
    sweep, count = settings.sweep, settings.sweep.periods
    low, high = sweep.band
    stretches = [
        (float(part.time[i]), float(part.time[i + count]))
        for part in parts
        for i in range(0, part.time.size - count, count)
        if low <= count / (part.time[i + count] - part.time[i]) <= high
    ]
    if len(stretches) < 3:
        text = f"{record.path}: no sweep: {len(stretches)} stretches of {count} turns"
        raise ZSpringError(f"{text} within {low:g} to {high:g} Hz, 3 at least are needed")
    rate = _rate(record, np.array(stretches), sweep)
    points = told([_point(record, begin, end, rate, settings) for begin, end in stretches], settings)
    return _with_lag(points, rate)


def _rate(record: Record, stretches: np.ndarray, sweep: Sweep) -> Rate:
    """The rate of the settings, in the direction that is found."""
    frequency, middle = sweep.periods / np.diff(stretches)[:, 0], stretches.mean(1)
    values = np.log2(frequency) if sweep.octaves else frequency
    told, unit = (sweep.octaves, "octaves a minute") if sweep.octaves else (sweep.rate, "Hz/s")
    found = float(np.median(np.diff(values) / np.diff(middle))) * (60 if sweep.octaves else 1)
    if told is None or abs(abs(found) / told - 1) > OFF:
        raise ZSpringError(f"{record.path}: the sweep goes by {found:.3g} {unit}, the settings say {told:g}")
    signed = math.copysign(told, found)
    return Rate(growth=signed * math.log(2) / 60) if sweep.octaves else Rate(linear=signed)


def _point(record: Record, begin: float, end: float, rate: Rate, settings: Settings) -> Point:
    middle, frequency = (begin + end) / 2, settings.sweep.periods / (end - begin)
    first, last = map(int, np.searchsorted(record.time, [begin, end]))

    def cut(signal: Signal) -> Signal:
        return replace(signal, values=signal.values[first:last], beyond=signal.beyond[first:last])

    part = replace(
        record,
        time=rate.bent(record.time[first:last] - middle, frequency),
        parts=[(0, last - first)],
        force=cut(record.force),
        motions={name: cut(motion) for name, motion in record.motions.items()},
    )
    low, high = rate.bent(np.array([begin - middle, end - middle]), frequency)
    point = evaluate(part, Stretch(float(low), float(high), frequency, 0.0), settings, swept=True)
    # The periods that count need not lie about the middle.
    there = point.frequency + rate.at(point.frequency) * (point.begin + point.end) / 2
    acceleration = point.acceleration * (there / point.frequency) ** 2
    return replace(point, begin=begin, end=end, frequency=there, acceleration=acceleration)


def _with_lag(points: list[Point], rate: Rate) -> list[Point]:
    """With what the sweep's rate makes of H, in the errors and, where it is large, as a mark.

    With the dynamic stiffness G over the angular frequency w the force is that of G - i w' G'' / 2 (first term of the
    expansion in the rate w'), and the mean over a stretch of d rad/s that of G + d^2 G'' / 24. G'' is that of a
    parabola through the points about each, less the share of their noise.
    """
    used = [point for point in points if not point.left_out]
    if len(used) < 3:
        return points
    omega = 2 * np.pi * np.array([point.frequency for point in used])
    G = 1 / np.array([point.H for point in used])
    error = np.array([max(point.magnitude_error, point.phase_error) for point in used])
    pace = 2 * np.pi * np.array([rate.at(point.frequency) for point in used])
    swept = pace * [point.end - point.begin for point in used]
    factor = np.hypot(pace / 2, swept**2 / 24)
    lagging = {id(point): _lag(i, omega, G, error, factor[i]) for i, point in enumerate(used)}
    return [_lagging(point, lagging.get(id(point), 0.0)) for point in points]


def _lag(i: int, omega: np.ndarray, G: np.ndarray, error: np.ndarray, factor: float) -> float:
    """Relative share of point i, `factor` times its G''.

    Second differences of noise grow with the square of how close points are: the parabola takes in as few of them as
    make its noise small beside the point's own error, or those within NEAR.
    """
    for reach in range(1, (omega.size - 1) // 2 + 1):
        first = min(max(i - reach, 0), omega.size - 2 * reach - 1)
        near = slice(first, first + 2 * reach + 1)
        apart = omega[near] - omega[i]
        width = np.abs(apart).max()
        if reach > 1 and width > NEAR * omega[i]:
            break
        weights = 2 * np.linalg.pinv(np.vander(apart / width, 3))[0] / width**2 * G[near] / G[i]
        share, noise = factor * abs(weights.sum()), factor * np.linalg.norm(weights * error[near])
        if noise < max(QUIET, error[i] / 2):
            break
    return math.sqrt(max(share**2 - noise**2, 0))


def _lagging(point: Point, share: float) -> Point:
    mark = (f"swept too fast: H off by about {100 * share:.2g} %",) if share > LAGS else ()
    return replace(point, lag=share, marks=(*point.marks, *mark))
