"""One hysteresis loop of the head suspension: a blocked frame, the head moved at constant speed.

A free frame cannot be loaded slowly: on its soft spring k3 it follows the head. So k2 and k3 are made very
stiff, as a bench that clamps the upper frame, and force is read against head minus upper frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..fmu import Instance
from ..variables import Value

CLAMP = "1e9"  # N/m, of k2 and k3: a hundred thousand times the suspension
SETTINGS = ["drive=Displacement", f"k2={CLAMP}", f"k3={CLAMP}"]
SET_HERE = ("drive", "friction", "k2", "k3", "solver.step")
POINTS = 400  # of a loop, a multiple of 4
CYCLES = 3  # the last one is the loop: by then the start from rest is forgotten
LONGEST_STEP = 0.02  # s, internal; nothing in a slow test is faster

_OUTPUTS = ["head.z", "upper_frame.z", "contact.force", "head.a", "energy.dissipated"]


@dataclass(frozen=True)
class Loop:
    """A closed loop that begins and ends at the largest compression."""

    law: str
    rate: float  # m/s, speed of the head
    amplitude: float  # m, peak of its motion
    compression: np.ndarray  # (POINTS + 1,) in m: upper frame minus head, zero in the static state
    force: np.ndarray  # (POINTS + 1,) in N: what the suspension carries beyond the static state
    dissipated: float  # J, in one cycle, as the FMU counts it

    @property
    def stiffness(self) -> float:
        """Secant from peak to peak in N/m."""
        half = POINTS // 2
        return float((self.force[0] - self.force[half]) / (self.compression[0] - self.compression[half]))

    @property
    def area(self) -> float:
        """Area of the loop in J."""
        return float(np.sum(np.diff(self.compression) * (self.force[1:] + self.force[:-1]) / 2))


def measure_loop(instance: Instance, parameters: Mapping[str, Value], law: str, rate: float, amplitude: float) -> Loop:
    """Move the head to and fro between +/- `amplitude` (m) at `rate` (m/s) under a friction law by name.

    The head's own inertia, felt where the motion turns, is taken from the force.
    Raises FmuError when the FMU refuses a parameter.
    """
    step = 4 * amplitude / (rate * POINTS)
    settings = instance.variables.parse_assignments([*SETTINGS, f"friction={law}"])
    instance.start({**parameters, **settings, "solver.step": min(step, LONGEST_STEP)})
    mass, static_force = instance.get(["m1", "static_force"])
    count = CYCLES * POINTS + POINTS // 4  # to the largest compression, then whole cycles
    phase = np.arange(count + 1) / POINTS
    targets = -amplitude * np.interp(phase % 1, [0, 0.25, 0.75, 1], [0, 1, -1, 0])
    samples = []
    for i in range(count):
        instance.set({"head_displacement": float(targets[i])})
        instance.set_slopes({"head_displacement": float(targets[i + 1] - targets[i]) / step})
        instance.step(i * step, step)
        samples.append(instance.get(_OUTPUTS))
    head, frame, force, acceleration, dissipated = np.array(samples[-POINTS - 1 :]).T
    return Loop(
        law,
        rate,
        amplitude,
        compression=frame - head,
        force=force - static_force + mass * acceleration,
        dissipated=float(dissipated[-1] - dissipated[0]),
    )
