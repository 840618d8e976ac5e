"""Files of an FRF: the finished CSV, and the record of a measurement under way."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ..bench.points import FrfPoint, Kept, Sweep
from ..bench.responses import HARMONICS, QUANTITIES, as_quantity, phase_degrees
from ..records import Record
from ..tables import write_table
from ..variables import exact
from .backbone import PhaseResonance, Row

_HARMONICS = [f"harmonic_{n} [N]" for n in HARMONICS]


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
        "remaining",
        *_HARMONICS,
        "loss [J]",
        "stiffness [N/m]",
        "damping [N.s/m]",
        "force [N]",
        "level",
    ]


def frf_row(point: FrfPoint, quantity: str) -> list[object]:
    """The point's values in the order of `frf_columns`; NaN where nothing was measured."""
    value = as_quantity(point.H, quantity, point.frequency)
    return [
        *(point.frequency, point.amplitude, point.displacement, point.H.real, point.H.imag),
        *(abs(value), float(phase_degrees(value, quantity)), point.periods, point.change, point.status),
        *(point.steps, point.iterations, point.refinements, point.iterations_max),
        *(point.remaining, *point.harmonics, point.loss, point.stiffness, point.damping),
        *(point.force, f"{exact(point.level)} {point.unit}"),
    ]


def frf_point(row: Mapping[str, str]) -> FrfPoint:
    """The point of a row, by column name."""

    def number(column: str) -> float:
        return float(row[column] or "nan")

    level, unit = row["level"].split()
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
        remaining=number("remaining"),
        harmonics=tuple(map(number, _HARMONICS)),
        loss=number("loss [J]"),
        level=float(level),
        unit=unit,
    )


def frf_record(path: Path, head: Mapping[str, str], quantity: str) -> Record[Kept]:
    """Points of a measurement under way, with the bench's states.

    So a continued sweep gives the same bits as one that was never interrupted.
    """
    return Record(
        path,
        head,
        [*frf_columns(quantity), "state"],
        lambda kept: [*frf_row(kept[0], quantity), json.dumps(kept[1])],
        lambda row: (frf_point(row), json.loads(row["state"])),
    )


def remaining(record: Record[Kept], sweeps: Iterable[Sweep]) -> list[Sweep]:
    """What is still to be measured of these sweeps, each from the state after its last point so far."""
    states = {point.place: state for point, state in record.results}
    rest = []
    for sweep in sweeps:
        keys = [(sweep.level, frequency) for frequency in sweep.frequencies]
        done = next((i for i, key in enumerate(keys) if key not in states), len(keys))
        if done < len(keys):
            rest.append(Sweep(sweep.level, sweep.frequencies[done:], states[keys[done - 1]] if done else None))
    return rest


def write_frf(
    path: Path,
    head: Mapping[str, str],
    points: Sequence[FrfPoint],
    quantity: str,
    errors: Mapping[tuple[float, float], float] | None = None,
) -> Path:
    """The finished FRF file; `errors` are relative error estimates by level and frequency."""
    columns, rows = frf_columns(quantity), [frf_row(point, quantity) for point in points]
    if errors:
        columns.append("error_estimate")
        rows = [[*row, errors.get(point.place, math.nan)] for row, point in zip(rows, points)]
    return write_table(path, head, columns, rows, digits=None)


def write_resonances(path: Path, head: Mapping[str, str], rows: Iterable[Row]) -> Path:
    """Extremes of the receptance, and the resonances by phase that belong to them; no errors where they are exact."""
    quantities = ["frequency [Hz]", "frequency_error [Hz]", "magnitude [m/N]", "magnitude_error [m/N]"]
    by_phase = ["phase_frequency [Hz]", "phase_frequency_error [Hz]", "phase_magnitude [m/N]"]
    cells = []
    for row in rows:
        for i, e in enumerate(row.extremes):
            found = row.by_phase(i) or PhaseResonance(math.nan, math.nan, math.nan)
            cells.append(
                [
                    *(row.curve, row.direction, "resonance" if e.is_resonance else "antiresonance"),
                    *(e.frequency, e.frequency_error or math.nan, e.magnitude, e.magnitude_error or math.nan, e.doubt),
                    *(row.displacement(e), found.frequency, found.frequency_error or math.nan, found.magnitude),
                ]
            )
    columns = ["curve", "direction", "kind", *quantities, "doubt", "displacement [m]", *by_phase]
    return write_table(path, head, columns, cells)
