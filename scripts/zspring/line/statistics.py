"""Statistics of a contact force as EN 50318 takes them: 0 to 20 Hz, its parts below and above 5 Hz, and other bands.

The filter is a Butterworth low-pass of order 4, run forwards and backwards over the whole series: no phase
shift, gain 1 / (1 + (f / f_c)^8), which is 1/2 (-6 dB) at the band's edge f_c, 0.71 at 0.90 f_c and 0.97 at
0.65 f_c. The part of 5 to 20 Hz is the difference of the forces of 0 to 20 and 0 to 5 Hz, so that the
parts add up to the whole; their variances do so but for what both have near 5 Hz. All other bands are taken alike. The
series is continued at its ends by point reflection; ends belong to no span that is evaluated, if the series is long
enough.

Loss of contact is counted in the unfiltered force: the share of time in which it is not positive.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import ZSpringError
from .quantities import FIGURES, Statistics, band_of, point_of
from .series import BAND, Series

ORDER = 4  # of the filter that runs twice
SETTLING = 1.0  # s by which the series is continued at its ends, or
SETTLING_PERIODS = 5  # of the edge of the band, if these are longer
SHORTEST = 5  # periods of the edge of the band that a series must have
HIGHEST = 0.4  # of the sample rate: where a band may end at most
SAME_POINT = 1e-3  # m
MIDDLE = 0.02  # of a span: a point this near to its middle is there


@dataclass(frozen=True)
class Section:
    """A part of the line: spans first to last, counted from 1.

    edges   where each of them begins, and the last one ends, m
    """

    first: int
    last: int
    edges: tuple[float, ...]

    @classmethod
    def alike(cls, first: int, last: int, span: float, start: float = 0.0) -> Section:
        """Spans of one length, the first one of the line from `start` on; in m."""
        return cls(first, last, tuple(start + n * span for n in range(first - 1, last + 1)))

    @property
    def bounds(self) -> tuple[float, float]:
        """Where it begins and ends in m."""
        return self.edges[0], self.edges[-1]

    @property
    def span(self) -> float | None:
        """Length of each of its spans in m; None where they are not alike."""
        lengths = np.diff(self.edges)
        return float(lengths[0]) if np.ptp(lengths) < 1e-6 else None

    @property
    def middles(self) -> tuple[float, ...]:
        """The middle of each span, m."""
        return tuple(0.5 * (a + b) for a, b in zip(self.edges, self.edges[1:]))

    def moved(self, by: float) -> Section:
        """The same spans `by` m further along."""
        return Section(self.first, self.last, tuple(edge + by for edge in self.edges))

    def __str__(self) -> str:
        spans = f"span {self.first}" if self.first == self.last else f"spans {self.first} to {self.last}"
        return "{}, {:g} to {:g} m".format(spans, *self.bounds)

    def single_spans(self) -> list[Section]:
        """Its spans one by one."""
        return [Section(self.first + i, self.first + i, self.edges[i : i + 2]) for i in range(len(self.edges) - 1)]


def highest_band(step: float) -> float:
    """Hz, below which a band must end for samples `step` s apart."""
    return HIGHEST / step


def low_pass(series: np.ndarray, step: float, cutoff: float = BAND, order: int = ORDER) -> np.ndarray:
    """The part of (n,) or (n, p) samples, `step` s apart, below `cutoff` Hz; see the head of this file.

    Raises ZSpringError where the samples are too few or too slow for the filter.
    """
    series = np.asarray(series, dtype=float)
    if not cutoff < highest_band(step):
        raise ZSpringError(f"sample step {step:g} s: must be below {HIGHEST / cutoff:g} s for {cutoff:g} Hz")
    duration, least = series.shape[0] * step, SHORTEST / cutoff
    if duration < least:
        raise ZSpringError(f"{duration:g} s are too short for {cutoff:g} Hz: at least {least:g} s")
    continued = min(series.shape[0] - 1, round(max(SETTLING, SETTLING_PERIODS / cutoff) / step))
    from scipy.signal import butter, sosfiltfilt  # slow to load

    return sosfiltfilt(butter(order, cutoff, fs=1 / step, output="sos"), series, axis=0, padlen=continued)


def statistics(
    series: Series, section: Section | None = None, order: int = ORDER, further: Iterable[str] = ()
) -> Statistics:
    """All FIGURES over a section of the line, or over the whole series, then the further, free ones: see quantities.py.

    order       of the filter
    Uplift is the largest of the supports in the section, its ends included, at any time; of all where the
    series does not tell where they are. At mid-span it is the largest of the points that are there: of none without a
    section. A series that is too short for one of the standard's bands does not tell it. Raises ZSpringError where the
    section is not inside the series, and where that is too short or too slow for a further band.
    """
    chosen = inside(series, section)
    below: dict[float, np.ndarray] = {}

    def up_to(cutoff: float) -> np.ndarray:
        if cutoff not in below:
            below[cutoff] = low_pass(series.force, series.step, cutoff, order)
        return below[cutoff]

    def deviation(low: float, high: float) -> float:
        return float(np.std((up_to(high) - up_to(low) if low > 0 else up_to(high))[chosen]))

    force = up_to(BAND)[chosen]
    lost = series.force[chosen] <= 0
    lengths = _lengths(lost)
    mean, whole = float(np.mean(force)), float(np.std(force))
    found = {
        "mean_force": mean,
        "standard_deviation": whole,
        "statistical_maximum": mean + 3 * whole,
        "statistical_minimum": mean - 3 * whole,
        "actual_maximum": float(np.max(force)),
        "actual_minimum": float(np.min(force)),
        "support_uplift": _highest(_at_supports(series, section)),
        "midspan_uplift": _highest(_at_middles(series, section)),
        "contact_point_range": np.nan if series.height is None else 1e3 * float(np.ptp(series.height[chosen])),
        "loss_of_contact": 100 * float(np.mean(lost)),
        "losses": float(len(lengths)),
        "longest_loss": 1e3 * series.step * max(lengths, default=0),
    }
    duration = series.time.size * series.step
    for name in (*FIGURES, *further):
        if band := band_of(name):
            is_told = name not in FIGURES or duration * (band[0] or band[1]) >= SHORTEST
            found[name] = deviation(*band) if is_told else np.nan
        elif (point := point_of(name)) is not None:
            found[name] = _highest(values for x, values in series.points.items() if abs(x - point) < SAME_POINT)
    return {name: found[name] for name in (*FIGURES, *further)}


def inside(series: Series, section: Section | None) -> np.ndarray:
    """Mask (n,) of the samples in the section. Raises ZSpringError where that is not inside the series."""
    if section is None:
        return np.ones(series.time.shape, dtype=bool)
    if series.position is None:
        raise ZSpringError(f"{series.name}: {section}: needs positions, or the speed to make them of the time")
    low, high = section.bounds
    first, last = series.position[[0, -1]]
    if low < first or high > last:
        raise ZSpringError(f"{series.name}: {section}: the series has {first:g} to {last:g} m")
    return (series.position >= low) & (series.position < high)


def _at_supports(series: Series, section: Section | None) -> Iterator[np.ndarray]:
    """Uplift of each support in the section. (n,) m"""
    low, high = section.bounds if section else (-np.inf, np.inf)
    places = series.support_position or {}
    for name, values in (series.uplift or {}).items():
        if low - 1e-6 <= places.get(name, low) <= high + 1e-6:
            yield values


def _at_middles(series: Series, section: Section | None) -> Iterator[np.ndarray]:
    """Uplift of each point at the middle of one of the section's spans. (n,) m"""
    for span in section.single_spans() if section else ():
        for position, values in series.points.items():
            if is_middle(position, span):
                yield values


def is_middle(position: float, span: Section) -> bool:
    """Whether a place, m, is at the middle of a single span."""
    low, high = span.bounds
    return abs(position - 0.5 * (low + high)) <= MIDDLE * (high - low)


def _highest(uplifts: Iterable[np.ndarray]) -> float:
    """mm, of all (n,) m; NaN where there is none."""
    return 1e3 * max((float(np.max(values)) for values in uplifts), default=np.nan)


def _lengths(flags: Sequence[bool] | np.ndarray) -> list[int]:
    """Lengths of the runs of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [int(length) for length in edges[1::2] - edges[::2]]
