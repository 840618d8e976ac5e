"""What is said about a fit: parameters, how well they are determined, residuals by amplitude."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..bench.curves import Curve
from ..fmu import Fmu
from .fit import Fit
from .problem import Problem

STRONG_CORRELATION = 0.98


def parameter_table(fmu: Fmu, problem: Problem, fit: Fit) -> list[str]:
    """Fitted values with standard errors, start values and bounds."""
    rows = [["", "fitted", "std. error", "unit", "start", "bounds", ""]]
    for i, (name, free) in enumerate(problem.settings.free.items()):
        error = fit.standard_error[i]
        relative = f" ({100 * error / abs(fit.values[i]):.2g} %)" if fit.values[i] and np.isfinite(error) else ""
        rows.append(
            [
                name,
                _with_error(fit.values[i], error),
                "-" if np.isnan(error) else f"{error:.2g}{relative}",
                fmu.variables[name].unit or "",
                f"{free.start:g}",
                f"{free.minimum:g} .. {free.maximum:g}",
                "at the bound" if fit.at_bound[i] else "",
            ]
        )
    return aligned(rows)


def doubts(problem: Problem, fit: Fit) -> list[str]:
    """A line for everything that makes the result less than it seems."""
    lines = [] if fit.is_converged else [f"least squares did not converge: {fit.message}"]
    names = list(problem.settings.free)
    for i, (name, free) in enumerate(problem.settings.free.items()):
        error, half_range = fit.unbound_error[i], (free.maximum - free.minimum) / 2
        place = f", at its bound {fit.values[i]:g}" if fit.at_bound[i] else ""
        if np.isinf(error):
            lines.append(f"the data do not determine {name}{place}: no effect of its own on the fit")
        elif error > half_range:
            lines.append(
                f"the data do not determine {name}{place}: its standard error {error:.2g} is more "
                "than half the range between its bounds"
            )
        elif fit.at_bound[i]:
            lines.append(f"{name} is at its bound {fit.values[i]:g}: the data want it there or beyond")
    for i in range(len(names)):
        for j in range(i):
            if abs(fit.correlation[i, j]) > STRONG_CORRELATION:
                lines.append(
                    f"{names[j]} and {names[i]} can hardly be told apart: correlation {fit.correlation[i, j]:.3f}"
                )
    failed = sum(int(np.sum(~np.isfinite(H))) for H in fit.answer.curves)
    if failed:
        lines.append(f"{failed} points could not be computed at the solution and count as a penalty")
    return lines


def correlation_table(problem: Problem, fit: Fit) -> list[str]:
    """Correlations of the fitted parameters, below the diagonal."""
    names = list(problem.settings.free)
    rows = [["correlation", *names[:-1]]]
    for i in range(1, len(names)):
        cells = (fit.correlation[i, j] for j in range(i))
        rows.append([names[i], *("-" if np.isnan(cell) else f"{cell:.3f}" for cell in cells)])
    return aligned(rows) if len(rows) > 1 else []


def magnitude_error(curve: Curve, H: np.ndarray) -> np.ndarray:
    """Relative error (n,) of the fitted magnitude."""
    return np.abs(H) / np.abs(curve.H) - 1


def phase_error(curve: Curve, H: np.ndarray) -> np.ndarray:
    """Error (n,) of the fitted phase in degrees."""
    return np.degrees(np.angle(H / curve.H))


def residual_table(problem: Problem, fit: Fit) -> list[str]:
    """Root mean square and largest errors by amplitude, and of the static test."""
    rows = [["residuals", "points", "magnitude, rms", "largest", "phase, rms", "largest"]]
    for curve, H in zip(problem.curves, fit.answer.curves):
        kept = curve.at(np.isfinite(H))
        magnitude, phase = (error(kept, H[np.isfinite(H)]) for error in (magnitude_error, phase_error))
        cells = ["-"] * 4
        if magnitude.size:
            worst, late = np.argmax(np.abs(magnitude)), np.argmax(np.abs(phase))
            cells = [
                f"{100 * _rms(magnitude):.2f} %",
                f"{100 * magnitude[worst]:.1f} % ({kept.frequency[worst]:g} Hz)",
                f"{_rms(phase):.2f} deg",
                f"{phase[late]:.1f} deg ({kept.frequency[late]:g} Hz)",
            ]
        rows.append([curve.label, f"{kept.frequency.size}", *cells])
    lines = aligned(rows)
    if problem.static and fit.answer.static is not None:
        measured, force = (f - f.mean() for f in (problem.static.force, fit.answer.static))
        lines.append(
            f"static test: rms {_rms(force - measured):.3g} N of {_rms(measured):.3g} N, "
            f"largest {np.max(np.abs(force - measured)):.3g} N"
        )
    return lines


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines with their cells below each other."""
    width = max(map(len, rows))
    full = [[*row, *[""] * (width - len(row))] for row in rows]
    widths = [max(map(len, column)) for column in zip(*full)]
    return ["  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in full]


def _with_error(value: float, error: float) -> str:
    """The value with the digits that its standard error leaves, two of them uncertain."""
    if not (np.isfinite(error) and error > 0):
        return f"{value:.6g}"
    return f"{value:.{min(max(1 - int(np.floor(np.log10(error))), 0), 12)}f}"


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
