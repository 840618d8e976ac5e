"""A measured response laid over the FRF: what it says of the run, and how far the model is from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..bench.compare import LevelComparison
from ..bench.conditions import read_conditions
from ..bench.curves import Source
from ..bench.measured import read_curves
from ..errors import ZSpringError
from ..fmu import Fmu
from ..variables import Value

STEADY = 0.1  # relative: amplitudes that scatter less are one acceleration


def stated(
    fmu: Fmu, source: Source, parameters: Mapping[str, Value], direction: str | None
) -> tuple[dict[str, Value], str | None]:
    """Parameters and direction of the sweep, those given and those that the head of the file states.

    Raises ZSpringError where they differ.
    """
    conditions = read_conditions([source.path], fmu)
    swept = direction if direction == "both" else direction or conditions.direction
    return conditions.agreed(fmu, parameters), swept


def amplitudes_of(source: Source) -> tuple[float, ...]:
    """Peak accelerations of the levels in m/s2, ascending. Raises ZSpringError for a level that is none."""
    found = set()
    for curve in read_curves(source):
        middle = float(np.median(curve.acceleration))
        low, high = curve.acceleration.min(), curve.acceleration.max()
        if max(high / middle, middle / low) > 1 + STEADY:
            raise ZSpringError(
                f"{source.path}: the accelerations of level {curve.label} are {low:.3g} to {high:.3g} m/s2, no steady "
                "one: give --amplitudes"
            )
        found.add(float(f"{middle:.3g}"))
    return tuple(sorted(found))


def distance_lines(levels: Sequence[LevelComparison]) -> list[str]:
    """How far the model is from each level."""
    lines = []
    for level in levels:
        for e in level.errors:
            at = f"over {level.measured.frequency.min():g} to {level.measured.frequency.max():g} Hz"
            magnitude = f"{_two(100 * e.magnitude_mean)} % in the mean, {_two(100 * e.magnitude_rms, '')} % rms"
            phase = f"{_two(e.phase_mean)} deg, {_two(e.phase_rms, '')} deg rms"
            largest = f"{_two(100 * e.magnitude_largest)} % and {_two(e.phase_largest)} deg at most"
            lines.append(f"model against measured {level.measured.label}, {e.points} points {at}:")
            lines.append(f"  magnitude {magnitude}; phase {phase}; {largest}")
    return lines


def _two(value: float, sign: str = "+") -> str:
    """Two digits, without an exponent."""
    return f"{float(f'{value:.2g}'):{sign}g}"
