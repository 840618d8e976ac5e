"""The figures of a study over a line. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..figures import new_figure
from ..line.statistics import FIGURES
from .coupled import CoupledQuantity
from .files import Rows, values

COLUMNS = 3  # of panels


def distribution_figure(quantity: CoupledQuantity, compared: Mapping[str, Rows], title: str) -> Figure:
    """Of each figure that varies, the share of cases up to a value, of each of the compared and each pantograph."""
    every = [rows for rows in compared.values() if rows]
    names = [
        name
        for name in quantity.figures
        if any(_varies(values(rows, quantity.column(name, i))) for rows in every for i in range(quantity.pantographs))
    ] or list(quantity.figures)
    count = min(COLUMNS, len(names))
    rows_of_panels = -(-len(names) // count)
    figure = new_figure(3.6 * count, 2.5 * rows_of_panels + 0.9)
    panels = figure.subplots(rows_of_panels, count, sharey=True, squeeze=False)
    for axes, name in zip(panels.flat, names):
        for k, (label, rows) in enumerate(compared.items()):
            for i in range(quantity.pantographs):
                found = values(rows, quantity.column(name, i))
                if found.size and np.isfinite(found).any():
                    who = f"pantograph {i + 1}" if quantity.pantographs > 1 else ""
                    style = {"color": f"C{k}", "linestyle": ("-", "--")[i], "linewidth": 1.2}
                    axes.ecdf(found[np.isfinite(found)], label=", ".join(filter(None, (label, who))) or None, **style)
        shown, unit, _ = FIGURES[name]
        axes.set_xlabel(f"{shown}  [{unit or 1}]", fontsize=8)
        axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.ticklabel_format(axis="x", useOffset=False)
        axes.tick_params(labelsize=8)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    for axes in panels.flat[len(names) :]:
        axes.set_axis_off()
    if panels[0, 0].get_legend_handles_labels()[0]:
        panels[0, 0].legend(fontsize=7)
    figure.suptitle(title, fontsize=10)
    figure.supylabel("share of the cases up to the value", fontsize=9)
    return figure


def _varies(numbers: np.ndarray) -> bool:
    finite = numbers[np.isfinite(numbers)]
    return bool(finite.size and np.ptp(finite) > 0)
