"""What the measurements say: cheapest variant for an error, comparison with the paper and with the goals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isnan

from .measure import INERTIA_PERIODS, STABILITY, STIFF, Result, Variant

Runs = Mapping[Variant, Result]

DEFAULT_ALPHA = -0.3
FMU_METHOD = f"HHT, alpha {DEFAULT_ALPHA:g}"
# The published comparison with MATLAB's ode45, whose rod inertia is not printed.
PAPER_STEP_RATIO, PAPER_TIME_RATIO = 2000, 250
QUANTITIES = {"H": "H", "frame": "upper frame", "force": "contact force"}


@dataclass(frozen=True)
class Choice:
    """The cheapest variant that meets an error."""

    variant: Variant
    result: Result
    end: float  # s, simulated

    @property
    def mean_step(self) -> float:
        """In s."""
        return self.end / self.result.steps


def secured_errors(runs: Runs, quantity: str) -> dict[Variant, float]:
    """Largest error of each run and all finer ones of its family: a lucky zero of the error does not count.

    Infinite from where one failed.
    """
    secured = {}
    worst: dict[Variant, float] = {}
    for variant in sorted(runs, key=lambda variant: (variant.step, variant.rtol)):
        error = getattr(runs[variant], quantity)
        error = inf if isnan(error) else error
        worst[variant.family] = secured[variant] = max(error, worst.get(variant.family, 0.0))
    return secured


def cheapest(runs: Runs, target: float, quantity: str, frequency: float) -> Choice | None:
    """The cheapest run whose secured error of the quantity is at most the target; None if none is."""
    fit = [variant for variant, error in secured_errors(runs, quantity).items() if error <= target]
    if not fit:
        return None
    variant = min(fit, key=lambda variant: runs[variant].seconds)
    return Choice(variant, runs[variant], (1 + variant.periods) / frequency)


def by_method(runs: Runs) -> dict[str, dict[Variant, Result]]:
    """The runs by the method's name as it is shown; HHT with the FMU's default alpha comes first, alone."""
    groups: dict[str, dict[Variant, Result]] = {FMU_METHOD: {}}
    for variant, result in runs.items():
        name = variant.method
        if name == "HHT":
            if variant.hht_alpha == DEFAULT_ALPHA:
                groups[FMU_METHOD][variant] = result
            name = "HHT, best alpha"
        groups.setdefault(name, {})[variant] = result
    return {name: group for name, group in groups.items() if group}


def precision_table(runs: Runs, frequency: float) -> list[str]:
    """CPU times for given errors, by method, and their ratio to the FMU's."""
    cases = [("H", 1e-2), ("H", 1e-3), ("frame", 1e-2), ("force", 1e-2)]
    lines = [
        "CPU time in ms for an error of at most (and its ratio to the FMU's default)",
        f"{'':16s}" + "".join(f"{f'{QUANTITIES[q]} {target:g}':>22s}" for q, target in cases),
    ]
    chosen = {
        name: [cheapest(group, target, quantity, frequency) for quantity, target in cases]
        for name, group in by_method(runs).items()
    }
    for name, choices in chosen.items():
        cells = []
        for choice, base in zip(choices, chosen[FMU_METHOD]):
            ratio = f" ({choice.result.seconds / base.result.seconds:.1f})" if choice and base else ""
            cells.append(f"{1e3 * choice.result.seconds:.2f}{ratio}" if choice else "-")
        lines.append(f"{name:16s}" + "".join(f"{cell:>22s}" for cell in cells))
    return lines


@dataclass(frozen=True)
class Ratios:
    """The peers against the FMU at one inertia, all at an error of at most 1 %."""

    inertia: float  # kg m2
    hht: Choice
    methods: Mapping[str, Choice]

    def time(self, method: str) -> float:
        """CPU time of a method by the FMU's."""
        return self.methods[method].result.seconds / self.hht.result.seconds

    @property
    def step(self) -> float:
        """The FMU's step by the mean one of Dormand-Prince."""
        return self.hht.mean_step / self.methods["RK45"].mean_step


