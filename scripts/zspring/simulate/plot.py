"""The figure of a simulation. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..figures import legend_beside, new_figure


class Panel(NamedTuple):
    """Outputs that are drawn together, by their names in the legend, in units of 1/factor of the FMU's."""

    label: str
    factor: float
    lines: Mapping[str, str]


PANELS = (
    Panel(
        "displacement  [mm]",
        1e3,
        {"head": "head.z", "upper frame": "upper_frame.z", "lower frame": "lower_frame.z", "wire": "wire_height"},
    ),
    Panel("contact force  [N]", 1.0, {"contact": "contact.force"}),
    Panel(
        "rod angle  [deg]", float(np.degrees(1.0)), {"α, head side": "zspring.alpha", "β, frame side": "zspring.beta"}
    ),
    Panel("friction moment  [N.m]", 1.0, {"α": "zspring.moment_alpha", "β": "zspring.moment_beta"}),
)


def simulation_figure(
    columns: Mapping[str, np.ndarray], friction_bound: float, title: str, start: Decimal = Decimal(0)
) -> Figure:
    """Displacements, contact force, rod angles and friction moments over time.

    columns         "time" and the FMU's outputs by name, with drive Wire "wire_height", each (n,), in the FMU's units
    friction_bound  zspring.Mf in N.m
    start           s, of the run in the times of its input
    """
    figure = new_figure(9.5, 9)
    panels = figure.subplots(len(PANELS), 1, sharex=True)
    time = columns["time"]
    for axes, (label, factor, lines) in zip(panels, PANELS):
        for (name, output), style in zip(lines.items(), ("-", "--", ":", "-.")):
            if output in columns:
                axes.plot(time, factor * columns[output], style, linewidth=1.2, label=name)
        axes.set_ylabel(label)
        axes.ticklabel_format(axis="y", useOffset=False)
        axes.grid(True, linewidth=0.4, alpha=0.5)
        if len(lines) > 1:
            legend_beside(axes)
    for sign in (-1, 1):
        panels[-1].axhline(sign * friction_bound, color="gray", linewidth=0.8, linestyle="--")
    panels[0].set_title(title)
    panels[-1].set_xlabel(f"time since {start.normalize():f} s  [s]" if start else "time  [s]")
    panels[-1].set_xlim(time[0], time[-1])
    return figure
