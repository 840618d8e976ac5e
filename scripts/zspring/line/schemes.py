"""The master's algorithms: how wire heights and contact forces are exchanged over one communication step."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import Array, c_double
from dataclasses import dataclass

import numpy as np

from ..errors import ZSpringError
from .sides import ContactInMaster, ContactInPantograph, Wire

Pantographs = Sequence[ContactInPantograph | ContactInMaster]

MAPPED = {"sequential": "Sequential", "parallel": "Parallel"}  # the catenary's exchange, of schemes with its affine map
SCHEMES, DRIVES = (*MAPPED, "implicit", "explicit", "jacobi"), ("Wire", "Force")
UNDAMPED = 6  # outer iterations before the corrections are halved


@dataclass(frozen=True)
class Coupling:
    """How the FMUs are coupled.

    scheme          "sequential": each step once, the pantographs first, with the wire as an affine map of their force:
                    what "implicit" gives, unless a dropper slackens or tightens otherwise than the map foresaw
                    "parallel": each step once, side by side, with such a map
                    "implicit": forces and heights at the end of each step agree, by steps taken back
                    "explicit": each step once, the pantographs first (Gauss-Seidel)
                    "jacobi": each step once, with the values at its begin, as plain co-simulation tools do
    drive           of the pantographs: "Wire" (they solve the contact) or "Force" (the master does)
    tolerance       of the contact force, as a share of static_force; for "implicit"
    max_iterations  steps of the catenary for one communication step; for "implicit"
    """

    scheme: str = "sequential"
    drive: str = "Wire"
    tolerance: float = 1e-6
    max_iterations: int = 30

    def __post_init__(self) -> None:
        """Raises ZSpringError for a value or a combination that there is not."""
        if self.scheme not in SCHEMES:
            raise ZSpringError(f"coupling {self.scheme!r}: must be one of {', '.join(SCHEMES)}")
        if self.drive not in DRIVES:
            raise ZSpringError(f"drive {self.drive!r}: must be one of {', '.join(DRIVES)}")
        if self.scheme in (*MAPPED, "jacobi") and self.drive != "Wire":
            raise ZSpringError(f"coupling {self.scheme} with drive {self.drive}: needs drive Wire")
        if not self.tolerance > 0:
            raise ZSpringError(f"tolerance = {self.tolerance:g}: must be above 0")


class Mapped:
    """With the wire as the catenary's affine map of the forces: its documentation has the theory.

    The pantographs meet the wire as it will be under the forces that they are about to have. Sequential: the
    catenary is then told these. Parallel: it steps with those at the begin of the step, and tells its map a step ahead.
    """

    def __init__(self, wire: Wire, pantographs: Sequence[ContactInPantograph], parallel: bool):
        self._wire, self._pantographs, self._parallel = wire, pantographs, parallel
        self.forces = [pantograph.force for pantograph in pantographs]

    def advance(self, time: float, size: float, shifts: Sequence[float]) -> None:
        """As Jacobi.advance."""
        begin = self.forces
        self.forces = [
            pantograph.meet(time, size, free - shift, compliance, previous)
            for pantograph, (free, compliance, previous), shift in zip(self._pantographs, self._wire.maps(), shifts)
        ]
        self._wire.step_unseen(time, size, begin if self._parallel else self.forces)


class Jacobi:
    """Pantographs and catenary step side by side with each other's last values."""

    def __init__(self, wire: Wire, pantographs: Pantographs):
        self._wire, self._pantographs = wire, pantographs
        self.forces = [pantograph.force for pantograph in pantographs]

    def advance(self, time: float, size: float, shifts: Sequence[float]) -> None:
        """One step of `size` s from `time` s.

        shifts  how much lower than the catenary says the pantographs meet the wire at the end of the step, m
        """
        heights, forces = self._wire.heights, self.forces
        self.forces = [
            pantograph.step(time, size, height - shift, force)
            for pantograph, height, shift, force in zip(self._pantographs, heights, shifts, forces)
        ]
        self._wire.step(time, size, forces)


class GaussSeidel:
    """The pantographs first, with the wire as it will be if it keeps its velocity; then the catenary.

    This extrapolation makes the error of the force second order in the step; with the height held it is first
    order, and at 1 ms on the line of EN 50318:2002 four times larger.
    """

    def __init__(self, wire: Wire, pantographs: Pantographs):
        self._wire, self._pantographs = wire, pantographs
        self.forces = [pantograph.force for pantograph in pantographs]

    def advance(self, time: float, size: float, shifts: Sequence[float]) -> None:
        """As Jacobi.advance."""
        wire, forces = self._wire, []
        for i, pantograph in enumerate(self._pantographs):
            height = wire.heights[i] + size * wire.velocities[i] - shifts[i]
            pantograph.force = pantograph.explicit_step(time, size, height, pantograph.force)
            forces.append(pantograph.force)
        wire.step(time, size, forces)
        self.forces = forces


