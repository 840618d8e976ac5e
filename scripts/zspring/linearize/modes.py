"""Modes of a linear model M q'' + C q' + K q = 0, damped and undamped, and with the head held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, eig

from ..errors import ZSpringError
from ..receptance import HEAD, LinearModel

NEGLIGIBLE = 1e-9  # of the largest: of an eigenvalue, or of a shape's entry, no more than rounding


@dataclass(frozen=True)
class Modes:
    """Complex modes q = Re(shape exp(s t)), one of each conjugate pair, by ascending |s|."""

    eigenvalues: np.ndarray  # (modes,) s in 1/s
    shapes: np.ndarray  # (n, modes), columns

    @property
    def frequencies(self) -> np.ndarray:
        """|s| / 2 pi in Hz: of an undamped mode its natural frequency."""
        return np.abs(self.eigenvalues) / (2 * np.pi)

    @property
    def damping(self) -> np.ndarray:
        """Damping ratio -Re(s) / |s|; 1 for a mode that does not oscillate, NaN for a rigid one (s = 0)."""
        with np.errstate(invalid="ignore"):
            return -self.eigenvalues.real / np.abs(self.eigenvalues)


def complex_modes(model: LinearModel, reach: np.ndarray) -> Modes:
    """Modes with damping. Degrees of freedom without mass and damper have none of their own.

    reach   (n,) motion in m that one unit of each degree of freedom makes; the largest one of a shape is 1
    """
    n = len(model.names)
    zero, one = np.zeros((n, n)), np.eye(n)
    state = np.block([[zero, one], [-model.K, -model.C]])
    s, vectors = _finite_eig(state, np.block([[one, zero], [zero, model.M]]))
    s = np.where(np.abs(s) > NEGLIGIBLE * np.abs(s).max(), s, 0)
    kept = s.imag >= -NEGLIGIBLE * np.abs(s)
    s, shapes = s[kept], vectors[:n, kept]
    largest = np.abs(reach[:, None] * shapes).argmax(axis=0)
    shapes = shapes / (reach[largest] * np.take_along_axis(shapes, largest[None], 0)[0])
    order = np.argsort(np.abs(s))
    return Modes(s[order], shapes[:, order])


def natural_frequencies(model: LinearModel, head_held: bool = False) -> np.ndarray:
    """Undamped natural frequencies in Hz, ascending; with the head held: the antiresonances at the head."""
    kept = slice(HEAD + 1 if head_held else HEAD, None)
    squares, _ = _finite_eig(model.K[kept, kept], model.M[kept, kept])
    return np.sort(np.sqrt(np.maximum(squares.real, 0))) / (2 * np.pi)


def _finite_eig(A: np.ndarray, B: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and vectors of A x = s B x without the infinite ones, which B's null space makes.

    Raises ZSpringError where LAPACK finds none, as with parameters of 1e300.
    """
    try:
        (numerator, denominator), vectors = eig(A, B, homogeneous_eigvals=True)
    except LinAlgError as error:
        raise ZSpringError(f"no modes with these parameters: {error}") from None
    finite = np.abs(denominator) > 1e-14 * np.abs(denominator).max()
    return numerator[finite] / denominator[finite], vectors[:, finite]
