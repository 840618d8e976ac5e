"""What to identify and from what: a TOML file, explained by resources/examples/identify.toml."""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, Strict, model_validator

from ..bench.conditions import Conditions, read_conditions
from ..bench.curves import Source
from ..bench.measure import BENCH_PARAMETERS
from ..bench.responses import HARMONICS, QUANTITIES
from ..errors import ZSpringError
from ..fmu import Fmu
from ..parameter_sets import ACCURATE_STEP, PANTOGRAPHS, chosen_set
from ..settings import ALL_FREQUENCIES, Band, BesidePath, Positive, Table, by_full_name, fitting, set_name, settings_of
from ..variables import Value, Variables, parse

LINEAR_PARAMETERS = ("m1", "m2", "m3", "c1", "c2", "c3", "k1", "k2", "k3")
UNKNOWN = (  # what only the bench knows: how to say it, and what it is worth
    (
        "static_force",
        ("110 N", "110"),
        "Taken as 120 N where it was 110 N it makes the stiffness found 4 % low, where it was 70 N 23 %",
    ),
    (
        "friction",
        ("Coulomb", '"Coulomb"'),
        "Where the rods stick and creep, and so Mf, depends on it: Coulomb or Regularized",
    ),
)
LOG_RANGE = 10.0  # a parameter whose bounds are positive and further apart is searched on a logarithmic scale


class Free(Table):
    """Start value and bounds of a parameter to identify, in the FMU's unit.

    The optimiser sees the parameter as x from 0 (minimum) to 1 (maximum).
    """

    start: float
    minimum: float = Field(alias="min")
    maximum: float = Field(alias="max")

    @model_validator(mode="after")
    def _in_order(self) -> Free:
        if not self.minimum < self.maximum:
            raise ValueError(f"min = {self.minimum:g} must be below max = {self.maximum:g}")
        if not self.minimum <= self.start <= self.maximum:
            raise ValueError(f"start = {self.start:g} must lie in {self.minimum:g} .. {self.maximum:g}")
        return self

    @property
    def is_logarithmic(self) -> bool:
        return self.minimum > 0 and self.maximum > LOG_RANGE * self.minimum

    def value(self, x: float) -> float:
        """The parameter at x; at 0 and 1 exactly the bounds."""
        if x <= 0 or x >= 1:
            return self.minimum if x <= 0 else self.maximum
        if self.is_logarithmic:
            return self.minimum * (self.maximum / self.minimum) ** x
        return self.minimum + (self.maximum - self.minimum) * x

    def x(self, value: float) -> float:
        """Inverse of `value`."""
        if self.is_logarithmic:
            return math.log(value / self.minimum) / math.log(self.maximum / self.minimum)
        return (value - self.minimum) / (self.maximum - self.minimum)

    def slope(self, x: float) -> float:
        """d value / dx."""
        if self.is_logarithmic:
            return self.value(x) * math.log(self.maximum / self.minimum)
        return self.maximum - self.minimum


class Search(Table):
    """Where least squares begin besides the start values: the best of a Sobol sequence between the bounds."""

    samples: int = Field(default=16, ge=0, le=100_000, description="for each free parameter, at least; 0 for none")
    starts: int = Field(default=2, ge=1, le=1000, description="at most, of the best of these")
    points: int = Field(default=12, ge=1, description="at most for each amplitude")
    seed: int = Field(default=1, ge=0)

    def candidates(self, parameters: int) -> int:
        """How many, a power of 2, at which the sequence is even."""
        return 1 << (self.samples * parameters - 1).bit_length()


class Uncertainty(Table):
    """What is computed of it beside standard errors and correlations, each for many evaluations of the model."""

    profiles: bool = Field(default=False, description="intervals by profile likelihood")
    draws: int = Field(default=0, ge=0, le=100_000, description="from the posterior; 0 for none")
    seed: int = Field(default=1, ge=0)


class Static(Table):
    """A static test and its weight."""

    path: BesidePath = Field(alias="file")
    force: Literal["specimen", "contact"] = "specimen"
    speed: Positive = Field(0.005, description="m/s, where the file has no time")
    weight: Positive = Field(1.0, description="relative to all frequency responses together")


