"""An independent pantograph: equations of motion from the energy alone, solved by a tight stiff ODE solver.

Nothing here is shared with the FMU. The elastic forces are the complex-step gradient of the elastic energy

    E = 1/2 k (l - l0)^2 + 1/2 k2 (u2 - u3)^2 + 1/2 k3 u3^2,      q = [u1, alpha, beta, u2, u3]

with u measured upward from the static state under static_force, where rods and spring lie on one line. There
the springs balance the preload, so

    M q'' = -(dE/dq - dE/dq_static) - C q' - friction + uplift - (Fc - static_force) e1
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from harness import Fmu, Signal, Value

U1, ALPHA, BETA, U2, U3 = range(5)


class Reference:
    """The pantograph with the FMU's parameters (by the FMU's names); suspension ZSpring or Linear.

    Friction is the regularised law Mf tanh(tau w), or none with friction "Free"; rods need inertia.
    """

    def __init__(self, fmu: Fmu, parameters: Mapping[str, Value]):
        names = fmu.names("parameter")
        self.p = p = {name: fmu.start(name) for name in names} | dict(parameters)
        self.linear = p["suspension"] == "Linear"
        self.friction = 0.0 if self.linear or p["friction"] == "Free" else p["zspring.Mf"]
        self.mass = np.array([p["m1"], p["zspring.J1"], p["zspring.J2"], p["m2"], p["m3"]])
        self.theta = self._static_angle()
        self.static = np.array([0.0, self.theta, self.theta, 0.0, 0.0])
        self.static_gradient = self.gradient(self.static)

    def _static_angle(self) -> float:
        """Angle at which the spring carries the head and the static force."""
        p = self.p
        load = p["m1"] * p["gravity"] + p["static_force"]
        slack = p["zspring.L1"] + p["zspring.L2"] + p["zspring.l0"]
        taut = np.arccos(min(1.0, p["zspring.d"] / slack))

        def unbalanced(angle: float) -> float:
            return p["zspring.k"] * (p["zspring.d"] / np.cos(angle) - slack) * np.sin(angle) - load

        return brentq(unbalanced, taut, np.pi / 2 - 1e-9, xtol=1e-15, rtol=1e-15)

    def spring_length(self, q: np.ndarray) -> np.ndarray:
        p = self.p
        static_height = p["zspring.d"] * np.tan(self.theta)
        a = p["zspring.L1"] * np.cos(q[ALPHA]) + p["zspring.L2"] * np.cos(q[BETA]) - p["zspring.d"]
        b = -p["zspring.L1"] * np.sin(q[ALPHA]) - p["zspring.L2"] * np.sin(q[BETA]) + static_height + q[U2] - q[U1]
        return np.sqrt(a * a + b * b)

    def energy(self, q: np.ndarray) -> np.ndarray:
        """Elastic energy (J) of q, shape (5, ...); holomorphic, for the complex step."""
        p = self.p
        if self.linear:
            head = p["k1"] * (q[U1] - q[U2]) ** 2
        else:
            head = p["zspring.k"] * (self.spring_length(q) - p["zspring.l0"]) ** 2
        return 0.5 * (head + p["k2"] * (q[U2] - q[U3]) ** 2 + p["k3"] * q[U3] ** 2)

    def gradient(self, q: np.ndarray) -> np.ndarray:
        """dE/dq by the complex step: exact to rounding."""
        tiny = 1e-50
        return self.energy(q[:, None] + 1j * tiny * np.eye(5)).imag / tiny

    def damping(self, v: np.ndarray) -> np.ndarray:
        p = self.p
        upper, lower = p["c1"] * (v[U1] - v[U2]), p["c2"] * (v[U2] - v[U3])
        return np.array([upper, 0.0, 0.0, lower - upper, p["c3"] * v[U3] - lower])

    def moment(self, rate: np.ndarray) -> np.ndarray:
        return self.friction * np.tanh(self.p["zspring.tau"] * rate)

    def contact(self, t: float, q: np.ndarray, v: np.ndarray, inputs: Mapping[str, Signal]) -> float:
        """Contact force (N) of drives Force and Wire."""
        p = self.p
        if p["drive"] == "Force":
            return inputs["contact_force"](t)
        wire = inputs["wire_height"]
        return max(0.0, p["static_force"] + p["contact.k"] * (q[U1] - wire(t)) + p["contact.c"] * (v[U1] - wire(t, 1)))

    def unbalanced(self, t: float, q: np.ndarray, v: np.ndarray, inputs: Mapping[str, Signal]) -> np.ndarray:
        """All generalised forces but the contact force's departure from static_force."""
        force = self.static_gradient - self.gradient(q) - self.damping(v)
        force[[ALPHA, BETA]] -= self.moment(v[[ALPHA, BETA]])
        for row, name in ((U1, "uplift.head"), (U2, "uplift.upper_frame"), (U3, "uplift.lower_frame")):
            if name in inputs:
                force[row] += inputs[name](t)
        return force

    def solve(self, times: np.ndarray, inputs: Mapping[str, Signal], rtol: float = 1e-9) -> dict[str, np.ndarray]:
        """Motion from the static state at t = 0: values at `times` under the names of the FMU's outputs."""
        imposed = inputs["head_displacement"] if self.p["drive"] == "Displacement" else None
        f0 = self.p["static_force"]

        def state(t: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            q, v = y[:5].copy(), y[5:10].copy()
            if imposed:
                q[U1], v[U1] = imposed(t), imposed(t, 1)
            return q, v

        def acceleration_and_force(t: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, float]:
            force = self.unbalanced(t, q, v, inputs)
            contact = (f0 + force[U1] - self.mass[U1] * imposed(t, 2)) if imposed else self.contact(t, q, v, inputs)
            force[U1] -= contact - f0
            return force / self.mass, contact

        def dissipated_power(v: np.ndarray) -> float:
            return self.damping(v) @ v + self.moment(v[[ALPHA, BETA]]) @ v[[ALPHA, BETA]]

        def right_side(t: float, y: np.ndarray) -> np.ndarray:
            q, v = state(t, y)
            return np.concatenate([v, acceleration_and_force(t, q, v)[0], [dissipated_power(v)]])

        start = np.concatenate([self.static, np.zeros(6)])
        with np.errstate(over="ignore"):  # SciPy widens its differences for states that act on nothing (energy)
            solution = solve_ivp(
                right_side,
                (0.0, times[-1]),
                start,
                method="Radau",
                t_eval=times,
                rtol=rtol,
                atol=rtol * 1e-3,
                max_step=0.05,
            )
        assert solution.success, solution.message

        columns = []
        for t, y in zip(solution.t, solution.y.T):
            q, v = state(t, y)
            a, contact = acceleration_and_force(t, q, v)
            stretch = self.spring_length(q) - self.p["zspring.l0"]
            columns.append(
                {
                    "head.z": q[U1],
                    "head.v": v[U1],
                    "head.a": a[U1],
                    "contact.force": contact,
                    "upper_frame.z": q[U2],
                    "upper_frame.v": v[U2],
                    "lower_frame.z": q[U3],
                    "lower_frame.v": v[U3],
                    "zspring.alpha": q[ALPHA],
                    "zspring.beta": q[BETA],
                    "zspring.force": self.p["zspring.k"] * stretch,
                    "energy.kinetic": 0.5 * self.mass @ v**2,
                    "energy.dissipated": y[10],
                    "energy.elastic": float(self.energy(q) - self.energy(self.static)),
                }
            )
        return {name: np.array([c[name] for c in columns]) for name in columns[0]}
