"""Figures of recordings. Nothing is computed here but what is drawn."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from ..bench.responses import HARMONICS, phase_degrees
from ..figures import level_label, new_figure, rising_colors
from .cycle import Cycle
from .groups import Group
from .points import Point

INTERVAL = 1.96  # standard errors
MARKERS = {"up": "^", "down": "v", "rest": "o", None: "o"}


def response_figure(groups: Sequence[Group], title: str) -> Figure:
    """Magnitude and phase with 95 % intervals over frequency, one colour for each level, markers by direction."""
    figure = new_figure(8.5, 7.5)
    magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    labels = list(dict.fromkeys(group.label for group in groups))
    colors = dict(zip(labels, rising_colors(len(labels))))
    for group in groups:
        points = sorted(group.points, key=lambda point: point.frequency)
        frequency, H = group_values(points, "frequency"), group_values(points, "H")
        errors = [INTERVAL * group_values(points, name) for name in ("magnitude_error", "phase_error")]
        style = {"color": colors[group.label], "marker": MARKERS[group.direction], "markersize": 4, "linewidth": 0.7}
        style |= {
            "fillstyle": "none",
            "elinewidth": 1.1,
            "capsize": 2,
            "ls": "--" if group.direction == "down" else "-",
        }
        magnitude.errorbar(frequency, np.abs(H), np.abs(H) * errors[0], **style)
        phase.errorbar(frequency, phase_degrees(H, "receptance"), np.degrees(errors[1]), **style)
        marked = np.array([bool(point.marks) for point in points])
        magnitude.plot(frequency[marked], np.abs(H)[marked], "x", color="black", markersize=5, zorder=5)
    handles = [Line2D([], [], color=color, label=level_label(label)) for label, color in colors.items()]
    for way in dict.fromkeys(group.direction for group in groups):
        text = f"sweep {way}" if way else "measured"
        handles.append(
            Line2D(
                [], [], color="gray", ls="none", marker=MARKERS[way], fillstyle="none", label=f"{text}, 95 % interval"
            )
        )
    if any(point.marks for group in groups for point in group.points):
        handles.append(Line2D([], [], color="black", ls="none", marker="x", label="marked, see holds.csv"))
    magnitude.legend(handles=handles, fontsize=8, ncols=2)
    magnitude.set(title=title, ylabel="|H|, receptance  [m/N]", yscale="log")
    phase.set(xlabel="frequency  [Hz]", ylabel="phase  [deg]")
    phase.yaxis.set_major_locator(MultipleLocator(45))
    for axes in (magnitude, phase):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    return figure


def harmonics_figure(groups: Sequence[Group], title: str) -> Figure:
    """Harmonics of the contact force beside its fundamental over frequency, one panel for each level and direction.

    Those whose interval reaches 0 are not drawn.
    """
    columns = min(2, len(groups))
    rows = -(-len(groups) // columns)
    figure = new_figure(4.6 * columns + 1.2, 2.6 * rows + 0.8)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    colors = dict(zip(HARMONICS, matplotlib.colormaps["tab10"](range(len(HARMONICS)))))
    for axes, group in zip(panels.flat, groups):
        points = sorted(group.points, key=lambda point: point.frequency)
        frequency = group_values(points, "frequency")
        force, error = (np.array([getattr(p, name) for p in points]) for name in ("force", "force_error"))
        for k in HARMONICS:
            share, bar = (100 * values[:, k - 1] / force[:, 0] for values in (force, INTERVAL * error))
            share = np.where(share > bar, share, np.nan)
            style = {"ls": "-" if k % 2 else ":", "marker": "o" if k % 2 else "s", "markersize": 2.5, "linewidth": 0.9}
            axes.errorbar(frequency, share, bar, color=colors[k], elinewidth=0.5, label=f"{k}", **style)
        label = level_label(group.label) + (f", sweep {group.direction}" if group.direction else "")
        axes.set(yscale="log", ylim=(2e-2, 1e2))
        axes.set_title(label, fontsize=9)
        axes.grid(True, which="major", linewidth=0.4, alpha=0.5)
    for axes in panels.flat[len(groups) :]:
        axes.set_visible(False)
    figure.suptitle(f"{title}: harmonics of the contact force", fontsize=10)
    figure.supxlabel("frequency of the drive  [Hz]", fontsize=9)
    figure.supylabel("harmonic / fundamental  [%], 95 % interval", fontsize=9)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, title="harmonic", loc="outside right upper", fontsize=8, title_fontsize=8)
    return figure


def hold_figure(cycle: Cycle, point: Point) -> Figure:
    """One hold over its period, and as loop of force against displacement."""
    figure = new_figure(9.5, 4.6)
    time, loop = figure.subplots(1, 2)
    values = {"color": "0.65", "marker": ".", "ls": "none", "markersize": 2, "label": f"{point.periods} periods"}
    for axes, x, smooth in ((time, cycle.phase, cycle.smooth_phase), (loop, 1e3 * cycle.at, 1e3 * cycle.displacement)):
        axes.plot(x, cycle.force, **values)
        axes.plot(smooth, cycle.fundamental, color="tab:orange", linewidth=1.2, label="fundamental")
        axes.plot(smooth, cycle.smooth_force, color="tab:blue", linewidth=1.2, label="harmonics 1 to 7")
        axes.grid(True, linewidth=0.4, alpha=0.5)
    beside = time.twinx()
    beside.plot(cycle.smooth_phase, 1e3 * cycle.displacement, color="tab:green", linewidth=0.9, ls="--")
    beside.set_ylabel("displacement  [mm], dashed", color="tab:green")
    time.set(xlabel="phase  [periods]", ylabel="contact force about its mean  [N]", xlim=(0, 1))
    loop.set(xlabel="displacement of the head  [mm]", ylabel="contact force about its mean  [N]")
    time.legend(fontsize=8)
    figure.suptitle(
        f"{point.record}, {point.begin:.1f} to {point.end:.1f} s: {point.frequency:.4g} Hz, "
        f"{point.acceleration:.3g} m/s², loss {point.loss:.3g} J per cycle",
        fontsize=10,
    )
    return figure


def group_values(points: Sequence[Point], name: str) -> np.ndarray:
    """One value of each point (n,)."""
    return np.array([getattr(point, name) for point in points])
