"""What a study says: envelope of the receptance, spread and Sobol indices of the scalar results."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..tables import write_table
from ..text_tables import aligned
from .coupled import REMARKS
from .design import unit_problem
from .evaluations import FrfQuantity, column
from .files import STATUS, Rows, values
from .settings import StudySettings
from .workers import OK

PERCENTILES = (0, 5, 50, 95, 100)
NEGLIGIBLE = 0.05  # of a Sobol index


@dataclass(frozen=True)
class Envelope:
    """Of |H| over all cases, at one amplitude."""

    amplitude: float  # m/s2
    frequency: np.ndarray  # (n,) in Hz
    percentiles: np.ndarray  # (len(PERCENTILES), n) in m/N; NaN where no case has a value


@dataclass(frozen=True)
class SobolIndices:
    """Sobol indices of one scalar result, with the half width of their 95 % confidence intervals."""

    column: str
    first: np.ndarray  # (parameters,) first order
    first_confidence: np.ndarray
    total: np.ndarray
    total_confidence: np.ndarray


def envelopes(quantity: FrfQuantity, rows: Rows) -> list[Envelope]:
    """One envelope for each amplitude."""
    found = []
    for amplitude in dict.fromkeys(amplitude for amplitude, _ in quantity.points):
        frequency = np.array(sorted(f for a, f in quantity.points if a == amplitude))
        magnitude = np.array(
            [np.hypot(*(values(rows, column(part, amplitude, f)) for part in ("H_re", "H_im"))) for f in frequency]
        )
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "All-NaN slice", RuntimeWarning)
            percentiles = np.nanpercentile(magnitude, PERCENTILES, axis=1)
        found.append(Envelope(amplitude, frequency, percentiles))
    return found


def spread_table(scalars: Sequence[str], rows: Rows) -> list[str]:
    """Lines with smallest, median and largest value of each scalar result, and how many cases have one."""
    table = [["", "min", "median", "max", "cases"]]
    for name in scalars:
        numbers = values(rows, name)
        numbers = numbers[np.isfinite(numbers)]
        if numbers.size:
            table.append([name, *(f"{n:.5g}" for n in np.percentile(numbers, (0, 50, 100))), str(numbers.size)])
        else:
            table.append([name, "no case has a value"])
    return aligned(table, right=True)


def sobol_indices(settings: StudySettings, scalars: Sequence[str], rows: Rows) -> list[SobolIndices]:
    """Indices of each scalar result that varies (Saltelli et al. 2010, by SALib).

    The estimators need all cases of a block, so a block with a case without value is left out.
    """
    from SALib.analyze import sobol  # slow to load

    names, found = list(settings.vary), []
    for name in scalars:
        blocks = values(rows, name).reshape(-1, len(names) + 2)
        blocks = blocks[np.isfinite(blocks).all(axis=1)]
        if len(blocks) < 2 or np.ptp(blocks) == 0:
            continue
        indices = sobol.analyze(unit_problem(names), blocks.ravel(), calc_second_order=False, seed=settings.seed)
        found.append(SobolIndices(name, *(indices[key] for key in ("S1", "S1_conf", "ST", "ST_conf"))))
    return found


def incomplete_blocks(settings: StudySettings, rows: Rows) -> int:
    """Blocks of a Sobol design with a case that is not whole."""
    whole = np.array([rows[number][STATUS] == OK for number in sorted(rows)])
    return int((~whole.reshape(-1, len(settings.vary) + 2).all(axis=1)).sum())


def sobol_table(settings: StudySettings, found: Sequence[SobolIndices]) -> list[str]:
    """Lines with first and total order index and their 95 % confidence by result and parameter."""
    rows = [["first / total order", *settings.vary]]
    for i in found:
        numbers = zip(i.first, i.first_confidence, i.total, i.total_confidence)
        rows.append([i.column, *(f"{a:.2f} ± {b:.2f} / {c:.2f} ± {d:.2f}" for a, b, c, d in numbers)])
    return aligned(rows, right=True)


def sobol_doubts(found: Sequence[SobolIndices]) -> list[str]:
    """A line if indices are less than their uncertainty; those that are 0 within NEGLIGIBLE do not count."""
    index = np.concatenate([np.concatenate([i.first, i.total]) for i in found])
    half_width = np.concatenate([np.concatenate([i.first_confidence, i.total_confidence]) for i in found])
    wide = int(np.sum(half_width > np.maximum(np.abs(index), NEGLIGIBLE)))
    if not wide:
        return []
    return [f"{wide} of {index.size} Sobol indices are smaller than their 95 % confidence: they need more samples"]


def write_sobol(path: Path, head: Mapping[str, str], settings: StudySettings, found: Sequence[SobolIndices]) -> None:
    """Indices and confidence intervals as CSV, one row for each result and parameter."""
    rows = [
        [indices.column, name, *numbers]
        for indices in found
        for name, *numbers in zip(
            settings.vary, indices.first, indices.first_confidence, indices.total, indices.total_confidence
        )
    ]
    columns = ["result", "parameter", "first order", "confidence", "total order", "confidence of total"]
    write_table(path, {**head, "confidence": "half width of the 95 % interval"}, columns, rows, digits=6)


def remarks(rows: Rows) -> list[str]:
    """Lines with what results must not be read without, the first of those alike, and of how many cases."""
    found: dict[str, list[str]] = {}  # alike but for their numbers
    for row in rows.values():
        if remark := row.get(REMARKS):
            found.setdefault(re.sub(r"\d+(\.\d+)?", "", remark), []).append(remark)
    return [f"1 case: {alike[0]}" if len(alike) == 1 else f"{len(alike)} cases: {alike[0]}" for alike in found.values()]
