"""The core's elements as Python functions, through the C++ probe that scripts/test builds (tests/native)."""

from __future__ import annotations

import ctypes
import os
import sys
from functools import cache
from pathlib import Path

import numpy as np

FREE, TANH, COULOMB, LOCKED = range(4)


def probe_folder() -> Path:
    """Where scripts/test built the programs of tests/native."""
    if "ZSPRING_PROBES" not in os.environ:
        raise RuntimeError("ZSPRING_PROBES is not set: run the tests with scripts/test")
    return Path(os.environ["ZSPRING_PROBES"])


@cache
def _probe() -> ctypes.CDLL:
    suffix = ".dll" if sys.platform == "win32" else ".so"
    return ctypes.CDLL(str(probe_folder() / f"core_probe{suffix}"))


def _doubles(values) -> ctypes.Array:
    return (ctypes.c_double * len(values))(*values)


def zspring(parameters, coordinates) -> tuple[float, np.ndarray, np.ndarray]:
    """Energy (J), force (4,) and tangent (4, 4) with respect to u1, alpha, beta, u2 (m, rad).

    parameters    k, l0, L1, L2, d in SI units
    coordinates   alpha, beta in rad, gap u2 - u1 in m
    """
    out = _doubles([0.0] * 21)
    assert _probe().probe_zspring(_doubles(parameters), _doubles(coordinates), out)
    return out[0], np.array(out[1:5]), np.array(out[5:]).reshape(4, 4)


def resolvent(law: int, rho: float, tau: float, z: float, w_guess: float = 0.0) -> tuple[float, float, float, float]:
    """w (rad/s), s (1) and their slopes for z = rho w + s."""
    out = _doubles([0.0] * 4)
    arguments = [ctypes.c_double(value) for value in (rho, tau, z, w_guess)]
    _probe().probe_resolvent(ctypes.c_int(law), *arguments, out)
    return tuple(out)


def static_state(parameters, load: float) -> dict[str, float] | None:
    """theta, gap, length, tension, k_locked, k_free; None where there is no static state."""
    out = _doubles([0.0] * 6)
    if not _probe().probe_static_state(_doubles(parameters), ctypes.c_double(load), out):
        return None
    return dict(zip(("theta", "gap", "length", "tension", "k_locked", "k_free"), out))
