"""Measured frequency responses from universal files, data set 58 (function at nodal degree of freedom)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import ZSpringError, missing_extra
from ..units import UnitError, conversion, offered
from .curves import Curve
from .responses import Response

FRF = 4  # function type
MOTIONS = {8: 0, 11: 1, 12: 2}  # specific data type: derivatives of the displacement
FORCES = (9, 13)  # reaction force, excitation force
ACCELERATION = 12

SI = ("m", "m/s", "m/s2")  # of a motion, by derivatives of the displacement


def read_uff(path: Path, amplitude: float | None) -> list[Curve]:
    """The driving-point responses of a universal file, one curve for each data set 58 of function type FRF.

    amplitude   peak in m/s2 for data sets without a Z-axis value; a Z-axis value is a peak acceleration
    The sign of response and reference direction counts. Raises ZSpringError for a missing package, a file
    without driving-point response, and, with the data set's number, for anything that is not clear in it:
    motion and force, units, amplitude, frequencies that do not increase, values that are not finite.
    """
    try:
        import pyuff
    except ImportError:
        raise missing_extra(["pyuff"], "uff") from None
    if not path.is_file():
        raise ZSpringError(f"{path}: no such file")
    try:
        sets = pyuff.UFF(str(path)).read_sets()
    except Exception as error:  # pyuff raises nothing more specific
        raise ZSpringError(f"{path}: no universal file: {error}") from None
    sets = [sets] if isinstance(sets, dict) else list(sets)
    factors = next((s for s in sets if s.get("type") == 164), None)
    curves = []
    for number, data in enumerate(sets, 1):
        if data.get("type") == 58 and data.get("func_type") == FRF and _is_driving_point(data):
            try:
                curves.append(_curve(data, factors, amplitude))
            except ZSpringError as error:
                raise ZSpringError(f"{path}, data set {number}: {error}") from None
    if not curves:
        raise ZSpringError(f"{path}: no data set 58 with the frequency response of a driving point")
    return curves


def _is_driving_point(data: dict) -> bool:
    """Response and force at one node in one direction, either way."""
    return data["rsp_node"] == data["ref_node"] and abs(data["rsp_dir"]) == abs(data["ref_dir"])


def _curve(data: dict, factors: dict | None, amplitude: float | None) -> Curve:
    numerator, denominator = data["ordinate_spec_data_type"], data["orddenom_spec_data_type"]
    if numerator in MOTIONS and denominator in FORCES:
        derivatives, inverse = MOTIONS[numerator], False
    elif numerator in FORCES and denominator in MOTIONS:
        derivatives, inverse = MOTIONS[denominator], True
    else:
        raise ZSpringError(f"types {numerator} over {denominator}: must be motion over force or the inverse")
    factor = _factor(data, "ordinate", numerator, factors) / _factor(data, "orddenom", denominator, factors)
    sign = 1 if data["rsp_dir"] * data["ref_dir"] >= 0 else -1

    frequency, value = np.asarray(data["x"], float), sign * np.asarray(data["data"], complex)
    kept = frequency > 0  # a static line says nothing about a response over acceleration
    frequency, value = frequency[kept], value[kept]
    if not frequency.size or np.any(np.diff(frequency) <= 0):
        raise ZSpringError("the frequencies must increase")
    wrong = np.flatnonzero(~np.isfinite(value) | (value == 0))
    if wrong.size:
        raise ZSpringError(f"the response at {frequency[wrong[0]]:g} Hz is {value[wrong[0]]}")

    peak = float(data.get("z_axis_value") or 0.0)
    if peak and data.get("z_axis_spec_data_type") not in (0, 1, ACCELERATION, None):
        raise ZSpringError(f"Z-axis of type {data['z_axis_spec_data_type']}: must be acceleration (12)")
    if peak < 0 or not (peak or amplitude):
        raise ZSpringError("no amplitude: neither as Z-axis value nor in the settings")
    peak = peak or amplitude or 0.0
    H = Response("", derivatives, inverse, factor).receptance(frequency, value)
    return Curve(f"{peak:g} m/s2", frequency, np.full(frequency.shape, peak), H)


def _factor(data: dict, axis: str, kind: int, factors: dict | None) -> float:
    """From the unit of numerator or denominator to SI: by its label, else by data set 164."""
    label = str(data.get(f"{axis}_axis_units_lab") or "").strip()
    unit = "N" if kind in FORCES else SI[MOTIONS[kind]]
    if label.upper() in ("", "NONE") and factors is not None:
        return 1 / float(factors["force" if kind in FORCES else "length"])
    try:
        return conversion(label, unit)[1]
    except UnitError:
        known = ", ".join(offered(unit))
        raise ZSpringError(f"unit {label!r}: must be one of {known}, or come from a data set 164") from None
