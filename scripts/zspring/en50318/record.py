"""The figures of all runs in one CSV, which survives an interruption at any moment."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..line.statistics import FIGURES, Statistics
from ..tables import read_table, write_head
from .plan import Run
from .workers import Finished

FIGURE_COLUMNS = {name: f"{name} [{unit}]" if unit else name for name, (_, unit, _) in FIGURES.items()}
COLUMNS = ["group", "of", "label", "speed [km/h]", "section", *FIGURE_COLUMNS.values(), "CPU [s]", "key"]


class Record:
    """Figures by run; a context manager that keeps its file open for `append`.

    path    of the file; series of the runs that keep theirs are in files beside it
    head    FMUs and filter; a file with another head is stale and begun anew, and so is one that cannot be read
    """

    def __init__(self, path: Path, head: Mapping[str, str], runs: Sequence[Run]):
        self.path, self._head, self._runs = path, dict(head), list(runs)
        self._rows: dict[str, list[str]] = {}
        self.found: dict[str, Statistics] = {}  # by key of the run
        self.is_stale = False
        if path.exists():
            try:
                self._read()
            except (KeyError, TypeError, ValueError):  # somebody changed the file
                self.is_stale, self.found, self._rows = True, {}, {}

    @property
    def missing(self) -> list[Run]:
        """Runs whose figures or series are not there."""
        return [run for run in self._runs if run.key not in self.found or not self._has_series(run)]

    def __enter__(self) -> Record:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._write()
        self._file = open(self.path, "a", encoding="utf-8", newline="")
        return self

    def append(self, finished: Finished) -> None:
        """Keep the figures of a run, on disk at once."""
        row = self._keep(finished.run, finished.statistics, finished.seconds)
        csv.writer(self._file, lineterminator="\n").writerow(row)
        self._file.flush()

    def __exit__(self, *_) -> None:
        """Close the file, its rows in the order of the runs."""
        self._file.close()
        self._write()

    def _has_series(self, run: Run) -> bool:
        return not run.series or (self.path.parent / run.series).exists()

    def _keep(self, run: Run, found: Statistics, seconds: float) -> list[str]:
        self.found[run.key] = found
        named = [run.group, run.of, run.label, repr(run.speed), str(run.section)]
        numbers = [repr(float(found[name])) for name in FIGURES]
        self._rows[run.key] = [*named, *numbers, f"{seconds:.3f}", run.key]
        return self._rows[run.key]

    def _write(self) -> None:
        fresh = self.path.with_suffix(".new")
        rows = [self._rows[run.key] for run in self._runs if run.key in self._rows]
        with open(fresh, "w", encoding="utf-8", newline="") as file:
            write_head(file, self._head, COLUMNS)
            csv.writer(file, lineterminator="\n").writerows(rows)
        os.replace(fresh, self.path)

    def _read(self) -> None:
        head, rows = read_table(self.path)
        self.is_stale = head != self._head
        by_key = {run.key: run for run in self._runs}
        for row in [] if self.is_stale else rows:
            if row["key"] in by_key:
                found = {name: float(row[column]) for name, column in FIGURE_COLUMNS.items()}
                self._keep(by_key[row["key"]], found, float(row["CPU [s]"]))
