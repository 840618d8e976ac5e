"""Random parameter sets of both FMUs, sensible and far from it, and what a run with one of them must be.

A set is drawn around the start values, by up to a factor 3, 1e3 or 1e6 in each number, with some at their bounds.
Either the FMU refuses it with one line, or it runs under jumping inputs and steps of many lengths; a step that it
cannot make it discards with one line. Of what it calls good, here is checked that

- every value is finite, energies and losses are not negative, a unilateral contact does not pull, an anchor holds;
- Newton's method has converged (sensible sets): the same run with a tolerance of 1e-13 gives the same values. The
  tolerance is one of forces relative to the largest, so where forces differ by ten orders of magnitude, or where a
  light head bounces on a rigid wire, the rest of it may move what is small: such sets outside the sensible are
  counted as sensitive.
- energy is balanced (sensible sets): what the balance lacks is small, or vanishes with the internal step.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, FmuError, Instance, StepDiscarded, installed_fmu

DECADES = {"sensible": 0.5, "outside": 3.0, "far outside": 6.0}
STEPS = 20
ROUNDING = 1e-6  # J; a soft spring holds the load with a strain energy of many MJ
ENERGIES = ("energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work")


@dataclass
class Tally:
    """What became of the sets, by kind, and the worst that was seen."""

    outcomes: Counter = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    refined: int = 0  # balance their energy with finer steps only
    sensitive: int = 0  # depend on the last digits
    worst_error: float = 0.0

    def __add__(self, other: Tally) -> Tally:
        return Tally(
            self.outcomes + other.outcomes,
            self.faults + other.faults,
            self.refined + other.refined,
            self.sensitive + other.sensitive,
            max(self.worst_error, other.worst_error),
        )


def choose(rng: np.random.Generator, start: float, low: float | None, high: float | None, decades: float) -> float:
    low, high = -np.inf if low is None else low, np.inf if high is None else high
    if rng.random() < 0.05 and np.isfinite(low):
        return low
    if start == 0:
        return 0.0 if rng.random() < 0.7 else float(np.clip(10 ** rng.uniform(-2, decades - 1), low, high))
    return float(np.clip(start * 10 ** rng.uniform(-decades, decades), low, high))


def random_set(fmu: Fmu, rng: np.random.Generator, decades: float) -> dict[str, float]:
    """Values for all parameters that describe the model, and for those of the solver within what is affordable."""
    values: dict[str, float] = {}
    share = rng.uniform(0.1, 1)  # of the parameters that leave their start value
    for v in fmu.variables:
        if v.causality != "parameter" or v.name.startswith(("solver", "mesh", "point", "dropper.pos", "line.spans")):
            continue
        if v.declaredType:
            values[v.name] = int(rng.integers(1, 1 + len(v.declaredType.items)))
        elif v.type == "Real" and rng.random() < share and v.name != "bench.frequency":
            bounds = (None if x is None else float(x) for x in (v.min, v.max))
            values[v.name] = choose(rng, float(v.start), *bounds, decades)
    return values | MODELS[fmu.description.modelName].affordable(rng)


@dataclass(frozen=True)
class Pantograph:
    outputs = ("head.z", "head.v", "upper_frame.z", "lower_frame.z", "zspring.alpha", "zspring.beta")
    forces = ("contact.force", "zspring.moment_alpha", "zspring.moment_beta")
    counters = ("solver.steps", "solver.refinements")
    iterates = True
    unilateral = (1, 3)  # drives
    held = ()

    def affordable(self, rng: np.random.Generator) -> dict[str, float]:
        return {"solver.step": 10 ** rng.uniform(-4, -2), "bench.frequency": 10 ** rng.uniform(-1, 1.5)}

    def inputs(self, rng: np.random.Generator, values: Mapping[str, float]) -> dict[str, float]:
        height = rng.uniform(-0.02, 0.02)
        return {
            "contact_force": values.get("static_force", 120.0) * rng.uniform(0.5, 1.5),
            "head_displacement": height,
            "wire_height": height,
            "uplift.head": rng.uniform(-20, 20),
        }


@dataclass(frozen=True)
class Catenary:
    outputs = ("pantograph[1].wire_height", "pantograph[2].wire_velocity", "support.uplift[2]", "support.uplift[1]")
    forces = ("droppers.force_max",)
    counters = ("solver.steps",)
    iterates = False
    unilateral = ()
    held = ("support.uplift[1]",)

    def affordable(self, rng: np.random.Generator) -> dict[str, float]:
        return {
            "line.spans": int(rng.integers(1, 4)),
            "mesh.element": 5.0,
            "solver.step": 10 ** rng.uniform(-3.5, -2),
            "dropper.count": int(rng.integers(0, 10)),
        }

    def inputs(self, rng: np.random.Generator, values: Mapping[str, float]) -> dict[str, float]:
        length = values["line.spans"] * values.get("line.span", 60.0)
        return {
            f"pantograph[{i}].{name}": value
            for i in (1, 2)
            for name, value in (
                ("force", rng.uniform(0, 300)),
                ("speed", rng.uniform(0, 70)),
                ("position", length * np.clip(rng.uniform(-0.1, 1.1), 0, 1)),
            )
        }


MODELS = {PANTOGRAPH: Pantograph(), CATENARY: Catenary()}


@dataclass
class Run:
    """Outputs, energies and counters after each step made, (n, ...); why it ended, "" where it did not."""

    outputs: np.ndarray
    energies: np.ndarray
    counters: np.ndarray
    end: str


def drive(instance: Instance, model, values: Mapping[str, float], seed: int, step: float) -> Run:
    """Raises FmuError where the FMU refuses the parameters."""
    rng = np.random.default_rng(seed)
    names = (*model.outputs, *model.forces, *ENERGIES)
    instance.start(values, model.inputs(rng, values))
    rows, counters, t, end = [instance.get(names)], [instance.get(model.counters)], 0.0, ""
    try:
        for _ in range(STEPS):
            instance.set(model.inputs(rng, values))
            h = step * 10 ** rng.uniform(-1.5, 0.5)
            instance.step(t, h)
            t += h
            rows.append(instance.get(names))
            counters.append(instance.get(model.counters))
    except StepDiscarded as discarded:
        end = str(discarded)
    rows = np.array(rows, float)
    return Run(rows[:, : -len(ENERGIES)], rows[:, -len(ENERGIES) :], np.array(counters, float), end)


def balance(run: Run) -> float:
    """Largest lack of the energy balance, relative to the energy that went through."""
    kinetic, elastic, dissipated, work = run.energies.T
    lack = np.abs((kinetic + elastic + dissipated - work) - (kinetic + elastic + dissipated - work)[0])
    through = np.abs(np.diff(work, prepend=work[0])).cumsum() + kinetic + np.abs(elastic - elastic[0])
    return float(lack.max() / (through.max() + ROUNDING))


def difference(model, run: Run, precise: Run) -> float:
    """Largest difference of two runs while their internal steps are the same, relative to the outputs' size."""
    n = min(len(run.counters), len(precise.counters))
    same = np.cumprod((run.counters[:n] == precise.counters[:n]).all(axis=1)).astype(bool)
    a, b = run.outputs[:n][same], precise.outputs[:n][same]
    k = len(model.outputs)
    scale = np.maximum(np.abs(b).max(axis=0), 1e-3)  # m, m/s, rad, N: what is smaller is nothing
    scale[k:] = np.maximum(scale[k:], np.abs(b[:, k:]).max())
    return float((np.abs(a - b) / scale).max())


