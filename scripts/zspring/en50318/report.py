"""Tables of the report, which the command prints as well."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from ..bench.compare import LevelComparison
from ..fmu import Fmu
from ..line.mean_force import mean_force
from ..line.quantities import Statistics, described
from ..line_table import LineTable
from ..page import BAD, GOOD, WORDS, Cell, Table
from ..text_tables import aligned
from ..variables import text
from .edition import Case, Judgement, sources_of
from .plan import Run
from .summary import share

SENSITIVE = (
    "mean_force",
    "standard_deviation",
    "statistical_maximum",
    "statistical_minimum",
    "actual_maximum",
    "actual_minimum",
    "support_uplift",
)


def number(name: str, value: float) -> str:
    """A value with its digits; a dash where the series does not tell it."""
    return "-" if math.isnan(value) else f"{value:.{described(name)[2]}f}"


def labelled(name: str) -> str:
    label, unit, _ = described(name)
    return f"{label}, {unit}" if unit else label


def distance(judgement: Judgement) -> Cell:
    """Inside, or by how much outside."""
    if math.isnan(judgement.value):
        return Cell("not known")
    if judgement.is_inside:
        return Cell("inside", GOOD)
    return Cell(f"outside by {judgement.outside:+.3g}", BAD)


def case_table(
    found: Statistics, judgements: Sequence[Judgement], speed: float | None, caption: str, target: float | None = None
) -> Table:
    """All values at `speed` km/h, with the accepted ranges where there are any; then deviation and mean force
    beside what papers quote as the limits of current collection, or the mean force of the case, `target` N."""
    by_name = {judgement.name: judgement for judgement in judgements}
    rows = []
    for name, value in found.items():
        row: list[str | Cell] = [labelled(name), number(name, value)]
        if judgements:
            judged = by_name.get(name)
            row += ["{:g} to {:g}".format(*judged.accepted), distance(judged)] if judged else ["", ""]
        rows.append(row)
    part = share(found)
    inside = Cell("inside", GOOD) if part.is_inside else Cell("outside", BAD)
    blank: list[str | Cell] = [""] * (2 if judgements else 0)
    judged_share: list[str | Cell] = [f"at most {part.accepted[1]:g}", inside] if judgements else []
    label = f"{part.name}, of current collection"
    rows.append([label, f"{part.value:.3f}", *judged_share])
    if target is not None:
        rows.append(["target mean force, N", number("mean_force", target), *blank])
    elif speed:
        rows.append(["target mean force of AC lines, N", number("mean_force", mean_force("AC", speed)), *blank])
    return Table(caption, ["", "found", *(["accepted", ""] if judgements else [])], rows)


def figures_table(found: Mapping[str, Statistics], caption: str) -> Table:
    """Figures of several series or runs side by side."""
    names = dict.fromkeys(name for each in found.values() for name in each)
    rows: list[list[str | Cell]] = [
        [labelled(name), *(number(name, each.get(name, math.nan)) for each in found.values())] for name in names
    ]
    return Table(caption, ["", *found], rows)


def spans_table(whole: Statistics, by_span: Mapping[str, Statistics], caption: str) -> Table:
    """The values span by span, and over all of them."""
    return figures_table({**by_span, "all": whole}, caption)


def sensitivity_table(
    reference: Statistics, choices: Mapping[str, Statistics], judged: Mapping[str, Sequence[Judgement]], caption: str
) -> Table:
    """Main values by choice; those outside their accepted ranges are marked."""
    rows: list[list[str | Cell]] = []
    for label, found in {"reference": reference, **choices}.items():
        outside = {judgement.name for judgement in judged[label] if not judgement.is_inside}
        rows.append([label, *(Cell(number(n, found[n]), BAD if n in outside else "") for n in SENSITIVE)])
    return Table(caption, ["", *map(labelled, SENSITIVE)], rows)


def agreement_table(
    simulated: Statistics, measured: Statistics, judgements: Sequence[Judgement], caption: str
) -> Table:
    """Simulation and line test side by side."""
    by_name = {judgement.name: judgement for judgement in judgements}
    rows = []
    for name in simulated:
        judged = by_name.get(name)
        limits = [f"{judged.value:+.1f} %", f"± {judged.accepted[1]:g} %", distance(judged)] if judged else [""] * 3
        rows.append([labelled(name), number(name, simulated[name]), number(name, measured[name]), *limits])
    header = ["", "simulation", "line test", "difference", "accepted", ""]
    return Table(caption, header, rows)


def places_table(both: Mapping[str, tuple[Statistics, Statistics]], names: Sequence[str], caption: str) -> Table:
    """Figures of a simulation, in brackets those of the line test, and their difference; by place. What both tell."""
    rows: list[list[str | Cell]] = []
    told = [name for name in names if any(not math.isnan(a[name] - b[name]) for a, b in both.values())]
    for place, (mine, theirs) in both.items():
        row: list[str | Cell] = [place]
        for name in told:
            change = 100 * (mine[name] / theirs[name] - 1) if theirs[name] else math.nan
            beside = f"{number(name, mine[name])} ({number(name, theirs[name])})"
            row.append(beside if math.isnan(change) else f"{beside} {round(change):+d} %")
        rows.append(row)
    return Table(caption, ["", *map(labelled, told)], rows)


def frf_table(comparisons: Sequence[LevelComparison]) -> Table:
    """Errors by amplitude and band."""
    rows = [
        [
            comparison.measured.label,
            "{:g} to {:g} Hz".format(*error.band),
            f"{error.points}",
            *(f"{100 * v:+.1f} %" for v in (error.magnitude_mean, error.magnitude_largest)),
            f"{100 * error.magnitude_rms:.1f} %",
            *(f"{v:+.1f} deg" for v in (error.phase_mean, error.phase_largest)),
            f"{error.phase_rms:.1f} deg",
        ]
        for comparison in comparisons
        for error in comparison.errors
    ]
    header = ["amplitude", "band", "points", "magnitude, mean", "largest", "rms", "phase, mean", "largest", "rms"]
    return Table("Computed against measured, by frequency band", header, rows)


def parameter_table(case: Case, run: Run, catenary: Fmu, pantograph: Fmu) -> Table:
    """Every parameter that the sets of a case give, with its source; arrays in one row."""
    rows: list[list[str | Cell]] = []
    parts = ("line", catenary, run.line), ("pantograph", pantograph, run.pantograph)
    for (title, description, remarks), (part, fmu, values) in zip(sources_of(case), parts):
        own = {name: remark for remark, names in remarks.items() for name in names}
        own.setdefault("static_force", f"of the case {case.title}")
        arrays: dict[tuple[str, str, str], list[str]] = {}
        for name, value in values.items():
            variable = fmu.variables[name]
            key = re.sub(r"\[\d+\]", "[]", name), variable.unit or "", own.get(name, "as its set says, above")
            arrays.setdefault(key, []).append(text(variable, value))
        rows.append([f"{part}: {title}", "", Cell(description, WORDS)])
        if part == "line" and run.table:
            rows.append(["resources/line.table", table_told(run.table), Cell("of the line file", WORDS)])
        rows += [
            [name, f"{', '.join(each)} {unit}".strip(), Cell(source, WORDS)]
            for (name, unit, source), each in arrays.items()
        ]
    return Table(f"Parameters of {case.title}", ["parameter", "value", "source"], rows)


def table_told(table: LineTable) -> str:
    """What a line's table holds, and by what it is known."""
    parts = {"spans": table.supports[1:], "droppers": table.droppers, "stitch wires": table.stitches}
    counted = [f"{len(each)} {name}" for name, each in {**parts, "point masses": table.masses}.items()]
    return f"{', '.join(counted)}, {table.boundaries[-1]:g} m, FNV-1a {table.digest}"


