"""What to identify and from what: a TOML file, explained by resources/examples/identify.toml."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..bench.measure import BENCH_PARAMETERS
from ..bench.measured import Source
from ..errors import ZSpringError
from ..fmu import Fmu
from ..parameter_sets import find_set, packaged_sets, read_set
from ..toml_tables import Table, flatten, has_table, is_plain, read_toml
from ..variables import Value, parse

LINEAR_PARAMETERS = ("m1", "m2", "m3", "c1", "c2", "c3", "k1", "k2", "k3")
# At the FMU's own step of 2 ms HHT's error near 12 Hz would go into the parameters: 1.6 % of zspring.l0.
ACCURATE_STEP = 5e-4  # s
LOG_RANGE = 10.0  # a parameter whose bounds are positive and further apart is searched on a logarithmic scale


@dataclass(frozen=True)
class Free:
    """A parameter to identify; the optimiser sees it as x from 0 (minimum) to 1 (maximum)."""

    name: str
    start: float
    minimum: float
    maximum: float

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


@dataclass(frozen=True)
class Search:
    """Differential evolution before the least squares."""

    generations: int
    population: int = 10
    points: int = 12
    seed: int = 1


@dataclass(frozen=True)
class Static:
    """A static test and its weight."""

    path: Path
    speed: float = 0.005
    weight: float = 1.0


@dataclass(frozen=True)
class Settings:
    """All that defines a fit."""

    path: Path
    model: str
    sources: tuple[Source, ...]
    free: tuple[Free, ...]
    fixed: Mapping[str, Value]  # all parameters that are given, by name
    tied: Mapping[str, tuple[str, float]]  # (other parameter, factor) by name
    search: Search
    band: tuple[float, float] = (0.0, math.inf)
    error: str = "log"
    quantity: str = "receptance"
    direction: str = "up"
    static: Static | None = None
    text: str = field(default="", repr=False)  # of the file

    def parameters(self, x) -> dict[str, Value]:
        """All given parameters of the FMU at the optimiser's x (n,)."""
        values = {**self.fixed, **{free.name: free.value(float(at)) for free, at in zip(self.free, x)}}
        return {**values, **{name: factor * values[to] for name, (to, factor) in self.tied.items()}}


def read_settings(
    path: Path, fmu: Fmu, parameter_set: str | None = None, assignments: tuple[str, ...] = ()
) -> Settings:
    """Settings of a file; `parameter_set` and `assignments` of the command line go before its own.

    Raises ZSpringError with file and key for anything unknown, missing or out of range.
    """
    text, table = read_toml(path)
    try:
        return _settings(path, text, table, fmu, parameter_set, assignments)
    except ZSpringError as error:
        raise ZSpringError(f"{path}: {error}") from None


def _settings(
    path: Path, text: str, table: Table, fmu: Fmu, parameter_set: str | None, assignments: tuple[str, ...]
) -> Settings:
    model = table.choice("model", ("linear", "zspring"), None)
    linear = model == "linear"
    fixed, given = _fixed(path, table, fmu, parameter_set, assignments, linear)
    free = tuple(
        _free(fmu, name, Table(bounds, f"free.{name}"))
        for name, bounds in flatten(table.table("free"), lambda item: not has_table(item)).items()
    )
    if not free:
        raise ZSpringError("free: needs at least one parameter with start, min and max")
    names = [parameter.name for parameter in free]
    if linear and not set(names) <= set(LINEAR_PARAMETERS):
        other = next(name for name in names if name not in LINEAR_PARAMETERS)
        raise ZSpringError(f"free.{other}: the linear model has only {', '.join(LINEAR_PARAMETERS)}")
    tied = _tied(fmu, table, names)
    for name in given:
        if name in names or name in tied:
            raise ZSpringError(f"{name} is {'free' if name in names else 'tied'}, so it cannot be fixed, too")
    # Values of a set for what is free or tied do not count. A tie may be to a parameter that nobody has set.
    starts = {v.name: parse(v, v.start) for v in fmu.variables if v.name in fmu.variables.names("parameter")}
    for to, _ in tied.values():
        fixed.setdefault(to, starts[to])
    fixed = {name: value for name, value in fixed.items() if name not in (*names, *tied)}

    sources = []
    for number, item in enumerate(table.list("measurement"), 1):
        entry = Table(item, f"measurement {number}")
        sources.append(
            Source(
                path.parent / entry.text("file"),
                entry.number("amplitude", None, above=0),
                entry.choice("force", ("specimen", "contact"), "specimen"),
                entry.number("fixture_mass", 0.0, least=0),
            )
        )
        entry.finish()
    if not sources:
        raise ZSpringError("measurement: needs at least one, [[measurement]] with file = ...")
    static = None
    if "static" in table.content:
        entry = Table(table.table("static"), "static")
        if linear:
            raise ZSpringError("static: the linear model has no static test")
        static = Static(
            path.parent / entry.text("file"),
            entry.number("speed", Static.speed, above=0),
            entry.number("weight", Static.weight, above=0),
        )
        entry.finish()
    entry = Table(table.table("search"), "search")
    search = Search(
        entry.integer("generations", 300 if linear else 12, 0),
        entry.integer("population", Search.population, 1),
        entry.integer("points", 1000 if linear else Search.points, 1),
        entry.integer("seed", Search.seed, 0),
    )
    entry.finish()
    settings = Settings(
        path,
        model,
        tuple(sources),
        free,
        fixed,
        tied,
        search,
        table.band("band"),
        table.choice("error", ("log", "linear"), "linear" if linear else "log"),
        table.choice("quantity", ("receptance", "stiffness"), "receptance"),
        table.choice("direction", ("up", "down", "rest"), "up"),
        static,
        text,
    )
    table.finish()
    return settings


