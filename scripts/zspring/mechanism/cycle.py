"""A steady cycle of the linkage on the FMU's bench."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..fmu import Instance
from ..linkage import linkage_points
from ..variables import Value

SETTLING_PERIODS = 40
FRAMES = 120  # in a cycle

_OUTPUTS = ["head.z", "zspring.alpha", "zspring.beta", "upper_frame.z", "zspring.moment_alpha", "zspring.moment_beta"]


@dataclass(frozen=True)
class Cycle:
    """States over one period, FRAMES of them."""

    frequency: float  # Hz
    acceleration: float  # m/s2, peak, of the head
    parameters: Mapping[str, Value]  # of the FMU, calculated ones included
    u1: np.ndarray  # (n,) in m, from the static state, as u2
    alpha: np.ndarray  # (n,) in rad, as beta
    beta: np.ndarray
    u2: np.ndarray
    moments: np.ndarray  # (n, 2) in N.m, friction in the joints of alpha and beta

    @property
    def compression(self) -> np.ndarray:
        """(n,) in m, upper frame minus head, zero in the static state."""
        return self.u2 - self.u1

    @property
    def extremes(self) -> tuple[int, int]:
        """Where the head is farthest below and above its static place on the frame."""
        return int(self.compression.argmax()), int(self.compression.argmin())

    @property
    def swing(self) -> float:
        """Rod angle from one end to the other, in rad, the larger of both rods."""
        return float(max(np.ptp(self.alpha), np.ptp(self.beta)))

    @property
    def slips(self) -> bool:
        """Whether the rods take part: more than a tenth of what they do with free joints in the static state.

        There a compression x turns a rod by about x cos(theta) / D, D = d / cos(theta) between the joints.
        """
        cos = math.cos(self.parameters["zspring.theta"])
        free = np.ptp(self.compression) * cos**2 / self.parameters["zspring.d"]
        return self.swing > 0.1 * free

    def points(self, magnification: float = 1.0, on_frame: bool = False) -> np.ndarray:
        """(n, 4, 2) in m, as `linkage_points`, with all motion from the static state magnified.

        on_frame    as seen from the upper frame
        """
        theta = self.parameters["zspring.theta"]
        origin = self.u2 if on_frame else np.zeros_like(self.u2)
        return linkage_points(
            self.parameters,
            magnification * (self.u1 - origin),
            theta + magnification * (self.alpha - theta),
            theta + magnification * (self.beta - theta),
            magnification * (self.u2 - origin),
        )


def simulate_cycle(instance: Instance, parameters: Mapping[str, Value], frequency: float, acceleration: float) -> Cycle:
    """One steady period; frequency in Hz, peak acceleration in m/s2. Raises FmuError when the FMU refuses."""
    variables = instance.variables
    bench = {"bench.frequency": frequency, "bench.acceleration": acceleration}
    instance.start({**parameters, **variables.parse_assignments(["drive=Bench"]), **bench})
    names = variables.names("parameter", "calculatedParameter")
    used = dict(zip(names, instance.get(names)))
    begin, step = SETTLING_PERIODS / frequency, 1 / (frequency * FRAMES)
    instance.step(0, begin)
    states = []
    for i in range(FRAMES):
        states.append(instance.get(_OUTPUTS))
        instance.step(begin + i * step, step)
    u1, alpha, beta, u2, *moments = np.array(states).T
    return Cycle(frequency, acceleration, used, u1, alpha, beta, u2, np.stack(moments, -1))
