"""The figure of an FRF's bands. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ..bench.responses import QUANTITIES, phase_degrees
from ..figures import level_label, new_figure, over_frequency, rising_colors


@dataclass(frozen=True)
class Band:
    """Of one level; lower end, median and upper end (3, n) over the draws, NaN where one of them has no value."""

    label: str
    frequency: np.ndarray  # (n,) Hz
    given: np.ndarray  # (n,) quantity of the parameters as given, complex
    magnitude: np.ndarray  # (3, n)
    phase: np.ndarray  # (3, n) deg


def bands_figure(bands: Sequence[Band], quantity: str, title: str) -> Figure:
    """Magnitude, phase, and the band's half width over the median, by level."""
    figure = new_figure(8.5, 9.0)
    magnitude, phase, width = figure.subplots(3, 1, sharex=True, height_ratios=[2, 1, 1])
    colors = rising_colors(len(bands))
    for band, color in zip(bands, colors):
        for axes, (low, _, high) in ((magnitude, band.magnitude), (phase, band.phase)):
            axes.fill_between(band.frequency, low, high, color=color, alpha=0.35, linewidth=0)
        label = level_label(band.label)
        magnitude.plot(band.frequency, np.abs(band.given), color=color, linewidth=0.9, label=label)
        phase.plot(band.frequency, phase_degrees(band.given, quantity), color=color, linewidth=0.9)
        low, middle, high = band.magnitude
        width.plot(band.frequency, 50 * (high - low) / middle, color=color, linewidth=1.0)
    magnitude.set_yscale("log")
    magnitude.legend(title="line: as given", title_fontsize=8, fontsize=8, ncols=2)
    magnitude.set(title=title, ylabel=f"{quantity}, magnitude  [{QUANTITIES[quantity]}]")
    phase.set(ylabel="phase  [deg]")
    width.set(ylabel="± half width  [%]")
    width.set_ylim(bottom=0)
    over_frequency([magnitude, phase, width], np.concatenate([band.frequency for band in bands]))
    return figure
