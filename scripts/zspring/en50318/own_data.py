"""Reports on a user's own data: a contact force, a simulation beside a line test, a measured FRF."""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..bench.compare import compare_frf, write_comparison
from ..bench.conditions import FILE_ORDER, STATED
from ..bench.curves import Source
from ..errors import ZSpringError, tell
from ..fmu import Fmu
from ..heads import synthetic_note
from ..interrupt import Interrupted, stop_on_interrupt
from ..line.limits import of_series
from ..line.series import Series, read_series, require_pressing
from ..line.stated import SAME_SPEED, agreed
from ..line.statistics import Section, Statistics, statistics
from ..page import Cell, Chapter, Picture, Table, keep_other_reports
from ..parameter_sets import LINES, chosen_set
from ..variables import Value, with_unit
from . import about, plot, report, summary
from .edition import Case, Edition, Judgement, agreement, judge
from .plan import section_of, slug
from .run import REPORT, finish


@dataclass(frozen=True)
class OwnData:
    """A user's contact forces, and what to make of them."""

    series: Path | None  # of a simulation, or of whatever is to be evaluated
    line_test: Path | None
    edition: Edition
    case_title: str | None  # of the case whose spans and ranges are meant
    speed: float | None  # m/s
    spans: tuple[int, int] | None
    span: float | None  # m
    first_support: float | None  # m, where span 1 begins
    pantograph: int
    turned: Sequence[str] = ()  # of "series" and "line-test", those whose forces have the other sign

    def told(self) -> dict[str, str]:
        """What was chosen, in words."""
        return {name: str(value) for name, value in vars(self).items() if name != "edition"} | {
            "edition": self.edition.name
        }

    def read(self) -> dict[str, Series]:
        """The series by the title of their chapters. Raises ZSpringError as read_series does."""
        first = "Simulation" if self.line_test else "Contact force"
        files = (first, self.series, "series"), ("Line test", self.line_test, "line-test")
        return {
            title: read_series(path, self.speed, self.pantograph, name in self.turned)
            for title, path, name in files
            if path
        }

    def section(self, case: Case | None, catenary: Fmu, series: Collection[Series]) -> Section | None:
        """The spans to evaluate: those asked for, else those of the case; None: the whole series.

        Raises ZSpringError where options, the case and the heads of the files do not agree on speed or line, and
        where nobody says how long a span is.
        """
        heads = {one.name: one.stated for one in series}
        speeds = {one.name: one.speed for one in series}
        lengths = {"--span": self.span, **{name: head.span for name, head in heads.items()}}
        of_case = None
        if case:
            of_case = section_of(case, catenary, chosen_set(case.line, catenary, LINES))
            speeds[f"the case {case.title}"] = case.speed
            lengths[f"the case {case.title}"] = of_case.span
        agreed("speed", "km/h", speeds, SAME_SPEED)
        span = agreed("span", "m", lengths)
        begins = {"--first-support": self.first_support, **{n: head.first_support for n, head in heads.items()}}
        begin = agreed("first support", "m", begins) or 0.0
        if not self.spans:
            return of_case.moved(begin) if of_case else None
        if span is None:
            raise ZSpringError("--spans: needs the length of a span, --span L; no file says it in its head")
        for name, head in heads.items():
            if head.spans and self.spans[1] > head.spans:
                raise ZSpringError(f"spans {self.spans[0]} to {self.spans[1]}: {name} says that there are {head.spans}")
        return Section.alike(*self.spans, span, begin)


def report_on(
    data: OwnData,
    source: Source | None,
    parameters: Mapping[str, Value],
    edges: Sequence[float],
    direction: str | None,
    pantograph: Fmu,
    catenary: Fmu,
    folder: Path,
    jobs: int,
) -> None:
    """Evaluate the contact forces, compare the FRF of `source`, write the report and print its report.

    parameters, edges, direction    of the FRF, see compare_frf
    """
    told = {"report": "on own data", **data.told()}
    if source:
        frf = {**vars(source), "bands": edges, "direction": direction, **parameters}
        told |= {f"FRF, {name}": str(value) for name, value in frf.items()}
    keep_other_reports(folder / REPORT, told)
    case = data.edition.case(data.case_title) if data.case_title else None
    given = data.read()
    section = data.section(case, catenary, given.values())
    made, files, lines, found, settings, box = [], [], [], {}, {}, []
    for title, series in given.items():
        found[title] = statistics(series, section)
        require_pressing(f"{series.name}, {section}" if section else series.name, found[title]["mean_force"])
        made.append(series_chapter(series, section, case, title))
        judged = judge(found[title], case.ranges) if case else []
        box.append(summary.row(f"{title}: {series.name}", "", "", series.speed, section, judged, found[title]))
        tell(of_series(series, section), folder)
        settings[title] = series.name
    if found:
        lines += report.as_lines(report.figures_table(found, str(section or "the whole series")))
    if len(found) == 2:
        made.append(agreement_chapter(found["Simulation"], found["Line test"], data.edition))
        judged = compared(found["Simulation"], found["Line test"], data.edition)
        box.append(["Simulation against line test", *[""] * 4, summary.ended(judged), ""])
    if source:
        folder.mkdir(parents=True, exist_ok=True)
        chapter, written = frf_chapter(pantograph, source, parameters, edges, direction, folder, jobs)
        made.append(chapter)
        files += written
        box.append([f"FRF: {source.path}", *[""] * 4, Cell("nothing is judged"), ""])
        settings["measured FRF"] = str(source.path)
        lines += [line for b in chapter.blocks if isinstance(b, Table) for line in report.as_lines(b)]
    lines += [b for chapter in made for b in chapter.blocks if isinstance(b, str) and "accepted ranges" in b]
    chosen = [summary.chapter(box), about.own_data(), *made]
    written = finish(folder, chosen, (pantograph,), settings, files, told)
    print(*lines, " ".join(["written:", *map(str, written)]), sep="\n")


