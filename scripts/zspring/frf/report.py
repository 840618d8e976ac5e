"""What is said about an FRF: head of its file, table of resonances, solver statistics, error estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ..bench.measure import BENCH_PARAMETERS
from ..bench.points import FAILED, NOT_HELD, NOT_SETTLED, REPEATS, FrfPoint, FrfSettings, differences
from ..bench.refine import JUMP, Extreme
from ..bench.responses import QUANTITIES, RESPONSES
from ..fmu import Fmu
from ..heads import file_head, model_note, now, synthetic_note
from ..receptance import LinearModel
from ..text_tables import aligned, with_error
from ..variables import Value
from .backbone import PhaseResonance, Row, exact_phase_resonances
from .bounds import exact_extremes

ERROR_LIMIT = 0.01  # of |H|, by the estimate from half the step; more is warned of


DOUBTS = {  # mark and meaning
    NOT_SETTLED: ("?", "rests on points not settled"),
    JUMP: ("|", "the curve jumps there"),
}


def frf_head(fmu: Fmu, settings: FrfSettings, parameters: Mapping[str, Value], quantity: str) -> dict[str, str]:
    """Everything that defines the numbers of an FRF file, and the date.

    `parameters` are all parameters of the FMU, calculated ones included.
    """
    own = {
        "date": now(),
        "SHA-256 of the FMU": fmu.sha256,
        "quantity": RESPONSES[QUANTITIES[quantity]].name,
        **settings.described(),
    }
    return file_head(fmu, parameters, own, but_not=BENCH_PARAMETERS)


def title(fmu: Fmu, settings: FrfSettings, parameters: Mapping[str, Value], pantograph: str) -> str:
    """Title of the figure: what was measured and whether any number of the Z-spring is synthetic."""
    course = {"rest": "each point from rest", "both": "sweeps up and down"}.get(
        settings.direction, f"sweep {settings.direction}"
    )
    about = f"{model_note(fmu, parameters)}, {course}{synthetic_note(fmu, parameters)}"
    held = "" if settings.control == "acceleration" else f", {settings.control} held"
    return f"First-order FRF at the head{held}, {pantograph}\n{about}"


def resonance_rows(
    measured: Mapping[str, Mapping[float, Sequence[Extreme]]],
    phases: Mapping[str, Mapping[float, Sequence[PhaseResonance]]],
    bounds: Mapping[str, LinearModel],
    band: tuple[float, float],
    unit: str,
) -> list[Row]:
    """Extremes of the receptance, of the levels between the linear bounds.

    measured    by direction and level (in `unit`); phases likewise, its resonances by phase
    band        Hz, where those of the bounds are looked for; they are exact
    """
    first, *last = (
        Row(name, "", exact_extremes(model, band), exact_phase_resonances(model, band))
        for name, model in bounds.items()
    )
    levels = sorted({level for found in measured.values() for level in found})
    middle = [
        Row(f"{level:g} {unit}", way, found[level], phases[way][level], level, unit)
        for level in levels
        for way, found in measured.items()
    ]
    return [first, *middle, *last]


def resonance_table(rows: Sequence[Row]) -> list[str]:
    """Lines with resonances and antiresonances by curve."""
    several = len({row.direction for row in rows if row.direction}) > 1
    maxima, minima = (
        [[_cell(e) for e in row.extremes if e.is_resonance is kind] for row in rows] for kind in (True, False)
    )
    width = max(1, *map(len, maxima))
    table = [["", "resonances: Hz, mm/N", *[""] * (width - 1), "antiresonances"]]
    for row, high, low in zip(rows, maxima, minima):
        name = f"{row.curve} {row.direction}".rstrip() if several else row.curve
        table.append([name, *high, *[""] * (width - len(high)), *low])
    doubts = {e.doubt for row in rows for e in row.extremes}
    notes = [f"; {mark} {meaning}" for doubt, (mark, meaning) in DOUBTS.items() if doubt in doubts]
    return [*aligned(table), "".join(["in brackets: error of the last digit", *notes])]


def difference_lines(up: Sequence[FrfPoint], down: Sequence[FrfPoint], tolerance: float) -> list[str]:
    """How far the sweep down is from the sweep up by level, and at how many points that is no transient."""
    found = differences(up, down)
    if not found:
        return []
    worst = []
    for level in dict.fromkeys(level for level, _ in found):
        place = max((key for key in found if key[0] == level), key=found.__getitem__)
        worst.append(f"{100 * found[place]:.2g} % at {level:g} {up[0].unit} ({place[1]:g} Hz)")
    left = {p.place: 0.0 for p in up}
    for p in (*up, *down):
        left[p.place] += max(p.remaining, tolerance)
    other = sum(difference > left[key] for key, difference in found.items())
    lines = [f"up and down differ by at most {', '.join(worst)}"]
    if other:
        lines.append(f"at {other} of {len(found)} points by more than is left of both transients: two steady states")
    return lines


def solver_line(points: Iterable[FrfPoint]) -> str:
    """Newton statistics over all points."""
    points = list(points)
    steps, iterations = sum(p.steps for p in points), sum(p.iterations for p in points)
    worst, halvings = max(p.iterations_max for p in points), sum(p.refinements for p in points)
    return (
        f"Newton: {iterations / max(steps, 1):.2f} iterations per step, at most {worst}; "
        f"{steps} steps, {halvings} halvings"
    )


def richardson(H: complex, H_half: complex) -> float:
    """Relative error of |H - exact| estimated for a second-order method from the same at half the step."""
    return 4 / 3 * abs(H - H_half) / abs(H)


def error_line(errors: Mapping[tuple[float, float], float], unit: str = "m/s2") -> str:
    """Median and worst of the estimates by level (in `unit`) and frequency."""
    (level, frequency), worst = max(errors.items(), key=lambda item: item[1])
    return (
        f"error estimate of H from half the step: {100 * np.median(list(errors.values())):.2g} % median, "
        f"{100 * worst:.2g} % worst (at {frequency:g} Hz, {level:g} {unit})"
    )


def error_warnings(errors: Mapping[tuple[float, float], float]) -> list[str]:
    """One line where estimates exceed the limit, else none."""
    beyond = sum(error > ERROR_LIMIT for error in errors.values())
    limit = f"{100 * ERROR_LIMIT:g} %"
    text = f"the error of H exceeds {limit} at {beyond} of {len(errors)} points: take a smaller --set solver.step"
    return [text] if beyond else []


def doubtful_lines(points: Iterable[FrfPoint]) -> list[str]:
    """One line for each point that did not settle, repeats only after several periods, was not held, or failed."""
    lines = []
    for p in points:
        about = ""
        if p.status == NOT_SETTLED:
            about = f" after {p.periods} periods (change {p.change:.2g}, about {p.remaining:.2g} from steady)"
        elif p.status.startswith(REPEATS):
            about = f": repeats only after so many periods of the drive (change {p.change:.2g})"
        elif not p.status.startswith((FAILED, NOT_HELD)):
            continue
        lines.append(f"{p.label}, {p.frequency:g} Hz: {p.status}{about}")
    return lines


def _cell(extreme: Extreme) -> str:
    frequency = with_error(extreme.frequency, extreme.frequency_error, 3)
    magnitude = with_error(1e3 * extreme.magnitude, 1e3 * extreme.magnitude_error, 4)
    return f"{frequency} {magnitude}{DOUBTS[extreme.doubt][0] if extreme.doubt else ''}"
