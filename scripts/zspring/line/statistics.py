"""Statistics of a contact force as EN 50318 takes them: 0 to 20 Hz, and its parts below and above 5 Hz.

The filter is a Butterworth low-pass of order 4, run forwards and backwards over the whole series: no phase
shift, gain 1 / (1 + (f / f_c)^8), which is 1/2 (-6 dB) at the band's edge f_c, 0.71 at 0.90 f_c and 0.97 at
0.65 f_c. The part of 5 to 20 Hz is the difference of the forces of 0 to 20 and 0 to 5 Hz, so that the
parts add up to the whole; their variances do so but for what both have near 5 Hz. The series is continued at
its ends by point reflection; ends belong to no span that is evaluated, if the series is long enough.

Loss of contact is counted in the unfiltered force: the share of time in which it is not positive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import ZSpringError
from .series import BAND, Series

ORDER = 4  # of the filter that runs twice
PARTS = 5.0  # Hz, where the standard parts the band
SETTLING = 1.0  # s by which the series is continued at its ends

# Names, and by them label, unit and digits to show, in the order of the standard's table.
FIGURES: dict[str, tuple[str, str, int]] = {
    "mean_force": ("mean force", "N", 1),
    "standard_deviation": ("standard deviation, 0-20 Hz", "N", 1),
    "standard_deviation_0_5": ("standard deviation, 0-5 Hz", "N", 1),
    "standard_deviation_5_20": ("standard deviation, 5-20 Hz", "N", 1),
    "statistical_maximum": ("statistical maximum", "N", 1),
    "statistical_minimum": ("statistical minimum", "N", 1),
    "actual_maximum": ("actual maximum", "N", 1),
    "actual_minimum": ("actual minimum", "N", 1),
    "support_uplift": ("largest uplift at a support", "mm", 1),
    "contact_point_range": ("range of the contact point", "mm", 1),
    "loss_of_contact": ("loss of contact", "%", 2),
    "losses": ("number of losses of contact", "", 0),
    "longest_loss": ("longest loss of contact", "ms", 1),
}

Statistics = dict[str, float]  # by name, in the units of FIGURES; NaN where the series does not tell


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

    def moved(self, by: float) -> Section:
        """The same spans `by` m further along."""
        return Section(self.first, self.last, tuple(edge + by for edge in self.edges))

    def __str__(self) -> str:
        spans = f"span {self.first}" if self.first == self.last else f"spans {self.first} to {self.last}"
        return "{}, {:g} to {:g} m".format(spans, *self.bounds)

    def single_spans(self) -> list[Section]:
        """Its spans one by one."""
        return [Section(self.first + i, self.first + i, self.edges[i : i + 2]) for i in range(len(self.edges) - 1)]


def low_pass(series: np.ndarray, step: float, cutoff: float = BAND, order: int = ORDER) -> np.ndarray:
    """The part of (n,) or (n, p) samples, `step` s apart, below `cutoff` Hz; see the head of this file.

    Raises ZSpringError where the samples are too few or too slow for the filter.
    """
    series = np.asarray(series, dtype=float)
    if not step < 0.4 / cutoff:
        raise ZSpringError(f"sample step {step:g} s: must be below {0.4 / cutoff:g} s for {cutoff:g} Hz")
    if series.shape[0] * step < 5 / cutoff:
        raise ZSpringError(f"{series.shape[0] * step:g} s are too short for {cutoff:g} Hz: at least {5 / cutoff:g} s")
    continued = min(series.shape[0] - 1, round(SETTLING / step))
    from scipy.signal import butter, sosfiltfilt  # slow to load

    return sosfiltfilt(butter(order, cutoff, fs=1 / step, output="sos"), series, axis=0, padlen=continued)


def statistics(series: Series, section: Section | None = None, order: int = ORDER) -> Statistics:
    """All figures over a section of the line, or over the whole series.

    Uplift is the largest of the supports in the section, its ends included, at any time; of all where the
    series does not tell where they are. `order` is that of the filter. Raises ZSpringError where the section
    is not inside the series.
    """
    chosen = _within(series, section)
    force = low_pass(series.force, series.step, BAND, order)
    below = low_pass(series.force, series.step, PARTS, order)
    mean, deviation = float(np.mean(force[chosen])), float(np.std(force[chosen]))
    lost = series.force[chosen] <= 0
    lengths = _lengths(lost)
    uplift = _uplifts(series, section)
    return {
        "mean_force": mean,
        "standard_deviation": deviation,
        "standard_deviation_0_5": float(np.std(below[chosen])),
        "standard_deviation_5_20": float(np.std((force - below)[chosen])),
        "statistical_maximum": mean + 3 * deviation,
        "statistical_minimum": mean - 3 * deviation,
        "actual_maximum": float(np.max(force[chosen])),
        "actual_minimum": float(np.min(force[chosen])),
        "support_uplift": 1e3 * max(uplift) if uplift else np.nan,
        "contact_point_range": np.nan if series.height is None else 1e3 * float(np.ptp(series.height[chosen])),
        "loss_of_contact": 100 * float(np.mean(lost)),
        "losses": float(len(lengths)),
        "longest_loss": 1e3 * series.step * max(lengths, default=0),
    }


def _within(series: Series, section: Section | None) -> np.ndarray:
    """Mask of the samples in the section."""
    if section is None:
        return np.ones(series.time.shape, dtype=bool)
    if series.position is None:
        raise ZSpringError(f"{series.name}: {section}: needs positions, or the speed to make them of the time")
    low, high = section.bounds
    first, last = series.position[[0, -1]]
    if low < first or high > last:
        raise ZSpringError(f"{series.name}: {section}: the series has {first:g} to {last:g} m")
    return (series.position >= low) & (series.position < high)


def _uplifts(series: Series, section: Section | None) -> list[float]:
    """Largest uplift in m of each support in the section."""
    if not series.uplift:
        return []
    low, high = section.bounds if section else (-np.inf, np.inf)
    places = series.support_position or {}
    return [
        float(np.max(values))
        for name, values in series.uplift.items()
        if low - 1e-6 <= places.get(name, low) <= high + 1e-6
    ]


def _lengths(flags: Sequence[bool] | np.ndarray) -> list[int]:
    """Lengths of the runs of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [int(length) for length in edges[1::2] - edges[::2]]
