"""A simulation with any drive: inputs from a file, all outputs to a CSV and a plot."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu, Instance
from ..heads import file_head, synthetic_note
from ..interrupt import Interrupted, stop_on_interrupt
from ..tables import TableFile
from ..variables import Value, text
from .inputs import interpolate
from .plot import simulation_figure

DRIVEN_BY = {"Force": "contact_force", "Displacement": "head_displacement", "Wire": "wire_height", "Bench": None}

Inputs = tuple[np.ndarray, Mapping[str, np.ndarray]]  # time (n,) in s, values (n,) by name


def simulate(
    fmu: Fmu,
    parameters: Mapping[str, Value],
    inputs: Inputs | None,
    interpolation: str,
    stop_time: float | None,
    step: float | None,
    folder: Path,
    suffix: str,
) -> None:
    """Simulate and write simulation.csv and the figure simulation.<suffix> into the folder.

    inputs          None: all inputs keep their start values
    interpolation   between the rows of the inputs: "linear" or "cubic"
    stop_time       in s; None: where the inputs end, else the FMU's default experiment
    step            communication step in s; None: that of the default experiment
    Raises Interrupted after Ctrl-C (the rows so far are kept) and FmuError when the FMU refuses something.
    """
    experiment = fmu.description.defaultExperiment
    step = float(experiment.stepSize) if step is None else step
    start_time = inputs[0][0] if inputs else 0.0
    if stop_time is None:
        stop_time = inputs[0][-1] if inputs else float(experiment.stopTime)
    if inputs and stop_time > inputs[0][-1]:
        raise ZSpringError(f"--stop {stop_time:g} s: the input file ends at {inputs[0][-1]:g} s")
    if not (0 < step < math.inf and start_time < stop_time < math.inf):
        raise ZSpringError(
            f"from {start_time:g} s to {stop_time:g} s by {step:g} s: the stop must be above the start and "
            "the step above 0, both finite"
        )

    # The last step is shorter where the duration is no multiple of the step.
    count = int(np.ceil((stop_time - start_time) / step * (1 - 1e-12)))
    times = np.append(start_time + step * np.arange(count), stop_time)
    outputs = fmu.variables.names("output")
    path, rows = folder / "simulation.csv", []
    with fmu.instances() as (instance,), ExitStack() as stack:
        feed = _Feed(instance, inputs, times, interpolation)
        instance.start(parameters, feed.values(0), start_time)
        used = instance.used_parameters()
        drive = text(fmu.variables["drive"], used["drive"])
        for name in set(DRIVEN_BY.values()) & set(inputs[1] if inputs else ()) - {DRIVEN_BY[drive]}:
            print(f"{name}: has no effect with drive {drive}; see --drive", file=sys.stderr)
        table = TableFile(path, ["time [s]", *(_label(fmu, name) for name in outputs)], digits=12)
        table.begin(file_head(fmu, used))
        stack.enter_context(table)
        stop = stack.enter_context(stop_on_interrupt())
        for i in tqdm(range(count + 1), unit=" steps", disable=None):
            if i > 0:
                feed.hand_over(i - 1)
                instance.step(times[i - 1], times[i] - times[i - 1])
            rows.append([float(times[i]), *instance.get(outputs)])
            table.write(rows[-1])
            if stop.is_set():
                raise Interrupted(
                    f"interrupted at {times[i]:g} s; the rows so far are kept in {path}; the same command begins anew"
                )

    title = f"Pantograph, drive {drive}{synthetic_note(fmu, used)}"
    columns = dict(zip(["time", *outputs], np.array(rows, dtype=float).T))
    figure_path = folder / f"simulation.{suffix}"
    save(simulation_figure(columns, used["zspring.Mf"], title), figure_path)
    print(f"{count} communication steps from {start_time:g} s to {stop_time:g} s")
    print(f"written: {path} {figure_path}")


class _Feed:
    """Hands the inputs over: at each communication point the value, and the slope to that at the next one."""

    def __init__(self, instance: Instance, inputs: Inputs | None, points: np.ndarray, kind: str):
        self._instance = instance
        time, columns = inputs or (points, {})
        self._values = {name: interpolate(time, column, points, kind) for name, column in columns.items()}
        self._slopes = {name: np.diff(values) / np.diff(points) for name, values in self._values.items()}

    def values(self, i: int) -> dict[str, float]:
        """All inputs at communication point i."""
        return {name: float(values[i]) for name, values in self._values.items()}

    def hand_over(self, i: int) -> None:
        """Set the inputs for the step that begins at communication point i."""
        self._instance.set(self.values(i))
        self._instance.set_slopes({name: float(slopes[i]) for name, slopes in self._slopes.items()})


def _label(fmu: Fmu, name: str) -> str:
    unit = fmu.variables[name].unit
    return f"{name} [{unit}]" if unit else name
