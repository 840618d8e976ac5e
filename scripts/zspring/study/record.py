"""The results of a study in one CSV that can be read while it grows and that survives an interruption."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import ZSpringError
from ..tables import read_table, write_head
from .workers import FAILED, OK, Result

NUMBER, STATUS, SECONDS = "case", "status", "seconds"


class StudyRecord:
    """One row for each case, in the order they finished; in that of the cases after `finish`.

    path        of the file
    head        all settings; a file with another head (but for the date) is not touched
    parameters  columns and texts of what varies, by number of the case
    columns     of the results
    Raises ZSpringError if the file there is of another study.
    """

    def __init__(
        self, path: Path, head: Mapping[str, str], parameters: Sequence[Mapping[str, str]], columns: Sequence[str]
    ):
        self.path, self.head, self._parameters = path, dict(head), parameters
        self.columns = [NUMBER, STATUS, SECONDS, *parameters[0], *dict.fromkeys(columns)]
        self.rows: dict[int, dict[str, str]] = {}
        if path.exists():
            self._read()

    @property
    def missing(self) -> list[int]:
        """Cases without a result, those that were lost with their workers included."""
        return [number for number in range(len(self._parameters)) if not self._is_done(number)]

    @property
    def failed(self) -> list[tuple[int, str]]:
        """Numbers and reasons of the cases that did not come out whole."""
        return [(number, row[STATUS]) for number, row in sorted(self.rows.items()) if row[STATUS] != OK]

    def __enter__(self) -> StudyRecord:
        """Open for `append`, keeping what was found."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._write_anew()
        self._file = open(self.path, "a", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        return self

    def append(self, number: int, result: Result) -> None:
        """Keep a result, on disk at once."""
        # One case is one line, so that a reader never sees half a reason.
        texts = {
            key: " ".join(value.split()) if isinstance(value, str) else "" if value != value else repr(value)
            for key, value in result.items()
        }
        row = dict.fromkeys(self.columns, "")
        row |= {NUMBER: str(number), **self._parameters[number], **texts}
        self.rows[number] = row
        self._writer.writerow(row.values())
        self._file.flush()

    def __exit__(self, *_) -> None:
        self._file.close()

    def finish(self) -> None:
        """Put the rows in the order of the cases."""
        self.rows = dict(sorted(self.rows.items()))
        self._write_anew()

    def _is_done(self, number: int) -> bool:
        status = self.rows[number][STATUS] if number in self.rows else ""
        return status == OK or status.startswith(FAILED)

    def _write_anew(self) -> None:
        fresh = self.path.with_suffix(".new")
        with open(fresh, "w", encoding="utf-8", newline="") as file:
            write_head(file, self.head, self.columns)
            csv.writer(file, lineterminator="\n").writerows(row.values() for row in self.rows.values())
        os.replace(fresh, self.path)

    def _read(self) -> None:
        head, rows = read_table(self.path)
        for key in (key for key in [*self.head, *head] if key != "date"):
            there, here = head.get(key), self.head.get(key, "").strip()
            if there != here:
                raise ZSpringError(
                    f"{self.path} is of another study ({key}: {there or 'none'}, now {here or 'none'}): "
                    "remove it, or give another --output"
                )
        for line, row in enumerate(rows, 1):
            number = row.get(NUMBER) or ""
            if (
                list(row) != self.columns
                or None in row.values()
                or not number.isdigit()
                or (int(number) >= len(self._parameters))
            ):
                raise ZSpringError(f"{self.path}, row {line} of the table: is not as it was written; remove the file")
            self.rows[int(number)] = row
