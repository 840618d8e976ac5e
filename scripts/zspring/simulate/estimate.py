"""What the internal step costs in accuracy: the same run at half of it, output by output."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..text_tables import aligned

LIMIT = 0.01  # of an output's range; a larger error in the root mean square is warned of


@dataclass(frozen=True)
class Estimate:
    """Error of one output, in its unit, as a method of second order has it: 4/3 of the difference to half the step."""

    name: str
    unit: str
    rms: float
    largest: float
    at: float  # s, where it is largest
    range: float  # largest less smallest value in the run

    @property
    def relative(self) -> float:
        """The root mean square over the range; 0 for an output that stays and has no error."""
        return self.rms / self.range if self.range else (math.inf if self.rms else 0.0)


def half_step(solver_step: float, step: float) -> float:
    """solver.step in s with which each internal step is half as long: those of a communication step are equal."""
    return step / math.ceil(step / solver_step * (1 - 1e-12)) / 2


def estimates(
    names: Mapping[str, str], time: np.ndarray, values: Sequence[np.ndarray], finer: Sequence[np.ndarray]
) -> list[Estimate]:
    """The estimates of these outputs, from their values (n,) in both runs; `names` are with their units."""
    found = []
    for (name, unit), value, other in zip(names.items(), values, finer):
        error = 4 / 3 * np.abs(value - other)
        worst = int(error.argmax())
        rms = float(np.sqrt(np.mean(error**2)))
        found.append(Estimate(name, unit, rms, float(error[worst]), float(time[worst]), float(np.ptp(value))))
    return found


def table(found: Sequence[Estimate]) -> list[str]:
    """Lines: root mean square, largest and where, range and the share of it."""
    rows = [["error estimate", "rms", "largest", "at", "range", "rms/range"]]
    for one in found:
        numbers = [f"{one.rms:.2g} {one.unit}", f"{one.largest:.2g} {one.unit}", f"{one.at:.3f} s"]
        share = f"{100 * one.relative:.2g} %" if math.isfinite(one.relative) else ""
        rows.append([one.name, *numbers, f"{one.range:.3g} {one.unit}", share])
    return aligned(rows, right=True)


def warning(found: Sequence[Estimate]) -> str | None:
    """One line for the outputs beyond the limit, the worst first."""
    beyond = sorted((one for one in found if one.relative > LIMIT), key=lambda one: -one.relative)
    if not beyond:
        return None
    listed = ", ".join(f"{one.name} {100 * one.relative:.2g} %" for one in beyond)
    return (
        f"the internal step's error exceeds {100 * LIMIT:g} % of the range (rms) in {listed}: take a smaller "
        "--set solver.step"
    )
