"""Tables in text files: one reader for those of users and our own, one writer.

A file begins with lines of comment (#), ours with "# key: value". Then come a line of column names, NAME [UNIT],
NAME (UNIT) or, as MATLAB writes that, NAME_UNIT_, perhaps one with units alone, and the rows. Cells are separated by
commas, semicolons or tabs; where it is not commas, numbers may have a decimal comma. Capitals, underscores and blanks
in names count for nothing. Text is UTF-8, UTF-16 with its mark, or Windows-1252.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TextIO

import numpy as np

from .errors import ZSpringError
from .units import conversion, is_unit

_DECIMAL = re.compile(r"[-+]?\d*([.,])\d+(?:[eE][-+]?\d+)?|[-+]?\d+([.,])")
_IN_BRACKETS = re.compile(r"(.*?)\s*(?:\[([^\]]*)\]|\((.*)\))")
_IN_UNDERSCORES = re.compile(r"(.*?)_([^\W_]+)_")
LARGEST = 1e100  # that is read: nothing in these units is so large, and squares and products stay numbers
_CONTROL = re.compile(r"[\0-\x08\x0e-\x1f]")


def canonical(name: str) -> str:
    """A column's name without what counts for nothing in it."""
    return " ".join(name.replace("_", " ").lower().split())


def split_label(label: str) -> tuple[str, str | None]:
    """Name and unit of a column; None without a unit. Round brackets may be a part of the name."""
    found = _IN_BRACKETS.fullmatch(label.strip())
    if found and (found[3] is None or is_unit(found[3])):
        return found[1], found[2] if found[3] is None else found[3]
    if (found := _IN_UNDERSCORES.fullmatch(label.strip())) and is_unit(found[2]):
        return found[1], found[2]
    return label.strip(), None


@dataclass(frozen=True)
class Column:
    """One column as it was read, (n,) cells."""

    label: str
    name: str
    unit: str | None
    cells: Sequence[str]


@dataclass(frozen=True)
class Table:
    """Columns by canonical name, n rows with their line numbers in the file."""

    path: Path
    head: Mapping[str, str]
    columns: Mapping[str, Column]
    lines: Sequence[int]
    decimal: str

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def __getitem__(self, name: str) -> Column:
        """The column. Raises ZSpringError with those that there are."""
        if name not in self.columns:
            there = ", ".join(column.label for column in self.columns.values())
            raise ZSpringError(f"{self.path}: no column {name!r} (there are: {there})")
        return self.columns[name]

    def unit(self, name: str, example: str = "UNIT") -> str:
        """Unit of a column. Raises ZSpringError where it has none."""
        unit = self[name].unit
        if unit is None:
            raise ZSpringError(f"{self.path}: column {name!r} needs its unit, as in '{name} [{example}]'")
        return unit

    def numbers(self, name: str, *units: str, positive: bool = False, gaps: bool = False) -> np.ndarray:
        """A column (n,), in the one of these units that its own converts to; as it stands where none is named.

        gaps    an empty cell or NaN is a missing value, NaN
        Raises ZSpringError, with file and line or column, for a missing column or unit, a unit of another kind, and a
        cell that is no finite number, or not positive where it must be.
        """
        column, factor = self[name], 1.0
        if units:
            unit = self.unit(name, units[0])
            try:
                factor = conversion(unit, *units)[1]
            except ZSpringError as error:
                raise ZSpringError(f"{self.path}, column {column.name!r}: {error}") from None
        missing = ("", "nan") if gaps else ()
        values = [
            math.nan if cell.lower() in missing else self._number(column.name, line, cell)
            for line, cell in zip(self.lines, column.cells)
        ]
        for line, value in zip(self.lines, values):
            if positive and value <= 0:
                raise ZSpringError(f"{self.path}, line {line}: {column.name} = {value:g}: must be positive")
        return factor * np.array(values)

    def where(self, keep: Iterable[bool]) -> Table:
        """Only the rows for which `keep` (n,) is true."""
        kept = [i for i, kept in enumerate(keep) if kept]
        columns = {
            name: replace(column, cells=[column.cells[i] for i in kept]) for name, column in self.columns.items()
        }
        return replace(self, columns=columns, lines=[self.lines[i] for i in kept])

    def _number(self, name: str, line: int, cell: str) -> float:
        try:
            number = float(cell.replace(",", ".") if self.decimal == "," else cell)
        except ValueError:
            number = math.nan
        if not abs(number) < LARGEST:
            raise ZSpringError(f"{self.path}, line {line}: {name} = {cell!r}: must be a finite number")
        return number


