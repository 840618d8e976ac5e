"""The box on top of a report: what was run, which criteria are judged, and how each of them ended."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..line.statistics import Section, Statistics
from ..page import BAD, GOOD, WORDS, Cell, Chapter, Table
from .edition import DEVIATION_SHARE, Judgement

TITLE = "Summary"
CRITERIA = (
    "Two criteria are judged, each for itself. The accepted ranges of an edition hold for its own line and "
    "pantograph: whether values are inside tells how a simulation agrees with others on a known case. The limit of "
    f"standard deviation / mean force, {DEVIATION_SHARE:g} as papers quote it, is one of current collection: it tells "
    "how well a pantograph runs under a line, and nothing of the simulation. Nothing else is judged."
)
HEADER = ["", "pantograph", "line", "speed", "evaluated", "accepted ranges", f"deviation / mean, {DEVIATION_SHARE:g}"]

Row = list[str | Cell]


def share(found: Statistics) -> Judgement:
    """Standard deviation over mean force, beside its limit; infinite where nothing presses."""
    mean = found["mean_force"]
    value = found["standard_deviation"] / mean if mean > 0 else math.inf
    return Judgement("standard deviation / mean force", value, (0.0, DEVIATION_SHARE))


def shares(name: str, found: Mapping[str, Statistics]) -> str:
    """One sentence on the limit of current collection, by case."""
    ended = [f"{share(each).value:.3f}, {_word(share(each))}, at {case}" for case, each in found.items()]
    return f"{name}: standard deviation / mean force, at most {DEVIATION_SHARE:g}: {'; '.join(ended)}"


def ended(judged: Sequence[Judgement]) -> Cell:
    """How many values are inside their ranges."""
    if not judged:
        return Cell("none known")
    inside, unknown = sum(j.is_inside for j in judged), sum(math.isnan(j.value) for j in judged)
    text = f"{inside} of {len(judged)} inside" + (f", {unknown} not known" if unknown else "")
    return Cell(text, GOOD if inside == len(judged) else BAD)


def row(
    what: str,
    pantograph: str,
    line: str,
    speed: float | None,
    section: Section | None,
    judged: Sequence[Judgement] | None,
    found: Statistics,
) -> Row:
    """A run or series at `speed` km/h; judged: by accepted ranges, None where those are not for this pantograph."""
    ranges = Cell("not for this pantograph") if judged is None else ended(judged)
    part = share(found)
    own = Cell(f"{part.value:.3f}, {_word(part)}", GOOD if part.is_inside else BAD)
    place = str(section or "the whole series")
    return [what, pantograph, line, f"{speed:.4g} km/h" if speed else "not known", place, ranges, own]


def chapter(rows: Sequence[Row]) -> Chapter:
    """The box."""
    words = [
        [cells[0], *(cell if isinstance(cell, Cell) else Cell(cell, WORDS) for cell in cells[1:])] for cells in rows
    ]
    return Chapter(TITLE, [Table("What was run, and how it ended", HEADER, words), CRITERIA])


def _word(judgement: Judgement) -> str:
    return "inside" if judgement.is_inside else "outside"
