"""Figures of the Newton study. Nothing is simulated here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from zspring.figures import new_figure

from .accuracy import Errors
from .iteration import Iteration
from .work import TangentWork

COLORS = {"Resolvent": "C0", "Mean": "C2", "Secant": "C1", "Exact": "C3"}
MARKERS = {"Resolvent": "o", "Mean": "s", "Secant": "^", "Exact": "x"}
SHOWN = 25  # iterations


def jump_figure(
    iterations: Mapping[str, Iteration], balance: tuple[np.ndarray, np.ndarray], tau: float, title: str
) -> Figure:
    """The exact tangent's two states on the friction law, and the iterates of all tangents.

    balance     rod rate (n,) in rad/s and the moment over Mf (n,) that the rest of the pantograph needs
    """
    figure = new_figure(14, 4.8)
    law, rates, unbalance = figure.subplots(1, 3)
    w, needed = balance
    law.plot(1e3 * w, np.tanh(tau * w), color="black", linewidth=1.5, label=f"tanh(τw), τ = {tau:g} s")
    law.plot(1e3 * w, needed, color="gray", linewidth=1.5, label="what the rest needs")
    last = iterations["Exact"].rates[-2:, 0]
    for number, (here, there) in enumerate((last, last[::-1])):
        s = np.tanh(tau * here)
        landing = s + tau * (1 - s**2) * (there - here)
        law.plot(
            [1e3 * here, 1e3 * there],
            [s, landing],
            color=COLORS["Exact"],
            linewidth=1,
            label="exact tangent at each of two states" if number == 0 else None,
        )
        law.plot([1e3 * there] * 2, [landing, np.tanh(tau * there)], ":", color=COLORS["Exact"], linewidth=1)
        law.plot(1e3 * here, s, "o", color=COLORS["Exact"], markersize=6)
    solution = iterations["Resolvent"].rates[-1, 0]
    law.plot(
        1e3 * solution,
        np.tanh(tau * solution),
        "*",
        color=COLORS["Resolvent"],
        markersize=12,
        label="solution (resolvent)",
    )
    law.set(xlabel="rate of the rod  [mrad/s]", ylabel="friction moment / Mf", ylim=(-1.6, 1.6))
    law.set_title("the step's equation")
    law.legend(fontsize=8)

    for tangent, iteration in iterations.items():
        style = {"color": COLORS[tangent], "marker": MARKERS[tangent], "markersize": 4, "linewidth": 1.1}
        numbers = np.arange(SHOWN + 1)
        rates.plot(numbers, 1e3 * iteration.rates[: SHOWN + 1, 0], label=tangent, **style)
        unbalance.semilogy(numbers, np.maximum(iteration.unbalance[: SHOWN + 1], 1e-16), label=tangent, **style)
    rates.set_yscale("symlog", linthresh=10)
    rates.set(xlabel="iteration", ylabel="rate of the rod  [mrad/s]", title="iterates")
    unbalance.set(xlabel="iteration", ylabel="unbalanced moment / Mf", title="what is left")
    rates.legend(fontsize=8)
    for axes in (law, rates, unbalance):
        axes.grid(True, linewidth=0.4, alpha=0.5)
    figure.suptitle(title)
    return figure


def convergence_figure(
    by_amplitude: Sequence[TangentWork], by_tau: Sequence[TangentWork], errors: Sequence[Errors], title: str
) -> Figure:
    """Iterations by amplitude and by tau, time by tau, accuracy by tau."""
    figure = new_figure(11, 8.5)
    (first, second), (third, fourth) = figure.subplots(2, 2)
    for works, axes, key, quantity in (
        (by_amplitude, first, "amplitude", "iterations_per_step"),
        (by_tau, second, "tau", "iterations_per_step"),
        (by_tau, third, "tau", "seconds"),
    ):
        for tangent in dict.fromkeys((work.law, work.tangent) for work in works):
            own = [work for work in works if (work.law, work.tangent) == tangent]
            style = {"color": COLORS[tangent[1]], "marker": MARKERS[tangent[1]], "markersize": 5}
            if tangent[0] == "Coulomb":
                style |= {"linestyle": "--", "fillstyle": "none"}
            label = tangent[1] if tangent[0] == "Regularized" else f"{tangent[1]}, Coulomb"
            x = [getattr(work, key) for work in own]
            y = [getattr(work, quantity) for work in own]
            axes.loglog(x, y, label=label, linewidth=1.2, **style)
        axes.legend(fontsize=8)
    amplitudes = sorted({work.amplitude for work in by_amplitude if work.amplitude is not None})
    first.set_xticks(amplitudes, [f"{amplitude:g}" for amplitude in amplitudes])
    first.set_xticks([], minor=True)
    first.set(xlabel="amplitude  [m/s²]", ylabel="Newton iterations a step", title="by amplitude")
    second.set(xlabel="τ  [s]", ylabel="Newton iterations a step", title="by steepness of the friction law")
    third.set(xlabel="τ  [s]", ylabel="time  [s]", title=f"{by_tau[0].points} points of the figure")
    tau = [error.tau for error in errors]
    for name, label, marker in (
        ("H_largest", "H, worst point", "v"),
        ("H_median", "H, median", "^"),
        ("contact_force", "contact force", "o"),
        ("head_position", "head position", "s"),
    ):
        fourth.loglog(tau, [100 * getattr(error, name) for error in errors], marker=marker, linewidth=1.2, label=label)
    fourth.set(xlabel="τ  [s]", ylabel="error  [%]", title="against the Coulomb law, at the same time step")
    fourth.legend(fontsize=8)
    for axes in (first, second, third, fourth):
        axes.grid(True, which="both", linewidth=0.4, alpha=0.5)
    figure.suptitle(title)
    return figure
