"""The command `zspring`."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from .errors import ZSpringError
from .fmu import Fmu
from .frf import BENCH_PARAMETERS, BENCHES, LOOK_PERIODS, FrfSettings
from .frf_run import default_folder, run_frf
from .info import variable_table
from .inputs import read_inputs
from .interrupt import Interrupted
from .results import QUANTITIES
from .simulate import simulate as run_simulation

STANDARD = FrfSettings()
MOST_NUMBERS = 100_000


class Numbers(click.ParamType):
    """Positive numbers and ranges START:STOP:STEP between commas or blanks; sorted, without doubles."""

    name = "numbers"

    def convert(self, value, param, ctx) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        numbers = {
            number for part in value.replace(",", " ").split() for number in self._part(part, param, ctx)
        }
        return tuple(sorted(numbers)) or self.fail("needs at least one number", param, ctx)

    def _part(self, part: str, param, ctx) -> list[float]:
        try:
            values = [float(text) for text in part.split(":")]
        except ValueError:
            values = []
        if len(values) not in (1, 3) or not all(math.isfinite(value) and value > 0 for value in values):
            self.fail(f"{part!r}: must be a positive number or START:STOP:STEP", param, ctx)
        if len(values) == 1:
            return values
        start, stop, step = values
        if stop < start:
            self.fail(f"{part!r}: STOP must not be below START", param, ctx)
        if stop - start > MOST_NUMBERS * step:
            self.fail(f"{part!r}: more than {MOST_NUMBERS} numbers", param, ctx)
        return [round(start + i * step, 12) for i in range(math.floor((stop - start) / step + 1e-9) + 1)]


fmu_option = click.option(
    "--fmu",
    "fmu_path",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Use this FMU instead of the one in the package.",
)
set_option = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a parameter of the FMU, in its unit or by the name of an enumeration's item; repeatable. "
    "`zspring info` lists them.",
)
format_option = click.option(
    "--format",
    "suffix",
    type=click.Choice(["png", "svg"]),
    default="png",
    show_default=True,
    help="Format of the figure.",
)


@contextmanager
def opened(path: Path | None) -> Iterator[Fmu]:
    """The FMU for one command, which tells at its end what the FMU warned of."""
    with Fmu(path) as fmu:
        yield fmu
        for warning in fmu.warnings:
            print(f"the FMU warns: {warning}", file=sys.stderr)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="zspring")
def commands() -> None:
    """DSA-380 pantograph with Z-spring head suspension, as an FMI 2.0 co-simulation FMU."""


@commands.command()
@click.option(
    "--amplitudes",
    type=Numbers(),
    default=STANDARD.amplitudes,
    metavar="LIST",
    help="Peak accelerations of the imposed sine in m/s2, e.g. 0.25,4.  [default: 0.25,0.5,1,2,4,8]",
)
@click.option(
    "--frequencies",
    type=Numbers(),
    default=STANDARD.frequencies,
    metavar="LIST",
    help="In Hz: numbers and ranges START:STOP:STEP, e.g. 1,2,3:13:0.1.  [default: 0.5:20:0.25]",
)
@click.option(
    "--direction",
    type=click.Choice(["up", "down", "rest"]),
    default=STANDARD.direction,
    show_default=True,
    help="Sweep the frequency up or down without stopping, or begin each point in the static state.",
)
@set_option
@click.option(
    "--quantity",
    type=click.Choice(list(QUANTITIES)),
    default="receptance",
    show_default=True,
    help="What to draw: receptance H = -Z/F or dynamic stiffness 1/H.",
)
@click.option(
    "--output",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Folder of the results.  [default: results/frf-FRICTION-DIRECTION, and a code for the "
    "settings where they differ from the standard figure's]",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0, min_open=True),
    default=STANDARD.tolerance,
    show_default=True,
    help="A point is settled when H differs by no more than this, relatively, from the period before "
    f"and from {LOOK_PERIODS} periods before.",
)
@click.option(
    "--min-periods",
    type=click.IntRange(min=1),
    default=STANDARD.min_periods,
    show_default=True,
    help="Fewest periods of a point, not counting the ramp to it.",
)
@click.option(
    "--max-periods",
    type=click.IntRange(min=2 * LOOK_PERIODS),
    default=STANDARD.max_periods,
    show_default=True,
    help="Most periods of a point; it is marked if it has not settled by then.",
)
@click.option(
    "--stroke",
    type=click.FloatRange(min=0, min_open=True),
    default=STANDARD.stroke,
    show_default=True,
    help="Largest displacement peak in m; points that need more are left out and marked.",
)
@click.option(
    "--through",
    type=click.Choice(list(BENCHES)),
    default=STANDARD.through,
    show_default=True,
    help="Use the FMU's own bench, or command the head step by step from outside (slower).",
)
@click.option(
    "--error-estimate",
    is_flag=True,
    help="Measure at half the internal step, too, and estimate the error of H from both.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Sweeps at a time (amplitudes; single points from rest).  [default: number of processors]",
)
@format_option
@fmu_option
def frf(
    amplitudes,
    frequencies,
    direction,
    assignments,
    quantity,
    output,
    tolerance,
    min_periods,
    max_periods,
    stroke,
    through,
    error_estimate,
    jobs,
    suffix,
    fmu_path,
) -> None:
    """Measure the first-order FRF by stepped sine with controlled response.

    Without options: the standard figure. Writes frf.csv and frf.png, and prints resonances and
    antiresonances.

    Ctrl-C keeps all finished points, and the same command goes on from there. With other settings in the same
    folder the measurement begins anew.
    """
    if max_periods < min_periods:
        raise click.BadParameter(
            f"{max_periods}: must not be below --min-periods {min_periods}", param_hint="--max-periods"
        )
    with opened(fmu_path) as fmu:
        parameters = fmu.variables.parse_assignments(assignments, but_not=BENCH_PARAMETERS)
        settings = FrfSettings(
            amplitudes,
            frequencies,
            parameters,
            direction,
            through,
            tolerance,
            min_periods,
            max_periods,
            stroke,
        )
        run_frf(
            fmu,
            settings,
            output or default_folder(fmu, settings),
            quantity,
            suffix,
            jobs or os.cpu_count() or 1,
            error_estimate,
        )


@commands.command()
@click.option("--drive", help="What moves the head, as --set drive=...: Force, Displacement, Wire or Bench.")
@set_option
@click.option(
    "--input",
    "input_path",
    type=click.Path(path_type=Path),
    metavar="FILE.csv",
    help="Inputs over time: a column 'time [s]' and columns named after inputs, as 'wire_height [mm]'.  "
    "[default: all inputs keep their start values]",
)
@click.option(
    "--interpolation",
    type=click.Choice(["linear", "cubic"]),
    default="linear",
    show_default=True,
    help="Between the rows of the inputs. Use cubic for measured positions: corners are jumps in "
    "velocity, and the contact force shows them.",
)
@click.option(
    "--stop",
    "stop_time",
    type=float,
    metavar="T",
    help="Stop time in s.  [default: where the inputs end; without inputs that of the FMU]",
)
@click.option("--step", type=float, metavar="H", help="Communication step in s.  [default: that of the FMU]")
@click.option(
    "--output",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("results/simulation"),
    show_default=True,
    metavar="DIR",
    help="Folder of the results.",
)
@format_option
@fmu_option
def simulate(
    drive, assignments, input_path, interpolation, stop_time, step, output, suffix, fmu_path
) -> None:
    """Simulate any drive with inputs from a CSV file.

    Writes simulation.csv with all outputs, and a figure. After Ctrl-C the rows so far are kept.
    """
    with opened(fmu_path) as fmu:
        parameters = fmu.variables.parse_assignments([*assignments, *([f"drive={drive}"] if drive else [])])
        inputs = read_inputs(input_path, fmu.variables) if input_path else None
        run_simulation(fmu, parameters, inputs, interpolation, stop_time, step, output, suffix)


@commands.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--path", "only_path", is_flag=True, help="Print only where the FMU is.")
@fmu_option
def info(names, only_path, fmu_path) -> None:
    """List the FMU's variables, or those with these NAMEs (zspring.* for all that begin so).

    `cp $(zspring info --path) .` copies the FMU for use in another tool.
    """
    with opened(fmu_path) as fmu:
        if only_path:
            print(fmu.path.absolute())
            return
        print(*variable_table(fmu.variables, names), sep="\n")


def main() -> int:
    """Run the command line; returns 0 (fine), 1 (failure, one line on stderr) or 130 (interrupted)."""
    try:
        return commands.main(standalone_mode=False) or 0
    except click.ClickException as error:
        message, status = error.format_message(), 1
    except ZSpringError as error:
        message, status = str(error), 1
    except OSError as error:
        message, status = f"{error.filename}: {error.strerror}" if error.filename else str(error), 1
    except Interrupted as error:
        message, status = str(error), 130
    except (click.Abort, KeyboardInterrupt):
        message, status = "interrupted", 130
    print(f"zspring: {message}", file=sys.stderr)
    return status
