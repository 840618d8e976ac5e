"""The mechanism study from settings to result folder."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..bench.points import FrfSettings
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..heads import file_head, synthetic_note
from ..records import keep_others
from ..tables import write_table
from ..variables import Value, exact, exact_list, text
from .animation import animation_html
from .cycle import Cycle, simulate_cycle
from .plot import mechanism_figure

LARGEST_DRAWN = 0.025  # m, of the compression; smaller motion is magnified up to this


def run_mechanism(
    fmu: Fmu,
    parameters: Mapping[str, Value],
    frequency: float,
    accelerations: Sequence[float],
    folder: Path,
    suffix: str,
) -> None:
    """Write mechanism.csv, the figure and mechanism.html; one cycle for each peak acceleration in m/s2.

    Raises ZSpringError for a suspension without rods and for motion beyond the standard figure's stroke,
    FmuError when the FMU refuses a parameter.
    """
    used = fmu.used_parameters(parameters)
    suspension = text(fmu.variables["suspension"], used["suspension"])
    if suspension == "Linear":
        raise ZSpringError("suspension = Linear: has no linkage to draw")
    stroke = FrfSettings().stroke
    omega = 2 * math.pi * frequency
    for acceleration in accelerations:
        if acceleration > stroke * omega * omega > 0:
            raise ZSpringError(f"{frequency:g} Hz at {acceleration:g} m/s2: needs more stroke than {1e3 * stroke:g} mm")
    table, figure, page = (folder / f"mechanism.{kind}" for kind in ("csv", suffix, "html"))
    listed = {name: value for name, value in used.items() if not name.startswith(("bench.", "drive"))}
    own = {"frequency": f"{exact(frequency)} Hz", "accelerations": exact_list(accelerations, "m/s2")}
    head = file_head(fmu, listed, own)
    keep_others(table, head)
    with fmu.instances() as (instance,):
        cycles = [simulate_cycle(instance, parameters, frequency, acceleration) for acceleration in accelerations]
    magnifications = [magnification(cycle) for cycle in cycles]
    write_table(table, head, _COLUMNS, (row for cycle in cycles for row in _rows(cycle)))
    title = f"Linkage of the head suspension, seen from the upper frame{synthetic_note(fmu, used)}"
    save(mechanism_figure(cycles, magnifications, title), figure)
    about = f"A steady cycle at {frequency:g} Hz, simulated{synthetic_note(fmu, used)}."
    page.write_text(animation_html(cycles, magnifications, about), encoding="utf-8", newline="\n")
    for cycle in cycles:
        print(
            f"{cycle.frequency:g} Hz, {cycle.acceleration:g} m/s2: head {1e3 * np.ptp(cycle.u1) / 2:.2f} mm, "
            f"on the frame {-1e3 * cycle.compression.max():.2f} to {-1e3 * cycle.compression.min():+.2f} mm; "
            f"rods turn by {np.degrees(cycle.swing):.3f} deg: {'slipping' if cycle.slips else 'stuck'}"
        )
    print("written:", table, figure, page)


def magnification(cycle: Cycle) -> float:
    """1, 2, 5, 10, 20, ...: the largest by which the compression is drawn no longer than LARGEST_DRAWN."""
    room = LARGEST_DRAWN / max(np.abs(cycle.compression).max(), 1e-6)
    decade = 10.0 ** math.floor(math.log10(max(room, 1.0)))
    return max((step * decade for step in (1, 2, 5) if step * decade <= room), default=1.0)


_COLUMNS = [
    "acceleration [m/s2]",
    "time [s]",
    "head.z [m]",
    "upper_frame.z [m]",
    "zspring.alpha [rad]",
    "zspring.beta [rad]",
    "zspring.moment_alpha [N.m]",
    "zspring.moment_beta [N.m]",
]


def _rows(cycle: Cycle) -> list[list[float]]:
    time = np.arange(len(cycle.u1)) / (len(cycle.u1) * cycle.frequency)
    columns = [time, cycle.u1, cycle.u2, cycle.alpha, cycle.beta, *cycle.moments.T]
    return [[cycle.acceleration, *row] for row in np.transpose(columns).tolist()]
