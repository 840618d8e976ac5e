"""Newton's iteration of one recorded step, done again in Python: what the FMU does inside, step by step.

The unknowns are alpha, beta, u2, u3; the bench imposes u1. With each tangent of the friction law

    Exact      sech^2(x)                  Secant   tanh(x)/x           with x = tau w,
    Mean       mean of both, the paper    Resolvent: unknown z = rho w + s instead of the rod's acceleration

HHT-alpha:  M a1 + (1 + hht_alpha) R1 - hht_alpha R0 = 0,  R = C v + Fe(q) - Fe(q_static) + Mf tanh(tau w).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from zspring.linkage import force_and_tangent, static_gap
from zspring.receptance import linear_model

from .recorded import Recording, newmark

TANGENTS = ("Resolvent", "Mean", "Secant", "Exact")
RODS = [0, 1]  # among the unknowns


@dataclass(frozen=True)
class Iteration:
    """The iterates of one tangent, the start included."""

    rates: np.ndarray  # (n + 1, 2) of the rods in rad/s
    unbalance: np.ndarray  # (n + 1,) largest of both rods, in units of the friction bound Mf
    q: np.ndarray  # (5,) of the last iterate in m and rad


class Step:
    """The step from sample `index` of a recording to the next one.

    Needs a head in drive Bench, friction Regularized, and 1 <= index < len(recording.time) - 1.
    """

    def __init__(self, recording: Recording, index: int):
        p = self.p = recording.parameters
        self.recording, self.index = recording, index
        self.q0, self.v0, a0 = recording.q[index], recording.v[index], recording.a[index]
        self.head = recording.q[index + 1, 0], recording.v[index + 1, 0]
        self.beta, self.gamma = newmark(p["solver.alpha"])
        h = recording.step
        self.alpha, self.weight = p["solver.alpha"], 1 + p["solver.alpha"]
        self.bh2, self.gh = self.beta * h**2, self.gamma * h
        self.q_predicted = self.q0 + h * self.v0 + (0.5 - self.beta) * h**2 * a0
        self.v_predicted = self.v0 + (1 - self.gamma) * h * a0
        self.a0 = a0
        self.bound, self.tau = p["zspring.Mf"], p["zspring.tau"]
        free = linear_model(p, "free")
        self.M, self.C = free.M, free.C
        static = force_and_tangent(p, p["zspring.theta"], p["zspring.theta"], static_gap(p))
        self._static_force = static[0]
        self._frame = free.K.copy()  # the linear springs alone
        self._frame[:4, :4] -= static[1]
        s0 = np.tanh(self.tau * self.v0[1:3])
        self.R0 = self._smooth_force(self.q0, self.v0)[0]
        self.R0[1:3] += self.bound * s0
        self._start_z = s0

    def iterate(self, tangent: str, count: int) -> Iteration:
        """`count` iterations with one of TANGENTS from the FMU's own start."""
        resolvent = tangent == "Resolvent"
        x = self.a0[1:].copy()
        if resolvent:
            K = self._smooth_force(self.q0, self.v0)[1]
            inertia = np.diag(self.M)[1:3] + self.weight * self.bh2 * np.diag(K)[1:3]
            rho = inertia / (self.gh * self.weight * self.bound)  # any rho > 0 solves the same step
            x[RODS] = rho * self.v0[1:3] + self._start_z
        rates, unbalance = [], []
        for i in range(count + 1):
            a, slope, friction_slope = x.copy(), np.ones(4), np.zeros(4)
            if resolvent:
                w = np.array([self._rate(r, z) for r, z in zip(rho, x[RODS])])
                a[RODS] = (w - self.v_predicted[1:3]) / self.gh
                g = self.tau * (1 - np.tanh(self.tau * w) ** 2)
                slope[RODS] = 1 / (rho + g) / self.gh
                friction_slope[RODS] = self.bound * g / (rho + g)
            else:
                w = self.v_predicted[1:3] + self.gh * a[RODS]
                friction_slope[RODS] = self.bound * self.gh * self.tau * tanh_slope(tangent, self.tau * w)
            residual, smooth = self._residual(a, np.tanh(self.tau * w))
            rates.append(w)
            unbalance.append(np.abs(residual[RODS]).max() / self.bound)
            if i < count:
                jacobian = smooth * slope + np.diag(self.weight * friction_slope)
                x -= np.linalg.solve(jacobian, residual)
        q = self.q_predicted + self.bh2 * np.append(0.0, a)
        q[0] = self.head[0]
        return Iteration(np.array(rates), np.array(unbalance), q)

    def balance(self, shift: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Friction moment over Mf that the rest of the pantograph needs at the first rod, (n,).

        rates (n,) of this rod in rad/s at the step's end; the other one's is shifted by shift[1] - shift[0].
        """
        needed = []
        for w in rates:
            a = self.a0[1:].copy()
            a[RODS] = (w + shift - shift[0] - self.v_predicted[1:3]) / self.gh
            for _ in range(3):  # the frames' equations are all but linear
                residual, smooth = self._residual(a, np.zeros(2))
                a[2:] -= np.linalg.solve(smooth[2:, 2:], residual[2:])
            residual, _ = self._residual(a, np.zeros(2))
            needed.append(-residual[0] / (self.weight * self.bound))
        return np.array(needed)

    def _residual(self, a: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unbalance (4,) of the unknowns' rows, and its derivative (4, 4) by a without that of friction."""
        q = self.q_predicted + self.bh2 * np.append(0.0, a)
        v = self.v_predicted + self.gh * np.append(0.0, a)
        q[0], v[0] = self.head
        force, tangent = self._smooth_force(q, v)
        force[1:3] += self.bound * s
        residual = np.diag(self.M) * np.append(0.0, a) + self.weight * force - self.alpha * self.R0
        derivative = self.M + self.weight * (self.gh * self.C + self.bh2 * tangent)
        return residual[1:], derivative[1:, 1:]

    def _smooth_force(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """C v + Fe(q) - Fe(q_static), (5,), and its derivative by q, (5, 5)."""
        force = self._frame @ q + self.C @ v
        spring, tangent = force_and_tangent(self.p, q[1], q[2], q[3] - q[0] + static_gap(self.p))
        force[:4] += spring - self._static_force
        stiffness = self._frame.copy()
        stiffness[:4, :4] += tangent
        return force, stiffness

    def _rate(self, rho: float, z: float) -> float:
        """w with rho w + tanh(tau w) = z."""
        return brentq(lambda w: rho * w + np.tanh(self.tau * w) - z, -abs(z) / rho, abs(z) / rho, xtol=1e-16)


def tanh_slope(tangent: str, x: np.ndarray) -> np.ndarray:
    """The slope that a tangent takes for that of tanh at x."""
    exact = 1 - np.tanh(x) ** 2
    secant = np.divide(np.tanh(x), x, out=np.ones_like(x), where=np.abs(x) > 1e-8)
    return {"Exact": exact, "Secant": secant, "Mean": (exact + secant) / 2}[tangent]
