"""A contact force along a line, from one of our runs or from a user's CSV of any simulator or line test.

The file is a table as `tables.py` reads it, with the columns, in any order:

    contact force [N]
    time [s]                    may be missing where there are positions and a speed
    position [m]                of the pantograph along the line, may be missing where there is a time
    wire height [m]             of the contact point; optional
    support uplift ... [mm]     one column for each support; optional
    uplift at X m [mm]          of the contact wire at any point, X m along the line, one column for each; optional

or other units of these kinds. A number ("contact force 1 [N]") counts as that of the pantograph: the files that
`zspring couple` and `zspring en50318` write have this form; contact.force, as `zspring simulate` writes it, is the
contact force. Other columns are not read. The head may say more of the line: see `stated.py`.

A force that presses the head down is positive, so that its mean is, too. Samples must be even in time. Blank cells,
and numbers that stand for no value (-9999), are gaps, which are refused and not bridged.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import Table, read_table
from .stated import SAME_SPEED, Stated, agreed

ROUNDING = 1e-6  # of rate and duration, as times come from files
UNEVEN = 0.02  # largest relative deviation of a time step: files round their times
LEAST_RATE = 100.0  # Hz, five samples in a period of 20 Hz
LEAST_PERIODS = 20  # of 20 Hz in a series, 5 of 5 Hz
BAND = 20.0  # Hz, upper end of the standard's frequency range
POSSIBLE = -500.0, 5000.0  # N: a contact only presses, but what is measured has noise; far beyond any peak
NEAR = 2.0  # m from the usual height, within which a contact point or a lifted support is
_POINT = re.compile(r"uplift at ([-+]?\d+(?:\.\d+)?) m")
_NO_VALUE = re.compile(r"[-+]?9{3,}(?:[.,][09]{0,4})?")  # signs for no value: -999, -9999.0, 9999.99


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
    stated: Stated = field(default_factory=Stated)
    points: Mapping[float, np.ndarray] = field(default_factory=dict)  # (n,) m, uplift of the wire by position in m

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

    def moved(self, by: float) -> Series:
        """The series with all positions `by` m further along."""
        if not by:
            return self
        supports = {name: place + by for name, place in (self.support_position or {}).items()}
        points = {place + by: values for place, values in self.points.items()}
        position = None if self.position is None else self.position + by
        return replace(self, position=position, support_position=supports, points=points)

    def check(self) -> Series:
        """The series itself. Raises ZSpringError where it is uneven, too short or too slowly sampled."""
        steps = np.diff(self.time)
        if not steps.size or steps.min() <= 0:
            at = 0.0 if not steps.size else float(self.time[np.argmin(steps)])
            raise ZSpringError(f"{self.name}: time does not increase after {at:.13g} s")
        usual = float(np.median(steps))
        wrong = np.flatnonzero(np.abs(steps - usual) > UNEVEN * usual)
        if wrong.size:
            i = wrong[0]
            what = "sample rate changes" if wrong.size > steps.size // 100 + 3 else "gap"
            raise ZSpringError(
                f"{self.name}: {what}: step of {steps[i]:.6g} s at {self.time[i]:.13g} s, {usual:.6g} s elsewhere; "
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


def read_series(path: Path, speed: float | None = None, pantograph: int = 1, turned: bool = False) -> Series:
    """The series of a CSV file as described above.

    speed       m/s; gives the time where the file has positions alone, positions where it has a time alone
                (then from 0 m on); by default that of the file's head
    pantograph  which one, where the names of the columns have numbers
    turned      in the file forces are negative where they press the head down
    Raises ZSpringError with file, line and column for a missing or doubled column, a missing or unknown unit,
    a value that is no finite number or none that can be; where speeds disagree; where the mean force is not
    positive; and what Series.check raises.
    """
    aliases = {f"{name} {pantograph}": name for name in ("contact force", "position", "wire height")}
    table = read_table(path, {**aliases, "contact.force": "contact force"})
    if not table.lines:
        raise ZSpringError(f"{path}: no row of values")
    labels = ", ".join(column.label for column in table.columns.values())
    if "contact force" not in table:
        raise ZSpringError(f"{path}: no column 'contact force [N]' (there are: {labels})")
    stated = Stated.in_head(path, table.head, pantograph)
    force = _values(table, "contact force", "N") * (-1 if turned else 1)
    _within(table, "contact force", force, (-POSSIBLE[1], POSSIBLE[1]), "N")  # what is no force has no sign
    require_pressing(str(path), float(np.mean(force)))
    _within(table, "contact force", force, POSSIBLE, "N")
    position = table.numbers("position", "m") if "position" in table else None
    said = {"the head of the file": stated.speed, "--speed": speed}
    if "time" in table:
        time = table.numbers("time", "s")
        if position is not None and time.size > 1 and time[-1] > time[0]:
            said["its times and positions"] = float((position[-1] - position[0]) / (time[-1] - time[0]))
        speed = _speed(path, said)
        if position is None and speed:
            position = speed * (time - time[0])
    elif position is None:
        raise ZSpringError(f"{path}: no column 'time [s]' or 'position [m]' (there are: {labels})")
    elif not (speed := _speed(path, said)):
        raise ZSpringError(f"{path}: no column 'time [s]': the positions need the speed, --speed")
    else:
        time = (position - position[0]) / speed
    height = _values(table, "wire height", "m") if "wire height" in table else None
    if height is not None:
        usual = float(np.median(height))
        _within(table, "wire height", height, (usual - NEAR, usual + NEAR), "m")
    uplift, points = {}, {}
    for name in table.columns:
        is_point = _POINT.fullmatch(name)
        if name.startswith("support uplift") or is_point:
            values = _values(table, name, "m")
            _within(table, name, values, (-NEAR, NEAR), "m")
            if is_point:
                points[float(is_point[1])] = values
            else:
                uplift[name.removeprefix("support uplift").strip() or "support"] = values
    places = {name: float(found[1]) for name in uplift if (found := re.fullmatch(r"at (\S+) m", name))}
    return Series(str(path), time, force, position, height, uplift, places, stated, points).check()


def require_pressing(name: str, mean: float) -> None:
    """Raises ZSpringError for a mean in N that no contact force has."""
    if not mean > 0:
        raise ZSpringError(
            f"{name}: mean contact force = {mean:.4g} N: must be above 0, forces that press the head down are positive "
            "(--turn-force takes those of a file with the other sign)"
        )


def _speed(path: Path, said: Mapping[str, float | None]) -> float | None:
    """m/s, from who says it."""
    kmh = {name: None if value is None else 3.6 * value for name, value in said.items()}
    speed = agreed(f"{path}: speed", "km/h", kmh, SAME_SPEED)
    return speed and speed / 3.6


def _values(table: Table, name: str, unit: str) -> np.ndarray:
    """A column (n,) whose cells are values and not signs for no value."""
    for line, cell in zip(table.lines, table[name].cells):
        if _NO_VALUE.fullmatch(cell):
            raise ZSpringError(
                f"{table.path}, line {line}: {name} = {cell}: is a sign for no value; gaps are not bridged"
            )
    return table.numbers(name, unit)


def _within(table: Table, name: str, values: np.ndarray, allowed: tuple[float, float], unit: str) -> None:
    """Raises ZSpringError for the first value that cannot be."""
    low, high = allowed
    for i in np.flatnonzero((values < low) | (values > high))[:1]:
        raise ZSpringError(
            f"{table.path}, line {table.lines[i]}: {name} = {values[i]:.6g} {unit}: must be in {low:.4g} .. {high:.4g} "
            f"{unit}"
        )
