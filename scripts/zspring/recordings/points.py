"""What one hold of a recording tells.

H = -Z/F as in `bench.responses`: head displacement Z, upward, and contact force F, which presses the head down.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .sine import MOST, students


@dataclass(frozen=True)
class Point:
    """What one hold tells; NaN where it does not. Harmonics (7,) count from the fundamental."""

    record: str  # name of the file
    level: str | None
    begin: float  # s, of the periods that count
    end: float
    frequency: float  # Hz
    found: int  # whole periods in the hold
    periods: int = 0  # that count
    H: complex = complex(math.nan, math.nan)  # m/N
    variance: np.ndarray = field(
        default_factory=lambda: np.full(2, np.nan)
    )  # of magnitude, relative, and phase: scatter
    freedom: np.ndarray = field(default_factory=lambda: np.full(2, np.nan))  # how many numbers tell it
    white: float = math.nan  # what either variance would be if all that is not periodic were white noise
    rounding: float = math.nan  # standard error of magnitude, relative, and phase by the converter's steps
    harmonics: float = math.nan  # the same by harmonics of the motion, which neighbouring points share
    lag: float = 0.0  # the same by the rate of a slow sweep, which they share as well
    acceleration: float = math.nan  # m/s2, peak
    scatter: float = math.nan  # of the motion's amplitude from period to period, relative, beyond its noise
    force: np.ndarray = field(default_factory=lambda: np.full(MOST, np.nan))  # N, peaks
    force_error: np.ndarray = field(default_factory=lambda: np.full(MOST, np.nan))
    motion: np.ndarray = field(default_factory=lambda: np.full(MOST, np.nan))  # m, peaks
    distortion: float = math.nan  # harmonics 2.. of the velocity over its fundamental
    force_noise: float = math.nan  # N, rms of what is not periodic
    motion_noise: float = math.nan  # m or m/s2
    static_force: float = math.nan  # N, mean of the record
    drift: float = math.nan  # N, of the mean force over the hold
    loss: float = math.nan  # J, energy per cycle
    loss_error: float = math.nan
    agreement: complex = complex(math.nan, math.nan)  # displacement from acceleration over that measured
    agreement_error: float = math.nan  # its standard error
    subharmonic: int = 1  # periods after which the force repeats
    marks: tuple[str, ...] = ()  # what makes it less than it seems
    left_out: str = ""  # why it is not used

    @property
    def errors(self) -> np.ndarray:
        """Standard errors (2,) of the magnitude, relative, and of the phase in rad."""
        return np.sqrt(students(self.variance, self.freedom) + self.rounding**2 + self.common**2)

    @property
    def common(self) -> float:
        """What of either error neighbouring points share."""
        return math.hypot(self.harmonics, self.lag)

    @property
    def magnitude_error(self) -> float:
        return float(self.errors[0])

    @property
    def phase_error(self) -> float:
        return float(self.errors[1])

    @property
    def status(self) -> str:
        """As the tables have it."""
        if self.left_out:
            return f"left out: {self.left_out}"
        return f"marked: {', '.join(self.marks)}" if self.marks else "used"
