"""The values of all runs in one CSV, which survives an interruption at any moment."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path

from ..errors import ZSpringError
from ..line.quantities import FIGURES
from ..records import Record
from ..tables import read_head
from .plan import Run
from .workers import OF_RUN, Finished

FIGURE_COLUMNS = {name: f"{name} [{unit}]" if unit else name for name, (_, unit, _) in FIGURES.items()}
SPANS = 4  # of a section at most, of which the values by span are kept
BY_SPAN = ("standard_deviation", "standard_deviation_5_20", "actual_minimum", "loss_of_contact")
SPAN_COLUMNS = {
    (name, n): f"span {n + 1} of the section: {FIGURE_COLUMNS[name]}" for n in range(SPANS) for name in BY_SPAN
}
COLUMNS = [
    "group",
    "of",
    "label",
    "speed [km/h]",
    "section",
    *FIGURE_COLUMNS.values(),
    *SPAN_COLUMNS.values(),
    "uplift [N]",
    *(f"trailing: {column}" for column in FIGURE_COLUMNS.values()),
    "trailing: uplift [N]",
    "CPU [s]",
    "key",
]


def run_record(path: Path, head: Mapping[str, str]) -> Record[Finished]:
    """Figures by run, those of other plans included; series of the runs that keep theirs are in files beside it."""
    return Record(path, head, COLUMNS, _to_row, _from_row)


def missing(record: Record[Finished], runs: Iterable[Run]) -> list[Run]:
    """Runs whose values or series are not there. Raises ZSpringError where two would write one file.

    A series of that name may be another run's: of other settings, or of another line or pantograph under its name.
    """
    folder, found = record.path.parent, {finished.key for finished in record.results}
    runs, files = list(runs), dict[str, Run]()
    for run in runs:
        if run.series and files.setdefault(run.series, run).key != run.key:
            first = files[run.series]
            raise ZSpringError(
                f"{first.label!r} and {run.label!r} of {run.of} would both be {run.series}: name them otherwise"
            )
    return [run for run in runs if run.key not in found or (run.series and not _is_of(folder / run.series, run))]


def _is_of(series: Path, run: Run) -> bool:
    """Whether the file is there, and the run's."""
    return series.exists() and read_head(series).get(OF_RUN) == run.key


def put_in_order(record: Record[Finished], runs: Iterable[Run]) -> None:
    """Write the results in the order of the runs, then those of other plans."""
    found = {finished.key: finished for finished in record.results}
    first = [run.key for run in runs if run.key in found]
    record.write(found[key] for key in dict.fromkeys([*first, *found]))


def _to_row(finished: Finished) -> list[object]:
    numbers = (float(finished.statistics[name]) for name in FIGURES)
    spans = (finished.by_span[n][name] if n < len(finished.by_span) else math.nan for name, n in SPAN_COLUMNS)
    trailing = (finished.trailing[name] if finished.trailing else math.nan for name in FIGURES)
    uplifts = finished.uplift, *trailing, finished.trailing_uplift
    return [*finished.told, *numbers, *spans, *uplifts, f"{finished.seconds:.3f}", finished.key]


def _from_row(row: Mapping[str, str]) -> Finished:
    found = {name: float(row[column] or "nan") for name, column in FIGURE_COLUMNS.items()}
    spans = ({name: float(row[SPAN_COLUMNS[name, n]] or "nan") for name in BY_SPAN} for n in range(SPANS))
    by_span = tuple(span for span in spans if not math.isnan(span[BY_SPAN[0]]))
    told = tuple(row[name] for name in COLUMNS[:5])
    trailing = {name: float(row[f"trailing: {column}"] or "nan") for name, column in FIGURE_COLUMNS.items()}
    uplifts = [float(row[f"{whose}uplift [N]"] or "nan") for whose in ("", "trailing: ")]
    second = None if math.isnan(uplifts[1]) else trailing
    return Finished(row["key"], told, found, by_span, uplifts[0], float(row["CPU [s]"]), second, uplifts[1])