def _fixed(
    path: Path, table: Table, fmu: Fmu, parameter_set: str | None, assignments: tuple[str, ...], linear: bool
) -> tuple[dict[str, Value], dict[str, Value]]:
    """Parameters given by set, file and command line, the last before the first; and those not of the set."""
    own_set = table.text("parameters", "")
    chosen = parameter_set or own_set
    if own_set and not parameter_set and own_set not in packaged_sets():
        chosen = str(path.parent / own_set)
    values = read_set(find_set(chosen), fmu) if chosen else {}
    lines = [f"{name}={value}" for name, value in flatten(table.table("fixed"), is_plain).items()]
    given = fmu.variables.parse_assignments([*lines, *assignments], but_not=BENCH_PARAMETERS)
    suspension = fmu.variables.parse_assignments([f"suspension={'Linear' if linear else 'ZSpring'}"])
    values = {name: value for name, value in values.items() if name not in BENCH_PARAMETERS}
    step = {} if linear else {"solver.step": ACCURATE_STEP}
    return {**step, **values, **given, **suspension}, given


def _free(fmu: Fmu, name: str, bounds: Table) -> Free:
    if fmu.variables.parameter(name).type != "Real" or name in BENCH_PARAMETERS:
        raise ZSpringError(f"free.{name}: must be a Real parameter of the pantograph")
    start, low, high = (bounds.number(key) for key in ("start", "min", "max"))
    bounds.finish()
    if not low < high:
        raise ZSpringError(f"free.{name}: min = {low:g} must be below max = {high:g}")
    if not low <= start <= high:
        raise ZSpringError(f"free.{name}: start = {start:g} must lie in {low:g} .. {high:g}")
    for key, bound, limit in (("min", low, "min"), ("max", high, "max")):
        allowed = getattr(fmu.variables[name], limit)
        if allowed is not None and (bound - float(allowed)) * (1 if key == "min" else -1) < 0:
            raise ZSpringError(f"free.{name}: {key} = {bound:g}: the FMU allows {limit} {allowed}")
    return Free(name, start, low, high)


def _tied(fmu: Fmu, table: Table, free: list[str]) -> dict[str, tuple[str, float]]:
    tied = {}
    for name, value in flatten(table.table("tied"), lambda item: "to" in item or is_plain(item)).items():
        entry = Table(value if isinstance(value, Mapping) else {"to": value}, f"tied.{name}")
        to, factor = entry.text("to"), entry.number("factor", 1.0)
        entry.finish()
        for each in (name, to):
            if fmu.variables.parameter(each).type != "Real":
                raise ZSpringError(f"tied.{name}: {each} is no Real parameter")
        if name in free:
            raise ZSpringError(f"tied.{name}: is free, too")
        tied[name] = (to, factor)
    for name, (to, _) in tied.items():
        if to in tied:
            raise ZSpringError(f"tied.{name}: {to} is itself tied")
    return tied
