"""The regularised pantograph on the bench as a compiled first-order system, which all peers integrate.

The head is moved as by the FMU's drive Bench: u1 = X r(t) sin(2 pi f t) with X = acceleration / (2 pi f)^2
and the ramp r = 10 s^3 - 15 s^4 + 6 s^5, s = f t, over the first period. Unknown are the departures from the
static state y = (alpha, beta, u2, u3) and their rates, in rad, m, rad/s, m/s: measured from there, relative
tolerances refer to the motion. With E = k (l - l0)^2 / 2 + k2 (u2 - u3)^2 / 2 + k3 u3^2 / 2,

    J alpha'' = -dE/dalpha - Mf tanh(tau alpha'),    m u'' = -(dE/du - dE/du_static) - damping

and the contact force is what the head's own equation of motion leaves over.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

import numba
import numpy as np

SIZE = 8
UPPER_FRAME = 2  # index of u2

_NAMES = ["m1", "m2", "m3", "c1", "c2", "c3", "k2", "k3"]
_ZSPRING = ["k", "l0", "L1", "L2", "d", "J1", "J2", "Mf", "tau", "theta"]
MODEL = np.dtype([(name, float) for name in [*_NAMES, *_ZSPRING, "tension", "peak", "frequency"]])


def bench_model(parameters: Mapping[str, float], frequency: float, acceleration: float) -> np.ndarray:
    """Everything `dynamics` needs, as a record array of shape (1,).

    parameters      the FMU's, calculated ones included, in its units
    frequency       of the bench in Hz
    acceleration    peak acceleration of the head in m/s2
    """
    model = np.zeros(1, MODEL)
    for name in _NAMES:
        model[name] = parameters[name]
    for name in _ZSPRING:
        model[name] = parameters[f"zspring.{name}"]
    p = model[0]
    p["tension"] = p["k"] * (p["d"] / np.cos(p["theta"]) - p["L1"] - p["L2"] - p["l0"])
    p["peak"], p["frequency"] = acceleration / (2 * pi * frequency) ** 2, frequency
    return model


def scales(model: np.ndarray) -> np.ndarray:
    """Typical size of each state, shape (8,): the stroke, the angle it turns a rod by, and their rates."""
    p = model[0]
    sizes = p["peak"] * np.array([1 / p["L1"], 1 / p["L2"], 1, 1])
    return np.append(sizes, 2 * pi * p["frequency"] * sizes)


@numba.njit(inline="always")
def head_motion(t, p):
    """Position (m), velocity and acceleration of the head at time t (s)."""
    w = 2 * pi * p.frequency
    sine, cosine = np.sin(w * t), np.cos(w * t)
    s = p.frequency * t
    if s >= 1:
        return p.peak * sine, p.peak * w * cosine, -p.peak * w * w * sine
    r = s**3 * (10 - 15 * s + 6 * s * s)
    dr = p.frequency * 30 * s * s * (1 - s) ** 2
    ddr = p.frequency**2 * 60 * s * (1 - s) * (1 - 2 * s)
    return (
        p.peak * r * sine,
        p.peak * (dr * sine + r * w * cosine),
        p.peak * ((ddr - r * w * w) * sine + 2 * dr * w * cosine),
    )


@numba.njit
def dynamics(dy, t, y, p):
    """Write the time derivative of y, shape (8,), into dy; returns contact force less static force in N."""
    u1, v1, a1 = head_motion(t, p)
    sin_a, cos_a = np.sin(p.theta + y[0]), np.cos(p.theta + y[0])
    sin_b, cos_b = np.sin(p.theta + y[1]), np.cos(p.theta + y[1])
    A = p.L1 * cos_a + p.L2 * cos_b - p.d
    B = p.d * np.tan(p.theta) - p.L1 * sin_a - p.L2 * sin_b + y[2] - u1
    length = np.sqrt(A * A + B * B)
    tension = p.k * (length - p.l0)
    ex, ey = A / length, B / length  # unit vector along the spring

    head = tension * ey - p.tension * np.sin(p.theta) + p.c1 * (y[6] - v1)  # pulls the frame down, head up
    frames = p.k2 * (y[2] - y[3]) + p.c2 * (y[6] - y[7])
    dy[0], dy[1], dy[2], dy[3] = y[4], y[5], y[6], y[7]
    dy[4] = (tension * p.L1 * (ex * sin_a + ey * cos_a) - p.Mf * np.tanh(p.tau * y[4])) / p.J1
    dy[5] = (tension * p.L2 * (ex * sin_b + ey * cos_b) - p.Mf * np.tanh(p.tau * y[5])) / p.J2
    dy[6] = (-head - frames) / p.m2
    dy[7] = (frames - p.k3 * y[3] - p.c3 * y[7]) / p.m3
    return head - p.m1 * a1


@numba.njit
def contact_force(t, y, model):
    """Contact force less static force in N at times t (n,) for states y (n, 8)."""
    force, unused = np.empty(t.size), np.empty(SIZE)
    for i in range(t.size):
        force[i] = dynamics(unused, t[i], y[i], model[0])
    return force
