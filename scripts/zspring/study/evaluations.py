"""What a study computes of the pantograph on a bench. This runs on the workers, so it needs only fmpy and numpy."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..bench.fmu_bench import FmuBench
from ..bench.loops import measure_loop
from ..bench.measure import run_sweep
from ..bench.points import FAILED, NOT_SETTLED, REPEATS, FrfSettings, Kept, sweeps
from ..bench.refine import Refinement, refine
from ..fmu import Instance
from ..variables import Value, exact, exact_list, parse, text
from .coupled import CoupledQuantity

NOT_SETTLED_COLUMN = "not settled"


@dataclass(frozen=True)
class FrfQuantity:
    """First-order FRF by amplitude, and the highest resonance within a band (Hz)."""

    settings: FrfSettings  # its `parameters` stay empty: each case has its own
    band: tuple[float, float]

    @property
    def points(self) -> list[tuple[float, float]]:
        """Amplitude (m/s2) and frequency (Hz) of all points within the stroke."""
        return [(sweep.level, frequency) for sweep in sweeps(self.settings) for frequency in sweep.frequencies]

    @property
    def scalars(self) -> list[str]:
        """Columns of the numbers that sum an FRF up."""
        names = []
        for amplitude in dict.fromkeys(amplitude for amplitude, _ in self.points):
            names += [f"resonance {exact(amplitude)} m/s2 [Hz]", f"peak {exact(amplitude)} m/s2 [m/N]"]
        return names

    @property
    def columns(self) -> list[str]:
        parts = [column(part, *point) for point in sorted(self.points) for part in ("H_re", "H_im")]
        return [*self.scalars, NOT_SETTLED_COLUMN, *parts]

    def described(self) -> dict[str, str]:
        """Settings as text, by key."""
        frf = {f"frf {key}": value for key, value in self.settings.described().items() if key != "through"}
        return {**frf, "frf resonance band": f"{exact(self.band[0])} to {exact(self.band[1])} Hz"}

    def measure(self, instance: Instance, parameters: Mapping[str, Value]) -> tuple[dict[str, float], list[str]]:
        """Values by column, and a line for each point that could not be solved."""
        bench = FmuBench(instance, parameters)
        found: dict[tuple[float, float], complex] = {}
        kept: dict[float, list[Kept]] = {}
        problems, unsettled = [], 0
        for sweep in sweeps(self.settings):
            for point, state in run_sweep(bench, sweep, self.settings, threading.Event()):
                found[point.amplitude, point.frequency] = point.H
                kept.setdefault(point.amplitude, []).append((point, state))
                unsettled += point.status.startswith((NOT_SETTLED, REPEATS))
                if point.status.startswith(FAILED):
                    problems.append(f"{point.amplitude:g} m/s2, {point.frequency:g} Hz: {point.status}")
        values: dict[str, float] = {NOT_SETTLED_COLUMN: unsettled}
        for (amplitude, frequency), H in found.items():
            values[column("H_re", amplitude, frequency)] = H.real
            values[column("H_im", amplitude, frequency)] = H.imag
        for amplitude, points in kept.items():
            frequency, peak = self._resonance(bench, points)
            values[f"resonance {exact(amplitude)} m/s2 [Hz]"] = frequency
            values[f"peak {exact(amplitude)} m/s2 [m/N]"] = peak
        return values, problems

    def _resonance(self, bench: FmuBench, points: Sequence[Kept]) -> tuple[float, float]:
        """Frequency (Hz) and magnitude (m/N) of the highest resonance of one amplitude within the band, else NaN."""
        low, high = self.band
        inside = [(point, state) for point, state in points if low <= point.frequency <= high]
        if not inside:
            return math.nan, math.nan
        beside = list(refine(bench, Refinement(inside, highest=True), self.settings, threading.Event()))
        found = Refinement(inside, beside, highest=True).extremes()
        return max(((e.frequency, e.magnitude) for e in found), key=lambda each: each[1], default=(math.nan, math.nan))


@dataclass(frozen=True)
class StaticQuantity:
    """Static test of the head suspension, see studies/static/loops.py.

    stiffness   secant from peak to peak
    loss        energy that one loop dissipates
    """

    amplitudes: tuple[float, ...]  # m, ascending
    rate: float = 1e-3  # m/s

    @property
    def scalars(self) -> list[str]:
        """Columns of stiffness and loss."""
        return [
            f"static {name} {exact(amplitude)} m [{unit}]"
            for amplitude in self.amplitudes
            for name, unit in (("stiffness", "N/m"), ("loss", "J"))
        ]

    @property
    def columns(self) -> list[str]:
        return self.scalars

    def described(self) -> dict[str, str]:
        """Settings as text, by key."""
        return {"static amplitudes": exact_list(self.amplitudes, "m"), "static rate": f"{exact(self.rate)} m/s"}

    def measure(self, instance: Instance, parameters: Mapping[str, Value]) -> tuple[dict[str, float], list[str]]:
        """Values by column; FmuError if a step cannot be solved."""
        friction = instance.variables["friction"]
        law = text(friction, parameters.get("friction", parse(friction, friction.start)))
        values: list[float] = []
        for amplitude in self.amplitudes:
            loop = measure_loop(instance, parameters, law, self.rate, amplitude)
            values += [loop.stiffness, loop.dissipated]
        return dict(zip(self.scalars, values)), []


Quantity = FrfQuantity | StaticQuantity | CoupledQuantity


def column(part: str, amplitude: float, frequency: float) -> str:
    """Name of the column of "H_re" or "H_im" at an amplitude (m/s2) and a frequency (Hz)."""
    return f"{part} {exact(amplitude)} m/s2 {exact(frequency)} Hz [m/N]"
