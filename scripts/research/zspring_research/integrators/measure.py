"""Which methods run with which settings, and one timed run of each."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from math import nan
from typing import Any

import numpy as np

from zspring.bench.fmu_bench import FmuBench
from zspring.fmu import Instance, StepDiscarded
from zspring.variables import Value

from .peers import SolverFailed, clock, rk4, solve
from .problem import Errors, Problem

# Longest stable step of the explicit methods is this number times J / (Mf tau): where their stability
# function leaves the unit circle on the negative real axis.
STABILITY = {"RK45": 3.3066, "RK4": 2.7853}
STIFF = ("LSODA", "Radau", "CVODE")

HHT_STEPS = tuple(1e-3 * h for h in (8, 5.6, 4, 2.8, 2, 1.4, 1, 0.7, 0.5, 0.35, 0.25, 0.2, 0.14, 0.1))
HHT_ALPHAS: tuple[float, ...] = (0.0, -0.1, -0.2, -0.3)
RK4_STEPS: tuple[float, ...] = (20, 14, 10, 7, 5, 3.5, 2, 1.4, 0.99, 0.7)  # times the longest stable one
TOLERANCES = tuple(10 ** (-i / 2) for i in range(2, 13))
ATOL_FACTORS: tuple[float, ...] = (1.0, 0.1, 0.01)
INERTIAS = (7.5e-4, 2.5e-4, 7.5e-5, 2.5e-5, 1e-5, 3e-6, 1e-6)  # kg m2
INERTIA_PERIODS = 2  # explicit methods take a minute for more at the least inertia


@dataclass(frozen=True)
class Variant:
    """One method with its settings on one problem; settings that a method does not have are 0."""

    study: str  # "precision": inertia as given; "inertia": J1 = J2 = inertia
    inertia: float  # kg m2
    periods: int  # after the ramp
    method: str
    step: float = 0  # s; HHT, RK4
    hht_alpha: float = 0
    rtol: float = 0
    atol_factor: float = 0

    @property
    def family(self) -> Variant:
        """The same for all variants that differ only in how fine they are."""
        return replace(self, step=0, rtol=0)


@dataclass(frozen=True)
class Result:
    """One run: CPU seconds and steps of the integration, errors, and "ok" or why it failed."""

    seconds: float = nan
    steps: int = 0
    H: float = nan
    frame: float = nan
    force: float = nan
    status: str = "ok"


COLUMNS = {
    "study": "study",
    "inertia": "J [kg.m2]",
    "periods": "periods",
    "method": "method",
    "step": "step [s]",
    "hht_alpha": "hht_alpha",
    "rtol": "rtol",
    "atol_factor": "atol_factor",
    "seconds": "CPU time [s]",
    "steps": "steps",
    "H": "error of H",
    "frame": "error of upper frame",
    "force": "error of contact force",
    "status": "status",
}


def to_row(run: tuple[Variant, Result]) -> list[object]:
    """The cells of a run, in the order of COLUMNS."""
    values = {**asdict(run[0]), **asdict(run[1])}
    return [values[name] for name in COLUMNS]


def from_row(row: Mapping[str, str]) -> tuple[Variant, Result]:
    """What `to_row` was given, by column name. Raises KeyError or ValueError for another row."""
    kinds: dict[str, Callable[[str], Any]] = {"str": str, "int": int, "float": lambda cell: float(cell or "nan")}

    def values(kind: type[Variant | Result]) -> dict[str, Any]:
        return {f.name: kinds[str(f.type)](row[COLUMNS[f.name]]) for f in fields(kind)}

    return Variant(**values(Variant)), Result(**values(Result))


def variants(parameters: Mapping[str, Value], periods: int, quick: bool) -> list[Variant]:
    """All variants of both studies; `quick` takes a few of each."""
    few = slice(None, None, 3 if quick else 1)
    given = parameters["zspring.J1"]
    precision = Variant("precision", given, periods, "")
    longest = STABILITY["RK4"] * given / (parameters["zspring.Mf"] * parameters["zspring.tau"])
    found = [
        replace(precision, method="HHT", step=step, hht_alpha=hht_alpha)
        for hht_alpha in HHT_ALPHAS[few]
        for step in HHT_STEPS[few]
    ]
    found += [replace(precision, method="RK4", step=factor * longest) for factor in RK4_STEPS[few]]
    found += [
        replace(precision, method=method, rtol=rtol, atol_factor=factor)
        for method in ("RK45", *STIFF)
        for factor in ATOL_FACTORS[few]
        for rtol in TOLERANCES[few]
    ]
    for inertia in INERTIAS[:5:4] if quick else INERTIAS:
        base = Variant("inertia", inertia, INERTIA_PERIODS, "")
        found += [replace(base, method="HHT", step=step, hht_alpha=-0.3) for step in HHT_STEPS[few]]
        found += [replace(base, method="RK45", rtol=rtol, atol_factor=0.1) for rtol in (1e-3, 1e-4)]
        found += [
            replace(base, method=method, rtol=rtol, atol_factor=0.1)
            for method in STIFF
            for rtol in (1e-2, 1e-3, 1e-4, 1e-5)
        ]
    return found


class Laboratory:
    """Runs variants on one FMU instance and on the peers; problems are solved when first needed.

    parameters      all of the FMU, calculated ones included; frequency in Hz, acceleration in m/s2
    """

    def __init__(self, instance: Instance, parameters: Mapping[str, Value], frequency: float, acceleration: float):
        settable = set(instance.variables.names("parameter"))
        self._instance, self._parameters = instance, dict(parameters)
        self._settable = {name: value for name, value in parameters.items() if name in settable}
        self._frequency, self._acceleration = frequency, acceleration
        self._problems: dict[tuple[str, float, int], Problem] = {}

    def problem(self, variant: Variant) -> Problem:
        """The problem of a variant."""
        key = (variant.study, variant.inertia, variant.periods)
        if key not in self._problems:
            parameters = {**self._parameters, **_inertia(variant)}
            self._problems[key] = Problem(parameters, self._frequency, self._acceleration, variant.periods)
        return self._problems[key]

    def run(self, variant: Variant) -> Result:
        """One timed run."""
        problem = self.problem(variant)
        try:
            if variant.method == "HHT":
                return self._run_fmu(variant, problem)
            if variant.method == "RK4":
                run = rk4(problem.model, problem.times, variant.step)
            else:
                run = solve(variant.method, problem.model, problem.times, variant.rtol, variant.atol_factor)
        except (SolverFailed, StepDiscarded) as error:
            return Result(status=str(error))
        return Result(run.seconds, run.steps, **asdict(problem.errors_of_states(run.states)))

    def _run_fmu(self, variant: Variant, problem: Problem) -> Result:
        """The whole run in one communication step, timed; then again, the last period step by step."""
        settings = {"solver.step": variant.step, "solver.alpha": variant.hht_alpha}
        bench = FmuBench(self._instance, {**self._settable, **_inertia(variant), **settings})
        bench.start(self._frequency, self._acceleration)
        begin = clock()
        self._instance.step(0, problem.end)
        seconds = clock() - begin
        steps, real, imaginary = self._instance.get(["solver.steps", "bench.H_re", "bench.H_im"])

        bench.start(self._frequency, self._acceleration)
        bench.run(variant.periods)
        count = round(steps / (1 + variant.periods))
        times = problem.end - np.arange(count, -1, -1) / (count * self._frequency)
        outputs = ["upper_frame.z", "contact.force"]
        seen = [self._instance.get(outputs)]
        for begin, end in itertools.pairwise(times):
            self._instance.step(begin, end - begin)
            seen.append(self._instance.get(outputs))
        frame, force = np.array(seen).T
        force -= self._parameters["static_force"]
        errors: Errors = problem.errors(times, frame, force, complex(real, imaginary))
        return Result(seconds, int(steps), **asdict(errors))


def _inertia(variant: Variant) -> dict[str, float]:
    """Parameters that a variant changes in the problem."""
    if variant.study == "precision":
        return {}
    return {"zspring.J1": variant.inertia, "zspring.J2": variant.inertia}
