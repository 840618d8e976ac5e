"""What `zspring couple` prints of a run."""

from __future__ import annotations

from collections.abc import Sequence

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


def summary(result: LineResult, chosen: Sequence[Section | None]) -> list[str]:
    """Lines with the main values of each pantograph over its section. Raises ZSpringError where there are none."""
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
