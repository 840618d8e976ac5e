"""The peers: ODE solvers in compiled code, which call the compiled right-hand side without Python between.

    RK45, LSODA, Radau, DOP853   CyRK's C++ solvers, after Dormand, Prince (1980) and SciPy, ODEPACK, and
                                 Hairer, Wanner (1996); RK45 is the pair that MATLAB's ode45 uses
    CVODE                        BDF with modified Newton of SUNDIALS, the library in FMPy
    RK4                          the classic method with fixed steps, below

LSODA, Radau and CVODE take their Jacobians by finite differences of the right-hand side.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np
from CyRK.nb import numba_solver as cyrk
from numba import carray, types

from . import cvode
from .model import MODEL, SIZE, dynamics, scales

# Time of this thread alone is fair to long runs on a busy machine, but Windows counts it in steps of 16 ms.
clock = time.thread_time if time.get_clock_info("thread_time").resolution < 1e-6 else time.perf_counter

# In MB. CyRK limits the steps to what it could store, but it stores only those asked for.
MEMORY_LIMIT = 1_000_000


@dataclass(frozen=True)
class Run:
    """One integration: states (times, 8), seconds in the solver, accepted steps."""

    states: np.ndarray
    seconds: float
    steps: int


class SolverFailed(Exception):
    """The solver gave up; the text is its own."""


@numba.cfunc(types.void(types.CPointer(types.float64), types.float64, types.CPointer(types.float64), types.voidptr))
def _right_side(dy, t, y, model):
    dynamics(carray(dy, (SIZE,)), t, carray(y, (SIZE,)), carray(model, (1,), MODEL)[0])


def _cyrk(method: str, model: np.ndarray, times: np.ndarray, rtol: float, atol: np.ndarray) -> Run:
    start, rtols, arguments = np.zeros(SIZE), np.array([rtol]), model.view(float)
    # The C function behind nbsolve2_ivp, which itself would take half a minute to compile.
    call = (
        _right_side.address,
        0.0,
        times[-1],
        start.ctypes.data,
        SIZE,
        cyrk.find_ode_method_int(method),
        0,
        0,
        arguments.ctypes.data,
        arguments.nbytes,
        0,
        MEMORY_LIMIT,
        False,
        times.ctypes.data,
        times.size,
        None,
        None,
        0,
        rtols.ctypes.data,
        1,
        atol.ctypes.data,
        SIZE,
        np.inf,
        0.0,
        False,
    )
    begin = clock()
    result = cyrk.c_numba_cysolve_ivp(*call)
    seconds = clock() - begin
    try:
        count = cyrk.c_get_size(result)
        if not cyrk.c_get_success(result) or count != times.size:
            text = ctypes.create_string_buffer(256)
            cyrk.c_get_msg_buf(result, ctypes.addressof(text), len(text))
            raise SolverFailed(f"CyRK's {method}: {text.value.decode(errors='replace').strip()}")
        states = np.ctypeslib.as_array(cyrk.c_get_y_ptr(result), (count, SIZE)).copy()
        return Run(states, seconds, int(cyrk.c_get_steps(result)))
    finally:
        cyrk.c_free(result)


def _cvode(model: np.ndarray, times: np.ndarray, rtol: float, atol: np.ndarray) -> Run:
    with cvode.Cvode(model, rtol, atol) as solver:
        states = np.empty((times.size, SIZE))
        begin = clock()
        status = solver.run(times, states)
        seconds = clock() - begin
        if status < 0:
            raise SolverFailed(f"CVODE, status {status}")
        return Run(states, seconds, solver.steps())


ADAPTIVE: dict[str, Callable[[np.ndarray, np.ndarray, float, np.ndarray], Run]] = {
    "CVODE": _cvode,
    **{name: (lambda *a, _name=name: _cyrk(_name, *a)) for name in ("RK45", "LSODA", "Radau", "DOP853")},
}


def solve(method: str, model: np.ndarray, times: np.ndarray, rtol: float, atol_factor: float) -> Run:
    """Integrate from the static state at t = 0 with an adaptive method, a key of ADAPTIVE.

    times           (n,) in s, ascending, where the states are wanted; the last one is the end
    rtol            relative tolerance; the absolute one of a state is rtol * atol_factor * its typical size
    Raises SolverFailed.
    """
    return ADAPTIVE[method](model, times, rtol, rtol * atol_factor * scales(model))


def rk4(model: np.ndarray, times: np.ndarray, step: float) -> Run:
    """Classic Runge-Kutta method with fixed steps of about `step` s, a whole number of them up to each time.

    Raises SolverFailed if the result is not finite.
    """
    states = np.empty((times.size, SIZE))
    begin = clock()
    steps = _rk4(model, times, step, states)
    seconds = clock() - begin
    if not np.isfinite(states).all():
        raise SolverFailed("RK4: the motion grows without bound")
    return Run(states, seconds, steps)


@numba.njit
def _rk4(model, times, step, states):
    p = model[0]
    y, k1, k2, k3, k4 = np.zeros(SIZE), np.empty(SIZE), np.empty(SIZE), np.empty(SIZE), np.empty(SIZE)
    t, total = 0.0, 0
    for i in range(times.size):
        n = max(1, round((times[i] - t) / step))
        h = (times[i] - t) / n
        for j in range(n):
            now = t + j * h
            dynamics(k1, now, y, p)
            dynamics(k2, now + h / 2, y + h / 2 * k1, p)
            dynamics(k3, now + h / 2, y + h / 2 * k2, p)
            dynamics(k4, now + h, y + h * k3, p)
            y += h / 6 * (k1 + 2 * (k2 + k3) + k4)
        t = times[i]
        total += n
        states[i] = y
    return total


def warm_up(model: np.ndarray) -> None:
    """Compile what is compiled on first use, so that no timed run has to."""
    times = np.array([1e-6])
    rk4(model, times, 1e-6)
    for method in ADAPTIVE:
        solve(method, model, times, 1e-3, 1.0)
