"""What an identification writes: the fitted set, the fit point by point, draws from the posterior."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import datetime, timezone
from pathlib import Path

from ..bench.points import FrfSettings
from ..draws import write_draws
from ..fmu import Fmu
from ..heads import content_of, file_head
from ..parameter_sets import write_set
from ..tables import write_table
from ..variables import Value, with_unit
from . import report
from .fit import Fit
from .posterior import Posterior
from .problem import Problem
from .settings import LINEAR_PARAMETERS, Settings

# Of the bench, the line and the solver, so not of a pantograph.
OTHER_PARAMETERS = ("drive", "bench.", "static_force", "contact.", "solver.")


def fit_head(fmu: Fmu, settings: Settings) -> dict[str, str]:
    """All that defines a fit."""
    files = [*(source.path for source in settings.sources), *([settings.static.path] if settings.static else [])]
    return {
        "SHA-256 of the FMU": fmu.sha256,
        **{
            f"setting {key}": json.dumps(value)
            for key, value in settings.model_dump(mode="json", by_alias=True).items()
        },
        **content_of(files),
    }


def write_fitted(fmu: Fmu, problem: Problem, result: Fit, defaults: dict[str, Value], path: Path) -> Path:
    settings = problem.settings
    values = {**defaults, **settings.parameters(result.x)}
    if settings.model == "linear":
        names = ["suspension", *LINEAR_PARAMETERS]
    else:
        names = [name for name in values if not name.startswith(OTHER_PARAMETERS) and name != "k1"]
    remarks = {
        name: "identified, at its bound"
        if result.at_bound[i]
        else f"identified, standard error {result.standard_error[i]:.2g}"
        for i, name in enumerate(settings.free)
    }
    remarks |= {name: f"tied to {tie.to}" for name, tie in settings.tied.items()}
    files = ", ".join(source.path.name for source in settings.sources)
    date = datetime.now(timezone.utc).strftime("%Y-%m-%d")
    description = f"Identified from {files} on {date}, {settings.model} model{_preload(fmu, values, settings)}"
    description += f"; see {path.parent.name}/identify.log"
    write_set(path, fmu, {name: values[name] for name in names}, path.stem, description, remarks)
    return path


def _preload(fmu: Fmu, values: Mapping[str, Value], settings: Settings) -> str:
    """The bench's static force, which the set leaves to the line; the linear model depends on none."""
    if settings.model == "linear":
        return ""
    return f", at a static force of {with_unit(fmu.variables['static_force'], values['static_force'])}"


def write_points(fmu: Fmu, problem: Problem, result: Fit, path: Path) -> Path:
    settings = problem.settings
    own = {**fit_head(fmu, settings), "H": FrfSettings().described()["H"]}
    columns = ["frequency [Hz]", "amplitude [m/s2]"]
    columns += [f"{kind}_{part} [m/N]" for kind in ("measured", "fitted") for part in ("re", "im")]
    columns += ["magnitude_error [%]", "phase_error [deg]"]
    rows: list[tuple[float, ...]] = []
    for curve, H in zip(problem.curves, result.answer.curves):
        errors = 100 * report.magnitude_error(curve, H), report.phase_error(curve, H)
        rows += zip(curve.frequency, curve.acceleration, curve.H.real, curve.H.imag, H.real, H.imag, *errors)
    return write_table(path, file_head(fmu, settings.parameters(result.x), own), columns, rows, digits=None)


def write_posterior(fmu: Fmu, problem: Problem, posterior: Posterior, path: Path) -> Path:
    """The parameters of each draw that are free, or tied to one that is; the others are those of the fitted set."""
    settings = problem.settings
    names = [*settings.free, *(name for name, tie in settings.tied.items() if tie.to in settings.free)]
    names = [name for name in names if not name.startswith(OTHER_PARAMETERS)]
    rows = [[settings.parameters(x)[name] for name in names] for x in posterior.x]
    head = {**fit_head(fmu, settings), "effective sample size": f"{posterior.effective:.3g} of {posterior.drawn} draws"}
    return write_draws(path, fmu, names, rows, head)
