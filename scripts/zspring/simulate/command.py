"""The command `zspring simulate`."""

from __future__ import annotations

from dataclasses import replace

import click

from ..options import FILE, choice, format_option, option, output_option, pantograph_options
from ..records import claimed
from .inputs import read_inputs


@click.command()
@option(
    "--drive",
    kind=str,
    help="What moves the head, as --set drive=...: Force, Displacement, Wire or Bench.  [default: Force]",
)
@pantograph_options
@option(
    "--input",
    "input_path",
    kind=FILE,
    metavar="FILE.csv",
    help="Inputs over time: a column 'time [s]' and columns named after inputs, as 'wire_height [mm]'.  "
    "[default: all inputs keep their start values]",
)
@choice(
    "--interpolation",
    of=["linear", "cubic"],
    default="linear",
    help="Between the rows of the inputs. Use cubic for measured positions: corners are jumps in "
    "velocity, and the contact force shows them.",
)
@option(
    "--stop",
    "stop_time",
    metavar="T",
    help="Stop time in s.  [default: where the inputs end; without inputs that of the FMU]",
)
@option("--step", metavar="H", help="Communication step in s.  [default: that of the FMU]")
@click.option(
    "--error-estimate",
    is_flag=True,
    help="Run at half the internal step, too, and estimate what it costs each output; more than 1 % of the output's "
    "range (rms) is warned of. What the communication step and the inputs' rows cost is not in it.",
)
@output_option("results/simulation")
@format_option
def simulate(pantograph, drive, input_path, interpolation, stop_time, step, error_estimate, output, suffix) -> None:
    """Simulate any drive with inputs from a CSV file.

    Times may begin anywhere, as seconds since 1970 do. Writes simulation.csv with all outputs, a figure, and with
    --error-estimate errors.csv. After Ctrl-C the rows so far are kept.
    """
    from .run import plan  # matplotlib is slow to load
    from .run import simulate as run_simulation

    if drive:
        pantograph = replace(pantograph, assignments=[*pantograph.assignments, f"drive={drive}"])
    with pantograph.opened() as (fmu, parameters), claimed(output):
        inputs = read_inputs(input_path, fmu.variables) if input_path else None
        experiment = fmu.description.defaultExperiment
        default = float(experiment.stopTime), float(experiment.stepSize)
        course = plan(inputs, interpolation, stop_time, step, default)
        source = input_path.name if input_path else ""
        run_simulation(fmu, parameters, inputs, course, output, suffix, error_estimate, source)
