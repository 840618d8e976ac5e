"""The validation from settings to report: all runs, or a user's own data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..fmu import Fmu
from ..line.statistics import BAND, ORDER
from ..records import Record, fill
from . import about, chapters, report
from .edition import Edition
from .files import missing, put_in_order, run_record
from .page import Chapter, write_report
from .plan import Run, head_runs, reference_runs, sensitivity_runs
from .workers import Finished, run_all

TITLE = "EN 50318: simulation of pantograph and overhead line"


@dataclass(frozen=True)
class Plan:
    """What to run: cases of editions, what choices do to those of the first, the heads by speed (km/h)."""

    editions: Sequence[Edition]
    with_sensitivity: bool
    head_speeds: Sequence[float]


def validate(plan: Plan, catenary: Fmu, pantograph: Fmu, folder: Path, jobs: int) -> None:
    """Run what the folder has no result of; write the report and print its main report.

    Raises ZSpringError where a run cannot be made, Interrupted after Ctrl-C; finished runs are kept.
    """
    references = [reference_runs(edition, catenary, pantograph) for edition in plan.editions]
    sensitivity = sensitivity_runs(references[0]) if plan.with_sensitivity else []
    heads = head_runs(catenary, pantograph, plan.head_speeds) if plan.head_speeds else []
    runs = [*(run for each in references for run in each), *sensitivity, *heads]
    record = run_record(folder / "runs.csv", _head(catenary, pantograph))
    speed = _run_missing(record, runs, catenary, pantograph, folder, jobs)
    done = {finished.key: finished for finished in record.results}
    found = {key: finished.statistics for key, finished in done.items()}

    outcomes = [
        chapters.outcome(edition, its_runs, done, folder) for edition, its_runs in zip(plan.editions, references)
    ]
    made = [chapters.edition_chapter(each, catenary, pantograph) for each in outcomes]
    if sensitivity:
        made.insert(1, chapters.sensitivity_chapter(outcomes[0], sensitivity, found))
    lines = [line for each in outcomes for line in _summary(each, catenary)]
    if sensitivity:
        lines.append(str(made[1].blocks[1]).removesuffix("."))
    if heads:
        made.append(chapters.heads_chapter(heads, found, folder))
        by_head = chapters.heads(heads, found)
        for name in ("standard_deviation", "loss_of_contact"):
            lines += ["", *report.as_lines(report.heads_table(by_head, name))]
    series = [folder / run.series for run in runs if run.series]
    written = finish(folder, [about.own_runs(), *made], (catenary, pantograph), {}, [record.path, *series])
    print(*lines, "", speed, f"written: {written[0]} and {len(written) - 1} files beside it", sep="\n")


def finish(
    folder: Path, made: Sequence[Chapter], fmus: Sequence[Fmu], settings: Mapping[str, str], files: Sequence[Path]
) -> list[Path]:
    """Write the report, after these chapters those of every report; all paths, that of the report first."""
    last = about.made_with(fmus, settings, files)
    page, *pictures = write_report(folder / "report.html", TITLE, [*made, about.method(), last])
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
    """Main figures of an edition's cases side by side, the verdict, and what to know beside it."""
    judged = made.judged
    rows = []
    for name in (*report.SENSITIVE, "loss_of_contact"):
        row = [report.labelled(name)]
        for case, found in zip(made.edition.cases, made.found):
            accepted = case.ranges.get(name)
            row.append(report.number(name, found[name]) + ("  {:g}..{:g}".format(*accepted) if accepted else ""))
        rows.append(row)
    titles = [case.title for case in made.edition.cases]
    lines = report.as_lines(report.Table("", [made.edition.name, *titles], rows))
    if any(judged.values()):
        lines.append(report.verdict(made.edition.name, judged))
    return [*lines, *made.remarks(catenary), ""]


def _head(catenary: Fmu, pantograph: Fmu) -> dict[str, str]:
    """What all runs have in common."""
    head: dict[str, str] = {}
    for fmu in (catenary, pantograph):
        head |= {f"{fmu.description.modelName} {key}": value for key, value in fmu.identity.items()}
        head[f"{fmu.description.modelName} SHA-256"] = fmu.sha256
    return {**head, "filter": f"Butterworth of order {ORDER} at {BAND:g} Hz, forwards and backwards"}
