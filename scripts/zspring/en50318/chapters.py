"""Chapters of the report on our own runs: reference cases and sensitivity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..fmu import Fmu
from ..line.limits import near_wave_speed, of_series
from ..line.result import read_result
from ..line.series import Series
from ..line.statistics import Statistics, statistics
from ..page import Chapter, Picture, Table
from . import plot, report, summary
from .edition import Edition, Judgement, judge
from .plan import Run, slug
from .workers import Finished

FILTERS = {  # order of the two-pass filter, by what the tables call it
    "filter of order 2": 2,
    "filter of order 8": 8,
}


@dataclass(frozen=True)
class Outcome:
    """An edition's runs with their series, figures, and ranges; in the order of its cases."""

    edition: Edition
    runs: Sequence[Run]
    series: Sequence[Series]
    found: Sequence[Statistics]
    uplifts: Sequence[float]  # N

    @property
    def judged(self) -> dict[str, list[Judgement]]:
        """By title of the case."""
        cases = zip(self.edition.cases, self.found)
        return {case.title: judge(found, case.ranges) for case, found in cases}

    def summary_rows(self) -> list[summary.Row]:
        """The rows of the box on top."""
        name = self.edition.name
        return [
            summary.row(
                f"{name}, {case.title}",
                Path(case.pantograph).stem,
                Path(case.line).stem,
                case.speed,
                run.section,
                self.judged[case.title],
                found,
            )
            for case, run, found in zip(self.edition.cases, self.runs, self.found)
        ]

    def remarks(self, catenary: Fmu) -> list[str]:
        """Lines on mean forces that were aimed at, and on what the line's model is not good for."""
        lines = []
        for case, run, series, found, uplift in zip(
            self.edition.cases, self.runs, self.series, self.found, self.uplifts
        ):
            if run.mean_force is not None:
                lines.append(
                    f"{case.title}: mean force of {case.supply} lines at {case.speed:g} km/h: target "
                    f"{run.mean_force:.1f} N, reached {found['mean_force']:.1f} N with a static force of "
                    f"{case.static_force:.1f} N and an uplift of {uplift:.1f} N on the upper frame"
                )
            limits = near_wave_speed(catenary, run.line, run.speed / 3.6) + of_series(series, run.section)
            lines += [f"{case.title}: {line}" for line in limits]
        return lines


def outcome(edition: Edition, runs: Sequence[Run], done: Mapping[str, Finished], folder: Path) -> Outcome:
    """What the runs of an edition came to; their series are read from the folder."""
    results = [read_result(folder / run.series).series(0) for run in runs]
    finished = [done[run.key] for run in runs]
    return Outcome(edition, runs, results, [each.statistics for each in finished], [each.uplift for each in finished])


def edition_chapter(made: Outcome, catenary: Fmu, pantograph: Fmu) -> Chapter:
    """Figures against ranges, forces along the line, figures by span, parameters with their sources."""
    edition, judged = made.edition, made.judged
    chapter = Chapter(edition.name, [f"Source: {' '.join(edition.source.split())}"])
    if any(judged.values()):
        chapter.blocks.append(report.verdict(edition.name, judged) + ".")
        picture = plot.ranges_figure(judged, edition.name)
        caption = "Figures within their accepted ranges; those whose range is a single value are not drawn"
        chapter.blocks.append(Picture(picture, caption, f"{slug(edition.name)}-ranges.png"))
    else:
        chapter.blocks.append("No accepted ranges are known to us, so that nothing is judged here.")
    chapter.blocks += [f"{line}." for line in made.remarks(catenary)]
    for case, run, one, found in zip(edition.cases, made.runs, made.series, made.found):
        title = f"{edition.name}, {case.title}"
        by_span = {str(s).split(",")[0]: statistics(one, s) for s in run.section.single_spans()}
        chapter.blocks += [
            report.case_table(found, judged[case.title], case.speed, f"{title}: {run.section}"),
            Picture(
                plot.force_figure(one, run.section, found, title),
                f"{title}: contact force, height of the contact point and uplift at the supports",
                run.series.replace(".csv", ".png"),
            ),
            report.spans_table(found, by_span, f"{title}, span by span"),
        ]
    seen: dict[tuple[str, str], Table] = {}
    for case, run in zip(edition.cases, made.runs):
        seen.setdefault((case.line, case.pantograph), report.parameter_table(case, run, catenary, pantograph))
    chapter.blocks += seen.values()
    return chapter


def choices(made: Outcome, runs: Sequence[Run], found: Mapping[str, Statistics]) -> dict[str, dict[str, Statistics]]:
    """Figures with other choices, by title of the edition's case and choice."""
    by_case = {}
    for case, run, one in zip(made.edition.cases, made.runs, made.series):
        own = {r.label: found[r.key] for r in runs if r.of == f"{run.of}, {run.label}"}
        by_case[case.title] = own | {name: statistics(one, run.section, order) for name, order in FILTERS.items()}
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
    """What other choices do to the figures of an edition's cases; `found` as `choices` gives it."""
    drawn, listed, judged = {}, [], judged_choices(made, found)
    for case, reference in zip(made.edition.cases, made.found):
        rows = {"reference": judge(reference, case.ranges), **judged[case.title]}
        listed.append(report.sensitivity_table(reference, found[case.title], rows, case.title))
        drawn[case.title] = reference, found[case.title], case.ranges.get("standard_deviation")
    picture = Picture(
        plot.sensitivity_figure(drawn, made.edition.name), "Standard deviation by choice", "sensitivity.png"
    )
    text = (
        "What the published data leave open, and the numerical settings, one at a time from the reference, whose "
        "sources are told with its parameters above. Filters of order 2 and 8 are run twice like that of order 4, "
        "which the reference has. Figures outside their accepted ranges are marked. The reference was chosen "
        "among published values with the ranges in view: that its figures are inside is the agreement of a chosen "
        "set and no validation; how many of these choices are inside tells more."
    )
    return Chapter(f"Sensitivity of {made.edition.name}", [text, f"{report.departures(judged)}.", picture, *listed])
