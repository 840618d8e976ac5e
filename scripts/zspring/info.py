"""The command `zspring info`: a table of the FMU's variables as text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path

import click
from fmpy.model_description import ScalarVariable

from .errors import ZSpringError, did_you_mean
from .fmu import CATENARY, installed_fmu
from .options import FILE, fmu_option, opened, option
from .parameter_sets import LINES, PANTOGRAPHS, describe_set, packaged_sets
from .text_tables import aligned
from .variables import Variables, parse, text

HEAD = ["name", "causality", "unit", "start", "allowed", "description"]


def variable_table(variables: Variables, names: Sequence[str] = ()) -> list[str]:
    """Aligned lines: name, causality, unit, start, bounds, description.

    names   of variables, * and ? allowed; none: all. Raises ZSpringError for one that fits no variable.
    """
    wanted = list(variables)
    if names:
        known = [variable.name for variable in variables]
        for name in names:
            if not any(fnmatchcase(other, name) for other in known):
                raise ZSpringError(f"no variable {name!r} in the FMU{did_you_mean(name, known)}")
        wanted = [variable for variable in variables if any(fnmatchcase(variable.name, name) for name in names)]
    return aligned([HEAD, *map(row_of, wanted)])


def row_of(variable: ScalarVariable) -> list[str]:
    """Cells below HEAD."""
    causality = f"{'tunable ' if variable.variability == 'tunable' else ''}{variable.causality}"
    start = "" if variable.start is None else text(variable, parse(variable, variable.start))
    return [variable.name, causality, variable.unit or "", start, _bounds(variable), variable.description or ""]


def _bounds(variable: ScalarVariable) -> str:
    if variable.type == "Enumeration":
        return " | ".join(item.name for item in variable.declaredType.items)
    if variable.min is None and variable.max is None:
        return ""
    return f"{variable.min or '-inf'} .. {variable.max or 'inf'}"


def set_lines(names: Sequence[str] = ()) -> list[str]:
    """Name of each parameter set in the package, or of these, with its source and how far it is trusted."""
    known = {*packaged_sets(PANTOGRAPHS), *packaged_sets(LINES)}
    for name in names:
        if name not in known:
            raise ZSpringError(f"no set {name!r}{did_you_mean(name, known)} (there are {', '.join(sorted(known))})")
    lines = []
    for heading, kind in ("Pantographs, for --parameters", PANTOGRAPHS), ("Lines, for --line", LINES):
        chosen = {name: path for name, path in packaged_sets(kind).items() if not names or name in names}
        lines += [heading] if chosen else []
        for name, path in chosen.items():
            description, remarks = describe_set(path)
            marked = [f"{remark}: {', '.join(parameters)}" for remark, parameters in remarks.items()]
            lines.append(f"  {name}")
            for line in [description, *marked]:
                lines += textwrap.wrap(line, 110, initial_indent="      ", subsequent_indent="      ")
    return lines


def write_packaged(names: Sequence[str], kind: str, path: Path) -> None:
    """Copy a set of this kind from the package. Raises ZSpringError for more than one name, or a file that is there."""
    known = packaged_sets(kind)
    if len(names) != 1 or names[0] not in known:
        raise ZSpringError(f"--write: needs --sets and the name of one set of {', '.join(known)}")
    try:
        with open(path, "xb") as file:
            file.write(known[names[0]].read_bytes())
    except FileExistsError:
        raise ZSpringError(f"{path} exists and is kept: name another file") from None
    print(f"written: {path}")


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--path", "only_path", is_flag=True, help="Print only where the FMU is.")
@click.option(
    "--sets",
    is_flag=True,
    help="List the parameter sets of pantographs and lines, or those NAMEd, each with its source.",
)
@option(
    "--write",
    "copy",
    kind=FILE,
    metavar="FILE.ssv",
    help="With --sets NAME: write that set of a pantograph, or with --catenary of a line, to be edited.",
)
@click.option("--catenary", is_flag=True, help="Of the catenary's FMU instead of the pantograph's.")
@fmu_option
def info(names, only_path, sets, copy, catenary, fmu_path) -> None:
    """List the FMU's variables, or those with these NAMEs (zspring.* for all that begin so).

    `cp $(zspring info --path) .` copies the FMU for use in another tool, `zspring info --sets dsa-380 --write mine.ssv`
    begins a set of your own.
    """
    if copy:
        write_packaged(names if sets else (), LINES if catenary else PANTOGRAPHS, copy)
        return
    if sets:
        print(*set_lines(names), sep="\n")
        return
    if catenary and fmu_path:
        raise ZSpringError(f"--fmu {fmu_path}: must not come with --catenary")
    with opened(installed_fmu(CATENARY) if catenary else fmu_path) as fmu:
        if only_path:
            print(fmu.path.absolute())
            return
        print(*variable_table(fmu.variables, names), sep="\n")
