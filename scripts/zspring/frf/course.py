"""One FRF in one direction: the points asked for, those around its extremes, and what half the step says of both."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from dataclasses import replace
from operator import attrgetter
from pathlib import Path

from ..bench.measure import BENCHES, at_a_time, measure
from ..bench.points import LEFT_OUT, FrfPoint, FrfSettings, Kept, Sweep, left_out, sweeps
from ..bench.refine import AT_EXTREME, Extreme, Refinement, refine
from ..fmu import Fmu
from ..records import Record, fill
from ..variables import Value
from .backbone import PhaseResonance, phase_resonances
from .files import frf_record, remaining, write_frf
from .report import frf_head, richardson

Key = tuple[float, float]  # level in the unit of the control, and frequency in Hz


class Course:
    """Measures in a folder, into records from which it goes on after an interruption.

    path        of their file
    points      asked for, by level and frequency, with those left out
    beside      other ones, around the extremes
    extremes    by level
    phases      resonances by phase, by level
    errors      relative ones of H by half the step, where they were asked for
    Its methods raise Interrupted after Ctrl-C; finished points are kept.
    """

    def __init__(self, fmu: Fmu, settings: FrfSettings, folder: Path, name: str, quantity: str, jobs: int):
        self._fmu, self._folder, self._name, self._quantity, self._jobs = fmu, folder, name, quantity, jobs
        self.path = folder / f"{name}.csv"
        self.settings, self.parameters = settings, all_parameters(fmu, settings)
        self.head = frf_head(fmu, settings, self.parameters, quantity)
        self.points: list[FrfPoint] = []
        self.beside: list[FrfPoint] = []
        self.extremes: dict[float, list[Extreme]] = {}
        self.phases: dict[float, list[PhaseResonance]] = {}
        self.errors: dict[Key, float] = {}
        self._records: list[Record[Kept]] = []

    def measure(self) -> str:
        """The points asked for; a line on the time they took."""
        record = self._record(self.settings, "partial")
        points, missing, seconds = self._sweep(record, self.settings, sweeps(self.settings), self._name)
        self.points = sorted([*points, *left_out(self.settings)], key=attrgetter("place"))
        count = f"{missing} of {len(points)}" if missing < len(points) else len(points)
        return (
            f"{count} points in {seconds:.2f} s, {missing / max(seconds, 1e-9):.0f} points/s; "
            f"{sum(p.status == LEFT_OUT for p in self.points)} left out: stroke > {1e3 * self.settings.stroke:g} mm"
        )

    def refine(self) -> str:
        """The extremes, by points beside those asked for and some of them at half the step; a line on the time."""
        record, asked = self._records[0], {p.place for p in self.points}

        def tasks() -> list[Refinement]:
            result = []
            for level in self.settings.amplitudes:
                kept = [each for each in record.results if each[0].level == level]
                sweep = [each for each in kept if each[0].place in asked]
                if sweep:
                    result.append(Refinement(sweep, [each for each in kept if each[0].place not in asked]))
            return result

        def work(stop: threading.Event) -> Iterator[Kept]:
            return at_a_time(refine, self._fmu, self.settings, tasks(), self._jobs, stop)

        seconds = fill(record, None, 0, "points", work, f"{self._name}, extremes")
        self.beside = sorted(
            (point for point, _ in record.results if point.place not in asked), key=attrgetter("place")
        )
        self.extremes = {task.sweep[0][0].level: task.extremes() for task in tasks()}
        every = sorted([*self.points, *self.beside], key=attrgetter("frequency"))
        self.phases = {level: phase_resonances([p for p in every if p.level == level]) for level in self.extremes}
        finer = self._at_half_step(self.settings.tolerance * AT_EXTREME)
        way = -1 if self.settings.direction == "down" else 1
        about = [(a, [p.frequency for p in e.about][::way]) for a, found in self.extremes.items() for e in found]
        planned = [Sweep(level, tuple(frequencies)) for level, frequencies in about if frequencies]
        points, _, more = self._sweep(self._record(finer, "extremes"), finer, planned, f"{self._name}, half step")
        halved = {p.place: p for p in points}
        for a, found in self.extremes.items():
            self.extremes[a] = [e.checked([halved[a, p.frequency] for p in e.about]) if e.about else e for e in found]
        count = sum(map(len, self.extremes.values()))
        took = f"{len(self.beside)} more points and {len(points)} at half the step in {seconds + more:.2f} s"
        return f"{count} extremes by {took}"

    def estimate_errors(self) -> None:
        """Those of the points asked for, by half the step."""
        finer = self._at_half_step(self.settings.tolerance)
        points, _, _ = self._sweep(self._record(finer, "half-step"), finer, sweeps(finer), f"{self._name}, half step")
        H = {p.place: p.H for p in points}
        errors = {p.place: richardson(p.H, H[p.place]) for p in self.points if p.place in H}
        self.errors = {key: error for key, error in errors.items() if math.isfinite(error)}

    def write(self) -> list[Path]:
        """The file of the points asked for, and that of the others if they were looked for."""
        written = [write_frf(self.path, self.head, self.points, self._quantity, self.errors)]
        if self.extremes:
            refined = self._folder / f"{self._name}-refined.csv"
            written.append(write_frf(refined, self.head, self.beside, self._quantity))
        return written

    def forget(self) -> None:
        """The records, once all is written."""
        for record in self._records:
            record.path.unlink(missing_ok=True)

    def _at_half_step(self, tolerance: float) -> FrfSettings:
        parameters = {**self.settings.parameters, "solver.step": self.parameters["solver.step"] / 2}
        return replace(self.settings, tolerance=tolerance, parameters=parameters)

    def _record(self, settings: FrfSettings, part: str) -> Record[Kept]:
        head = frf_head(self._fmu, settings, all_parameters(self._fmu, settings), self._quantity)
        name = f"{self._name}.{part}.csv" if part == "partial" else f"{self._name}.{part}.partial.csv"
        self._records.append(frf_record(self._folder / name, head, self._quantity))
        return self._records[-1]

    def _sweep(
        self, record: Record[Kept], settings: FrfSettings, planned: list[Sweep], label: str
    ) -> tuple[list[FrfPoint], int, float]:
        """All points of these sweeps, how many were missing, and the seconds they took."""
        todo = remaining(record, planned)
        total, missing = (sum(len(sweep.frequencies) for sweep in some) for some in (planned, todo))

        def work(stop: threading.Event) -> Iterator[Kept]:
            return measure(self._fmu, settings, todo, self._jobs, stop)

        seconds = fill(record, total, missing, "points", work, label)
        points = {point.place: point for point, _ in record.results}
        return [points[sweep.level, f] for sweep in planned for f in sweep.frequencies], missing, seconds


def all_parameters(fmu: Fmu, settings: FrfSettings) -> dict[str, Value]:
    """All parameters that the FMU runs with, calculated ones included. Raises FmuError if it refuses one."""
    with fmu.instances() as (instance,):
        BENCHES[settings.through](instance, settings.parameters).start(settings.frequencies[0], settings.amplitudes[0])
        return instance.used_parameters()
