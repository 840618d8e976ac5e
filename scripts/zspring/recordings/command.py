"""The command `zspring recordings`."""

from __future__ import annotations

from pathlib import Path

import click

from ..options import format_option, output_option, settings_argument
from ..records import claimed


@click.command()
@settings_argument("virtual recordings of the FMU, and settings that explain themselves")
@click.option("--uff", is_flag=True, help="Write the responses as a universal file (data sets 58), too.")
@output_option(described="results/recordings-SETTINGS")
@format_option
def recordings(settings_path, example, uff, output, suffix) -> None:
    """Make frequency responses from time records of a shaker bench.

    SETTINGS.toml names the files and their channels: force, and displacement or acceleration, with units, signs and
    delays, and how the frequencies were driven. `zspring recordings --example DIR` writes one to begin with, which
    explains them all. Files are tables of text, MAT, HDF5, TDMS or universal files (data set 58).

    Finds the holds, their steady periods and the frequency that was driven; H from the fundamentals with its standard
    errors, harmonics, distortion and noise. Writes frf.csv for `zspring identify` (by direction, if there are two),
    holds.csv with all that was found and why something is left out, frf.png, harmonics.png and hold.png.
    """
    if example:
        from .example import write_example

        write_example(example)
        return
    if settings_path is None:
        raise click.UsageError("name a SETTINGS.toml, or a folder for an --example")
    from .run import run_recordings  # scipy and pint are slow to load
    from .settings import read_settings

    settings = read_settings(settings_path)
    folder = output or Path("results") / f"recordings-{settings_path.stem}"
    with claimed(folder):
        run_recordings(settings, settings_path, folder, suffix, uff)
