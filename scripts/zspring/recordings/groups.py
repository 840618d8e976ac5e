"""Points by level of the amplitude and direction of the sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..bench.curves import Curve
from ..bench.levels import levels_of
from .points import Point

SAME = 0.002  # relative distance of frequencies that are one


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
    groups = [Group(label, way, own) for (label, way), own in found.items()]
    return sorted(groups, key=lambda group: float(np.median(group.curve.acceleration)))


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
