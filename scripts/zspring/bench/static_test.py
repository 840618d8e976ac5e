"""Static test of the head suspension: force against displacement with the frame blocked.

A table as `tables.py` reads it, with the columns

    displacement [m]        of the head against the blocked frame, upward, from the static state
    force [N]               on the head, positive upward as the displacement (a load cell in compression under
                            the contact strip counts negative); a contact force, positive where it presses the
                            head down, is turned as that of a frequency response is
    time [s]                may be missing: then the head moves with the speed of the settings

in the order in which they were measured; the path begins in the static state at displacement 0. Means of both
forces are taken off before they are compared, so the zero of the load cell does not matter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..fmu import Instance
from ..tables import read_table
from ..variables import Value
from .curves import SENSES, WRONG_SIGN

BLOCKED_FRAME = {"k2": 1e9, "k3": 1e9}  # N/m, so stiff that the frame moves less than a micrometre
# From point to point. The FMU rounds a turn of the head over a few communication steps, so that the inertia
# in it is over when the next point is reached.
STEPS = 5


@dataclass(frozen=True)
class StaticTest:
    """Path of the head and the force on it."""

    displacement: np.ndarray  # (n,) m, upward
    force: np.ndarray  # (n,) N, upward on the head
    duration: np.ndarray  # (n,) s, of the way to each point from the one before, first from displacement 0

    @property
    def sign_warning(self) -> str | None:
        """What to say if the head gives way the wrong way, which no stable suspension does."""
        if np.sum((self.displacement - self.displacement.mean()) * (self.force - self.force.mean())) >= 0:
            return None
        return f"static test: the force falls while the head is lifted, as if the head pulled along: {WRONG_SIGN}"

    def simulated(self, instance: Instance, parameters: Mapping[str, Value]) -> np.ndarray:
        """Force (n,) in N, upward on the head, that the FMU has on the same path."""
        drive = instance.variables.parse_assignments(["drive=Displacement"])
        instance.start({**parameters, **BLOCKED_FRAME, **drive})
        time, position, forces = 0.0, 0.0, []
        for target, duration in zip(self.displacement.tolist(), self.duration.tolist()):
            for part in range(1, STEPS + 1):
                instance.set({"head_displacement": position + (target - position) * part / STEPS})
                instance.step(time + duration * (part - 1) / STEPS, duration / STEPS)
            time, position = time + duration, target
            forces += instance.get(["contact.force"])
        return -np.array(forces)


def read_static_test(path: Path, speed: float, force_sense: str = "specimen") -> StaticTest:
    """The test of a file as described above; `speed` in m/s where it has no time.

    force_sense     "specimen": positive along the displacement, "contact": positive pressing the head down

    Raises ZSpringError, with file, line and column, for missing columns or units, values that are not finite
    and time that does not increase.
    """
    table = read_table(path)
    displacement, force = table.numbers("displacement", "m"), SENSES[force_sense] * table.numbers("force", "N")
    if displacement.size < 3:
        raise ZSpringError(f"{path}: needs at least three rows")
    distance = np.abs(np.diff(displacement, prepend=0.0))
    duration = np.maximum(distance / speed, 1e-3)
    if "time" in table:
        steps = np.diff(table.numbers("time", "s"))
        if np.any(steps <= 0):
            line = table.lines[int(np.argmax(steps <= 0)) + 1]
            raise ZSpringError(f"{path}, line {line}: time must increase")
        duration[1:] = steps
    return StaticTest(displacement, force, duration)
