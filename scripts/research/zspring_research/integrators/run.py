"""The study from settings to result folder: all variants in turn, CSV, figures, tables."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

from zspring.errors import ZSpringError
from zspring.figures import save
from zspring.fmu import Fmu
from zspring.heads import file_head, synthetic_note
from zspring.records import Record, fill
from zspring.tables import write_table
from zspring.variables import Value, text, with_unit

from . import peers, plot, report
from .measure import COLUMNS, INERTIA_PERIODS, Laboratory, Result, Variant, from_row, to_row, variants
from .model import bench_model

STANDARD = 5.0, 1.0  # Hz, m/s2: what the goals are set for
Run = tuple[Variant, Result]

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
    parameters = fmu.used_parameters(assigned)
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
    head = file_head(fmu, fixed, settings)
    with fmu.instances() as (instance,):
        record = Record(folder / "integrators.partial.csv", head, list(COLUMNS.values()), to_row, from_row)
        laboratory = Laboratory(instance, parameters, frequency, acceleration)
        peers.warm_up(bench_model(parameters, frequency, acceleration))
        _measure(laboratory, planned, record, rounds)
        doubt = laboratory.problem(planned[0]).doubt

    best = {variant: min(runs, key=lambda run: run.seconds) for variant, runs in runs_of(record, planned).items()}
    precision = {variant: run for variant, run in best.items() if variant.study == "precision"}
    inertia = {variant: run for variant, run in best.items() if variant.study == "inertia"}
    bound = report.stable_step(parameters["zspring.Mf"], parameters["zspring.tau"])
    ratios, force_ratios = (report.inertia_ratios(inertia, quantity, frequency) for quantity in ("H", "force"))
    files = [folder / name for name in ("integrators.csv", f"precision.{suffix}", f"inertia.{suffix}")]
    write_table(files[0], head, record.columns, map(to_row, best.items()), digits=None)
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


def runs_of(record: Record[Run], planned: list[Variant]) -> dict[Variant, list[Result]]:
    """The runs so far of each planned variant."""
    runs: dict[Variant, list[Result]] = {variant: [] for variant in planned}
    for variant, result in record.results:
        if variant in runs:
            runs[variant].append(result)
    return runs


def _measure(laboratory: Laboratory, planned: list[Variant], record: Record[Run], rounds: int) -> None:
    """All variants in turn, round after round, so that a busy machine hurts all of them alike."""
    runs = runs_of(record, planned)

    def to_do(number: int, variant: Variant) -> bool:
        """Whether a variant still needs its run of this number; long ones, and those that failed, have just one."""
        done = runs[variant]
        return len(done) <= number and (not done or done[0].seconds < LONG)

    def work(stop: threading.Event) -> Iterator[Run]:
        for number in range(rounds):
            for variant in planned:
                if to_do(number, variant) and not stop.is_set():
                    runs[variant].append(laboratory.run(variant))
                    yield variant, runs[variant][-1]

    total = rounds * len(planned)
    missing = sum(to_do(number, variant) for number in range(rounds) for variant in planned)
    fill(record, total, missing, "runs", work)