def read_table(path: Path, aliases: Mapping[str, str] | None = None, skip: int = 0) -> Table:
    """The table of a file as described above.

    aliases     canonical names that stand for others
    skip        lines at the begin that are passed over
    Raises ZSpringError for a file that is no text, has no column names, two columns of one name, both decimal commas
    and points, or a row that is longer or shorter than the line of column names.
    """
    lines = enumerate(_text(path).splitlines(), 1)
    numbered = [(number, line) for number, line in lines if line.strip() and number > skip]
    content = [(number, line) for number, line in numbered if not line.startswith("#")]
    if not content:
        raise ZSpringError(f"{path}: needs a line of column names")
    separator = _separator(content[0][1])
    cells = csv.reader((line for _, line in content), delimiter=separator)
    rows = [(number, [cell.strip() for cell in row]) for (number, _), row in zip(content, cells)]
    (_, labels), *rows = rows
    for number, row in rows:
        if len(row) != len(labels):
            raise ZSpringError(f"{path}, line {number}: {len(row)} values for {len(labels)} columns")
    units: Sequence[str] = ()
    if rows and _are_units(rows[0][1], f"{path}, line {rows[0][0]}"):
        (_, units), *rows = rows
    signs = {match[1] or match[2] for _, row in rows for cell in row if (match := _DECIMAL.fullmatch(cell))}
    if len(signs) > 1:
        raise ZSpringError(f"{path}: numbers with decimal commas and with decimal points: must be one of both")
    columns: dict[str, Column] = {}
    contents = zip(*(row for _, row in rows)) if rows else [()] * len(labels)
    for place, (label, column) in enumerate(zip(labels, contents)):
        name, unit = split_label(label)
        unit = (units[place].strip("[]()") if units else "") or unit
        key = canonical(name)
        key = (aliases or {}).get(key, key)
        if not label and not any(column):  # a separator at the end of every line
            continue
        if key in columns:
            raise ZSpringError(f"{path}: two columns {name!r}")
        columns[key] = Column(label, name, unit, column)
    return Table(path, _head(line for _, line in numbered), columns, [number for number, _ in rows], "".join(signs))


def _are_units(row: Sequence[str], where: str) -> bool:
    """Whether a row below the names has their units: no number, and nothing but what units are.

    Raises ZSpringError for one that has units, no digit, and what is no unit.
    """
    texts = [cell.strip("[]()") for cell in row]
    units = [text for text in texts if any(map(str.isalpha, text)) and is_unit(text)]
    others = [text for text in texts if not is_unit(text)]
    if units and others and not any(map(str.isdigit, "".join(row))):
        raise ZSpringError(f"{where}: unit {others[0]!r} is none that is known, as {units[0]!r} beside it is")
    return bool(units) and not others


def read_head(path: Path) -> dict[str, str]:
    """The remarks `# NAME: VALUE` above a table. Raises ZSpringError for what is no text."""
    return _head(_text(path).splitlines())


def read_rows(path: Path) -> tuple[dict[str, str], list[dict[str, str]]]:
    """Head, and rows by label, of a file that TableFile wrote, without a last line that is not complete."""
    lines = [line for line in _text(path).splitlines(keepends=True) if line.endswith("\n")]
    return _head(lines), list(csv.DictReader(line for line in lines if not line.startswith("#")))


class TableFile:
    """A table under way, each row on disk at once; a context manager.

    head, columns   written by `begin`; without it, rows go to the end of a file that is there
    digits          of floats; None: as many as it takes to read the same number back
    """

    def __init__(self, path: Path, columns: Sequence[str], digits: int | None = None):
        self.path, self._columns, self._digits = path, columns, digits

    def begin(self, head: Mapping[str, str]) -> None:
        """Make the file anew, and its folder where there is none."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with open(self.path, "w", encoding="utf-8", newline="") as file:
            file.writelines(f"# {key}: {value}\n" for key, value in head.items())
            _writer(file).writerow(self._columns)

    def __enter__(self) -> TableFile:
        self._file = open(self.path, "a", encoding="utf-8", newline="")
        self._writer = _writer(self._file)
        return self

    def write(self, row: Iterable[object]) -> None:
        """Texts as they are, NaN as an empty cell."""
        self._writer.writerow([self._text(cell) for cell in row])
        self._file.flush()

    def __exit__(self, *_) -> None:
        self._file.close()

    def _text(self, cell: object) -> str:
        if not isinstance(cell, float):  # numpy's are
            return str(int(cell)) if isinstance(cell, bool) else str(cell)
        if math.isnan(cell):
            return ""
        return repr(float(cell)) if self._digits is None else f"{cell:.{self._digits}g}"


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A file beside `path` to write, which takes its place at the end; an error leaves what was there."""
    unfinished = path.with_name(f"{path.name}.new")
    try:
        yield unfinished
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def write_table(
    path: Path,
    head: Mapping[str, str],
    columns: Sequence[str],
    rows: Iterable[Iterable[object]],
    digits: int | None = 12,
) -> Path:
    """A whole table; see TableFile. The file is complete or as it was before."""
    with replaced(path) as unfinished:
        table = TableFile(unfinished, columns, digits)
        table.begin(head)
        with table:
            for row in rows:
                table.write(row)
    return path


def _writer(file: TextIO):
    return csv.writer(file, lineterminator="\n")


def _head(lines: Iterable[str]) -> dict[str, str]:
    head = {}
    for line in lines:
        if not line.startswith("#"):
            break
        key, _, value = line[1:].partition(":")
        head[key.strip()] = value.strip()
    return head


def _text(path: Path) -> str:
    data = path.read_bytes()
    try:
        encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text = "\0" if encoding == "utf-16" else data.decode("cp1252", errors="replace")
    if _CONTROL.search(text) or "\ufffd" in text:
        raise ZSpringError(f"{path}: no text in UTF-8, UTF-16 or Windows-1252")
    return text


def _separator(labels: str) -> str:
    """What separates the cells: what is between the names, outside of units and quotes."""
    bare = re.sub(r'\[[^\]]*\]|"[^"]*"', "", labels)
    return next((sign for sign in "\t;" if sign in bare), ",")
