"""A study as its TOML file describes it.

design = "sobol"            # grid, list, latin-hypercube or sobol
samples = 64                # latin-hypercube: cases; sobol: N, a power of 2, for N (D + 2) cases
seed = 1                    # of latin-hypercube and sobol
[vary]                      # parameters of the FMU, in its units
zspring.Mf = { from = 0.2, to = 0.4, scale = "log" }    # a range; grid needs its count, too
friction = ["Coulomb", "Regularized"]                   # values, for grid (all combinations) and
                                                        # list (the first of each, the second of each, ...)
[set]                       # parameters that all cases have in common
zspring.tau = 500
[frf]                       # either or both of what to compute, see quantities.py
amplitudes = [1, 4]
[static]
amplitudes = [0.02]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
from fmpy.model_description import ScalarVariable

from ..bench.measure import BENCH_PARAMETERS, LOOK_PERIODS, FrfSettings
from ..errors import ZSpringError
from ..options import Numbers
from ..toml_tables import Table, flatten, is_number, read_toml
from ..variables import Value, Variables, parse, text
from .evaluations import FrfQuantity, Quantity, StaticQuantity

DESIGNS = ("grid", "list", "latin-hypercube", "sobol")
SAMPLED = DESIGNS[2:]
SCALES = ("linear", "log")
RANGE_KEYS = ("from", "to", "count", "scale")


@dataclass(frozen=True)
class Range:
    """Values from `low` to `high`, evenly spread on a linear or logarithmic scale."""

    low: float
    high: float
    scale: str = "linear"

    def at(self, position: Any) -> Any:
        """The value at a position between 0 and 1; numbers or arrays."""
        if self.scale == "log":
            return self.low * (self.high / self.low) ** position
        return self.low + (self.high - self.low) * position


@dataclass(frozen=True)
class StudySettings:
    """What to vary and what to compute; everything here changes the numbers."""

    design: str
    samples: int  # 0 for grid and list
    seed: int
    vary: Mapping[str, Range | tuple[Value, ...]]  # by parameter: Range for sampled designs, else values
    common: Mapping[str, Value]  # parameters that all cases have in common
    quantities: tuple[Quantity, ...]

    def described(self, variables: Variables) -> dict[str, str]:
        """Everything above as text, by key."""
        head = {"design": self.design}
        if self.design in SAMPLED:
            head |= {"samples": str(self.samples), "seed": str(self.seed)}
        for name, values in self.vary.items():
            head[f"vary {name}"] = (
                f"{values.low!r} to {values.high!r}, {values.scale}"
                if isinstance(values, Range)
                else " ".join(text(variables[name], value) for value in values)
            )
        for quantity in self.quantities:
            head |= quantity.described()
        return head


def read_study(path: Path, variables: Variables) -> StudySettings:
    """The study of a TOML file. Raises ZSpringError with the file and the key, or the line of bad syntax."""
    _, table = read_toml(path)
    try:
        return _study(table, variables)
    except ZSpringError as error:
        raise ZSpringError(f"{path}: {error}") from None


def _study(table: Table, variables: Variables) -> StudySettings:
    design = table.choice("design", DESIGNS, None)
    samples, seed = 0, 0
    if design in SAMPLED:
        samples, seed = table.integer("samples", ..., 1), table.integer("seed", 1, 0)
        if design == "sobol" and (samples < 2 or samples & (samples - 1)):
            raise ZSpringError(f"samples = {samples}: design sobol needs a power of 2, such as 64")
    elif "samples" in table.content or "seed" in table.content:
        raise ZSpringError(f"samples and seed: only for {' and '.join(SAMPLED)}, not for {design}")

    given = {key: flatten(table.table(key), _is_range) for key in ("vary", "set")}
    common = {name: _value(variables, name, value, "set") for name, value in given["set"].items()}
    vary = {name: _varied(variables, name, value, design) for name, value in given["vary"].items()}
    if not vary:
        raise ZSpringError("[vary]: must name at least one parameter")
    for name in vary:
        if name in common:
            raise ZSpringError(f"{name}: must be in [vary] or in [set], not in both")
    lengths = {name: len(values) for name, values in vary.items() if not isinstance(values, Range)}
    if design == "list" and len(set(lengths.values())) > 1:
        found = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ZSpringError(f"[vary]: design list needs as many values of each parameter: {found}")

    quantities: list[Quantity] = []
    for key, read in (("frf", _frf), ("static", _static)):
        if key in table.content:
            quantities.append(read(Table(table.table(key), f"[{key}]")))
    table.finish()
    if not quantities:
        raise ZSpringError("nothing to compute: needs [frf] or [static]")
    return StudySettings(design, samples, seed, vary, common, tuple(quantities))


def _is_range(item: Mapping[str, Any]) -> bool:
    """Whether a table is a range, and not what TOML makes of the first part of zspring.k."""
    return any(key in item for key in RANGE_KEYS)


def _varied(variables: Variables, name: str, value: Any, design: str) -> Range | tuple[Value, ...]:
    """A parameter of [vary]: a range where the design samples it, otherwise values."""
    where, is_real = f"[vary] {name}", _parameter(variables, name, "vary").type == "Real"
    if isinstance(value, list) and design not in SAMPLED:
        values = tuple(_value(variables, name, item, "vary") for item in value)
        if not values or (design == "grid" and len(set(values)) < len(values)):
            raise ZSpringError(f"{where} = {value!r}: needs {'different ' if values else ''}values")
        return values
    if not isinstance(value, dict) or not is_real:
        ranges = ["a range { from = ..., to = ... }"] if is_real else []
        lists = [] if design in SAMPLED else ["a list of values"]
        needed = " or ".join([*ranges, *lists]) or "design grid or list, as it is no real number"
        raise ZSpringError(f"{where} = {value!r}: needs {needed}")
    table = Table(value, where)
    low, high = table.number("from"), table.number("to")
    scale = table.choice("scale", SCALES, "linear")
    count = None if design in SAMPLED else table.integer("count", None, 2)
    table.finish()
    for end in (low, high):
        _value(variables, name, end, "vary")
    if not low < high:
        raise ZSpringError(f"{where}: from = {low:g} must be below to = {high:g}")
    if scale == "log" and low <= 0:
        raise ZSpringError(f"{where}: from = {low:g} must be above 0 for scale log")
    span = Range(low, high, scale)
    if design in SAMPLED:
        return span
    if count is None:
        raise ZSpringError(f"{where}: count is missing")
    return tuple(span.at(i / (count - 1)) for i in range(count))


def _frf(table: Table) -> FrfQuantity:
    standard = FrfSettings()
    settings = FrfSettings(
        amplitudes=_numbers(table, "frf", "amplitudes", standard.amplitudes),
        frequencies=_numbers(table, "frf", "frequencies", standard.frequencies),
        direction=table.choice("direction", ("up", "down", "rest"), standard.direction),
        tolerance=table.number("tolerance", standard.tolerance, above=0),
        min_periods=table.integer("min_periods", standard.min_periods, 1),
        max_periods=table.integer("max_periods", standard.max_periods, 2 * LOOK_PERIODS),
        stroke=table.number("stroke", standard.stroke, above=0),
    )
    band = table.band("resonance_band")
    table.finish()
    if settings.max_periods < settings.min_periods:
        raise ZSpringError(f"[frf] max_periods = {settings.max_periods}: must be {settings.min_periods} or more")
    quantity = FrfQuantity(settings, band)
    if not quantity.points:
        raise ZSpringError(f"[frf]: all points need more stroke than {settings.stroke:g} m")
    return quantity


def _static(table: Table) -> StaticQuantity:
    quantity = StaticQuantity(
        _numbers(table, "static", "amplitudes"), table.number("rate", StaticQuantity.rate, above=0)
    )
    table.finish()
    return quantity


def _parameter(variables: Variables, name: str, where: str) -> ScalarVariable:
    try:
        variable = variables.parameter(name)
    except ZSpringError as error:
        raise ZSpringError(f"[{where}]: {error}") from None
    if name in BENCH_PARAMETERS:
        raise ZSpringError(f"[{where}] {name}: the study itself sets {', '.join(BENCH_PARAMETERS)}")
    return variable


def _value(variables: Variables, name: str, value: Any, where: str) -> Value:
    """A value of a parameter of the FMU, within the bounds of the model description."""
    variable = _parameter(variables, name, where)
    try:
        number = parse(variable, str(value))
    except ZSpringError as error:
        raise ZSpringError(f"[{where}] {error}") from None
    if variable.type in ("Real", "Integer"):
        shown = f"[{where}] {name} = {value} {variable.unit or ''}".rstrip()
        if not math.isfinite(number):
            raise ZSpringError(f"{shown}: must be finite")
        if variable.min is not None and number < float(variable.min):
            raise ZSpringError(f"{shown}: must be at least {variable.min}")
        if variable.max is not None and number > float(variable.max):
            raise ZSpringError(f"{shown}: must be at most {variable.max}")
    return number


def _numbers(table: Table, where: str, key: str, default: tuple[float, ...] | None = None) -> tuple[float, ...]:
    """Positive numbers, ascending: a list, or a text as on the command line."""
    value = table.content.get(key, default)
    if isinstance(value, (list, tuple)):
        numbers = table.list(key) or value
        if not numbers or not all(is_number(number) and number > 0 for number in numbers):
            raise ZSpringError(f"[{where}] {key} = {value!r}: must be positive numbers")
        return tuple(sorted({float(number) for number in numbers}))
    try:
        return Numbers().convert(table.text(key), None, None)
    except click.BadParameter as error:
        raise ZSpringError(f"[{where}] {key}: {error.message}") from None
