"""The command `zspring couple`."""

from __future__ import annotations

from pathlib import Path

import click

from ..draws import read_draws
from ..errors import ZSpringError
from ..fmu import CATENARY, installed_fmu
from ..line.journey import MASSES, START_UPS, Journey
from ..line.mean_force import STANDING, mean_force
from ..line.schemes import DRIVES, SCHEMES, Coupling
from ..line.system import System
from ..line_file.chosen import chosen_line
from ..options import (
    Spans,
    choice,
    draws_option,
    format_option,
    line_fmu_option,
    line_option,
    opened,
    option,
    output_option,
    pantograph_options,
)
from ..records import claimed

SET_HERE = ("travel", "pantograph[1].start", "pantograph[2].start")  # parameters of the catenary


@click.command()
@option("--speed", default=250.0, metavar="V", help="Speed in km/h.")
@line_option
@click.option(
    "--tension", type=float, nargs=2, metavar="CONTACT MESSENGER", help="Tension of contact wire and messenger in N."
)
@click.option(
    "--set-line",
    "line_assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a parameter of the catenary FMU, as --set does for the pantograph.",
)
@pantograph_options
@option("--pantographs", "count", default=1, kind=click.IntRange(1, 2), help="How many.")
@option("--spacing", default=100.0, metavar="D", help="Of the two, in m.")
@option("--uplift", metavar="F", help="Extra upward force on each pantograph in N.")
@choice(
    "--mean-force",
    "supply",
    of=STANDING,
    help="Choose the uplift of each pantograph so that its mean force over the evaluated spans is the target of the "
    "standards for this supply and speed, to 0.1 N, by as many runs as that takes. At low speeds the uplift may be "
    "negative.",
)
@choice(
    "--uplift-on",
    of=MASSES,
    default="upper_frame",
    help="Mass on which the uplift acts. Through the upper frame it loads the head suspension as the static "
    "force does, in two-mass models too.",
)
@option("--start", metavar="X", help="Of the first pantograph in m.  [default: half a span]")
@option("--stop", metavar="X", help="Where the first pantograph ends, in m.  [default: half a span before the end]")
@option(
    "--spans",
    kind=Spans(),
    metavar="FIRST:LAST",
    help="Spans to evaluate.  [default: the middle ones; where the far end reflects into them, the last two before]",
)
@choice(
    "--start-up",
    of=START_UPS,
    default="ramp",
    help="What static_force lifts the wire at the start is taken off the height that the pantographs see, and "
    "comes back over the first span (ramp) or never (direct).",
)
@choice(
    "--coupling",
    "scheme",
    of=SCHEMES,
    help="sequential: pantograph, then catenary, once a step, with the wire as an affine map of the force; forces "
    "and heights agree. parallel: the same side by side, as plain co-simulation tools step. implicit: they agree by "
    "Newton's method, with steps taken back. explicit: pantograph, then catenary, with an extrapolated wire. jacobi: "
    "both side by side with the last values.  [default: sequential; implicit with drive Force]",
)
@choice(
    "--drive", of=DRIVES, default="Wire", help="The pantograph solves the contact (Wire) or the master does (Force)."
)
@option("--step", default=1e-3, metavar="H", help="Communication step in s.")
@option("--tolerance", default=Coupling.tolerance, help="Of the contact force, implicit, as a share of static_force.")
@draws_option("the run")
@click.option("--compare-steps", is_flag=True, help="Tell what the coupling costs at 0.5, 1, 2 and 5 ms.")
@option(
    "--ssp",
    "ssp_path",
    kind=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.ssp",
    help="Write the system as an archive of SSP 1.0 instead of running it. Tools that exchange values once a "
    "step give with it what --coupling parallel --start-up direct gives.",
)
@click.option("--parquet", is_flag=True, help="Write the series as Parquet too.")
@output_option("results/couple")
@format_option
@line_fmu_option
def couple(pantograph, output, suffix, **given) -> None:
    """Run one or two pantographs along an overhead line: co-simulation of both FMUs.

    Writes line.csv with contact forces, heights, uplifts at the supports and friction moments, and a figure.
    After Ctrl-C the rows so far are kept.
    """
    from . import run  # matplotlib is slow to load
    from .draws import run_draws

    speed, uplift, supply, ssp_path = (given[name] for name in ("speed", "uplift", "supply", "ssp_path"))
    if uplift is not None and supply:
        raise ZSpringError(f"--uplift {uplift:g} and --mean-force {supply}: give one of them")
    given["scheme"] = given["scheme"] or ("sequential" if given["drive"] == "Wire" else "implicit")
    if ssp_path:
        if ssp_path.suffix.lower() != ".ssp":
            raise ZSpringError(f"--ssp {ssp_path}: must end in .ssp")
        given |= {"scheme": "parallel", "drive": "Wire", "start_up": "direct"}
    coupling = Coupling(given["scheme"], given["drive"], given["tolerance"])

    spans = given["spans"]
    with (
        opened(given["line_fmu"] or installed_fmu(CATENARY)) as catenary,
        pantograph.opened(("drive",)) as (fmu, parameters),
    ):
        chosen = chosen_line(given["line_set"], catenary, given["line_assignments"], SET_HERE)
        if given["tension"]:
            chosen.parameters.update(zip(("contact_wire.tension", "messenger.tension"), given["tension"]))
        where = {name: given[name] for name in ("start", "stop", "step", "spacing", "start_up", "uplift_on")}
        journey = Journey(speed / 3.6, uplift=uplift or 0.0, **where)
        system = System(chosen.catenary, fmu, chosen.parameters, [parameters] * given["count"], journey, coupling)
        aim = run.Aim(mean_force(supply, speed), f"{supply} at {speed:g} km/h", spans) if supply else None
        if ssp_path:
            run.export_ssp(run.aimed(system, aim) if aim else system, ssp_path)
            return
        own_line = "the FMU's own" if given["line_fmu"] else "EN 50318:2002 (the FMU's own)"
        own_head = "the FMU's own" if pantograph.fmu_path else "DSA-380 (the FMU's own)"
        head = Path(pantograph.parameter_set).stem if pantograph.parameter_set else own_head
        what = f"Line {chosen.name or own_line}, pantograph {head}"
        with claimed(output):
            if given["compare_steps"]:
                run.compare_and_write(run.aimed(system, aim) if aim else system, output, suffix, what)
            elif given["draws_path"]:
                draws = read_draws(given["draws_path"], fmu, ("drive",), pantograph.assignments)
                aimed = run.aimed(system, aim) if aim else system
                run_draws(aimed, draws, given["draws_path"], output, suffix, spans, what)
            else:
                run.run_and_write(system, output, suffix, given["parquet"], aim, spans, what)
