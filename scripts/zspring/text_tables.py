"""Tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence


def aligned(rows: Sequence[Sequence[str]], right: bool = False) -> list[str]:
    """Rows, of the same length or shorter, as lines with their cells below each other.

    right   all columns but the first are set to the right, as numbers are
    """
    width = max(map(len, rows))
    full = [[*row, *[""] * (width - len(row))] for row in rows]
    widths = [max(map(len, column)) for column in zip(*full)]
    set_cell = [str.ljust, *[str.rjust if right else str.ljust] * (width - 1)]
    return ["  ".join(put(cell, w) for put, cell, w in zip(set_cell, row, widths)).rstrip() for row in full]