class Tie(Table):
    """To a parameter of which the tied one is `factor` times as much; in the file, its name alone will do."""

    to: str
    factor: float = 1.0

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, content: Any) -> Any:
        return content if isinstance(content, Mapping) else {"to": content}


DataSets = Annotated[
    tuple[Annotated[int, Field(ge=1)], ...], Strict(False), fitting("must be numbers of data sets, from 1")
]


Orders = Annotated[
    tuple[int, ...],
    Strict(False),
    fitting(f"must be orders from {HARMONICS[0]} to {HARMONICS[-1]}", lambda orders: set(orders) <= set(HARMONICS)),
]


class Measurement(Table):
    """A file of measured responses and what it does not tell, see Source."""

    path: BesidePath = Field(alias="file")
    amplitude: Positive | None = Field(None, description="m/s2, peak")
    force: Literal["specimen", "contact"] = "specimen"
    fixture_mass: float = Field(0.0, ge=0, description="kg, of what moves between load cell and head")
    data_sets: DataSets = ()


class Settings(Table):
    """All that defines a fit. Tables of parameters are by their names."""

    model: Literal["linear", "zspring"]
    parameter_set: Annotated[str, set_name(PANTOGRAPHS)] = Field("", alias="parameters")
    band: Band = ALL_FREQUENCIES
    error: Literal["log", "linear"] = "log"
    quantity: Annotated[str, fitting(f"must be one of {', '.join(QUANTITIES)}", lambda q: q in QUANTITIES)] = (
        "receptance"
    )
    weights: Literal["errors", "equal"] | None = Field(None, description="None: errors where all files tell them")
    harmonics: Orders = ()
    direction: Literal["up", "down", "rest", "file"] | None = Field(None, description="None: as the files have it")
    measurement: list[Measurement] = Field([], min_length=1, validate_default=True)
    static: Static | None = None
    free: Annotated[dict[str, Free], by_full_name(Free)] = Field({}, min_length=1, validate_default=True)
    fixed: Annotated[dict[str, Any], by_full_name()] = Field({}, description="once read, all that are given")
    tied: Annotated[dict[str, Tie], by_full_name(Tie)] = Field({})
    compare_models: bool = Field(False, description="with the other friction law, and a linear head")
    search: Search = Search()
    uncertainty: Uncertainty = Uncertainty()

    @model_validator(mode="before")
    @classmethod
    def _defaults_of_the_linear_model(cls, content: dict[str, Any]) -> dict[str, Any]:
        """It costs next to nothing, and has a single amplitude."""
        search = content.get("search", {})
        if content.get("model") != "linear" or not isinstance(search, Mapping):
            return content
        return {"error": "linear", **content, "search": {"samples": 200, "starts": 20, "points": 1000, **search}}

    @model_validator(mode="after")
    def _fit_together(self) -> Settings:
        if self.model == "linear":
            for name in self.free:
                if name not in LINEAR_PARAMETERS:
                    raise ValueError(f"free.{name}: the linear model has only {', '.join(LINEAR_PARAMETERS)}")
            if self.static:
                raise ValueError("static: the linear model has no static test")
            if self.harmonics:
                raise ValueError("harmonics: the linear model has none")
            if self.compare_models:
                raise ValueError("compare_models: needs model zspring, whose amplitudes tell the models apart")
        for one, other in itertools.combinations(self.measurement, 2):
            sets = [set(each.data_sets) for each in (one, other)]
            if one.path.resolve() == other.path.resolve() and not (all(sets) and sets[0].isdisjoint(sets[1])):
                raise ValueError(f"measurement: {other.path.name} is named twice: its points would count twice")
        for name, tie in self.tied.items():
            if name in self.free:
                raise ValueError(f"tied.{name}: is free, too")
            if tie.to in self.tied:
                raise ValueError(f"tied.{name}: {tie.to} is itself tied")
        return self

    @property
    def sources(self) -> list[Source]:
        """The measurements as the bench reads them."""
        return [Source(**dict(measurement)) for measurement in self.measurement]

    def parameters(self, x) -> dict[str, Value]:
        """All given parameters of the FMU at the optimiser's x (n,)."""
        values = {**self.fixed, **{name: free.value(float(at)) for (name, free), at in zip(self.free.items(), x)}}
        return {**values, **{name: tie.factor * values[tie.to] for name, tie in self.tied.items()}}


