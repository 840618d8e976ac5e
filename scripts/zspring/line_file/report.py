"""What `zspring line check` tells of a line, and the tables that `draw` writes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ..line_table import ON_STITCH
from ..text_tables import aligned
from .design import Line
from .statics import AtRest

DROPPERS = "span", "dropper", "position [m]", "length [m]", "force [N]", "hangs on"


def summary(line: Line, droppers: AtRest) -> list[str]:
    """Lines: what was read, like spans in one row, with the droppers at rest; masses.

    droppers    the line at its droppers
    """
    table, file = line.table, line.file
    count = len(table.supports) - 1
    parts = [f"{count} spans", f"{table.boundaries[-1]:g} m"]
    for name, found in (("dropper", droppers.x), ("stitch wire", table.stitches), ("point mass", table.masses)):
        parts += [_counted(len(found), name)] if len(found) else []
    rows: dict[tuple[str, ...], list[int]] = {}
    for span in range(1, count + 1):
        rows.setdefault(_span_row(line, droppers, span), []).append(span)
    head = ["spans", "length", "droppers", "on stitch wires", "their lengths", "forces at rest", "loose"]
    return [
        f"{file.name}: {', '.join(parts)}",
        *([file.description] if file.description else []),
        *(["synthetic: its numbers are those of no line there is"] if file.synthetic else []),
        *aligned([head, *([_numbers(spans), *row] for row, spans in rows.items())]),
        f"kg: {', '.join(f'{name} {_four(mass)}' for name, mass in _masses(line, droppers) if mass > 0)}",
    ]


def dropper_rows(line: Line, droppers: AtRest) -> Iterator[Sequence[object]]:
    """Rows of DROPPERS."""
    for span in range(1, len(line.table.supports)):
        for number, i in enumerate(range(*line.first_droppers[span - 1 : span + 1]), 1):
            on = "stitch wire" if line.table.droppers["upper"][i] == ON_STITCH else "messenger"
            yield span, number, droppers.x[i], droppers.dropper_length[i], droppers.dropper_force[i], on


def _span_row(line: Line, droppers: AtRest, span: int) -> tuple[str, ...]:
    own = slice(*line.first_droppers[span - 1 : span + 1])
    length = line.table.boundaries[span] - line.table.boundaries[span - 1]
    force = droppers.dropper_force[own]
    on_stitch = int(np.sum(line.table.droppers["upper"][own] == ON_STITCH))
    cells = f"{length:g} m", str(len(force)), str(on_stitch or "")
    if not len(force):
        return *cells, "", "", ""
    loose = int(np.sum(force <= 0))
    return *cells, _range(droppers.dropper_length[own], 2, "m"), _range(force, 0, "N"), str(loose or "")


def _range(values: np.ndarray, digits: int, unit: str) -> str:
    low, high = (f"{value:.{digits}f}" for value in (values.min(), values.max()))
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _four(value: float) -> str:
    """With four digits, and as many before the point as there are."""
    return f"{value:.0f}" if value >= 1000 else f"{value:.4g}"


def _counted(count: int, name: str) -> str:
    return f"{count} {name if count == 1 else 'point masses' if name == 'point mass' else name + 's'}"


def _numbers(numbers: Iterable[int]) -> str:
    """ "1 to 3, 8" of ascending whole numbers."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    texts = (f"{r[0]}" if len(r) == 1 else f"{r[0]} to {r[-1]}" if len(r) > 2 else f"{r[0]}, {r[1]}" for r in runs)
    return ", ".join(texts)


def _masses(line: Line, droppers: AtRest) -> Iterator[tuple[str, float]]:
    table, length = line.table, line.table.boundaries[-1]
    yield "contact wire", float(line.parameters["contact_wire.mass"] * length)
    yield "messenger", float(line.parameters["messenger.mass"] * length)
    stitches, own = table.stitches, table.droppers
    yield "stitch wires", float(np.sum((stitches["end"] - stitches["begin"]) * stitches["mass"]))
    yield "droppers", float(np.sum(own["mass"] * droppers.dropper_length))
    yield "clamps", float(np.sum(own["clamp_contact"] + own["clamp_upper"]) + 2 * np.sum(stitches["clamp"]))
    yield "steady arms", float(np.sum(table.supports["arm_mass"]))
    yield "point masses", float(np.sum(table.masses["mass"]))
