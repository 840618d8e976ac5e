"""The command `zspring identify`."""

from __future__ import annotations

from pathlib import Path

import click

from ..options import (
    copy_examples,
    format_option,
    jobs_option,
    opened,
    output_option,
    pantograph_options,
    settings_argument,
)
from ..records import claimed

EXAMPLE = ("identify.toml", "bench.csv", "independent.csv")


@click.command()
@settings_argument("settings and synthetic measurements, both explained")
@pantograph_options
@output_option(described="results/identify-SETTINGS")
@jobs_option("Amplitudes to simulate at a time.")
@format_option
def identify(pantograph, settings_path, example, output, jobs, suffix) -> None:
    """Fit parameters of the model to measured frequency responses.

    SETTINGS.toml names the measurements, the free parameters with start and bounds, those that are fixed or
    tied, the band, the kind of error and the model. `zspring identify --example DIR` writes one to begin
    with, which explains them all.

    Measurements are CSV files or universal files (data set 58): receptance, dynamic stiffness, mobility,
    accelerance, or the inverse of these two, with several amplitudes; a static test may join them.

    A search for where to begin is followed by least squares. Writes fitted.ssv for --parameters and other tools,
    fit.csv, fit.png, report.html and identify.log; where they were asked for, draws.csv for --draws, and figures of
    the posterior, the harmonics and the static test. Ctrl-C keeps the search, and the same command goes on from there.
    """
    if example:
        copy_examples(example, {name: f"examples/{name}" for name in EXAMPLE})
        return
    if settings_path is None:
        raise click.UsageError("name a SETTINGS.toml, or a folder for an --example")
    from .run import identify as run_identification  # scipy's optimisers are slow to load
    from .settings import read_settings

    with opened(pantograph.fmu_path) as fmu:
        settings = read_settings(settings_path, fmu, pantograph.parameter_set, pantograph.assignments)
        folder = output or Path("results") / f"identify-{settings_path.stem}"
        with claimed(folder):
            run_identification(fmu, settings, settings_path, folder, suffix, jobs)
