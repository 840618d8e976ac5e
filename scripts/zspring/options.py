"""Options that commands share, and lists of numbers on the command line."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from .fmu import Fmu

MOST_NUMBERS = 100_000


class Numbers(click.ParamType):
    """Positive numbers and ranges START:STOP:STEP between commas or blanks; sorted, without doubles."""

    name = "numbers"

    def convert(self, value, param, ctx) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        numbers = {
            number for part in value.replace(",", " ").split() for number in self._part(part, param, ctx)
        }
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
set_option = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a parameter of the FMU, in its unit or by the name of an enumeration's item; repeatable. "
    "`zspring info` lists them.",
)
format_option = click.option(
    "--format",
    "suffix",
    type=click.Choice(["png", "svg"]),
    default="png",
    show_default=True,
    help="Format of the figure.",
)


@contextmanager
def opened(path: Path | None) -> Iterator[Fmu]:
    """The FMU for one command, which tells at its end what the FMU warned of."""
    with Fmu(path) as fmu:
        yield fmu
        for warning in fmu.warnings:
            print(f"the FMU warns: {warning}", file=sys.stderr)
