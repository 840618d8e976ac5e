"""Linear pantograph models and their driving-point receptance at the head.

Three linear models, perturbations about the static state:

    linear   three masses, head spring k1
    locked   three masses, head spring zspring.k_locked          (rods held at their static angle)
    free     five degrees of freedom u1, alpha, beta, u2, u3     (no joint friction, rod inertia kept)

M q'' + C q' + K q = -F e1 with the contact force F pushing the head down. In complex form with exp(i omega t)
D = -omega^2 M + i omega C + K, so that the receptance is H = -Z/F = (D^-1)_11.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .linkage import force_and_tangent, static_gap

HEAD, ALPHA, BETA, UPPER, LOWER = range(5)
MASSES = [HEAD, UPPER, LOWER]
NAMES = ("u1", "alpha", "beta", "u2", "u3")
MODELS = ("linear", "locked", "free")


@dataclass(frozen=True)
class LinearModel:
    """Mass, damping and stiffness matrix, (n, n) each, in SI units; u in m, rod angles in rad."""

    names: tuple[str, ...]  # of the degrees of freedom, n = 3 or 5; the head comes first
    M: np.ndarray
    C: np.ndarray
    K: np.ndarray

    def receptance(self, frequency: np.ndarray) -> np.ndarray:
        """H = -Z/F at the head in m/N, complex, for frequencies > 0 in Hz of any shape."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)[..., None, None]
        dynamic = -(omega**2) * self.M + 1j * omega * self.C + self.K
        force = np.broadcast_to(np.eye(len(self.names))[:, :1], (*dynamic.shape[:-1], 1))
        return np.linalg.solve(dynamic, force)[..., HEAD, 0]

    def level_slope(self, frequency: float) -> float:
        """d log |H| / d omega in s at the head, for a frequency > 0 in Hz."""
        omega, unit = 2 * np.pi * frequency, np.eye(len(self.names))[HEAD]
        dynamic = -(omega**2) * self.M + 1j * omega * self.C + self.K
        answer = np.linalg.solve(dynamic, unit)  # D is symmetric, so that H' = -answer D' answer
        change = -2 * omega * self.M + 1j * self.C
        return float((-(answer @ change @ answer) / answer[HEAD]).real)


def linear_model(parameters: Mapping[str, float], model: str) -> LinearModel:
    """A linear model of the pantograph.

    parameters  the FMU's parameters by name, calculated ones included, in its units
    model       one of MODELS, see above
    """
    p = parameters
    mass = np.diag([p["m1"], p["zspring.J1"], p["zspring.J2"], p["m2"], p["m3"]])
    damping, stiffness = np.zeros((5, 5)), np.zeros((5, 5))
    _connect(damping, HEAD, UPPER, p["c1"])
    for matrix, upper, lower in ((damping, p["c2"], p["c3"]), (stiffness, p["k2"], p["k3"])):
        _connect(matrix, UPPER, LOWER, upper)
        matrix[LOWER, LOWER] += lower

    if model == "free":
        theta = p["zspring.theta"]
        stiffness[:4, :4] += force_and_tangent(p, theta, theta, static_gap(p))[1]
        kept = [HEAD, ALPHA, BETA, UPPER, LOWER]
    elif model in MODELS:
        _connect(stiffness, HEAD, UPPER, p["zspring.k_locked" if model == "locked" else "k1"])
        kept = MASSES
    else:
        raise ValueError(f"model = {model!r}: must be one of {', '.join(MODELS)}")
    return LinearModel(
        tuple(NAMES[i] for i in kept), *(matrix[np.ix_(kept, kept)] for matrix in (mass, damping, stiffness))
    )


def receptance(frequency: np.ndarray, parameters: Mapping[str, float], model: str) -> np.ndarray:
    """Receptance H = -Z/F at the head in m/N of a linear model, see LinearModel."""
    return linear_model(parameters, model).receptance(frequency)


def _connect(matrix: np.ndarray, i: int, j: int, value: float) -> None:
    """Add a spring or damper of the given value between degrees of freedom i and j."""
    matrix[i, i] += value
    matrix[j, j] += value
    matrix[i, j] -= value
    matrix[j, i] -= value
