"""What `zspring line draw` does: the line at rest and its elasticity, as figures and tables."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..heads import content_of, file_head
from ..records import keep_others
from ..tables import write_table
from .design import Line
from .plot import Drawn, line_drawing
from .report import DROPPERS, dropper_rows
from .statics import at_rest, elasticity

PER_SPAN = 24  # places of each span at which the elasticity is taken, besides droppers; four times as many of the wires


def draw_and_write(line: Line, catenary: Fmu, spans: tuple[int, int] | None, force: float, folder: Path) -> None:
    """Write line.svg, line.png, dropper-forces.csv and elasticity.csv, and print what they come to.

    spans   first and last to draw, from 1; None: all
    force   N, of the elasticity
    Raises ZSpringError where the line has not these spans, or another line's tables are there.
    """
    table, parameters = line.table, line.parameters
    count = len(table.supports) - 1
    first, last = spans or (1, count)
    if last > count:
        raise ZSpringError(f"--spans {first}:{last}: must be in 1 .. {count}")
    tables = folder / "dropper-forces.csv", folder / "elasticity.csv"
    head = file_head(
        catenary,
        catenary.used_parameters(parameters),
        {"line": line.file.name, **content_of([line.path]), "spans": f"{first}:{last}", "force": f"{force:g} N"},
    )
    for path in tables:
        keep_others(path, head)
    edges = table.boundaries[first - 1 : last + 1]
    marks = [edges, table.droppers["x"], table.stitches["begin"], table.stitches["end"], table.masses["x"]]
    places, close = (_places(edges, np.concatenate(marks), per_span) for per_span in (PER_SPAN, 4 * PER_SPAN))
    found = elasticity(catenary, parameters, tqdm(places, unit=" places", disable=None), force)
    droppers = at_rest(catenary, parameters, table.droppers["x"])
    drawn = Drawn(
        name=line.title,
        table=table,
        between=(float(edges[0]), float(edges[-1])),
        wires=at_rest(catenary, parameters, close),
        droppers=droppers,
        places=places,
        elasticity=found,
        force=force,
    )
    write_table(tables[0], head, DROPPERS, dropper_rows(line, droppers), digits=6)
    write_table(tables[1], head, ["position [m]", "elasticity [mm/N]"], zip(places, 1e3 * found), digits=6)
    figures = folder / "line.svg", folder / "line.png"
    for path in figures:
        save(line_drawing(drawn), path)
    inner = (
        (places >= table.boundaries[1]) & (places <= table.boundaries[-2]) if count > 2 else np.full(len(places), True)
    )
    if inner.any():
        low, high = 1e3 * found[inner].min(), 1e3 * found[inner].max()
        print(
            f"elasticity under {force:g} N{', without the spans at the ends' if count > 2 else ''}: {low:.3f} to "
            f"{high:.3f} mm/N, (max - min) / (max + min) {100 * (high - low) / (high + low):.0f} %"
        )
    print("written:", *figures, *tables)


def _places(edges: np.ndarray, marks: np.ndarray, per_span: int) -> np.ndarray:
    """That many even places in each span between the edges, and those of the marks there are, m."""
    even = [np.linspace(begin, end, per_span, endpoint=False) for begin, end in pairwise(edges)]
    return np.unique(np.concatenate([*even, marks[(marks >= edges[0]) & (marks <= edges[-1])]]))
