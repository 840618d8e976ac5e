"""The command `zspring en50318`."""

from __future__ import annotations

import re
from pathlib import Path

import click

from ..fmu import CATENARY, installed_fmu
from ..options import (
    Numbers,
    chosen_parameters,
    copy_examples,
    fmu_option,
    jobs_option,
    line_fmu_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from ..records import claimed

FILE = click.Path(path_type=Path, dir_okay=False)
POSITIVE = click.FloatRange(min=0, min_open=True)
EDITIONS = ("en-50318-2002", "benchmark-2015")


class Spans(click.ParamType):
    """N or FIRST:LAST, counted from 1."""

    name = "spans"

    def convert(self, value, param, ctx) -> tuple[int, int]:
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"(\d+)(?::(\d+))?", value.strip())
        first, last = (int(found[1]), int(found[2] or found[1])) if found else (0, 0)
        if not 1 <= first <= last:
            self.fail(f"{value!r}: must be N or FIRST:LAST, counted from 1", param, ctx)
        return first, last


@click.command()
@click.option(
    "--edition",
    "edition_path",
    type=FILE,
    metavar="FILE.toml",
    help="Run these cases and compare with their accepted ranges, instead of all else.",
)
@click.option(
    "--example",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Only write an empty file for --edition into this folder, which explains all keys: for the numbers of "
    "EN 50318:2018, which are not public.",
)
@click.option("--quick", is_flag=True, help="The first reference case alone, to try it out.")
@click.option(
    "--head-speeds",
    type=Numbers(),
    metavar="LIST",
    help="Speeds in km/h at which the heads are compared.  [default: 200:350:25]",
)
@jobs_option("Runs at a time.")
@click.option("--series", type=FILE, metavar="FILE.csv", help="Instead of our runs: a contact force to evaluate.")
@click.option("--line-test", type=FILE, metavar="FILE.csv", help="A measured contact force, to compare --series with.")
@click.option("--case", "case_title", metavar="TITLE", help="Compare --series with the ranges of this case.")
@click.option("--speed", type=POSITIVE, metavar="V", help="Of series without times or positions, in km/h.")
@click.option("--spans", type=Spans(), metavar="FIRST:LAST", help="Spans to evaluate.  [default: of the case, or all]")
@click.option("--span", type=POSITIVE, default=60.0, show_default=True, metavar="L", help="Length of a span in m.")
@click.option(
    "--first-support", type=float, default=0.0, show_default=True, metavar="X", help="Where span 1 begins, m."
)
@click.option(
    "--pantograph",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    metavar="N",
    help="Which one, in files with several.",
)
@click.option(
    "--frf",
    type=FILE,
    metavar="FILE",
    help="Instead of our runs: a measured FRF of a pantograph (CSV "
    "or universal file, see `zspring identify`), to compare with that of --parameters.",
)
@click.option(
    "--frf-bands",
    type=Numbers(),
    default=(0.5, 5.0, 10.0, 20.0),
    metavar="LIST",
    help="Edges of the frequency bands in Hz.  [default: 0.5,5,10,20]",
)
@click.option(
    "--frf-force",
    type=click.Choice(["specimen", "contact"]),
    default="specimen",
    show_default=True,
    help="Measured force positive along the displacement, or pressing the head down.",
)
@click.option("--frf-amplitude", type=POSITIVE, metavar="A", help="Peak acceleration in m/s2, if --frf does not tell.")
@click.option(
    "--fixture-mass",
    type=click.FloatRange(min=0),
    default=0.0,
    show_default=True,
    metavar="M",
    help="What moves between load cell and head in the measured FRF, in kg.",
)
@click.option(
    "--direction",
    type=click.Choice(["up", "down", "rest"]),
    default="up",
    show_default=True,
    help="Of the sweep in the measured FRF.",
)
@parameters_option
@set_option
@output_option("results/en50318")
@fmu_option
@line_fmu_option
def en50318(
    edition_path,
    example,
    quick,
    head_speeds,
    jobs,
    series,
    line_test,
    case_title,
    speed,
    spans,
    span,
    first_support,
    pantograph,
    frf,
    frf_bands,
    frf_force,
    frf_amplitude,
    fixture_mass,
    direction,
    parameter_set,
    assignments,
    output,
    fmu_path,
    line_fmu,
) -> None:
    """Validate the simulation as EN 50318 does, and write a report.

    Without options: the reference case of EN 50318:2002 with its accepted ranges, what free choices do to it, the
    benchmark of 2015, and the linear against the Z-spring head of the DSA-380. Takes about a minute on two
    processors. Ctrl-C keeps all finished runs, and the same command goes on from there.

    With --series, --line-test or --frf: the same report on your own data. A series is a CSV with the columns
    contact force [N], time [s] and/or position [m], and perhaps wire height [m] and support uplift at X m [mm].

    Writes report.html, which needs no other file, and raw CSV and PNG files beside it.
    """
    if example:
        copy_examples(example, {"edition.toml": "en50318/example.toml"})
        return
    own = series or line_test or frf
    for name, given in ("--parameters", parameter_set), ("--set", assignments):
        if given and not frf:
            raise click.UsageError(f"{name} is for --frf")
    for name, given in ("--case", case_title), ("--spans", spans), ("--speed", speed):
        if given and not (series or line_test):
            raise click.UsageError(f"{name} is for --series and --line-test")
    from .edition import packaged_edition, read_edition  # matplotlib and scipy are slow to load

    paths = [edition_path] if edition_path else [packaged_edition(name) for name in EDITIONS]
    editions = [read_edition(path) for path in paths]
    with opened(fmu_path) as fmu, opened(line_fmu or installed_fmu(CATENARY)) as catenary, claimed(output):
        if not own:
            from .plan import HEAD_SPEEDS
            from .run import Plan, validate

            if quick:
                editions = [editions[0].only_first()]
            speeds = head_speeds or (() if quick or edition_path else HEAD_SPEEDS)
            plan = Plan(editions, not (quick or edition_path), speeds)
            validate(plan, catenary, fmu, output, jobs)
            return
        from ..bench.measured import Source
        from .own_data import OwnData, report_on

        source = frf and Source(frf, frf_amplitude, frf_force, fixture_mass)
        parameters = chosen_parameters(fmu, parameter_set, assignments) if frf else {}
        data = OwnData(
            series, line_test, editions[0], case_title, speed and speed / 3.6, spans, span, first_support, pantograph
        )
        report_on(data, source, parameters, frf_bands, direction, fmu, catenary, output, jobs)
