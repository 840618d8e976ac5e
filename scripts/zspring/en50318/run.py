"""The validation from settings to report: all runs, or a user's own data."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from ..errors import ZSpringError
from ..fmu import Fmu
from ..interrupt import Interrupted, stop_on_interrupt
from ..line.statistics import BAND, ORDER
from . import about, chapters, report
from .edition import Edition
from .page import Chapter, write_report
from .plan import head_runs, reference_runs, sensitivity_runs
from .record import Record
from .workers import run_all

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
    record = Record(folder / "runs.csv", _head(catenary, pantograph), runs)
    speed = _run_missing(record, len(runs), catenary, pantograph, folder, jobs)

    outcomes = [
        chapters.outcome(edition, its_runs, record.found, folder)
        for edition, its_runs in zip(plan.editions, references)
    ]
    made = [chapters.edition_chapter(each, catenary, pantograph) for each in outcomes]
    if sensitivity:
        made.insert(1, chapters.sensitivity_chapter(outcomes[0], sensitivity, record.found))
    lines = [line for each in outcomes for line in _summary(each)]
    if sensitivity:
        lines.append(made[1].blocks[1].removesuffix("."))
    if heads:
        made.append(chapters.heads_chapter(heads, record.found, folder))
        by_head = chapters.heads(heads, record.found)
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


def _run_missing(record: Record, total: int, catenary: Fmu, pantograph: Fmu, folder: Path, jobs: int) -> str:
    """Make the runs that the record has not; a line on the time they took."""
    missing = record.missing
    if record.is_stale:
        print(f"{record.path} does not fit these settings: begun anew")
    if not missing:
        return f"all {total} runs are in {record.path}"
    if len(missing) < total:
        print(f"going on after {total - len(missing)} of {total} runs in {record.path}")
    begin, done = time.perf_counter(), 0
    with (
        stop_on_interrupt() as stop,
        record,
        tqdm(total=total, initial=total - len(missing), unit=" runs", disable=None, file=sys.stderr) as bar,
    ):
        try:
            for finished in run_all(missing, catenary.path, pantograph.path, folder, jobs, stop):
                record.append(finished)
                done += 1
                bar.update()
        except ZSpringError as error:
            kept = total - len(missing) + done
            raise ZSpringError(f"{error}; {kept} of {total} runs are kept in {record.path}") from None
    if done < len(missing):
        raise Interrupted(
            f"interrupted after {total - len(missing) + done} of {total} runs, kept in {record.path}; "
            "the same command goes on from there"
        )
    seconds = time.perf_counter() - begin
    return f"{done} runs in {seconds:.1f} s on {min(jobs, done)} processes"


def _summary(made: chapters.Outcome) -> list[str]:
    """Main figures of an edition's cases side by side, and the verdict."""
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
    return [*lines, ""]


def _head(catenary: Fmu, pantograph: Fmu) -> dict[str, str]:
    """What all runs have in common."""
    head = {}
    for fmu in (catenary, pantograph):
        head |= {f"{fmu.description.modelName} {key}": value for key, value in fmu.identity.items()}
        head[f"{fmu.description.modelName} SHA-256"] = fmu.sha256
    return {**head, "filter": f"Butterworth of order {ORDER} at {BAND:g} Hz, forwards and backwards"}
