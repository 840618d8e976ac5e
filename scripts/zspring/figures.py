"""What all figures share."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text


def save(figure: Figure, path: Path) -> None:
    """Write the figure in the format that the file's suffix names; names in its texts may have any characters."""
    for text in figure.findobj(Text):
        if "$" in text.get_text() and "mathdefault" not in text.get_text():  # as matplotlib's own numbers have
            text.set_parse_math(False)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font", UserWarning)
        figure.savefig(path, dpi=150)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of that size in inches, independent of any display."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def legend_beside(axes: Axes) -> None:
    """The legend right of the axes, where it hides nothing."""
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1, 0.5))


def rising_colors(count: int) -> np.ndarray:
    """A colour for each level of the amplitude, ascending (count, 4)."""
    return matplotlib.colormaps["plasma"](np.linspace(0, 0.88, count))


def level_label(label: str) -> str:
    """A level with its unit as legends have it."""
    return label.replace("m/s2", "m/s²")


def over_frequency(panels: Sequence[Axes], frequencies: np.ndarray) -> None:
    """The common axis of panels one below the other, of these frequencies in Hz, and their grids."""
    panels[-1].set_xlabel("frequency  [Hz]")
    if np.ptp(frequencies) > 0:
        panels[-1].set_xlim(frequencies.min(), frequencies.max())
    for axes in panels:
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
