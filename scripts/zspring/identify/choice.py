"""Which model the data ask for: the same fit with the other friction law, and with a linear head suspension.

Told apart by Schwarz's information criterion (Estimating the dimension of a model, Annals of Statistics 6, 1978), whose
differences Kass and Raftery (Bayes factors, Journal of the American Statistical Association 90, 1995) call strong from
6 on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..fmu import Fmu
from ..text_tables import aligned
from ..variables import Value, parse, text
from .fit import NOISE_FREE, Fit
from .problem import Problem
from .report import magnitude_error, rms
from .settings import LINEAR_PARAMETERS, Free, Settings

LAWS = ("Regularized", "Coulomb")
STRONG = 6.0
FARTHEST = 5.0  # times the start value of k1
MOST_DAMPING = 1000.0  # N.s/m, of c1


@dataclass(frozen=True)
class Candidate:
    """A model that was fitted to all of the data."""

    name: str
    problem: Problem
    fit: Fit

    @property
    def residuals(self) -> int:
        return self.problem.residuals(self.fit.answer).size

    @property
    def variance(self) -> float:
        """Of a residual, see Problem.variance."""
        return self.problem.variance(self.fit.cost, self.residuals - self.fit.x.size)

    def criterion(self, variance: float) -> float:
        """BIC, but for what all models have in common: -2 log likelihood + n log m.

        variance    of a residual, by the model that follows the data best: where that misses them by more than their
                    errors, these say too much of all models
        """
        misfit = 2 * self.fit.cost / variance
        if not self.problem.is_weighted:  # the variance is one more unknown, which all have
            misfit = self.residuals * np.log(max(2 * self.fit.cost, NOISE_FREE) / self.residuals)
        return float(misfit + self.fit.x.size * np.log(self.residuals))


def name_of(fmu: Fmu, parameters: Mapping[str, Value]) -> str:
    """The model of these parameters in words."""
    suspension, friction = (text(fmu.variables[name], parameters[name]) for name in ("suspension", "friction"))
    return "linear head" if suspension == "Linear" else f"Z-spring, {friction}"


def others(fmu: Fmu, settings: Settings, defaults: Mapping[str, Value]) -> dict[str, Settings]:
    """Settings of the other models, by name. That with the linear head has k1 and c1 instead of what it does not know.

    defaults    of all parameters
    """
    result = {}
    for law in LAWS:
        changed = {**settings.fixed, **fmu.variables.parse_assignments([f"friction={law}"])}
        if changed["friction"] == settings.fixed.get("friction"):
            continue
        free = dict(settings.free)
        if law == "Coulomb" and (steepness := free.pop("zspring.tau", None)):  # which it does not know
            changed["zspring.tau"] = steepness.start
        result[name_of(fmu, {**defaults, **changed})] = settings.model_copy(update={"fixed": changed, "free": free})
    fixed = {**settings.fixed, **fmu.variables.parse_assignments(["suspension=Linear"])}
    k1 = float(fixed.pop("k1", defaults["k1"])) or float(parse(fmu.variables["k1"], fmu.variables["k1"].start))
    c1 = min(float(fixed.pop("c1", defaults["c1"])), MOST_DAMPING)
    free = {name: each for name, each in settings.free.items() if name in LINEAR_PARAMETERS}
    head = {"k1": Free(start=k1, min=k1 / FARTHEST, max=k1 * FARTHEST)}
    head |= {"c1": Free(start=c1, min=0.0, max=MOST_DAMPING)}
    free = {**head, **free}
    known = {**fixed, **free}
    tied = {name: tie for name, tie in settings.tied.items() if name in LINEAR_PARAMETERS and tie.to in known}
    free = {name: each for name, each in free.items() if name not in tied}
    linear = settings.model_copy(update={"fixed": fixed, "free": free, "tied": tied})
    result[name_of(fmu, {**defaults, **fixed})] = linear
    return result


def choice_table(candidates: Sequence[Candidate]) -> list[str]:
    """Models, the best first, with their criterion and where each fails; then what the data say."""
    variance = min(candidate.variance for candidate in candidates)
    criteria = {candidate.name: candidate.criterion(variance) for candidate in candidates}
    ordered = sorted(candidates, key=lambda candidate: criteria[candidate.name])
    labels = [curve.label for curve in ordered[0].problem.curves]
    rows = [["model", "free", "BIC", *(f"rms at {label}" for label in labels)]]
    for each in ordered:
        shown = [_rms(magnitude_error(curve, H)) for curve, H in zip(each.problem.curves, each.fit.answer.curves)]
        rows.append(
            [each.name, f"{each.fit.x.size}", f"{criteria[each.name] - criteria[ordered[0].name]:+.3g}", *shown]
        )
    best, *rest = ordered
    close = [each.name for each in rest if criteria[each.name] - criteria[best.name] < STRONG]
    verdict = f"the data ask for {best.name}"
    if close:
        verdict = f"the data cannot tell {best.name} from {' or '.join(close)}: less than {STRONG:g} apart"
    if "zspring.tau" not in best.problem.settings.free:
        verdict += " (Regularized: with zspring.tau as given)"
    missed = [f"even {best.name} misses them by {np.sqrt(best.variance):.3g} times their standard errors"]
    return [*aligned(rows), verdict, *(missed if best.problem.is_weighted and best.variance > 1 else [])]


def _rms(error: np.ndarray) -> str:
    known = error[np.isfinite(error)]
    return f"{100 * rms(known):.2g} %" if known.size else "-"
