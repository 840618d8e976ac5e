"""A line of one's own beside the pantograph FMU: a finite-element string, by NumPy alone, that tells its affine map."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Pantograph

TENSION, MASS, LENGTH, ELEMENTS = 20000.0, 1.35, 120.0, 240
STIFFNESS = 40.0  # N/m2, of the foundation that stands for what carries the wire
STATIC, SPEED = 120.0, 60.0
START = 40.0


class String:
    """A taut string on an elastic foundation with linear elements, by the trapezoidal rule, under one moving force."""

    def __init__(self, size: float):
        self.size, self.element = size, LENGTH / ELEMENTS
        n, e = ELEMENTS + 1, self.element
        self.M, self.K = np.zeros((n, n)), np.zeros((n, n))
        for i in range(ELEMENTS):
            pair = np.ix_([i, i + 1], [i, i + 1])
            self.M[pair] += MASS * e / 6 * np.array([[2, 1], [1, 2]])
            self.K[pair] += TENSION / e * np.array([[1, -1], [-1, 1]]) + STIFFNESS * e / 6 * np.array([[2, 1], [1, 2]])
        for end in (0, -1):
            self.K[end, :] = self.K[:, end] = self.M[end, :] = self.M[:, end] = 0
            self.K[end, end] = self.M[end, end] = 1
        self.inverse = np.linalg.inv(self.M + size**2 / 4 * self.K)
        self.u = np.linalg.solve(self.K, STATIC * self.shape(START))
        self.v, self.a = np.zeros(n), np.zeros(n)
        self.datum = self.shape(START) @ self.u

    def shape(self, x: float) -> np.ndarray:
        p, place = np.zeros(ELEMENTS + 1), x / self.element
        i = int(place)
        p[i], p[i + 1] = 1 - (place - i), place - i
        return p

    def stepped(self, x: float, force: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement, velocity, acceleration after a step to the force at x."""
        h = self.size
        predicted = self.u + h * self.v + h**2 / 4 * self.a
        a = self.inverse @ (force * self.shape(x) - self.K @ predicted)
        return predicted + h**2 / 4 * a, self.v + h / 2 * (self.a + a), a

    def step(self, x: float, force: float) -> None:
        self.u, self.v, self.a = self.stepped(x, force)

    def height(self, x: float) -> float:
        return self.shape(x) @ self.u - self.datum

    def affine_map(self, x: float) -> tuple[float, float]:
        """Height at x at the end of the next step without force there, and its compliance: the two formulas."""
        free = self.shape(x) @ self.stepped(x, 0.0)[0] - self.datum
        compliance = self.size**2 / 4 * self.shape(x) @ self.inverse @ self.shape(x)
        return free, compliance


def sequential(p: Pantograph, size: float, steps: int) -> list[float]:
    """Contact forces: the pantograph steps with the map, then the line with the force."""
    line, forces = String(size), []
    for n in range(1, steps + 1):
        x = START + SPEED * size * n
        free, compliance = line.affine_map(x)
        p.set({"wire_height": free, "wire.compliance": compliance})
        p.step(size)
        forces.append(p["contact.force"])
        line.step(x, forces[-1])
    return forces


def monolithic(p: Pantograph, size: float, steps: int) -> list[float]:
    """The force for which pantograph and line agree at the end of each step, by the secant method with rollback."""
    line, forces, slave = String(size), [], p.slave
    for n in range(1, steps + 1):
        x, state, time = START + SPEED * size * n, slave.getFMUState(), p.time
        guess, last = (forces[-1] if forces else STATIC), None
        for _ in range(50):
            u, _, _ = line.stepped(x, guess)
            slave.setFMUState(state)
            p.time = time
            p["wire_height"] = line.shape(x) @ u - line.datum
            p.step(size)
            error = p["contact.force"] - guess
            if abs(error) < 1e-9:
                break
            slope = -1.0 if last is None else (error - last[1]) / (guess - last[0])
            last = guess, error
            guess -= error / slope
        slave.freeFMUState(state)
        forces.append(p["contact.force"])
        line.step(x, forces[-1])
    return forces


@pytest.mark.parametrize("size", [0.5e-3, 2e-3])
def test_the_map_of_a_line_of_ones_own_gives_the_monolithic_solution(pantograph, size):
    """0.6 s, friction included; with what most tools do, last values, the force is newtons off."""
    wire = {"drive": "Wire", "friction": "Coulomb", "solver.step": 5e-4, "solver.tolerance": 1e-10}
    steps = round(0.6 / size)
    exact = np.array(monolithic(pantograph(wire), size, steps))
    found = np.array(sequential(pantograph({**wire, "wire.compliance": 1e-6}), size, steps))
    assert np.std(exact) > 5
    np.testing.assert_allclose(found, exact, atol=1e-5)
