"""The figure of what one cycle shows beside the FRF: loss, equivalent stiffness and damping, harmonics of the force."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from operator import attrgetter

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..bench.points import FrfPoint
from ..bench.responses import HARMONICS
from ..figures import new_figure
from .plot import LEVELS, WAY_STYLES, level_colors, shown

LEAST = 0.01  # % of the first harmonic; harmonics below are not drawn


def cycle_figure(ways: Mapping[str, Sequence[FrfPoint]], title: str) -> Figure:
    """Nine panels over frequency, one colour for each level; `ways` has the points by direction."""
    every = [point for points in ways.values() for point in points]
    colors, unit = level_colors(every), every[0].unit
    quantities: dict[str, Callable[[FrfPoint], float]] = {
        "loss per cycle  [J]": attrgetter("loss"),
        "equivalent stiffness  [N/m]": attrgetter("stiffness"),
        "equivalent damping  [N s/m]": attrgetter("damping"),
        **{f"harmonic {n} of the force  [% of the first]": partial(_share, i) for i, n in enumerate(HARMONICS)},
    }
    figure = new_figure(13.0, 9.5)
    axes = figure.subplots(3, 3, sharex=True)
    for a, (label, quantity) in zip(axes.flat, quantities.items()):
        for way, points in ways.items():
            for level, color in colors.items():
                curve = [p for p in points if p.level == level]
                x, y = [p.frequency for p in curve], [quantity(p) for p in curve]
                a.plot(x, y, color=color, linestyle=WAY_STYLES[way], linewidth=1.1, marker=".", markersize=2)
        if "stiffness" not in label:  # whose sign changes with inertia
            a.set_yscale("log")
        if label.startswith("harmonic"):
            a.set_ylim(LEAST, max(100.0, a.get_ylim()[1]))
        a.set_ylabel(label, fontsize=9)
        a.grid(True, which="major", linewidth=0.4, alpha=0.5)
        a.tick_params(labelsize=8)
        a.xaxis.set_major_locator(MaxNLocator(10))
    for a in axes[-1]:
        a.set(xlabel="frequency  [Hz]")
    handles = [Line2D([], [], color=tuple(color), label=shown(level, unit)) for level, color in colors.items()]
    if len(ways) > 1:
        handles += [Line2D([], [], color="gray", ls=WAY_STYLES[way], label=f"sweep {way}") for way in ways]
    figure.legend(
        handles=handles,
        fontsize=8,
        ncols=len(handles),
        loc="outside lower center",
        title=LEVELS[unit],
        title_fontsize=8,
    )
    figure.suptitle(title, fontsize=11)
    return figure


def _share(i: int, point: FrfPoint) -> float:
    """Of HARMONICS[i] in % of the first."""
    return 100 * point.harmonics[i] / point.force
