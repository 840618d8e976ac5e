"""The report of a fit as one HTML file that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from ..fmu import Fmu
from ..page import Chapter, Lines, Picture, write_page
from ..variables import text, with_unit
from .files import fit_head
from .fit import Fit
from .problem import Problem

ABOUT = {
    "Parameters": "Least squares over all points. A standard error is what the scatter of the residuals leaves open, "
    "or the measurement's own errors where they weigh, if these are independent but for what neighbours share, and the "
    "model is right; it knows nothing of what the model leaves out.",
    "Intervals": "By profile likelihood: how far a parameter may go before the others can no longer make up for it. "
    "From the posterior: between which ends 95 % of the draws are, even between the bounds before the measurement.",
    "Correlations": "Close to 1 or -1: the data know a combination of the two better than either.",
    "Residuals": "Of the fitted model against the measurement, by level of the amplitude. A level that is off alone "
    "tells that the model's friction is not the pantograph's.",
    "Models": "The same data fitted with other models. BIC is Schwarz's information criterion above that of the best; "
    "less than 6 apart the data do not tell.",
}
CAPTIONS = {
    "fit": "Measured points with the rms error of their level, and the fitted model between them; below, the error of "
    "its magnitude.",
    "static": "Static test, measured and fitted, without the means.",
    "harmonics": "Harmonics of the contact force over its first one: measured points, and the fitted model.",
    "posterior": "Equally probable draws; the fit in orange.",
}


def write_fit_report(
    fmu: Fmu,
    problem: Problem,
    fit: Fit,
    title: str,
    tables: Mapping[str, Sequence[str]],
    figures: Mapping[str, Figure],
    path: Path,
) -> Path:
    """Tables and figures by name, then what was assumed."""
    chapters = [Chapter(name, [ABOUT[name], Lines(lines)]) for name, lines in tables.items() if lines]
    pictures = [Picture(figure, CAPTIONS[name], "") for name, figure in figures.items()]
    chapters.insert(1, Chapter("Measurement and fit", list(pictures)))
    chapters.append(Chapter("What was assumed", [_assumed(fmu, problem, fit), Lines(_head_lines(fmu, problem))]))
    return write_page(path, title, chapters, fit_head(fmu, problem.settings))


def _assumed(fmu: Fmu, problem: Problem, fit: Fit) -> str:
    settings = problem.settings
    used = settings.parameters(fit.x)
    given = {name: value for name, value in used.items() if name not in settings.free}
    listed = ", ".join(f"{name} {with_unit(fmu.variables[name], value)}" for name, value in given.items())
    synthetic = fmu.variables.synthetic({**{v.name: used[v.name] for v in fmu.variables if v.name in given}})
    note = f" Synthetic, nobody measured them: {', '.join(synthetic)}." if synthetic else ""
    weights = "each point by its standard errors" if problem.is_weighted else "all points alike"
    law = text(fmu.variables["friction"], given["friction"]) if "friction" in given else "the FMU's own"
    return f"Friction law {law}; weights: {weights}. Given, not fitted: {listed}.{note}"


def _head_lines(fmu: Fmu, problem: Problem) -> list[str]:
    head = {**fmu.identity, **fit_head(fmu, problem.settings)}
    return [f"{key}: {value}" for key, value in head.items()]
