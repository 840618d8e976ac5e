"""Extremes of a measured response: which further frequencies to measure until they are known, and how well.

First the curve is resolved: where a point disagrees with what its neighbours let expect, the intervals beside it are
halved until their middles are as expected, or they are too narrow. Then three points about each extreme, close enough
for a polynomial of log |H| and far enough for their own errors not to count, are measured, twice or more.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Generator, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from .measure import Bench, run_sweep
from .points import NOT_SETTLED, SETTLED, FrfPoint, FrfSettings, Kept, Sweep

LEAST_STEP = 0.03  # of log |H| between neighbouring extremes; smaller ones are ripple, not resonances
EXPECTED = 0.01  # of log H: distance of a point from what its neighbours let expect, in a resolved curve
STEEP = 0.1  # the same, of the change of log |H| over the interval: no pair of extremes hides in a steep flank
LEAST_WIDTH = 2e-4  # of an interval, relative to its frequency
DROPS = 12e-3, 3e-3, 6e-3  # of log |H| beside an extreme, in the rounds of three points about it
AT_EXTREME = 0.1  # of the tolerance of a point
WANTED = 3e-4  # relative error of the frequency at which an extreme is known

Asking = Generator[tuple[float, bool], FrfPoint, "list[Extreme]"]
JUMP = "jump"


@dataclass(frozen=True)
class Extreme:
    """A resonance (maximum of |H|) or antiresonance (minimum), with estimates of the errors."""

    is_resonance: bool
    frequency: float  # Hz
    frequency_error: float
    magnitude: float  # m/N
    magnitude_error: float
    doubt: str = ""  # NOT_SETTLED if it rests on such points, JUMP where the curve jumps beside it
    about: tuple[FrfPoint, ...] = ()  # three, by frequency, where it is not in doubt

    def checked(self, finer: Sequence[FrfPoint]) -> Extreme:
        """With the error of the internal step, of second order in it, from the points `about` at half the step."""
        if any(p.status != SETTLED for p in finer):
            return replace(self, doubt=NOT_SETTLED)
        here, there = _Polynomial(self.about, 2), _Polynomial(finer, 2)
        return replace(
            self,
            frequency_error=self.frequency_error + 4 / 3 * abs(there.vertex - here.vertex),
            magnitude_error=self.magnitude_error + 4 / 3 * abs(math.exp(there.level) - math.exp(here.level)),
        )


def refining(points: Sequence[FrfPoint], highest: bool = False) -> Asking:
    """Asks for one frequency (Hz) after the other, and says whether it is at an extreme; returns them, ascending.

    points      of one amplitude, by ascending frequency; those without H divide the curve
    highest     only the highest resonance that these points show
    It is to be sent the point measured at each frequency.
    """
    found, start = [], 0
    for end in range(len(points) + 1):
        if end == len(points) or not math.isfinite(abs(points[end].H)):
            curve = _Curve(points[start:end])
            if not highest:
                yield from curve.resolve()
            found += yield from curve.extremes(highest)
            start = end + 1
    return found


@dataclass(frozen=True)
class Refinement:
    """What is to be measured beside one sweep: its points, and those measured beside it before an interruption."""

    sweep: Sequence[Kept]  # in the order in which they were measured
    beside: Sequence[Kept] = ()
    highest: bool = False  # only the highest resonance

    @property
    def asking(self) -> Asking:
        return refining(sorted((point for point, _ in self.sweep), key=lambda p: p.frequency), self.highest)

    def extremes(self) -> list[Extreme]:
        """What the sweep and all points beside it say. Raises KeyError if points are missing."""
        known = {point.frequency: point for point, _ in self.beside}
        asking = self.asking
        try:
            frequency, _ = next(asking)
            while True:
                frequency, _ = asking.send(known[frequency])
        except StopIteration as end:
            return end.value


def refine(bench: Bench, task: Refinement, settings: FrfSettings, stop: threading.Event) -> Iterator[Kept]:
    """The points that are still missing beside a sweep, until `stop` is set.

    Each goes on from the state after the point before it, as the sweep would; those at extremes settle to a tenth of
    the tolerance.
    """
    done = {point.frequency: (point, state) for point, state in (*task.sweep, *task.beside)}
    down = settings.direction == "down"
    finer = replace(settings, tolerance=settings.tolerance * AT_EXTREME)
    asking = task.asking
    with suppress(StopIteration):
        frequency, at_extreme = next(asking)
        while True:
            if frequency not in done:
                before = [f for f in done if (f > frequency if down else f < frequency)]
                state = done[(min if down else max)(before)][1] if before else None
                one = Sweep(task.sweep[0][0].level, (frequency,), state)
                for result in run_sweep(bench, one, finer if at_extreme else settings, stop):
                    done[frequency] = result
                    yield result
                if frequency not in done:
                    return
            frequency, at_extreme = asking.send(done[frequency][0])


def turns(level: np.ndarray) -> list[int]:
    """Where levels (n,) of log |H| are extreme, but for those that differ from a neighbouring one by < LEAST_STEP."""
    slopes = np.sign(np.diff(level))
    found = [i for i in range(1, len(level) - 1) if slopes[i - 1] * slopes[i] < 0]
    while len(found) > 1:
        steps = np.abs(np.diff(level[found]))
        smallest = int(np.argmin(steps))
        if steps[smallest] >= LEAST_STEP:
            break
        del found[smallest : smallest + 2]
    return found


class _Curve:
    """Points without a gap, by ascending frequency, more and more of them."""

    def __init__(self, points: Sequence[FrfPoint]):
        self._points = list(points)
        self._jumps: set[float] = set()  # lower ends of intervals too narrow to halve

    def _measure(self, frequency: float, at_extreme: bool) -> Generator[tuple[float, bool], FrfPoint, FrfPoint]:
        frequency = float(f"{frequency:.9g}")
        for point in self._points:
            if point.frequency == frequency:
                return point
        point = yield frequency, at_extreme
        if math.isfinite(abs(point.H)):
            self._points = sorted([*self._points, point], key=lambda p: p.frequency)
        return point

    def resolve(self) -> Generator[tuple[float, bool], FrfPoint, None]:
        """Halve the intervals whose ends are not as expected, and then those whose middle is not."""
        surprises = [0.0, *map(self._surprise, range(1, len(self._points) - 1)), 0.0]
        todo = [(*ends, max(two)) for ends, two in zip(pairwise(self._points), pairwise(surprises))]
        while todo:
            low, high, surprise = todo.pop(0)
            change = np.log(high.H / low.H)
            if surprise <= max(EXPECTED, STEEP * abs(change.real)) or {low.status, high.status} != {SETTLED}:
                continue
            if high.frequency - low.frequency < LEAST_WIDTH * high.frequency:
                self._jumps |= {low.frequency} if abs(change) > EXPECTED else set()
                continue
            middle = yield from self._measure((low.frequency + high.frequency) / 2, False)
            if middle in self._points:
                surprise = self._surprise(self._points.index(middle))
                todo += [(low, middle, surprise), (middle, high, surprise)]

    def _surprise(self, i: int) -> float:
        """Distance of log H of point i from the polynomial through two neighbours on either side, as far as there."""
        here, others = self._points[i], [*self._points[max(i - 2, 0) : i], *self._points[i + 1 : i + 3]]
        x = np.array([p.frequency for p in others]) - here.frequency
        return float(abs(np.linalg.solve(np.vander(x), np.log(np.array([p.H for p in others]) / here.H))[-1]))

    def extremes(self, highest: bool) -> Asking:
        """All of them, or the highest resonance, each with points of its own."""
        found, points = [], self._points
        level = np.log([abs(p.H) for p in points])
        chosen = turns(level)
        if highest:
            chosen = sorted((i for i in chosen if level[i] > level[i - 1]), key=lambda i: level[i])[-1:]
        for i in chosen:
            found.append((yield from self._extreme(points[i - 1], points[i], points[i + 1])))
        return found

    def _extreme(
        self, low: FrfPoint, middle: FrfPoint, high: FrfPoint
    ) -> Generator[tuple[float, bool], FrfPoint, Extreme]:
        """The extreme between three neighbouring points."""
        sign = 1 if abs(middle.H) > abs(low.H) else -1
        outer = low, high
        latest: list[FrfPoint] = []
        for drop in (*DROPS, 0.0):
            doubt = JUMP if self._jumps & {low.frequency, middle.frequency} else ""
            if {p.status for p in (*latest, low, middle, high)} != {SETTLED}:
                doubt = NOT_SETTLED
            if doubt:
                half, magnitude = (high.frequency - low.frequency) / 2, abs(middle.H)
                return Extreme(sign > 0, middle.frequency, half, magnitude, magnitude * middle.remaining, doubt)
            found = _known(latest, (low, middle, high), sign > 0)
            if drop == 0 or found.frequency_error <= WANTED * found.frequency:
                break
            three = []
            for frequency in _about(_Polynomial((low, middle, high), 2), drop, low.frequency, high.frequency):
                three.append((yield from self._measure(frequency, True)))
            latest = [*three, *latest][:6]
            inside = [p for p in self._points if outer[0].frequency <= p.frequency <= outer[1].frequency]
            if sign * abs(three[1].H) < max(sign * abs(three[0].H), sign * abs(three[2].H)):
                best = max(range(1, len(inside) - 1), key=lambda i: sign * abs(inside[i].H))
                three = inside[best - 1 : best + 2]
            low, middle, high = sorted(three, key=lambda p: p.frequency)
        return found


def _about(parabola: _Polynomial, drop: float, low: float, high: float) -> tuple[float, float, float]:
    """Three frequencies about the vertex of a parabola, where it falls by `drop`, all of them between low and high."""
    margin = (high - low) / 8
    vertex = min(max(parabola.vertex, low + margin), high - margin)
    reach = min(math.sqrt(drop / abs(parabola.curvature)), 0.9 * (vertex - low), 0.9 * (high - vertex))
    return vertex - reach, vertex, vertex + reach


def _known(latest: Sequence[FrfPoint], bracket: Sequence[FrfPoint], is_resonance: bool) -> Extreme:
    """The extreme by the polynomial of order 4 through the latest points; the parabola of the bracket if that fails.

    Its error: the difference to that of order 3, and what the points' own errors make; the bracket has it in any case.
    """
    low, high = bracket[0].frequency, bracket[2].frequency
    if len(latest) == 6:
        cubic, quartic = (_Polynomial(latest, degree) for degree in (3, 4))
        frequency_error = abs(quartic.vertex - cubic.vertex) + max(quartic.vertex_error, cubic.vertex_error)
        level_error = abs(quartic.level - cubic.level) + max(quartic.level_error, cubic.level_error)
        if low <= quartic.vertex <= high and 2 * frequency_error <= high - low:
            magnitude = math.exp(quartic.level)
            errors = frequency_error, magnitude, magnitude * level_error
            return Extreme(is_resonance, quartic.vertex, *errors, about=tuple(bracket))
    parabola = _Polynomial(bracket, 2)
    level_error = abs(parabola.level - math.log(abs(bracket[1].H))) + parabola.level_error
    magnitude = math.exp(parabola.level)
    errors = (high - low) / 2, magnitude, magnitude * level_error
    return Extreme(is_resonance, parabola.vertex, *errors, about=tuple(bracket))


class _Polynomial:
    """Of log |H| over frequency by least squares, at its extreme nearest to the first point.

    vertex, level, curvature    Hz, log |H|, and half the second derivative in 1/Hz2 there
    vertex_error, level_error   of independent errors of the points: the largest of what remains of their transients,
                                or, with more points than the degree needs, their scatter if that is larger
    """

    def __init__(self, points: Sequence[FrfPoint], degree: int):
        x = np.array([p.frequency for p in points])
        scale = np.ptp(x)
        level = np.log([abs(p.H) for p in points])
        inverse = np.linalg.pinv(np.vander((x - x[0]) / scale, degree + 1, increasing=True))
        y = np.polynomial.Polynomial(inverse @ level)
        zeros = y.deriv().roots()
        zeros = zeros[np.abs(zeros.imag) < 1e-9].real
        at = zeros[np.argmin(np.abs(zeros))] if zeros.size else math.nan
        noise, powers = max(p.remaining for p in points), at ** np.arange(degree + 1)
        if len(points) > degree + 1:
            left = y((x - x[0]) / scale) - level
            noise = max(noise, math.sqrt(left @ left / (len(points) - degree - 1)))
        slope = np.append(0, np.arange(1, degree + 1) * powers[:-1]) @ inverse
        self.vertex, self.level = float(x[0] + at * scale), float(y(at))
        self.curvature = float(y.deriv(2)(at)) / 2 / scale**2
        self.vertex_error = float(noise * np.linalg.norm(slope) / abs(y.deriv(2)(at)) * scale)
        self.level_error = float(noise * np.linalg.norm(powers @ inverse))
