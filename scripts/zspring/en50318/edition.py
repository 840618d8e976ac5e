"""Editions of the standard: reference cases and accepted ranges, in TOML files.

EN 50318:2002 and the benchmark of 2015 come with the package. Later editions are filled in by the user;
`example.toml` explains all keys.
"""

from __future__ import annotations

import importlib.resources
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from ..errors import ZSpringError, did_you_mean
from ..line.mean_force import STANDING, mean_force
from ..line.quantities import FIGURES, FREE, Statistics, is_figure, points_of
from ..line_file.schema import LineFile
from ..parameter_sets import LINES, PANTOGRAPHS, describe_set, find_set
from ..settings import Pair, Positive, Table, fitting, set_name, settings_of

DEVIATION_SHARE = 0.3  # of the mean force: largest standard deviation, as papers quote it
MOST_SPEED = 600.0  # km/h


def _known(figures: Any) -> Any:
    """A list of names of values, or numbers by name. Raises ValueError for a name that is none."""
    for name in figures if isinstance(figures, (Mapping, list)) else ():
        if isinstance(name, str) and not is_figure(name):
            other = did_you_mean(name, FIGURES) or f": free ones are {FREE}"
            raise ValueError(f"unknown value {name!r}{other}")
    return figures


Range = Annotated[Pair, fitting("must be [lowest, highest]", lambda ends: ends[0] <= ends[1])]
Ranges = Annotated[dict[str, Range], BeforeValidator(_known)]
Supply = Annotated[str, fitting(f"must be one of {', '.join(STANDING)}", ("", *STANDING).__contains__)]


class Case(Table):
    """One run of an edition, with one pantograph or two."""

    title: str
    line: Annotated[str, set_name(LINES)]
    pantograph: Annotated[str, set_name(PANTOGRAPHS)]
    speed: Positive = Field(description="km/h")
    first_span: int = Field(ge=1, description="that is evaluated, from 1")
    last_span: int = Field(ge=1, description="that is evaluated")
    spacing: Positive | None = Field(None, description="m, from the leading pantograph back to a trailing one")
    given_force: Positive | None = Field(None, alias="static_force", description="N")
    supply: Supply = Field("", description="whose mean force by speed the run has")
    given_mean: Positive | None = Field(None, alias="mean_force", description="N, that the run has")
    values: Annotated[list[str], BeforeValidator(_known)] = Field([], description="further ones that are told")
    ranges: Ranges = Field({}, description="in the units of FIGURES, of the leading pantograph or the only one")
    trailing_ranges: Ranges = Field({}, description="of the trailing one")

    @property
    def target(self) -> float | None:
        """Mean force in N that each pantograph is to have over the evaluated spans, by an uplift; None: it has what
        it has."""
        return mean_force(self.supply, self.speed) if self.supply else self.given_mean

    @property
    def static_force(self) -> float:
        """N; the target where none is given."""
        force = self.target if self.given_force is None else self.given_force
        assert force is not None  # see _fits
        return force

    @property
    def further(self) -> tuple[str, ...]:
        """Figures that are told besides FIGURES."""
        names = (*self.values, *self.ranges, *self.trailing_ranges)
        return tuple(dict.fromkeys(name for name in names if name not in FIGURES))

    @property
    def points(self) -> tuple[float, ...]:
        """Positions in m at which uplifts are told."""
        return points_of(self.further)

    @model_validator(mode="after")
    def _fits(self) -> Case:
        if self.speed > MOST_SPEED:
            raise ValueError(f"speed = {self.speed:g} km/h: must be at most {MOST_SPEED:g} km/h")
        if self.last_span < self.first_span:
            raise ValueError(f"last_span = {self.last_span}: must be a whole number of at least {self.first_span}")
        if self.supply and self.given_mean is not None:
            raise ValueError("supply and mean_force: give one of them")
        if self.target is None and self.given_force is None:
            raise ValueError("static_force is missing (or the mean force that the run has: supply or mean_force)")
        if self.trailing_ranges and self.spacing is None:
            raise ValueError("trailing_ranges: need a trailing pantograph, spacing")
        return self


class Edition(Table):
    """What an edition of the standard asks for."""

    name: str = Field(alias="edition")
    source: str
    cases: list[Case] = Field([], alias="case")
    agreement: Annotated[dict[str, Positive], BeforeValidator(_known)] = Field(
        {}, description="largest difference of simulation and line test in %, by name of FIGURES"
    )

    @model_validator(mode="after")
    def _is_complete(self) -> Edition:
        if not self.source.strip():
            raise ValueError("source is empty: say where the numbers are from")
        if not self.cases:
            raise ValueError("needs at least one [[case]]")
        titles = [case.title for case in self.cases]
        for title in titles:
            if titles.count(title) > 1:
                raise ValueError(f"two cases {title!r}")
        return self

    def with_figures(self, names: Sequence[str]) -> Edition:
        """The edition with further values that each case tells."""
        if not names:
            return self
        cases = [case.model_copy(update={"values": [*case.values, *names]}) for case in self.cases]
        return self.model_copy(update={"cases": cases})

    def only_first(self) -> Edition:
        """The edition with its first case alone."""
        return self.model_copy(update={"cases": self.cases[:1]})

    def case(self, title: str) -> Case:
        """The case of that title. Raises ZSpringError if there is none."""
        known = {case.title: case for case in self.cases}
        if title not in known:
            raise ZSpringError(
                f"{title}: no case of {self.name}{did_you_mean(title, known)} (there are {', '.join(known)})"
            )
        return known[title]


@dataclass(frozen=True)
class Judgement:
    """A value beside its accepted range; `outside` is how far it is beyond, 0 inside, in the value's unit."""

    name: str
    value: float
    accepted: Range

    @property
    def outside(self) -> float:
        low, high = self.accepted
        return min(self.value - low, 0.0) + max(self.value - high, 0.0)

    @property
    def is_inside(self) -> bool:
        return self.outside == 0.0


def packaged_edition(name: str) -> Path:
    """The file of an edition in this package: "en-50318-2002", "benchmark-2015", or the "example"."""
    return Path(str(importlib.resources.files("zspring") / "resources" / "en50318" / f"{name}.toml"))


def sources_of(case: Case) -> list[tuple[str, str, dict[str, list[str]]]]:
    """Name, description and remarks by text, of line and pantograph. Raises ZSpringError where a file is not there."""
    files = [find_set(case.line, LINES), find_set(case.pantograph)]
    found = []
    for path in files:
        if path.suffix == ".toml":
            with settings_of(path, LineFile, brackets=True) as file:
                found.append((file.name, file.description, dict[str, list[str]]()))
        else:
            found.append((path.stem, *describe_set(path)))
    return found


def judge(found: Statistics, ranges: Mapping[str, Range]) -> list[Judgement]:
    """Every value that has a range beside it; one that the series does not tell is outside by NaN."""
    return [Judgement(name, found[name], accepted) for name, accepted in ranges.items()]


def agreement(simulated: Statistics, measured: Statistics, limits: Mapping[str, float]) -> list[Judgement]:
    """Differences of a simulation from a line test in % of the line test, beside what is accepted."""
    differences = {name: 100 * (simulated[name] / measured[name] - 1) for name in limits}
    return [Judgement(name, differences[name], (-limit, limit)) for name, limit in limits.items()]


def read_edition(path: Path) -> Edition:
    """The edition of a TOML file. Raises ZSpringError, one line with the file and the key, for a bad one."""
    with settings_of(path, Edition) as edition:
        return edition
