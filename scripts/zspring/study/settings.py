"""A study as its TOML file describes it; resources/examples/study.toml explains one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import click
from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, Strict, model_validator

from ..bench.measure import BENCH_PARAMETERS
from ..bench.points import FrfSettings
from ..bench.steady import LOOK_PERIODS
from ..draws import read_draws
from ..errors import ZSpringError
from ..fmu import Fmu
from ..options import Numbers
from ..parameter_sets import ACCURATE_STEP, PANTOGRAPHS, chosen_set
from ..settings import (
    ALL_FREQUENCIES,
    Band,
    BesidePath,
    Positive,
    Table,
    by_full_name,
    fitting,
    named,
    set_name,
    settings_of,
)
from ..variables import Value, Variables, text
from .evaluations import FrfQuantity, Quantity, StaticQuantity

SAMPLED = ("latin-hypercube", "sobol")
MOST_CASES = 1_000_000


class Range(Table):
    """Values from `low` to `high`, evenly spread on a linear or logarithmic scale."""

    low: float = Field(alias="from")
    high: float = Field(alias="to")
    scale: Literal["linear", "log"] = "linear"
    count: int | None = Field(None, ge=2, le=MOST_CASES, description="of values, in grid and list")

    @model_validator(mode="after")
    def _in_order(self) -> Range:
        if not self.low < self.high:
            raise ValueError(f"from = {self.low:g} must be below to = {self.high:g}")
        if self.scale == "log" and self.low <= 0:
            raise ValueError(f"from = {self.low:g} must be above 0 for scale log")
        return self

    def at(self, position: Any) -> Any:
        """The value at a position between 0 and 1; numbers or arrays."""
        if self.scale == "log":
            return self.low * (self.high / self.low) ** position
        return self.low + (self.high - self.low) * position


def _range_or_values(content: Any) -> Range | list:
    if isinstance(content, Mapping):
        return Range.model_validate(content)
    if not isinstance(content, list) or not content:
        raise ValueError("needs a range { from = ..., to = ... } or a list of values")
    return content


def _from_text(numbers: Any) -> Any:
    """A text as on the command line as numbers."""
    try:
        return list(Numbers().convert(numbers, None, None)) if isinstance(numbers, str) else numbers
    except click.BadParameter as error:
        raise ValueError(error.message) from None


RangeOrValues = Annotated[Range | list, PlainValidator(_range_or_values)]
Ascending = Annotated[
    tuple[Positive, ...],
    Strict(False),
    Field(min_length=1),
    AfterValidator(lambda numbers: tuple(sorted(set(numbers)))),
    fitting("must be positive numbers"),
    BeforeValidator(_from_text),
]


class _Frf(Table):
    """What FrfSettings explains, and where the highest resonance is looked for."""

    amplitudes: Ascending = Field(FrfSettings.amplitudes, description="m/s2")
    frequencies: Ascending = Field(FrfSettings.frequencies, description="Hz")
    direction: Literal["up", "down", "rest"] = "up"
    tolerance: Positive = FrfSettings.tolerance
    min_periods: int = Field(FrfSettings.min_periods, ge=1)
    max_periods: int = Field(FrfSettings.max_periods, ge=2 * LOOK_PERIODS)
    stroke: Positive = Field(FrfSettings.stroke, description="m")
    resonance_band: Band = ALL_FREQUENCIES

    @property
    def quantity(self) -> FrfQuantity:
        return FrfQuantity(FrfSettings(**self.model_dump(exclude={"resonance_band"})), self.resonance_band)

    @model_validator(mode="after")
    def _has_points(self) -> _Frf:
        if self.max_periods < self.min_periods:
            raise ValueError(f"max_periods = {self.max_periods}: must be {self.min_periods} or more")
        if not self.quantity.points:
            raise ValueError(f"all points need more stroke than {self.stroke:g} m")
        return self


class _Static(Table):
    """What StaticQuantity explains."""

    amplitudes: Ascending = Field(description="m")
    rate: Positive = Field(StaticQuantity.rate, description="m/s")

    @property
    def quantity(self) -> StaticQuantity:
        return StaticQuantity(self.amplitudes, self.rate)


class _File(Table):
    """The file, as far as it can be checked without the FMU."""

    design: Literal["grid", "list", "latin-hypercube", "sobol"]
    samples: int = Field(0, ge=1, description="of sampled designs")
    seed: int = Field(1, ge=0, description="of sampled designs")
    parameter_set: Annotated[str, set_name(PANTOGRAPHS)] = Field("", alias="parameters")
    draws: BesidePath | None = Field(None, description="of `zspring identify`, instead of [vary]")
    vary: Annotated[dict[str, RangeOrValues], by_full_name(Range)] = Field({})
    common: Annotated[dict[str, Any], by_full_name()] = Field({}, alias="set")
    frf: _Frf | None = None
    static: _Static | None = None

    @model_validator(mode="after")
    def _fits_together(self) -> _File:
        is_power_of_2 = self.samples > 1 and not self.samples & (self.samples - 1)
        if self.design not in SAMPLED and {"samples", "seed"} & self.model_fields_set:
            raise ValueError(f"samples and seed: only for {' and '.join(SAMPLED)}, not for {self.design}")
        if self.design in SAMPLED and not self.samples:
            raise ValueError("samples is missing")
        if self.design == "sobol" and not is_power_of_2:
            raise ValueError(f"samples = {self.samples}: design sobol needs a power of 2, such as 64")
        if self.draws and self.design != "list":
            raise ValueError("draws: needs design list")
        if self.draws and self.vary:
            raise ValueError("draws: must be given without [vary]")
        if not self.draws and not self.vary:
            raise ValueError("[vary]: needs at least one")
        for name in self.vary:
            if name in self.common:
                raise ValueError(f"{name}: must be in [vary] or in [set], not in both")
        if self.frf is None and self.static is None:
            raise ValueError("nothing to compute: needs [frf] or [static]")
        return self


@dataclass(frozen=True)
class StudySettings:
    """What to vary and what to compute; everything here changes the numbers."""

    design: str
    samples: int  # 0 for grid and list
    seed: int  # of sampled designs
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


def read_study(path: Path, fmu: Fmu) -> StudySettings:
    """The study of a TOML file. Raises ZSpringError with the file and the key, or the line of bad syntax."""
    variables = fmu.variables
    with settings_of(path, _File, brackets=True) as file:
        with named("[set] "):
            common = {name: _value(variables, name, value) for name, value in file.common.items()}
        with named("[vary] "):
            given = file.vary
            if file.draws:
                given = _by_parameter(read_draws(file.draws, fmu, (*BENCH_PARAMETERS, *common)))
            vary = {name: _varied(variables, name, value, file.design) for name, value in given.items()}
        if file.parameter_set:
            common = {**chosen_set(file.parameter_set, fmu, but_not=(*BENCH_PARAMETERS, *vary)), **common}
        if "solver.step" not in vary:
            common = {"solver.step": ACCURATE_STEP, **common}
        lengths = {name: len(values) for name, values in vary.items() if not isinstance(values, Range)}
        if file.design == "list" and len(set(lengths.values())) > 1:
            found = ", ".join(f"{name} has {length}" for name, length in lengths.items())
            raise ZSpringError(f"[vary]: design list needs as many values of each parameter: {found}")
        quantities = tuple(table.quantity for table in (file.frf, file.static) if table)
        return StudySettings(file.design, file.samples, file.seed, vary, common, quantities)


def _by_parameter(draws: Sequence[Mapping[str, Value]]) -> dict[str, Range | list]:
    """Values of each parameter, one for each draw."""
    return {name: [draw[name] for draw in draws] for name in draws[0]}


def _varied(variables: Variables, name: str, given: Range | list, design: str) -> Range | tuple[Value, ...]:
    """A parameter of [vary]: a range where the design samples it, otherwise values."""
    is_sampled, is_real = design in SAMPLED, variables.settable(name).type == "Real"
    if isinstance(given, list):
        if is_sampled:
            needed = "a range { from = ..., to = ... }" if is_real else "design grid or list, as it is no real number"
            raise ZSpringError(f"{name} = {given!r}: needs {needed}")
        values = tuple(_value(variables, name, item) for item in given)
        if design == "grid" and len(set(values)) < len(values):
            raise ZSpringError(f"{name} = {given!r}: needs different values")
        return values
    if not is_real:
        raise ZSpringError(f"{name}: needs a list of values, as it is no real number")
    for end in (given.low, given.high):
        _value(variables, name, end)
    if is_sampled and given.count:
        raise ZSpringError(f"{name}.count: only for grid and list, not for {design}")
    if is_sampled:
        return given
    if not given.count:
        raise ZSpringError(f"{name}.count is missing")
    return tuple(given.at(i / (given.count - 1)) for i in range(given.count))


def _value(variables: Variables, name: str, given: Any) -> Value:
    """A value of a parameter of the FMU, within the bounds of the model description."""
    value = variables.parse_assignments([f"{name}={given}"], but_not=BENCH_PARAMETERS)[name]
    variable = variables[name]
    if variable.type in ("Real", "Integer"):
        shown = f"{name} = {given} {variable.unit or ''}".rstrip()
        if not math.isfinite(value):
            raise ZSpringError(f"{shown}: must be finite")
        if variable.min is not None and value < float(variable.min):
            raise ZSpringError(f"{shown}: must be at least {variable.min}")
        if variable.max is not None and value > float(variable.max):
            raise ZSpringError(f"{shown}: must be at most {variable.max}")
    return value
