"""The figures of a study over a line. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..figures import new_figure
from ..line.quantities import described
from ..variables import Value
from .compare import COUNT, NO_INTERVALS, SPEED, Difference, Runner, condition_texts, conditions, has_intervals, runners
from .coupled import CoupledQuantity
from .design import Case
from .files import Rows, values
from .sensitivity import Correlation
from .settings import COMPARED, StudySettings

COLUMNS = 3  # of panels
PERCENTILES = (5, 50, 95)


def distribution_figure(quantity: CoupledQuantity, compared: Mapping[str, Rows], title: str) -> Figure:
    """Of each value that varies, the share of cases up to a value, of each of the compared and each pantograph."""
    every = [rows for rows in compared.values() if rows]
    names = [
        name
        for name in quantity.figures
        if any(_varies(values(rows, quantity.column(name, i))) for rows in every for i in range(quantity.pantographs))
    ] or list(quantity.figures)
    count = min(COLUMNS, len(names))
    rows_of_panels = -(-len(names) // count)
    figure = new_figure(3.6 * count, 2.5 * rows_of_panels + 0.9)
    panels = figure.subplots(rows_of_panels, count, sharey=True, squeeze=False)
    for axes, name in zip(panels.flat, names):
        for k, (label, rows) in enumerate(compared.items()):
            for i in range(quantity.pantographs):
                found = values(rows, quantity.column(name, i))
                if found.size and np.isfinite(found).any():
                    who = f"pantograph {i + 1}" if quantity.pantographs > 1 else ""
                    style = {"color": f"C{k}", "linestyle": ("-", "--")[i], "linewidth": 1.2}
                    axes.ecdf(found[np.isfinite(found)], label=", ".join(filter(None, (label, who))) or None, **style)
        shown, unit, _ = described(name)
        axes.set_xlabel(f"{shown}  [{unit or 1}]", fontsize=8)
        axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.ticklabel_format(axis="x", useOffset=False)
        axes.tick_params(labelsize=8)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    for axes in panels.flat[len(names) :]:
        axes.set_axis_off()
    if (shown_by := panels[0, 0].get_legend_handles_labels())[0]:
        figure.legend(*shown_by, loc="outside lower center", ncols=5, fontsize=7)
    figure.suptitle(title, fontsize=10)
    figure.supylabel("share of the cases up to the value", fontsize=9)
    return figure


def _varies(numbers: np.ndarray) -> bool:
    finite = numbers[np.isfinite(numbers)]
    return bool(finite.size and np.ptp(finite) > 0)


def sweep_figure(
    settings: StudySettings, quantity: CoupledQuantity, cases: Sequence[Case], rows: Rows, title: str
) -> Figure:
    """Median and 5 to 95 % of the cases of each condition, by value and pantograph, of each of the compared."""
    places = _Places(settings, cases)
    figure, panels = _panels(quantity.figures, runners(cases, settings))
    names = list(settings.compared) or [""]
    for (name, runner), axes in panels.items():
        column = quantity.column(name, runner.i)
        for k, label in enumerate(names):
            by_place: dict[float, list[float]] = {}
            for number, case in enumerate(cases):
                own = settings.parameters_of(case)
                if case.get(COMPARED, 1) == k + 1 and own.get(COUNT, 1) == runner.of and number in rows:
                    by_place.setdefault(places.of(case), []).append(float(rows[number][column] or "nan"))
            at = np.array(sorted(by_place))
            low, middle, high = np.array([_percentiles(by_place[place]) for place in at]).T
            axes.fill_between(at, low, high, color=f"C{k}", alpha=0.15, linewidth=0)
            axes.plot(at, middle, ".-", color=f"C{k}", linewidth=1.1, label=label or "median")
        places.mark(axes)
    _finish(figure, panels, f"{title}\nmedian and 5 to 95 % of the lines", places.label)
    return figure


def difference_figure(
    settings: StudySettings, cases: Sequence[Case], found: Sequence[Difference], title: str
) -> Figure:
    """Mean differences of the first of the compared from the others, with intervals, by value and pantograph."""
    places = _Places(settings, cases)
    figure, panels = _panels(list(dict.fromkeys(d.figure for d in found)), list(dict.fromkeys(d.runner for d in found)))
    first, *names = settings.compared
    for (name, runner), axes in panels.items():
        for k, label in enumerate(names, 1):
            own = [d for d in found if (d.figure, d.runner, d.name) == (name, runner, label)]
            at = np.array([places.of(dict(zip(places.names, d.condition))) for d in own])
            beside = places.step * 0.12 * (k - (len(names) + 1) / 2)
            mean, half = np.array([(d.mean, d.half_width) for d in own]).T
            axes.errorbar(at + beside, mean, half, fmt="o", ms=3, capsize=2.5, color=f"C{k}", label=f"less {label}")
        axes.axhline(0, color="black", linewidth=0.8)
        places.mark(axes)
    by = "on the same lines, 95 % intervals of the mean" if has_intervals(settings) else f"({NO_INTERVALS})"
    _finish(figure, panels, f"{title}\n{first} less the others {by}", places.label)
    return figure


def correlation_figure(found: Mapping[str, Sequence[Correlation]], parameters: Sequence[str], title: str) -> Figure:
    """Rank correlations with their intervals: a panel for each value, a bar for each parameter."""
    columns = list(dict.fromkeys(each.column for correlations in found.values() for each in correlations))
    count = min(COLUMNS, len(columns))
    figure = new_figure(3.8 * count, 0.9 + (0.9 + 0.3 * len(parameters)) * -(-len(columns) // count))
    panels = figure.subplots(-(-len(columns) // count), count, sharex=True, sharey=True, squeeze=False)
    at = np.arange(len(parameters))
    height = 0.8 / len(found)
    for axes, column in zip(panels.flat, columns):
        for k, (label, correlations) in enumerate(found.items()):
            for each in (each for each in correlations if each.column == column):
                error = np.array([each.value - each.low, each.high - each.value])
                style = {"height": height, "color": f"C{k}", "alpha": 0.7, "label": label or None}
                beside = height * (k - (len(found) - 1) / 2)
                axes.barh(at + beside, each.value, xerr=error, error_kw={"elinewidth": 0.9, "capsize": 2}, **style)
        axes.axvline(0, color="black", linewidth=0.6)
        axes.set_xlim(-1, 1)
        axes.set_yticks(at, parameters, fontsize=8)
        axes.set_title(column, fontsize=9)
        axes.grid(True, axis="x", linewidth=0.4, alpha=0.5)
    panels[0, 0].invert_yaxis()
    for axes in panels.flat[len(columns) :]:
        axes.set_axis_off()
    for axes in panels.flat[len(columns) - count : len(columns)]:
        axes.tick_params(labelbottom=True)
    if panels[0, 0].get_legend_handles_labels()[0]:
        panels[0, 0].legend(fontsize=7)
    figure.suptitle(title, fontsize=10)
    figure.supxlabel("rank correlation, with 95 % intervals", fontsize=9)
    return figure


class _Places:
    """Where conditions are on a figure's axis: at their speeds, or one after the other where more than speeds vary."""

    def __init__(self, settings: StudySettings, cases: Sequence[Case]):
        self._settings, self.names = settings, conditions(settings)
        self._told = [name for name in self.names if name != COUNT]
        self._is_speed = self._told == [SPEED]
        keys = dict.fromkeys(tuple(case[name] for name in self._told) for case in cases)
        self._at = {key: float(key[0]) if self._is_speed else float(i) for i, key in enumerate(keys)}
        self.step = float(np.min(np.diff(sorted(self._at.values())))) if len(self._at) > 1 else 1.0
        self.label = "speed  [km/h]" if self._is_speed else ""

    def of(self, case: Mapping[str, Value]) -> float:
        return self._at[tuple(case[name] for name in self._told)]

    def mark(self, axes: Axes) -> None:
        labels = [", ".join(condition_texts(self._settings, self._told, key)) for key in self._at]
        if self._is_speed:
            labels = [f"{place:g}" for place in self._at.values()]
        axes.set_xticks(list(self._at.values()), labels)
        axes.set_xlim(min(self._at.values()) - 0.5 * self.step, max(self._at.values()) + 0.5 * self.step)


