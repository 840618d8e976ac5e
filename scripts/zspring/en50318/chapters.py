"""Chapters of the report on our own runs: reference cases and sensitivity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..fmu import Fmu
from ..line.limits import of_bands
from ..line.series import BAND
from ..line.statistics import Statistics, statistics
from ..page import Chapter, Picture, Table
from . import plot, report, summary
from .cases import FINE_ELEMENT, FINE_STEP, is_fine
from .edition import Edition, Judgement, judge
from .passage import Passage, passages
from .plan import Run, slug
from .workers import Finished

FILTERS = {  # order of the two-pass filter, by what the tables call it
    "filter of order 2": 2,
    "filter of order 8": 8,
}


@dataclass(frozen=True)
class Outcome:
    """What an edition's runs came to, in the order of its cases, each leading pantograph before the trailing one."""

    edition: Edition
    passages: Sequence[Passage]

    @property
    def leading(self) -> list[Passage]:
        """Those of the leading pantographs, and of those that are alone: one for each case."""
        return [each for each in self.passages if not each.number]

    @property
    def judged(self) -> dict[str, list[Judgement]]:
        """By title of the passage."""
        return {each.title: each.judged for each in self.passages}

    def summary_rows(self, pantograph: str = "", line: str = "") -> list[summary.Row]:
        """The rows of the box on top; names of pantograph and line where they are no sets."""
        return [
            summary.row(
                f"{self.edition.name}, {each.title}",
                pantograph or Path(each.case.pantograph).stem,
                line or Path(each.case.line).stem,
                each.run.speed,
                each.run.section,
                each.judged,
                each.found,
            )
            for each in self.passages
        ]

    def remarks(self, catenary: Fmu) -> list[str]:
        """Lines on mean forces that were aimed at, and on what the model is not good for."""
        lines = [f"{each.title}: {line}" for each in self.passages for line in each.remarks(catenary)]
        figures = {name: None for each in self.passages for name in each.case.further}
        if is_fine(figures):
            lines.append(
                f"for bands above {BAND:g} Hz: elements of {FINE_ELEMENT:g} m, steps of {1e3 * FINE_STEP:g} ms"
            )
        return [*lines, *of_bands(figures)]


def outcome(edition: Edition, runs: Sequence[Run], done: Mapping[str, Finished], folder: Path) -> Outcome:
    """What the runs of an edition came to; their series are read from the folder."""
    each = (passages(case, run, done[run.key], folder) for case, run in zip(edition.cases, runs))
    return Outcome(edition, [passage for of_case in each for passage in of_case])


def edition_chapter(made: Outcome, catenary: Fmu, pantograph: Fmu) -> Chapter:
    """Values against ranges, forces along the line, values by span, parameters with their sources."""
    edition, judged = made.edition, made.judged
    chapter = Chapter(edition.name, [f"Source: {' '.join(edition.source.split())}"])
    if any(judged.values()):
        chapter.blocks.append(report.verdict(edition.name, judged) + ".")
        picture = plot.ranges_figure(judged, edition.name)
        caption = "Values within their accepted ranges; those whose range is a single value are not drawn"
        chapter.blocks.append(Picture(picture, caption, f"{slug(edition.name)}-ranges.png"))
    else:
        chapter.blocks.append("No accepted ranges are known to us, so that nothing is judged here.")
    chapter.blocks += [f"{line}." for line in made.remarks(catenary)]
    for each in made.passages:
        title = f"{edition.name}, {each.title}"
        chapter.blocks += [
            report.case_table(
                each.found, each.judged, each.run.speed, f"{title}: {each.run.section}", each.case.target
            ),
            each.picture(title),
            report.spans_table(each.found, each.by_span(), f"{title}, span by span"),
        ]
    seen: dict[tuple[str, str], Table] = {}
    for each in made.leading:
        key = each.case.line, each.case.pantograph
        seen.setdefault(key, report.parameter_table(each.case, each.run, catenary, pantograph))
    chapter.blocks += seen.values()
    return chapter


def choices(made: Outcome, runs: Sequence[Run], found: Mapping[str, Statistics]) -> dict[str, dict[str, Statistics]]:
    """Figures with other choices, by title of the edition's case and choice."""
    by_case = {}
    for each in made.leading:
        run = each.run
        own = {r.label: found[r.key] for r in runs if r.of == f"{run.of}, {run.label}"}
        filtered = {name: statistics(each.series, run.section, order) for name, order in FILTERS.items()}
        by_case[each.case.title] = own | filtered
    return by_case


def judged_choices(
    made: Outcome, found: Mapping[str, Mapping[str, Statistics]]
) -> dict[str, dict[str, list[Judgement]]]:
    """Judgements of what `choices` gives."""
    return {
        case.title: {name: judge(each, case.ranges) for name, each in found[case.title].items()}
        for case in made.edition.cases
    }


def sensitivity_chapter(made: Outcome, found: Mapping[str, Mapping[str, Statistics]]) -> Chapter:
    """What other choices do to the values of an edition's cases; `found` as `choices` gives it."""
    drawn, listed, judged = {}, [], judged_choices(made, found)
    for each in made.leading:
        case, reference = each.case, each.found
        rows = {"reference": judge(reference, case.ranges), **judged[case.title]}
        listed.append(report.sensitivity_table(reference, found[case.title], rows, case.title))
        drawn[case.title] = reference, found[case.title], case.ranges.get("standard_deviation")
    picture = Picture(
        plot.sensitivity_figure(drawn, made.edition.name), "Standard deviation by choice", "sensitivity.png"
    )
    text = (
        "What the published data leave open, and the numerical settings, one at a time from the reference, whose "
        "sources are told with its parameters above. Filters of order 2 and 8 are run twice like that of order 4, "
        "which the reference has. Values outside their accepted ranges are marked. The reference was chosen "
        "among published values with the ranges in view: that its values are inside is the agreement of a chosen "
        "set and no validation; how many of these choices are inside tells more."
    )
    return Chapter(f"Sensitivity of {made.edition.name}", [text, f"{report.departures(judged)}.", picture, *listed])
