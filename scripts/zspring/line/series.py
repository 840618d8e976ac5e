"""A contact force along a line, from one of our runs or from a user's CSV of any simulator or line test.

A CSV file has a line of column names with units, in any order, and may begin with lines of comment (#):

    contact force [N]           also kN
    time [s]                    also ms; may be missing where there are positions and a speed
    position [m]                also km; of the pantograph along the line, may be missing where there is a time
    wire height [m]             of the contact point, also mm or cm; optional
    support uplift ... [mm]     one column for each support, also m or cm; optional

An underscore counts as a blank, and a number ("contact force 1 [N]") as that of the pantograph: the files that
`zspring couple` and `zspring en50318` write have this form. Other columns are not read. Samples must be even
in time; blank cells are gaps, which are refused and not bridged.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import finite_number, read_rows, split_label

ROUNDING = 1e-6  # of rate and duration, as times come from files
UNEVEN = 0.02  # largest relative deviation of a time step: files round their times
LEAST_RATE = 100.0  # Hz, five samples in a period of 20 Hz
LEAST_PERIODS = 20  # of 20 Hz in a series, 5 of 5 Hz
BAND = 20.0  # Hz, upper end of the standard's frequency range

_TIME = {"s": 1.0, "ms": 1e-3}
_LENGTH = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
_POSITION = {"m": 1.0, "km": 1e3}
_FORCE = {"N": 1.0, "kN": 1e3}


@dataclass(frozen=True)
class Series:
    """What one pantograph does along the line, evenly sampled in time."""

    name: str
    time: np.ndarray  # (n,) s
    force: np.ndarray  # (n,) N, unfiltered
    position: np.ndarray | None = None  # (n,) m, not decreasing
    height: np.ndarray | None = None  # (n,) m, of the contact point
    uplift: Mapping[str, np.ndarray] | None = None  # (n,) m by name of the support
    support_position: Mapping[str, float] | None = None  # m by name of the support, where known

    @property
    def step(self) -> float:
        """Time between samples in s."""
        return float((self.time[-1] - self.time[0]) / (self.time.size - 1))

    @property
    def speed(self) -> float | None:
        """Mean speed in km/h; None without positions."""
        if self.position is None:
            return None
        return float(3.6 * (self.position[-1] - self.position[0]) / (self.time[-1] - self.time[0]))

    def check(self) -> Series:
        """The series itself. Raises ZSpringError where it is uneven, too short or too slowly sampled."""
        steps = np.diff(self.time)
        if not steps.size or steps.min() <= 0:
            at = 0.0 if not steps.size else float(self.time[np.argmin(steps)])
            raise ZSpringError(f"{self.name}: time does not increase after {at:g} s")
        usual = float(np.median(steps))
        wrong = np.flatnonzero(np.abs(steps - usual) > UNEVEN * usual)
        if wrong.size:
            i = wrong[0]
            what = "sample rate changes" if wrong.size > steps.size // 100 + 3 else "gap"
            raise ZSpringError(
                f"{self.name}: {what}: step of {steps[i]:.6g} s at {self.time[i]:.6g} s, {usual:.6g} s elsewhere; "
                "samples must be even in time"
            )
        if 1 / usual < LEAST_RATE * (1 - ROUNDING):
            raise ZSpringError(
                f"{self.name}: {1 / usual:.4g} samples/s: at least {LEAST_RATE:g} are needed for {BAND:g} Hz"
            )
        duration = self.time[-1] - self.time[0]
        if duration < LEAST_PERIODS / BAND * (1 - ROUNDING):
            raise ZSpringError(
                f"{self.name}: {duration:.4g} s is too short for {BAND:g} Hz: at least {LEAST_PERIODS / BAND:g} s "
                "are needed"
            )
        if self.position is not None and np.any(np.diff(self.position) < 0):
            at = self.position[np.argmin(np.diff(self.position))]
            raise ZSpringError(f"{self.name}: position decreases after {at:g} m")
        return self


def read_series(path: Path, speed: float | None = None, pantograph: int = 1) -> Series:
    """The series of a CSV file as described above.

    speed       m/s; gives the time where the file has positions alone, positions where it has a time alone
                (then from 0 m on)
    pantograph  which one, where the names of the columns have numbers
    Raises ZSpringError with file, line and column for a missing or doubled column, a missing or unknown unit,
    and a value that is no finite number; and what Series.check raises.
    """
    labels, rows = read_rows(path)
    columns: dict[str, tuple[int, str | None]] = {}
    for index, label in enumerate(labels):
        name, unit = split_label(label)
        name = _canonical(name, pantograph)
        if name in columns:
            raise ZSpringError(f"{path}: two columns {name!r}")
        columns[name] = (index, unit)
    if not rows:
        raise ZSpringError(f"{path}: no row of values")

    def column(name: str, factors: Mapping[str, float]) -> np.ndarray:
        index, unit = columns[name]
        if unit not in factors:
            given = "has no unit" if unit is None else f"unit [{unit}]"
            raise ZSpringError(f"{path}, column {name!r}: {given}: must be {' or '.join(f'[{u}]' for u in factors)}")
        numbers = [finite_number(path, line, name, row[index]) for line, row in rows]
        return factors[unit] * np.array(numbers)

    if "contact force" not in columns:
        raise ZSpringError(f"{path}: no column 'contact force [N]' (there are: {', '.join(labels)})")
    force = column("contact force", _FORCE)
    position = column("position", _POSITION) if "position" in columns else None
    if "time" in columns:
        time = column("time", _TIME)
        if position is None and speed:
            position = speed * (time - time[0])
    elif position is None:
        raise ZSpringError(f"{path}: no column 'time [s]' or 'position [m]' (there are: {', '.join(labels)})")
    elif not speed:
        raise ZSpringError(f"{path}: no column 'time [s]': the positions need the speed, --speed")
    else:
        time = (position - position[0]) / speed
    height = column("wire height", _LENGTH) if "wire height" in columns else None
    uplift = {
        name.removeprefix("support uplift").strip() or "support": column(name, _LENGTH)
        for name in columns
        if name.startswith("support uplift")
    }
    places = {name: float(found[1]) for name in uplift if (found := re.fullmatch(r"at (\S+) m", name))}
    return Series(str(path), time, force, position, height, uplift, places).check()


def _canonical(name: str, pantograph: int) -> str:
    """Name of a column without underscores and without the pantograph's number, if it is this one."""
    name = " ".join(name.replace("_", " ").lower().split())
    for known in ("contact force", "position", "wire height"):
        if name == f"{known} {pantograph}":
            return known
    return name
