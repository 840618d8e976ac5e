"""A simulation with any drive: inputs from a file, all outputs to a CSV and a plot."""

from __future__ import annotations

import hashlib
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu, Instance
from ..heads import file_head, synthetic_note
from ..interrupt import Interrupted, stop_on_interrupt
from ..records import keep_others
from ..tables import TableFile, write_table
from ..variables import Value, parse, text
from . import estimate
from .inputs import Inputs, interpolate
from .plot import PANELS, simulation_figure

DRIVEN_BY = {"Force": "contact_force", "Displacement": "head_displacement", "Wire": "wire_height", "Bench": None}
MOST_STEPS = 10_000_000  # rows of simulation.csv, of some 300 characters each


@dataclass(frozen=True)
class Course:
    """Communication points, and what the inputs are there and how they go on to the next."""

    times: np.ndarray  # (n,) s since the start
    start: Decimal  # s, what times are counted from in files and figures
    values: Mapping[str, np.ndarray]  # (n,) by name of the input
    slopes: Mapping[str, np.ndarray]  # (n - 1,), 1/s

    def at(self, i: int) -> dict[str, float]:
        """The inputs at communication point i."""
        return {name: float(values[i]) for name, values in self.values.items()}

    def described(self, source: str) -> dict[str, str]:
        """All of it as text, by key; `source` names what the inputs come from."""
        last, first_step = len(self.times) - 1, float(self.times[1] - self.times[0])
        head = {"times": f"{self.time_text(0)} to {self.time_text(last)} s by {first_step:.12g} s"}
        if self.values:
            content = b"".join(name.encode() + values.tobytes() for name, values in sorted(self.values.items()))
            head |= {"inputs": source, "SHA-256 of the inputs": hashlib.sha256(content).hexdigest()}
        return head

    def time_text(self, i: int) -> str:
        """The time of communication point i as the input counts it; no two are alike."""
        time = f"{self.times[i]:.15g}"
        return f"{(self.start + Decimal(time)).normalize():f}" if self.start else time


def plan(
    inputs: Inputs | None, interpolation: str, stop: float | None, step: float | None, experiment: tuple[float, float]
) -> Course:
    """The course of a run to `stop` s, as the inputs count time, by steps of `step` s; for None, to the inputs' end.

    interpolation   between the rows of the inputs: "linear" or "cubic"
    experiment      stop time and step of the FMU's default experiment, where neither inputs nor options have one
    Raises ZSpringError for times that are no run.
    """
    step = experiment[1] if step is None else step
    start = inputs.start if inputs else Decimal(0)
    end = float(inputs.time[-1]) if inputs else experiment[0]
    if stop is None:
        duration = end
    else:
        duration = inputs.since_start(stop) if inputs and math.isfinite(stop) else stop
        if inputs and end < duration < math.inf:
            raise ZSpringError(f"--stop {stop:.15g} s: the input file ends at {float(start) + end:.15g} s")
    if not (0 < step < math.inf and 0 < duration < math.inf):
        raise ZSpringError(
            f"from {float(start):.15g} s to {end if stop is None else stop:.15g} s by {step:g} s: the stop must be "
            "above the start and the step above 0, both finite"
        )
    # The last step is shorter where the duration is no multiple of the step.
    steps = duration / step * (1 - 1e-12)
    if steps > MOST_STEPS:
        raise ZSpringError(
            f"{duration:g} s by steps of {step:g} s: {steps:.3g} communication steps: must be at most {MOST_STEPS:g}"
        )
    times = np.append(step * np.arange(max(1, math.ceil(steps))), duration)
    values = {}
    if inputs:
        values = {name: interpolate(inputs.time, each, times, interpolation) for name, each in inputs.values.items()}
    return Course(times, start, values, {name: np.diff(value) / np.diff(times) for name, value in values.items()})


