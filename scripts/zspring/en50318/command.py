"""The command `zspring en50318`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from ..bench.conditions import DIRECTIONS
from ..fmu import CATENARY, installed_fmu
from ..line.mean_force import STANDING
from ..line_file.chosen import line_of
from ..options import (
    FILE,
    NOT_NEGATIVE,
    POSITIVE,
    Band,
    Spans,
    choice,
    copy_examples,
    data_sets_option,
    jobs_option,
    line_fmu_option,
    numbers,
    opened,
    option,
    output_option,
    pantograph_options,
)
from ..records import claimed

EDITIONS = ("en-50318-2002", "benchmark-2015")


@click.command()
@option(
    "--edition",
    "edition_path",
    kind=FILE,
    metavar="FILE.toml",
    help="Run these cases and compare with their accepted ranges, instead of all else.",
)
@option(
    "--example",
    kind=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Only write an empty file for --edition into this folder, which explains all keys: for the numbers of "
    "EN 50318:2018, which are not public.",
)
@click.option("--quick", is_flag=True, help="The first reference case alone, to try it out.")
@numbers("--head-speeds", None, "Speeds in km/h at which the heads are compared.  [default: 200:350:25]")
@jobs_option("Runs at a time.")
@option("--series", kind=FILE, metavar="FILE.csv", help="Instead of our runs: a contact force to evaluate.")
@option("--line-test", kind=FILE, metavar="FILE.csv", help="A measured contact force, to compare --series with.")
@option("--case", "case_title", kind=str, metavar="TITLE", help="Compare --series with the ranges of this case.")
@numbers("--speed", None, "Speeds in km/h: of our runs on --line; one alone of series without times or positions.")
@option(
    "--line",
    "line_set",
    kind=str,
    metavar="NAME|FILE",
    help="Your own line, a set (`zspring info --sets`), an SSV file of SSP, or a line file of `zspring line`: runs of "
    "the pantograph of --parameters along it at each --speed, beside the reference cases and not judged by their "
    "ranges. With --series or --line-test: the line whose spans are meant.",
)
@choice(
    "--mean-force",
    "supply",
    of=STANDING,
    help="On --line: choose the uplift of each pantograph so that its mean force over the evaluated spans is the "
    "target for this supply and speed, to 0.1 N.  [default: static_force is the force]",
)
@option("--spacing", kind=POSITIVE, metavar="D", help="On --line: two pantographs, D m apart.")
@click.option(
    "--spans",
    type=Spans(),
    multiple=True,
    metavar="FIRST:LAST",
    help="Spans to evaluate; of series, repeat it for each tension section.  [default: of the case, or all; on --line "
    "the middle ones, or the last two before the far end is felt]",
)
@click.option(
    "--band",
    "bands",
    type=Band(),
    multiple=True,
    metavar="LOW:HIGH",
    help="Tell the standard deviation of this frequency band in Hz, too; repeatable. Those of 0-2, 0-5, 5-20 and "
    "0-20 Hz are told anyway.",
)
@click.option(
    "--point",
    "points",
    type=POSITIVE,
    multiple=True,
    metavar="X",
    help="Tell the largest uplift of the contact wire X m along the line, too; repeatable. At supports and mid-span it "
    "is told anyway.",
)
@option("--span", kind=POSITIVE, metavar="L", help="Length of a span in m.  [default: of the file's head or the case]")
@option(
    "--first-support", metavar="X", help="Where span 1 begins in files whose head does not say it, m.  [default: 0]"
)
@click.option(
    "--turn-force",
    type=click.Choice(["series", "line-test"]),
    multiple=True,
    help="In this file forces that press the head down are negative: take them with the other sign.",
)
@option(
    "--pantograph",
    "number",
    default=1,
    kind=click.IntRange(min=1),
    metavar="N",
    help="Which one, of files with several.",
)
@option(
    "--frf",
    kind=FILE,
    metavar="FILE",
    help="Instead of our runs: a measured FRF of a pantograph (CSV "
    "or universal file, see `zspring identify`), to compare with that of --parameters.",
)
@numbers("--frf-bands", (0.5, 5.0, 10.0, 20.0), "Edges of the frequency bands in Hz.  [default: 0.5,5,10,20]")
@choice(
    "--frf-force",
    of=["specimen", "contact"],
    default="specimen",
    help="Measured force positive along the displacement, or pressing the head down.",
)
@data_sets_option("--frf-data-sets")
@option("--frf-amplitude", kind=POSITIVE, metavar="A", help="Peak acceleration in m/s2, if --frf does not tell.")
@option(
    "--fixture-mass",
    default=0.0,
    kind=NOT_NEGATIVE,
    metavar="M",
    help="What moves between load cell and head in the measured FRF, in kg.",
)
@choice(
    "--direction",
    of=DIRECTIONS,
    help="Of the sweep in the measured FRF.  [default: as the head of the file says, else in its order]",
)
@pantograph_options
@output_option(described="results/en50318, for own data with the names of the files")
@line_fmu_option
def en50318(pantograph, edition_path, quick, series, line_test, frf, jobs, output, **given) -> None:
    """Validate the simulation as EN 50318 does, and write a report.

    Without options: the reference case of EN 50318:2002 with its accepted ranges, what free choices do to it, the
    benchmark of 2015, and the linear against the Z-spring head of the DSA-380. Takes two to three minutes on two
    processors. Ctrl-C keeps all finished runs, and the same command goes on from there.

    With --parameters or --set: this pantograph on the lines of the reference cases and of the benchmark, counted
    apart from the reference pantograph. With --line: on this line instead, beside the first reference cases.

    With --series, --line-test or --frf: the same report on your own data. A series is a CSV with the columns
    contact force [N], time [s] and/or position [m], and perhaps wire height [m] and support uplift at X m [mm]. Lines
    before them may say "# span: 55 m", "# first support: 0 m", "# speed: 250 km/h".

    Writes report.html, which needs no other file, and raw CSV and PNG files beside it.
    """
    if given["example"]:
        copy_examples(given["example"], {"edition.toml": "en50318/example.toml"})
        return
    own = series or line_test or frf
    own_pantograph = bool(pantograph.parameter_set or pantograph.assignments)
    if own_pantograph and own and not frf:
        raise click.UsageError("--parameters and --set are for --frf and for our runs: a series has its own pantograph")
    _refuse_what_does_not_fit(given, bool(series or line_test), own)
    if output is None:
        output = Path("results", "-".join(["en50318", *(path.stem for path in (series, line_test, frf) if path)]))
    from ..line.quantities import band_figure, point_figure
    from .edition import packaged_edition, read_edition  # matplotlib and scipy are slow to load

    paths = [edition_path] if edition_path else [packaged_edition(name) for name in EDITIONS]
    further = [*(band_figure(*band) for band in given["bands"]), *map(point_figure, given["points"])]
    editions = [read_edition(path).with_figures(further) for path in paths]
    with (
        pantograph.opened(("drive",)) as (fmu, parameters),
        opened(given["line_fmu"] or installed_fmu(CATENARY)) as catenary,
        claimed(output),
    ):
        if not own:
            from .own_pair import OwnPair
            from .own_pantograph import OwnPantograph, name_of
            from .plan import HEAD_SPEEDS
            from .run import Plan, validate

            if quick:
                editions = [editions[0].only_first()]
            few = quick or edition_path or own_pantograph or given["line_set"]
            speeds = given["head_speeds"] or (() if few else HEAD_SPEEDS)
            name = name_of(pantograph.parameter_set, pantograph.assignments)
            plan = Plan(editions, not few, speeds)
            if given["line_set"]:
                pair = OwnPair(
                    line=line_of(given["line_set"], catenary),
                    pantograph_name=name,
                    pantograph=parameters,
                    speeds=given["speed"],
                    spacing=given["spacing"],
                    supply=given["supply"] or "",
                    spans=next(iter(given["spans"]), None),
                    figures=further,
                )
                plan = replace(plan, editions=editions[:1], pair=pair)
            elif own_pantograph:
                plan = replace(plan, own=OwnPantograph(name, parameters))
            validate(plan, catenary, fmu, output, jobs)
            return
        from ..bench.curves import Source
        from .own_data import OwnData, report_on

        source = frf and Source(
            frf, given["frf_amplitude"], given["frf_force"], given["fixture_mass"], given["frf_data_sets"]
        )
        data = OwnData(
            series,
            line_test,
            editions[0],
            given["case_title"],
            speed=given["speed"][0] / 3.6 if given["speed"] else None,
            spans=given["spans"],
            span=given["span"],
            first_support=given["first_support"],
            line=line_of(given["line_set"], catenary) if given["line_set"] else None,
            pantograph=given["number"],
            turned=given["turn_force"],
            further=further,
        )
        bands, direction = given["frf_bands"], given["direction"]
        report_on(data, source, parameters, bands, direction, fmu, catenary, output, jobs)


def _refuse_what_does_not_fit(given: Mapping[str, Any], has_series: bool, own: Any) -> None:
    """Raises UsageError for options of runs, of series or of a line without these, or for too many of their values."""

    def told(name: str) -> bool:
        return given[name] not in (None, ())

    def option_of(name: str) -> str:
        return "--" + {"case_title": "case", "supply": "mean-force", "line_set": "line"}.get(
            name, name.replace("_", "-")
        )

    line = told("line_set")
    for name in "case_title", "span", "first_support", "turn_force":
        if told(name) and not has_series:
            raise click.UsageError(f"{option_of(name)} is for --series and --line-test")
    for name in "speed", "spans":
        if told(name) and not (has_series or line):
            raise click.UsageError(f"{option_of(name)} is for --series, --line-test and --line")
        if told(name) and len(given[name]) > 1 and (has_series if name == "speed" else not has_series):
            raise click.UsageError(f"{option_of(name)}: {len(given[name])} values: must be one")
    for name in "spacing", "supply":
        if told(name) and (not line or own):
            raise click.UsageError(f"{option_of(name)} is for our runs on --line; an edition's cases say it themselves")
    if line and own and not has_series:
        raise click.UsageError("--line is for our runs, --series and --line-test")
    if line and not own and not told("speed"):
        raise click.UsageError("--line: needs --speed, in km/h")
