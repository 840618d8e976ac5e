"""The map of stick and slip. Nothing is simulated here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ..bench.slip import PARTIAL, SLIP, STATES, SlipPoint, bounds
from ..figures import legend_beside, new_figure

STYLES = {  # of points: colour, marker
    "stick": ("tab:blue", "o"),
    "partial slip": ("tab:orange", "s"),
    "full slip": ("tab:red", "D"),
}
LINES = {PARTIAL: ("black", "-", "onset of slip"), SLIP: ("darkred", "--", "onset of full slip")}


def slip_figure(found: Mapping[float, Sequence[SlipPoint]], stroke: float, title: str) -> Figure:
    """Points in the colour of their state and the lines between, over frequency and amplitude.

    found       points by frequency (Hz), ascending
    stroke      in m, beyond which nothing was measured
    """
    figure = new_figure(9.5, 6.0)
    axes = figure.subplots()
    every = [point for points in found.values() for point in points]
    for state in STATES:
        color, marker = STYLES[state]
        some = [p for p in every if p.state == state]
        x, y = [p.frequency for p in some], [p.amplitude for p in some]
        axes.plot(x, y, marker, color=color, markersize=4, alpha=0.7, linestyle="none", label=state)
    for state, (color, style, label) in LINES.items():
        ends = [bounds(points, state) for points in found.values()]
        middle = [math.sqrt(low * high) if low > 0 else math.nan for low, high in ends]
        axes.plot(list(found), middle, style, color=color, linewidth=1.6, label=label)
    fine = np.linspace(min(found), max(found), 400)
    limit = stroke * (2 * np.pi * fine) ** 2
    low, high = min(p.amplitude for p in every), max(p.amplitude for p in every)
    if np.any(limit < high):
        axes.fill_between(fine, limit, 1.2 * high, color="lightgray", label=f"stroke > {1e3 * stroke:g} mm", zorder=0)
    axes.set(
        title=title,
        xlabel="frequency  [Hz]",
        ylabel="peak acceleration of the head  [m/s²]",
        yscale="log",
        ylim=(low / 1.2, 1.2 * high),
    )
    axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    legend_beside(axes)
    return figure
