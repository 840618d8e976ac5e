"""The command `zspring info`: a table of the FMU's variables as text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from fnmatch import fnmatchcase

import click
from fmpy.model_description import ScalarVariable

from .errors import ZSpringError, did_you_mean
from .fmu import CATENARY, installed_fmu
from .options import fmu_option, opened
from .parameter_sets import LINES, PANTOGRAPHS, describe_set, packaged_sets
from .text_tables import aligned
from .variables import Variables, parse, text


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
    return aligned([["name", "causality", "unit", "start", "allowed", "description"], *map(_row, wanted)])


def _row(variable: ScalarVariable) -> list[str]:
    causality = f"{'tunable ' if variable.variability == 'tunable' else ''}{variable.causality}"
    start = "" if variable.start is None else text(variable, parse(variable, variable.start))
    return [variable.name, causality, variable.unit or "", start, _bounds(variable), variable.description or ""]


def _bounds(variable: ScalarVariable) -> str:
    if variable.type == "Enumeration":
        return " | ".join(item.name for item in variable.declaredType.items)
    if variable.min is None and variable.max is None:
        return ""
    return f"{variable.min or '-inf'} .. {variable.max or 'inf'}"


def set_lines() -> list[str]:
    """Name of each parameter set in the package with its source and how far it is trusted."""
    lines = []
    for heading, kind in ("Pantographs, for --parameters", PANTOGRAPHS), ("Lines, for --line", LINES):
        lines.append(heading)
        for name, path in packaged_sets(kind).items():
            description, remarks = describe_set(path)
            marked = [f"{remark}: {', '.join(parameters)}" for remark, parameters in remarks.items()]
            lines.append(f"  {name}")
            for line in [description, *marked]:
                lines += textwrap.wrap(line, 110, initial_indent="      ", subsequent_indent="      ")
    return lines


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--path", "only_path", is_flag=True, help="Print only where the FMU is.")
@click.option("--sets", is_flag=True, help="List the parameter sets of pantographs and lines, each with its source.")
@click.option("--catenary", is_flag=True, help="Of the catenary's FMU instead of the pantograph's.")
@fmu_option
def info(names, only_path, sets, catenary, fmu_path) -> None:
    """List the FMU's variables, or those with these NAMEs (zspring.* for all that begin so).

    `cp $(zspring info --path) .` copies the FMU for use in another tool.
    """
    if sets:
        print(*set_lines(), sep="\n")
        return
    if catenary and fmu_path:
        raise ZSpringError(f"--fmu {fmu_path}: must not come with --catenary")
    with opened(installed_fmu(CATENARY) if catenary else fmu_path) as fmu:
        if only_path:
            print(fmu.path.absolute())
            return
        print(*variable_table(fmu.variables, names), sep="\n")
