"""A grid of hard steps for the pantograph's Newton iteration: what it costs, what is halved, what is discarded.

Each run makes STEPS communication steps of one internal step each, under a load that is as rough as it can be.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from zspring.fmu import Fmu, Instance, StepDiscarded

STEPS = 24
STEP_SIZES = (1e-5, 1e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)  # s
FRICTION_MOMENTS = tuple(10.0**k for k in range(-3, 4))  # N.m
REGULARIZATIONS = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)  # s
LAWS = {"Regularized": 1, "Coulomb": 2}
FORCE, DISPLACEMENT, WIRE = 1, 2, 3


@dataclass(frozen=True)
class Load:
    """`value(n)` of `name` is set before step n = 0, 1, ..."""

    drive: int
    name: str
    value: Callable[[int], float]


def square(n: int) -> float:
    """1 and 0 in turns of eight steps."""
    return 1.0 - n // 8 % 2


def loads() -> dict[str, list[Load]]:
    return {
        "force steps to 0 and of 0.1 ... 10 kN": [
            Load(FORCE, "contact_force", lambda n, F=F: 120 + F * square(n)) for F in (-120.0, 100.0, 1e3, 1e4)
        ],
        "wire steps of 1 ... 100 mm up": [
            Load(WIRE, "wire_height", lambda n, z=z: z * square(n)) for z in (0.001, 0.01, 0.1)
        ],
        "wire steps of 1 ... 100 mm down": [
            Load(WIRE, "wire_height", lambda n, z=z: -z * square(n)) for z in (0.001, 0.01, 0.1)
        ],
        "contact lost and back each step": [
            Load(WIRE, "wire_height", lambda n, z=z: z * (-1) ** n) for z in (0.005, 0.05)
        ],
        "head on a sine of 10 ... 100 mm": [
            Load(DISPLACEMENT, "head_displacement", lambda n, z=z: z * np.sin(2 * np.pi * n / STEPS))
            for z in (0.01, 0.05, 0.1)
        ],
    }


@dataclass
class Effort:
    """What the solver did."""

    steps: int = 0
    iterations: int = 0
    worst: int = 0
    halvings: int = 0
    discarded: int = 0

    def add(self, other: Effort) -> None:
        self.steps += other.steps
        self.iterations += other.iterations
        self.worst = max(self.worst, other.worst)
        self.halvings += other.halvings
        self.discarded += other.discarded


def run(instance: Instance, load: Load, parameters: dict[str, float], h: float) -> Effort:
    instance.start({"drive": load.drive, "solver.step": h, **parameters})
    effort, t = Effort(), 0.0
    for n in range(STEPS):
        instance.set({load.name: float(load.value(n))})
        try:
            instance.step(t, h)
            t += h
        except StepDiscarded:
            effort.discarded += 1
    names = ["solver.steps", "solver.iterations", "solver.iterations_max", "solver.refinements"]
    effort.steps, effort.iterations, effort.worst, effort.halvings = map(int, instance.get(names))
    return effort


def grid(fmu: Fmu) -> Iterator[tuple[str, str, float, Effort]]:
    """Load, law, step size and effort of each point."""
    with fmu.instances() as (instance,):
        for (name, variants), (law, number), h in product(loads().items(), LAWS.items(), STEP_SIZES):
            for load, Mf, tau in product(variants, FRICTION_MOMENTS, REGULARIZATIONS):
                if law == "Coulomb" and tau != REGULARIZATIONS[0]:
                    continue  # knows no tau
                parameters = {"friction": number, "zspring.Mf": Mf, "zspring.tau": tau}
                yield name, law, h, run(instance, load, parameters, h)
