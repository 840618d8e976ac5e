"""The figures of the study. Nothing is simulated here."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from zspring.figures import new_figure

from .measure import STIFF
from .report import FMU_METHOD, PAPER_STEP_RATIO, PAPER_TIME_RATIO, QUANTITIES, Ratios, Runs, by_method, secured_errors

COLORS = {
    FMU_METHOD: "black",
    "HHT, best alpha": "tab:gray",
    "RK45": "tab:red",
    "RK4": "tab:orange",
    "LSODA": "tab:blue",
    "Radau": "tab:green",
    "CVODE": "tab:purple",
}
LABELS = {"RK45": "Dormand-Prince 5(4) (ode45)", "RK4": "RK4, fixed step"}


def precision_figure(runs: Runs, title: str) -> Figure:
    """Error against CPU time: a point for each variant, a line along each method's best secured errors."""
    figure = new_figure(12, 5.4)
    axes = figure.subplots(1, len(QUANTITIES), sharex=True, sharey=True)
    for ax, (quantity, name) in zip(axes, QUANTITIES.items()):
        for method, group in by_method(runs).items():
            secured = secured_errors(group, quantity)
            points = np.array(
                [(1e3 * run.seconds, getattr(run, quantity), secured[variant]) for variant, run in group.items()]
            )
            points = points[np.isfinite(points[:, 0])]
            seconds, errors, safe = points[np.argsort(points[:, 0])].T
            # The line leaves out what a cheaper variant undercuts.
            best = safe < np.minimum.accumulate(np.append(np.inf, safe))[:-1]
            color = COLORS[method]
            style = {"color": color, "label": LABELS.get(method, method), "zorder": 3 if method == FMU_METHOD else 2}
            ax.loglog(seconds, errors, ".", color=color, alpha=0.25, markersize=4)
            ax.loglog(seconds[best], safe[best], ".-", linewidth=1.3, **style)
        for target in (1e-2, 1e-3):
            ax.axhline(target, color="gray", linewidth=0.6, linestyle=":")
        ax.grid(True, linewidth=0.4, alpha=0.5)
        ax.set(title=name, xlabel="CPU time  [ms]")
    axes[0].set(ylabel="relative error", ylim=(1e-7, 3))
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=9, loc="outside lower center", ncols=len(COLORS))
    figure.suptitle(title, fontsize=11)
    return figure


def inertia_figure(ratios: list[Ratios], force_ratios: list[Ratios], bound: float, title: str) -> Figure:
    """CPU time and step ratios against the rod inertia, with the paper's values.

    ratios  at 1 % of H; force_ratios: at 1 % of the contact force
    bound   Dormand-Prince's longest stable step with stuck rods, in s for each kg m2
    """
    figure = new_figure(10, 5.2)
    time, step = figure.subplots(1, 2, sharex=True)
    inertia = np.array([row.inertia for row in ratios])
    for method in ("RK45", *STIFF):
        known = [(row.inertia, row.time(method)) for row in ratios if method in row.methods]
        if known:
            time.loglog(*zip(*known), "o-", color=COLORS[method], markersize=4, label=LABELS.get(method, method))
    by_force = [(row.inertia, row.time("RK45")) for row in force_ratios]
    if by_force:
        time.loglog(
            *zip(*by_force),
            "o--",
            color="tab:red",
            markersize=4,
            fillstyle="none",
            label="Dormand-Prince, both at 1 % of the force",
        )
    time.axhline(1, color="black", linewidth=1, label=FMU_METHOD)
    time.axhline(PAPER_TIME_RATIO, color="gray", linestyle="--", label=f"paper: {PAPER_TIME_RATIO} (ode45)")
    time.set(ylabel="CPU time by that of the FMU, both at 1 % of H", xlabel="rod inertia J  [kg m²]")
    step.loglog(
        inertia, [row.step for row in ratios], "o-", color="tab:red", markersize=4, label="mean step of Dormand-Prince"
    )
    stable = [row.hht.mean_step / (bound * row.inertia) for row in ratios]
    step.loglog(inertia, stable, ":", color="tab:red", label="its stability bound with stuck rods")
    step.axhline(PAPER_STEP_RATIO, color="gray", linestyle="--", label=f"paper: {PAPER_STEP_RATIO}")
    step.set(ylabel="step of the FMU by that of Dormand-Prince", xlabel="rod inertia J  [kg m²]")
    for ax in (time, step):
        ax.grid(True, which="both", linewidth=0.4, alpha=0.5)
    step.legend(fontsize=8)
    figure.legend(*time.get_legend_handles_labels(), fontsize=8, loc="outside lower center", ncols=4)
    figure.suptitle(title, fontsize=11)
    return figure
