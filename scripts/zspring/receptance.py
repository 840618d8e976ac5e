"""Analytic driving-point receptance of the linear pantograph models at the head.

Three linear models, all in complex form with exp(i omega t), perturbations about the static state:

    linear   three masses, head spring k1
    locked   three masses, head spring zspring.k_locked          (rods held at their static angle)
    free     five degrees of freedom u1, alpha, beta, u2, u3     (no joint friction, rod inertia kept)

With D = -omega^2 M + i omega C + K and the contact force F pushing the head down, D q = -F e1, so that
the receptance is H = -Z/F = (D^-1)_11. K of the free model is the second derivative of the Z-spring's energy

    E = k (l - l0)^2 / 2,    l^2 = A^2 + B^2,
    A = L1 cos(alpha) + L2 cos(beta) - d,    B = -L1 sin(alpha) - L2 sin(beta) + u2 - u1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

HEAD, ALPHA, BETA, UPPER, LOWER = range(5)
MASSES = [HEAD, UPPER, LOWER]


def zspring_stiffness(parameters: Mapping[str, float]) -> np.ndarray:
    """Second derivative of the Z-spring's energy with respect to (u1, alpha, beta, u2) at the static state.

    `parameters` holds the FMU's `zspring.k`, `.l0`, `.L1`, `.L2`, `.d` and the calculated `.theta`.
    Returns a 4 x 4 array: N/m, N, and N.m/rad according to row and column.
    """
    k, l0, L1, L2, d, theta = (
        parameters[f"zspring.{name}"] for name in ("k", "l0", "L1", "L2", "d", "theta")
    )
    s, c = np.sin(theta), np.cos(theta)
    A = L1 * c + L2 * c - d
    B = -L1 * s - L2 * s + d * np.tan(theta)
    length = np.hypot(A, B)
    dA = np.array([0.0, -L1 * s, -L2 * s, 0.0])
    dB = np.array([-1.0, -L1 * c, -L2 * c, 1.0])
    d2A = np.diag([0.0, -L1 * c, -L2 * c, 0.0])
    d2B = np.diag([0.0, L1 * s, L2 * s, 0.0])
    dl = (A * dA + B * dB) / length
    d2l = (np.outer(dA, dA) + np.outer(dB, dB) + A * d2A + B * d2B - np.outer(dl, dl)) / length
    return k * np.outer(dl, dl) + k * (length - l0) * d2l


def receptance(frequency: np.ndarray, parameters: Mapping[str, float], model: str) -> np.ndarray:
    """Receptance H = -Z/F at the head in m/N.

    frequency   in Hz, any shape, > 0
    parameters  the FMU's parameters by name, calculated ones included, in its units
    model       "linear", "locked" or "free", see above
    Returns a complex array of the shape of `frequency`.
    """
    p = parameters
    mass = np.diag([p["m1"], p["zspring.J1"], p["zspring.J2"], p["m2"], p["m3"]])
    damping, stiffness = np.zeros((5, 5)), np.zeros((5, 5))
    _connect(damping, HEAD, UPPER, p["c1"])
    for matrix, upper, lower in ((damping, p["c2"], p["c3"]), (stiffness, p["k2"], p["k3"])):
        _connect(matrix, UPPER, LOWER, upper)
        matrix[LOWER, LOWER] += lower

    if model == "free":
        stiffness[:4, :4] += zspring_stiffness(p)
        kept = [HEAD, ALPHA, BETA, UPPER, LOWER]
    elif model in ("locked", "linear"):
        _connect(stiffness, HEAD, UPPER, p["zspring.k_locked" if model == "locked" else "k1"])
        kept = MASSES
    else:
        raise ValueError(f"model = {model!r}: must be 'linear', 'locked' or 'free'")

    mass, damping, stiffness = (matrix[np.ix_(kept, kept)] for matrix in (mass, damping, stiffness))
    omega = 2 * np.pi * np.asarray(frequency, dtype=float)[..., None, None]
    dynamic = -(omega**2) * mass + 1j * omega * damping + stiffness
    unit_force = np.eye(len(kept))[:, :1]
    return np.linalg.solve(dynamic, np.broadcast_to(unit_force, dynamic.shape[:-1] + (1,)))[..., HEAD, 0]


def _connect(matrix: np.ndarray, i: int, j: int, value: float) -> None:
    """Add a spring or damper of the given value between degrees of freedom i and j."""
    matrix[i, i] += value
    matrix[j, j] += value
    matrix[i, j] -= value
    matrix[j, i] -= value
