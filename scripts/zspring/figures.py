"""What all figures share."""

from __future__ import annotations

import warnings
from pathlib import Path

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
