"""Files of an FRF: the finished CSV, and the record of a measurement under way."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..bench.measure import FrfPoint, Sweep
from ..bench.responses import QUANTITIES, as_quantity, phase_degrees
from ..tables import read_table, write_head


def frf_columns(quantity: str) -> list[str]:
    """Column names of an FRF file."""
    return [
        "frequency [Hz]",
        "amplitude [m/s2]",
        "displacement [m]",
        "H_re [m/N]",
        "H_im [m/N]",
        f"magnitude [{QUANTITIES[quantity]}]",
        "phase [deg]",
        "periods",
        "change",
        "status",
        "steps",
        "iterations",
        "refinements",
        "iterations_max",
    ]


def frf_row(point: FrfPoint, quantity: str) -> list[str]:
    """The point's values in the order of `frf_columns`, exact; empty where nothing was measured."""
    value = as_quantity(point.H, quantity)
    numbers = [
        point.frequency,
        point.amplitude,
        point.displacement,
        point.H.real,
        point.H.imag,
        abs(value),
        float(phase_degrees(value, quantity)),
        point.periods,
        point.change,
    ]
    counts = [point.steps, point.iterations, point.refinements, point.iterations_max]
    return [*("" if math.isnan(number) else repr(number) for number in numbers), point.status, *map(str, counts)]


def frf_point(row: Mapping[str, str]) -> FrfPoint:
    """The point of a row, by column name."""

    def number(column: str) -> float:
        return float(row[column] or "nan")

    return FrfPoint(
        amplitude=number("amplitude [m/s2]"),
        frequency=number("frequency [Hz]"),
        status=row["status"],
        H=complex(number("H_re [m/N]"), number("H_im [m/N]")),
        periods=int(row["periods"]),
        change=number("change"),
        steps=int(row["steps"]),
        iterations=int(row["iterations"]),
        refinements=int(row["refinements"]),
        iterations_max=int(row["iterations_max"]),
    )


class FrfRecord:
    """Points of a measurement under way in a CSV that survives an interruption at any moment.

    Each row has the bench's state after the point, so that a continued sweep gives the same bits as one that
    was never interrupted.

    path        of the file
    head        all settings; a file with another head (but for the date) is stale and begun anew, and so
                is one that cannot be read
    """

    def __init__(self, path: Path, head: Mapping[str, str], quantity: str):
        self.path, self._head, self._quantity = path, dict(head), quantity
        self._rows: dict[tuple[float, float], list[str]] = {}
        self._states: dict[tuple[float, float], dict[str, Any] | None] = {}
        self.points: dict[tuple[float, float], FrfPoint] = {}
        self.is_stale = False
        if path.exists():
            try:
                self._read()
            except (KeyError, TypeError, ValueError):  # somebody changed the file
                self.is_stale = True

    def remaining(self, sweeps: Iterable[Sweep]) -> list[Sweep]:
        """What is still to be measured of these sweeps, each from the state after its last point so far."""
        rest = []
        for sweep in sweeps:
            keys = [(sweep.amplitude, frequency) for frequency in sweep.frequencies]
            done = next((i for i, key in enumerate(keys) if key not in self.points), len(keys))
            if done < len(keys):
                state = self._states[keys[done - 1]] if done else None
                rest.append(Sweep(sweep.amplitude, sweep.frequencies[done:], state))
        return rest

    def __enter__(self) -> FrfRecord:
        """Open for `append`, keeping what was found."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        fresh = self.path.with_suffix(".new")
        with open(fresh, "w", encoding="utf-8", newline="") as file:
            write_head(file, self._head, [*frf_columns(self._quantity), "state"])
            csv.writer(file, lineterminator="\n").writerows(self._rows.values())
        os.replace(fresh, self.path)
        self._file = open(self.path, "a", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file, lineterminator="\n")
        return self

    def append(self, point: FrfPoint, state: dict[str, Any] | None) -> None:
        """Keep a finished point, on disk at once."""
        self._writer.writerow(self._keep(point, state))
        self._file.flush()

    def __exit__(self, *_) -> None:
        self._file.close()

    def _read(self) -> None:
        head, rows = read_table(self.path)
        self.is_stale = {**head, "date": ""} != {**self._head, "date": ""}
        if not self.is_stale:
            kept = [(frf_point(row), json.loads(row["state"])) for row in rows]
            for point, state in kept:
                self._keep(point, state)

    def _keep(self, point: FrfPoint, state: dict[str, Any] | None) -> list[str]:
        key = (point.amplitude, point.frequency)
        self.points[key], self._states[key] = point, state
        self._rows[key] = [*frf_row(point, self._quantity), json.dumps(state)]
        return self._rows[key]


def write_frf(
    path: Path,
    head: Mapping[str, str],
    points: Sequence[FrfPoint],
    quantity: str,
    errors: Mapping[tuple[float, float], float] | None = None,
) -> None:
    """The finished FRF file; `errors` are relative error estimates by (amplitude, frequency)."""
    columns, rows = frf_columns(quantity), [frf_row(point, quantity) for point in points]
    if errors:
        columns.append("error_estimate")
        for row, point in zip(rows, points):
            error = errors.get((point.amplitude, point.frequency), math.nan)
            row.append("" if math.isnan(error) else repr(error))
    with open(path, "w", encoding="utf-8", newline="") as file:
        write_head(file, head, columns)
        csv.writer(file, lineterminator="\n").writerows(rows)