class Implicit:
    """Newton's method for the forces at the end of the step, with the derivatives of both FMUs.

    The wire answers linearly to the forces unless a dropper slackens or tightens within the step, and steps
    of a pantograph cost little. So the forces are first found for the linear wire through the catenary's last
    answer; the catenary steps again with them, and the pantographs with the heights it gives. Two steps of
    the catenary do for nearly every communication step. Where contacts or droppers change state the
    derivative jumps (semismooth Newton); the force of the contact falls and the wire rises with the force, so
    that halved corrections converge where full ones alternate. A contact of 1e6 N/m that bounces several
    times within one communication step has no such order: that ends with an error, never unconverged.
    """

    def __init__(self, wire: Wire, pantographs: Pantographs, tolerance: float, max_iterations: int):
        """tolerance    N"""
        self._wire, self._pantographs = wire, pantographs
        self._tolerance, self._max_iterations = tolerance, max_iterations
        self.forces = [pantograph.force for pantograph in pantographs]
        self._before = self.forces

    def advance(self, time: float, size: float, shifts: Sequence[float]) -> None:
        """As Jacobi.advance. Raises ZSpringError if forces and heights do not agree within the tolerance."""
        wire, last = self._wire, self.forces
        wire.save()
        for pantograph in self._pantographs:
            pantograph.save()
        forces = [max(0.0, 2 * now - before) for now, before in zip(last, self._before)]
        for iteration in range(self._max_iterations):
            if iteration:
                wire.restore()
            wire.step(time, size, forces)
            heights = [height - shift for height, shift in zip(wire.heights, shifts)]
            errors = self._errors(time, size, heights, forces, again=iteration > 0)
            if max(map(abs, errors)) <= self._tolerance:
                break
            found = self._on_linear_wire(time, size, heights, forces, errors)
            share = 1.0 if iteration < UNDAMPED else 0.5
            forces = [max(0.0, old + share * (new - old)) for old, new in zip(forces, found)]
        else:
            raise ZSpringError(
                f"the contact force does not converge at {time + size:g} s: after {iteration + 1} iterations "
                f"it is {max(map(abs, errors)):.2g} N off, allowed are {self._tolerance:.2g} N; "
                "use a smaller step or explicit coupling"
            )
        self._before, self.forces = last, forces
        for pantograph, force in zip(self._pantographs, forces):
            pantograph.force = force

    def _errors(
        self, time: float, size: float, heights: Sequence[float], forces: Sequence[float], again: bool
    ) -> list[float]:
        """The pantographs' answers to these heights and forces, less the forces, N."""
        errors = []
        for pantograph, height, force in zip(self._pantographs, heights, forces):
            if again:
                pantograph.restore()
            errors.append(pantograph.step(time, size, height, force) - force)
        return errors

    def _on_linear_wire(
        self, time: float, size: float, heights: Sequence[float], forces: list[float], errors: Sequence[float]
    ) -> list[float]:
        """Forces that agree with a wire at `heights` under `forces`, and as compliant as in the last step."""
        compliance = self._wire.compliance()
        for _ in range(self._max_iterations):
            change = self._newton(compliance, errors)
            forces = [force + by for force, by in zip(forces, change)]
            heights = [
                height + sum(column[i] * by for column, by in zip(compliance, change))
                for i, height in enumerate(heights)
            ]
            errors = self._errors(time, size, heights, forces, again=True)
            if max(map(abs, errors)) <= 0.1 * self._tolerance:
                break
        return forces

    def _newton(self, compliance: Sequence[Array[c_double]], errors: Sequence[float]) -> Sequence[float]:
        """Change of the forces that makes the linearised errors vanish."""
        slopes = [pantograph.slopes() for pantograph in self._pantographs]
        if len(errors) == 1:
            (by_height, by_force), ((own,),) = slopes[0], compliance
            return (errors[0] / (1.0 - by_force - by_height * own),)
        by_height, by_force = np.array(slopes).T
        matrix = np.eye(len(errors)) - np.diag(by_force) - by_height[:, None] * np.array(compliance).T
        return np.linalg.solve(matrix, errors).tolist()
