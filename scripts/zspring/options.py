"""Options that commands share, and lists of numbers on the command line."""

from __future__ import annotations

import importlib.resources
import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from pathlib import Path

import click

from .errors import ZSpringError
from .fmu import Fmu
from .parameter_sets import ACCURATE_STEP, PANTOGRAPHS, chosen_set
from .tables import LARGEST
from .variables import Value

_DECIMAL = r"\d+(?:\.\d+)?"
MOST_NUMBERS = 100_000
TOLD_ANYWAY = ("drive", "suspension", "friction", "solver.step")  # by titles


class _Finite(click.ParamType):
    """Refuses nan and inf, which are numbers to click, before a number's type."""

    def convert(self, value, param, ctx) -> float:
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r}: must be a finite number", param, ctx)
        return number


class Number(_Finite, click.types.FloatParamType):
    """A finite number."""


class NumberRange(_Finite, click.FloatRange):
    """A finite number between bounds."""


class Numbers(click.ParamType):
    """Positive numbers and ranges START:STOP:STEP between commas or blanks; sorted, without doubles."""

    name = "numbers"

    def convert(self, value, param, ctx) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        numbers = {number for part in value.replace(",", " ").split() for number in self._part(part, param, ctx)}
        return tuple(sorted(numbers)) or self.fail("needs at least one number", param, ctx)

    def _part(self, part: str, param, ctx) -> list[float]:
        try:
            values = [float(text) for text in part.split(":")]
        except ValueError:
            values = []
        if len(values) not in (1, 3) or not all(0 < value < LARGEST for value in values):
            self.fail(f"{part!r}: must be a positive number or START:STOP:STEP", param, ctx)
        if len(values) == 1:
            return values
        start, stop, step = values
        if stop < start:
            self.fail(f"{part!r}: STOP must not be below START", param, ctx)
        if stop - start > MOST_NUMBERS * step:
            self.fail(f"{part!r}: more than {MOST_NUMBERS} numbers", param, ctx)
        return [round(start + i * step, 12) for i in range(math.floor((stop - start) / step + 1e-9) + 1)]


class WholeNumbers(click.ParamType):
    """Whole numbers from 1 between commas or blanks."""

    name = "whole numbers"

    def convert(self, value, param, ctx) -> tuple[int, ...]:
        parts = value.replace(",", " ").split() if isinstance(value, str) else value
        if not all(isinstance(part, int) or (part.isdecimal() and int(part) > 0) for part in parts):
            self.fail(f"{value!r}: must be whole numbers from 1, as 1,3", param, ctx)
        return tuple(map(int, parts))


class Spans(click.ParamType):
    """N or FIRST:LAST, counted from 1."""

    name = "spans"

    def convert(self, value, param, ctx) -> tuple[int, int]:
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"(\d+)(?::(\d+))?", value.strip())
        first, last = (int(found[1]), int(found[2] or found[1])) if found else (0, 0)
        if not 1 <= first <= last:
            self.fail(f"{value!r}: must be N or FIRST:LAST, counted from 1", param, ctx)
        return first, last


class Band(click.ParamType):
    """LOW:HIGH, frequencies in Hz from 0."""

    name = "band"

    def convert(self, value, param, ctx) -> tuple[float, float]:
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(rf"({_DECIMAL}):({_DECIMAL})", value.strip())
        low, high = (float(found[1]), float(found[2])) if found else (0.0, 0.0)
        if not low < high:
            self.fail(f"{value!r}: must be LOW:HIGH, frequencies in Hz from 0, as 20:50", param, ctx)
        return low, high


FILE = click.Path(path_type=Path, dir_okay=False)
NUMBER, POSITIVE, NOT_NEGATIVE = Number(), NumberRange(min=0, min_open=True), NumberRange(min=0)


def option(*names: str, help: str, default=None, kind=NUMBER, metavar: str | None = None):
    """click's option, which shows its default unless `help` tells it in words."""
    shown = default not in (None, ()) and "[default: " not in help
    return click.option(*names, type=kind, default=default, show_default=shown, metavar=metavar, help=help)


def numbers(name: str, default, help: str):
    """An option with a list of numbers."""
    return option(name, default=default, kind=Numbers(), metavar="LIST", help=help)


def choice(*names: str, of: Iterable[str], default: str | None = None, help: str):
    """An option with one of these texts."""
    return option(*names, default=default, kind=click.Choice(list(of)), help=help)


fmu_option = option("--fmu", "fmu_path", kind=FILE, metavar="FILE", help="Use this FMU, not the one in the package.")
line_fmu_option = option("--line-fmu", kind=FILE, metavar="FILE", help="Use this FMU of the catenary.")
set_option = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a parameter of the FMU, in its unit or by the name of an enumeration's item; repeatable. "
    f"`zspring info` lists them. solver.step is {1e3 * ACCURATE_STEP:g} ms where it is not set; the FMU alone starts "
    "with 2 ms.",
)
parameters_option = option(
    "--parameters",
    "parameter_set",
    kind=str,
    metavar="NAME|FILE",
    help="Set the parameters of a pantograph: the name of a set (`zspring info --sets` lists them) or an "
    "SSV file of SSP; FILE#PREFIX reads those whose names begin with PREFIX and a dot. --set goes before it.",
)
line_option = option(
    "--line",
    "line_set",
    kind=str,
    metavar="NAME|FILE",
    help="The line: the name of a set (`zspring info --sets` lists them), an SSV file of SSP 1.0, or a line file, "
    "LINE.toml, of `zspring line`.  [default: the catenary FMU's own, EN 50318:2002]",
)


