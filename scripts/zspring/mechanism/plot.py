"""The linkage drawn to scale. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import new_figure
from .cycle import Cycle

COILS = 7
COIL_WIDTH = 4.0  # mm
STRIP = 150.0  # mm, above the head's joint
BASE = -60.0  # mm, the frame's crossbar, below the head's joint in the static state
SIDES = (-45.0, 215.0)  # mm, ends of strip and crossbar
REST, BELOW, ABOVE = "0.65", "C3", "C0"


def mechanism_figure(cycles: Sequence[Cycle], magnifications: Sequence[float], title: str) -> Figure:
    """The static state with its dimensions, and the two extremes of each cycle, seen from the upper frame."""
    figure = new_figure(5.2 * (1 + len(cycles)), 5.6)
    panels = figure.subplots(1, 1 + len(cycles), sharex=True, sharey=True)
    _dimensions(panels[0], cycles[0])
    for axes, cycle, magnification in zip(panels[1:], cycles, magnifications):
        points = 1e3 * cycle.points(magnification, on_frame=True)
        rest = 1e3 * cycle.points(0.0, on_frame=True)[0]
        _draw(axes, rest, REST, frame=True)
        for index, color in zip(cycle.extremes, (BELOW, ABOVE)):
            label = f"head {-1e3 * cycle.compression[index]:+.2f} mm on the frame"
            label += f", α {np.degrees(cycle.alpha[index]):.2f}°"
            _draw(axes, points[index], color, label=label)
        axes.set_title(case_title(cycle, magnification), fontsize=10)
        axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 0))
    for axes in panels:
        axes.set_aspect("equal")
        axes.set(xlabel="[mm]", ylim=(BASE - 55, STRIP + 45))
        axes.grid(True, linewidth=0.3, alpha=0.5)
    panels[0].set_ylabel("from the head's joint at rest  [mm]")
    figure.suptitle(title)
    return figure


def case_title(cycle: Cycle, magnification: float) -> str:
    """What the cycle is, what its rods do, and at which scale its motion is drawn."""
    rods = "rods slipping" if cycle.slips else "rods stuck"
    scale = "motion to scale" if magnification == 1 else f"motion magnified {magnification:g} times"
    return f"{cycle.frequency:g} Hz, {cycle.acceleration:g} m/s²: {rods}, {scale}"


def spring_line(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Zigzag from one point to another, (m, 2), in mm."""
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    place = np.linspace(0, 1, 2 * COILS + 4)
    offset = np.zeros_like(place)
    offset[2:-2] = np.where(np.arange(2 * COILS) % 2, -COIL_WIDTH, COIL_WIDTH)
    return start + np.outer(place, end - start) + np.outer(offset, across)


def _draw(axes: Axes, points: np.ndarray, color: str, frame: bool = False, label: str | None = None) -> None:
    """One state, points (4, 2) in mm; its head, rods and spring, and the frame if asked for."""
    head, head_end, frame_end, top = points
    axes.plot([head[0]] * 2, [head[1], head[1] + STRIP], color=color, linewidth=2)
    axes.plot(SIDES, [head[1] + STRIP] * 2, color=color, linewidth=4, solid_capstyle="butt", label=label)
    for one, other in ((head, head_end), (frame_end, top)):
        axes.plot(*np.transpose([one, other]), color=color, linewidth=3, marker="o", markersize=5)
    axes.plot(*spring_line(head_end, frame_end).T, color=color, linewidth=1.2)
    if frame:
        axes.plot([top[0]] * 2, [BASE, top[1]], color="black", linewidth=2)
        axes.plot(SIDES, [BASE] * 2, color="black", linewidth=5, solid_capstyle="butt")


def _dimensions(axes: Axes, cycle: Cycle) -> None:
    points = 1e3 * cycle.points(0.0)[0]
    _draw(axes, points, "C7", frame=True)
    head, head_end, frame_end, top = points
    p = cycle.parameters
    above, below = ((-10, 10), "right"), ((10, -10), "left")
    for one, other, text, (offset, align) in (
        (head, head_end, f"L1 = {1e3 * p['zspring.L1']:g}", below),
        (head_end, frame_end, "spring", above),
        (frame_end, top, f"L2 = {1e3 * p['zspring.L2']:g}", above),
    ):
        axes.annotate(text, (one + other) / 2, offset, textcoords="offset points", fontsize=9, ha=align)
    low = head[1] - 28
    axes.annotate("", (head[0], low), (top[0], low), arrowprops={"arrowstyle": "<->", "linewidth": 0.8})
    axes.text((head[0] + top[0]) / 2, low + 3, f"d = {1e3 * p['zspring.d']:g}", fontsize=9, ha="center")
    axes.plot([head[0], head[0] + 60], [head[1]] * 2, "k:", linewidth=0.8)
    axes.text(head[0] + 20, head[1] - 12, f"θ = {np.degrees(p['zspring.theta']):.1f}°", fontsize=9)
    axes.text(SIDES[0], STRIP + 6, "head", fontsize=9)
    axes.text(SIDES[0], BASE - 15, "upper frame", fontsize=9)
    axes.set_title("static state, lengths in mm", fontsize=10)
