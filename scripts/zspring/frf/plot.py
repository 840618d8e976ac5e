"""The figure of an FRF. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, MultipleLocator

from ..bench.measure import LEFT_OUT, NOT_SETTLED, REPEATS, FrfPoint
from ..bench.responses import QUANTITIES, as_quantity, phase_degrees
from ..figures import new_figure

BOUND_STYLES = {"locked": "--", "free": ":", "linear": "-."}
BOUND_LABELS = {
    "locked": "linear bound: rods locked",
    "free": "linear bound: rods free",
    "linear": "linear suspension k1",
}


def frf_figure(
    points: Sequence[FrfPoint],
    bounds: Mapping[str, tuple[np.ndarray, np.ndarray]],
    quantity: str,
    stroke: float,
    title: str,
) -> Figure:
    """Magnitude and phase over frequency, one colour for each amplitude, between the linear bounds.

    points      of one figure, in any order
    bounds      by model name ("locked", "free", "linear"): frequency (n,) in Hz and receptance (n,) in m/N
    quantity    "receptance" or "stiffness"
    stroke      in m, beyond which points were left out
    """
    figure = new_figure(8.5, 7.5)
    magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    for model, (frequency, H) in bounds.items():
        value = as_quantity(H, quantity)
        style = {"color": "black", "linestyle": BOUND_STYLES[model], "linewidth": 1.1, "zorder": 3}
        magnitude.semilogy(frequency, np.abs(value), label=BOUND_LABELS[model], **style)
        phase.plot(frequency, phase_degrees(value, quantity), **style)

    amplitudes = sorted({point.amplitude for point in points})
    colors = matplotlib.colormaps["plasma"](np.linspace(0, 0.88, len(amplitudes)))
    for number, (amplitude, color) in enumerate(zip(amplitudes, colors)):
        curve = sorted((p for p in points if p.amplitude == amplitude), key=lambda p: p.frequency)
        frequency = np.array([p.frequency for p in curve])
        value = as_quantity(np.array([p.H for p in curve]), quantity)
        style = {"color": color, "linewidth": 1.2, "marker": ".", "markersize": 3}
        magnitude.semilogy(frequency, np.abs(value), label=f"{amplitude:g} m/s²", **style)
        phase.plot(frequency, phase_degrees(value, quantity), **style)
        for status, marker in ((NOT_SETTLED, "o"), (REPEATS, "D")):
            doubtful = np.array([p.status.startswith(status) for p in curve])
            magnitude.semilogy(frequency[doubtful], np.abs(value[doubtful]), marker, color=color, fillstyle="none")
        missing = frequency[[p.status == LEFT_OUT for p in curve]]
        height = np.full(missing.shape, 0.02 + 0.022 * number)
        magnitude.plot(missing, height, "x", color=color, markersize=4, transform=magnitude.get_xaxis_transform())

    handles = magnitude.get_legend_handles_labels()[0]
    for status, marker, label in (
        (NOT_SETTLED, "o", "not settled"),
        (REPEATS, "D", "repeats only after several periods"),
        (LEFT_OUT, "x", f"left out: stroke > {1e3 * stroke:g} mm"),
    ):
        if any(point.status.startswith(status) for point in points):
            handles.append(
                Line2D(
                    [], [], color="gray", linestyle="none", marker=marker, fillstyle="none", markersize=5, label=label
                )
            )
    magnitude.legend(handles=handles, fontsize=8, ncols=2, title="peak acceleration of the head", title_fontsize=8)
    symbol = {"receptance": "|H|, receptance", "stiffness": "|1/H|, dynamic stiffness"}[quantity]
    magnitude.set(title=title, ylabel=f"{symbol}  [{QUANTITIES[quantity]}]")
    phase.set(xlabel="frequency  [Hz]", ylabel="phase  [deg]")
    phase.xaxis.set_major_locator(MaxNLocator(12))
    phase.yaxis.set_major_locator(MultipleLocator(45))
    for axes in (magnitude, phase):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    phase.set_xlim(0, max(point.frequency for point in points))
    return figure
