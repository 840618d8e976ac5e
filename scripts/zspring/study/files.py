"""The results of a study in files that can be read while they grow and that survive an interruption."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from fmpy.model_description import ScalarVariable

from ..records import Record
from ..tables import replaced
from .workers import FAILED, OK, Result

NUMBER, STATUS = "case", "status"
TIMES = ("seconds", "CPU")  # of a result, s: never the same, so no columns

COPY_SHARE = 50  # times as long as a copy took, at least, goes by without one
COPY_EVERY = 10.0  # s, at least likewise

Row = dict[str, str]  # by column
Rows = Mapping[int, Mapping[str, str]]  # by number of the case


class StudyRecord(Record[Row]):
    """One row for each case, in the order they finished; in that of the cases after `finish`.

    parameters  columns and texts of what varies, by number of the case
    columns     of the results
    """

    def __init__(
        self, path: Path, head: Mapping[str, str], parameters: Sequence[Mapping[str, str]], columns: Sequence[str]
    ):
        self._parameters = parameters
        every = [NUMBER, STATUS, *parameters[0], *dict.fromkeys(columns)]
        super().__init__(path, head, every, lambda row: row.values(), self._checked)

    @property
    def rows(self) -> dict[int, Row]:
        """By number of the case; of those that were lost and run again the last."""
        return {int(row[NUMBER]): row for row in self.results}

    @property
    def missing(self) -> list[int]:
        """Cases without a result, those that were lost with their workers included."""
        done = {n for n, row in self.rows.items() if row[STATUS] == OK or row[STATUS].startswith(FAILED)}
        return [number for number in range(len(self._parameters)) if number not in done]

    @property
    def failed(self) -> list[tuple[int, str]]:
        """Numbers and reasons of the cases that did not come out whole."""
        return [(number, row[STATUS]) for number, row in sorted(self.rows.items()) if row[STATUS] != OK]

    def row(self, number: int, result: Result) -> Row:
        """The row of a case. It is one line, so that a reader never sees half a reason."""
        texts = {
            key: " ".join(value.split()) if isinstance(value, str) else "" if value != value else repr(value)
            for key, value in result.items()
            if key not in TIMES
        }
        return {**dict.fromkeys(self.columns, ""), NUMBER: str(number), **self._parameters[number], **texts}

    def finish(self) -> None:
        """Put the rows in the order of the cases."""
        self.write(row for _, row in sorted(self.rows.items()))

    def _checked(self, row: Mapping[str, str]) -> Row:
        if list(row) != self.columns or None in row.values() or int(row[NUMBER]) >= len(self._parameters):
            raise ValueError
        if not self._parameters[int(row[NUMBER])].items() <= row.items():  # of another case
            raise ValueError
        return dict(row)


class ParquetCopy:
    """The record as Parquet beside it, written anew from time to time: at any time a whole file.

    texts   columns that are no numbers
    """

    def __init__(self, record: StudyRecord, texts: Sequence[str]):
        self.path = record.path.with_suffix(".parquet")
        self._record, self._texts = record, texts
        self._next = time.monotonic() + COPY_EVERY

    def write(self) -> None:
        begin = time.monotonic()
        with replaced(self.path) as unfinished:
            write_parquet(unfinished, self._record.head, self._record.columns, self._record.rows, self._texts)
        end = time.monotonic()
        self._next = end + max(COPY_EVERY, COPY_SHARE * (end - begin))

    def write_if_due(self) -> None:
        if time.monotonic() >= self._next:
            self.write()


def column_of(variable: ScalarVariable) -> str:
    """Column of what varies."""
    return variable.name + ("" if variable.unit in (None, "1") else f" [{variable.unit}]")


def values(rows: Rows, name: str) -> np.ndarray:
    """A column as numbers, in the order of the cases; NaN where it is empty. Shape (rows,)."""
    return np.array([float(rows[number][name] or "nan") for number in sorted(rows)])


def write_parquet(
    path: Path, head: Mapping[str, str], columns: Sequence[str], rows: Rows, texts: Sequence[str]
) -> None:
    """All rows as Parquet, the head as the schema's metadata; columns in `texts` stay text."""
    import pyarrow
    import pyarrow.parquet

    ordered = [rows[number] for number in sorted(rows)]
    arrays = {
        name: [row[name] for row in ordered]
        if name in texts
        else pyarrow.array(values(rows, name), from_pandas=True)  # NaN is a missing value
        for name in columns
    }
    table = pyarrow.table(arrays).replace_schema_metadata(dict(head))
    pyarrow.parquet.write_table(table, path)
