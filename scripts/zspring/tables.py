"""CSV files with "# key: value" lines at their head and units in the column names."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TextIO


def write_head(file: TextIO, head: Mapping[str, str], columns: Sequence[str]) -> None:
    """Lines "# key: value", then the names of the columns."""
    file.writelines(f"# {key}: {value}\n" for key, value in head.items())
    csv.writer(file, lineterminator="\n").writerow(columns)


def read_table(path: Path) -> tuple[dict[str, str], list[dict[str, str]]]:
    """Head, and rows by column name, of a CSV file, without a last line that was not written to its end."""
    head, lines = {}, []
    with open(path, encoding="utf-8", newline="") as file:
        for line in file:
            if line.startswith("#"):
                key, _, value = line[1:].partition(":")
                head[key.strip()] = value.strip()
            elif line.endswith("\n"):
                lines.append(line)
    return head, list(csv.DictReader(lines))
