"""What differs between the compared on the same lines: paired differences with their intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..line.quantities import described
from ..tables import write_table
from ..text_tables import aligned
from ..variables import Value, text
from .coupled import COUPLE, CoupledQuantity
from .design import Case
from .factors import LINE_NUMBER
from .files import Rows, column_of
from .settings import COMPARED, StudySettings

SHARE = 0.95  # of the intervals
NO_INTERVALS = "no intervals: cases are not drawn by chance"
COUNT = f"{COUPLE}pantographs"
SPEED = f"{COUPLE}speed"
Condition = tuple[Value, ...]  # values of `conditions`


@dataclass(frozen=True)
class Runner:
    """One of the pantographs of a case: i, counted from 0, of so many."""

    i: int
    of: int

    def __str__(self) -> str:
        return "one pantograph" if self.of == 1 else f"{('leading', 'trailing')[self.i]} of two"


@dataclass(frozen=True)
class Difference:
    """What a value's mean is more by the first of the compared than by another one, over lines that both ran along.

    condition   values of `conditions`
    name        of the other one
    first       mean of the first one
    half_width  of the interval of the mean difference, by Student's t; NaN of one line, and of cases that are not drawn
    lines       or cases, where lines are not irregular
    """

    condition: Condition
    runner: Runner
    figure: str
    name: str
    first: float
    mean: float
    half_width: float
    lines: int

    @property
    def is_clear(self) -> bool:
        """Whether the interval is on one side of 0."""
        return abs(self.mean) > self.half_width


def conditions(settings: StudySettings) -> list[str]:
    """Names whose values are told apart: all of a grid on irregular lines, else speed and number of pantographs."""
    varied = [name for name, values in settings.vary.items() if isinstance(values, tuple) and len(values) > 1]
    return [name for name in varied if settings.lines or name in (SPEED, COUNT)] if settings.design == "grid" else []


def runners(cases: Sequence[Case], settings: StudySettings) -> list[Runner]:
    """All pantographs that there are in any case."""
    counts = {int(settings.parameters_of(case).get(COUNT, 1)) for case in cases}
    return [Runner(i, count) for count in sorted(counts) for i in range(count)]


def differences(
    settings: StudySettings, quantity: CoupledQuantity, cases: Sequence[Case], rows: Rows
) -> list[Difference]:
    """Of all values, by condition, pantograph and name. Cases count that have values by both.

    Lines count once: what else varies is averaged over along each.
    """
    names, found = list(settings.compared), []
    told = conditions(settings)
    for runner in runners(cases, settings):
        for figure in quantity.figures:
            values = [_value(rows, number, quantity.column(figure, runner.i)) for number in range(len(cases))]
            for k, name in enumerate(names[1:], 1):
                by_condition: dict[Condition, dict[Value, list[tuple[float, float]]]] = {}
                for first in range(0, len(cases), len(names)):
                    case = cases[first]
                    pair = values[first], values[first + k]
                    if int(settings.parameters_of(case).get(COUNT, 1)) == runner.of and np.isfinite(pair).all():
                        condition = tuple(case[key] for key in told)
                        line = case[LINE_NUMBER] if settings.lines else first
                        by_condition.setdefault(condition, {}).setdefault(line, []).append(pair)
                for condition, by_line in by_condition.items():
                    means = np.array([np.mean(pairs, axis=0) for pairs in by_line.values()])
                    mean, difference, half_width, count = _interval(means)
                    half_width = half_width if has_intervals(settings) else float("nan")
                    found.append(Difference(condition, runner, figure, name, mean, difference, half_width, count))
    return found


def has_intervals(settings: StudySettings) -> bool:
    """Whether what is averaged is drawn independently, as lines are; cases of a grid, list or Sobol block are not."""
    return settings.lines > 0 or settings.design == "latin-hypercube"


def _value(rows: Rows, number: int, column: str) -> float:
    return float(rows[number][column] or "nan") if number in rows else float("nan")


def _interval(pairs: np.ndarray) -> tuple[float, float, float, int]:
    """Mean of the first, mean difference and half the width of its interval, of pairs (lines, 2); their number."""
    from scipy.stats import t  # slow to load

    by = pairs[:, 0] - pairs[:, 1]
    count = len(by)
    error = by.std(ddof=1) / count**0.5 if count > 1 else float("nan")
    return float(pairs[:, 0].mean()), float(by.mean()), float(t.ppf((1 + SHARE) / 2, max(1, count - 1)) * error), count


def write_differences(
    path: Path, head: Mapping[str, str], settings: StudySettings, found: Sequence[Difference]
) -> None:
    """One row for each condition, pantograph, value and name."""
    variables, told = settings.variables, conditions(settings)
    rows = [
        [
            *(text(variables[name], value) for name, value in zip(told, each.condition)),
            str(each.runner),
            each.figure,
            described(each.figure)[1] or "1",
            each.name,
            each.first,
            each.mean,
            each.half_width,
            each.lines,
        ]
        for each in found
    ]
    columns = [*(column_of(variables[name]) for name in told), "pantograph", "value", "unit", COMPARED]
    columns += ["mean of the first", "difference", "half width", "lines"]
    head = {**head, "first": next(iter(settings.compared)), "half width": f"of the {100 * SHARE:g} % interval"}
    write_table(path, head, columns, rows, digits=6)


def difference_table(settings: StudySettings, found: Sequence[Difference]) -> list[str]:
    """Lines with the differences of the first value, a column for each condition; * where the interval excludes 0."""
    figure, first = found[0].figure, next(iter(settings.compared))
    shown = [each for each in found if each.figure == figure]
    label, unit, _ = described(figure)
    told = conditions(settings)
    columns = list(dict.fromkeys(_without_count(told, each.condition) for each in shown))
    by = f"± half of the {100 * SHARE:g} % interval" if has_intervals(settings) else NO_INTERVALS
    lines = [f"{label}, {unit or 1}: what {first} has more than the others, {by}"]
    table = [["", *(", ".join(condition_texts(settings, told, condition)) or "all cases" for condition in columns)]]
    last = None
    for runner, name in dict.fromkeys((each.runner, each.name) for each in shown):
        own = {_without_count(told, d.condition): d for d in shown if (d.runner, d.name) == (runner, name)}
        if runner != last:
            table.append([f"{first}, {runner}", *(f"{own[c].first:.1f}" if c in own else "" for c in columns)])
        table.append([f"more than {name}", *(_cell(own[c]) if c in own else "" for c in columns)])
        last = runner
    lines += aligned(table, right=True)
    clear, intervals = sum(each.is_clear for each in found), sum(each.half_width > 0 for each in found)
    if intervals:
        lines.append(
            f"*: on one side of 0, as {clear} of {intervals} intervals of all values are; without any difference "
            f"about {(1 - SHARE) * intervals:.0f} would be"
        )
    return lines


def _cell(each: Difference) -> str:
    if not np.isfinite(each.half_width):
        return f"{each.mean:+.2g}"
    digits = max(0, 1 - int(np.floor(np.log10(each.half_width)))) if each.half_width > 0 else 1
    return f"{each.mean:+.{digits}f} ± {each.half_width:.{digits}f}{'*' if each.is_clear else ' '}"


def _without_count(told: Sequence[str], condition: Condition) -> Condition:
    """A condition but for the number of pantographs, which a Runner tells."""
    return tuple(value for name, value in zip(told, condition) if name != COUNT)


def condition_texts(settings: StudySettings, told: Sequence[str], condition: Condition) -> list[str]:
    """What a condition has, but for the number of pantographs."""
    names = [name for name in told if name != COUNT]
    units = (settings.variables[name].unit or "" for name in names)
    values = (text(settings.variables[name], value) for name, value in zip(names, condition))
    return [
        f"{value} {unit}" if name == SPEED else f"{name}={value}" for name, unit, value in zip(names, units, values)
    ]
