"""Recordings as they are read: channels by name, with unit and time as far as the file tells them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import ZSpringError, did_you_mean

MOST_LISTED = 12


@dataclass(frozen=True)
class Channel:
    """Values (n,) as the file has them, NaN for missing ones."""

    values: np.ndarray
    unit: str | None = None
    step: float | None = None  # s between values, where the file tells it beside them
    start: float = 0.0  # s, of the first value


@dataclass(frozen=True)
class Recording:
    """A file's channels by their names."""

    path: Path
    channels: Mapping[str, Channel]

    def __getitem__(self, name: str) -> Channel:
        """Capitals, underscores and blanks count for nothing where that leaves one. Raises ZSpringError."""
        if name in self.channels:
            return self.channels[name]
        alike = [other for other in self.channels if _plain(other) == _plain(name)]
        if len(alike) == 1:
            return self.channels[alike[0]]
        there = [*self.channels][:MOST_LISTED]
        more = len(self.channels) - len(there)
        listed = ", ".join(there) + (f" and {more} more" if more else "")
        hint = did_you_mean(name, self.channels)
        raise ZSpringError(f"{self.path}: no channel {name!r} (there are: {listed}){hint}")


def _plain(name: str) -> str:
    return "".join(name.replace("_", "").lower().split())


def even_times(path: Path, time: np.ndarray) -> tuple[float, list[tuple[int, int]]]:
    """The step (s) of times (n,) in s, and the parts [first, last) without a gap.

    Times that are rounded to few digits are even as long as none comes twice. Raises ZSpringError where they are not
    even, with the first place.
    """
    if time.size < 2:
        raise ZSpringError(f"{path}: {time.size} values: too few")
    if not np.all(np.isfinite(time)):
        raise ZSpringError(f"{path}: value {np.flatnonzero(~np.isfinite(time))[0] + 1} of the time is missing")
    steps = np.diff(time)
    step = float(np.median(steps))
    wrong = np.flatnonzero(steps <= 0)
    if wrong.size or step <= 0:
        at = int(wrong[0])
        text = f"{path}: time {time[at + 1]:.9g} s after {time[at]:.9g} s: must increase; if its digits are too few, "
        raise ZSpringError(f"{text}give the sampling rate: [time] rate")
    gaps = np.flatnonzero(steps > 1.5 * step)
    edges = [0, *(gaps + 1), time.size]
    parts = [(a, b) for a, b in itertools.pairwise(edges) if b - a > 1]
    lengths = np.array([b - a - 1 for a, b in parts])
    step = float(np.sum([time[b - 1] - time[a] for a, b in parts]) / lengths.sum())
    for a, b in parts:
        off = np.abs(time[a:b] - time[a] - step * np.arange(b - a)) / step
        if off.max() > 1:
            at = a + int(np.argmax(off > 1))
            raise ZSpringError(f"{path}: uneven times about {time[at]:.9g} s: the sampling rate must be one")
    return step, parts