Panels = dict[tuple[str, Runner], Axes]


def _panels(figures: Sequence[str], who: Sequence[Runner]) -> tuple[Figure, Panels]:
    """A row for each value, a column for each pantograph."""
    figure = new_figure(max(6.0, 1.2 + 3.3 * len(who)), 1.1 + 1.9 * len(figures))
    grid = figure.subplots(len(figures), len(who), sharex=True, sharey="row", squeeze=False)
    return figure, {(name, runner): grid[r, c] for r, name in enumerate(figures) for c, runner in enumerate(who)}


def _finish(figure: Figure, panels: Panels, title: str, label: str) -> None:
    (first_figure, first_runner), (last_figure, _) = next(iter(panels)), list(panels)[-1]
    for (name, runner), axes in panels.items():
        axes.grid(True, linewidth=0.4, alpha=0.5)
        axes.tick_params(labelsize=8)
        if runner == first_runner:
            shown, unit, _ = described(name)
            axes.set_ylabel(f"{shown.replace(', ', chr(10))}  [{unit or 1}]", fontsize=8)
        if name == first_figure:
            axes.set_title(str(runner), fontsize=9)
        if name == last_figure:
            axes.set_xlabel(label, fontsize=8)
    shown_by = panels[first_figure, first_runner].get_legend_handles_labels()
    figure.legend(*shown_by, loc="outside lower center", ncols=5, fontsize=8)
    figure.suptitle(title, fontsize=10)


def _percentiles(values: Sequence[float]) -> np.ndarray:
    finite = np.array(values)[np.isfinite(values)]
    return np.percentile(finite, PERCENTILES) if finite.size else np.full(len(PERCENTILES), np.nan)
