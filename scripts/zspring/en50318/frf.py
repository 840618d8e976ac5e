"""Validation of a pantograph's model by its frequency response: measured against computed, by amplitude."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..bench.curves import Curve, Source, in_band
from ..bench.measured import read_curves
from ..bench.model import BenchModel
from ..errors import ZSpringError
from ..fmu import Fmu
from ..variables import Value

ACCURATE_STEP = 5e-4  # s; at 2 ms the solver itself is off by 0.8 % in frequency at 20 Hz


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
class FrfComparison:
    """One amplitude: what was measured, what the FMU has there (n,), and the errors by band."""

    measured: Curve
    computed: np.ndarray  # m/N, NaN where it failed
    errors: list[BandError]


def compare_frf(
    fmu: Fmu,
    source: Source,
    parameters: Mapping[str, Value],
    edges: Sequence[float],
    direction: str,
    jobs: int,
    stop: threading.Event,
) -> list[FrfComparison]:
    """Measure the FMU on its bench at the points of the file, and compare.

    edges       Hz, of the bands; what was measured beyond them is left out
    direction   of the sweep: "up", "down", or "rest" (each point from the static state)
    Raises ZSpringError for a bad file or parameter, and where no point could be computed.
    """
    if len(edges) < 2:
        raise ZSpringError("frequency bands: need at least two edges, e.g. 0.5,5,20")
    curves = in_band(read_curves(source), (edges[0], edges[-1]))
    given = {"solver.step": ACCURATE_STEP, **parameters}
    with fmu.instances(min(jobs, len(curves))) as instances:
        model = BenchModel(instances, direction, stop)
        try:
            model.check(given)
            (found,) = model.receptances([given], curves)
        finally:
            model.close()
    comparisons = [FrfComparison(c, H, band_errors(c, H, edges)) for c, (H, _) in zip(curves, found)]
    if not stop.is_set() and not any(np.isfinite(c.computed).any() for c in comparisons):
        raise ZSpringError(f"{source.path}: no point could be computed with these parameters")
    return comparisons


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
            errors.append(BandError((low, high), int(inside.sum()), *_summary(magnitude), *_summary(phase)))
    return errors


def _summary(values: np.ndarray) -> tuple[float, float, float]:
    """Mean, root mean square, and the value farthest from 0."""
    return float(values.mean()), float(np.sqrt(np.mean(values**2))), float(values[np.argmax(np.abs(values))])
