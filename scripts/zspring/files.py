"""What the studies write: tables with all settings at their head."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from .fmu import Fmu
from .tables import write_head
from .variables import Value, with_unit


def study_head(fmu: Fmu, parameters: Mapping[str, Value], settings: Mapping[str, str]) -> dict[str, str]:
    """Head of a file: the FMU, the study's own settings, the FMU's parameters with their units."""
    return {
        **fmu.identity,
        **settings,
        "synthetic": " ".join(fmu.variables.synthetic(parameters)),
        **{name: with_unit(fmu.variables[name], value) for name, value in parameters.items()},
    }


def used_parameters(fmu: Fmu, parameters: Mapping[str, Value]) -> dict[str, Value]:
    """All parameters of an instance started with these, calculated ones included.

    Raises FmuError when the FMU refuses one.
    """
    names = fmu.variables.names("parameter", "calculatedParameter")
    with fmu.instances() as (instance,):
        instance.start(parameters)
        return dict(zip(names, instance.get(names)))


def write_table(
    path: Path, head: Mapping[str, str], columns: Sequence[str], rows: Iterable[Sequence[float | str]]
) -> None:
    """A CSV file with 12 digits; the folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", encoding="utf-8", newline="") as file:
        write_head(file, head, columns)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([cell if isinstance(cell, str) else f"{cell:.12g}" for cell in row] for row in rows)


def synthetic_note(fmu: Fmu, parameters: Mapping[str, Value]) -> str:
    """What a figure's title says of parameters that nobody measured; empty if there are none."""
    return "; Z-spring parameters synthetic" if fmu.variables.synthetic(parameters) else ""
