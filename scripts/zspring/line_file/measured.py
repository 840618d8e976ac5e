"""What was measured on a line, from tables in text files: heights, lengths of droppers, irregularity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line_table import PROFILE, LineTable
from ..tables import read_table
from ..variables import Value
from .schema import Irregularity, Measured
from .statics import at_rest

LEVEL = 1e-6  # m, that is no height
SAME_LENGTH = 1e-6  # m
MOST_ROUNDS = 50


def put_measured(measured: Measured, droppers: np.ndarray, first: Sequence[int]) -> np.ndarray:
    """Heights and lengths of a table with the columns span, dropper, height, length into (n,) DROPPER; which they are.

    first   place of the first dropper of each span, and at last their number. (spans + 1,)
    An empty cell leaves what the design says. Raises ZSpringError for droppers that are not there or come twice, and
    for what the line file must say of the table.
    """
    path = measured.file
    table = read_table(path)
    spans, numbers = table.numbers("span"), table.numbers("dropper")
    both = {"heights": "height", "lengths": "length"}
    has = [name for name, column in both.items() if column in table]
    if not has:
        raise ZSpringError(f"{path}: no column 'height' and no column 'length'")
    if len(has) == 2 and measured.use is None:
        raise ZSpringError(
            f'{path}: has heights and lengths, of which one makes the other: [measured] use = "heights", say'
        )
    use = measured.use or has[0]
    if use not in has:
        raise ZSpringError(f'{path}: no column {both[use]!r}: [measured] use = "{use}"')
    if use == "heights" and measured.datum is None:
        raise ZSpringError(
            "[measured] datum is missing: the contact wire's height at the line's begin, as the file counts"
        )
    if use == "lengths" and measured.lengths is None:
        raise ZSpringError('[measured] lengths is missing: "unstretched", or "installed" if under load')
    if use == "heights" and (np.any(droppers["length"] > 0) or np.any(droppers["length_error"] != 0)):
        raise ZSpringError(
            "[measured] heights are those of the contact wire at rest, which dropper_length, length_error and missing "
            "would change: leave these out"
        )
    values = table.numbers(both[use], "m", gaps=True)
    seen, put = set(), np.zeros(len(droppers), bool)
    for line, span, number, value in zip(table.lines, spans, numbers, values):
        if not (span == int(span) and 1 <= span < len(first)):
            raise ZSpringError(f"{path}, line {line}: span = {span:g}: must be in 1 .. {len(first) - 1}")
        begin, end = first[int(span) - 1 : int(span) + 1]
        if not (number == int(number) and 1 <= number <= end - begin):
            raise ZSpringError(f"{path}, line {line}: dropper = {number:g}: must be in 1 .. {end - begin}")
        if (span, number) in seen:
            raise ZSpringError(f"{path}, line {line}: span {span:g}, dropper {number:g} comes twice")
        seen.add((span, number))
        if np.isnan(value):
            continue
        place = begin + int(number) - 1
        dropper, put[place] = droppers[place : place + 1], True
        if use == "heights":
            dropper["height"] = value - float(measured.datum or 0.0)
        elif value > 0:
            dropper["length"] = value
        else:
            raise ZSpringError(f"{path}, line {line}: length = {value:g} m: must be above 0")
    return put


def as_installed(
    table: LineTable, parameters: Mapping[str, Value], catenary: Fmu, measured: np.ndarray, first: Sequence[int]
) -> LineTable:
    """The table with the unstretched lengths with which the droppers, at rest under load, have the measured ones.

    measured    of the droppers, which the FMU at first takes for unstretched; (n,) booleans
    first       as in put_measured
    A dropper is so much stiffer than the wires that what is missing, added to the unstretched length, is nearly there.
    Raises ZSpringError where no lengths do it, as for a dropper that hangs loose.
    """
    wanted, droppers = table.droppers["length"].copy(), table.droppers.copy()
    for _ in range(MOST_ROUNDS):
        line = replace(table, droppers=droppers)
        found = at_rest(catenary.with_line(line), parameters, droppers["x"])
        missing = np.where(measured, wanted - found.dropper_length, 0.0)
        if np.abs(missing).max() < SAME_LENGTH:
            return line
        droppers["length"] += missing
        if np.any(droppers["length"][measured] <= 0):
            break
    worst = int(np.argmax(np.abs(missing)))
    span = int(np.searchsorted(first, worst, "right"))
    raise ZSpringError(
        f"span {span}, dropper {worst - first[span - 1] + 1}: {wanted[worst]:g} m long under load: no dropper between "
        f"these wires is, it would hang loose or break"
    )


def irregularity(given: Irregularity | None, length: float) -> np.ndarray:
    """The profile of a table with the columns position and height, (n,) PROFILE of a line of `length` m.

    Slopes are those of a cubic spline. Raises ZSpringError for places that do not ascend, and for a profile that begins
    or ends within the line at another height than 0, where the wire would have a step.
    """
    if given is None:
        return np.zeros(0, PROFILE)
    from scipy.interpolate import CubicSpline  # slow to load

    path = given.file
    table = read_table(path)
    position, height = table.numbers("position", "m"), table.numbers("height", "m")
    if len(position) < 2:
        raise ZSpringError(f"{path}: {len(position)} rows: must be 2 at least")
    for line, step in zip(table.lines[1:], np.diff(position)):
        if not step > 0:
            raise ZSpringError(f"{path}, line {line}: position: must be above that of the row before")
    inside = position[0] > 0, position[-1] < length
    for is_inside, end, place in zip(inside, (height[0], height[-1]), (position[0], position[-1])):
        if is_inside and abs(end) > LEVEL:
            raise ZSpringError(
                f"{path}: height = {end:g} m at {place:g} m, an end within the line: must be 0 there, or the profile "
                f"must reach from 0 to {length:g} m"
            )
    ends = [(1, 0.0) if is_inside else (2, 0.0) for is_inside in inside]
    profile = np.zeros(len(position), PROFILE)
    profile["x"], profile["height"] = position, height
    profile["slope"] = CubicSpline(position, height, bc_type=tuple(ends))(position, 1)
    return profile