def departures(judged: Mapping[str, Mapping[str, Sequence[Judgement]]]) -> str:
    """One sentence on how many other choices put a value outside its range; `judged` by case and choice."""
    counts = [
        f"{sum(any(j.outside for j in each) for each in choices.values())} of {len(choices)} at {case}"
        for case, choices in judged.items()
    ]
    return f"Choices with which at least one value is outside its accepted range: {', '.join(counts)}"


def as_lines(table: Table) -> list[str]:
    """The table as text, under its caption."""
    rows = [list(table.header), *([cell.text for cell in row] for row in table.cells)]
    return [*([table.caption] if table.caption else []), *aligned(rows, right=True)]


def verdict(name: str, judged: Mapping[str, Sequence[Judgement]], unit: str | None = None) -> str:
    """One sentence on how many values are inside their ranges; `unit` where it is not the values' own."""
    counted = [(case, j) for case, each in judged.items() for j in each]
    known = [(case, j) for case, j in counted if not math.isnan(j.value)]
    if not known:
        return f"{name}: none of the {len(counted)} values with accepted ranges is known"
    unknown = f"; {len(counted) - len(known)} are not known" if len(known) < len(counted) else ""
    outside = [
        f"{described(j.name)[0]} at {case} by {j.outside:+.3g} {unit or described(j.name)[1]}"
        for case, j in known
        if not j.is_inside
    ]
    if not outside:
        return f"{name}: all {len(known)} values are inside their accepted ranges{unknown}"
    listed = ", ".join(outside)
    return f"{name}: {len(outside)} of {len(known)} values are outside their accepted ranges: {listed}{unknown}"
