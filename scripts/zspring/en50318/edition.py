"""Editions of the standard: reference cases and accepted ranges, in TOML files.

EN 50318:2002 and the benchmark of 2015 come with the package. Later editions are filled in by the user;
`example.toml` explains all keys.
"""

from __future__ import annotations

import importlib.resources
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import ZSpringError, did_you_mean
from ..line.mean_force import STANDING, mean_force
from ..line.statistics import FIGURES, Statistics
from ..parameter_sets import LINES, PANTOGRAPHS, find_set, packaged_sets
from ..toml_tables import Table, is_number, read_toml

DEVIATION_SHARE = 0.3  # of the mean force: largest standard deviation, as papers quote it
MOST_SPEED = 600.0  # km/h

Range = tuple[float, float]


@dataclass(frozen=True)
class Case:
    """One run of an edition."""

    title: str
    line: str  # name of a set of the package, or path of a file
    pantograph: str
    speed: float  # km/h
    spans: tuple[int, int]  # first and last that are evaluated, from 1
    static_force: float  # N
    ranges: Mapping[str, Range]  # by name of FIGURES, in its units


@dataclass(frozen=True)
class Edition:
    """What an edition of the standard asks for."""

    name: str
    source: str
    cases: tuple[Case, ...]
    agreement: Mapping[str, float]  # largest difference of simulation and line test in %, by name of FIGURES

    def only_first(self) -> Edition:
        """The edition with its first case alone."""
        return replace(self, cases=self.cases[:1])

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
    """A figure beside its accepted range; `outside` is how far it is beyond, 0 inside, in the figure's unit."""

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


def sets_of(case: Case) -> list[Path]:
    """Files of the case's line and pantograph. Raises ZSpringError where one is not there."""
    return [find_set(case.line, LINES), find_set(case.pantograph)]


def judge(found: Statistics, ranges: Mapping[str, Range]) -> list[Judgement]:
    """Every figure that has a range beside it; one that the series does not tell is outside by NaN."""
    return [Judgement(name, found[name], accepted) for name, accepted in ranges.items()]


def agreement(simulated: Statistics, measured: Statistics, limits: Mapping[str, float]) -> list[Judgement]:
    """Differences of a simulation from a line test in % of the line test, beside what is accepted."""
    differences = {name: 100 * (simulated[name] / measured[name] - 1) for name in limits}
    return [Judgement(name, differences[name], (-limit, limit)) for name, limit in limits.items()]


def read_edition(path: Path) -> Edition:
    """The edition of a TOML file. Raises ZSpringError, one line with the file and the key, for a bad one."""
    try:
        _, table = read_toml(path)
        name, source = table.text("edition"), table.text("source")
        if not source.strip():
            raise ZSpringError("source is empty: say where the numbers are from")
        entries = table.list("case")
        cases = tuple(_case(path, entry, number) for number, entry in enumerate(entries, 1))
        if not cases:
            raise ZSpringError("needs at least one [[case]]")
        titles = [case.title for case in cases]
        for title in titles:
            if titles.count(title) > 1:
                raise ZSpringError(f"two cases {title!r}")
        limits = Table(table.table("agreement"), "agreement")
        _check_names(limits.content, "agreement")
        edition = Edition(name, source, cases, {key: limits.number(key, above=0) for key in limits.content})
        table.finish()
        return edition
    except ZSpringError as error:
        text = str(error)
        raise ZSpringError(text if text.startswith(str(path)) else f"{path}: {text}") from None


def _case(path: Path, content: object, number: int) -> Case:
    entry = Table(content, f"case {number}")
    title, speed = entry.text("title"), entry.number("speed", above=0)
    if speed > MOST_SPEED:
        raise ZSpringError(f"case {number}: speed = {speed:g} km/h: must be at most {MOST_SPEED:g} km/h")
    sets = [_set(path, entry.text("line"), LINES), _set(path, entry.text("pantograph"), PANTOGRAPHS)]
    first = entry.integer("first_span", ..., 1)
    last = entry.integer("last_span", ..., first)
    supply = entry.text("supply", "")
    if supply and supply not in STANDING:
        raise ZSpringError(f"case {number}: supply = {supply!r}: must be one of {', '.join(STANDING)}")
    force = entry.number("static_force", mean_force(supply, speed) if supply else ..., above=0)
    if supply and "static_force" in entry.content:
        raise ZSpringError(f"case {number}: static_force and supply: give one of them")
    ranges = entry.table("ranges")
    _check_names(ranges, f"case {number}: ranges")
    for name, accepted in ranges.items():
        is_pair = isinstance(accepted, Sequence) and len(accepted) == 2 and all(map(is_number, accepted))
        if not is_pair or accepted[0] > accepted[1]:
            raise ZSpringError(f"case {number}: ranges.{name} = {accepted!r}: must be [lowest, highest]")
    entry.finish()
    accepted = {name: (float(low), float(high)) for name, (low, high) in ranges.items()}
    return Case(title, *sets, speed, (first, last), force, accepted)


def _set(path: Path, name: str, kind: str) -> str:
    """A packaged set's name, or the path of a file beside the edition's."""
    return name if name in packaged_sets(kind) else str(path.parent / name)


def _check_names(table: Mapping[str, object], where: str) -> None:
    for name in table:
        if name not in FIGURES:
            raise ZSpringError(f"{where}: unknown figure {name!r}{did_you_mean(name, FIGURES)}")
