"""The command `zspring export`: the FMUs for use in other tools, as they are or as those need them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import click

from .errors import ZSpringError
from .exported_fmu import Copy
from .fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu
from .line_file.chosen import chosen_line
from .options import chosen_parameters, line_option, parameters_option
from .variables import Value

# What shows at once how each FMU behaves: the bench, with rods that stick and slide, and a line under a force that
# moves along it.
DEMO: Mapping[str, tuple[list[str], float]] = {
    PANTOGRAPH: (["drive=Bench", "bench.frequency=5", "bench.acceleration=1", "solver.step=0.0005"], 5.0),
    CATENARY: (
        ["pantograph[1].start=30", "pantograph[1].speed=69.44", "pantograph[1].force=120", "point.position[1]=270"],
        7.5,
    ),
}


@click.command()
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--plain", is_flag=True, help="Declare enumerations as Integers, for tools that cannot set them.")
@click.option("--flat", is_flag=True, help="Declare all variables as Reals, with names such as pantograph_1_force.")
@click.option("--demo", is_flag=True, help="Begin with start values that show something: the bench, a moving force.")
@parameters_option
@click.option("--set", "assignments", multiple=True, metavar="NAME=VALUE", help="Start value of the pantograph.")
@line_option
@click.option("--set-line", multiple=True, metavar="NAME=VALUE", help="Start value of the catenary.")
def export(folder, plain, flat, demo, parameter_set, assignments, line_set, set_line) -> None:
    """Copy the FMUs of pantograph and catenary into FOLDER, for use in other tools.

    With --plain `drive = Wire` becomes `drive = 3`: libcosim, Ecos, Maestro and others know no enumerations. With
    --flat `drive` is a Real, 3.0, as cofmupy and pathsim-fmi want it, and names have no dots, which jaxonomy refuses.

    --parameters, --line, --set and --set-line change what the copies start with, parameters and inputs: an input that
    nothing is connected to, such as pantograph[1].speed, keeps it. Internal steps stay those of the FMU unless set.
    """
    chosen = {PANTOGRAPH: (parameter_set, assignments), CATENARY: (line_set, set_line)}
    copies = {installed_fmu(model): folder / f"{model}.fmu" for model in chosen}
    for source, target in copies.items():
        if target.exists() and target.samefile(source):
            raise ZSpringError(f"FOLDER {folder}: has the package's own {target.name}; give another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for (model, (named, given)), (source, target) in zip(chosen.items(), copies.items()):
        shown, stop = DEMO[model] if demo else ([], None)
        unfinished = target.with_suffix(".part")
        try:
            with Fmu(source) as opened:
                fmu, settable = opened, ("parameter", "input")
                if model == CATENARY:
                    line = chosen_line(named, opened, [*shown, *given], settable=settable)
                    fmu, starts = line.catenary, line.parameters
                else:
                    starts = chosen_parameters(fmu, named, [*shown, *given], settable=settable)
                check(fmu, starts)
                Copy(plain, flat, starts, stop).write(fmu, unfinished)
            os.replace(unfinished, target)
        finally:
            unfinished.unlink(missing_ok=True)
        click.echo(f"written: {target}")


def check(fmu: Fmu, starts: Mapping[str, Value]) -> None:
    """Start once with these values. Raises FmuError where the FMU refuses them."""
    inputs = {name: value for name, value in starts.items() if fmu.variables[name].causality == "input"}
    parameters = {name: value for name, value in starts.items() if name not in inputs}
    with fmu.instances() as (instance,):
        instance.start(parameters, inputs)
