"""How values go with the parameters of a sampled study: rank correlations with their intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..tables import write_table
from ..text_tables import aligned
from .files import Rows, column_of, values
from .report import NEGLIGIBLE
from .settings import StudySettings

LEAST = 5  # cases, that a correlation tells anything of
QUANTILE = 1.959964  # of the normal distribution, of a 95 % interval


@dataclass(frozen=True)
class Correlation:
    """Spearman's rank correlation of one value with each parameter, and the ends of its 95 % interval.

    samples             that have the value
    value, low, high    (parameters,)
    """

    column: str
    samples: int
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray


def parameters_of(settings: StudySettings, rows: Rows) -> list[str]:
    """Real parameters that have more than two values."""
    reals = [name for name in settings.vary if settings.variables[name].type == "Real"]
    return [name for name in reals if len(set(values(rows, column_of(settings.variables[name])))) > 2]


def correlations(
    settings: StudySettings, parameters: Sequence[str], columns: Sequence[str], rows: Rows
) -> list[Correlation]:
    """Of each column that varies, over the cases that have it.

    An item of a list is one sample, with the mean of the value over its lines; one that lacks a line does not count.
    Intervals by Fisher's transform with the variance of Bonett, Wright, Psychometrika 65 (2000).
    """
    from scipy.stats import rankdata  # slow to load

    found = []
    alike = settings.lines if settings.design == "list" and settings.lines else 1
    copies = alike * max(1, len(settings.compared))
    items: dict[int, dict[int, Mapping[str, str]]] = {}
    for number, row in sorted(rows.items()):
        items.setdefault(number // copies, {})[number] = row
    whole_items = [own for own in items.values() if len(own) == alike]

    def of_items(column: str) -> np.ndarray:
        return np.array([values(own, column).mean() for own in whole_items])

    given = np.array([of_items(column_of(settings.variables[name])) for name in parameters])
    for column in columns:
        figure = of_items(column)
        whole = np.isfinite(figure)
        if whole.sum() < LEAST or np.ptp(figure[whole]) == 0:
            continue
        ranks = rankdata(np.vstack([figure[whole], given[:, whole]]), axis=1)
        value = np.corrcoef(ranks)[0, 1:]
        half = QUANTILE * np.sqrt((1 + value**2 / 2) / (whole.sum() - 3))
        at = np.arctanh(np.clip(value, -1 + 1e-12, 1 - 1e-12))
        low, high = np.tanh(at - half), np.tanh(at + half)
        found.append(Correlation(column, int(whole.sum()), value, np.minimum(low, value), np.maximum(high, value)))
    return found


def correlation_table(parameters: Sequence[str], found: Sequence[Correlation]) -> list[str]:
    """Lines by value and parameter."""
    rows = [["rank correlation", *parameters]]
    for each in found:
        rows.append([each.column, *(f"{v:+.2f} ({a:+.2f} .. {b:+.2f})" for v, a, b in _each(each))])
    return aligned(rows, right=True)


def correlation_doubts(found: Sequence[Correlation]) -> list[str]:
    """A line if correlations are less than half of their intervals; those that are 0 within NEGLIGIBLE do not count."""
    every = np.array([triple for each in found for triple in _each(each)])
    wide = int(np.sum((every[:, 2] - every[:, 1]) / 2 > np.maximum(np.abs(every[:, 0]), NEGLIGIBLE)))
    if not wide:
        return []
    return [f"{wide} of {len(every)} rank correlations are smaller than their uncertainty: they need more samples"]


def write_correlations(
    path: Path, head: Mapping[str, str], parameters: Sequence[str], found: Mapping[str, Sequence[Correlation]]
) -> None:
    """One row for each of the compared, value and parameter."""
    rows = [
        [name, each.column, parameter, *triple, each.samples]
        for name, correlations in found.items()
        for each in correlations
        for parameter, triple in zip(parameters, _each(each))
    ]
    columns = ["compare", "result", "parameter", "rank correlation", "low", "high", "samples"]
    write_table(path, {**head, "low, high": "ends of the 95 % interval"}, columns, rows, digits=6)


def _each(correlation: Correlation) -> list[tuple[float, float, float]]:
    return list(zip(correlation.value.tolist(), correlation.low.tolist(), correlation.high.tolist()))
