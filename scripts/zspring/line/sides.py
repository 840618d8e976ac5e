"""Catenary and pantograph as the master sees them: one step under given values, and how it answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from ctypes import Array, c_double

from .calls import Jacobian, PreparedCalls


class Wire:
    """The catenary under the forces of all pantographs.

    datum   m, what its heights under the pantographs are measured from
    """

    def __init__(self, calls: PreparedCalls, datum: Sequence[float]):
        count = len(datum)

        def names(variable: str) -> list[str]:
            return [f"pantograph[{i + 1}].{variable}" for i in range(count)]

        self.save, self.restore, self._step = calls.save, calls.restore, calls.step
        self._count, self._datum = count, datum
        self.steps = 0  # made, those that were taken back included
        self._forces = calls.reals(names("force"))
        self._motion = calls.reals(names("wire_height") + names("wire_velocity"))
        self._map = calls.reals(names("free_height") + names("compliance") + names("compliance_previous"))
        self._compliance = Jacobian(calls, names("wire_height"), names("force"))
        self.look()

    def look(self) -> None:
        """Take `heights` in m and `velocities` in m/s, at the contacts, from the FMU."""
        motion = self._motion.get()
        self.heights = [height + datum for height, datum in zip(motion, self._datum)]
        self.velocities = motion[self._count :]

    def step(self, time: float, size: float, forces: Sequence[float]) -> None:
        """One step at whose end the contact forces, N, are these; looks at where the wire then is."""
        self.step_unseen(time, size, forces)
        self.look()

    def step_unseen(self, time: float, size: float, forces: Sequence[float]) -> None:
        self._forces.set(forces)
        self._step(time, size)
        self.steps += 1

    def maps(self) -> Iterator[tuple[float, float, float]]:
        """Of each pantograph's wire at the end of the next step: height without force, m, and by the forces then and
        at the begin, m/N."""
        values, count = self._map.get(), self._count
        for i, datum in enumerate(self._datum):
            yield values[i] + datum, values[count + i], values[2 * count + i]

    def compliance(self) -> list[Array[c_double]]:
        """Heights at the end of the last step by the forces there, m/N: [i][j] is height j by force i."""
        return self._compliance.get()


class ContactInPantograph:
    """A pantograph in drive Wire, which solves the contact itself."""

    def __init__(self, calls: PreparedCalls):
        self.save, self.restore, self._step = calls.save, calls.restore, calls.step
        self._wire, self._force = calls.reals(["wire_height"]), calls.reals(["contact.force"])
        self._map = calls.reals(["wire_height", "wire.compliance", "wire.compliance_previous"])
        self._stiffness = Jacobian(calls, ["contact.force"], ["wire_height"])
        self.force = self._force.get()[0]

    def step(self, time: float, size: float, height: float, _force: float) -> float:
        """The contact force, N, after a step at whose end the wire is at `height` m."""
        self._wire.set((height,))
        self._step(time, size)
        return self._force.get()[0]

    explicit_step = step

    def meet(self, time: float, size: float, free: float, compliance: float, previous: float) -> float:
        """The contact force, N, after a step on a wire that gives way to it; m, m/N."""
        self._map.set((free, compliance, previous))
        self._step(time, size)
        return self._force.get()[0]

    def slopes(self) -> tuple[float, float]:
        """Of the last answer by the wire's height, N/m, and by the force that acted, 1."""
        return self._stiffness.get()[0][0], 0.0


class ContactInMaster:
    """A pantograph in drive Force, and between it and the wire max(0, static_force + contact.k (z - height))."""

    def __init__(self, calls: PreparedCalls, static_force: float, stiffness: float):
        self.save, self.restore, self._step = calls.save, calls.restore, calls.step
        self._static_force, self._stiffness = static_force, stiffness
        self._applied, self._head = calls.reals(["contact_force"]), calls.reals(["head.z", "head.v"])
        self._receptance = Jacobian(calls, ["head.z"], ["contact_force"])
        self._closed = True
        self.force = static_force  # at the begin of the step

    def step(self, time: float, size: float, height: float, force: float) -> float:
        """The contact force, N, of the law after a step in which the applied one, N, ends at `force`."""
        self._applied.set((self.force,))
        self._applied.set_slopes(((force - self.force) / size,))
        self._step(time, size)
        return self._law(self._head.get()[0], height)

    def explicit_step(self, time: float, size: float, height: float, _force: float) -> float:
        """One step under the law's force for the head as it will be if it keeps its velocity."""
        position, velocity = self._head.get()
        force = self._law(position + size * velocity, height)
        self.step(time, size, height, force)
        return force

    def slopes(self) -> tuple[float, float]:
        """Of the last answer by the wire's height, N/m, and by the force that acted, 1.

        The FMU knows the derivative by a force held during the step, which is up to three times that by one
        that rises to its end: good enough for Newton's method, as the wire is so much softer.
        """
        if not self._closed:
            return 0.0, 0.0
        return -self._stiffness, self._stiffness * self._receptance.get()[0][0]

    def _law(self, position: float, height: float) -> float:
        force = self._static_force + self._stiffness * (position - height)
        self._closed = force > 0
        return max(0.0, force)
