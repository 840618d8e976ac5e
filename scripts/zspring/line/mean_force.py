"""Target mean contact forces by speed, as the standards give them (quoted in papers: check before use), and the
uplift with which a run has them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..errors import ZSpringError
from .evaluated import sections
from .result import LineResult
from .run import run_line
from .statistics import statistics
from .system import System

AERODYNAMIC = 0.00097  # N/(km/h)^2
STANDING = {"AC": 70.0, "DC-3kV": 110.0, "DC-1.5kV": 140.0}  # N
TOLERANCE = 0.1  # N, of a mean force that is solved for
MOST_RUNS = 8
LEAST_SLOPE = 0.2  # of a mean force by its uplift, which is 1 where no spring to the base carries a part


def mean_force(supply: str, speed: float) -> float:
    """Target mean force in N at `speed` in km/h for a supply of STANDING."""
    return STANDING[supply] + AERODYNAMIC * speed**2


def uplifts_for(
    target: float, first: Sequence[float], means: Callable[[tuple[float, ...]], Sequence[float]]
) -> tuple[float, ...]:
    """The uplifts, N, of each pantograph with which each one's mean force is `target` N, to TOLERANCE.

    first   uplifts to begin with
    means   makes a run with these uplifts: the mean forces, N
    By the secant method, each pantograph for itself, as one hardly changes the mean of the other. Raises
    ZSpringError where MOST_RUNS are not enough.
    """
    uplifts, slope, before = np.array(first, dtype=float), np.ones(len(first)), None
    change = np.zeros(len(first))
    for _ in range(MOST_RUNS):
        found = np.asarray(means(tuple(uplifts.tolist())))
        if np.all(np.abs(target - found) <= TOLERANCE):
            return tuple(uplifts.tolist())
        if before is not None:
            known = np.abs(change) > TOLERANCE
            slope[known] = np.maximum((found - before)[known] / change[known], LEAST_SLOPE)
        later = np.round(uplifts + (target - found) / slope, 3)  # to what a file of results keeps
        change, before, uplifts = later - uplifts, found, later
    shown = ", ".join(f"{mean:.1f}" for mean in found)
    raise ZSpringError(f"mean force = {shown} N after {MOST_RUNS} runs: {target:.1f} N is not reached by an uplift")


def static_uplifts(system: System, target: float) -> tuple[float, ...]:
    """The uplifts, N, that together with static_force are `target` N: the mean force, but for what the waves of a few
    spans and a spring between pantograph and base make of it."""
    return tuple(target - force for force in system.of_each("static_force"))


def run_aimed(
    system: System, target: float, spans: tuple[int, int] | None, run: Callable[[System], LineResult] = run_line
) -> tuple[tuple[float, ...], LineResult, list[float]]:
    """The uplifts, N, that give each pantograph a mean force of `target` N, their run, and the mean forces, N.

    spans   evaluated; None: those of `sections`
    Raises ZSpringError where no uplifts do, or where no whole span is evaluated; and what `run` raises.
    """
    last: list[tuple[LineResult, list[float]]] = []

    def means(uplifts: tuple[float, ...]) -> list[float]:
        result = run(replace(system, journey=replace(system.journey, uplift=uplifts)))
        chosen = sections(result, system.extent, spans)
        if None in chosen:
            raise ZSpringError("a mean force is aimed at, but the run goes through no whole span after the first one")
        found = [statistics(result.series(i), section)["mean_force"] for i, section in enumerate(chosen)]
        last[:] = [(result, found)]
        return found

    return uplifts_for(target, static_uplifts(system, target), means), *last[0]