def read_settings(
    path: Path, fmu: Fmu, parameter_set: str | None = None, assignments: tuple[str, ...] = ()
) -> Settings:
    """Settings of a file; `parameter_set` and `assignments` of the command line go before its own.

    Raises ZSpringError with file and key for anything unknown, missing or out of range.
    """
    with settings_of(path, Settings) as settings:
        for name, free in settings.free.items():
            _check_free(fmu.variables, name, free)
        for name, tie in settings.tied.items():
            for each in (name, tie.to):
                if fmu.variables.settable(each).type != "Real":
                    raise ZSpringError(f"tied.{name}: {each} is no Real parameter")
        conditions = read_conditions([measurement.path for measurement in settings.measurement], fmu)
        for remark in conditions.remarks:
            print(remark, file=sys.stderr)
        fixed = _fixed(settings, fmu, parameter_set, assignments, conditions)
        return settings.model_copy(update={"fixed": fixed, "direction": conditions.swept(settings.direction)})


def _check_free(variables: Variables, name: str, free: Free) -> None:
    """Raises ZSpringError if it is no parameter to identify, or if its bounds are not those of the FMU or within."""
    variable = variables.settable(name)
    if variable.type != "Real" or name in BENCH_PARAMETERS:
        raise ZSpringError(f"free.{name}: must be a Real parameter of the pantograph")
    if variable.min is not None and free.minimum < float(variable.min):
        raise ZSpringError(f"free.{name}: min = {free.minimum:g}: the FMU allows min {variable.min}")
    if variable.max is not None and free.maximum > float(variable.max):
        raise ZSpringError(f"free.{name}: max = {free.maximum:g}: the FMU allows max {variable.max}")


def _fixed(
    settings: Settings, fmu: Fmu, parameter_set: str | None, assignments: tuple[str, ...], conditions: Conditions
) -> dict[str, Value]:
    """Parameters given by set, file and command line, the last before the first, what is tied to, and the bench's.

    Static force and friction law are those of the bench, whatever the set has. Raises ZSpringError where nobody
    tells them.
    """
    chosen = parameter_set or settings.parameter_set
    values = chosen_set(chosen, fmu, but_not=BENCH_PARAMETERS) if chosen else {}
    lines = [f"{name}={value}" for name, value in settings.fixed.items()]
    given = fmu.variables.parse_assignments([*lines, *assignments], but_not=BENCH_PARAMETERS)
    for name in given:
        for kind, others in (("free", settings.free), ("tied", settings.tied)):
            if name in others:
                raise ZSpringError(f"{name} is {kind}, so it cannot be fixed, too")
    linear, to_find = settings.model == "linear", {**settings.free, **settings.tied}
    if not linear:  # whose response depends on neither
        given = conditions.agreed(fmu, given)
        for name, example, reason in UNKNOWN:
            if name not in {**given, **to_find}:
                files = ", ".join(measurement.path.name for measurement in settings.measurement)
                raise ZSpringError(
                    f"{name} of the bench is not known: neither does the head of {files} say '# {name}: {example[0]}' "
                    f"nor [fixed] {name} = {example[1]}. {reason}"
                )
    fixed = {
        # At 2 ms HHT's error near 12 Hz would go into the parameters: 1.6 % of zspring.l0.
        **({} if linear else {"solver.step": ACCURATE_STEP}),
        **values,
        **given,
        **fmu.variables.parse_assignments([f"suspension={'Linear' if linear else 'ZSpring'}"]),
    }
    for tie in settings.tied.values():  # may be to a parameter that nobody has set
        fixed.setdefault(tie.to, parse(fmu.variables[tie.to], fmu.variables[tie.to].start))
    # Values of a set for what is free or tied do not count.
    return {name: value for name, value in fixed.items() if name not in to_find}
