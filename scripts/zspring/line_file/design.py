"""From a line file to the catenary's table: what its set leaves to say, exceptions by span and support, places."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line_table import (
    CONTACT,
    DROPPER,
    MESSENGER,
    NEVER_PULLS,
    ON_MESSENGER,
    ON_STITCH,
    POINT_MASS,
    STITCH,
    SUPPORT,
    LineTable,
)
from ..parameter_sets import LINES, chosen_set
from ..settings import settings_of
from ..variables import Value
from .measured import as_installed, irregularity, put_measured
from .schema import MOST_SPANS, LineFile, SpanException
from .values import Values, by_table, chosen_at, needed, over

LEAST_DISTANCE = 1e-3  # m, of droppers from each other and from the ends of their span


@dataclass(frozen=True)
class Line:
    """A line as its file describes it.

    parameters      of the catenary that the table does not replace: wires, damping and what else the set holds
    first_droppers  place in the table's droppers of the first one of each span, and at last their number. (n + 1,)
    """

    path: Path
    file: LineFile
    table: LineTable
    parameters: Mapping[str, Value]
    first_droppers: Sequence[int]

    @property
    def title(self) -> str:
        """The name, which says that the line is synthetic."""
        return self.file.name + " (synthetic)" * (self.file.synthetic and "synthetic" not in self.file.name.lower())


def read_line(path: Path, catenary: Fmu) -> Line:
    """The line of a TOML file. Raises ZSpringError, one line with the file and the key or the span, for a bad one."""
    with settings_of(path, LineFile, brackets=True) as file:
        of_set = chosen_set(file.parameters, catenary, LINES) if file.parameters else {}
        return _Design(file, of_set).line(path, catenary)


class _Design:
    """A line file and the values by table that it leaves to its set."""

    def __init__(self, file: LineFile, of_set: Mapping[str, Value]):
        self.file, self.others = file, dict[str, Value]()
        base = by_table(of_set, self.others)
        self.given = {name: over(base.get(name, {}), part) for name, part in file.parts().items()}
        self.count = file.spans or int(of_set.get("line.spans", 0))
        if not self.count:
            raise ZSpringError(f"spans is missing: their number, up to {MOST_SPANS}")
        self.spans = [self._with(number, file.span_exceptions) for number in range(1, self.count + 1)]
        lengths = [needed(span, f"span {i}", "length") for i, span in enumerate(self.spans, 1)]
        rises = [length * span.get("gradient", 0.0) for length, span in zip(lengths, self.spans)]
        # As correctly rounded as multiples of one length are.
        self.boundaries = [math.fsum(lengths[:i]) for i in range(self.count + 1)]
        self.heights = [math.fsum(rises[:i]) for i in range(self.count + 1)]

    def _with(self, number: int, exceptions: Iterable[SpanException]) -> Values:
        """The values of a span."""
        values = dict(self.given["span"], dropper=self.given["dropper"])
        for exception in chosen_at(
            number, 1, self.count, ((e.spans, e) for e in exceptions), "span_exception", "spans"
        ):
            values = over(values, exception)
            if exception.dropper:
                values["dropper"] = over(self.given["dropper"], exception.dropper)
        return values

    def line(self, path: Path, catenary: Fmu) -> Line:
        supports, stitches = self._supports()
        each = [self._droppers(number) for number in range(1, self.count + 1)]
        first = np.cumsum([0, *map(len, each)]).tolist()
        droppers = np.concatenate(each)
        for stitch in stitches:
            droppers["upper"][(droppers["x"] > stitch["begin"]) & (droppers["x"] < stitch["end"])] = ON_STITCH
        measured, parameters = self.file.measured, self._parameters()
        put = put_measured(measured, droppers, first) if measured else None
        table = LineTable(
            supports=supports,
            ends=(self.heights[0], self.heights[-1]),
            droppers=droppers,
            stitches=stitches,
            masses=self._masses(),
            profile=irregularity(self.file.irregularity, self.boundaries[-1]),
        )
        if measured and put is not None and droppers["length"][put].any() and measured.lengths == "installed":
            table = as_installed(table, parameters, catenary, put, first)
        return Line(path, self.file, table, parameters, first)

    def _parameters(self) -> dict[str, Value]:
        wire = "mass", "tension", "EI"
        names = {"contact_wire": wire, "messenger": wire, "damping": ("mass", "stiffness")}
        found = dict(self.others)
        for group, keys in names.items():
            times = self.file.contact_wires if group == "contact_wire" else 1
            for key in keys:
                found[f"{group}.{key}"] = times * needed(self.given[group], f"[{group}]", key)
        return found

    def _supports(self) -> tuple[np.ndarray, np.ndarray]:
        supports, stitches = np.zeros(self.count + 1, SUPPORT), []
        exceptions = [(exception.after_spans, exception) for exception in self.file.support_exceptions]
        for i, support in enumerate(supports):
            values: Values = dict(self.given["support"])
            arm, stitch = self.given["steady_arm"], self.file.stitch.given if self.file.stitch else None
            for other in chosen_at(i, 0, self.count, exceptions, "support_exception", "after_spans"):
                anchored = i in (0, self.count) and set(other.given) - {"after_spans", "encumbrance"}
                if anchored:
                    raise ZSpringError(f"after span {i}: {', '.join(anchored)}: an anchor has an encumbrance alone")
                values = over(values, other)
                arm = over(arm, other.steady_arm) if other.steady_arm else arm
                if other.stitch is not None:
                    stitch = over(stitch or {}, other.stitch) if other.stitch else None
            where = f"support after span {i}"
            support["x"] = self.boundaries[i]
            support["messenger"] = self.heights[i] + needed(values, where, "encumbrance")
            if i in (0, self.count):
                continue
            support["stiffness"] = needed(values, where, "stiffness")
            support["arm_mass"], support["arm_stiffness"] = arm.get("mass", 0.0), _arm_stiffness(arm)
            if stitch is not None:
                half = needed(stitch, f"stitch wire after span {i}", "length") / 2
                others = (needed(stitch, f"stitch wire after span {i}", key) for key in ("tension", "mass"))
                stitches.append((support["x"] - half, support["x"] + half, *others, stitch.get("clamp", 0.0)))
        return supports, np.array(stitches, STITCH)

    def _droppers(self, number: int) -> np.ndarray:
        """Those of a span."""
        values, where = self.spans[number - 1], f"span {number}"
        begin, end = self.boundaries[number - 1 : number + 1]
        places = needed(values, where, "droppers")
        droppers, length, last = np.zeros(len(places), DROPPER), values["length"], 0.0
        for i, place in enumerate(places, 1):
            if not last + LEAST_DISTANCE <= place <= length - LEAST_DISTANCE:
                raise ZSpringError(
                    f"span {number}, dropper {i}: at {place:g} m: must be after the dropper before it, and within the "
                    f"span of {length:g} m"
                )
            last = place

        def each(key: str, source: Values, default: float = 0.0) -> np.ndarray:
            value = source.get(key, default)
            if isinstance(value, list) and len(value) != len(places):
                raise ZSpringError(f"{where}: {key}: {len(value)} values for {len(places)} droppers")
            return np.asarray(value, float)

        base, rise = self.heights[number - 1], self.heights[number] - self.heights[number - 1]
        droppers["x"] = begin + np.array(places, float)
        droppers["upper"] = ON_MESSENGER
        droppers["height"] = base + rise * (droppers["x"] - begin) / (end - begin) - each("sag", values)
        made = values["dropper"]
        if len(places) and not made.keys() & {"stiffness", "EA"}:
            raise ZSpringError(f"{where}: [dropper] stiffness or EA is missing")
        for key, column in {**{key: key for key in ("stiffness", "EA", "mass", "clamp_contact")}, **_UPPER}.items():
            droppers[column] = each(key, made)
        for i, (stiffness, EA) in enumerate(zip(droppers["stiffness"], droppers["EA"]), 1):
            if not (stiffness > 0 or EA > 0):
                raise ZSpringError(f"span {number}, dropper {i}: stiffness or EA = 0: must be above 0")
        droppers["length"] = each("dropper_length", values)
        if "dropper_length" in values and not np.all(droppers["length"] > 0):
            raise ZSpringError(f"{where}: dropper_length = 0: must be above 0")
        droppers["length_error"] = each("length_error", values)
        for dropper in values.get("missing", []):
            if not 1 <= dropper <= len(places):
                raise ZSpringError(f"{where}: missing = {dropper}: must be in 1 .. {len(places)}")
            droppers["length_error"][dropper - 1] = NEVER_PULLS
        return droppers

    def _masses(self) -> np.ndarray:
        masses = []
        for mass in self.file.point_masses:
            if mass.span > self.count:
                raise ZSpringError(f"[[point_mass]] span = {mass.span}: must be in 1 .. {self.count}")
            length = self.spans[mass.span - 1]["length"]
            if mass.at > length:
                raise ZSpringError(f"span {mass.span}: [[point_mass]] at = {mass.at:g} m: must be within {length:g} m")
            wire = CONTACT if mass.wire == "contact_wire" else MESSENGER
            masses.append((self.boundaries[mass.span - 1] + mass.at, wire, mass.mass))
        return np.array(sorted(masses), POINT_MASS)


_UPPER = {"clamp_messenger": "clamp_upper"}


def _arm_stiffness(arm: Mapping[str, Any]) -> float:
    """N/m. An arm under a radial load is a taut string: it turns about its far end, load / length (docs/lines.md)."""
    return arm["radial_load"] / arm["length"] if "length" in arm else arm.get("stiffness", 0.0)