def series_chapter(series: Series, section: Section | None, case: Case | None, title: str) -> Chapter:
    """Figures of one series, beside the ranges of a case if one is chosen."""
    found = statistics(series, section)
    judged = judge(found, case.ranges) if case else []
    place = str(section or "the whole series")
    chapter = Chapter(title, [f"{series.name}: {series.time.size} samples, one each {1e3 * series.step:.4g} ms."])
    chapter.blocks += [f"{line}." for line in of_series(series, section)]
    if case and judged:
        chapter.blocks.append(report.verdict(case.title, {title.lower(): judged}) + ".")
    chapter.blocks += [
        report.case_table(found, judged, series.speed, f"{title}: {place}"),
        Picture(plot.force_figure(series, section, found, title), f"{title}: {place}", f"{slug(title)}.png"),
    ]
    if section and section.last > section.first:
        by_span = {str(s).split(",")[0]: statistics(series, s) for s in section.single_spans()}
        chapter.blocks.append(report.spans_table(found, by_span, f"{title}, span by span"))
    return chapter


def compared(simulated: Statistics, measured: Statistics, edition: Edition) -> list[Judgement]:
    """Differences that both tell, beside what the edition accepts."""
    limits = {
        name: limit
        for name, limit in edition.agreement.items()
        if measured[name] and math.isfinite(measured[name]) and math.isfinite(simulated[name])
    }
    return agreement(simulated, measured, limits)


def agreement_chapter(simulated: Statistics, measured: Statistics, edition: Edition) -> Chapter:
    """A simulation beside the line test."""
    judged = compared(simulated, measured, edition)
    chapter = Chapter("Simulation and line test", [f"Accepted differences: {' '.join(edition.source.split())}"])
    if judged:
        chapter.blocks.append(report.verdict("Simulation against line test", {"the line test": judged}, "%") + ".")
    chapter.blocks.append(report.agreement_table(simulated, measured, judged))
    return chapter


def frf_chapter(
    fmu: Fmu,
    source: Source,
    parameters: Mapping[str, Value],
    edges: Sequence[float],
    direction: str | None,
    folder: Path,
    jobs: int,
) -> tuple[Chapter, list[Path]]:
    """The FMU's frequency response beside a measured one; the files written. Raises Interrupted after Ctrl-C."""
    with stop_on_interrupt() as stop:
        comparison = compare_frf(fmu, source, parameters, edges, direction, jobs, stop)
        if stop.is_set():
            raise Interrupted("interrupted: the frequency response is not complete, nothing is written")
    path = folder / "frf-comparison.csv"
    comparisons, used = comparison.levels, fmu.used_parameters(comparison.parameters)
    write_comparison(path, fmu, source, comparisons)
    for remark in comparison.remarks:
        print(remark, file=sys.stderr)
    note = synthetic_note(fmu, used)
    title = f"{source.path.name} and {fmu.description.modelName}{note}"
    course = "in the order of the file" if comparison.direction == FILE_ORDER else comparison.direction
    bench = ", ".join(f"{name} {with_unit(fmu.variables[name], used[name])}" for name in STATED)
    text = (
        f"Measured: {source.path}, force counted as that on the {source.force}. Computed: the FMU on its own "
        f"bench, stepped sine at the same frequencies and amplitudes, sweep {course}, {bench}. Errors are relative to "
        "the measured value; a positive phase error means that the computed response is ahead."
    )
    failed = sum(int((c.computed != c.computed).sum()) for c in comparisons)
    missing = [f"{failed} points could not be computed."] if failed else []
    picture = Picture(plot.frf_comparison_figure(comparisons, edges, title), title, "frf-comparison.png")
    table = report.frf_table(comparisons)
    return Chapter(
        "Pantograph: measured and computed FRF",
        [text, *missing, *(f"{r}." for r in comparison.remarks), table, picture],
    ), [path]
