"""Which spans of a run are evaluated, and where it can end for them."""

from __future__ import annotations

from ..errors import ZSpringError
from .journey import SAME_PLACE, LineExtent
from .result import LineResult
from .statistics import Section

RUN_OUT = 0.4  # s beyond the evaluated spans, for the filter


def evaluated(result: LineResult, i: int, line: LineExtent) -> Section | None:
    """The middle spans of the line, farthest from its ends, or the last two whole spans before the far end is felt.

    None where pantograph i runs through no whole span there. What the start-up takes does not count.
    """
    return middle_or_last(line, _started(result, i, line), min(result.position[-1, i], result.undisturbed_until[i]))


def middle_or_last(line: LineExtent, begin: float, end: float) -> Section | None:
    """The middle spans of the line, or else the last two whole ones, between two positions in m; None if none is."""
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


def of_start_up(result: LineResult, i: int, section: Section | None, line: LineExtent) -> list[str]:
    """A line for a section in which pantograph i still starts up."""
    if section is None or section.bounds[0] >= (end := _started(result, i, line)) - SAME_PLACE:
        return []
    return [
        f"warning: pantograph {i + 1}: what is evaluated begins at {section.bounds[0]:.4g} m, but the start-up takes "
        f"until {end:.4g} m"
    ]


def stop_behind(section: Section, line: LineExtent, speed: float, behind: float = 0.0) -> float:
    """Where a run at `speed` m/s may stop, m, with a last pantograph `behind` m behind: its filter has run out."""
    return min(section.bounds[1] + behind + RUN_OUT * speed, line.length)
