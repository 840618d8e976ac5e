"""What `zspring couple` prints of a run."""

from __future__ import annotations

from ..line.journey import LineExtent
from ..line.result import LineResult
from ..line.statistics import FIGURES, Section, statistics
from ..text_tables import aligned

SHOWN = (
    "mean_force",
    "standard_deviation",
    "actual_maximum",
    "actual_minimum",
    "loss_of_contact",
    "support_uplift",
    "contact_point_range",
)


def evaluated(result: LineResult, i: int, line: LineExtent) -> Section | None:
    """The middle spans of the line, farthest from its ends; None where pantograph i has not run through them.

    The first span after the start does not count, as the start-up is there.
    """
    section = Section((line.spans + 1) // 2, line.spans // 2 + 1, line.span)
    low, high = section.bounds
    begin, end = result.position[0, i] + line.span, result.position[-1, i]
    return section if begin <= low and high <= end else None


def summary(result: LineResult, line: LineExtent) -> list[str]:
    """Lines with the main figures of each pantograph."""
    count = result.position.shape[1]
    sections = [evaluated(result, i, line) for i in range(count)]
    found = [statistics(result.series(i), sections[i]) for i in range(count)]
    where = dict.fromkeys(str(section or "the whole run") for section in sections)
    rows = []
    for name in SHOWN:
        label, unit, digits = FIGURES[name]
        rows.append([label, *(f"{figures[name]:.{digits}f}" for figures in found), unit])
    return [f"0-20 Hz, over {' and '.join(where)}", *aligned(rows, right=True)]
