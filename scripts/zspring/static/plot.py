"""The figure of the static study. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ..bench.loops import Loop
from ..figures import new_figure
from ..variables import Value

LAW_STYLES = {"Regularized": "-", "Coulomb": "--"}
MARKERS = "osD^v<>"


def static_figure(loops: Sequence[Loop], parameters: Mapping[str, Value], title: str) -> Figure:
    """Loops by amplitude, one loop by loading rate, stiffness over amplitude between both linear models.

    parameters  zspring.k_locked and zspring.k_free in N/m
    """
    figure = new_figure(14, 4.8)
    by_amplitude, by_rate, over_amplitude = figure.subplots(1, 3)
    rates = sorted({loop.rate for loop in loops})
    amplitudes = sorted({loop.amplitude for loop in loops})
    # The loop that friction fills best shows most.
    dissipation = {a: max(loop.area / a**2 for loop in loops if loop.amplitude == a) for a in amplitudes}
    fullest = max(dissipation, key=dissipation.__getitem__)

    shown = [a for a in amplitudes if fullest / 4 <= a <= 4 * fullest]
    colors = dict(zip(shown, matplotlib.colormaps["plasma"](np.linspace(0, 0.85, len(shown)))))
    for loop in loops:
        if loop.rate == rates[-1] and loop.amplitude in colors:
            label = f"{1e3 * loop.amplitude:g} mm" if loop.law == "Regularized" else None
            _draw(by_amplitude, loop, colors[loop.amplitude], label)
    by_amplitude.set_title(f"loops at {1e3 * rates[-1]:g} mm/s; dashed: Coulomb")
    by_amplitude.legend(fontsize=8, title="amplitude", title_fontsize=8)

    colors = dict(zip(rates, matplotlib.colormaps["viridis"](np.linspace(0, 0.85, len(rates)))))
    for loop in loops:
        if loop.amplitude == fullest:
            _draw(by_rate, loop, colors[loop.rate], f"{loop.law}, {1e3 * loop.rate:g} mm/s")
    by_rate.set_title(f"loop of {1e3 * fullest:g} mm by loading rate")
    by_rate.legend(fontsize=8)

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
    for axes in (by_amplitude, by_rate):
        axes.set(xlabel="compression, frame minus head  [mm]", ylabel="force beyond the static one  [N]")
    for axes in (by_amplitude, by_rate, over_amplitude):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    figure.suptitle(title)
    return figure


def _draw(axes, loop: Loop, color, label: str | None) -> None:
    axes.plot(1e3 * loop.compression, loop.force, LAW_STYLES[loop.law], color=color, linewidth=1.2, label=label)
