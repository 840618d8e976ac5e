"""CVODE of the SUNDIALS library that FMPy ships, with a compiled right-hand side and output loop."""

from __future__ import annotations

import ctypes

import numba
import numpy as np
from fmpy import sundials
from fmpy.sundials.libraries import (
    sundials_core,
    sundials_cvode,
    sundials_nvecserial,
    sundials_sunlinsoldense,
    sundials_sunmatrixdense,
)
from numba import carray, types

from .model import MODEL, SIZE, dynamics

ADVANCE_TO_TIME = 1  # CV_NORMAL of cvode.h


def _address(library: ctypes.CDLL, name: str) -> int:
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0


# As functions of plain addresses, which compiled code can call.
_data_of = ctypes.CFUNCTYPE(ctypes.POINTER(ctypes.c_double), ctypes.c_void_p)(
    _address(sundials_nvecserial, "N_VGetArrayPointer_Serial")
)
_advance = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_size_t, ctypes.c_double, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_int
)(_address(sundials_cvode, "CVode"))


@numba.cfunc(types.int32(types.float64, types.voidptr, types.voidptr, types.voidptr))
def _right_side(t, y, dy, model):
    dynamics(carray(_data_of(dy), (SIZE,)), t, carray(_data_of(y), (SIZE,)), carray(model, (1,), MODEL)[0])
    return 0


@numba.njit
def _run(memory, vector, data, reached, times, states):
    for i in range(times.size):
        status = _advance(memory, times[i], vector, reached, ADVANCE_TO_TIME)
        if status < 0:
            return status
        states[i] = data
    return 0


class Cvode:
    """BDF with dense modified Newton from the static state at t = 0; a context manager.

    model, atol     as `bench_model` makes it; absolute tolerance of each state, shape (8,)
    """

    def __init__(self, model: np.ndarray, rtol: float, atol: np.ndarray):
        self._model = model
        self._context = sundials.SUNContext()
        self._check(sundials.SUNContext_Create(sundials.SUN_COMM_NULL, ctypes.byref(self._context)))
        # Failures come back as a status; nothing is to be printed.
        self._silent = sundials.SUNErrHandlerFn(lambda *_: None)
        sundials.SUNContext_PushErrHandler(self._context, self._silent, None)
        self._y, self._tolerances = (sundials.N_VNew_Serial(SIZE, self._context) for _ in range(2))
        self._data = np.ctypeslib.as_array(sundials.NV_DATA_S(self._y), (SIZE,))
        self._data[:] = 0
        np.ctypeslib.as_array(sundials.NV_DATA_S(self._tolerances), (SIZE,))[:] = atol
        self._memory = ctypes.c_void_p(sundials.CVodeCreate(sundials.CV_BDF, self._context))
        right_side = ctypes.cast(_right_side.address, sundials.CVRhsFn)
        self._check(sundials.CVodeInit(self._memory, right_side, 0.0, self._y))
        self._check(sundials.CVodeSVtolerances(self._memory, rtol, self._tolerances))
        self._matrix = sundials.SUNDenseMatrix(SIZE, SIZE, self._context)
        self._solver = sundials.SUNLinSol_Dense(self._y, self._matrix, self._context)
        self._check(sundials.CVodeSetLinearSolver(self._memory, self._solver, self._matrix))
        self._check(sundials.CVodeSetMaxNumSteps(self._memory, -1))
        self._check(sundials_cvode.CVodeSetUserData(self._memory, ctypes.c_void_p(model.ctypes.data)))

    def run(self, times: np.ndarray, states: np.ndarray) -> int:
        """Write the states at `times` (n,) into `states` (n, 8); returns the status, < 0 for a failure."""
        vector = ctypes.cast(self._y, ctypes.c_void_p).value
        reached = ctypes.c_double()
        return _run(self._memory.value, vector, self._data, ctypes.addressof(reached), times, states)

    def steps(self) -> int:
        """Steps taken so far."""
        count = ctypes.c_long()
        self._check(sundials_cvode.CVodeGetNumSteps(self._memory, ctypes.byref(count)))
        return count.value

    def __enter__(self) -> Cvode:
        return self

    def __exit__(self, *_) -> None:
        sundials.CVodeFree(ctypes.byref(self._memory))
        sundials_sunlinsoldense.SUNLinSolFree_Dense(ctypes.c_void_p(self._solver))
        sundials_sunmatrixdense.SUNMatDestroy_Dense(ctypes.c_void_p(self._matrix))
        for vector in (self._y, self._tolerances):
            sundials.N_VDestroy_Serial(vector)
        sundials_core.SUNContext_Free(ctypes.byref(self._context))

    @staticmethod
    def _check(status: int) -> None:
        if status:
            raise RuntimeError(f"SUNDIALS refused a call with status {status}")