def judge(instance: Instance, fmu: Fmu, seed: int, kind: str, tally: Tally) -> None:
    """Run one random set, count what became of it and note any fault."""
    rng = np.random.default_rng(seed)
    model = MODELS[fmu.description.modelName]
    values = random_set(fmu, rng, DECADES[kind])
    step = 4 * values["solver.step"]

    def fault(text: str) -> None:
        tally.faults.append(f"{kind}, seed {seed}: {text}")

    def run_with(**solver: float) -> Run:
        changed = {f"solver.{name}": value for name, value in solver.items()}
        return drive(instance, model, values | changed, seed, step)

    try:
        run = run_with()
    except StepDiscarded:
        return fault("discarded before the first step")
    except FmuError as refusal:
        tally.outcomes["refused"] += 1
        return None if len(str(refusal).splitlines()) == 1 else fault(str(refusal))
    tally.outcomes["discarded" if run.end else "ran"] += 1
    if run.end and len(run.end.splitlines()) != 1:
        fault(run.end)
    if not (np.isfinite(run.outputs).all() and np.isfinite(run.energies).all()):
        return fault("not finite")
    if (run.energies[:, [0, 2]] < 0).any():
        fault("negative energy")
    if values.get("drive") in model.unilateral and (run.outputs[:, len(model.outputs)] < 0).any():
        fault("the contact pulls")
    if run.outputs[:, [model.outputs.index(name) for name in model.held]].any():
        fault("an anchor moves")
    if model.iterates:
        tested = run if kind == "sensible" else run_with(tolerance=1e-11, max_iterations=400)
        error = difference(model, tested, run_with(tolerance=1e-13, max_iterations=400))
        if kind == "sensible":
            tally.worst_error = max(tally.worst_error, error)
        if error > 1e-4:
            tally.sensitive += 1
            if kind == "sensible":
                fault(f"not converged: {error:.1e}")
    # An imposed position that jumps in straight lines has no energy balance.
    if kind == "sensible" and values.get("drive") != 2 and balance(run) > 0.02:
        tally.refined += 1
        lacks = [balance(run_with(step=max(1e-6, values["solver.step"] / finer))) for finer in (8, 64, 512)]
        if min(lacks) > 0.02:
            fault(f"the energy balance lacks {balance(run):.1e}, with finer steps {lacks}")


def judge_all(model: str, kind: str, seeds: Sequence[int]) -> Tally:
    tally = Tally()
    with Fmu(installed_fmu(model)) as fmu, fmu.instances() as (instance,):
        for seed in seeds:
            judge(instance, fmu, seed, kind, tally)
    return tally
