"""An independent overhead line in motion and its monolithic coupling with lumped-mass pantographs.

Nothing here is shared with the FMU. The bodies, two wires and the pantographs, are linear; every force between
them is an unknown of one linear complementarity problem per time step,

    0 <= f   complementary to   Q f - q >= 0,       Q = diag(1/k) + J' A^-1 J

(droppers: f is the tension, f/k - (T0/k + elongation) >= 0; contacts: f/kc - (F0/kc + penetration) >= 0), with J
the directions in which the forces f act and A the bodies' iteration matrices. Q is symmetric positive definite,
so the solution is unique.

HHT-alpha as Hilber, Hughes and Taylor (1977): M a[n+1] + (1 + alpha) R[n+1] - alpha R[n] = 0, R all forces but
inertia, contacts and droppers included.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from catenary_line import Banded, Line, complementarity


@dataclass(frozen=True)
class Pantograph:
    """Masses from the head down, each on its spring and damper, the last on the ground.

    Static under F0 at z = 0; contact F = max(0, F0 + kc (z_head - z_wire)).
    """

    mass: Sequence[float]
    k: Sequence[float]
    c: Sequence[float]
    F0: float = 120.0
    kc: float = 50e3

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        n = len(self.mass)
        difference = np.eye(n) - np.eye(n, k=1)
        return (
            np.diag(np.asarray(self.mass, float)),
            difference.T @ np.diag(np.asarray(self.k, float)) @ difference,
            difference.T @ np.diag(np.asarray(self.c, float)) @ difference,
        )


EN_50318_2002 = Pantograph((7.2, 15.0), (4200.0, 50.0), (10.0, 90.0))


class Body:
    """M u'' + C u' + K u = load + J f of one body, f all droppers' tensions; its motion under HHT-alpha."""

    def __init__(self, mass, damping, stiffness, J: np.ndarray, load: np.ndarray, solver: Callable):
        self.M, self.C, self.K, self.J, self.load = mass, damping, stiffness, J, load
        self.factor = solver
        self.u, self.v, self.a = (np.zeros(len(load)) for _ in range(3))

    def residual(self, tension: np.ndarray, contact: np.ndarray) -> None:
        """R at the present motion; `contact`: the forces of contacts on the body."""
        self.R = self.C @ self.v + self.K @ self.u - self.load - self.J @ tension - contact

    def start(self, step: float, alpha: float) -> None:
        self.h, self.al = step, alpha
        self.beta, self.gamma = (1 - alpha) ** 2 / 4, 0.5 - alpha
        matrix = self.M + (1 + alpha) * step * (self.gamma * self.C + self.beta * step * self.K)
        self.solve = self.factor(matrix)
        self.Y = self.solve(self.J) if self.J.shape[1] else self.J

    def predict(self) -> np.ndarray:
        """Displacement at the end of the step without any force f there."""
        h, b, g = self.h, self.beta, self.gamma
        self.us = self.u + h * self.v + h * h * (0.5 - b) * self.a
        self.vs = self.v + h * (1 - g) * self.a
        self.free = self.solve(self.al * self.R - (1 + self.al) * (self.C @ self.vs + self.K @ self.us - self.load))
        return self.us + b * h * h * self.free

    def correct(self, tension: np.ndarray, contact: np.ndarray, solved: np.ndarray) -> None:
        """The end of the step under f; `solved`: the contact forces times the inverse iteration matrix."""
        self.a = self.free + (1 + self.al) * (self.Y @ tension + solved)
        self.u = self.us + self.beta * self.h**2 * self.a
        self.v = self.vs + self.gamma * self.h * self.a
        self.residual(tension, contact)


@dataclass(frozen=True)
class History:
    """One row per time, the start included: per load x, force, head, wire (its height); per dropper its tension;
    uplift of each support and of the points asked for; kinetic and elastic energy of the line (J)."""

    time: np.ndarray
    x: np.ndarray
    force: np.ndarray
    head: np.ndarray
    wire: np.ndarray
    tension: np.ndarray
    uplift: np.ndarray
    points: np.ndarray
    energy: np.ndarray


class Solver:
    """The line under imposed forces or under pantographs, all unknowns of a step solved at once."""

    def __init__(
        self,
        line: Line,
        step: float,
        alpha: float = -0.1,
        pantographs: Sequence[Pantograph] = (),
        points: Sequence[float] = (),
    ):
        self.line, self.step, self.alpha, self.pantographs = line, step, alpha, pantographs
        self.points, self.supports = line.wires[0].at(points), line.wires[0].at(line.supports)
        self.wires = [Body(m, c, k, j, -j @ line.pull, Banded) for m, c, k, j in zip(line.M, line.C, line.K, line.J)]
        none = len(line.droppers)
        self.masses = []
        for p in pantographs:
            m, k, c = p.matrices()
            load = np.zeros(len(m))
            load[0] = p.F0  # balances the contact force in the static state
            self.masses.append(Body(m, c, k, np.zeros((len(m), none)), load, lambda a: np.linalg.inv(a).__matmul__))
        for body in (*self.wires, *self.masses):
            body.start(step, alpha)
        self.weight = (1 + alpha) * self.wires[0].beta * step**2  # of a force in the displacement
        self.G = self.weight * sum(w.J.T @ w.Y for w in self.wires) + np.diag(line.flexibility)

    def run(
        self,
        steps: int,
        position: Callable[[float], Sequence[float]],
        force: Callable[[float], Sequence[float]] | None = None,
        offset: Callable[[float], float] = lambda t: 0.0,
    ) -> History:
        """`position` of every load at time t; `force` (N) of each, or None: contact with the pantographs.

        The wire that the pantographs see is lower than the line's by offset(t) m. Starts at rest in equilibrium
        under the forces given, or under F0 of the pantographs, which start in their static state.
        """
        line, (contact, messenger) = self.line, self.wires
        nd = len(line.droppers)
        F = np.array([p.F0 for p in self.pantographs] if force is None else force(0.0), float)
        contact.u, messenger.u, tension = line.equilibrium(position(0.0), F)
        N = line.wires[0].at(position(0.0))
        self._residuals(tension, N.T @ F, F)
        active = np.append(tension > 0, np.ones(len(self.masses), bool))
        rows = [self._record(0.0, position, N, F, tension)]
        for t in self.step * np.arange(1, steps + 1):
            N = line.wires[0].at(position(t))
            dense = N.toarray().T
            solved = contact.solve(dense)
            u0, u1 = (w.predict() for w in self.wires)
            if force is not None:
                F = np.asarray(force(t), float)
                u0 = u0 + self.weight * (solved @ F)
            q = line.flexibility * line.T0 - contact.J.T @ u0 - messenger.J.T @ u1
            Q = self.G
            if force is None:
                cross = self.weight * contact.Y.T @ dense
                own = self.weight * dense.T @ solved
                penetration = offset(t) - N @ (u0 + line.shape) - line.irregularity(position(t))
                for i, (p, body) in enumerate(zip(self.pantographs, self.masses)):
                    penetration[i] += p.F0 / p.kc + body.predict()[0]
                    own[i, i] += 1 / p.kc + self.weight * body.solve(np.eye(len(body.u)))[0, 0]
                Q, q = np.block([[Q, cross], [cross.T, own]]), np.append(q, penetration)
            f, active = complementarity(Q, q, active)
            tension = f[:nd]
            F = f[nd:] if force is None else F
            contact.correct(tension, N.T @ F, solved @ F)
            messenger.correct(tension, 0.0, 0.0)
            for body, pressed in zip(self.masses, F):
                down = -pressed * np.eye(len(body.u))[0]
                body.correct(tension, down, body.solve(down))
            rows.append(self._record(t, position, N, F, tension))
        return History(*(np.array(column) for column in zip(*rows)))

    def _residuals(self, tension: np.ndarray, pressed: np.ndarray, F: np.ndarray) -> None:
        self.wires[0].residual(tension, pressed)
        self.wires[1].residual(tension, 0.0)
        for body, f in zip(self.masses, F):
            body.residual(tension, -f * np.eye(len(body.u))[0])

    def _record(self, t, position, N, F, tension):
        line, (contact, messenger) = self.line, self.wires
        elongation = -(contact.J.T @ contact.u + messenger.J.T @ messenger.u)
        pull = np.maximum(0.0, line.T0 + elongation / line.flexibility)
        droppers = 0.5 * line.flexibility * (pull**2 - line.pull**2) - line.pull * elongation
        kinetic = sum(0.5 * w.v @ (w.M @ w.v) for w in self.wires)
        elastic = sum(0.5 * w.u @ (w.K @ w.u) for w in self.wires) + droppers.sum()
        return (
            t,
            np.asarray(position(t), float),
            F,
            np.array([body.u[0] for body in self.masses]),
            N @ (contact.u + line.shape) + line.irregularity(position(t)),
            tension,
            self.supports @ contact.u,
            self.points @ contact.u,
            np.array([kinetic, elastic]),
        )


def line_run(
    line: Line,
    pantograph: Pantograph,
    speed: float,
    start: float,
    stop: float,
    step: float = 1e-3,
    alpha: float = -0.1,
    *,
    ramp: bool = True,
) -> History:
    """One pantograph from `start` to `stop` (m) at constant speed (m/s), from static equilibrium.

    With `ramp` the pantograph's zero moves from the loaded to the unloaded height of the wire within the first
    span, so that F0 holds at the unloaded nominal height; without, F0 holds at the loaded height of the start.
    """
    u = line.equilibrium([start], [pantograph.F0])[0]
    loaded = (line.wires[0].at(start) @ (u + line.shape))[0] + line.irregularity(start)

    def offset(t: float) -> float:
        done = min(1.0, speed * t / line.span) if ramp else 0.0
        return loaded * 0.5 * (1 + np.cos(np.pi * done))

    solver = Solver(line, step, alpha, [pantograph])
    steps = round((stop - start) / (speed * step))
    return solver.run(steps, lambda t: [start + speed * t], offset=offset)
