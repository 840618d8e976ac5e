"""The validation from settings to report: all runs, or a user's own data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..fmu import Fmu
from ..interrupt import Interrupted
from ..line.statistics import BAND, ORDER
from ..page import Chapter, keep_other_reports, write_report
from ..records import Record, fill
from . import about, chapters, comparison, report, summary
from .cases import reference_runs
from .edition import Edition
from .files import missing, put_in_order, run_record
from .own_pair import OwnPair
from .own_pantograph import OwnPantograph
from .own_pantograph import lines as printed
from .plan import Run, head_runs, sensitivity_runs
from .workers import Finished, run_all

OUR_RUNS = {"report": "on our runs"}  # of whatever plan: runs.csv has them all
REPORT = "report.html"
TITLE = "EN 50318: simulation of pantograph and overhead line"


@dataclass(frozen=True)
class Plan:
    """What to run: cases of editions, what choices do to those of the first, the heads by speed (km/h)."""

    editions: Sequence[Edition]
    with_sensitivity: bool
    head_speeds: Sequence[float]
    own: OwnPantograph | None = None  # on the lines of all cases
    pair: OwnPair | None = None


def validate(plan: Plan, catenary: Fmu, pantograph: Fmu, folder: Path, jobs: int) -> None:
    """Run what the folder has no result of; write the report and print its main report.

    Raises ZSpringError where a run cannot be made, Interrupted after Ctrl-C; finished runs are kept.
    """
    keep_other_reports(folder / REPORT, OUR_RUNS)
    record = run_record(folder / "runs.csv", _head(catenary, pantograph))
    try:
        _validate(plan, catenary, pantograph, folder, jobs, record)
    except KeyboardInterrupt:
        kept = f"{len(record.results)} runs are kept in {record.path}; the same command goes on from there"
        raise Interrupted(f"interrupted: {kept}") from None


def _validate(plan: Plan, catenary: Fmu, pantograph: Fmu, folder: Path, jobs: int, record: Record[Finished]) -> None:
    references = [reference_runs(edition, catenary, pantograph) for edition in plan.editions]
    own = [plan.own.runs(each) for each in references] if plan.own else []
    pair = plan.pair.edition(pantograph) if plan.pair else None
    of_pair = plan.pair.runs(pair) if plan.pair and pair else []
    sensitivity = sensitivity_runs(references[0], catenary) if plan.with_sensitivity else []
    heads = head_runs(catenary, pantograph, plan.head_speeds) if plan.head_speeds else []
    runs = [*(run for each in (*references, *own, of_pair) for run in each), *sensitivity, *heads]
    speed = _run_missing(record, runs, catenary, pantograph, folder, jobs)
    done = {finished.key: finished for finished in record.results}
    found = {key: finished.statistics for key, finished in done.items()}

    outcomes = [chapters.outcome(*each, done, folder) for each in zip(plan.editions, references)]
    box = [row for each in outcomes for row in each.summary_rows()]
    lines = [line for each in outcomes for line in _summary(each, catenary)]
    made = [chapters.edition_chapter(each, catenary, pantograph) for each in outcomes]
    if sensitivity:
        counted = chapters.choices(outcomes[0], sensitivity, found)
        made.insert(1, chapters.sensitivity_chapter(outcomes[0], counted))
        lines.append(report.departures(chapters.judged_choices(outcomes[0], counted)))
    if plan.own:
        pairs = list(zip(outcomes, (chapters.outcome(*each, done, folder) for each in zip(plan.editions, own))))
        made.insert(0, plan.own.chapter(pairs, pantograph, catenary))
        box = [row for _, mine in pairs for row in plan.own.summary_rows(mine)] + box
        lines = [line for each, mine in pairs for line in printed(plan.own.name, mine, each, catenary)] + lines
    if plan.pair and pair:
        ours = chapters.outcome(pair, of_pair, done, folder)
        made.insert(0, plan.pair.chapter(ours, pantograph))
        box = [*ours.summary_rows(plan.pair.pantograph_name, plan.pair.line.name), *box]
        lines = [*_summary(ours, catenary), *lines]
    if heads:
        compared = comparison.by_head(heads, done)
        made.append(comparison.chapter(heads, compared, catenary, folder))
        lines += comparison.printed(compared)
        box.append(comparison.summary_row(heads))
    series = [folder / run.series for run in runs if run.series]
    first = summary.chapter(box)
    chosen = [first, about.own_runs(), *made]
    written = finish(folder, chosen, (catenary, pantograph), {}, [record.path, *series], OUR_RUNS)
    print(*lines, "", speed, f"written: {written[0]} and {len(written) - 1} files beside it", sep="\n")


def finish(
    folder: Path,
    made: Sequence[Chapter],
    fmus: Sequence[Fmu],
    listed: Mapping[str, str],
    files: Sequence[Path],
    settings: Mapping[str, str],
) -> list[Path]:
    """Write the report, after these chapters those of every report; all paths, that of the report first.

    listed      in the report, with the versions
    settings    that tell it from others
    """
    last = about.made_with(fmus, listed, files)
    page, *pictures = write_report(folder / REPORT, TITLE, [*made, about.method(), last], settings)
    return [page, *files, *pictures]


def _run_missing(
    record: Record[Finished], runs: Sequence[Run], catenary: Fmu, pantograph: Fmu, folder: Path, jobs: int
) -> str:
    """Make the runs that the record has not; a line on the time they took."""
    todo = missing(record, runs)
    if not todo:
        return f"all {len(runs)} runs are in {record.path}"
    try:
        seconds = fill(
            record,
            len(runs),
            len(todo),
            "runs",
            lambda stop: run_all(todo, catenary.path, pantograph.path, folder, jobs, stop),
        )
    finally:
        put_in_order(record, runs)
    return f"{len(todo)} runs in {seconds:.1f} s on {min(jobs, len(todo))} processes"


def _summary(made: chapters.Outcome, catenary: Fmu) -> list[str]:
    """Main values of an edition's cases side by side, the verdict, and what to know beside it."""
    judged = made.judged
    rows = []
    further = dict.fromkeys(name for case in made.edition.cases for name in case.further)
    for name in (*report.SENSITIVE, "loss_of_contact", *further):
        row = [report.labelled(name)]
        for each in made.passages:
            accepted = next((j.accepted for j in each.judged if j.name == name), None)
            shown = report.number(name, each.found.get(name, math.nan))
            row.append(shown + ("  {:g}..{:g}".format(*accepted) if accepted else ""))
        rows.append(row)
    titles = [each.title for each in made.passages]
    lines = report.as_lines(report.Table("", [made.edition.name, *titles], rows))
    if any(judged.values()):
        lines.append(report.verdict(made.edition.name, judged))
    lines.append(summary.shares(made.edition.name, {each.title: each.found for each in made.passages}))
    return [*lines, *made.remarks(catenary), ""]


def _head(catenary: Fmu, pantograph: Fmu) -> dict[str, str]:
    """What all runs have in common."""
    head: dict[str, str] = {}
    for fmu in (catenary, pantograph):
        head |= {f"{fmu.description.modelName} {key}": value for key, value in fmu.identity.items()}
        head[f"{fmu.description.modelName} SHA-256"] = fmu.sha256
    return {**head, "filter": f"Butterworth of order {ORDER} at {BAND:g} Hz, forwards and backwards"}
