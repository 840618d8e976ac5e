"""Steps of the FMU recorded on its bench: all that is needed to solve one of them again elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from zspring.fmu import Instance
from zspring.variables import Value

SETTLING_PERIODS = 20

_POSITIONS = ["head.z", "zspring.alpha", "zspring.beta", "upper_frame.z", "lower_frame.z"]
_VELOCITIES = ["head.v", "upper_frame.v", "lower_frame.v"]
_RODS = ["zspring.alpha", "zspring.beta"]


@dataclass(frozen=True)
class Recording:
    """Consecutive internal steps of equal length; degrees of freedom u1, alpha, beta, u2, u3."""

    parameters: Mapping[str, Value]  # of the FMU, calculated ones included
    step: float  # s
    time: np.ndarray  # (n,) in s, since the first sample
    q: np.ndarray  # (n, 5) in m and rad; u from the static state
    v: np.ndarray  # (n, 5) in m/s and rad/s
    a: np.ndarray  # (n, 5), see `newmark_accelerations`; NaN in the first row


def record(
    instance: Instance,
    parameters: Mapping[str, Value],
    frequency: float,
    acceleration: float,
    settling_periods: int = SETTLING_PERIODS,
) -> Recording:
    """One period on the bench, one communication step for each internal step.

    frequency in Hz, peak acceleration in m/s2. Raises FmuError when the FMU refuses a parameter or a step.
    """
    variables = instance.variables
    instance.start(
        {
            **parameters,
            **variables.parse_assignments(["drive=Bench"]),
            "bench.frequency": frequency,
            "bench.acceleration": acceleration,
        }
    )
    names = variables.names("parameter", "calculatedParameter")
    used = dict(zip(names, instance.get(names)))
    period = 1 / frequency
    (count,) = map(int, instance.get(["bench.steps_per_period"]))
    step = period / count
    begin = settling_periods * period
    if settling_periods:
        instance.step(0, begin)
    positions, velocities = [], []
    for i in range(count + 1):
        instance.step(begin + i * step, step)
        positions.append(instance.get(_POSITIONS))
        head, upper, lower = instance.get(_VELOCITIES)
        velocities.append([head, *instance.get_slopes(_RODS), upper, lower])
    q, v = np.array(positions), np.array(velocities)
    a = newmark_accelerations(q, v, step, used["solver.alpha"])
    return Recording(used, step, step * np.arange(count + 1), q, v, a)


def newmark_accelerations(q: np.ndarray, v: np.ndarray, h: float, hht_alpha: float) -> np.ndarray:
    """HHT's accelerations (n, 5) at the end of each step, from positions and velocities (n, 5) at both ends.

    They are no outputs, but Newmark's two formulas tie them to what is:

        v1 = v0 + h ((1 - gamma) a0 + gamma a1),   q1 = q0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1)

    Their determinant is hht_alpha^2 / 4: no answer for hht_alpha = 0.
    """
    beta, gamma = newmark(hht_alpha)
    coefficients = np.array([[1 - gamma, gamma], [0.5 - beta, beta]])
    right = np.stack([(v[1:] - v[:-1]) / h, (q[1:] - q[:-1] - h * v[:-1]) / h**2])
    a = np.full_like(q, np.nan)
    a[1:] = np.tensordot(np.linalg.inv(coefficients), right, 1)[1]
    return a


def newmark(hht_alpha: float) -> tuple[float, float]:
    """beta and gamma of HHT-alpha (Hilber, Hughes, Taylor 1977)."""
    return (1 - hht_alpha) ** 2 / 4, 0.5 - hht_alpha
