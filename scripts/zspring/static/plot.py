"""The figure of the static study. Nothing is simulated here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ..bench.loops import Loop
from ..figures import new_figure
from ..variables import Value

LAW_STYLES = {"Regularized": "-", "Coulomb": "--"}
MARKERS = "osD^v<>"
MOST_COLUMNS = 5


def static_figure(loops: Sequence[Loop], parameters: Mapping[str, Value], title: str) -> Figure:
    """The loops, a panel for each amplitude, and the stiffness over the amplitude between both linear models.

    parameters  zspring.k_locked and zspring.k_free in N/m
    """
    rates, amplitudes = (sorted({getattr(loop, key) for loop in loops}) for key in ("rate", "amplitude"))
    colors = dict(zip(rates, matplotlib.colormaps["viridis"](np.linspace(0, 0.85, len(rates)))))
    columns = min(math.ceil(math.sqrt(len(amplitudes))), MOST_COLUMNS)
    rows = math.ceil(len(amplitudes) / columns)
    figure = new_figure(2.3 * columns + 5.5, max(1.9 * rows, 4.0) + 0.8)
    left, right = figure.subfigures(1, 2, squeeze=False, width_ratios=[2.3 * columns, 5.5])[0]
    panels = left.subplots(rows, columns, squeeze=False).ravel()
    for axes, amplitude in zip(panels, amplitudes):
        for loop in loops:
            if loop.amplitude == amplitude:
                axes.plot(
                    1e3 * loop.compression, loop.force, LAW_STYLES[loop.law], color=colors[loop.rate], linewidth=1.1
                )
        axes.set_title(f"{1e3 * amplitude:g} mm", fontsize=9)
        axes.ticklabel_format(useOffset=False, style="plain")
        axes.tick_params(labelsize=7)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    for axes in panels[len(amplitudes) :]:
        axes.remove()
    left.supxlabel("compression, frame minus head  [mm]", fontsize=10)
    left.supylabel("force beyond the static one  [N]", fontsize=10)
    over_amplitude = right.subplots()
    for law, style in LAW_STYLES.items():
        for (rate, color), marker in zip(colors.items(), MARKERS * len(rates)):
            curve = sorted((loop.amplitude, loop.stiffness) for loop in loops if (loop.law, loop.rate) == (law, rate))
            x, y = np.array(curve).T
            filled = "full" if law == "Regularized" else "none"
            over_amplitude.semilogx(
                1e3 * x,
                1e-3 * y,
                style,
                color=color,
                marker=marker,
                fillstyle=filled,
                markersize=4,
                linewidth=1.2,
                label=f"{law}, {1e3 * rate:g} mm/s",
            )
    for name, style in (("k_locked", "--"), ("k_free", ":")):
        stiffness = 1e-3 * parameters[f"zspring.{name}"]
        over_amplitude.axhline(stiffness, color="black", linestyle=style, linewidth=1.0)
        over_amplitude.annotate(
            f"rods {name[2:]}",
            (0.02, stiffness),
            xycoords=("axes fraction", "data"),
            xytext=(0, 3),
            textcoords="offset points",
            fontsize=8,
        )
    over_amplitude.set(
        xlabel="amplitude  [mm]",
        ylabel="secant stiffness, peak to peak  [N/mm]",
        title="equivalent stiffness",
        ylim=(0, 1.1e-3 * parameters["zspring.k_locked"]),
    )
    over_amplitude.legend(fontsize=8, loc="lower left")
    over_amplitude.grid(True, which="both", linewidth=0.4, alpha=0.5)
    if len(amplitudes) > 1:
        over_amplitude.set_xlim(1e3 * amplitudes[0], 1e3 * amplitudes[-1])
    figure.suptitle(title)
    return figure
