"""What is said about a fit: parameters, how well they are determined, residuals by amplitude."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..bench.curves import Curve
from ..bench.responses import HARMONICS
from ..fmu import Fmu
from ..text_tables import aligned
from .fit import Fit
from .posterior import Posterior
from .problem import Problem

STRONG_CORRELATION = 0.98
SHARE = 0.95  # of intervals
FEW = 50  # effective draws: too few for intervals to rely on


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
    if problem.is_weighted:
        ratio = np.sqrt(problem.variances(fit.answer, len(names))[0])  # of the points
        if ratio > 1:
            lines.append(
                f"the model misses the measurement by {ratio:.3g} times its standard errors, more than by chance: "
                "those of the parameters are widened as much, and are no measure of what the model leaves out"
            )
    failed = sum(int(np.sum(~np.isfinite(H))) for H in fit.answer.curves)
    if failed:
        lines.append(f"{failed} points could not be computed at the solution and count as a penalty")
    return lines


def posterior_doubts(posterior: Posterior | None) -> list[str]:
    """What to say of draws that tell little."""
    if not posterior or posterior.effective >= FEW:
        return []
    return [
        f"posterior: {posterior.drawn} draws are worth {posterior.effective:.2g} only: its intervals are rough; give "
        "more draws"
    ]


def interval_table(
    fmu: Fmu, problem: Problem, fit: Fit, profiles: Sequence[tuple[float, float]] | None, posterior: Posterior | None
) -> list[str]:
    """Intervals of 95 % by profile likelihood and from the posterior, where they were computed."""
    if not profiles and not posterior:
        return []
    kinds: dict[str, Sequence[tuple[float, float]]] = {}
    if profiles:
        kinds["profile"] = profiles
    if posterior:
        low, high = posterior.interval(SHARE)
        kinds[f"posterior ({posterior.effective:.3g} of {posterior.drawn} draws)"] = list(zip(low, high))
    rows = [[f"{100 * SHARE:g} % intervals", *kinds, "unit"]]
    for i, (name, free) in enumerate(problem.settings.free.items()):
        cells = []
        for ends in kinds.values():
            a, b = (free.value(float(end)) for end in ends[i])
            digits = (b - a) / 4 if b > a else fit.standard_error[i]  # of about a standard error
            cells.append(f"{_with_error(a, digits)} .. {_with_error(b, digits)}")
        rows.append([name, *cells, fmu.variables[name].unit or ""])
    return aligned(rows)


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
                f"{100 * rms(magnitude):.2f} %",
                f"{100 * magnitude[worst]:.1f} % ({kept.frequency[worst]:g} Hz)",
                f"{rms(phase):.2f} deg",
                f"{phase[late]:.1f} deg ({kept.frequency[late]:g} Hz)",
            ]
        rows.append([curve.label, f"{kept.frequency.size}", *cells])
    lines = aligned(rows)
    for order in problem.settings.harmonics if fit.answer.harmonics else ():
        off = [
            (computed - curve.harmonics.peak)[:, HARMONICS.index(order)] * np.abs(curve.H) / curve.displacement
            for curve, computed in zip(problem.curves, fit.answer.harmonics or ())
            if curve.harmonics is not None
        ]
        lines.append(f"harmonic {order}: rms {100 * rms(np.concatenate(off)):.2g} % of the first one")
    if problem.static and fit.answer.static is not None:
        measured, force = (f - f.mean() for f in (problem.static.force, fit.answer.static))
        lines.append(
            f"static test: rms {rms(force - measured):.3g} N of {rms(measured):.3g} N, "
            f"largest {np.max(np.abs(force - measured)):.3g} N"
        )
    return lines


def _with_error(value: float, error: float) -> str:
    """The value with the digits that its standard error leaves, two of them uncertain."""
    if not (np.isfinite(error) and error > 0):
        return f"{value:.6g}"
    return f"{value:.{min(max(1 - int(np.floor(np.log10(error))), 0), 12)}f}"


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
