"""The command `zspring study`."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import click

from ..errors import missing_extra
from ..fmu import CATENARY, installed_fmu
from ..options import (
    POSITIVE,
    copy_examples,
    fmu_option,
    format_option,
    line_fmu_option,
    opened,
    option,
    output_option,
    settings_argument,
)
from ..records import claimed

EXAMPLE = "study.toml", "study-friction.toml", "study-friction-line.toml"
NEEDED = ("distributed", "SALib", "pyarrow")


@click.command()
@settings_argument("a Sobol design, and what friction changes on irregular lines, with its line")
@output_option(described="results/study-SETTINGS")
@option(
    "--scheduler",
    kind=str,
    metavar="ADDRESS",
    help="Run on the Dask cluster with this scheduler, e.g. tcp://host:8786, instead of local processes. Its "
    "workers need distributed, fmpy, numpy (scipy for [couple]) and the Python version from here; FMUs and code are "
    "sent to them.",
)
@option(
    "--workers",
    default=lambda: os.cpu_count() or 1,
    kind=click.IntRange(min=1),
    metavar="N",
    help="Local processes.  [default: number of processors]",
)
@option(
    "--timeout",
    default=30.0,
    kind=POSITIVE,
    help="Longest wait in s for the scheduler, and for a worker when there is none.",
)
@option(
    "--line-of",
    kind=click.IntRange(min=0),
    metavar="CASE",
    help="Only write the line of this case as line-CASE.fmu, an FMU of the catenary, for `zspring couple --line-fmu`.",
)
@click.option(
    "--parquet", is_flag=True, help="Write the results as study.parquet, too, from time to time and at the end."
)
@format_option
@fmu_option
@line_fmu_option
def study(
    settings_path, example, output, scheduler, workers, timeout, line_of, parquet, suffix, fmu_path, line_fmu
) -> None:
    """Run the parameter study that SETTINGS.toml describes.

    \b
        design = "sobol"           # grid, list, latin-hypercube or sobol
        samples = 64               # sobol: N for N (D + 2) cases
        seed = 1
        parameters = "dsa-380-zspring"  # what is not varied, from a set or an SSV file
        [vary]                     # parameters of the FMU, in its units
        zspring.k = { from = 12000, to = 14000 }
        zspring.Mf = { from = 0.2, to = 0.4, scale = "log" }
        [set]                      # common to all cases
        friction = "Coulomb"
        [frf]                      # what to compute: the FRF by amplitude (options of `zspring frf`) ...
        amplitudes = [1, 4]        # m/s2
        frequencies = "3:9:0.25"   # Hz
        resonance_band = [3, 9]    # Hz, where the highest resonance is looked for
        [static]                   # ... and/or the static stiffness of the suspension ...
        amplitudes = [0.02]        # m
        [couple]                   # ... and/or a run along a line (options of `zspring couple`)
        line = "line.toml"         # a line file, a set or an SSV file
        speed = 250                # km/h
        spans = [4, 6]             # to evaluate
        [irregularity]             # each run along all of these lines, with a line file
        lines = 30
        dropper_length = 0.003     # m, standard deviation
        [compare]                  # each run by all of these, with [couple]
        "Z-spring" = {}
        "rods held" = { suspension = "LinearLocked" }

    With [couple] the line's parameters vary as catenary.NAME, what the run is given as couple.speed, couple.spacing
    and so on, irregularities as irregularity.dropper_length.

    A grid takes values ([1, 2, 3] or a range with its count) and makes all combinations; a list takes the
    first value of each parameter, then the second of each, and so on.

    Each result is a row of study.csv as soon as it is there. After Ctrl-C, or whatever else ended the study,
    the same command goes on. A case that fails is recorded with its reason. Writes summary figures, too.
    """
    if example:
        copy_examples(example, {name: f"examples/{name}" for name in EXAMPLE})
        return
    if settings_path is None:
        raise click.UsageError("name a SETTINGS.toml, or a folder for an --example")
    absent = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if absent:
        raise missing_extra(absent, "study")
    from .run import Place, run_study, write_line

    folder = output or Path("results") / f"study-{settings_path.stem}"
    with opened(fmu_path) as fmu, opened(line_fmu or installed_fmu(CATENARY)) as catenary, claimed(folder):
        if line_of is not None:
            write_line(fmu, catenary, settings_path, folder, line_of)
        else:
            run_study(fmu, catenary, settings_path, folder, Place(scheduler, workers, timeout), suffix, parquet)
