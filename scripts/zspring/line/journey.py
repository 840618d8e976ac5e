"""Where, how fast and how the pantographs run along a line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import ZSpringError
from ..fmu import Fmu
from ..variables import Value, parse
from .statistics import Section

MOST_PANTOGRAPHS = 2
START_UPS = "ramp", "direct"
MASSES = "head", "upper_frame", "lower_frame"
SAME_PLACE = 1e-7  # m


@dataclass(frozen=True)
class Journey:
    """Where and how the pantographs run.

    speed       m/s
    start       of the first pantograph, m along the line; None: half the first span from where all can be in the line
    stop        where the first pantograph ends, m; None: half the last span before the line's end
    step        communication step, s
    spacing     from the first pantograph back to the second, m
    start_up    "ramp": the run begins at rest, with the wire as static_force lifts it at the start. This lift is
                taken off the height that the pantographs see and comes back as a half cosine over the length
                of the span it starts in, as the uplift forces do; from then on static_force is the force at
                height 0.
                "direct": the lift stays off for the whole run, and the uplift forces act at once.
    uplift      extra upward force, N, on all pantographs or on each
    uplift_on   the mass it acts on: "head", "upper_frame" or "lower_frame"
    """

    speed: float
    start: float | None = None
    stop: float | None = None
    step: float = 1e-3
    spacing: float = 0.0
    start_up: str = "ramp"
    uplift: float | Sequence[float] = 0.0
    uplift_on: str = "upper_frame"


@dataclass(frozen=True)
class FittedJourney(Journey):
    """A journey whose start and stop are known, and the uplift of each pantograph."""

    start: float
    stop: float
    uplift: tuple[float, ...] = ()


@dataclass(frozen=True)
class LineExtent:
    """Spans of a line, and what fits into it.

    boundaries      of the spans, anchors included, m along the line, ascending from 0. (spans + 1,)
    """

    boundaries: np.ndarray

    @classmethod
    def of(cls, catenary: Fmu, line: Mapping[str, Value]) -> LineExtent:
        """By the catenary's table, else by its parameters."""
        if catenary.line:
            return cls(catenary.line.boundaries)
        spans, span = (parameter_value(catenary, line, f"line.{name}") for name in ("spans", "span"))
        return cls.alike(int(spans), span)

    @classmethod
    def alike(cls, spans: int, span: float) -> LineExtent:
        """So many spans of that length, m."""
        return cls(span * np.arange(spans + 1))

    @property
    def spans(self) -> int:
        return len(self.boundaries) - 1

    @property
    def length(self) -> float:
        return float(self.boundaries[-1])

    @property
    def supports(self) -> np.ndarray:
        """Positions of the supports inside the line, m. (spans - 1,)"""
        return self.boundaries[1:-1]

    def span_of(self, position: float) -> int:
        """Number of the span, from 1, at a position in m; at a support that behind it."""
        return int(np.clip(np.searchsorted(self.boundaries, position, "right"), 1, self.spans))

    def span_length(self, number: int) -> float:
        """Length of a span, counted from 1, m."""
        return float(self.boundaries[number] - self.boundaries[number - 1])

    def run_up(self, start: float) -> float:
        """Over how many m a run from `start` m starts up: the length of the span it starts in."""
        return self.span_length(self.span_of(start))

    def whole_spans(self, begin: float, end: float) -> tuple[int, int]:
        """The first and the last span, counted from 1, that lie between two positions in m; last < first: none does."""
        first = int(np.searchsorted(self.boundaries, begin - SAME_PLACE)) + 1
        return first, int(np.searchsorted(self.boundaries, end + SAME_PLACE, "right")) - 1

    def section(self, first: int, last: int) -> Section:
        """These spans, counted from 1. Raises ZSpringError where the line has not so many."""
        if not 1 <= first <= last <= self.spans:
            raise ZSpringError(f"spans {first} to {last}: must be in 1 .. {self.spans}, the spans of the line")
        return Section(first, last, tuple(self.boundaries[first - 1 : last + 1].tolist()))

    def complete(self, journey: Journey, count: int) -> FittedJourney:
        """The journey with its start and stop. Raises ZSpringError where it does not fit the line."""
        if not 1 <= count <= MOST_PANTOGRAPHS:
            raise ZSpringError(f"{count} pantographs: must be 1 or {MOST_PANTOGRAPHS}")
        if journey.start_up not in START_UPS:
            raise ZSpringError(f"start-up {journey.start_up!r}: must be {' or '.join(START_UPS)}")
        if journey.uplift_on not in MASSES:
            raise ZSpringError(f"uplift on {journey.uplift_on!r}: must be on {', '.join(MASSES[:-1])} or {MASSES[-1]}")
        for name, unit in ("speed", "m/s"), ("step", "s"):
            value = getattr(journey, name)
            if not (math.isfinite(value) and value > 0):
                raise ZSpringError(f"{name} = {value:g} {unit}: must be above 0")
        each = (journey.uplift,) * count if isinstance(journey.uplift, (int, float)) else tuple(journey.uplift)
        if len(each) != count:
            raise ZSpringError(f"{len(each)} uplifts for {count} pantographs")
        for uplift in each:
            if not math.isfinite(uplift):
                raise ZSpringError(f"uplift = {uplift:g} N: must be finite")
        behind = journey.spacing if count > 1 else 0.0
        if count > 1 and not 0 < behind < self.length:
            raise ZSpringError(
                f"spacing = {behind:g} m: must be above 0 and below the line's length, {self.length:g} m"
            )
        start = behind + self.span_length(1) / 2 if journey.start is None else journey.start
        stop = self.length - self.span_length(self.spans) / 2 if journey.stop is None else journey.stop
        if not behind <= start < self.length:
            others = f" with a pantograph {behind:g} m behind" if behind else ""
            raise ZSpringError(f"start = {start:g} m: must be in {behind:g} .. {self.length:g} m{others}")
        if not start < stop <= self.length:
            raise ZSpringError(
                f"stop = {stop:g} m: must be above the start, {start:g} m, and in the line of {self.length:g} m"
            )
        if stop - start < journey.speed * journey.step * (1 - 1e-9):
            raise ZSpringError(
                f"step = {journey.step:g} s: is longer than the run of {(stop - start) / journey.speed:g} s"
            )
        return FittedJourney(**{**vars(journey), "start": start, "stop": stop, "spacing": behind, "uplift": each})


def parameter_value(fmu: Fmu, parameters: Mapping[str, Value], name: str) -> Value:
    """A parameter as given, else the FMU's own."""
    variable = fmu.variables[name]
    return parameters.get(name, parse(variable, variable.start))
