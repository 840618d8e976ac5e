"""The tables of a study's TOML file, as far as they can be checked without the FMUs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import click
from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, Strict, create_model, model_validator

from ..bench.points import FrfSettings
from ..bench.steady import LOOK_PERIODS
from ..line.quantities import FIGURES, FREE, is_figure
from ..options import Numbers
from ..parameter_sets import LINES, PANTOGRAPHS
from ..settings import ALL_FREQUENCIES, Band, BesidePath, Positive, Table, by_full_name, fitting, set_name
from .coupled import IRREGULARITY
from .evaluations import FrfQuantity, StaticQuantity
from .factors import IRREGULARITIES, run_keys

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
Spans = Annotated[
    tuple[int, int],
    Strict(False),
    fitting("must be [first, last] span, counted from 1", lambda spans: 1 <= spans[0] <= spans[1]),
]
Wavelengths = Annotated[
    tuple[float, float],
    Strict(False),
    fitting("must be [shortest, longest] wave in m", lambda waves: 0.1 <= waves[0] < waves[1] < 1e6),
]
Figures = Annotated[
    tuple[str, ...],
    Strict(False),
    Field(min_length=1),
    fitting(f"must be some of {', '.join(FIGURES)}, {FREE}", lambda names: all(map(is_figure, names))),
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


class _CoupleOwn(Table):
    """What CoupledQuantity explains, and the line."""

    line: Annotated[str, set_name(LINES)] = ""
    spans: Spans | None = None
    values: Figures = tuple(FIGURES)


# And what can vary as well: here numbers and texts, which the variables of these names check.
_run_keys: Any = dict.fromkeys(run_keys(), (Any, None))
_Couple: Any = create_model("_Couple", __base__=_CoupleOwn, **_run_keys)


class _IrregularityOwn(Table):
    """How many lines, and what their contact wires have in common."""

    lines: int = Field(ge=1)
    seed: int = Field(1, ge=0)
    wavelengths: Wavelengths | None = Field(None, description="m, of a spectrum that falls with the wavenumber ...")
    exponent: float | None = Field(None, description="... to the power of -exponent")
    spectrum: BesidePath | None = None
    profile: BesidePath | None = None

    @model_validator(mode="after")
    def _one_source(self) -> _IrregularityOwn:
        given = [key for key in ("wavelengths", "spectrum", "profile") if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)}: give one of them")
        if (self.wavelengths is None) != (self.exponent is None):
            raise ValueError("wavelengths and exponent: both make a spectrum, one alone does not")
        return self


_irregularity_keys: Any = dict.fromkeys(IRREGULARITIES, (Any, None))
_Irregularity: Any = create_model("_Irregularity", __base__=_IrregularityOwn, **_irregularity_keys)


class StudyFile(Table):
    """The file."""

    design: Literal["grid", "list", "latin-hypercube", "sobol"]
    samples: int = Field(0, ge=1, description="of sampled designs")
    seed: int = Field(1, ge=0, description="of sampled designs")
    title: str = Field("", description="of the figures")
    parameter_set: Annotated[str, set_name(PANTOGRAPHS)] = Field("", alias="parameters")
    draws: BesidePath | None = Field(None, description="of `zspring identify`, instead of [vary]")
    vary: Annotated[dict[str, RangeOrValues], by_full_name(Range)] = Field({})
    common: Annotated[dict[str, Any], by_full_name()] = Field({}, alias="set")
    frf: _Frf | None = None
    static: _Static | None = None
    couple: _Couple | None = None
    irregularity: _Irregularity | None = None
    compare: dict[str, Annotated[dict[str, Any], by_full_name()]] = Field({})

    @model_validator(mode="after")
    def _fits_together(self) -> StudyFile:
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
        if not (self.draws or self.vary or (self.design == "grid" and (self.compare or self.irregularity))):
            raise ValueError("[vary]: needs at least one")
        for table in ("compare", "irregularity"):
            if getattr(self, table) and not self.couple:
                raise ValueError(f"[{table}]: needs [couple]")
        given = {"[vary]": self.vary, "[set]": self.common, **{f"[compare] {n}:": x for n, x in self.compare.items()}}
        for where, names in given.items():
            for name in names:
                if name.startswith(IRREGULARITY) and not self.irregularity:
                    raise ValueError(f"{where} {name}: needs [irregularity]")
        if self.compare and self.design == "sobol":
            raise ValueError("[compare]: needs another design than sobol")
        for name in self.vary:
            if name in self.common:
                raise ValueError(f"{name}: must be in [vary] or in [set], not in both")
        if self.frf is None and self.static is None and self.couple is None:
            raise ValueError("nothing to compute: needs [frf], [static] or [couple]")
        return self
