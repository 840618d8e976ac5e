"""Reports on a user's own data: a contact force, a simulation beside a line test, a measured FRF."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..bench.curves import Source
from ..errors import ZSpringError, tell
from ..fmu import Fmu
from ..line.journey import LineExtent
from ..line.limits import of_bands, of_series
from ..line.quantities import FIGURES
from ..line.series import Series, read_series, require_pressing
from ..line.stated import SAME_SPEED, agreed
from ..line.statistics import Section, Statistics, statistics
from ..line_file.chosen import ChosenLine, line_of
from ..page import Cell, Chapter, Picture, Table, keep_other_reports
from ..variables import Value
from . import about, line_test, plot, report, summary
from .cases import section_of
from .edition import Case, Edition, judge
from .measured_frf import frf_chapter
from .plan import slug
from .run import REPORT, finish

SAME_SPANS = 1e-3  # m
SIMULATION, LINE_TEST = "Simulation", "Line test"  # titles of chapters


@dataclass(frozen=True)
class OwnData:
    """A user's contact forces, and what to make of them."""

    series: Path | None  # of a simulation, or of whatever is to be evaluated
    line_test: Path | None
    edition: Edition
    case_title: str | None  # of the case whose spans and ranges are meant
    speed: float | None  # m/s
    spans: Sequence[tuple[int, int]]  # first and last of each section to evaluate
    span: float | None  # m
    first_support: float | None  # m, where span 1 begins
    pantograph: int
    line: ChosenLine | None = None  # whose spans are meant
    turned: Sequence[str] = ()  # of "series" and "line-test", those whose forces have the other sign
    further: Sequence[str] = ()  # values to tell besides those of every evaluation and of the case

    def told(self) -> dict[str, str]:
        """What was chosen, in words."""
        named = {"edition": self.edition.name, "line": self.line.name if self.line else None}
        return {name: str(value) for name, value in {**vars(self), **named}.items()}

    @property
    def case(self) -> Case | None:
        """Raises ZSpringError for a title that no case has."""
        return self.edition.case(self.case_title) if self.case_title else None

    @property
    def figures(self) -> tuple[str, ...]:
        """Those to tell besides FIGURES."""
        names = (*self.further, *(self.case.further if self.case else ()), *self.edition.agreement)
        return tuple(dict.fromkeys(name for name in names if name not in FIGURES))

    def read(self) -> dict[str, Series]:
        """The series by the title of their chapters; the line test's positions count from the simulation's first
        support, if both files say where theirs is. Raises ZSpringError as read_series does."""
        first = SIMULATION if self.line_test else "Contact force"
        files = (first, self.series, "series"), (LINE_TEST, self.line_test, "line-test")
        found = {
            title: read_series(path, self.speed, self.pantograph, name in self.turned)
            for title, path, name in files
            if path
        }
        begins = self._begins(found.values())
        return {title: one.moved(begins[0] - begin) for begin, (title, one) in zip(begins, found.items())}

    def _begins(self, series: Collection[Series]) -> list[float]:
        """Where span 1 begins in the positions of each file, m: by its head, else by --first-support, else at 0.

        Raises ZSpringError where all heads say it, and not what --first-support says.
        """
        heads = {one.name: one.stated.first_support for one in series}
        if None not in heads.values():
            for name, begin in heads.items():
                agreed("first support", "m", {"--first-support": self.first_support, name: begin})
        return [(self.first_support or 0.0) if begin is None else begin for begin in heads.values()]

    def sections(self, catenary: Fmu, series: Collection[Series]) -> list[Section]:
        """The spans to evaluate: those asked for, else those of the case; none: the whole series.

        Raises ZSpringError where options, the case and the heads of the files do not agree on speed or line, and
        where nobody says how long a span is.
        """
        case, heads = self.case, {one.name: one.stated for one in series}
        speeds = {one.name: one.speed for one in series}
        lengths = {"--span": self.span, **{name: head.span for name, head in heads.items()}}
        lines = {name: LineExtent(np.array(head.boundaries)) for name, head in heads.items() if head.boundaries}
        if self.line:
            lines["--line"] = LineExtent.of(self.line.catenary, self.line.parameters)
        of_case = None
        if case:
            line = line_of(case.line, catenary)
            lines[f"the case {case.title}"] = extent = LineExtent.of(line.catenary, line.parameters)
            of_case = section_of(case, extent)
            speeds[f"the case {case.title}"] = case.speed
        agreed("speed", "km/h", speeds, SAME_SPEED)
        begin = next(iter(self._begins(series)), self.first_support or 0.0)
        chosen = self.spans or ([(of_case.first, of_case.last)] if of_case else [])
        lengths |= {name: extent.section(1, extent.spans).span for name, extent in lines.items()}
        span = agreed("span", "m", lengths)
        for first, last in chosen:
            for name, head in heads.items():
                if head.spans and last > head.spans:
                    raise ZSpringError(f"spans {first} to {last}: {name} says that there are {head.spans}")
        if lines:
            return [_same_section(lines, span, *each).moved(begin) for each in chosen]
        if chosen and span is None:
            raise ZSpringError("--spans: needs the length of a span, --span L, or --line; no file says it in its head")
        return [Section.alike(*each, span or 0.0, begin) for each in chosen]