def inertia_ratios(runs: Runs, quantity: str, frequency: float) -> list[Ratios]:
    """Ratios by descending inertia for the error of a quantity, where the FMU and Dormand-Prince meet it."""
    found = []
    for inertia in sorted({variant.inertia for variant in runs}, reverse=True):
        here = {variant: run for variant, run in runs.items() if variant.inertia == inertia}
        found_by = {name: cheapest(group, 1e-2, quantity, frequency) for name, group in by_method(here).items()}
        choices = {name: choice for name, choice in found_by.items() if choice}
        if FMU_METHOD in choices and "RK45" in choices:
            found.append(Ratios(inertia, choices[FMU_METHOD], choices))
    return found


def inertia_table(ratios: list[Ratios], force_ratios: list[Ratios], bound: float) -> list[str]:
    """Time and step ratios by inertia, for the errors of H and of the contact force.

    bound   Dormand-Prince's longest stable step in s for 1 kg m2
    """
    force = {row.inertia: row for row in force_ratios}
    lines = [
        f"By rod inertia J, for an error of H of at most 1 % in {INERTIA_PERIODS} periods; "
        f"the paper (J not printed): step {PAPER_STEP_RATIO}, time {PAPER_TIME_RATIO}",
        f"{'J, kg m2':>9s}{'HHT step':>10s}{'RK45 mean':>11s}{'stable, stuck':>15s}{'step ratio':>12s}"
        f"{'time ratio: RK45':>18s}" + "".join(f"{name:>8s}" for name in STIFF) + f"{'RK45, force 1 %':>17s}",
    ]
    for row in ratios:
        others = [f"{row.time(name):.1f}" if name in row.methods else "-" for name in STIFF]
        by_force = f"{force[row.inertia].time('RK45'):.0f}" if row.inertia in force else "-"
        explicit = row.methods["RK45"]
        lines.append(
            f"{row.inertia:9.1e}{1e3 * row.hht.mean_step:7.2f} ms{1e6 * explicit.mean_step:8.2f} us"
            f"{1e6 * bound * row.inertia:12.2f} us{row.step:12.0f}{row.time('RK45'):18.0f}"
            + "".join(f"{text:>8s}" for text in others)
            + f"{by_force:>17s}"
        )
    return lines


def stable_step(Mf: float, tau: float) -> float:
    """Dormand-Prince's longest stable step with stuck rods, in s for each kg m2 of inertia."""
    return STABILITY["RK45"] / (Mf * tau)


def goal_lines(precision: Runs, ratios: list[Ratios], frequency: float) -> list[str]:
    """Whether the goals were reached in this run."""
    groups = by_method(precision)
    base = {target: cheapest(groups[FMU_METHOD], target, "H", frequency) for target in (1e-2, 1e-3)}
    lines = []

    def say(goal: str, ratio: float | None, least: float) -> None:
        verdict = "not measured" if ratio is None else "reached" if ratio >= least else "not reached"
        lines.append(f"goal: {goal}: {verdict}" + ("" if ratio is None else f", {ratio:.3g} times"))

    def ratio(method: str, target: float) -> float | None:
        choice, own = cheapest(groups.get(method, {}), target, "H", frequency), base[target]
        return choice.result.seconds / own.result.seconds if choice and own else None

    say("50 times less CPU than Dormand-Prince at an error of H of 1 %", ratio("RK45", 1e-2), 50)
    small = [row.time("RK45") for row in ratios if row.inertia == 1e-5]
    say("1000 times less at J = 1e-5 kg m2", small[0] if small else None, 1000)
    for target in base:
        known = {name: found for name in STIFF if (found := ratio(name, target)) is not None}
        fastest = min(known, key=known.__getitem__, default="")
        name = f" ({fastest})" if fastest else ""
        say(f"less CPU than the best stiff peer{name} at {target:g}", known.get(fastest), 1)
    return lines


def failures(runs: Runs) -> list[str]:
    """One line on the runs that failed, if any."""
    failed = sorted({variant.method for variant, run in runs.items() if isnan(run.seconds)})
    count = sum(isnan(run.seconds) for run in runs.values())
    return [f"{count} of {len(runs)} variants failed ({', '.join(failed)}), see the CSV file"] if failed else []
