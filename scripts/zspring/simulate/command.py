"""The command `zspring simulate`."""

from __future__ import annotations

from pathlib import Path

import click

from ..options import chosen_parameters, fmu_option, format_option, opened, output_option, parameters_option, set_option
from ..records import claimed
from .inputs import read_inputs


@click.command()
@click.option(
    "--drive", help="What moves the head, as --set drive=...: Force, Displacement, Wire or Bench.  [default: Force]"
)
@parameters_option
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
@output_option("results/simulation")
@format_option
@fmu_option
def simulate(
    drive, parameter_set, assignments, input_path, interpolation, stop_time, step, output, suffix, fmu_path
) -> None:
    """Simulate any drive with inputs from a CSV file.

    Writes simulation.csv with all outputs, and a figure. After Ctrl-C the rows so far are kept.
    """
    from .run import simulate as run_simulation  # matplotlib is slow to load

    with opened(fmu_path) as fmu, claimed(output):
        assignments = [*assignments, *([f"drive={drive}"] if drive else [])]
        parameters = chosen_parameters(fmu, parameter_set, assignments)
        inputs = read_inputs(input_path, fmu.variables) if input_path else None
        run_simulation(fmu, parameters, inputs, interpolation, stop_time, step, output, suffix)
