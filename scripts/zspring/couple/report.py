"""What `zspring couple` prints of a run."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import ZSpringError
from ..line.journey import LineExtent
from ..line.limits import FAR_END
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
    """The middle spans of the line, farthest from its ends, or the last two whole spans before the far end is felt.

    None where pantograph i runs through no whole span there. What the start-up takes does not count.
    """
    begin, end = _started(result, i, line), min(result.position[-1, i], result.undisturbed_until[i])
    middle = line.section((line.spans + 1) // 2, line.spans // 2 + 1)
    low, high = middle.bounds
    if begin <= low and high <= end:
        return middle
    first, last = line.whole_spans(begin, end)
    return line.section(max(first, last - 1), last) if first <= last else None


def _started(result: LineResult, i: int, line: LineExtent) -> float:
    """Where pantograph i has started up, m."""
    return float(result.position[0, i]) + line.run_up(float(result.position[0, 0]))


def sections(result: LineResult, line: LineExtent, spans: tuple[int, int] | None) -> list[Section | None]:
    """What is evaluated of each pantograph: the spans asked for, else those of `evaluated`; None: the whole run.

    Raises ZSpringError where that would be nothing but start-up and what the far end reflects.
    """
    if spans:
        return [line.section(*spans)] * result.position.shape[1]
    found = [evaluated(result, i, line) for i in range(result.position.shape[1])]
    for i, until in enumerate(result.undisturbed_until):
        if found[i] is None and result.position[-1, i] > until:
            raise ZSpringError(
                f"no whole span between {_started(result, i, line):.4g} m, a span after the start, and "
                f"{until:.4g} m, where the far end begins to tell: take a longer line (line.spans), or choose --spans"
            )
    return found


def summary(result: LineResult, chosen: Sequence[Section | None]) -> list[str]:
    """Lines with the main figures of each pantograph over its section. Raises ZSpringError where there are none."""
    found = [statistics(result.series(i), section) for i, section in enumerate(chosen)]
    where = dict.fromkeys(str(section or "the whole run") for section in chosen)
    rows = []
    for name in SHOWN:
        label, unit, digits = FIGURES[name]
        rows.append([label, *(f"{figures[name]:.{digits}f}" for figures in found), unit])
    return [f"0-20 Hz, over {' and '.join(where)}", *aligned(rows, right=True), *_far_end(result)]


def _far_end(result: LineResult) -> list[str]:
    """A line on where the far end begins to tell, if a run goes there."""
    reached = [until for until, end in zip(result.undisturbed_until, result.position[-1]) if end > until]
    if not reached:
        return []
    where = dict.fromkeys(f"{until:.0f} m" for until in reached)
    return [f"from {' and '.join(where)} on {FAR_END}"]
