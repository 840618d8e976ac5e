"""Figures of a fit: measured points against the fitted model. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..bench.curves import Curve
from ..bench.responses import HARMONICS, phase_degrees
from ..bench.static_test import StaticTest
from ..figures import level_label, new_figure, over_frequency, rising_colors
from .fit import Fit
from .posterior import Posterior
from .problem import Problem
from .report import magnitude_error, phase_error


def fit_figure(curves: Sequence[Curve], fitted: Sequence[np.ndarray], drawn: Sequence[Curve], title: str) -> Figure:
    """Magnitude, phase and error of the magnitude over frequency, one colour for each level of the amplitude.

    fitted      receptances (n,) in m/N at the points of each curve
    drawn       the fitted model at and between them
    """
    figure = new_figure(8.5, 9)
    magnitude, phase, error = figure.subplots(3, 1, sharex=True, height_ratios=[2, 1, 1])
    colors = rising_colors(len(curves))
    for curve, H, line, color in zip(curves, fitted, drawn, colors):
        points = {"color": color, "linestyle": "none", "marker": "o", "fillstyle": "none", "markersize": 3}
        points |= {"elinewidth": 0.7, "capsize": 1.5}
        size, angle = magnitude_error(curve, H), phase_error(curve, H)
        scatter, turn = (np.sqrt(np.nanmean(each**2)) for each in (size, angle))
        magnitude.errorbar(curve.frequency, np.abs(curve.H), scatter * np.abs(curve.H), **points)
        magnitude.semilogy(line.frequency, np.abs(line.H), label=level_label(curve.label), color=color)
        phase.errorbar(curve.frequency, phase_degrees(curve.H, "receptance"), turn, **points)
        phase.plot(line.frequency, phase_degrees(line.H, "receptance"), color=color)
        error.plot(curve.frequency, 100 * size, marker=".", markersize=3, color=color, linewidth=0.6)
    handles = [
        Line2D([], [], color="gray", linestyle="none", marker="o", fillstyle="none", label="measured ± rms error"),
        Line2D([], [], color="gray", label="fitted"),
        *magnitude.get_legend_handles_labels()[0],
    ]
    magnitude.legend(handles=handles, fontsize=8, ncols=2)
    magnitude.set(title=title, ylabel="|H|, receptance  [m/N]")
    phase.set(ylabel="phase  [deg]")
    error.set(ylabel="fitted / measured - 1  [%]")
    over_frequency([magnitude, phase, error], np.concatenate([curve.frequency for curve in curves]))
    return figure


def static_figure(test: StaticTest, force: np.ndarray, title: str) -> Figure:
    """Force against displacement, measured and fitted, each without its mean. `force` (n,) in N."""
    figure = new_figure(6.5, 5)
    axes = figure.subplots()
    displacement = 1e3 * test.displacement
    axes.plot(displacement, test.force - test.force.mean(), "o", color="gray", markersize=3, label="measured")
    axes.plot(displacement, force - force.mean(), color="tab:blue", linewidth=1.2, label="fitted")
    axes.set(title=title, xlabel="displacement of the head  [mm]", ylabel="force on the head, mean removed  [N]")
    axes.grid(True, linewidth=0.4, alpha=0.5)
    axes.legend()
    return figure


def posterior_figure(problem: Problem, fit: Fit, posterior: Posterior, units: Mapping[str, str], title: str) -> Figure:
    """Draws of each parameter, and of each pair, with the fit; a corner figure."""
    frees = problem.settings.free
    values = {
        name: np.array([free.value(at) for at in posterior.x[:, i].tolist()])
        for i, (name, free) in enumerate(frees.items())
    }
    count = len(frees)
    figure = new_figure(2.2 * count + 1.5, 2.2 * count + 0.6)
    figure.suptitle(f"{title}, {len(posterior.x)} equally probable draws", fontsize=10)
    grid = figure.subplots(count, count, squeeze=False)
    for i, (row, y) in enumerate(values.items()):
        for j, (column, x) in enumerate(values.items()):
            axes = grid[i, j]
            if j > i:
                axes.set_axis_off()
                continue
            axes.axvline(fit.values[j], color="tab:orange", linewidth=1)
            if i == j:
                axes.hist(x, bins="auto", color="tab:blue", alpha=0.6)
                axes.set_yticks([])
            else:
                axes.axhline(fit.values[i], color="tab:orange", linewidth=1)
                axes.plot(x, y, ".", markersize=2, color="tab:blue")
            axes.tick_params(labelsize=7)
            axes.tick_params(axis="x", rotation=30)
            axes.xaxis.set_major_locator(MaxNLocator(4))
            if i != j:
                axes.yaxis.set_major_locator(MaxNLocator(4))
            if i == count - 1:
                axes.set_xlabel(f"{column}  [{units[column]}]", fontsize=8)
            if j == 0 and i > 0:
                axes.set_ylabel(f"{row}  [{units[row]}]", fontsize=8)
            if i < count - 1:
                axes.set_xticklabels([])
            if j > 0:
                axes.set_yticklabels([])
    return figure


def harmonics_figure(curves: Sequence[Curve], fitted: Sequence[np.ndarray], title: str) -> Figure | None:
    """Harmonics of the contact force over its first one, measured and fitted (n, 6) in N; None if none was measured."""
    measured = [curve.harmonics for curve in curves if curve.harmonics is not None]
    orders = [n for i, n in enumerate(HARMONICS) if any(np.isfinite(each.peak[:, i]).any() for each in measured)]
    if not orders:
        return None
    figure = new_figure(8.5, 1.9 * len(orders) + 0.8)
    panels = figure.subplots(len(orders), 1, sharex=True, squeeze=False)[:, 0]
    colors = rising_colors(len(curves))
    for axes, order in zip(panels, orders):
        column = HARMONICS.index(order)
        for curve, computed, color in zip(curves, fitted, colors):
            percent = 100 * np.abs(curve.H) / curve.displacement
            if curve.harmonics is not None:
                peak, error = percent * curve.harmonics.peak[:, column], percent * curve.harmonics.error[:, column]
                style = {"color": color, "linestyle": "none", "marker": "o", "fillstyle": "none", "markersize": 3}
                axes.errorbar(curve.frequency, peak, np.nan_to_num(error), elinewidth=0.7, **style)
            axes.plot(curve.frequency, percent * computed[:, column], color=color, label=level_label(curve.label))
        axes.set_ylabel(f"harmonic {order}  [%]")
        axes.grid(True, linewidth=0.4, alpha=0.5)
        axes.set_ylim(bottom=0)
    panels[0].set_title(title)
    panels[0].legend(fontsize=8, ncols=2, title="points measured, lines fitted", title_fontsize=8)
    panels[-1].set_xlabel("frequency  [Hz]")
    return figure
