"""The Newton study from settings to result folder: the jump, the work of each tangent, the accuracy."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from zspring.bench.fixed_work import PERIODS, Point, figure_points
from zspring.bench.points import FrfSettings
from zspring.errors import ZSpringError
from zspring.figures import save
from zspring.fmu import Fmu, Instance
from zspring.heads import file_head, synthetic_note
from zspring.interrupt import Interrupted, stop_on_interrupt
from zspring.tables import write_table
from zspring.variables import Value

from .accuracy import Errors, accuracy, coulomb_reference
from .iteration import TANGENTS, Step
from .jump import iterations_of, jumping_steps
from .plot import convergence_figure, jump_figure
from .recorded import record
from .report import ERROR_COLUMNS, WORK_COLUMNS, tables, work_row
from .work import TangentWork, tangent_work, total

MOST_ITERATIONS = 100  # of the published study
LARGEST_ALPHA = -0.01  # of HHT, see newmark_accelerations


@dataclass(frozen=True)
class NewtonSettings:
    """What to study."""

    amplitudes: tuple[float, ...]  # m/s2, of the figure
    frequencies: tuple[float, ...]  # Hz, of the figure
    taus: tuple[float, ...]  # s
    tau_stride: int  # every so many-th point of the figure for the work by tau
    frequency: float  # Hz, bench of the recorded step and of the accuracy in time
    acceleration: float  # m/s2


def run_newton(fmu: Fmu, parameters: Mapping[str, Value], settings: NewtonSettings, folder: Path, suffix: str) -> None:
    """Write jump.csv, newton.csv, accuracy.csv and the figures jump and newton, and print the tables.

    Raises ZSpringError without friction, for HHT's alpha near 0, and when no step of the recorded period
    makes the exact tangent jump; FmuError when the FMU refuses a parameter; Interrupted after Ctrl-C (the
    tables so far are kept).
    """
    parameters = {"solver.max_iterations": MOST_ITERATIONS, **parameters}
    used = fmu.used_parameters(parameters)
    if not used["zspring.Mf"] > 0:
        raise ZSpringError(f"zspring.Mf = {used['zspring.Mf']:g} N.m: must be above 0, this study is about friction")
    if not used["solver.alpha"] < LARGEST_ALPHA:
        raise ZSpringError(
            f"solver.alpha = {used['solver.alpha']:g}: must be below {LARGEST_ALPHA}; towards 0 a step's "
            "positions and velocities no longer determine its accelerations"
        )
    own = {
        "bench": f"{settings.frequency:g} Hz, {settings.acceleration:g} m/s2",
        "points": f"{PERIODS} periods each, from rest",
    }
    listed = {
        name: value
        for name, value in used.items()
        if not name.startswith("bench.") and name not in ("drive", "friction", "solver.tangent")
    }
    head = file_head(fmu, listed, own)
    note = synthetic_note(fmu, used)
    points = figure_points(FrfSettings(amplitudes=settings.amplitudes, frequencies=settings.frequencies))
    if not points:
        raise ZSpringError("nothing to study: all points need more stroke than the standard figure has")
    with fmu.instances() as (instance,), stop_on_interrupt() as stop:
        written = _jump(instance, parameters, settings, head, folder, suffix, note)
        works, errors = _work_and_accuracy(instance, parameters, settings, points, used["zspring.tau"], stop)
    table, accuracies = folder / "newton.csv", folder / "accuracy.csv"
    write_table(table, head, WORK_COLUMNS, [work_row(work) for work in works])
    write_table(accuracies, head, ERROR_COLUMNS, [astuple(error) for error in errors])
    if stop.is_set():
        raise Interrupted(f"interrupted; what was done is kept in {table} and {accuracies}")
    by_amplitude = [work for work in works if work.amplitude is not None]
    by_tau = [work for work in works if work.amplitude is None]
    figure = folder / f"newton.{suffix}"
    save(convergence_figure(by_amplitude, by_tau, errors, f"Newton's method by tangent{note}"), figure)
    print(*tables(by_amplitude, by_tau, errors), sep="\n")
    print("written:", *written, table, accuracies, figure)


def _jump(
    instance: Instance,
    parameters: Mapping[str, Value],
    settings: NewtonSettings,
    head: Mapping[str, str],
    folder: Path,
    suffix: str,
    note: str,
) -> list[Path]:
    """Record a period, find the exact tangent's first jump, write jump.csv and the figure."""
    chosen = instance.variables.parse_assignments(["friction=Regularized", "solver.tangent=Resolvent"])
    recording = record(instance, {**parameters, **chosen}, settings.frequency, settings.acceleration)
    found, count = jumping_steps(recording), len(recording.time) - 2
    if not found:
        raise ZSpringError(
            f"in no step of a period of {settings.frequency:g} Hz at {settings.acceleration:g} m/s2 does the "
            "exact tangent jump: try a larger --bench-acceleration or zspring.tau"
        )
    index, tau = found[0], recording.parameters["zspring.tau"]
    iterations = iterations_of(recording, index)
    states = np.sort(iterations["Exact"].rates[-2:, 0])
    solution = iterations["Resolvent"].rates[-1]
    margin = 0.15 * np.ptp([*states, solution[0]]) + 3 / tau
    low, high = min(states[0], solution[0]) - margin, max(states[1], solution[0]) + margin
    rates = np.unique([*np.linspace(low, high, 200), *np.linspace(-4 / tau, 4 / tau, 200)])
    rates = rates[(rates >= low) & (rates <= high)]
    balance = rates, Step(recording, index).balance(solution, rates)

    path, figure = folder / "jump.csv", folder / f"jump.{suffix}"
    write_table(
        path,
        {**head, "recorded step": f"from {recording.time[index]:g} s, {recording.step:g} s long"},
        ["tangent", "iteration", "rate_alpha [rad/s]", "rate_beta [rad/s]", "unbalance [1]"],
        (
            [tangent, float(i), *rates, unbalance]
            for tangent, iteration in iterations.items()
            for i, (rates, unbalance) in enumerate(zip(iteration.rates, iteration.unbalance))
        ),
    )
    save(jump_figure(iterations, balance, tau, f"One step of the FMU, iterated again{note}"), figure)
    error = np.abs(iterations["Resolvent"].q - recording.q[index + 1]).max()
    print(
        f"recorded period: {settings.frequency:g} Hz, {settings.acceleration:g} m/s2, {count} steps; "
        f"the exact tangent jumps for ever in {len(found)}\n"
        f"the first one: between {1e3 * states[0]:.3f} and {1e3 * states[1]:.3f} mrad/s; "
        f"solution {1e3 * solution[0]:.4f} mrad/s, within {error:.0e} of the FMU's positions"
    )
    return [path, figure]


