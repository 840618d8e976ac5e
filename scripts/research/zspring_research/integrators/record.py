"""Runs of a study under way in a CSV file that survives an interruption at any moment."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

from zspring.tables import read_table, write_head

from .measure import COLUMNS, Result, Variant, from_row, to_row


class Record:
    """All runs so far, one a row; a context manager that keeps its file open for `append`.

    path        of the file
    head        all settings; a file with another head is stale and begun anew, and so is one that cannot
                be read
    """

    def __init__(self, path: Path, head: Mapping[str, str]):
        self.path, self._head = path, dict(head)
        self.runs: dict[Variant, list[Result]] = {}
        self.is_stale = False
        if path.exists():
            try:
                found, rows = read_table(path)
                self.is_stale = found != self._head
                for variant, result in [] if self.is_stale else map(from_row, rows):
                    self.runs.setdefault(variant, []).append(result)
            except (KeyError, TypeError, ValueError):  # somebody changed the file
                self.is_stale, self.runs = True, {}

    def best(self, variant: Variant) -> Result:
        """The variant's fastest run."""
        return min(self.runs[variant], key=lambda run: run.seconds)

    def __enter__(self) -> Record:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        rows = [to_row(variant, run) for variant, runs in self.runs.items() for run in runs]
        write_runs(self.path, self._head, rows)
        self._file = open(self.path, "a", encoding="utf-8", newline="")
        return self

    def append(self, variant: Variant, result: Result) -> None:
        """Keep a run, on disk at once."""
        self.runs.setdefault(variant, []).append(result)
        csv.writer(self._file, lineterminator="\n").writerow(to_row(variant, result).values())
        self._file.flush()

    def __exit__(self, *_) -> None:
        self._file.close()


def write_runs(path: Path, head: Mapping[str, str], rows: Iterable[Mapping[str, str]]) -> None:
    """A CSV file of rows as `to_row` makes them."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        write_head(file, head, list(COLUMNS.values()))
        csv.writer(file, lineterminator="\n").writerows(row.values() for row in rows)
