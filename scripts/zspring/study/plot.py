"""The figures of a study. Nothing is simulated here."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..figures import new_figure
from .report import Envelope, SobolIndices


def envelope_figure(envelopes: Sequence[Envelope], cases: int, title: str) -> Figure:
    """Envelope, 5 to 95 % band and median of |H| over frequency, one panel for each amplitude."""
    columns = min(2, len(envelopes))
    rows = math.ceil(len(envelopes) / columns)
    figure = new_figure(8.5 if columns == 1 else 11, 1.2 + 3.6 * rows)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, envelope in zip(panels.flat, envelopes):
        low, low_band, median, high_band, high = envelope.percentiles
        axes.fill_between(envelope.frequency, low, high, color="C0", alpha=0.18, linewidth=0, label="all cases")
        axes.fill_between(
            envelope.frequency, low_band, high_band, color="C0", alpha=0.35, linewidth=0, label="5 to 95 %"
        )
        axes.plot(envelope.frequency, median, color="black", linewidth=1.2, label="median")
        axes.set_title(f"{envelope.amplitude:g} m/s²")
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
        axes.xaxis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
    for axes in panels.flat[len(envelopes) :]:
        axes.set_visible(False)
    if any(np.isfinite(envelope.percentiles).any() for envelope in envelopes):
        panels[0, 0].set_yscale("log")  # of all panels, which share it
    panels[0, 0].legend(fontsize=8)
    figure.suptitle(f"{title}\n{cases} cases, by peak acceleration of the head")
    figure.supxlabel("frequency  [Hz]")
    figure.supylabel("|H|, receptance  [m/N]")
    return figure


def sobol_figure(found: Sequence[SobolIndices], parameters: Sequence[str], title: str) -> Figure:
    """First and total order indices with their confidence intervals, one panel for each result."""
    columns = min(2, len(found))
    rows = math.ceil(len(found) / columns)
    figure = new_figure(max(7.0, columns * (2 + 0.8 * len(parameters))), 1.2 + 2.6 * rows)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    positions = np.arange(len(parameters))
    for axes, indices in zip(panels.flat, found):
        style = {"width": 0.38, "capsize": 3, "error_kw": {"linewidth": 0.8}}
        axes.bar(positions - 0.2, indices.first, yerr=indices.first_confidence, label="first order", **style)
        axes.bar(positions + 0.2, indices.total, yerr=indices.total_confidence, label="total order", **style)
        axes.axhline(0, color="black", linewidth=0.6)
        axes.set_title(indices.column, fontsize=10)
        axes.set_xticks(positions, parameters)
        axes.tick_params(axis="x", labelrotation=30)
        axes.grid(True, axis="y", linewidth=0.4, alpha=0.5)
    for axes in panels.flat[len(found) :]:
        axes.set_visible(False)
    panels[0, 0].legend(fontsize=8)
    figure.suptitle(title)
    figure.supylabel("Sobol index (bars: 95 % confidence)")
    return figure
