"""The command `zspring identify`."""

from __future__ import annotations

import importlib.resources
import os
import shutil
from pathlib import Path

import click

from ..errors import ZSpringError
from ..options import fmu_option, format_option, opened, output_option, parameters_option, set_option

EXAMPLE = ("identify.toml", "bench.csv")


@click.command()
@click.argument("settings_path", type=click.Path(path_type=Path), metavar="SETTINGS.toml", required=False)
@click.option(
    "--example",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Only write an example into this folder: settings and synthetic measurements, both explained.",
)
@parameters_option
@set_option
@output_option(described="results/identify-SETTINGS")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Amplitudes to simulate at a time.  [default: number of processors]",
)
@format_option
@fmu_option
def identify(settings_path, example, parameter_set, assignments, output, jobs, suffix, fmu_path) -> None:
    """Fit parameters of the model to measured frequency responses.

    SETTINGS.toml names the measurements, the free parameters with start and bounds, those that are fixed or
    tied, the band, the kind of error and the model. `zspring identify --example DIR` writes one to begin
    with, which explains them all.

    Measurements are CSV files or universal files (data set 58): receptance, dynamic stiffness, mobility,
    accelerance, or the inverse of these two, with several amplitudes; a static test may join them.

    A global search is followed by least squares. Writes fitted.ssv for --parameters and other tools, fit.csv,
    fit.png and identify.log. Ctrl-C keeps the search, and the same command goes on from there.
    """
    if example:
        _write_example(example)
        return
    if settings_path is None:
        raise click.UsageError("name a SETTINGS.toml, or a folder for an --example")
    from .run import identify as run_identification  # scipy's optimisers are slow to load
    from .settings import read_settings

    with opened(fmu_path) as fmu:
        settings = read_settings(settings_path, fmu, parameter_set, assignments)
        folder = output or Path("results") / f"identify-{settings_path.stem}"
        run_identification(fmu, settings, settings_path, folder, suffix, jobs or os.cpu_count() or 1)


def _write_example(folder: Path) -> None:
    """Copy the example's files. Raises ZSpringError where one would be overwritten."""
    source = Path(str(importlib.resources.files("zspring") / "resources" / "examples"))
    folder.mkdir(parents=True, exist_ok=True)
    for name in EXAMPLE:
        if (folder / name).exists():
            raise ZSpringError(f"{folder / name} exists and is kept: name another folder")
    for name in EXAMPLE:
        shutil.copy(source / name, folder / name)
    print("written:", *(folder / name for name in EXAMPLE))
