"""Options that commands share, and lists of numbers on the command line."""

from __future__ import annotations

import importlib.resources
import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from .errors import ZSpringError
from .fmu import Fmu
from .parameter_sets import PANTOGRAPHS, find_set, read_set
from .variables import Value

MOST_NUMBERS = 100_000


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
        if len(values) not in (1, 3) or not all(math.isfinite(value) and value > 0 for value in values):
            self.fail(f"{part!r}: must be a positive number or START:STOP:STEP", param, ctx)
        if len(values) == 1:
            return values
        start, stop, step = values
        if stop < start:
            self.fail(f"{part!r}: STOP must not be below START", param, ctx)
        if stop - start > MOST_NUMBERS * step:
            self.fail(f"{part!r}: more than {MOST_NUMBERS} numbers", param, ctx)
        return [round(start + i * step, 12) for i in range(math.floor((stop - start) / step + 1e-9) + 1)]


fmu_option = click.option(
    "--fmu",
    "fmu_path",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Use this FMU instead of the one in the package.",
)
line_fmu_option = click.option("--line-fmu", type=click.Path(path_type=Path), metavar="FILE", help="Of the catenary.")
set_option = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a parameter of the FMU, in its unit or by the name of an enumeration's item; repeatable. "
    "`zspring info` lists them.",
)
parameters_option = click.option(
    "--parameters",
    "parameter_set",
    metavar="NAME|FILE",
    help="Set the parameters of a pantograph: the name of a set (`zspring info --sets` lists them) or an "
    "SSV file of SSP 1.0. --set goes before it.",
)
format_option = click.option(
    "--format",
    "suffix",
    type=click.Choice(["png", "svg"]),
    default="png",
    show_default=True,
    help="Format of the figure.",
)


def jobs_option(what: str):
    """--jobs N, by default the number of processors; `what` is done at a time."""
    return click.option(
        "--jobs",
        type=click.IntRange(min=1),
        default=lambda: os.cpu_count() or 1,
        metavar="N",
        help=f"{what}  [default: number of processors]",
    )


def output_option(default: str = "", described: str = ""):
    """--output DIR with this default; `described` says in words what one is that the settings decide."""
    return click.option(
        "--output",
        type=click.Path(path_type=Path, file_okay=False),
        default=Path(default) if default else None,
        show_default=bool(default),
        metavar="DIR",
        help="Folder of the results." + (f"  [default: {described}]" if described else ""),
    )


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
) -> dict[str, Value]:
    """Parameters of the FMU from --parameters and --set.

    but_not     parameters that the command sets itself: passed over in a set, refused in an assignment
    kind        of the sets in the package
    """
    values = read_set(find_set(parameter_set, kind), fmu) if parameter_set else {}
    return {
        **{name: value for name, value in values.items() if name not in but_not},
        **fmu.variables.parse_assignments(assignments, but_not),
    }
