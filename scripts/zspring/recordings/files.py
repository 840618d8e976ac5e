"""Files of recordings: the responses that `zspring identify` takes, and all holds that were found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..bench.responses import HARMONICS, phase_degrees
from ..tables import write_table
from .groups import Group
from .points import Point
from .sine import MOST

DIGITS = 8


def write_responses(path: Path, head: Mapping[str, str], groups: Sequence[Group]) -> Path:
    """The responses of these groups, in the form that `bench.measured` reads."""
    columns = ["frequency [Hz]", "amplitude [m/s2]", "level"]
    columns += ["magnitude [m/N]", "magnitude_error [m/N]", "phase [deg]", "phase_error [deg]"]
    columns += ["common_error [1]"]
    columns += [f"harmonic_{k}{what} [N]" for k in HARMONICS for what in ("", "_error")]
    columns += ["loss [J]", "loss_error [J]", "periods", "status"]
    rows = [
        [
            *(p.frequency, p.acceleration, group.label),
            *(abs(p.H), abs(p.H) * p.magnitude_error),
            *(float(phase_degrees(p.H, "receptance")), math.degrees(p.phase_error), p.common),
            *np.column_stack([p.force, p.force_error])[1:].ravel(),
            *(p.loss, p.loss_error, p.periods, p.status),
        ]
        for group in groups
        for p in group.points
    ]
    return write_table(path, head, columns, rows, DIGITS)


def write_holds(path: Path, head: Mapping[str, str], points: Sequence[Point]) -> Path:
    """All that was found, used or not."""
    columns = ["file", "begin [s]", "end [s]", "frequency [Hz]", "periods", "periods_found", "status"]
    columns += ["amplitude [m/s2]", "amplitude_scatter [%]", "distortion [%]"]
    columns += [f"motion_{k} [m]" for k in range(1, MOST + 1)] + [f"force_{k} [N]" for k in range(1, MOST + 1)]
    columns += ["force_noise [N]", "motion_noise [SI]", "force_mean [N]", "force_drift [N]"]
    columns += ["acceleration_over_displacement", "acceleration_over_displacement_phase [deg]", "repeats_after"]
    rows = [
        [
            *(p.record, p.begin, p.end, p.frequency, p.periods, p.found, p.status),
            *(p.acceleration, 100 * p.scatter, 100 * p.distortion, *p.motion, *p.force),
            *(p.force_noise, p.motion_noise, p.static_force, p.drift),
            *(abs(p.agreement), math.degrees(np.angle(p.agreement)), p.subharmonic),
        ]
        for p in points
    ]
    return write_table(path, head, columns, rows, 6)
