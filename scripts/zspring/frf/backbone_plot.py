"""The backbone: frequency and height of the resonances against the level. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from ..figures import new_figure
from .backbone import Row
from .plot import BOUND_LABELS, BOUND_STYLES, LEVELS, WAY_STYLES


def backbone_figure(rows: Sequence[Row], title: str) -> Figure:
    """Two panels over one level axis: frequency, and |H|.

    A line goes through the highest resonance of each level, by peak; other peaks are dots, those in doubt hollow, and
    crosses are resonances by phase. Of the linear bounds the highest one.
    """
    figure = new_figure(10.0, 5.5)
    left, right = figure.subplots(1, 2, sharey=True)
    for way in dict.fromkeys(row.direction for row in rows if row.unit):
        curves = [row for row in rows if row.direction == way and row.unit]
        line = [(row.level, e) for row in curves if (e := row.highest)]
        style = {"color": "tab:blue", "linestyle": WAY_STYLES[way], "linewidth": 1.3}
        label = "highest peak" + (f", sweep {way}" if way != "rest" else "")
        left.plot([e.frequency for _, e in line], [level for level, _ in line], label=label, **style)
        right.plot([1e3 * e.magnitude for _, e in line], [level for level, _ in line], **style)
        for row in curves:
            for i, e in enumerate(row.extremes):
                if e.is_resonance:
                    fill = "none" if e.doubt else "full"
                    for axes, x in ((left, e.frequency), (right, 1e3 * e.magnitude)):
                        axes.plot(x, row.level, "o", color="tab:blue", markersize=4, fillstyle=fill)
                if found := row.by_phase(i):
                    for axes, x in ((left, found.frequency), (right, 1e3 * found.magnitude)):
                        axes.plot(x, row.level, "x", color="tab:red", markersize=6)
    left.plot([], [], "o", color="tab:blue", markersize=4, label="peak of |H|")
    left.plot([], [], "x", color="tab:red", markersize=6, label="phase of H is -90°")
    for row in rows:
        if not row.unit and (e := row.highest):
            style = {"color": "black", "linestyle": BOUND_STYLES[row.curve], "linewidth": 1.0}
            left.axvline(e.frequency, label=BOUND_LABELS[row.curve], **style)
            right.axvline(1e3 * e.magnitude, **style)
    unit = next(row.unit for row in rows if row.unit)
    levels = sorted({row.level for row in rows if row.unit})
    left.set(
        xlabel="frequency of the resonance  [Hz]",
        ylabel=f"{LEVELS[unit]}  [{unit}]".replace("m/s2", "m/s²"),
        yscale="log",
    )
    left.yaxis.set_minor_locator(NullLocator())
    left.set_yticks(levels, [f"{level:g}" for level in levels])
    right.set(xlabel="|H| at the resonance  [mm/N]")
    for axes in (left, right):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    figure.legend(fontsize=8, ncols=3, loc="outside lower center")
    figure.suptitle(title, fontsize=11)
    return figure
