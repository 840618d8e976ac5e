"""What the solvers cost and how exact they are. Run it with scripts/benchmark.

The pantograph over the standard figure; the catenary, alone and coupled, on its reference line.

Every point is run from rest through one communication step of 30 periods, a fixed amount of work, unlike
`zspring frf`, which stops where the response is steady. Times are minima over a few rounds in which the variants
take turns, so that a busy machine hurts all of them alike; their ratios say more than their values.

    scripts/benchmark --against FILE.fmu

compares with an older FMU instead, in pairs of runs: how many times faster, and how far apart the results are.
"""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path

import click
import numpy as np
from tqdm import tqdm

from contact_bands import contact_bands
from identification import identification
from probe import probe_folder
from zspring.bench.fixed_work import PERIODS, Work, figure_points, run_points
from zspring.bench.points import FrfSettings
from zspring.fmu import CATENARY, Fmu, Instance, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.schemes import Coupling
from zspring.line.system import System
from zspring.variables import Value

ROUNDS = 5
SPEED = 250 / 3.6  # m/s
LAWS = ("Regularized", "Coulomb")
POINTS = figure_points(FrfSettings())


def run(instance: Instance, settings: Iterable[str]) -> tuple[np.ndarray, np.ndarray, float]:
    """H (m/N) and counters of every point, (points,) and (points, 4), and the seconds it took."""
    work = run_points(instance, instance.variables.parse_assignments(settings), POINTS)
    return work.H, work.counts, work.seconds.sum()


def core_alone(friction: str) -> float:
    """Seconds the core needs for the same points without FMI."""
    number = {"Regularized": "1", "Coulomb": "2"}[friction]
    points = "".join(f"{frequency} {amplitude}\n" for amplitude, frequency in POINTS)
    done = subprocess.run(
        [probe_folder() / "core_benchmark", number, str(PERIODS)],
        input=points,
        check=True,
        capture_output=True,
        text=True,
    )
    return float(done.stdout.split()[1])


def speed(instance: Instance) -> None:
    print(f"Speed: {len(POINTS)} points, {PERIODS} periods each, one core, best of {ROUNDS}")
    print("law          steps     through fmpy   core alone   ratio   a step in fmi2DoStep")
    times: dict[str, list[tuple[float, float]]] = {"Regularized": [], "Coulomb": []}
    steps = 0
    for _ in tqdm(range(ROUNDS), unit=" rounds", leave=False, disable=None):
        for law, taken in times.items():
            _, counts, seconds = run(instance, [f"friction={law}"])
            steps = counts[:, 0].sum()
            taken.append((seconds, core_alone(law)))
    for law, taken in times.items():
        fmpy, core = np.min(taken, axis=0)
        print(
            f"{law:<11}  {steps:>8}  {fmpy:>8.2f} s   {core:>8.2f} s   {fmpy / core:>5.2f}   "
            f"{1e6 * fmpy / steps:>8.2f} us"
        )


def newton(instance: Instance) -> None:
    print("\nNewton: iterations a step (and steps that had to be halved, %) by amplitude in m/s2; the largest number")
    amplitudes = [amplitude for amplitude, _ in groupby(POINTS, key=lambda point: point[0])]
    print(f"{'law and tangent':<24}" + "".join(f"{a:>14g}" for a in amplitudes) + f"{'largest':>10}")
    variants = [
        ("Regularized", "Resolvent"),
        ("Coulomb", "Resolvent"),
        ("Regularized", "Mean"),
        ("Regularized", "Secant"),
        ("Regularized", "Exact"),
    ]
    for law, tangent in variants:
        # As the published study: up to 100 iterations.
        _, counts, _ = run(instance, [f"friction={law}", f"solver.tangent={tangent}", "solver.max_iterations=100"])
        cells = []
        for amplitude in amplitudes:
            steps, iterations, _, refinements = counts[[a == amplitude for a, _ in POINTS]].sum(axis=0)
            cells.append(f"{iterations / steps:.2f} ({100 * refinements / steps:.2f})")
        print(f"{law + ' ' + tangent:<24}" + "".join(f"{cell:>14}" for cell in cells) + f"{counts[:, 2].max():>10}")


