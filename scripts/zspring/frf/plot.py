"""The figure of an FRF. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, MultipleLocator

from ..bench.compare import LevelComparison
from ..bench.points import LEFT_OUT, NOT_HELD, NOT_SETTLED, REPEATS, FrfPoint, differences
from ..bench.responses import QUANTITIES, RESPONSES, as_quantity, phase_degrees
from ..figures import level_label, new_figure, rising_colors
from ..receptance import LinearModel

BOUND_STYLES = {"locked": "--", "free": ":", "linear": "-."}
BOUND_LABELS = {
    "locked": "linear bound: rods locked",
    "free": "linear bound: rods free",
    "linear": "linear suspension k1",
}


NEAR = 0.1  # relative: accelerations that far apart have one colour
WAY_STYLES = {"up": "-", "down": "--", "rest": "-"}
MARKS = {
    NOT_SETTLED: ("o", "not settled"),
    REPEATS: ("D", "repeats only after several periods"),
    NOT_HELD: ("s", "force not held"),
}
LEVELS = {
    "m/s2": "peak acceleration of the head",
    "m/s": "peak velocity of the head",
    "m": "peak displacement of the head",
}
LEVELS |= {"N": "peak of the contact force's first harmonic"}


def frf_figure(
    ways: Mapping[str, tuple[Sequence[FrfPoint], Sequence[FrfPoint]]],
    levels: Sequence[LevelComparison],
    bounds: Mapping[str, LinearModel],
    quantity: str,
    stroke: float,
    title: str,
) -> Figure:
    """Magnitude and phase over frequency, one colour for each level, between the linear bounds.

    ways        by direction: points asked for, and others around the extremes, which are drawn without markers; of two
                the difference is drawn as well
    levels      of a measured response: points in the colour of their amplitude, or black ones on the model's curve
    bounds      by name ("locked", "free", "linear")
    quantity    of QUANTITIES
    stroke      in m, beyond which points were left out
    """
    both = len(ways) > 1
    figure = new_figure(8.5, 9.0 if both else 7.5)
    magnitude, phase, *rest = figure.subplots(2 + both, 1, sharex=True, height_ratios=[2, 1, 0.8][: 2 + both])
    every = [point for points, _ in ways.values() for point in points]
    fine = np.linspace(min(p.frequency for p in every), max(p.frequency for p in every), 4001)
    for model, bound in bounds.items():
        value = as_quantity(bound.receptance(fine), quantity, fine)
        style = {"color": "black", "linestyle": BOUND_STYLES[model], "linewidth": 1.1, "zorder": 3}
        magnitude.semilogy(fine, np.abs(value), label=BOUND_LABELS[model], **style)
        phase.plot(fine, phase_degrees(value, quantity), **style)

    colors, unit = level_colors(every), every[0].unit
    for way, (points, beside) in ways.items():
        asked = set(points)
        for number, (level, color) in enumerate(colors.items()):
            curve = sorted((p for p in (*points, *beside) if p.level == level), key=lambda p: p.frequency)
            frequency = np.array([p.frequency for p in curve])
            value = as_quantity(np.array([p.H for p in curve]), quantity, frequency)
            style = {"color": color, "linestyle": WAY_STYLES[way], "linewidth": 1.2, "marker": ".", "markersize": 3}
            style["markevery"] = [i for i, p in enumerate(curve) if p in asked]
            label = shown(level, unit) if way != "down" or not both else None
            magnitude.semilogy(frequency, np.abs(value), label=label, **style)
            phase.plot(frequency, phase_degrees(value, quantity), **style)
            for status, (marker, _) in MARKS.items():
                doubtful = np.array([p.status.startswith(status) for p in curve])
                magnitude.semilogy(frequency[doubtful], np.abs(value[doubtful]), marker, color=color, fillstyle="none")
            missing = frequency[[p.status == LEFT_OUT for p in curve]]
            height = np.full(missing.shape, 0.02 + 0.022 * number)
            magnitude.plot(missing, height, "x", color=color, markersize=4, transform=magnitude.get_xaxis_transform())

    for measured in levels:
        _draw_measured(magnitude, phase, measured, colors if unit == "m/s2" else {}, quantity)

    handles = magnitude.get_legend_handles_labels()[0]
    if both:
        handles += [Line2D([], [], color="gray", ls=WAY_STYLES[way], label=f"sweep {way}") for way in ways]
    for status, (marker, label) in {**MARKS, LEFT_OUT: ("x", f"left out: stroke > {1e3 * stroke:g} mm")}.items():
        if any(point.status.startswith(status) for point in every):
            handles.append(
                Line2D([], [], color="gray", ls="none", marker=marker, fillstyle="none", markersize=5, label=label)
            )
    magnitude.legend(handles=handles, fontsize=8, ncols=2, title=LEVELS[unit], title_fontsize=8)
    name = RESPONSES[QUANTITIES[quantity]].name
    magnitude.set(title=title, ylabel=f"{'|H|, ' * (quantity == 'receptance')}{name}  [{QUANTITIES[quantity]}]")
    phase.set(ylabel="phase  [deg]")
    phase.yaxis.set_major_locator(MultipleLocator(45))
    for axes in rest:
        found = differences(*(points for points, _ in ways.values()))
        for level, color in colors.items():
            x = [f for a, f in found if a == level]
            axes.semilogy(x, [100 * found[level, f] for f in x], ".-", color=color, linewidth=0.8, markersize=3)
        axes.set(ylabel=f"{' and '.join(ways)} differ by  [%]")
    for axes in (magnitude, phase, *rest):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    axes.set(xlabel="frequency  [Hz]", xlim=(fine[0], fine[-1]) if fine[0] < fine[-1] else None)
    axes.xaxis.set_major_locator(MaxNLocator(12))
    return figure


def _draw_measured(
    magnitude: Axes, phase: Axes, level: LevelComparison, colors: Mapping[float, np.ndarray], quantity: str
) -> None:
    """One level; at an amplitude that no curve has, also what the model has at its points."""
    frequency, middle = level.measured.frequency, float(np.median(level.measured.acceleration))
    near = [amplitude for amplitude in colors if abs(amplitude / middle - 1) < NEAR]
    color = colors[min(near, key=lambda a: abs(a / middle - 1))] if near else "black"
    style: dict[str, Any] = {"color": color, "linestyle": "none", "marker": "o", "markersize": 4, "fillstyle": "none"}
    label = level_label(level.measured.label)
    curves = [(level.measured.H, f"measured, {label}", style)]
    if not near:
        curves.append((level.computed, f"model, {label}", {"color": "black", "linewidth": 0.8}))
    for H, name, style in curves:
        value = as_quantity(H, quantity, frequency)
        magnitude.semilogy(frequency, np.abs(value), label=name, zorder=4, **style)
        phase.plot(frequency, phase_degrees(value, quantity), zorder=4, **style)


def level_colors(points: Sequence[FrfPoint]) -> dict[float, np.ndarray]:
    """A colour for each level, ascending."""
    levels = sorted({point.level for point in points})
    return dict(zip(levels, rising_colors(len(levels))))


def shown(level: float, unit: str) -> str:
    """A level in a legend."""
    return f"{1e3 * level:g} mm" if unit == "m" else level_label(f"{level:g} {unit}")
