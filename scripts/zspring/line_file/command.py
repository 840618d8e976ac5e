"""The command `zspring line`."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from ..exported_fmu import Copy
from ..fmu import CATENARY, Fmu, installed_fmu
from ..options import FILE, POSITIVE, Spans, copy_examples, line_fmu_option, opened, option, output_option
from ..records import claimed
from .design import Line, read_line
from .report import summary
from .statics import FORCE, at_rest

EXAMPLES = "en-50318-2002.toml", "benchmark-2015.toml", "stitched-synthetic.toml"


@contextmanager
def _line(path: Path, fmu_path: Path | None) -> Iterator[tuple[Line, Fmu]]:
    """A line, and the catenary with it."""
    with opened(fmu_path or installed_fmu(CATENARY)) as catenary:
        line = read_line(path, catenary)
        yield line, catenary.with_line(line.table)


def _line_argument(command: Callable) -> Callable:
    return click.argument("path", metavar="LINE.toml", type=click.Path(path_type=Path))(command)


@click.group()
def line() -> None:
    """Check, draw and export an overhead line that a file describes: any spans, stitch wires, measured heights.

    docs/lines.md tells the form of the file; `zspring line example DIR` writes three of them to begin with. Commands
    that run along a line take it as --line LINE.toml.
    """


@line.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path, file_okay=False))
def example(folder) -> None:
    """Write the line files of the package into a folder, to be edited: two reference lines, one with stitch wires."""
    copy_examples(folder, {name: f"lines/{name}" for name in EXAMPLES})


@line.command()
@_line_argument
@line_fmu_option
def check(path, line_fmu) -> None:
    """Check a line file, and tell what was read: spans, droppers and their forces at rest, masses."""
    with _line(path, line_fmu) as (found, catenary):
        print(*summary(found, at_rest(catenary, found.parameters, found.table.droppers["x"])), sep="\n")


@line.command()
@_line_argument
@option("--spans", kind=Spans(), metavar="FIRST:LAST", help="Spans to draw.  [default: all]")
@option("--force", default=FORCE, kind=POSITIVE, help="In N, under which the elasticity is taken.")
@output_option("results/line")
@line_fmu_option
def draw(path, spans, force, output, line_fmu) -> None:
    """Draw a line to scale at rest, with the droppers' forces and its elasticity.

    Elasticity is the static uplift of the contact wire under a force, where it acts, for each N of it. Writes line.svg,
    line.png, dropper-forces.csv and elasticity.csv.
    """
    from .run import draw_and_write  # matplotlib is slow to load

    with _line(path, line_fmu) as (found, catenary), claimed(output):
        draw_and_write(found, catenary, spans, force, output)


@line.command()
@_line_argument
@click.argument("target", metavar="FILE.fmu", type=FILE)
@line_fmu_option
def fmu(path, target, line_fmu) -> None:
    """Write an FMU of the catenary that is this line.

    It has the line's table and its file in its resources, and its wires and damping as start values. Parameters of the
    catenary that the table stands for, line.* and the like, have no effect in it. Any tool that gives FMUs their
    resource location can run it; `zspring couple --line-fmu FILE.fmu` does.
    """
    with _line(path, line_fmu) as (found, catenary):
        unfinished = target.with_name(f"{target.name}.part")
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            Copy(starts=found.parameters, files={"line.toml": path.read_bytes()}).write(catenary, unfinished)
            with Fmu(unfinished) as made:
                made.used_parameters({})  # starts once
            os.replace(unfinished, target)
        finally:
            unfinished.unlink(missing_ok=True)
    print("written:", target)
