"""Measured frequency responses from universal files, data set 58 (function at nodal degree of freedom).

Types and units say what the axes are; labels go before a data set 164. Nothing is guessed: what a file does not tell
is refused, with how to tell it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..settings import named
from ..units import NONE, UnitError, conversion, offered
from .curves import Curve
from .responses import AMPLITUDES, Response, acceleration_of
from .uff_file import FUNCTION, UNITS, DataSet, UniversalFile

FRF = 4  # function type
# Specific data types of axes.
UNKNOWN, RPM = (0, 1), 19
ABSCISSAE = (*UNKNOWN, 18, RPM)  # 18: frequency
MOTIONS = {8: "m", 11: "m/s", 12: "m/s2"}
FORCES = (9, 13)  # reaction force, excitation force
COMPLEX = (5, 6)  # ordinate data types

MOST_LISTED = 6


def read_uff(path: Path, amplitude: float | None, chosen: Sequence[int] = ()) -> list[Curve]:
    """The driving-point responses of a universal file, one curve for each data set 58 of function type FRF.

    amplitude   peak in m/s2 for data sets whose Z axis has no value, or a value that is no amplitude
    chosen      numbers of the data sets to read, from 1; empty: those with response and force at one node in one
                direction, if this tells one driving point
    The sign of response and reference direction counts. Raises ZSpringError for a missing package, a file without
    driving-point response or with more than one, and, with the data set's number, for anything that is not clear in it:
    motion and force, units, frequencies, the phase, the amplitude, values that are not finite.
    """
    with UniversalFile(path) as file:
        responses = {s.number: s for s in file.sets if s["type"] == FUNCTION and s["func_type"] == FRF}
        for number in chosen:
            if number not in responses:
                there = ", ".join(map(str, responses)) or "none"
                raise ZSpringError(f"{path}: data set {number} is no frequency response (those are: {there})")
        picked = [responses[number] for number in chosen] or _driving_points(path, list(responses.values()))
        curves = []
        for data in picked:
            with named(f"{path}, data set {data.number}: "):
                curves.append(_curve(file, data, _factors(file, data), amplitude))
    if not chosen:
        _check_levels(path, picked, curves)
    return curves


def _driving_points(path: Path, responses: Sequence[DataSet]) -> list[DataSet]:
    """The responses at the driving point. Raises ZSpringError where nodes and directions do not tell which they are."""
    at_force = [data for data in responses if _place(data, "rsp") == _place(data, "ref") and _one_entity(data)]
    if not at_force:
        hint = f": {_choice(responses)}" if responses else ", function type 4"
        raise ZSpringError(f"{path}: no data set 58 with the frequency response of a driving point{hint}")
    places = {_place(data, "rsp") for data in at_force}
    if any(node == 0 for node, _ in places):
        raise ZSpringError(f"{path}: node 0 does not tell the driving point: {_choice(at_force)}")
    if len(places) > 1:
        raise ZSpringError(f"{path}: driving points at {len(places)} nodes or directions: {_choice(at_force)}")
    return at_force


def _check_levels(path: Path, picked: Sequence[DataSet], curves: Sequence[Curve]) -> None:
    """Raises ZSpringError for two data sets with one amplitude at the same frequencies: one may be of another point."""
    for (first, a), (second, b) in itertools.combinations(zip(picked, curves), 2):
        common = np.isin(a.frequency, b.frequency)
        if a.label == b.label and common.any():
            text = f"data sets {first.number} and {second.number} have one place and one amplitude, {a.label}"
            raise ZSpringError(f"{path}: {text}: {_choice(picked)}")


def _place(data: DataSet, which: str) -> tuple[int, int]:
    """Node and direction, whose sign only tells how values count."""
    return data[f"{which}_node"], abs(data[f"{which}_dir"])


def _one_entity(data: DataSet) -> bool:
    """Whether response and reference are of one component, as far as it is named."""
    response, reference = (data.text(f"{which}_ent_name").lower() for which in ("rsp", "ref"))
    return response == reference or not (response and reference)


def _choice(candidates: Sequence[DataSet]) -> str:
    """How to choose, and what tells the candidates apart."""
    texts = [[data.text(f"id{i}") for i in range(1, 6)] for data in candidates]
    telling = [i for i in range(5) if len({text[i] for text in texts}) > 1] or [0]
    shown = []
    for data, text in list(zip(candidates, texts))[:MOST_LISTED]:
        place = "/".join(
            f"{data.text(f'{which}_ent_name')} {data[f'{which}_node']}{_direction(data[f'{which}_dir'])}".strip()
            for which in ("rsp", "ref")
        )
        shown.append(f"{data.number} ({', '.join([*(text[i] for i in telling if text[i]), place])})")
    more = len(candidates) - len(shown)
    listed = ", ".join(shown) + (f" and {more} more" if more else "")
    first = candidates[0].number
    return f"choose by data_sets = [{first}] or its option (--frf-data-sets, --measured-data-sets) from {listed}"


def _direction(number: int) -> str:
    name = ("", "X", "Y", "Z", "RX", "RY", "RZ")[abs(number)] if abs(number) <= 6 else str(abs(number))
    return f"{'-' if number < 0 else '+'}{name}" if number else ""


def _factors(file: UniversalFile, data: DataSet) -> DataSet | None:
    """The data set 164 that tells the units of a data set: the last one before it, or the file's only one."""
    units = [each for each in file.sets if each["type"] == UNITS]
    before = [each for each in units if each.number < data.number]
    return before[-1] if before else units[0] if len(units) == 1 else None


