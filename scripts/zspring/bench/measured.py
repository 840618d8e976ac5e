"""Measured frequency responses from files: one curve for each level of the amplitude.

The file is a table as `tables.py` reads it, with the columns, in any order:

    frequency [Hz]      in the order in which the points were measured, if that matters
    amplitude [UNIT]    peak of the imposed sine, nominal or as it was reached; the unit tells whether
                        displacement, velocity or acceleration; may be missing where the settings give it
    level               of the amplitude, a number or a name; may be missing, see `levels`
    real [UNIT], imaginary [UNIT], or magnitude [UNIT], phase [deg or rad]
                        the unit tells the kind of response, see `responses`

    magnitude_error     standard error of the magnitude, in its unit or in %
    phase_error [deg or rad]    that of the phase; both or none
    common_error [1 or %]       the part of either that neighbouring points share, of the magnitude; may be missing
    harmonic_2 [N] ... harmonic_7 [N]   peaks of the contact force's harmonics, as many as were measured, and their
    harmonic_2_error [N] ...            standard errors, if they are known; an empty cell for one that is not

Other columns are not read. The file that `zspring frf` writes has this form (its H_re and H_im are read);
points that it marks as left out or failed are passed over. What its head says of the bench, `conditions` reads.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import ZSpringError
from ..tables import Table, read_table
from ..units import UnitError
from .conditions import is_universal
from .curves import Curve, Harmonics, Source
from .levels import levels_of, named_levels
from .responses import HARMONICS, acceleration_of, response_of
from .uff import read_uff

ROUNDED = 1e-6  # relative, of what files have
ALIASES = {"h re": "real", "h im": "imaginary", "imag": "imaginary"}


def read_curves(source: Source) -> list[Curve]:
    """All curves of a file, CSV or UFF data set 58 by its suffix. Raises ZSpringError, see the readers."""
    if is_universal(source.path):
        curves = read_uff(source.path, source.amplitude, source.data_sets)
    elif source.data_sets:
        raise ZSpringError(f"{source.path}: data_sets are for universal files (.uff, .unv)")
    else:
        curves = read_csv(source.path, source.amplitude)
    return [source.corrected(curve) for curve in curves]


def read_csv(path: Path, amplitude: float | None) -> list[Curve]:
    """The curves of a CSV file as described above; `amplitude` in m/s2 where the file has none.

    Raises ZSpringError with file, line and column for a missing column or unit, and a value that is no finite
    number or not positive where it must be.
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

    if "level" in table:
        levels = named_levels(table["level"].cells)
    else:
        levels = levels_of(frequency, acceleration, steps, step_unit)
    errors = _errors(table, kind, np.abs(value))
    whole = Curve("", frequency, acceleration, H, errors, _common(table, errors), _harmonics(table))
    return [replace(whole.at(level.points), label=level.label) for level in levels]


def _errors(table: Table, kind: str, magnitude: np.ndarray) -> np.ndarray | None:
    """Standard errors (n, 2) as a curve has them, of responses that stand in columns of this kind."""
    told = [name for name in ("magnitude error", "phase error") if name in table]
    if not told:
        return None
    if len(told) == 1:
        raise ZSpringError(f"{table.path}: {told[0].replace(' ', '_')} alone: needs magnitude_error and phase_error")
    unit = table.unit("magnitude error")
    if unit == table.unit(kind):
        relative = table.numbers("magnitude error", positive=True) / magnitude
    else:
        relative = table.numbers("magnitude error", "1", positive=True)
    return np.column_stack([relative, table.numbers("phase error", "rad", positive=True)])


def _common(table: Table, errors: np.ndarray | None) -> np.ndarray | None:
    """The part (n,) of errors (n, 2) that neighbouring points share. Raises ZSpringError where it is no part."""
    if "common error" not in table:
        return None
    common = table.numbers("common error", "1")
    least = np.full(common.shape, np.nan) if errors is None else errors.min(axis=1)
    for line, value, whole in zip(table.lines, common, least):
        if not 0 <= value <= whole * (1 + ROUNDED):
            text = f"{table.path}, line {line}: common_error = {100 * value:g} %: must be a part of magnitude_error and"
            raise ZSpringError(f"{text} phase_error" + ("" if errors is None else f", so 0 to {100 * whole:g} %"))
    return common


def _harmonics(table: Table) -> Harmonics | None:
    """Those that have a column."""
    names = [f"harmonic {n}" for n in HARMONICS]
    if not any(name in table for name in names):
        return None
    unknown = np.full(len(table.lines), np.nan)
    peak, error = (
        np.column_stack([table.numbers(name, "N", gaps=True) if name in table else unknown for name in columns])
        for columns in (names, [f"{name} error" for name in names])
    )
    return Harmonics(peak, error)
