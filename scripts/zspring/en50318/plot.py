"""Figures of the validation report. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ..bench.compare import LevelComparison
from ..bench.responses import phase_degrees
from ..figures import legend_beside, new_figure
from ..line.quantities import Statistics, described
from ..line.result import SLIPPING, LineResult
from ..line.series import Series
from ..line.statistics import Section, inside, low_pass
from .edition import Judgement

COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:purple")
STYLES = ("-", "-", ":", "--")
EDGES = (2.0, 5.0, 20.0)  # Hz, of the standard's bands
SHADE: dict[str, Any] = {"color": "tab:green", "alpha": 0.12, "linewidth": 0}


def force_figure(series: Series, section: Section | None, found: Statistics, title: str) -> Figure:
    """Contact force, unfiltered and 0-20 Hz, with its statistics, then height and uplifts where there are any.

    Over the position, or the time where there is none.
    """
    along, label = series.time, "time  [s]"
    if series.position is not None:
        along, label = series.position, "position along the line  [m]"
    low, high = section.bounds if section else along[[0, -1]]
    places = series.support_position or {}
    near = {k: v for k, v in (series.uplift or {}).items() if low - 1e-6 <= places.get(k, low) <= high + 1e-6}
    points = {f"wire at {x:g} m": values for x, values in series.points.items()}
    panels = 1 + (series.height is not None) + bool(near or points)
    figure = new_figure(10, 1.2 + 2.2 * panels)
    all_axes = figure.subplots(panels, 1, sharex=True, squeeze=False, height_ratios=[1.6, *[1] * (panels - 1)])[:, 0]
    axes = all_axes[0]
    axes.plot(along, series.force, color="0.65", linewidth=0.6, label="unfiltered")
    axes.plot(along, low_pass(series.force, series.step), color=COLOURS[0], linewidth=1.4, label="0-20 Hz")
    lines = (("mean_force", "-", "mean"), ("statistical_maximum", "--", "mean ± 3σ"), ("statistical_minimum", "--", ""))
    for name, style, text in lines:
        axes.plot([low, high], [found[name]] * 2, style, color="tab:red", linewidth=1, label=text or None)
    axes.set_ylabel("contact force  [N]")
    axes.set_title(title)
    legend_beside(axes)
    rest = iter(all_axes[1:])
    if series.height is not None:
        axes = next(rest)
        axes.plot(along, 1e3 * series.height, color=COLOURS[0], linewidth=1.2)
        axes.set_ylabel("contact point\nheight  [mm]")
    if near or points:
        axes = next(rest)
        for lifted, style in (near, "-"), (points, "--"):
            colours = matplotlib.colormaps["viridis"](np.linspace(0, 0.8, len(lifted)))
            for (name, values), colour in zip(lifted.items(), colours):
                axes.plot(along, 1e3 * values, style, color=colour, linewidth=1.2, label=name)
        axes.set_ylabel("uplift  [mm]")
        legend_beside(axes)
    for axes in all_axes:
        axes.axvspan(low, high, **SHADE)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    all_axes[-1].set_xlabel(f"{label}, evaluated part shaded")
    all_axes[-1].set_xlim(along[0], along[-1])
    return figure


def ranges_figure(by_case: Mapping[str, Sequence[Judgement]], title: str) -> Figure:
    """Each value between the ends of its accepted range, which is 0 to 1; ranges without width are left out."""
    names = list(dict.fromkeys(j.name for judgements in by_case.values() for j in judgements if _width(j)))
    figure = new_figure(9, 1.5 + 0.38 * len(names))
    axes = figure.subplots()
    axes.axvspan(0, 1, **SHADE)
    shifts = np.linspace(-0.12, 0.12, len(by_case)) if len(by_case) > 1 else [0.0]
    for number, (shift, (case, judgements)) in enumerate(zip(shifts, by_case.items())):
        colour, marker = f"C{number}", "osD^v"[number % 5]
        shown = [j for j in judgements if _width(j)]
        places = [(j.value - j.accepted[0]) / _width(j) for j in shown]
        rows = [names.index(j.name) + shift for j in shown]
        axes.plot(places, rows, marker, color=colour, label=case, markersize=7)
    axes.set_yticks(range(len(names)), [described(name)[0] for name in names])
    axes.invert_yaxis()
    axes.set_xlim(min(-0.3, axes.get_xlim()[0]), max(1.3, axes.get_xlim()[1]))
    axes.set_xticks([0, 0.5, 1], ["lower end", "middle", "upper end"])
    axes.set_xlabel("place in the accepted range (shaded)")
    axes.set_title(title)
    axes.grid(True, axis="y", linewidth=0.4, alpha=0.5)
    legend_beside(axes)
    return figure


def sensitivity_figure(
    by_case: Mapping[str, tuple[Statistics, Mapping[str, Statistics], tuple[float, float] | None]], title: str
) -> Figure:
    """Standard deviation by choice: a panel for each case of (reference, by choice, accepted range)."""
    count = max(len(choices) for _, choices, _ in by_case.values())
    figure = new_figure(10, 1.5 + 0.3 * count)
    panels = figure.subplots(1, len(by_case), squeeze=False, sharey=True)[0]
    for axes, (case, (reference, choices, accepted)) in zip(panels, by_case.items()):
        if accepted:
            axes.axvspan(*accepted, **SHADE, label="accepted")
        axes.axvline(reference["standard_deviation"], color="0.4", linewidth=1, label="reference")
        values = [found["standard_deviation"] for found in choices.values()]
        axes.plot(values, range(len(values)), "o", color=COLOURS[0], markersize=6)
        axes.set_yticks(range(len(choices)), list(choices))
        axes.set_xlabel("standard deviation, 0-20 Hz  [N]")
        axes.set_title(case, fontsize=10)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    panels[0].invert_yaxis()
    legend_beside(panels[-1])
    figure.suptitle(title)
    return figure


def heads_figure(found: Mapping[str, Mapping[float, Mapping[str, np.ndarray]]], title: str) -> Figure:
    """Standard deviation in both bands, smallest force and loss of contact over the speed, by head: mean and range.

    found   by head, speed in km/h and name the values of all starts (s,)
    """
    figure = new_figure(10, 6.5)
    panels = figure.subplots(2, 2, sharex=True)
    shown = (
        ("standard_deviation", "standard deviation,\n0-20 Hz  [N]"),
        ("standard_deviation_5_20", "standard deviation,\n5-20 Hz  [N]"),
        ("actual_minimum", "actual minimum,\n0-20 Hz  [N]"),
        ("loss_of_contact", "loss of contact  [%]"),
    )
    for axes, (name, label) in zip(panels.flat, shown):
        for i, ((head, by_speed), colour, style) in enumerate(zip(found.items(), COLOURS, ("o-", "s-", "^--", "D:"))):
            values = [each[name] for each in by_speed.values()]
            means = np.array([each.mean() for each in values])
            reach = np.abs([[each.min(), each.max()] for each in values] - means[:, None]).T
            shift = 2.5 * (i - 1)  # km/h, so that the ranges do not hide each other
            places = np.array(list(by_speed)) + shift
            axes.errorbar(
                places, means, reach, fmt=style, color=colour, label=head, linewidth=1.3, markersize=4, capsize=3
            )
        axes.set_ylabel(label)
        axes.grid(True, linewidth=0.4, alpha=0.5)
    panels[1, 1].set_ylim(bottom=0, top=max(1.0, panels[1, 1].get_ylim()[1]))
    for axes in panels[1]:
        axes.set_xlabel("speed  [km/h], drawn side by side")
    panels[0, 0].legend(fontsize=8, title="mean and range of all starts", title_fontsize=8)
    figure.suptitle(title)
    return figure


def heads_force_figure(results: Mapping[str, LineResult], section: Section, title: str) -> Figure:
    """Filtered contact forces of the heads over the evaluated spans, and the friction moments of the Z-spring."""
    figure = new_figure(10, 5.5)
    force, friction = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
    for (head, result), colour, style in zip(results.items(), COLOURS, STYLES):
        filtered = low_pass(result.contact_force[:, 0], float(result.time[1] - result.time[0]))
        force.plot(result.position[:, 0], filtered, style, color=colour, linewidth=1.3, label=head)
        if np.any(result.moment):
            share = result.moment[:, 0, 0] / result.friction_bound[0]
            slips = 100 * np.mean(np.abs(share) >= SLIPPING)
            label = f"{head.split(', ')[-1]}: slips {slips:.0f} % of the run"
            friction.plot(result.position[:, 0], share, style, color=colour, linewidth=1, label=label)
    force.set_ylabel("contact force,\n0-20 Hz  [N]")
    friction.set_ylabel("friction moment\nof joint α / Mf")
    friction.set_xlabel("position along the line  [m]")
    friction.set_xlim(*section.bounds)
    force.set_title(title)
    for axes in (force, friction):
        axes.grid(True, linewidth=0.4, alpha=0.5)
        legend_beside(axes)
    return figure


def frf_comparison_figure(comparisons: Sequence[LevelComparison], edges: Sequence[float], title: str) -> Figure:
    """Magnitude and phase of the receptance: measured points and computed lines, by amplitude."""
    figure = new_figure(10, 6.5)
    magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    for each, colour in zip(comparisons, matplotlib.colormaps["plasma"](np.linspace(0, 0.85, len(comparisons)))):
        frequency = each.measured.frequency
        for H, style, label in (
            (each.measured.H, {"marker": ".", "linestyle": "none"}, each.measured.label),
            (each.computed, {"linestyle": "-", "linewidth": 1.2}, None),
        ):
            magnitude.semilogy(frequency, np.abs(H), color=colour, label=label, **style)
            phase.plot(frequency, phase_degrees(H, "receptance"), color=colour, **style)
    for axes in (magnitude, phase):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
        for edge in edges:
            axes.axvline(edge, color="0.6", linewidth=0.8, linestyle="--")
    highest = max(float(each.measured.frequency[-1]) for each in comparisons)
    phase.set_xlim(0, 1.03 * highest)
    magnitude.set(title=title, ylabel="|H|, receptance  [m/N]")
    phase.set(xlabel="frequency  [Hz], bands by dashed lines", ylabel="phase  [deg]")
    magnitude.legend(fontsize=8, title="points measured, lines computed", title_fontsize=8)
    return figure


def overlay_figure(simulation: Series, line_test: Series, sections: Sequence[Section | None]) -> Figure | None:
    """Contact force of 0-20 Hz of both over the position, a panel for each section; None where one has no positions."""
    if simulation.position is None or line_test.position is None:
        return None
    both = (line_test, line_test.position, "0.25"), (simulation, simulation.position, COLOURS[0])
    figure = new_figure(10, 1.0 + 2.4 * len(sections))
    for axes, section in zip(figure.subplots(len(sections), 1, squeeze=False)[:, 0], sections):
        for (series, position, colour), name in zip(both, ("line test", "simulation")):
            shown, force = inside(series, section), low_pass(series.force, series.step)
            axes.plot(position[shown], force[shown], color=colour, linewidth=1.3, label=name)
        for edge in section.edges if section else ():
            axes.axvline(edge, color="0.8", linewidth=0.8, zorder=0)
        axes.set_title(str(section or "the whole series"), fontsize=10)
        axes.set_ylabel("contact force,\n0-20 Hz  [N]")
        axes.margins(x=0)
        axes.grid(True, axis="y", linewidth=0.4, alpha=0.5)
        legend_beside(axes)
    axes.set_xlabel("position along the line, of the simulation  [m]; supports as vertical lines")
    return figure


def spectra_figure(spectra: Mapping[str, tuple[np.ndarray, np.ndarray]], until: float) -> Figure:
    """Power spectral densities in N2/Hz over the frequency up to `until` Hz, by name; the standard's bands marked."""
    figure = new_figure(10, 4.5)
    axes = figure.subplots()
    for (name, (frequency, density)), colour in zip(spectra.items(), (COLOURS[0], "0.25")):
        shown = (frequency > 0) & (frequency <= until)
        axes.semilogy(frequency[shown], density[shown], color=colour, linewidth=1.3, label=name)
    for edge in EDGES:
        axes.axvline(edge, color="0.6", linewidth=0.8, linestyle="--")
    axes.set_xlim(0, until)
    axes.set_xlabel("frequency  [Hz]; dashed: 2, 5 and 20 Hz")
    axes.set_ylabel("power spectral density\nof the contact force  [N²/Hz]")
    axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    legend_beside(axes)
    return figure


def _width(judgement: Judgement) -> float:
    low, high = judgement.accepted
    return high - low