def _work_and_accuracy(
    instance: Instance,
    parameters: Mapping[str, Value],
    settings: NewtonSettings,
    points: Sequence[Point],
    tau: float,
    stop: threading.Event,
) -> tuple[list[TangentWork], list[Errors]]:
    """By amplitude at the FMU's tau, by tau, and the errors by tau; what is done when `stop` is set."""
    works: list[TangentWork] = []
    errors: list[Errors] = []
    sparse = points[:: settings.tau_stride]

    def tasks() -> Iterator[None]:
        for law, tangent in [*(("Regularized", tangent) for tangent in TANGENTS), ("Coulomb", "Resolvent")]:
            works.extend(tangent_work(instance, parameters, law, tangent, tau, points))
            yield
        for tau_ in settings.taus:
            for tangent in TANGENTS:
                works.append(total(tangent_work(instance, parameters, "Regularized", tangent, tau_, sparse)))
                yield
        bench = settings.frequency, settings.acceleration
        reference = coulomb_reference(instance, parameters, points, *bench)
        yield
        for tau_ in settings.taus:
            errors.append(accuracy(instance, parameters, points, *bench, tau_, reference))
            yield

    count = len(TANGENTS) + 2 + len(settings.taus) * (len(TANGENTS) + 1)
    for _ in tqdm(tasks(), total=count, unit=" runs", disable=None):
        if stop.is_set():
            break
    return works, errors
