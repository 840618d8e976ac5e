"""The values of a contact force along a line: those that every evaluation has, and free ones by their names.

standard_deviation_20_50 is the standard deviation of 20 to 50 Hz, uplift_at_132.5 the largest uplift of the contact
wire 132.5 m along the line.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

# Names, and by them label, unit and digits to show, in the order of the standard's table.
FIGURES: dict[str, tuple[str, str, int]] = {
    "mean_force": ("mean force", "N", 1),
    "standard_deviation": ("standard deviation, 0-20 Hz", "N", 1),
    "standard_deviation_0_2": ("standard deviation, 0-2 Hz", "N", 1),
    "standard_deviation_0_5": ("standard deviation, 0-5 Hz", "N", 1),
    "standard_deviation_5_20": ("standard deviation, 5-20 Hz", "N", 1),
    "statistical_maximum": ("statistical maximum", "N", 1),
    "statistical_minimum": ("statistical minimum", "N", 1),
    "actual_maximum": ("actual maximum", "N", 1),
    "actual_minimum": ("actual minimum", "N", 1),
    "support_uplift": ("largest uplift at a support", "mm", 1),
    "midspan_uplift": ("largest uplift at mid-span", "mm", 1),
    "contact_point_range": ("range of the contact point", "mm", 1),
    "loss_of_contact": ("loss of contact", "%", 2),
    "losses": ("number of losses of contact", "", 0),
    "longest_loss": ("longest loss of contact", "ms", 1),
}
FREE = "standard_deviation_LOW_HIGH (Hz) or uplift_at_X (m)"
_NUMBER = r"(\d+(?:\.\d+)?)"
_BAND, _POINT = re.compile(rf"standard_deviation_{_NUMBER}_{_NUMBER}"), re.compile(rf"uplift_at_{_NUMBER}")

Statistics = dict[str, float]  # by name, in the units of the values; NaN where the series does not tell


def is_figure(name: str) -> bool:
    """Whether a value has that name."""
    return name in FIGURES or band_of(name) is not None or point_of(name) is not None


def described(name: str) -> tuple[str, str, int]:
    """Label, unit and digits of a figure. Raises KeyError for a name that is none."""
    if name in FIGURES:
        return FIGURES[name]
    if (band := band_of(name)) is not None:
        return "standard deviation, {:g}-{:g} Hz".format(*band), "N", 1
    if (point := point_of(name)) is not None:
        return f"largest uplift at {point:g} m", "mm", 1
    raise KeyError(name)


def band_of(name: str) -> tuple[float, float] | None:
    """Ends in Hz of the band whose standard deviation a figure is; None for another figure."""
    found = _BAND.fullmatch(name)
    low, high = map(float, found.groups()) if found else (0.0, 0.0)
    return (low, high) if low < high else None


def point_of(name: str) -> float | None:
    """Position in m of the point whose uplift a figure is; None for another figure."""
    found = _POINT.fullmatch(name)
    return float(found[1]) if found else None


def points_of(names: Iterable[str]) -> tuple[float, ...]:
    """Positions in m of the points among values."""
    return tuple(point for name in names if (point := point_of(name)) is not None)


def band_figure(low: float, high: float) -> str:
    """Name of the standard deviation from low to high, in Hz."""
    return f"standard_deviation_{low:.12g}_{high:.12g}"


def point_figure(position: float) -> str:
    """Name of the largest uplift of the contact wire at a position, in m."""
    return f"uplift_at_{position:.12g}"
