"""The command `zspring couple`."""

from __future__ import annotations

from pathlib import Path

import click

from ..errors import ZSpringError
from ..fmu import CATENARY, installed_fmu
from ..line.journey import MASSES, START_UPS, Journey, parameter_value
from ..line.mean_force import STANDING, mean_force
from ..line.schemes import DRIVES, SCHEMES, Coupling
from ..line.system import System
from ..options import (
    chosen_parameters,
    format_option,
    line_fmu_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from ..parameter_sets import LINES
from ..records import claimed

SET_HERE = ("travel", "pantograph[1].start", "pantograph[2].start")  # parameters of the catenary


@click.command()
@click.option("--speed", type=float, default=250.0, show_default=True, metavar="V", help="Speed in km/h.")
@click.option(
    "--line",
    "line_set",
    metavar="NAME|FILE",
    help="Set the parameters of the line: the name of a set (`zspring info --sets` lists them) or an SSV file "
    "of SSP 1.0.  [default: the catenary FMU's own, EN 50318:2002]",
)
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
@parameters_option
@set_option
@click.option("--pantographs", "count", type=click.IntRange(1, 2), default=1, show_default=True, help="How many.")
@click.option("--spacing", type=float, default=100.0, show_default=True, metavar="D", help="Of the two, in m.")
@click.option("--uplift", type=float, metavar="F", help="Extra upward force on each pantograph in N.")
@click.option(
    "--mean-force",
    "supply",
    type=click.Choice(list(STANDING)),
    help="Choose the uplift so that static_force and uplift together are the target mean force of the "
    "standards for this supply and speed. At low speeds the uplift may be negative.",
)
@click.option(
    "--uplift-on",
    type=click.Choice(MASSES),
    default="upper_frame",
    show_default=True,
    help="Mass on which the uplift acts. Through the upper frame it loads the head suspension as the static "
    "force does, in two-mass models too.",
)
@click.option("--start", type=float, metavar="X", help="Of the first pantograph in m.  [default: half a span]")
@click.option(
    "--stop",
    type=float,
    metavar="X",
    help="Where the first pantograph ends, in m.  [default: half a span before the end]",
)
@click.option(
    "--start-up",
    type=click.Choice(START_UPS),
    default="ramp",
    show_default=True,
    help="What static_force lifts the wire at the start is taken off the height that the pantographs see, and "
    "comes back over the first span (ramp) or never (direct).",
)
@click.option(
    "--coupling",
    "scheme",
    type=click.Choice(SCHEMES),
    default="implicit",
    show_default=True,
    help="implicit: forces and heights at the end of each step agree, by Newton's method. explicit: "
    "pantograph, then catenary, once a step (Gauss-Seidel). jacobi: both side by side with the last values, "
    "as plain co-simulation tools do.",
)
@click.option(
    "--drive",
    type=click.Choice(DRIVES),
    default="Wire",
    show_default=True,
    help="The pantograph solves the contact (Wire) or the master does (Force).",
)
@click.option("--step", type=float, default=1e-3, show_default=True, metavar="H", help="Communication step in s.")
@click.option("--tolerance", type=float, help="Of the contact force, implicit, as a share of static_force.")
@click.option("--compare-steps", is_flag=True, help="Tell what the coupling costs at 0.5, 1, 2 and 5 ms.")
@click.option(
    "--ssp",
    "ssp_path",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.ssp",
    help="Write the system as an archive of SSP 1.0 instead of running it. Tools that exchange values once a "
    "step give with it what --coupling jacobi --start-up direct gives.",
)
@click.option("--parquet", is_flag=True, help="Write the series as Parquet too.")
@output_option("results/couple")
@format_option
@click.option("--fmu", "fmu_path", type=click.Path(path_type=Path), metavar="FILE", help="Of the pantograph.")
@line_fmu_option
def couple(
    speed,
    line_set,
    tension,
    line_assignments,
    parameter_set,
    assignments,
    count,
    spacing,
    uplift,
    supply,
    uplift_on,
    start,
    stop,
    start_up,
    scheme,
    drive,
    step,
    tolerance,
    compare_steps,
    ssp_path,
    parquet,
    output,
    suffix,
    fmu_path,
    line_fmu,
) -> None:
    """Run one or two pantographs along an overhead line: co-simulation of both FMUs.

    Writes line.csv with contact forces, heights, uplifts at the supports and friction moments, and a figure.
    After Ctrl-C the rows so far are kept.
    """
    from . import run  # matplotlib is slow to load

    if uplift is not None and supply:
        raise ZSpringError(f"--uplift {uplift:g} and --mean-force {supply}: give one of them")
    if ssp_path:
        scheme, drive, start_up = "jacobi", "Wire", "direct"
    coupling = Coupling(scheme, drive, **({} if tolerance is None else {"tolerance": tolerance}))

    with opened(line_fmu or installed_fmu(CATENARY)) as catenary, opened(fmu_path) as pantograph:
        line = chosen_parameters(catenary, line_set, line_assignments, SET_HERE, LINES)
        if tension:
            line |= dict(zip(("contact_wire.tension", "messenger.tension"), tension))
        parameters = chosen_parameters(pantograph, parameter_set, assignments, ("drive",))
        if supply:
            uplift = mean_force(supply, speed) - parameter_value(pantograph, parameters, "static_force")
        journey = Journey(speed / 3.6, start, stop, step, spacing, start_up, uplift or 0.0, uplift_on)
        system = System(catenary, pantograph, line, [parameters] * count, journey, coupling)
        if ssp_path:
            run.export_ssp(system, ssp_path)
            return
        with claimed(output):
            if compare_steps:
                run.compare_and_write(system, output, suffix)
            else:
                run.run_and_write(system, output, suffix, parquet)
