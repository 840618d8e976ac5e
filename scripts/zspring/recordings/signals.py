"""A recording as the bench meant it: contact force and motions in SI units, signed, over even times."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import canonical
from ..units import conversion
from .channels import Channel, Recording, even_times
from .formats import read_recording
from .settings import MOTIONS, File, Sensor, Settings

TIME_NAMES = ("time", "t", "x value")
EQUAL_RATE = 1e-6  # relative, as files round it
NEAR_END = 0.05  # of all values' range: what is compared with the end itself
OFTEN = 5  # times as often as it would be: the end is a limit
FLAT = 3  # times the values alike at an end that a sine has anyway


@dataclass(frozen=True)
class Signal:
    """Values (n,) in N, m or m/s2; NaN where one is missing."""

    values: np.ndarray
    delay: float  # s, by which they come late
    step: float  # smallest difference between two values: what the converter, or the file's digits, tell
    beyond: np.ndarray  # (n,) whether the channel's limit is reached

    def without_flat(self, part: slice, rate: float, frequency: float) -> tuple[np.ndarray, bool]:
        """The values of a part with NaN for those that stand still, and whether they do in most periods.

        Then they are clipped; once, a plug was loose. At its crest a sine of amplitude A stays within one step for
        sqrt(2 step / A) / (pi f).
        """
        values, flat = self.values[part], self.beyond[part].copy()
        amplitude = (np.nanmax(values) - np.nanmin(values)) / 2 if np.isfinite(values).any() else 0.0
        crest = rate / (np.pi * frequency) * np.sqrt(2 * self.step / amplitude) if amplitude > 0 else 0.0
        for first, last in _runs(np.abs(np.diff(values)) <= self.step / 2):
            flat[first : last + 1] |= last - first >= FLAT * (1 + crest)
        clipped = len(_runs(flat)) >= max(3, 0.5 * values.size * frequency / rate)
        return np.where(flat, np.nan, values), clipped


def _runs(which: np.ndarray) -> np.ndarray:
    """Places [first, last) (m, 2) of the runs of true values in (n,)."""
    return np.flatnonzero(np.diff(np.concatenate([[0], which.astype(np.int8), [0]]))).reshape(-1, 2)


@dataclass(frozen=True)
class Record:
    """One file. The first motion is that of H."""

    path: Path
    level: str | None
    rate: float  # Hz
    time: np.ndarray  # (n,) s, even within each part
    parts: list[tuple[int, int]]  # [first, last) without a gap in time
    force: Signal  # contact force, which presses the head down
    motions: dict[str, Signal]  # upward
    remarks: list[str]


def read_record(file: File, settings: Settings) -> Record:
    """The signals of a file.

    Raises ZSpringError for a channel that is missing or has no values, units that are not clear, and channels that do
    not have one sampling rate.
    """
    recording = read_recording(file.path, file.skip)
    sensors: dict[str, Sensor] = {"force": settings.force, **settings.motions}
    channels = {name: summed(f"{file.path}, [{name}]", recording, sensor.channel) for name, sensor in sensors.items()}
    clock = _clock(recording, settings)
    sizes = {name: c.values.size for name, c in {**channels, **({"time": clock} if clock else {})}.items()}
    size, remarks = min(sizes.values()), []
    if max(sizes.values()) > 1.01 * size:
        listed = ", ".join(f"{name} {count}" for name, count in sizes.items())
        raise ZSpringError(f"{file.path}: numbers of values differ ({listed}): the sampling rates must be equal")
    if max(sizes.values()) > size:
        remarks.append(f"{file.path.name}: channels end at different times: cut to {size} values")
    if clock is None:
        start, step = _told_beside(file.path, channels, settings.time.rate)
        time, parts = start + step * np.arange(size), [(0, size)]
        keep = np.arange(size)
    else:
        seconds = _seconds(file.path, clock, settings)[:size]
        step, whole = even_times(file.path, seconds)
        time = np.concatenate([seconds[a] + step * np.arange(b - a) for a, b in whole])
        keep = np.concatenate([np.arange(a, b) for a, b in whole])
        parts = [*itertools.pairwise(map(int, np.cumsum([0, *(b - a for a, b in whole)])))]
        if len(parts) > 1:
            remarks.append(f"{file.path.name}: {len(parts) - 1} gaps in time")

    def signal(name: str, wanted: str, sign: int) -> Signal:
        where = f"{file.path}, [{name}]"
        factor = sign * sensors[name].factor(channels[name].unit, wanted, where)
        return _signal(where, sensors[name], channels[name].values[:size][keep], factor)

    force = signal("force", "N", settings.contact_sign)
    motions = {name: signal(name, MOTIONS[name], motion.sign) for name, motion in settings.motions.items()}
    return Record(file.path, file.level, 1 / step, time, parts, force, motions, remarks)


def summed(where: str, recording: Recording, names: Sequence[str]) -> Channel:
    """The sum of channels, as of load cells beside each other. Raises ZSpringError where they do not fit together."""
    first, *others = (recording[name] for name in names)
    values = first.values.copy()
    for name, other in zip(names[1:], others):
        if (other.unit, other.step, other.start, other.values.size) != (
            first.unit,
            first.step,
            first.start,
            values.size,
        ):
            raise ZSpringError(f"{where}: {names[0]!r} and {name!r} differ in unit, time or number of values")
        values += other.values
    return replace(first, values=values)


def _clock(recording: Recording, settings: Settings) -> Channel | None:
    """The channel of time: the one named, else one with a usual name where nothing else tells the time."""
    if settings.time.channel is not None:
        return recording[settings.time.channel]
    if settings.time.rate or recording[settings.force.channel[0]].step:
        return None
    return next((channel for name, channel in recording.channels.items() if canonical(name) in TIME_NAMES), None)


def _seconds(path: Path, clock: Channel, settings: Settings) -> np.ndarray:
    unit = settings.time.unit or clock.unit
    if unit is None:
        raise ZSpringError(f'{path}, [time]: the file does not tell the unit of the time: unit = "s", say')
    return clock.values * conversion(unit, "s")[1]


def _told_beside(path: Path, channels: Mapping[str, Channel], rate: float | None) -> tuple[float, float]:
    """Start and step in s that the settings tell, or the channels beside their values."""
    told = {name: channel for name, channel in channels.items() if channel.step}
    rates = {name: 1 / channel.step for name, channel in told.items() if channel.step}
    if rate:
        rates["[time] rate"] = rate
    if not rates:
        raise ZSpringError(f"{path}: no time: [time] channel or rate, in Hz, tells it")
    if max(rates.values()) > (1 + EQUAL_RATE) * min(rates.values()):
        listed = ", ".join(f"{name} {value:g} Hz" for name, value in rates.items())
        raise ZSpringError(f"{path}: sampling rates differ ({listed}): must be one")
    starts, step = [channel.start for channel in told.values()] or [0.0], 1 / next(iter(rates.values()))
    if np.ptp(starts) > 0.01 * step:
        raise ZSpringError(f"{path}: channels begin at different times: {', '.join(f'{s:g} s' for s in starts)}")
    return starts[0], step


def _signal(where: str, sensor: Sensor, values: np.ndarray, factor: float) -> Signal:
    there = values[np.isfinite(values)]
    if not there.size:
        raise ZSpringError(f"{where}: {sensor.named} has no value")
    distinct = np.unique(there)
    if distinct.size < 2:
        raise ZSpringError(f"{where}: {sensor.named} is {distinct[0]:g} all the time: is the sensor connected?")
    steps = np.diff(distinct)
    step = float(steps[steps > 1e-9 * (distinct[-1] - distinct[0])].min())
    if sensor.limit is None:
        ends = [end for end, inward in ((-1, -1), (0, 1)) if _is_limit(values, distinct[end::inward], step)]
        beyond = np.isin(values, [distinct[end] for end in ends])
    else:
        beyond = np.abs(values) >= sensor.limit * (1 - 1e-6)
    return Signal(factor * values, sensor.delay, abs(factor) * step, beyond)


def _is_limit(values: np.ndarray, distinct: np.ndarray, step: float) -> bool:
    """Whether the first of the distinct values (m,), at an end of all values, is a limit: it comes far too often.

    Of the values that a sine has within n steps of its end, one in sqrt(n) is at the end. In records without noise all
    values come as often as there are periods.
    """
    width = NEAR_END * np.ptp(distinct)
    near = np.count_nonzero(np.abs(values - distinct[0]) < width)
    beside = max(1, np.count_nonzero(np.abs(distinct - distinct[0]) < width) - 1)
    at_end = np.count_nonzero(values == distinct[0])
    return at_end > OFTEN * max(1.0, near / np.sqrt(max(width / step, 1.0)), (near - at_end) / beside)
