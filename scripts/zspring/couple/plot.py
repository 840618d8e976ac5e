"""Figures of runs along a line. Nothing is simulated or filtered here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..figures import legend_beside, new_figure
from ..line.result import SLIPPING, LineResult
from ..line.statistics import FIGURES, Statistics
from .compare import Comparison

COLOURS = ("tab:blue", "tab:orange")


def line_figure(result: LineResult, filtered: np.ndarray | None, title: str) -> Figure:
    """Contact force, wire and head, friction state of the Z-spring and slack droppers along the line.

    filtered    contact force 0-20 Hz in N, (n, p); None where the run is too short for that
    """
    has_friction = bool(np.any(result.moment))
    heights = [2.2, 1.6, *([1.4] if has_friction else []), 0.7]
    figure = new_figure(11, 1.6 * sum(heights))
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    _draw_force(panels[0], result, filtered)
    _draw_heights(panels[1], result)
    if has_friction:
        _draw_friction(panels[2], result)
    panels[-1].fill_between(result.position[:, 0], result.slack_droppers, step="post", color="0.45")
    panels[-1].set_ylabel("slack\ndroppers")
    panels[-1].set_ylim(0, max(2, 1.1 * result.slack_droppers.max()))
    for axes in panels:
        axes.grid(True, axis="y", linewidth=0.4, alpha=0.5)
        for support in result.support_position:
            axes.axvline(support, color="0.8", linewidth=0.8, zorder=0)
        if felt := [until for until, end in zip(result.undisturbed_until, result.position[-1]) if until < end]:
            axes.axvspan(min(felt), result.position.max(), color="0.92", zorder=-1)
    panels[0].set_title(title)
    grey = "; grey: the far end's reflection is felt" if np.any(result.undisturbed_until < result.position[-1]) else ""
    panels[-1].set_xlabel(f"position along the line  [m], supports as vertical lines{grey}")
    panels[-1].set_xlim(result.position.min(), result.position.max())
    return figure


def _draw_force(axes: Axes, result: LineResult, filtered: np.ndarray | None) -> None:
    for i, name in enumerate(_names(result)):
        position = result.position[:, i]
        axes.plot(position, result.contact_force[:, i], color=COLOURS[i], linewidth=0.5, alpha=0.4)
        if filtered is not None:
            axes.plot(position, filtered[:, i], color=COLOURS[i], linewidth=1.3, label=f"{name}0-20 Hz")
    axes.set_ylabel("contact force  [N]")
    if filtered is not None:
        axes.set_ylim(bottom=min(0.0, filtered.min()))
        legend_beside(axes)


def _draw_heights(axes: Axes, result: LineResult) -> None:
    for i, name in enumerate(_names(result)):
        position = result.position[:, i]
        axes.plot(position, 1e3 * result.wire_height[:, i], color=COLOURS[i], label=f"{name}wire")
        axes.plot(
            position, 1e3 * result.head_height[:, i], color="0.2", linewidth=0.8, linestyle="--", label=f"{name}head"
        )
    axes.set_ylabel("height  [mm]")
    legend_beside(axes)


def _draw_friction(axes: Axes, result: LineResult) -> None:
    """Moments as a share of Mf, of the first pantograph; a mark below wherever a joint slips."""
    position, share = result.position[:, 0], result.moment[:, 0] / result.friction_bound[0]
    joints = ("α, head side", "tab:green", "-"), ("β, frame side", "tab:purple", "--")
    for joint, (name, colour, style) in enumerate(joints):
        axes.plot(position, share[:, joint], style, color=colour, linewidth=0.9, label=name)
        slips = np.abs(share[:, joint]) >= SLIPPING
        axes.fill_between(
            position,
            -1.25 - 0.15 * joint,
            -1.15 - 0.15 * joint,
            where=slips,
            color=colour,
            linewidth=0,
            label=f"slips, {100 * slips.mean():.0f} %",
        )
    axes.set_ylim(-1.5, 1.15)
    axes.set_ylabel("friction moment\n/ Mf")
    legend_beside(axes)


def _names(result: LineResult) -> Sequence[str]:
    count = result.position.shape[1]
    return [""] if count == 1 else [f"pantograph {i + 1}, " for i in range(count)]


def comparison_figure(rows: Sequence[Comparison], title: str) -> Figure:
    """Error of the contact force by communication step; the first row is the reference."""
    figure = new_figure(6.5, 4.5)
    axes = figure.subplots()
    for i, scheme in enumerate(dict.fromkeys(row.scheme for row in rows[1:])):
        colour = f"C{i}"
        own = [row for row in rows[1:] if row.scheme == scheme]
        steps = [1e3 * row.step for row in own]
        axes.loglog(steps, [row.rms for row in own], "o-", color=colour, label=f"{scheme}, rms")
        axes.loglog(steps, [row.largest for row in own], "o:", color=colour, label=f"{scheme}, largest")
    ticks = sorted({1e3 * row.step for row in rows})
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks], minor=False)
    axes.tick_params(axis="x", which="minor", labelbottom=False)
    axes.set_xlabel("communication step  [ms]")
    axes.set_ylabel("error of the contact force  [N]")
    axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    axes.legend(fontsize=8)
    axes.set_title(title)
    return figure


def draws_figure(drawn: Mapping[str, tuple[Statistics, Mapping[str, np.ndarray]]], title: str) -> Figure:
    """Histograms of values over draws, by pantograph, with those of the parameters as given; of those that differ."""
    first = next(iter(drawn.values()))[1]
    names = [name for name in first if any(np.ptp(values[name]) > 0 for _, values in drawn.values())] or list(first)
    rows = -(-len(names) // 2)
    figure = new_figure(9, 1.9 * rows + 0.8)
    figure.suptitle(title, fontsize=10)
    grid = figure.subplots(rows, 2).ravel()
    for axes, name in zip(grid, names):
        for color, (pantograph, (given, values)) in zip(COLOURS, drawn.items()):
            axes.hist(values[name], bins="auto", color=color, alpha=0.6, label=pantograph)
            axes.axvline(given[name], color=color, linewidth=1.2, linestyle="--")
        label, unit, _ = FIGURES[name]
        axes.set_xlabel(f"{label}  [{unit or 1}]", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.ticklabel_format(axis="x", useOffset=False)
        axes.set_yticks([])
    for axes in grid[len(names) :]:
        axes.set_axis_off()
    grid[0].legend(fontsize=7, title="dashed: as given", title_fontsize=7)
    return figure
