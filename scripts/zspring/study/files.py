"""The results of a study in one CSV that can be read while it grows and that survives an interruption."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ..records import Record
from .workers import FAILED, OK, Result

NUMBER, STATUS, SECONDS = "case", "status", "seconds"

Row = dict[str, str]  # by column


class StudyRecord(Record[Row]):
    """One row for each case, in the order they finished; in that of the cases after `finish`.

    parameters  columns and texts of what varies, by number of the case
    columns     of the results
    """

    def __init__(
        self, path: Path, head: Mapping[str, str], parameters: Sequence[Mapping[str, str]], columns: Sequence[str]
    ):
        self._parameters = parameters
        every = [NUMBER, STATUS, SECONDS, *parameters[0], *dict.fromkeys(columns)]
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
        }
        return {**dict.fromkeys(self.columns, ""), NUMBER: str(number), **self._parameters[number], **texts}

    def finish(self) -> None:
        """Put the rows in the order of the cases."""
        self.write(row for _, row in sorted(self.rows.items()))

    def _checked(self, row: Mapping[str, str]) -> Row:
        if list(row) != self.columns or None in row.values() or int(row[NUMBER]) >= len(self._parameters):
            raise ValueError
        return dict(row)
