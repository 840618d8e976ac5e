"""CSV files with "# key: value" lines at their head and units in the column names."""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TextIO

from .errors import ZSpringError


def write_head(file: TextIO, head: Mapping[str, str], columns: Sequence[str]) -> None:
    """Lines "# key: value", then the names of the columns."""
    file.writelines(f"# {key}: {value}\n" for key, value in head.items())
    csv.writer(file, lineterminator="\n").writerow(columns)


def read_head(path: Path) -> dict[str, str]:
    """Values by key of the lines "# key: value" at the head of a file."""
    with open(path, encoding="utf-8") as file:
        lines = [line[1:].partition(":") for line in itertools.takewhile(lambda line: line[0] == "#", file)]
    return {key.strip(): value.strip() for key, _, value in lines}


def read_table(path: Path) -> tuple[dict[str, str], list[dict[str, str]]]:
    """Head, and rows by column name, of a CSV file, without a last line that was not written to its end."""
    with open(path, encoding="utf-8", newline="") as file:
        lines = [line for line in file if line.endswith("\n") and not line.startswith("#")]
    return read_head(path), list(csv.DictReader(lines))


def read_rows(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Column names, and rows with their line numbers, of a CSV file that a user made.

    Blank lines, and lines that begin with #, are skipped. Raises ZSpringError for a file that is no text, and
    for a row that is longer or shorter than the line of column names.
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            numbered = [(number, line) for number, line in enumerate(file, 1) if line.strip() and line[0] != "#"]
    except UnicodeDecodeError:
        raise ZSpringError(f"{path}: no text in UTF-8") from None
    rows = [
        (number, [cell.strip() for cell in row])
        for (number, _), row in zip(numbered, csv.reader(line for _, line in numbered))
    ]
    if not rows:
        raise ZSpringError(f"{path}: needs a line of column names")
    (_, columns), *rows = rows
    for number, row in rows:
        if len(row) != len(columns):
            raise ZSpringError(f"{path}, line {number}: {len(row)} values for {len(columns)} columns")
    return columns, rows


def split_label(label: str) -> tuple[str, str | None]:
    """Name and unit of a column "NAME [UNIT]"; None without a unit."""
    return re.fullmatch(r"([^\[]*?)\s*(?:\[(.*)\])?", label).groups()


def finite_number(path: Path, line: int, name: str, cell: str) -> float:
    """The number in a cell. Raises ZSpringError with file, line and column unless it is finite."""
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ZSpringError(f"{path}, line {line}: {name} = {cell!r}: must be a finite number")
    return number
