"""What is said about an FRF: head of its file, table of resonances, solver statistics, error estimate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ..bench.measure import BENCH_PARAMETERS, FAILED, NOT_SETTLED, REPEATS, FrfPoint, FrfSettings
from ..bench.resonances import extremes
from ..fmu import Fmu
from ..heads import file_head, now, synthetic_note
from ..receptance import receptance
from ..variables import Value, text

Curve = tuple[np.ndarray, np.ndarray]  # frequency (n,) in Hz, receptance (n,) in m/N


def frf_head(fmu: Fmu, settings: FrfSettings, parameters: Mapping[str, Value], quantity: str) -> dict[str, str]:
    """Everything that defines the numbers of an FRF file, and the date.

    `parameters` are all parameters of the FMU, calculated ones included.
    """
    own = {
        "date": now(),
        "SHA-256 of the FMU": fmu.sha256,
        "quantity": "receptance H" if quantity == "receptance" else "dynamic stiffness 1/H",
        **settings.described(),
    }
    return file_head(fmu, parameters, own, but_not=BENCH_PARAMETERS)


def title(fmu: Fmu, settings: FrfSettings, parameters: Mapping[str, Value]) -> str:
    """Title of the figure: what was measured and whether any number of the Z-spring is synthetic."""
    suspension, friction = (text(fmu.variables[name], parameters[name]) for name in ("suspension", "friction"))
    model = f"Z-spring, friction {friction}" if suspension == "ZSpring" else f"suspension {suspension}"
    course = "each point from rest" if settings.direction == "rest" else f"sweep {settings.direction}"
    return f"Pantograph head, first-order FRF\n{model}, {course}{synthetic_note(fmu, parameters)}"


def linear_bounds(settings: FrfSettings, parameters: Mapping[str, Value], linear: bool) -> dict[str, Curve]:
    """Receptances of the linear models over the figure's range: "locked" and "free", or "linear" alone."""
    frequency = np.linspace(min(settings.frequencies), max(settings.frequencies), 4001)
    models = ["linear"] if linear else ["locked", "free"]
    return {model: (frequency, receptance(frequency, parameters, model)) for model in models}


def resonance_table(points: Sequence[FrfPoint], bounds: Mapping[str, Curve]) -> list[str]:
    """Lines with resonances and antiresonances of the receptance, by amplitude, between the linear bounds."""
    curves = {f"{model}": curve for model, curve in bounds.items()}
    measured = {}
    for amplitude in sorted({point.amplitude for point in points}):
        curve = sorted((p for p in points if p.amplitude == amplitude), key=lambda p: p.frequency)
        measured[f"{amplitude:g} m/s2"] = (np.array([p.frequency for p in curve]), np.array([p.H for p in curve]))
    first, *last = curves.items()
    rows = [(name, *(_cells(found) for found in extremes(*curve))) for name, curve in [first, *measured.items(), *last]]
    width = max(len(row[1]) for row in rows)
    return [
        f"{'':10s}  {'resonances, Hz (mm/N)':{width}s}  antiresonances, Hz (mm/N)",
        *(f"{name:>10s}  {maxima:{width}s}  {minima}" for name, maxima, minima in rows),
    ]


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


def error_line(errors: Mapping[tuple[float, float], float]) -> str:
    """Median and worst of the estimates by (amplitude, frequency)."""
    (amplitude, frequency), worst = max(errors.items(), key=lambda item: item[1])
    return (
        f"error estimate of H from half the step: {100 * np.median(list(errors.values())):.2g} % median, "
        f"{100 * worst:.2g} % worst (at {frequency:g} Hz, {amplitude:g} m/s2)"
    )


def doubtful_lines(points: Iterable[FrfPoint]) -> list[str]:
    """One line for each point that did not settle, repeats only after several periods, or failed."""
    lines = []
    for p in points:
        about = ""
        if p.status == NOT_SETTLED:
            about = f" after {p.periods} periods (change {p.change:.2g}, about {p.remaining:.2g} from steady)"
        elif p.status.startswith(REPEATS):
            about = f": repeats only after so many periods of the drive (change {p.change:.2g})"
        elif not p.status.startswith(FAILED):
            continue
        lines.append(f"{p.amplitude:g} m/s2, {p.frequency:g} Hz: {p.status}{about}")
    return lines


def _cells(found: Iterable[tuple[float, float]]) -> str:
    return "   ".join(f"{frequency:6.3f} ({1e3 * magnitude:.4f})" for frequency, magnitude in found)