def simulate(
    fmu: Fmu,
    parameters: Mapping[str, Value],
    inputs: Inputs | None,
    course: Course,
    folder: Path,
    suffix: str,
    error_estimate: bool,
    source: str,
) -> None:
    """Simulate and write simulation.csv, the figure simulation.<suffix> and perhaps errors.csv into the folder.

    error_estimate  run at half the internal step, too
    source          the name of what the inputs come from
    Raises Interrupted after Ctrl-C (the rows so far are kept) and FmuError when the FMU refuses something.
    """
    variables = fmu.variables
    outputs = variables.names("output")
    units = {name: variables[name].unit or "" for name in outputs}
    path, count = folder / "simulation.csv", len(course.times) - 1
    with fmu.instances() as (instance,), stop_on_interrupt() as stop:
        instance.start(parameters, course.at(0))
        used = instance.used_parameters()
        drive = text(variables["drive"], used["drive"])
        for name in set(DRIVEN_BY.values()) & set(course.values) - {DRIVEN_BY[drive]}:
            print(f"{name}: has no effect with drive {drive}; see --drive", file=sys.stderr)
        columns = ["time [s]", *(f"{name} [{unit}]" if unit else name for name, unit in units.items())]
        head = file_head(fmu, used, course.described(source))
        keep_others(path, head)
        table = TableFile(path, columns, digits=12)
        table.begin(head)

        def keep(i: int, row: Sequence[Value]) -> None:
            table.write([course.time_text(i), *row])
            if stop.is_set():
                raise Interrupted(
                    f"interrupted at {course.time_text(i)} s; the rows so far are kept in {path}; the same command "
                    "begins anew"
                )

        with table:
            rows = _run(instance, course, outputs, keep, "step")
        written, found = [path], []
        if error_estimate:

            def look(_i: int, _row: Sequence[Value]) -> None:
                if stop.is_set():
                    raise Interrupted(
                        f"interrupted at half the step; {path} is complete, without estimate of its error"
                    )

            step = estimate.half_step(float(used["solver.step"]), float(course.times[1]))
            instance.start({**parameters, "solver.step": step}, course.at(0))
            finer = _run(instance, course, outputs, look, "half step")
            reals = {name: unit for name, unit in units.items() if variables[name].type == "Real"}
            pick = [outputs.index(name) for name in reals]
            found = estimate.estimates(reals, course.times, rows.T[pick], finer.T[pick])
            head |= {"half the internal step": f"{step:g} s"}
            labels = ["output", "unit", "rms", "largest", "at [s]", "range"]
            written.append(write_table(folder / "errors.csv", head, labels, map(astuple, found)))

    series = {"time": course.times, **dict(zip(outputs, rows.T))}
    if drive == "Wire":
        start = float(parse(variables["wire_height"], variables["wire_height"].start))
        series["wire_height"] = course.values.get("wire_height", np.full(count + 1, start))
    written.append(folder / f"simulation.{suffix}")
    save(simulation_figure(series, float(used["zspring.Mf"]), _title(fmu, used, source), course.start), written[-1])
    print(f"{count} communication steps from {course.time_text(0)} s to {course.time_text(count)} s")
    if inputs and inputs.start:
        print(f"the simulation's time is 0 at {course.time_text(0)} s of the input")
    if inputs and inputs.rounding:
        print(f"times of the input taken as even: they are so but for rounding, {inputs.rounding:.2g} s")
    if found:
        drawn = [name for panel in PANELS for name in panel.lines.values()]
        shown = [one for one in found if one.name in drawn]
        print(*estimate.table(shown), sep="\n")
        if warning := estimate.warning(shown):
            print(warning, file=sys.stderr)
    print("written:", *written)


def _title(fmu: Fmu, used: Mapping[str, Value], source: str) -> str:
    """What was run: drive, suspension and friction, internal step, inputs, and whether parameters are synthetic."""
    drive, suspension, friction = (
        text(fmu.variables[name], used[name]) for name in ("drive", "suspension", "friction")
    )
    model = f"Z-spring, friction {friction}" if suspension == "ZSpring" else f"suspension {suspension}"
    bench = f" with {used['bench.frequency']:g} Hz, {used['bench.acceleration']:g} m/s²" if drive == "Bench" else ""
    inputs = f", inputs of {source}" if source else ""
    step = f"internal step {1e3 * used['solver.step']:g} ms"
    return f"Pantograph, drive {drive}{bench}{inputs}\n{model}, {step}{synthetic_note(fmu, used)}"


def _run(
    instance: Instance,
    course: Course,
    outputs: Sequence[str],
    on_row: Callable[[int, Sequence[Value]], None],
    label: str,
) -> np.ndarray:
    """All outputs (n, outputs) at the communication points, of an instance that is started there."""
    rows = np.empty((len(course.times), len(outputs)))
    for i in tqdm(range(len(course.times)), unit=" steps", desc=label, disable=None):
        if i > 0:
            instance.set(course.at(i - 1))
            instance.set_slopes({name: float(slopes[i - 1]) for name, slopes in course.slopes.items()})
            instance.step(course.times[i - 1], course.times[i] - course.times[i - 1])
        row = instance.get(outputs)
        rows[i] = row
        on_row(i, row)
    return rows
