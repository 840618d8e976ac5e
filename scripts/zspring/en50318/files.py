"""The figures of all runs in one CSV, which survives an interruption at any moment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from ..line.statistics import FIGURES
from ..records import Record
from .plan import Run
from .workers import Finished

FIGURE_COLUMNS = {name: f"{name} [{unit}]" if unit else name for name, (_, unit, _) in FIGURES.items()}
COLUMNS = ["group", "of", "label", "speed [km/h]", "section", *FIGURE_COLUMNS.values(), "uplift [N]", "CPU [s]", "key"]


def run_record(path: Path, head: Mapping[str, str]) -> Record[Finished]:
    """Figures by run, those of other plans included; series of the runs that keep theirs are in files beside it."""
    return Record(path, head, COLUMNS, _to_row, _from_row)


def missing(record: Record[Finished], runs: Iterable[Run]) -> list[Run]:
    """Runs whose figures or series are not there."""
    folder, found = record.path.parent, {finished.key for finished in record.results}
    return [run for run in runs if run.key not in found or (run.series and not (folder / run.series).exists())]


def put_in_order(record: Record[Finished], runs: Iterable[Run]) -> None:
    """Write the results in the order of the runs, then those of other plans."""
    found = {finished.key: finished for finished in record.results}
    first = [run.key for run in runs if run.key in found]
    record.write(found[key] for key in dict.fromkeys([*first, *found]))


def _to_row(finished: Finished) -> list[object]:
    numbers = (float(finished.statistics[name]) for name in FIGURES)
    return [*finished.told, *numbers, finished.uplift, f"{finished.seconds:.3f}", finished.key]


def _from_row(row: Mapping[str, str]) -> Finished:
    found = {name: float(row[column] or "nan") for name, column in FIGURE_COLUMNS.items()}
    told = tuple(row[name] for name in COLUMNS[:5])
    return Finished(row["key"], told, found, float(row["uplift [N]"]), float(row["CPU [s]"]))
