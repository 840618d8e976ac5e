"""Stick and slip of the rods in steady states: amplitudes raised at one frequency, and where the state changes.

A joint slides while its friction moment is at least SLIDES of its bound Mf: what tells a sliding joint of either law,
for tanh of a rate from 2/tau on. A point is "stick" where neither joint ever slides, "full slip" where both slide for
FULL of the period, with short stops where they turn, and "partial slip" between.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fmu import StepDiscarded
from .measure import Bench, FmuBench, settle
from .points import FAILED, FrfSettings

SLIDES, FULL = 0.95, 0.9
WIDTH = 0.02  # relative, between amplitudes of different states at the end of the search
STICK, PARTIAL, SLIP = "stick", "partial slip", "full slip"
STATES = (STICK, PARTIAL, SLIP)

_MOMENTS = ["zspring.moment_alpha", "zspring.moment_beta"]


@dataclass(frozen=True)
class SlipPoint:
    """A steady state; NaN where it failed."""

    frequency: float  # Hz
    amplitude: float  # m/s2, peak acceleration of the head
    status: str  # as of an FrfPoint
    moment: tuple[float, float] = (math.nan, math.nan)  # largest of either joint, relative to Mf
    sliding: tuple[float, float] = (math.nan, math.nan)  # for how much of the period either joint slides

    @property
    def state(self) -> str:
        """Of STATES; empty where it failed."""
        if self.status.startswith(FAILED):
            return ""
        return STICK if max(self.moment) < SLIDES else SLIP if min(self.sliding) >= FULL else PARTIAL


Kept = tuple[SlipPoint, Mapping[str, Any] | None]  # with the bench's state; None: the next point starts from rest


@dataclass(frozen=True)
class Raising:
    """One frequency: the amplitudes asked for, ascending in m/s2, and what was measured before an interruption."""

    frequency: float  # Hz
    amplitudes: tuple[float, ...]
    done: Sequence[Kept] = ()


def missing(points: Sequence[SlipPoint], amplitudes: Sequence[float]) -> float | None:
    """The next amplitude (m/s2) to measure at their frequency: of these, then about both changes of the state."""
    known = {point.amplitude for point in points}
    for amplitude in amplitudes:
        if amplitude not in known:
            return amplitude
    for state in (PARTIAL, SLIP):
        low, high = bounds(points, state)
        if 0 < low and high / low > 1 + WIDTH and (middle := float(f"{math.sqrt(low * high):.6g}")) not in known:
            return middle
    return None


def bounds(points: Sequence[SlipPoint], state: str) -> tuple[float, float]:
    """The amplitudes (m/s2) of one frequency between which its rods begin to be in this state, or in a later one.

    The lower is 0 where the smallest is in it; both are NaN where none is.
    """
    low = 0.0
    for point in sorted(points, key=lambda p: p.amplitude):
        if point.state and STATES.index(point.state) >= STATES.index(state):
            return low, point.amplitude
        low = point.amplitude if point.state else low
    return math.nan, math.nan


def raise_amplitude(bench: Bench, task: Raising, settings: FrfSettings, stop: threading.Event) -> Iterator[Kept]:
    """The points that are missing, until `stop` is set, each from the steady state at the next lower amplitude."""
    done = {point.amplitude: (point, state) for point, state in task.done}
    while (amplitude := missing([point for point, _ in done.values()], task.amplitudes)) is not None:
        below = [a for a in done if a < amplitude]
        state = done[max(below)][1] if below else None
        if state:
            bench.load(state)
        go = bench.tune if state else bench.start
        go(task.frequency, amplitude)
        kept = _measure(bench, task.frequency, amplitude, settings, stop)
        if kept is None:
            return
        done[amplitude] = kept
        yield kept


def _measure(
    bench: Bench, frequency: float, amplitude: float, settings: FrfSettings, stop: threading.Event
) -> Kept | None:
    """The steady state and one more period, seen at each internal step; None if stopped before."""
    assert isinstance(bench, FmuBench)
    found = settle(bench, amplitude, frequency, settings, stop)
    if found is None:
        return None
    status = found.status
    if not status.startswith(FAILED):
        try:
            (bound,) = bench.instance.get(["zspring.Mf"])
            share = np.abs(bench.watch(_MOMENTS)) / bound
            moment, sliding = share.max(axis=0), (share >= SLIDES).mean(axis=0)
            point = SlipPoint(frequency, amplitude, status, (moment[0], moment[1]), (sliding[0], sliding[1]))
            return point, bench.save()
        except StepDiscarded as error:
            status = f"{FAILED}: {error}"
    return SlipPoint(frequency, amplitude, status), None