def _same_section(lines: Mapping[str, LineExtent], span: float | None, first: int, last: int) -> Section:
    """These spans of all lines. Raises ZSpringError where a line has them elsewhere, or all spans alike, m."""
    sections = {name: extent.section(first, last) for name, extent in lines.items()}
    (name, section), *others = sections.items()
    if span is not None:
        others += [(f"a span of {span:g} m", Section.alike(first, last, span))]
    for other, found in others:
        for a, b in zip(section.edges, found.edges):
            if abs(a - b) > SAME_SPANS:
                raise ZSpringError(
                    f"spans {first} to {last}: begin or end at {a:g} m by {name}, but {b:g} m by {other}"
                )
    return section


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
    given = data.read()
    sections: list[Section | None] = [*data.sections(catenary, given.values())] or [None]
    made, files, lines, box = list[Chapter](), list[Path](), list[str](), list[summary.Row]()
    found: dict[str, list[Statistics]] = {}  # by title and section
    for title, series in given.items():
        found[title] = [statistics(series, section, further=data.figures) for section in sections]
        for section, each in zip(sections, found[title]):
            require_pressing(f"{series.name}, {section}" if section else series.name, each["mean_force"])
            judged = judge(each, data.case.ranges) if data.case else []
            box.append(summary.row(f"{title}: {series.name}", "", "", series.speed, section, judged, each))
            tell(of_series(series, section), folder)
        made.append(series_chapter(series, sections, found[title], data.case, title))
    if len(found) == 1:
        for section, one in zip(sections, *found.values()):
            lines += report.as_lines(report.figures_table({title: one}, str(section or "the whole series")))
    tell(of_bands(data.figures) if found else [], folder)
    if len(found) == 2:
        both = given[SIMULATION], given[LINE_TEST], sections, found[SIMULATION], found[LINE_TEST]
        compared = line_test.Comparison(*both, data.edition)
        made.append(compared.chapter())
        lines += compared.printed()
        box.append(["Simulation against line test", *[""] * 4, summary.ended(compared.all_judged), ""])
    if source:
        folder.mkdir(parents=True, exist_ok=True)
        chapter, written = frf_chapter(pantograph, source, parameters, edges, direction, folder, jobs)
        made.append(chapter)
        files += written
        box.append([f"FRF: {source.path}", *[""] * 4, Cell("nothing is judged"), ""])
        lines += [line for b in chapter.blocks if isinstance(b, Table) for line in report.as_lines(b)]
    lines += [b for chapter in made for b in chapter.blocks if isinstance(b, str) and "accepted ranges" in b]
    settings = {title: series.name for title, series in given.items()}
    settings |= {"measured FRF": str(source.path)} if source else {}
    chosen = [summary.chapter(box), about.own_data(), *made]
    written = finish(folder, chosen, (pantograph,), settings, files, told)
    print(*lines, " ".join(["written:", *map(str, written)]), sep="\n")


def series_chapter(
    series: Series, sections: Sequence[Section | None], found: Sequence[Statistics], case: Case | None, title: str
) -> Chapter:
    """Figures of one series over each section, beside the ranges of a case if one is chosen."""
    chapter = Chapter(title, [f"{series.name}: {series.time.size} samples, one each {1e3 * series.step:.4g} ms."])
    for section, each in zip(sections, found):
        judged, place = judge(each, case.ranges) if case else [], str(section or "the whole series")
        chapter.blocks += [f"{line}." for line in of_series(series, section)]
        if case and judged:
            chapter.blocks.append(report.verdict(case.title, {title.lower(): judged}) + ".")
        file = slug(title if len(sections) == 1 else f"{title} {place.split(',')[0]}") + ".png"
        chapter.blocks += [
            report.case_table(each, judged, series.speed, f"{title}: {place}", case.target if case else None),
            Picture(plot.force_figure(series, section, each, title), f"{title}: {place}", file),
        ]
        if section and section.last > section.first:
            free = [name for name in each if name not in FIGURES]
            by_span = {str(s).split(",")[0]: statistics(series, s, further=free) for s in section.single_spans()}
            chapter.blocks.append(report.spans_table(each, by_span, f"{title}, span by span"))
    return chapter
