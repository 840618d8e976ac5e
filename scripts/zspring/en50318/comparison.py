"""The linear and the Z-spring head on one line: what differs, how far that spreads, and what it supports.

Heads are compared by the runs of one start each, so that start-up and place in the span are the same; the spread is
that of these differences over all starts, and over the single spans of all starts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..fmu import Fmu
from ..line.limits import near_wave_speed
from ..line.result import read_result
from ..line.statistics import FIGURES
from ..page import Cell, Chapter, Picture, Table
from . import plot, report, summary
from .files import BY_SPAN
from .plan import HEAD_LINE, HEADS, STARTS, Run
from .workers import Finished

RELATIVE = ("standard_deviation", "standard_deviation_5_20")  # compared in percent of the linear head's
ByHead = dict[str, dict[float, list[Finished]]]  # runs by start, by head and speed in km/h


def by_head(runs: Sequence[Run], done: Mapping[str, Finished]) -> ByHead:
    """What the runs came to."""
    found: ByHead = {}
    for run in runs:
        found.setdefault(run.label, {}).setdefault(run.speed, []).append(done[run.key])
    return found


def whole(made: Sequence[Finished], name: str) -> np.ndarray:
    """A value over the section, by start. (s,)"""
    return np.array([finished.statistics[name] for finished in made])


def differences(made: Sequence[Finished], linear: Sequence[Finished], name: str) -> tuple[np.ndarray, np.ndarray]:
    """From the linear head, start by start (s,), and of each span of each start (s, spans).

    Standard deviations in % of the linear head's, others in their own units.
    """
    count = min(len(made), len(linear))
    pairs = [(whole(each[:count], name), _spans(each[:count], name)) for each in (made, linear)]
    (a, a_spans), (b, b_spans) = pairs
    if name in RELATIVE:
        return 100 * (a / b - 1), 100 * (a_spans / b_spans - 1)
    return a - b, a_spans - b_spans


def difference_table(found: ByHead, head: str, linear: str) -> Table:
    """Differences of a head from the linear one, by value and speed: mean, then the spread."""
    speeds = list(found[head])
    rows: list[list[str | Cell]] = []
    for name in BY_SPAN:
        each = [differences(found[head][speed], found[linear][speed], name) for speed in speeds]
        label = f"{FIGURES[name][0]}, {'%' if name in RELATIVE else FIGURES[name][1].replace('%', '% of time')}"
        digits = 2 if name == "loss_of_contact" else 1
        rows.append([label, *(f"{starts.mean():+.{digits}f}" if np.any(spans) else "0" for starts, spans in each)])
        rows.append(["    from start to start", *(_range(starts, digits) for starts, _ in each)])
        rows.append(["    single spans", *(_range(spans, digits) for _, spans in each)])
    caption = f"{head} against {linear}: mean difference, and its lowest and highest"
    return Table(caption, ["", *(f"{speed:g} km/h" for speed in speeds)], rows)


def level_table(found: ByHead, name: str) -> Table:
    """A value by head and speed: mean of all starts, and the range where there are several."""
    digits, rows = FIGURES[name][2], []
    for head, by_speed in found.items():
        each = [whole(made, name) for made in by_speed.values()]
        ranges = [_range(v, digits, "") if v.size > 1 else "" for v in each]
        cells = [f"{v.mean():.{digits}f}" + (f" ({shown})" if shown else "") for v, shown in zip(each, ranges)]
        rows.append([head, *cells])
    speeds = next(iter(found.values()))
    return Table(report.labelled(name), ["", *(f"{speed:g} km/h" for speed in speeds)], rows)


def supported(found: ByHead, head: str, linear: str) -> list[str]:
    """Lines on what holds from every start, and over every single span, by figure."""
    lines = []
    for name in BY_SPAN:
        said: dict[str, list[str]] = {}
        for speed in found[head]:
            starts, spans = differences(found[head][speed], found[linear][speed], name)
            said.setdefault(_word(starts, spans), []).append(f"{speed:g}")
        told = "; ".join(f"{word} at {', '.join(speeds)} km/h" for word, speeds in said.items())
        lines.append(f"{FIGURES[name][0]} of the {head} against {linear}: {told}")
    return lines


def chapter(runs: Sequence[Run], found: ByHead, catenary: Fmu, folder: Path) -> Chapter:
    """The heads on the same line."""
    kept = [run for run in runs if run.series]
    shown = {run.label: read_result(folder / run.series) for run in kept}
    title = f"DSA-380 on the line {HEAD_LINE}; Z-spring parameters synthetic"
    linear, head, free, coulomb, locked = (head.label for head in HEADS)
    sections = dict.fromkeys((f"{run.section.first} to {run.section.last}", f"{run.speed:g}") for run in runs)
    spans = ", ".join(f"{spans} at {speed}" for spans, speed in sections)
    text = (
        "The same pantograph with the linear head suspension of the published three-mass model and with the Z-spring, "
        f"on the same line, from {STARTS} places of the first span, over the last spans before the far end is felt "
        f"(spans {spans} km/h). Static force and uplift are together the mean force of the law for AC lines at each "
        "speed. Only the head suspension differs. The Z-spring's parameters are synthetic: with stuck rods it is as "
        "stiff as the linear one, with free rods half as stiff. So this shows what such a head can change, not what "
        "that of a real DSA-380 does."
    )
    alike = (
        f"From the first start alone: {coulomb}, which differs from regularized friction by at most "
        f"{_most(found, coulomb, head):.2g} N in the standard deviation of 0 to 20 Hz, and {locked}, which differs "
        f"from {linear} by at most {_most(found, locked, linear):.2g} N."
    )
    return Chapter(
        "Linear and Z-spring head",
        [
            text,
            "What the runs support, from every start or not:",
            *(f"{line}." for each in (head, free) for line in supported(found, each, linear)),
            *(f"{line}." for line in near_wave_speed(catenary, runs[0].line, max(run.speed for run in runs) / 3.6)),
            Picture(plot.heads_figure(_figures(found), title), "Contact quality by speed, mean and range", "heads.png"),
            difference_table(found, head, linear),
            difference_table(found, free, linear),
            alike,
            *(level_table(found, name) for name in (*BY_SPAN, "mean_force", "support_uplift")),
            Picture(
                plot.heads_force_figure(shown, kept[0].section, f"{title}, {kept[0].speed:g} km/h"),
                f"Contact force and friction moments at {kept[0].speed:g} km/h, start at 0 m",
                "heads-force.png",
            ),
        ],
    )


def printed(found: ByHead) -> list[str]:
    """What the command prints."""
    linear, head = (head.label for head in HEADS[:2])
    return ["", *report.as_lines(difference_table(found, head, linear)), "", *supported(found, head, linear)]


def summary_row(runs: Sequence[Run]) -> summary.Row:
    """The row of the box on top."""
    speeds = [run.speed for run in runs]
    between = f"{min(speeds):g} to {max(speeds):g} km/h"
    place = f"{STARTS} starts, spans by speed"
    return ["heads compared", "DSA-380, linear and Z-spring", HEAD_LINE, between, place, Cell("nothing is judged"), ""]


def _spans(made: Sequence[Finished], name: str) -> np.ndarray:
    return np.array([[span[name] for span in finished.by_span] for finished in made])


def _range(values: np.ndarray, digits: int, sign: str = "+") -> str:
    if not np.any(values):
        return ""
    return f"{values.min():{sign}.{digits}f} .. {values.max():{sign}.{digits}f}"


def _word(starts: np.ndarray, spans: np.ndarray) -> str:
    if not np.any(spans):
        return "equal"
    for sign, word in (1, "higher"), (-1, "lower"):
        if np.all(sign * starts >= 0):
            word += "" if np.all(starts) else " or equal"
            return f"{word} from every start" + (" and over every span" if np.all(sign * spans > 0) else "")
    return "of either sign"


def _most(found: ByHead, head: str, other: str) -> float:
    """Largest difference of the standard deviations of two heads' first runs, N."""
    first = [(found[head][v][0].statistics, found[other][v][0].statistics) for v in found[head]]
    return max(abs(a["standard_deviation"] - b["standard_deviation"]) for a, b in first)


def _figures(found: ByHead) -> dict[str, dict[float, dict[str, np.ndarray]]]:
    return {
        head: {speed: {name: whole(made, name) for name in BY_SPAN} for speed, made in by_speed.items()}
        for head, by_speed in found.items()
        if len(next(iter(by_speed.values()))) > 1
    }
