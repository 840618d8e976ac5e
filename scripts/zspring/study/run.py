"""One study from its file to the result folder: run the cases, write and print the results."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu, FmuError
from ..heads import file_head, now, synthetic_note
from ..records import fill
from ..variables import Value, text
from . import report
from .connection import connected
from .design import Case, make_cases
from .evaluations import FrfQuantity
from .files import STATUS, Row, StudyRecord
from .plot import envelope_figure, sobol_figure
from .settings import StudySettings, read_study


def run_study(
    fmu: Fmu, path: Path, folder: Path, scheduler: str | None, workers: int, timeout: float, suffix: str, parquet: bool
) -> None:
    """Run the cases of the study at `path` that the folder has no result of, write and print all results.

    scheduler   address of a Dask scheduler; None: `workers` processes on this machine
    timeout     s, for a scheduler to answer and to have a worker
    suffix      of the figures, "png" or "svg"
    parquet     write study.parquet, too
    Raises ZSpringError for a bad study, a missing scheduler, or when no case came out whole; Interrupted
    after Ctrl-C. Finished cases are kept.
    """
    settings = read_study(path, fmu)
    cases = make_cases(settings)
    parameters = _all_parameters(fmu, settings, cases)
    record = StudyRecord(
        folder / "study.csv",
        _head(fmu, settings, parameters, len(cases)),
        [_texts(fmu, case) for case in cases],
        [
            *(name for quantity in settings.quantities for name in quantity.scalars),
            *(name for quantity in settings.quantities for name in quantity.columns),
        ],
    )
    missing = record.missing
    speed = f"all {len(cases)} cases are in {record.path}"
    if missing:
        speed = _measure(fmu, settings, cases, record, missing, scheduler, workers, timeout)
    record.finish()
    lines = _write_results(fmu, settings, record, parameters, suffix, parquet)
    print(speed, *lines, sep="\n")
    lost, failed = record.missing, record.failed
    tell([f"case {number}: {reason}" for number, reason in failed], record.path)
    if lost:
        raise ZSpringError(f"{len(lost)} cases were lost with their workers; the same command runs them again")
    if len(failed) == len(cases):
        raise ZSpringError(f"all {len(cases)} cases failed")


def _measure(
    fmu: Fmu,
    settings: StudySettings,
    cases: list[Case],
    record: StudyRecord,
    missing: list[int],
    scheduler: str | None,
    workers: int,
    timeout: float,
) -> str:
    """Run the missing cases; a line on the time it took."""
    threads, busy, seconds = 0, 0.0, 0.0

    def work(stop: threading.Event) -> Iterator[Row]:
        nonlocal threads, busy, seconds
        with (
            connected(scheduler, min(workers, len(missing)), timeout) as cluster,
            cluster.study(fmu, settings) as study,
        ):
            threads, begin = cluster.threads, time.perf_counter()
            for number, result in cluster.run(study, {n: cases[n] for n in missing}, stop):
                busy += result.get("seconds", 0.0)
                yield record.row(number, result)
            seconds = time.perf_counter() - begin

    fill(record, len(cases), len(missing), "cases", work)
    return (
        f"{len(missing)} cases in {seconds:.1f} s on {threads} worker threads, "
        f"{len(missing) / seconds:.1f} cases/s; workers busy {100 * busy / (threads * seconds):.0f} %"
    )


def _write_results(
    fmu: Fmu, settings: StudySettings, record: StudyRecord, parameters: dict[str, Value], suffix: str, parquet: bool
) -> list[str]:
    """Write figures and tables of all results; the lines to print about them."""
    folder, rows, written = record.path.parent, record.rows, [record.path]
    scalars = [name for quantity in settings.quantities for name in quantity.scalars]
    note = synthetic_note(fmu, parameters)
    title = f"Parameter study, {settings.design}, of {', '.join(settings.vary)}{note}"
    lines = report.spread_table(scalars, rows)
    for quantity in settings.quantities:
        if isinstance(quantity, FrfQuantity):
            figure = envelope_figure(report.envelopes(quantity, rows), len(rows), title)
            written.append(folder / f"envelope.{suffix}")
            save(figure, written[-1])
    if settings.design == "sobol":
        found = report.sobol_indices(settings, scalars, rows)
        if found:
            lines += [*report.sobol_table(settings, found), *report.sobol_doubts(found)]
            written += [folder / "sobol.csv", folder / f"sobol.{suffix}"]
            report.write_sobol(written[-2], record.head, settings, found)
            save(sobol_figure(found, list(settings.vary), title), written[-1])
        incomplete = report.incomplete_blocks(settings, rows)
        if incomplete:
            lines.append(f"Sobol indices without {incomplete} of {settings.samples} blocks, which have failed cases")
    if parquet:
        written.append(folder / "study.parquet")
        enumerations = [name for name in settings.vary if fmu.variables[name].type in ("Enumeration", "Boolean")]
        report.write_parquet(written[-1], record.head, record.columns, rows, [STATUS, *enumerations])
    return [*lines, " ".join(map(str, ["written:", *written]))]


def _all_parameters(fmu: Fmu, settings: StudySettings, cases: list[Case]) -> dict[str, Value]:
    """All parameters of the first case that the FMU starts with. Raises FmuError if it starts with none."""
    names = [name for name in fmu.variables.names("parameter") if not name.startswith("bench.")]
    refusal = None
    with fmu.instances() as (instance,):
        for case in cases:
            try:
                instance.start({**settings.common, **case})
                return dict(zip(names, instance.get(names)))
            except FmuError as error:
                refusal = refusal or error
    raise ZSpringError(f"the FMU starts with no case: {refusal}")


def _head(fmu: Fmu, settings: StudySettings, parameters: dict[str, Value], cases: int) -> dict[str, str]:
    """Everything that defines the numbers of the study, and the date."""
    own = {"date": now(), "SHA-256 of the FMU": fmu.sha256, "cases": str(cases), **settings.described(fmu.variables)}
    unvaried = {name: value for name, value in parameters.items() if name not in settings.vary}
    return file_head(fmu, unvaried, own, but_not=("drive",))


def _texts(fmu: Fmu, case: Case) -> dict[str, str]:
    """Columns and texts of a case."""
    texts = {}
    for name, value in case.items():
        variable = fmu.variables[name]
        unit = "" if variable.unit in (None, "1") else f" [{variable.unit}]"
        texts[name + unit] = text(variable, value)
    return texts
