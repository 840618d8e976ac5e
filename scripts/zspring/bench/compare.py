"""A measured frequency response against that of the FMU on its bench, at the same points, by level of amplitude."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..fmu import Fmu
from ..tables import write_table
from ..variables import Value, with_unit
from .conditions import STATED, read_conditions
from .curves import Curve, Source, in_band, sign_warning
from .measured import read_curves
from .model import SETTLED, BenchModel


@dataclass(frozen=True)
class BandError:
    """How far computed magnitudes (relative) and phases (deg) are from measured ones in a band of frequencies."""

    band: tuple[float, float]  # Hz
    points: int
    magnitude_mean: float
    magnitude_rms: float
    magnitude_largest: float
    phase_mean: float
    phase_rms: float
    phase_largest: float


@dataclass(frozen=True)
class LevelComparison:
    """One level: what was measured, what the FMU has there (n,), and the errors by band."""

    measured: Curve
    computed: np.ndarray  # m/N, NaN where it failed
    errors: list[BandError]


@dataclass(frozen=True)
class FrfComparison:
    """All levels, and under what they were computed."""

    levels: list[LevelComparison]
    parameters: Mapping[str, Value]  # given ones, with those of the bench that the file states
    direction: str
    remarks: list[str]  # what makes the comparison less than it seems


def compare_frf(
    fmu: Fmu,
    source: Source,
    parameters: Mapping[str, Value],
    edges: Sequence[float],
    direction: str | None,
    jobs: int,
    stop: threading.Event,
) -> FrfComparison:
    """Measure the FMU on its bench at the points of the file, and compare.

    edges       Hz, of the bands; what was measured beyond them is left out
    direction   of the sweep: "up", "down", or "rest" (each point from the static state); None: as the file has it
    Raises ZSpringError for a bad file or parameter, for one that contradicts the file, and where no point could be
    computed.
    """
    if len(edges) < 2:
        raise ZSpringError("frequency bands: need at least two edges, e.g. 0.5,5,20")
    curves = in_band(read_curves(source), (edges[0], edges[-1]))
    conditions = read_conditions([source.path], fmu)
    given = conditions.agreed(fmu, parameters)
    swept = conditions.swept(direction)
    unknown = [name for name in STATED if name not in conditions.parameters]
    used = fmu.used_parameters(given)
    assumed = ", ".join(f"{name} {with_unit(fmu.variables[name], used[name])}" for name in unknown)
    remarks = []
    if unknown:
        remarks.append(f"{source.path.name} does not say {' and '.join(unknown)} of the bench: {assumed} assumed")
    if warning := sign_warning(curves):
        remarks.append(warning)
    with fmu.instances(min(jobs, len(curves))) as instances:
        model = BenchModel(instances, swept, stop)
        try:
            model.check(given)
            (found,) = model.receptances([given], curves)
        finally:
            model.close()
    late = sum(taken >= SETTLED.max_periods for each in found for taken in each.periods)
    if late:
        remarks.append(f"{late} points of the model had not settled after {SETTLED.max_periods} periods")
    levels = [LevelComparison(c, each.H, band_errors(c, each.H, edges)) for c, each in zip(curves, found)]
    if not stop.is_set() and not any(np.isfinite(c.computed).any() for c in levels):
        raise ZSpringError(f"{source.path}: no point could be computed with these parameters")
    return FrfComparison(levels, given, swept, remarks)


def band_errors(measured: Curve, computed: np.ndarray, edges: Sequence[float]) -> list[BandError]:
    """Errors in each band that has points; the upper edge of the last band belongs to it."""
    with np.errstate(invalid="ignore"):
        ratio = computed / measured.H
    errors = []
    for low, high in itertools.pairwise(edges):
        inside = (measured.frequency >= low) & (measured.frequency < high)
        if high == edges[-1]:
            inside |= measured.frequency == high
        inside &= np.isfinite(ratio)
        if inside.any():
            magnitude, phase = np.abs(ratio[inside]) - 1, np.degrees(np.angle(ratio[inside]))
            # Of angles the mean is that of their directions: -179 and 179 deg are 180 deg off, not 0.
            turned = np.degrees(np.angle(np.mean(np.exp(1j * np.radians(phase)))))
            of_magnitude = float(magnitude.mean()), *_rms_and_largest(magnitude)
            errors.append(
                BandError((low, high), int(inside.sum()), *of_magnitude, float(turned), *_rms_and_largest(phase))
            )
    return errors


def _rms_and_largest(values: np.ndarray) -> tuple[float, float]:
    """Root mean square, and the value farthest from 0."""
    return float(np.sqrt(np.mean(values**2))), float(values[np.argmax(np.abs(values))])


def write_comparison(path: Path, fmu: Fmu, source: Source, levels: Sequence[LevelComparison]) -> Path:
    """Both responses, point by point."""
    columns = ["amplitude", "frequency [Hz]", "amplitude [m/s2]"]
    columns += [f"{kind}_{part} [m/N]" for kind in ("measured", "computed") for part in ("re", "im")]
    rows = [
        [each.measured.label, float(f), float(a), m.real, m.imag, c.real, c.imag]
        for each in levels
        for f, a, m, c in zip(each.measured.frequency, each.measured.acceleration, each.measured.H, each.computed)
    ]
    return write_table(path, {**fmu.identity, "measured": str(source.path)}, columns, rows)
