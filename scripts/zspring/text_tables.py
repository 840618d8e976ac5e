"""Tables on the terminal."""

from __future__ import annotations

import math
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


def with_error(value: float, error: float, most: int) -> str:
    """The value with the digits that its error leaves, and in brackets the error of the last one, rounded up.

    most    digits after the point, at most; the value of an error of 0, an exact one, has them all, without brackets
    """
    if not error > 0:
        return f"{value:.{most}f}"
    digits = min(-math.floor(math.log10(error)), most)
    last = math.ceil(error * 10**digits * (1 - 1e-12))
    if last > 9:
        digits, last = digits - 1, 1
    if digits < 0:
        return f"{round(value, digits):.0f}({last * 10**-digits})"
    return f"{value:.{digits}f}({last})"