def settings_argument(example: str):
    """SETTINGS.toml, or --example DIR, which only writes `example`."""

    def decorated(command: Callable) -> Callable:
        folder = click.Path(path_type=Path, file_okay=False)
        text = f"Only write an example into this folder: {example}."
        command = option("--example", kind=folder, metavar="DIR", help=text)(command)
        path = click.Path(path_type=Path)
        return click.argument("settings_path", type=path, metavar="SETTINGS.toml", required=False)(command)

    return decorated


def draws_option(what: str):
    """--draws FILE: `what` is done for each of them."""
    text = f"Draws of the pantograph's parameters, as `zspring identify` leaves them: {what} for each, with intervals."
    return option("--draws", "draws_path", kind=FILE, metavar="FILE", help=text)


def data_sets_option(name: str):
    """Which data sets of a universal file to read."""
    text = "Of a universal file, where nodes and directions do not tell the driving point, e.g. 1,3."
    return option(name, default=(), kind=WholeNumbers(), metavar="LIST", help=text)


format_option = choice("--format", "suffix", of=["png", "svg"], default="png", help="Format of the figure.")


@dataclass(frozen=True)
class Pantograph:
    """What --fmu, --parameters and --set choose."""

    fmu_path: Path | None
    parameter_set: str | None
    assignments: Sequence[str]

    @property
    def named(self) -> str:
        """For titles: the set, and what --set gives that they do not say anyway."""
        others = [a for a in self.assignments if a.partition("=")[0].strip() not in TOLD_ANYWAY]
        return ", ".join([f"pantograph {self.parameter_set or 'of the FMU'}", *others])

    @contextmanager
    def opened(
        self, but_not: Sequence[str] = (), step: float = ACCURATE_STEP
    ) -> Iterator[tuple[Fmu, dict[str, Value]]]:
        """The FMU and the parameters.

        but_not     as in chosen_parameters
        step        s, solver.step where neither set nor assignment has one; not with solver.step in `but_not`
        """
        with opened(self.fmu_path) as fmu:
            chosen = chosen_parameters(fmu, self.parameter_set, self.assignments, but_not)
            yield fmu, chosen if "solver.step" in but_not else {"solver.step": step, **chosen}


def pantograph_options(command: Callable) -> Callable:
    """--parameters, --set and --fmu, which the command gets as one `pantograph`."""

    @parameters_option
    @set_option
    @fmu_option
    @wraps(command)
    def with_pantograph(*, fmu_path, parameter_set, assignments, **others):
        return command(pantograph=Pantograph(fmu_path, parameter_set, assignments), **others)

    return with_pantograph


def jobs_option(what: str):
    """--jobs N, by default the number of processors; `what` is done at a time."""
    most, kind = "  [default: number of processors]", click.IntRange(min=1)
    return option("--jobs", default=lambda: os.cpu_count() or 1, kind=kind, metavar="N", help=what + most)


def output_option(default: str = "", described: str = ""):
    """--output DIR with this default; `described` says in words what one is that the settings decide."""
    text = "Folder of the results." + (f"  [default: {described}]" if described else "")
    folder = click.Path(path_type=Path, file_okay=False)
    return option("--output", default=Path(default) if default else None, kind=folder, metavar="DIR", help=text)


def copy_examples(folder: Path, files: Mapping[str, str]) -> None:
    """Copy files of the package's resources, by their new names. Raises ZSpringError where one is there already."""
    for name in files:
        if (folder / name).exists():
            raise ZSpringError(f"{folder / name} exists and is kept: name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    resources = importlib.resources.files(__package__) / "resources"
    for name, source in files.items():
        (folder / name).write_bytes(resources.joinpath(source).read_bytes())
    print("written:", *(folder / name for name in files))


@contextmanager
def opened(path: Path | None) -> Iterator[Fmu]:
    """The FMU for one command, which tells at its end, be it a failure, what the FMU warned of."""
    with Fmu(path) as fmu:
        try:
            yield fmu
        finally:
            for warning in fmu.warnings:
                print(f"the FMU warns: {warning}", file=sys.stderr)


def chosen_parameters(
    fmu: Fmu,
    parameter_set: str | None,
    assignments: Iterable[str],
    but_not: Sequence[str] = (),
    kind: str = PANTOGRAPHS,
    settable: Sequence[str] = ("parameter",),
) -> dict[str, Value]:
    """Parameters of the FMU from --parameters and --set.

    but_not     parameters that the command sets itself: passed over in a set, refused in an assignment
    kind        of the sets in the package
    settable    what assignments may set, inputs perhaps
    """
    values = chosen_set(parameter_set, fmu, kind, but_not) if parameter_set else {}
    return {**values, **fmu.variables.parse_assignments(assignments, but_not, settable)}