def accuracy(instance: Instance, reference_step: float) -> None:
    print(f"\nAccuracy of |H|, in %, and of the phase, in rad, against a step of {1e3 * reference_step:g} ms")
    print("law          step      median     worst   at                    phase, worst")
    for law in LAWS:
        exact, *_ = run(instance, [f"friction={law}", f"solver.step={reference_step}"])
        for step in (2e-3, 1e-3, 5e-4):
            H, *_ = run(instance, [f"friction={law}", f"solver.step={step}"])
            error = 100 * np.abs(np.abs(H / exact) - 1)
            amplitude, frequency = POINTS[error.argmax()]
            print(
                f"{law:<11}  {f'{1e3 * step:g} ms':<8}{np.median(error):>7.3f}{error.max():>10.2f}   "
                f"{f'{frequency:g} Hz, {amplitude:g} m/s2':<20}  {np.abs(np.angle(H / exact)).max():>8.4f}"
            )


def line(pantograph: Fmu) -> None:
    with Fmu(installed_fmu(CATENARY)) as catenary:
        print(f"\nLine: steps of 1 ms at 250 km/h, one core, best of {ROUNDS}")
        print("spans        through fmpy, us a step   a span")
        lengths = (5, 10, 20, 40)
        times = {spans: [step_of_the_line(catenary, {"line.spans": spans}) for _ in range(ROUNDS)] for spans in lengths}
        for spans, taken in times.items():
            print(f"{spans:<11}  {1e6 * min(taken):>24.1f}   {1e6 * min(taken) / spans:>6.2f}")
        print("coupling     times faster than real time")
        for scheme in ("explicit", "sequential", "parallel", "implicit"):
            system = System(catenary, pantograph, {}, [{}], Journey(SPEED), Coupling(scheme))
            runs = [run_line(system) for _ in range(ROUNDS)]
            print(f"{scheme:<11}  {runs[0].time[-1] / min(run.elapsed for run in runs):>27.1f}")


def step_of_the_line(catenary: Fmu, parameters: Mapping[str, Value], steps: int = 1000) -> float:
    """Seconds a step of 1 ms takes, under a moving force."""
    with catenary.instances() as (instance,):
        instance.start(parameters, {"pantograph[1].force": 120, "pantograph[1].speed": SPEED})
        begin = time.perf_counter()
        for i in range(steps):
            instance.step(i * 1e-3, 1e-3)
        return (time.perf_counter() - begin) / steps


def against(older: Fmu) -> None:
    """Pairs of runs of the older FMU and of this one."""
    model = older.description.coSimulation.modelIdentifier
    with Fmu(installed_fmu(model)) as newer:
        print(f"{older.identity['FMU']}, GUID {older.identity['GUID']}, against this clone's: {ROUNDS} pairs in turn")
        if model == CATENARY:
            for spans in (5, 10, 20, 40):
                pairs = [
                    [step_of_the_line(fmu, {"line.spans": spans}) for fmu in (older, newer)] for _ in range(ROUNDS)
                ]
                print(f"step of 1 ms, {spans:>2} spans       {faster(pairs)}")
            return
        for law in LAWS:
            works = [[work_of(fmu, [f"friction={law}"]) for fmu in (older, newer)] for _ in range(ROUNDS)]
            pairs = [[work.seconds.sum() for work in pair] for pair in works]
            before, now = (work.H for work in works[0])
            apart = np.abs(now / before - 1).max()
            print(f"standard figure, {law:<12} {faster(pairs)}, |H| apart by at most {apart:.1e}")


def faster(pairs: Sequence[Sequence[float]]) -> str:
    """How many times faster the second of each pair was, in words."""
    ratios = np.array([older / newer for older, newer in pairs])
    return f"{np.median(ratios):.2f} times faster ({ratios.min():.2f} to {ratios.max():.2f})"


def work_of(fmu: Fmu, settings: Iterable[str]) -> Work:
    with fmu.instances() as (instance,):
        return run_points(instance, instance.variables.parse_assignments(settings), POINTS)


@click.command()
@click.option("--reference-step", default=5e-5, show_default=True, help="s, of the solution taken as exact.")
@click.option("--against", "older", type=click.Path(exists=True, dir_okay=False, path_type=Path), help="An older FMU.")
def main(reference_step: float, older: Path | None) -> None:
    """Print speed, Newton's work and accuracy over the standard figure, the speed of the line, what a fit costs."""
    if older:
        with Fmu(older) as fmu:
            against(fmu)
        return
    with Fmu() as fmu, fmu.instances() as (instance,):
        speed(instance)
        newton(instance)
        accuracy(instance, reference_step)
        line(fmu)
        with Fmu(installed_fmu(CATENARY)) as catenary:
            contact_bands(catenary, fmu)
        identification(fmu)


if __name__ == "__main__":
    main()
