"""The Z-spring's linkage: where its joints and rod ends are, and the force of its spring.

Two rods and one spring between head and upper frame. With the gap u2 - u1 between the masses' joints

    E = k (l - l0)^2 / 2,    l^2 = A^2 + B^2,
    A = L1 cos(alpha) + L2 cos(beta) - d,    B = -L1 sin(alpha) - L2 sin(beta) + gap.

In the static state alpha = beta = theta, and rods and spring lie on one line, so that gap = d tan(theta).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np


def static_gap(parameters: Mapping[str, float]) -> float:
    """u2 - u1 in the static state in m, from the FMU's `zspring.d` and the calculated `zspring.theta`."""
    return float(parameters["zspring.d"] * np.tan(parameters["zspring.theta"]))


def force_and_tangent(
    parameters: Mapping[str, float], alpha: float, beta: float, gap: float
) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of the energy E with respect to (u1, alpha, beta, u2).

    parameters  the FMU's zspring.k, .l0, .L1, .L2, .d by name, in its units
    alpha, beta in rad, gap in m
    Returns (4,) in N and N.m, and (4, 4) in N/m, N and N.m/rad according to row and column.
    """
    k, l0, L1, L2, d = (parameters[f"zspring.{name}"] for name in ("k", "l0", "L1", "L2", "d"))
    A = L1 * np.cos(alpha) + L2 * np.cos(beta) - d
    B = -L1 * np.sin(alpha) - L2 * np.sin(beta) + gap
    length = np.hypot(A, B)
    dA = np.array([0.0, -L1 * np.sin(alpha), -L2 * np.sin(beta), 0.0])
    dB = np.array([-1.0, -L1 * np.cos(alpha), -L2 * np.cos(beta), 1.0])
    d2A = np.diag([0.0, -L1 * np.cos(alpha), -L2 * np.cos(beta), 0.0])
    d2B = np.diag([0.0, L1 * np.sin(alpha), L2 * np.sin(beta), 0.0])
    dl = (A * dA + B * dB) / length
    d2l = (np.outer(dA, dA) + np.outer(dB, dB) + A * d2A + B * d2B - np.outer(dl, dl)) / length
    tension = k * (length - l0)
    return tension * dl, k * np.outer(dl, dl) + tension * d2l


def linkage_points(
    parameters: Mapping[str, float], u1: np.ndarray, alpha: np.ndarray, beta: np.ndarray, u2: np.ndarray
) -> np.ndarray:
    """Head's joint, end of its rod, end of the frame's rod, frame's joint: (..., 4, 2), x and z in m.

    u1, u2 (...,) in m from the static state, alpha, beta (...,) in rad. The origin is the head's joint in the
    static state; the spring is between the two rod ends.
    """
    L1, L2, d = (parameters[f"zspring.{name}"] for name in ("L1", "L2", "d"))
    top = u2 + static_gap(parameters)
    x = [np.zeros_like(u1), L1 * np.cos(alpha), d - L2 * np.cos(beta), np.full_like(u1, d)]
    z = [u1, u1 + L1 * np.sin(alpha), top - L2 * np.sin(beta), top]
    return np.stack([np.stack(x, -1), np.stack(z, -1)], -1)