def _curve(file: UniversalFile, data: DataSet, factors: DataSet | None, amplitude: float | None) -> Curve:
    numerator, denominator = data["ordinate_spec_data_type"], data["orddenom_spec_data_type"]
    if numerator in MOTIONS and denominator in FORCES:
        motion, inverse = numerator, False
    elif numerator in FORCES and denominator in MOTIONS:
        motion, inverse = denominator, True
    else:
        raise ZSpringError(f"types {numerator} over {denominator}: must be motion over force or the inverse")
    if data["ord_data_type"] not in COMPLEX:
        raise ZSpringError(f"ordinate of data type {data['ord_data_type']}, real: the phase is missing")
    factor = _factor(data, "ordinate", numerator, factors) / _factor(data, "orddenom", denominator, factors)
    to_hertz = _to_hertz(data)

    x, ordinate = file.values(data)
    frequency, value = to_hertz * x, ordinate.astype(complex)
    if data["rsp_dir"] * data["ref_dir"] < 0:
        value = -value
    if to_hertz != 1 and not data["abscissa_spacing"]:  # the file has six digits, and no more are known of them in Hz
        frequency = np.array([float(f"{f:.6g}") for f in frequency])
    kept = frequency > 0  # a static line says nothing about a response over acceleration
    frequency, value = frequency[kept], value[kept]
    steps = np.diff(frequency)
    if not np.all(np.isfinite(x)) or not frequency.size or not (np.all(steps > 0) or np.all(steps < 0)):
        raise ZSpringError("the frequencies must all rise or all fall")
    wrong = np.flatnonzero(~np.isfinite(value) | (value == 0))
    if wrong.size:
        raise ZSpringError(f"the response at {frequency[wrong[0]]:g} Hz is {value[wrong[0]]}")
    H = Response("", AMPLITUDES[MOTIONS[motion]], inverse, factor).receptance(frequency, value)
    peak, unit = _amplitude(data, factors, amplitude)
    return Curve(f"{peak:g} {unit}", frequency, acceleration_of(unit, frequency, np.full(frequency.shape, peak)), H)


def _to_hertz(data: DataSet) -> float:
    """From the unit of the abscissa to Hz. Raises ZSpringError, with its label, for one that is no frequency."""
    kind, label, name = data["abscissa_spec_data_type"], data.text("abscissa_axis_units_lab"), "abscissa_axis_lab"
    unit = ("rpm" if kind == RPM else "Hz") if label in NONE else label
    try:
        if kind in ABSCISSAE:
            return conversion(unit, "Hz")[1]
    except UnitError:
        pass
    shown = " ".join(filter(None, [data.text(name), f"[{label}]" if label else ""]))
    known = ", ".join(offered("Hz", "rad/s"))
    raise ZSpringError(f"abscissa of type {kind}, {shown or 'no label'}: must be a frequency (type 18) in {known}")


def _amplitude(data: DataSet, factors: DataSet | None, given: float | None) -> tuple[float, str]:
    """Peak of the imposed motion and its unit: from the Z axis, or `given` in m/s2 where that tells none."""
    value, kind, label = data["z_axis_value"] or 0.0, data["z_axis_spec_data_type"], data.text("z_axis_axis_units_lab")
    problem = "no amplitude: neither as Z-axis value nor in the settings"
    if value:
        try:
            if kind in MOTIONS and not label and factors:
                return _positive(value * _factor(data, "z_axis", kind, factors)), MOTIONS[kind]
            wanted = [MOTIONS[kind]] if kind in MOTIONS else AMPLITUDES if kind in UNKNOWN else []
            conversion(label, *wanted)
            return _positive(value), label
        except UnitError:
            shown = f"[{label}]" if label else "without a unit"
            problem = f"Z axis of type {kind}, {value:g} {shown}: must be a peak in {', '.join(offered(*AMPLITUDES))}"
    if given is None:
        raise ZSpringError(f"{problem}; an amplitude in the settings goes instead" if value else problem)
    return given, "m/s2"


def _positive(value: float) -> float:
    if not 0 < value < np.inf:
        raise ZSpringError(f"no amplitude: the Z-axis value is {value:g}, must be positive")
    return value


def _factor(data: DataSet, axis: str, kind: int, factors: DataSet | None) -> float:
    """From the unit of an axis to SI: by its label, else by data set 164."""
    label = data.text(f"{axis}_axis_units_lab")
    unit = "N" if kind in FORCES else MOTIONS[kind]
    if not label and factors is not None:
        return 1 / float(factors["force" if kind in FORCES else "length"])
    try:
        return conversion(label, unit)[1]
    except UnitError:
        known = ", ".join(offered(unit))
        raise ZSpringError(f"unit {label!r}: must be one of {known}, or come from a data set 164") from None
