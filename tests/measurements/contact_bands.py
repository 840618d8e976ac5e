"""To which frequency a line's contact force is good: what mesh, step and contact stiffness do to it, band by band.

Part of scripts/benchmark; docs/en50318.md has the table, and a test repeats one row of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from zspring.fmu import Fmu
from zspring.line.journey import Journey, parameter_value
from zspring.line.mean_force import mean_force
from zspring.line.run import run_line
from zspring.line.statistics import low_pass
from zspring.line.system import System
from zspring.parameter_sets import LINES, chosen_set
from zspring.variables import Value

BANDS = ((0, 20), (20, 50), (50, 100), (100, 200))  # Hz
SPANS = 4, 6  # between which boundaries forces are compared, from 0
STEP = 1e-3  # s of the communication; of the catenary the same, of the pantograph half of it


@dataclass(frozen=True)
class Case:
    """Line and pantograph, by the names of their sets, and a speed in km/h."""

    line: str
    pantograph: str
    speed: float
    force: float | None = None  # N, static; None: the FMU's own


CASES = (
    Case("en-50318-2002", "en-50318-2002", 250.0),
    Case("en-50318-2002", "en-50318-2002", 300.0),
    Case("benchmark-2015", "dsa-380-zspring", 300.0, mean_force("AC", 300.0)),
)


@dataclass(frozen=True)
class Variant:
    """Longest element in m, a divisor of all steps, and a factor of contact.k."""

    element: float = 1.0
    divisor: int = 1
    stiffness: float = 1.0


FINE = Variant(0.25, 4)
VARIANTS = {
    "as it is: 1 m, 1 ms": Variant(),
    "elements of 0.5 m": Variant(0.5),
    "elements of 0.25 m": Variant(0.25),
    "half the steps": Variant(1.0, 2),
    "0.5 m, half the steps": Variant(0.5, 2),
    "0.25 m, half the steps": Variant(0.25, 2),
    "twice as fine as the reference": Variant(0.125, 8),
    "reference, contact.k doubled": Variant(0.25, 4, 2.0),
    "reference, contact.k halved": Variant(0.25, 4, 0.5),
}


class Bands:
    """The forces of variants by band, over the same positions."""

    def __init__(self, catenary: Fmu, pantograph: Fmu):
        self._fmus = catenary, pantograph
        self.of = cache(self._of)

    def _of(self, case: Case, variant: Variant) -> list[np.ndarray]:
        """Contact force of each of BANDS in N, each (n,)."""
        catenary, pantograph = self._fmus
        step = STEP / variant.divisor
        line: Mapping[str, Value] = {
            **chosen_set(case.line, catenary, LINES),
            "mesh.element": variant.element,
            "solver.step": step,
        }
        stiffness = parameter_value(pantograph, chosen := chosen_set(case.pantograph, pantograph), "contact.k")
        head = {**chosen, "solver.step": step / 2, "contact.k": variant.stiffness * stiffness}
        if case.force is not None:
            head["static_force"] = case.force
        span = line["line.span"]
        where = [n * span for n in SPANS]
        journey = Journey(case.speed / 3.6, step=step, stop=where[1] + span / 2)
        series = run_line(System(catenary, pantograph, line, [head], journey)).series(0)
        at = np.arange(where[0], where[1], case.speed / 3.6 * STEP)
        below = {edge: low_pass(series.force, step, edge) for band in BANDS for edge in band if edge}
        parts = (below[high] - below.get(low, 0.0) for low, high in BANDS)
        return [np.interp(at, series.position, part) for part in parts]

    def differences(self, case: Case, variant: Variant) -> list[tuple[float, float]]:
        """By band: rms difference from FINE, and FINE's standard deviation, in N."""
        pairs = zip(self.of(case, variant), self.of(case, FINE))
        return [(float(np.sqrt(np.mean((found - fine) ** 2))), float(np.std(fine))) for found, fine in pairs]

    def deviations(self, case: Case, variant: Variant) -> np.ndarray:
        """Standard deviation by band in N."""
        return np.array([np.std(part) for part in self.of(case, variant)])


def contact_bands(catenary: Fmu, pantograph: Fmu) -> None:
    """Print what the variants change against the reference, over all CASES: rms differences, standard deviations."""
    bands = Bands(catenary, pantograph)
    header = f"{'':<32}" + "".join(f"{'{}-{} Hz'.format(*band):>16}" for band in BANDS)
    print(f"\nContact force by band against {FINE.element:g} m, {1e3 * STEP / FINE.divisor:g} ms")
    print(f"rms difference, worst, in % of the band's standard deviation\n{header}")
    for label, variant in VARIANTS.items():
        each = [bands.differences(case, variant) for case in CASES]
        worst = (max(100 * change / whole for change, whole in of_band) for of_band in zip(*each))
        print(f"{label:<32}" + "".join(f"{share:>14.2g} %" for share in worst), flush=True)
    print(f"change of the standard deviation, lowest and highest, in %\n{header}")
    for label, variant in VARIANTS.items():
        changes = np.array([bands.deviations(case, variant) / bands.deviations(case, FINE) - 1 for case in CASES])
        ranges = zip(100 * changes.min(axis=0), 100 * changes.max(axis=0))
        print(f"{label:<32}" + "".join(f"{low:>+8.2g} .. {high:<+4.2g}" for low, high in ranges))
