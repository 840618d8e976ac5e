"""The drawing of a line at rest. Nothing is simulated here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import new_figure
from ..line_table import MESSENGER, LineTable
from .statics import AtRest

WIDTHS = 11.0, 40.0  # inch, least and most
PER_INCH = 50.0  # m of line, where the width allows it
HIGH = 1.3  # inch, of the line itself at least
SCALES = 1, 2, 5, 10, 20, 50, 100, 200  # by which heights are exaggerated
COLOURS = {"contact": "black", "messenger": "tab:blue", "stitch": "tab:green", "dropper": "0.4", "mass": "tab:red"}


@dataclass(frozen=True)
class Drawn:
    """What is drawn of a line.

    between     m, along the line
    wires       at places in ascending order, with those of droppers, supports and clamps there
    droppers    at all droppers
    places      m, of the elasticity in m/N, under `force` N
    """

    name: str
    table: LineTable
    between: tuple[float, float]
    wires: AtRest
    droppers: AtRest
    places: np.ndarray
    elasticity: np.ndarray
    force: float


def line_drawing(drawn: Drawn) -> Figure:
    """The line to scale; the contact wire's height and the droppers' forces; the elasticity; one above the other."""
    begin, end = drawn.between
    width = float(np.clip((end - begin) / PER_INCH, *WIDTHS))
    wires, own = drawn.wires, _within(drawn.droppers.x, drawn)
    heights = np.concatenate([wires.contact_wire, wires.messenger])
    tall = 1.15 * np.ptp(heights)
    per_metre = (width - 1.2) / (end - begin)  # inch, beside the axis' labels
    scale = next((s for s in SCALES if s * per_metre * tall >= HIGH), SCALES[-1])
    sizes = [max(HIGH, scale * per_metre * tall), 1.2, 1.2, 1.4]
    figure = new_figure(width, sum(sizes) + 1.6)
    line, sag, forces, elastic = figure.subplots(4, 1, sharex=True, height_ratios=sizes)
    _draw_line(line, drawn)
    line.set_aspect(scale, adjustable="datalim")
    line.set_ylabel("height  [m]")
    line.set_title(
        f"{drawn.name}: at rest, heights {scale} times exaggerated" if scale > 1 else f"{drawn.name}: at rest"
    )
    sag.plot(wires.x, 1e3 * wires.contact_wire, color=COLOURS["contact"], linewidth=1.0)
    sag.plot(drawn.droppers.x[own], 1e3 * drawn.droppers.contact_wire[own], "o", color=COLOURS["dropper"], markersize=3)
    sag.set_ylabel("contact wire\n[mm]")
    forces.vlines(drawn.droppers.x[own], 0, drawn.droppers.dropper_force[own], color=COLOURS["dropper"], linewidth=2.5)
    forces.set_ylabel("dropper\nforce  [N]")
    forces.set_ylim(bottom=0)
    elastic.plot(drawn.places, 1e3 * drawn.elasticity, color="tab:purple", linewidth=1.2)
    elastic.set_ylabel(f"elasticity\nunder {drawn.force:g} N\n[mm/N]")
    elastic.set_ylim(bottom=0)
    for axes in (sag, forces, elastic):
        axes.grid(True, axis="y", linewidth=0.4, alpha=0.5)
        for support in drawn.table.boundaries:
            axes.axvline(support, color="0.8", linewidth=0.8, zorder=0)
    elastic.set_xlim(begin, end)
    elastic.set_xlabel("position along the line  [m], supports as vertical lines")
    return figure


def _draw_line(axes: Axes, drawn: Drawn) -> None:
    wires, droppers, table = drawn.wires, drawn.droppers, drawn.table
    axes.plot(wires.x, wires.messenger, color=COLOURS["messenger"], linewidth=1.2, label="messenger")
    for i, stitch in enumerate(table.stitches):
        on = (wires.x >= stitch["begin"]) & (wires.x <= stitch["end"])
        label = "stitch wire" if i == 0 else None
        axes.plot(wires.x[on], wires.stitch_wire[on], color=COLOURS["stitch"], linewidth=1.2, label=label)
    axes.plot(wires.x, wires.contact_wire, color=COLOURS["contact"], linewidth=1.2, label="contact wire")
    own = _within(droppers.x, drawn)
    top = droppers.contact_wire + droppers.dropper_length
    loose = droppers.dropper_force <= 0
    for some, label in (own & ~loose, "dropper"), (own & loose, "loose dropper"):
        if some.any():
            low, colour = droppers.contact_wire[some], COLOURS["dropper"]
            lines = axes.vlines(droppers.x[some], low, top[some], colour, label=label, linewidth=0.8)
            if label.startswith("loose"):
                lines.set_linestyle("dotted")
    inner = table.supports[1:-1]
    inner = inner[_within(inner["x"], drawn)]
    axes.plot(inner["x"], inner["messenger"], "v", color=COLOURS["messenger"], markersize=6, label="support")
    for i, mass in enumerate(table.masses[_within(table.masses["x"], drawn)]):
        heights = wires.messenger if mass["wire"] == MESSENGER else wires.contact_wire
        height = np.interp(mass["x"], wires.x, heights)
        label = "point mass" if i == 0 else None
        axes.plot(mass["x"], height, "s", color=COLOURS["mass"], markersize=5, label=label)
    axes.legend(fontsize=8, loc="upper left", ncols=6, bbox_to_anchor=(0, -0.02), frameon=False)


def _within(x: np.ndarray, drawn: Drawn) -> np.ndarray:
    return (x >= drawn.between[0]) & (x <= drawn.between[1])
