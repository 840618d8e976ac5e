"""The figure of a simulation. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ..figures import legend_beside, new_figure


def simulation_figure(columns: Mapping[str, np.ndarray], friction_bound: float, title: str) -> Figure:
    """Displacements, contact force, rod angles and friction moments over time.

    columns         "time" and the FMU's outputs by name, each (n,), in the FMU's units
    friction_bound  zspring.Mf in N.m
    """
    figure = new_figure(9.5, 9)
    panels = figure.subplots(4, 1, sharex=True)
    time = columns["time"]
    rows = (
        ("displacement  [mm]", 1e3, {"head": "head.z", "upper frame": "upper_frame.z", "lower frame": "lower_frame.z"}),
        ("contact force  [N]", 1.0, {"contact": "contact.force"}),
        ("rod angle  [deg]", np.degrees(1.0), {"α, head side": "zspring.alpha", "β, frame side": "zspring.beta"}),
        ("friction moment  [N.m]", 1.0, {"α": "zspring.moment_alpha", "β": "zspring.moment_beta"}),
    )
    for axes, (label, factor, names) in zip(panels, rows):
        for (text, name), style in zip(names.items(), ("-", "--", ":")):
            axes.plot(time, factor * columns[name], style, linewidth=1.2, label=text)
        axes.set_ylabel(label)
        axes.grid(True, linewidth=0.4, alpha=0.5)
        if len(names) > 1:
            legend_beside(axes)
    for sign in (-1, 1):
        panels[-1].axhline(sign * friction_bound, color="gray", linewidth=0.8, linestyle="--")
    panels[0].set_title(title)
    panels[-1].set_xlabel("time  [s]")
    panels[-1].set_xlim(time[0], time[-1])
    return figure
