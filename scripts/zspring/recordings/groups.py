"""Points by level of the amplitude and direction of the sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..bench.curves import REACH, Curve
from ..bench.levels import levels_of
from ..errors import ZSpringError
from .points import Point

SAME = 0.002  # relative distance of frequencies that are one
NEAR = 0.01  # relative distance of a frequency from one that was asked for


@dataclass(frozen=True)
class Group:
    """Points that are used, in the order in which they were measured."""

    label: str  # of the level
    direction: str | None  # "up", "down", "rest"; None: neither rising nor falling
    points: Sequence[Point]

    @property
    def curve(self) -> Curve:
        """As the readers of measured responses have it."""
        frequency, acceleration, H = (
            np.array([getattr(p, name) for p in self.points]) for name in ("frequency", "acceleration", "H")
        )
        return Curve(self.label, frequency, acceleration, H)


def asked_for(points: Sequence[Point], frequencies: Sequence[float], where: str) -> tuple[list[Point], list[str]]:
    """The points, those left out that are at none of the frequencies (Hz), and a line for each that has none.

    At a frequency is what is within NEAR of it, or half way to the next. Raises ZSpringError where nothing is.
    """
    wanted = np.sort(frequencies)
    within = np.minimum(NEAR * wanted, np.min(np.diff(wanted), initial=np.inf) / 2)
    places = [int(np.argmin(np.abs(wanted - point.frequency))) for point in points]
    there = [abs(wanted[i] - point.frequency) <= within[i] for point, i in zip(points, places)]
    if not any(there):
        raise ZSpringError(f"{where}: no hold at any of the frequencies of the settings")
    other = "not in the list of frequencies"
    kept = [point if is_there else replace(point, left_out=other) for point, is_there in zip(points, there)]
    found = {i for i, is_there in zip(places, there) if is_there}
    return kept, [f"{where}: no hold at {f:g} Hz" for i, f in enumerate(wanted) if i not in found]


def grouped(points: Sequence[Point], direction: str | None) -> list[Group]:
    """The used ones of points in the order of measurement, by level, ascending, and by direction.

    direction   of all; None: as the frequencies go, of one level in one file
    """
    used = [point for point in points if not point.left_out]
    if not used:
        return []
    labels: list[str] = [point.level or "" for point in used]
    unnamed = np.array([i for i, label in enumerate(labels) if not label], int)
    if unnamed.size:
        frequency, acceleration = (
            np.array([getattr(used[i], k) for i in unnamed]) for k in ("frequency", "acceleration")
        )
        for level in levels_of(frequency, acceleration, acceleration, "m/s2"):
            for i in unnamed[level.points]:
                labels[i] = level.label
    found: dict[tuple[str, str | None], list[Point]] = {}
    for label in dict.fromkeys(labels):
        for record in dict.fromkeys(point.record for point in used):
            own = [point for point, other in zip(used, labels) if other == label and point.record == record]
            ways = [direction] * len(own) if direction else _ways([point.frequency for point in own])
            for point, way in zip(own, ways):
                found.setdefault((label, way), []).append(point)
    groups = [Group(label, way, _with_neighbours(_with_control(own))) for (label, way), own in found.items()]
    return sorted(groups, key=lambda group: float(np.median(group.curve.acceleration)))


def _with_control(points: Sequence[Point]) -> list[Point]:
    """Points of one level whose harmonics of the force are known no better than what those of the motion make of them.

    A harmonic of the motion brings its own of the force, dynamic stiffness times motion, in a phase that is not known:
    1 / sqrt(2) of it is a standard error. The stiffness is that of the points, between them on logarithmic scales;
    above them it grows with the square of the frequency, as inertia does.
    """
    frequency = np.array([point.frequency for point in points])
    order = np.argsort(frequency)
    known, stiffness = np.log(frequency[order]), np.log([1 / abs(points[i].H) for i in order])
    result = []
    for point in points:
        at = np.log(point.frequency * np.arange(1, point.motion.size + 1))
        level = np.interp(at, known, stiffness) + 2 * np.maximum(at - known[-1], 0)
        share = np.exp(level) * point.motion / np.sqrt(2)
        share[0] = 0.0  # the fundamental, which is to move
        result.append(replace(point, force_error=np.hypot(point.force_error, share)))
    return result


def _with_neighbours(points: Sequence[Point]) -> list[Point]:
    """Points of one level in which the motion's harmonics count no less than in their neighbours.

    Where the rods are about to slip the force has no harmonics of its own yet, but those of the motion count the most.
    """
    place = np.log([point.frequency for point in points])
    harmonics = np.array([point.harmonics for point in points])
    near = np.abs(np.subtract.outer(place, place)) < REACH[0]
    return [replace(point, harmonics=float(harmonics[there].max())) for point, there in zip(points, near)]


def _ways(frequencies: Sequence[float]) -> Sequence[str | None]:
    """Of each frequency, whether it was reached from below or from above; None if they turn more than once."""
    steps = np.diff(np.log(frequencies))
    signs = np.where(np.abs(steps) < SAME, 0, np.sign(steps))
    moving = signs[signs != 0]
    if not moving.size or np.sum(np.diff(moving) != 0) > 1:
        return [None] * len(frequencies)
    ways, last = [], moving[0]
    for sign in (moving[0], *signs):
        last = sign or last
        ways.append("up" if last > 0 else "down")
    return ways
