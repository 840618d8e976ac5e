"""Measured frequency responses from files: one curve for each amplitude.

The file is a table as `tables.py` reads it, with the columns, in any order:

    frequency [Hz]      increasing within each amplitude
    amplitude [UNIT]    peak of the imposed sine; the unit tells whether displacement, velocity or
                        acceleration; may be missing where the settings give it
    real [UNIT], imaginary [UNIT], or magnitude [UNIT], phase [deg or rad]
                        the unit tells the kind of response, see `responses`

Other columns are not read. The file that `zspring frf` writes has this form (its H_re and H_im are read);
points that it marks as left out or failed are passed over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import read_table
from ..units import UnitError
from .responses import acceleration_of, response_of

ALIASES = {"h re": "real", "h im": "imaginary", "imag": "imaginary"}


@dataclass(frozen=True)
class Curve:
    """Receptance measured with one amplitude."""

    label: str  # of the amplitude, with its unit
    frequency: np.ndarray  # (n,) Hz, increasing
    acceleration: np.ndarray  # (n,) m/s2, peak
    H: np.ndarray  # (n,) m/N, complex

    def within(self, band: tuple[float, float]) -> Curve:
        """The points with frequencies in the band (Hz)."""
        return self.at((self.frequency >= band[0]) & (self.frequency <= band[1]))

    def at(self, points: np.ndarray) -> Curve:
        """Only some points, by index or by mask."""
        return replace(self, frequency=self.frequency[points], acceleration=self.acceleration[points], H=self.H[points])


@dataclass(frozen=True)
class Source:
    """A file of measured responses and what the file does not tell."""

    path: Path
    amplitude: float | None = None  # m/s2, peak
    force: str = "specimen"  # positive along the displacement, or "contact": positive pressing the head down
    fixture_mass: float = 0.0  # kg, of what moves between load cell and head

    def corrected(self, curve: Curve) -> Curve:
        """With this sign of the force, and without the inertia of the fixture: F_head = F_cell - m a."""
        H = -curve.H if self.force == "contact" else curve.H
        stiffness = 1 / H + self.fixture_mass * (2 * np.pi * curve.frequency) ** 2
        return replace(curve, H=1 / stiffness)


def read_curves(source: Source) -> list[Curve]:
    """All curves of a file, CSV or UFF data set 58 by its suffix. Raises ZSpringError, see the readers."""
    if source.path.suffix.lower() in (".uff", ".unv", ".uf"):
        from .uff import read_uff  # needs an optional package

        curves = read_uff(source.path, source.amplitude)
    else:
        curves = read_csv(source.path, source.amplitude)
    return [source.corrected(curve) for curve in curves]


def read_csv(path: Path, amplitude: float | None) -> list[Curve]:
    """The curves of a CSV file as described above; `amplitude` in m/s2 where the file has none.

    Raises ZSpringError with file, line and column for a missing column or unit, a value that is no finite
    number or not positive where it must be, and frequencies that do not increase.
    """
    table = read_table(path, ALIASES)
    if "status" in table:
        table = table.where(not cell.startswith(("left out", "failed")) for cell in table["status"].cells)
    if not table.lines:
        raise ZSpringError(f"{path}: no row with a measured point")
    frequency = table.numbers("frequency", "Hz", positive=True)
    if "real" in table or "imaginary" in table:
        kind = "real"
        value = table.numbers("real") + 1j * table.numbers("imaginary")
        real, imaginary = table.unit("real"), table.unit("imaginary")
        if real != imaginary:
            raise ZSpringError(f"{path}, column 'imaginary': unit [{imaginary}]: must be {real}")
    else:
        kind, phase = "magnitude", table.numbers("phase", "rad")
        value = table.numbers("magnitude", positive=True) * np.exp(1j * phase)
    for line, number in zip(table.lines, value):
        if number == 0:
            raise ZSpringError(f"{path}, line {line}: the response is 0")
    if "amplitude" in table:
        steps, step_unit = table.numbers("amplitude", positive=True), table.unit("amplitude")
    elif amplitude:
        steps, step_unit = np.full(frequency.shape, amplitude), "m/s2"
    else:
        raise ZSpringError(f"{path}: no column 'amplitude', and none given for the file in the settings")
    try:
        H = response_of(table.unit(kind)).receptance(frequency, value)
    except UnitError as error:
        raise ZSpringError(f"{path}, column {kind!r}: {error}") from None
    try:
        acceleration = acceleration_of(step_unit, frequency, steps)
    except UnitError as error:
        raise ZSpringError(f"{path}, column 'amplitude': {error}") from None

    curves = []
    for step in dict.fromkeys(steps.tolist()):
        points = np.flatnonzero(steps == step)
        late = np.flatnonzero(np.diff(frequency[points]) <= 0)
        if late.size:
            before, after = points[late[0]], points[late[0] + 1]
            raise ZSpringError(
                f"{path}, line {table.lines[after]}: frequency = {frequency[after]:g} Hz after "
                f"{frequency[before]:g} Hz: must increase within one amplitude"
            )
        curves.append(Curve(f"{step:g} {step_unit}", frequency[points], acceleration[points], H[points]))
    return curves


def in_band(curves: Sequence[Curve], band: tuple[float, float]) -> list[Curve]:
    """The curves within a frequency band (Hz). Raises ZSpringError if one has no point there."""
    kept = [curve.within(band) for curve in curves]
    for before, after in zip(curves, kept):
        if not after.frequency.size:
            low, high = before.frequency[[0, -1]]
            raise ZSpringError(
                f"band {band[0]:g} to {band[1]:g} Hz: no data with {before.label}, which was measured from "
                f"{low:g} to {high:g} Hz"
            )
    return kept


def sign_warning(curves: Sequence[Curve]) -> str | None:
    """What to say if most points give energy out, which no passive pantograph does."""
    imaginary = np.concatenate([curve.H.imag for curve in curves])
    wrong = int(np.sum(imaginary > 0))
    if 2 * wrong <= imaginary.size:
        return None
    return (
        f"at {wrong} of {imaginary.size} points the receptance has a positive imaginary part, as if the head "
        'gave energy out: is the force counted as contact force (force = "contact"), or the phase reversed?'
    )
