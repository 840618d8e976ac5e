"""One study from its file to the result folder: run the cases, write and print the results."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import ZSpringError, tell
from ..exported_fmu import Copy
from ..fmu import Fmu
from ..heads import now, synthetic_note
from ..records import fill
from ..tables import replaced
from ..variables import Variables, text
from .connection import connected
from .coupled import LINE, REMARKS, CoupledQuantity, those_of
from .design import Case, make_cases
from .files import STATUS, ParquetCopy, Row, StudyRecord, column_of
from .head import first_start, study_head
from .report import remarks
from .results import Written
from .settings import StudySettings, read_study

NAMED = ("Enumeration", "Boolean")  # types whose values are written as names


@dataclass(frozen=True)
class Place:
    """Where cases run.

    scheduler   address of a Dask scheduler; None: `workers` processes on this machine
    timeout     s, for a scheduler to answer and to have a worker
    """

    scheduler: str | None
    workers: int
    timeout: float


def run_study(
    fmu: Fmu, catenary: Fmu, path: Path, folder: Path, place: Place, suffix: str, is_parquet_wanted: bool
) -> None:
    """Run the cases of the study at `path` that the folder has no result of, write and print all results.

    suffix              of the figures, "png" or "svg"
    is_parquet_wanted   write study.parquet, too
    Raises ZSpringError for a bad study, a missing scheduler, or when no case came out whole; Interrupted
    after Ctrl-C. Finished cases are kept.
    """
    settings = read_study(path, fmu, catenary)
    cases = make_cases(settings)
    start = first_start(settings, cases, fmu, catenary)
    record = StudyRecord(
        folder / "study.csv",
        study_head(settings, start, fmu, catenary, len(cases)),
        [_texts(settings.variables, case) for case in cases],
        [
            *(name for quantity in settings.quantities for name in quantity.scalars),
            *(name for quantity in settings.quantities for name in quantity.columns),
        ],
    )
    named = [name for name in settings.names if settings.variables[name].type in NAMED]
    parquet = ParquetCopy(record, [STATUS, REMARKS, *named]) if is_parquet_wanted else None
    missing = {number: settings.parameters_of(cases[number]) for number in record.missing}
    speed = f"all {len(cases)} cases are in {record.path}"
    if missing:
        needed = catenary if start.line else None
        speed = _measure(fmu, needed, settings, missing, record, len(cases), place, parquet)
    record.finish()
    written = Written(settings, cases, record, synthetic_note(fmu, start.parameters), suffix)
    lines = written.all()
    if parquet:
        parquet.write()
        written.paths.append(parquet.path)
    print(speed, *lines, " ".join(map(str, ["written:", *written.paths])), sep="\n")
    lost, failed = record.missing, record.failed
    tell([f"case {number}: {reason}" for number, reason in failed], record.path)
    tell(remarks(record.rows), record.path)
    if lost:
        raise ZSpringError(f"{len(lost)} cases were lost with their workers; the same command runs them again")
    if len(failed) == len(cases):
        raise ZSpringError(f"all {len(cases)} cases failed")


def write_line(fmu: Fmu, catenary: Fmu, path: Path, folder: Path, number: int) -> None:
    """The line of a case of the study at `path` as an FMU. Raises ZSpringError where there is no such case."""
    settings = read_study(path, fmu, catenary)
    cases = make_cases(settings)
    quantity = next((each for each in settings.quantities if isinstance(each, CoupledQuantity)), None)
    if quantity is None:
        raise ZSpringError("--line-of: the study has no [couple]")
    if number >= len(cases):
        raise ZSpringError(f"--line-of {number}: must be in 0 .. {len(cases) - 1}")
    target = folder / f"line-{number}.fmu"
    with quantity.on_line(catenary, settings.parameters_of(cases[number])) as (on_line, parameters):
        with replaced(target) as unfinished:
            Copy(starts=those_of(LINE, parameters)).write(on_line, unfinished)
    print("written:", target)


def _measure(
    fmu: Fmu,
    catenary: Fmu | None,
    settings: StudySettings,
    missing: Mapping[int, Case],
    record: StudyRecord,
    total: int,
    place: Place,
    parquet: ParquetCopy | None,
) -> str:
    """Run the missing cases; a line on the time it took, which goes to study.log, too."""
    threads, busy, cpu, seconds = 0, 0.0, 0.0, 0.0

    def work(stop: threading.Event) -> Iterator[Row]:
        nonlocal threads, busy, cpu, seconds
        with (
            connected(place.scheduler, min(place.workers, len(missing)), place.timeout) as cluster,
            cluster.study(fmu, catenary, settings.quantities) as study,
        ):
            threads, begin = cluster.threads, time.perf_counter()
            for number, result in cluster.run(study, missing, stop):
                busy += result.get("seconds", 0.0)
                cpu += result.get("CPU", 0.0)
                yield record.row(number, result)
                if parquet:
                    parquet.write_if_due()
            seconds = time.perf_counter() - begin

    fill(record, total, len(missing), "cases", work)
    count = len(missing)
    speed = (
        f"{count} cases in {seconds:.1f} s on {threads} worker threads, {count / seconds:.1f} cases/s; "
        f"{cpu / count:.2g} s of CPU a case, workers busy {100 * busy / (threads * seconds):.0f} %"
    )
    with (record.path.parent / "study.log").open("a", encoding="utf-8", newline="\n") as log:
        log.write(f"{now()}: {speed}\n")
    return speed


def _texts(variables: Variables, case: Case) -> dict[str, str]:
    """Columns and texts of a case."""
    return {column_of(variables[name]): text(variables[name], value) for name, value in case.items()}
