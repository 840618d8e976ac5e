"""An independent overhead line at rest: plain finite elements in NumPy/SciPy, nothing shared with the FMU.

Each wire is a tensioned Euler-Bernoulli beam of cubic elements on its own; droppers join them only as forces.
Displacements u are measured upward from the unloaded static shape, in which gravity, tensions and the droppers'
forces T0 balance. Which droppers hang loose is one linear complementarity problem.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import cholesky, lapack
from scipy.optimize import nnls
from scipy.sparse import coo_matrix, csr_matrix

GAUSS = np.polynomial.legendre.leggauss(4)


def hermite(s: np.ndarray, length: np.ndarray, derivative: int = 0) -> np.ndarray:
    """Cubic shape functions (w0, w0', w1, w1') at s in [0, 1], shape (..., 4), or their x-derivative."""
    s, length = np.broadcast_arrays(np.asarray(s, float), np.asarray(length, float))
    cubics = [np.polynomial.Polynomial(c) for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])]
    values = [p.deriv(derivative)(s) if derivative else p(s) for p in cubics]
    scale = [1.0, length, 1.0, length]
    return np.stack([v * k / length**derivative for v, k in zip(values, scale)], axis=-1)


class Wire:
    """One tensioned beam between x[0] and x[-1], w = 0 at both ends if `held`; degrees of freedom (w, w') per node.

    tension     N, or of each element
    """

    def __init__(self, x: np.ndarray, mass: float, tension: float | np.ndarray, bending: float, *, held: bool = True):
        self.x, self.n = x, 2 * len(x)
        length = np.diff(x)
        stiffness = np.zeros((len(length), 4, 4))
        inertia = np.zeros_like(stiffness)
        for s, weight in zip(0.5 * (1 + GAUSS[0]), 0.5 * GAUSS[1]):
            for matrix, factor, order in ((inertia, mass, 0), (stiffness, tension, 1), (stiffness, bending, 2)):
                n = hermite(s, length, order)
                matrix += (factor * weight * length)[:, None, None] * n[:, :, None] * n[:, None, :]
        self.dofs = 2 * np.arange(len(length))[:, None] + np.arange(4)
        self.free = np.setdiff1d(np.arange(self.n), (0, self.n - 2) if held else ())
        self.mass, self.beam = self._assemble(inertia), self._assemble(stiffness)
        unit = np.sum([w * hermite(s, length) for s, w in zip(0.5 * (1 + GAUSS[0]), 0.5 * GAUSS[1])], axis=0)
        self.uniform = np.bincount(self.dofs.ravel(), (unit * length[:, None]).ravel(), self.n)[self.free]

    def _assemble(self, elements: np.ndarray) -> csr_matrix:
        rows = np.repeat(self.dofs, 4, axis=1).ravel()
        columns = np.tile(self.dofs, (1, 4)).ravel()
        full = coo_matrix((elements.ravel(), (rows, columns)), (self.n, self.n)).tocsr()
        return full[self.free][:, self.free]

    def at(self, x: float | np.ndarray, derivative: int = 0) -> csr_matrix:
        """Rows that give w (or w') at positions x, shape (len(x), free)."""
        x = np.atleast_1d(np.asarray(x, float))
        element = np.clip(np.searchsorted(self.x, x, "right") - 1, 0, len(self.x) - 2)
        length = np.diff(self.x)[element]
        values = hermite((x - self.x[element]) / length, length, derivative)
        rows = np.repeat(np.arange(len(x)), 4)
        full = csr_matrix((values.ravel(), (rows, self.dofs[element].ravel())), (len(x), self.n))
        return full[:, self.free]

    def point(self, x: np.ndarray, values: float | np.ndarray) -> csr_matrix:
        """Point masses or springs at x as a matrix."""
        rows = self.at(x)
        return (rows.T.multiply(np.broadcast_to(values, len(x))) @ rows).tocsr()


class Banded:
    """Cholesky factor of a sparse symmetric positive definite matrix with a small bandwidth."""

    def __init__(self, matrix: csr_matrix):
        entries = coo_matrix(matrix)
        width = int(np.max(entries.col - entries.row))
        band = np.zeros((width + 1, matrix.shape[0]))
        upper = entries.col >= entries.row
        row, column = entries.row[upper], entries.col[upper]
        np.add.at(band, (width + row - column, column), entries.data[upper])
        self.factor, info = lapack.dpbtrf(band)
        assert info == 0, f"not positive definite ({info})"

    def __call__(self, right: np.ndarray) -> np.ndarray:
        return lapack.dpbtrs(self.factor, right)[0]


def complementarity(q_matrix: np.ndarray, q: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """f >= 0 with w = Q f - q >= 0 and f w = 0, and where f > 0; `active`: a guess of that.

    Q symmetric positive definite. Found by an active set, or, where that cycles, as the non-negative least
    squares problem with the same solution.
    """
    for _ in range(20):
        f = np.zeros_like(q)
        f[active] = np.linalg.solve(q_matrix[np.ix_(active, active)], q[active])
        w = q_matrix @ f - q
        new = np.where(active, f > 0, w < 0)
        if np.array_equal(new, active):
            return f, active
        active = new
    upper = cholesky(q_matrix)
    f = nnls(upper, np.linalg.solve(upper.T, q), maxiter=100 * len(q))[0]
    return f, f > 0


@dataclass
class Line:
    """Parameters as the FMU's, by their meaning; lengths m, masses kg or kg/m, forces N, stiffnesses N/m."""

    spans: int = 10
    span: float = 60.0
    encumbrance: float = 1.2
    contact_wire: tuple[float, float, float] = (1.35, 20e3, 195.0)  # mass, tension, EI
    messenger: tuple[float, float, float] = (1.07, 16e3, 131.7)
    dropper_position: Sequence[float] = (5, 10.5, 17, 23.5, 30, 36.5, 43, 49.5, 55)
    dropper_sag: Sequence[float] = (0.0,) * 9
    dropper_stiffness: float = 1e5
    dropper_EA: float = 0.0
    dropper_mass: float = 0.0
    clamp_contact: float = 0.0
    clamp_messenger: float = 0.0
    support_stiffness: float = 5e4
    arm_mass: float = 0.0
    arm_stiffness: float = 0.0
    damping_mass: float = 0.0
    damping_stiffness: float = 0.0
    gravity: float = 9.81
    element: float = 1.0

    length: float = field(init=False)

    def __post_init__(self):
        self.length = self.spans * self.span
        self.supports = self.span * np.arange(1, self.spans)
        starts = self.span * np.arange(self.spans)
        self.droppers = (starts[:, None] + np.asarray(self.dropper_position, float)).ravel()
        x = self._nodes()
        self.wires = (Wire(x, *self.contact_wire), Wire(x, *self.messenger))
        self._static_shape()
        self._matrices()

    def _nodes(self) -> np.ndarray:
        fixed = np.unique(np.concatenate([[0.0, self.length], self.supports, self.droppers]))
        parts = [
            np.linspace(a, b, int(np.ceil((b - a) / self.element - 1e-9)) + 1)[:-1]
            for a, b in itertools.pairwise(fixed)
        ]
        return np.append(np.concatenate(parts), self.length)

    def _static_shape(self) -> None:
        """Contact wire held at its heights by the droppers; messenger carries them, held at its supports."""
        contact, messenger = self.wires
        count, g = len(self.droppers), self.gravity
        heights = -np.tile(np.asarray(self.dropper_sag, float)[: len(self.dropper_position)], self.spans)
        at_contact, at_messenger = (contact.at(self.droppers).toarray().T, messenger.at(self.droppers).toarray().T)
        at_support = messenger.at(self.supports).toarray().T
        beam_c, beam_m = Banded(contact.beam), Banded(messenger.beam)

        def held(solve, load, at, target):
            """Shape under a load with prescribed heights at points, and the upward forces there."""
            free, unit = solve(load), solve(at) if at.shape[1] else at
            force = np.linalg.solve(at.T @ unit, target - at.T @ free) if at.shape[1] else np.zeros(0)
            return free + unit @ force, force

        shape, reaction = held(beam_c, -self.contact_wire[0] * g * contact.uniform, at_contact, heights)
        rope = np.zeros(count)  # the droppers' own masses
        while True:
            self.T0 = reaction + g * (self.clamp_contact + rope / 2)
            load = -self.messenger[0] * g * messenger.uniform
            load -= at_messenger @ (self.T0 + g * (self.clamp_messenger + rope / 2))
            upper, self.support_force = held(beam_m, load, at_support, np.zeros(at_support.shape[1]))
            self.dropper_length = self.encumbrance + at_messenger.T @ upper - at_contact.T @ shape
            change = self.dropper_mass * self.dropper_length - rope
            rope = rope + change
            if np.abs(change).max(initial=0) < 1e-14:
                break
        self.shape, self.messenger_shape, self.rope = shape, upper, rope
        stiffness = self.dropper_EA / self.dropper_length if self.dropper_EA else np.full(count, self.dropper_stiffness)
        self.flexibility = 1 / stiffness

    def _matrices(self) -> None:
        """Mass, stiffness, damping per wire; the droppers' directions (elongation = -J' u)."""
        contact, messenger = self.wires
        drop = self.droppers
        self.M = (
            contact.mass
            + contact.point(drop, self.clamp_contact + self.rope / 2)
            + contact.point(self.supports, self.arm_mass),
            messenger.mass + messenger.point(drop, self.clamp_messenger + self.rope / 2),
        )
        self.K = (
            contact.beam + contact.point(self.supports, self.arm_stiffness),
            messenger.beam + messenger.point(self.supports, self.support_stiffness),
        )
        self.C = tuple(self.damping_mass * m + self.damping_stiffness * w.beam for m, w in zip(self.M, self.wires))
        # A tension pulls the contact wire up and the messenger down.
        self.J = (contact.at(drop).toarray().T, -messenger.at(drop).toarray().T)

    def irregularity(self, x: float | Sequence[float] | np.ndarray) -> np.ndarray:
        """What pantographs meet besides the wire's own shape, m."""
        return np.zeros(np.shape(x))

    def static_height(self, x: float | np.ndarray) -> np.ndarray:
        """Height of the unloaded contact wire (m)."""
        return self.wires[0].at(x) @ self.shape

    def equilibrium(self, x: Sequence[float], force: Sequence[float]):
        """(u contact, u messenger, dropper tensions) under upward forces on the contact wire."""
        load = self.wires[0].at(x).T @ np.asarray(force, float)
        solve = [Banded(k) for k in self.K]
        free = solve[0](load)
        y = [s(j) if j.shape[1] else j for s, j in zip(solve, self.J)]
        q_matrix = np.diag(self.flexibility) + sum(j.T @ v for j, v in zip(self.J, y))
        # Tensions beyond the static state move the wires: f = pull + df.
        q = self.flexibility * self.T0 - self.J[0].T @ free + (q_matrix - np.diag(self.flexibility)) @ self.pull
        f, _ = complementarity(q_matrix, q, np.ones(len(q), bool))
        return free + y[0] @ (f - self.pull), y[1] @ (f - self.pull), f

    @property
    def pull(self) -> np.ndarray:
        """Tensions in the static state (N); T0 is below 0 by stiffness times gap where a dropper hangs loose in it."""
        return np.maximum(self.T0, 0.0)


def parameters_of(line: Line) -> dict[str, float]:
    """The FMU's parameters, by name, that describe the same line on the same mesh."""
    wires = {
        f"{wire}.{name}": value
        for wire in ("contact_wire", "messenger")
        for name, value in zip(("mass", "tension", "EI"), getattr(line, wire))
    }
    droppers = {"dropper.count": len(line.dropper_position)}
    for i, (position, sag) in enumerate(zip(line.dropper_position, line.dropper_sag), start=1):
        droppers |= {f"dropper.position[{i}]": position, f"dropper.sag[{i}]": sag}
    return {
        "line.spans": line.spans,
        "line.span": line.span,
        "line.encumbrance": line.encumbrance,
        **wires,
        **droppers,
        "dropper.stiffness": line.dropper_stiffness,
        "dropper.EA": line.dropper_EA,
        "dropper.mass": line.dropper_mass,
        "dropper.clamp_contact": line.clamp_contact,
        "dropper.clamp_messenger": line.clamp_messenger,
        "support.stiffness": line.support_stiffness,
        "steady_arm.mass": line.arm_mass,
        "steady_arm.stiffness": line.arm_stiffness,
        "damping.mass": line.damping_mass,
        "damping.stiffness": line.damping_stiffness,
        "gravity": line.gravity,
        "mesh.element": line.element,
    }


# As published, second-hand; the steady arms, which the sources at hand do not tell, are left out.
EN_50318_2002 = Line(clamp_contact=0.165, clamp_messenger=0.195, damping_mass=0.0125, damping_stiffness=1e-4)
BENCHMARK_2015 = Line(
    span=55.0,
    dropper_position=(4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5),
    dropper_sag=(0.0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0.0),
    dropper_EA=200e3,
    dropper_mass=0.117,
    clamp_contact=0.165,
    clamp_messenger=0.195,
    contact_wire=(1.35, 22e3, 195.0),
    messenger=(1.08, 16e3, 131.7),
    support_stiffness=5e5,
    damping_mass=0.0125,
    damping_stiffness=1e-4,
)
# Every part that a line can have.
COMPLETE = replace(BENCHMARK_2015, spans=3, arm_mass=0.3, arm_stiffness=300.0)
