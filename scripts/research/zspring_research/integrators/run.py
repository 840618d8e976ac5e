"""The study from settings to result folder: all variants in turn, CSV, figures, tables."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

from tqdm import tqdm

from zspring.errors import ZSpringError
from zspring.figures import save
from zspring.files import study_head, synthetic_note, used_parameters
from zspring.fmu import Fmu
from zspring.interrupt import Interrupted, stop_on_interrupt
from zspring.variables import Value, text, with_unit

from . import peers, plot, report
from .measure import INERTIA_PERIODS, Laboratory, Variant, to_row, variants
from .model import bench_model
from .record import Record, write_runs

STANDARD = 5.0, 1.0  # Hz, m/s2: what the goals are set for
LONG = 1.0  # s; runs beyond are not repeated
SET_BY_THE_STUDY = (
    "drive",
    "suspension",
    "friction",
    "bench.frequency",
    "bench.acceleration",
    "solver.step",
    "solver.alpha",
)


def run_integrators(
    fmu: Fmu,
    assigned: Mapping[str, Value],
    frequency: float,
    acceleration: float,
    periods: int,
    rounds: int,
    quick: bool,
    folder: Path,
    suffix: str,
) -> None:
    """Run the study, going on where an interrupted one in the folder stopped; write and print the results.

    assigned    parameters of the FMU; frequency in Hz, acceleration in m/s2, periods after the ramp
    rounds      timed runs of each variant, of which the fastest counts
    suffix      of the figures, "png" or "svg"
    Raises ZSpringError when the model has no ordinary differential equation, Interrupted after Ctrl-C.
    """
    parameters = used_parameters(fmu, assigned)
    for name in ("zspring.J1", "zspring.J2", "m3", "zspring.Mf"):
        if not parameters[name] > 0:
            value = with_unit(fmu.variables[name], parameters[name])
            raise ZSpringError(f"{name} = {value}: must be more than 0 for the explicit methods")
    planned = variants(parameters, periods, quick)
    settings = {
        "SHA-256 of the FMU": fmu.sha256,
        "bench": f"{frequency!r} Hz, {acceleration!r} m/s2, from rest, one period of ramp",
        "CPU time": "of one run, the fastest of the rounds; the machine may have been busy",
        "errors": "relative, over the last period; upper frame and contact force in the root mean square",
    }
    fixed = {name: value for name, value in parameters.items() if name not in SET_BY_THE_STUDY}
    head = study_head(fmu, fixed, settings)
    with fmu.instances() as (instance,):
        record = Record(folder / "integrators.partial.csv", head)
        laboratory = Laboratory(instance, parameters, frequency, acceleration)
        peers.warm_up(bench_model(parameters, frequency, acceleration))
        _measure(laboratory, planned, record, rounds)
        doubt = laboratory.problem(planned[0]).doubt

    best = {variant: record.best(variant) for variant in planned}
    precision = {variant: run for variant, run in best.items() if variant.study == "precision"}
    inertia = {variant: run for variant, run in best.items() if variant.study == "inertia"}
    bound = report.stable_step(parameters["zspring.Mf"], parameters["zspring.tau"])
    ratios, force_ratios = (report.inertia_ratios(inertia, quantity, frequency) for quantity in ("H", "force"))
    files = [folder / name for name in ("integrators.csv", f"precision.{suffix}", f"inertia.{suffix}")]
    write_runs(files[0], head, [to_row(variant, run) for variant, run in best.items()])
    synthetic = synthetic_note(fmu, parameters)
    bench = f"bench at {frequency:g} Hz and {acceleration:g} m/s²"
    J = text(fmu.variables["zspring.J1"], parameters["zspring.J1"])
    save(
        plot.precision_figure(precision, f"Work and precision, {bench}, {periods} periods, J = {J} kg m²{synthetic}"),
        files[1],
    )
    save(
        plot.inertia_figure(
            ratios, force_ratios, bound, f"Against the rod inertia, {bench}, {INERTIA_PERIODS} periods{synthetic}"
        ),
        files[2],
    )
    record.path.unlink()

    print(*report.precision_table(precision, frequency), "", sep="\n")
    print(*report.inertia_table(ratios, force_ratios, bound), "", sep="\n")
    if not assigned and (frequency, acceleration) == STANDARD:
        print(*report.goal_lines(precision, ratios, frequency), sep="\n")
    print(f"reference: Radau; CVODE differs from it by {doubt.H:.0e} in H, {doubt.force:.0e} in the force")
    print("times are of this machine, which may have been busy: read the ratios")
    print("written:", *files)
    print(*report.failures(best), sep="\n", end="", file=sys.stderr)


def _measure(laboratory: Laboratory, planned: list[Variant], record: Record, rounds: int) -> None:
    """All variants in turn, round after round, so that a busy machine hurts all of them alike."""
    if record.is_stale:
        print(f"{record.path} does not fit these settings: begun anew")
    done = sum(min(len(record.runs.get(variant, [])), rounds) for variant in planned)
    total = rounds * len(planned)
    if done:
        print(f"going on after {done} of {total} runs in {record.path}")
    with stop_on_interrupt() as stop, record, tqdm(total=total, initial=done, unit=" runs", disable=None) as bar:
        for number in range(rounds):
            for variant in planned:
                runs = record.runs.get(variant, [])
                if len(runs) > number:
                    continue
                if not runs or runs[0].seconds < LONG:  # not so where it failed
                    record.append(variant, laboratory.run(variant))
                done += 1
                bar.update()
                if stop.is_set() and done < total:
                    raise Interrupted(
                        f"interrupted after {done} of {total} runs, kept in {record.path}; "
                        "the same command goes on from there"
                    )
