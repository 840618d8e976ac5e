"""The fit as a least-squares problem in x, the free parameters between their bounds (0 to 1)."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.stats import chi2

from ..bench.curves import Curve
from ..bench.model import SETTLED, BenchModel, Periods
from ..bench.responses import HARMONICS, as_quantity
from ..bench.static_test import StaticTest
from ..receptance import receptance
from ..variables import Value
from .settings import Settings
from .whitening import Whitening

# Good enough to find the right valley. The step, in s, is not for differences: those with friction are 30 % off.
COARSE_STEP, COARSE_TOLERANCE = 2e-3, 1e-2
ROUGH_PERIODS = 6
POINTS = "points"  # kind of residuals
NO_EFFECT = 1e-9  # change of the residuals over the whole range of a parameter
BY_CHANCE = 0.95  # of sums of squares
# Residual of a point that the model could not compute: 10 in the logarithm, or 10 times the mean square.
PENALTY = 10.0


def _penalised(off: np.ndarray) -> np.ndarray:
    return np.where(np.isfinite(off), off, PENALTY)


@dataclass(frozen=True)
class Answer:
    """What the model has for one x."""

    curves: list[np.ndarray]  # receptances (n,) in m/N, NaN where it failed
    static: np.ndarray | None  # forces (n,) in N
    periods: list[Periods] | None = None
    harmonics: list[np.ndarray] | None = None  # (n, 6) in N, as a curve's; NaN where it failed


class Model(Protocol):
    """Computes answers.

    relative_step   of a parameter, which differences of the answers need
    tolerance       relative change of cost or x at which least squares may end
    is_costly       so that a Jacobian by differences in each iteration would be most of the work
    """

    relative_step: float
    tolerance: float
    is_costly: bool

    def answers(self, candidates: Sequence[Mapping[str, Value]], like: Answer | None = None) -> list[Answer]:
        """One answer for each set of parameters.

        like    in as many periods as this answer took, so that they depend smoothly on the parameters
        """

    def with_curves(self, curves: Sequence[Curve]) -> Model:
        """The same model for other curves."""


class ThreeMassModel:
    """Three masses and linear springs and dampers: the analytic receptance."""

    relative_step = 1e-7
    tolerance = 1e-12
    is_costly = False

    def __init__(self, curves: Sequence[Curve], defaults: Mapping[str, Value]):
        self._curves, self._defaults = curves, defaults

    def answers(self, candidates: Sequence[Mapping[str, Value]], like: Answer | None = None) -> list[Answer]:
        del like
        return [
            Answer([receptance(c.frequency, {**self._defaults, **p}, "linear") for c in self._curves], None)
            for p in candidates
        ]

    def with_curves(self, curves: Sequence[Curve]) -> ThreeMassModel:
        return ThreeMassModel(curves, self._defaults)


class ZSpringModel:
    """The FMU on its bench, and in the static test if there is one."""

    # Coulomb's law makes H a little rough in the parameters: at 0.3 % the differences average over that.
    relative_step = 3e-3
    tolerance = 1e-5
    is_costly = True

    def __init__(self, bench: BenchModel, curves: Sequence[Curve], static: StaticTest | None):
        self._bench, self._curves, self._static = bench, curves, static

    def answers(self, candidates: Sequence[Mapping[str, Value]], like: Answer | None = None) -> list[Answer]:
        measured = self._bench.receptances(candidates, self._curves, like.periods if like else None)
        forces: list[np.ndarray | None] = [None] * len(candidates)
        if self._static:
            forces = list(self._bench.static_forces(candidates, self._static))
        return [
            Answer([p.H for p in row], force, [p.periods for p in row], [p.harmonics for p in row])
            for row, force in zip(measured, forces)
        ]

    def with_curves(self, curves: Sequence[Curve]) -> ZSpringModel:
        return ZSpringModel(self._bench, curves, self._static)


class Problem:
    """Residuals of the model against all measured curves and the static test."""

    def __init__(self, settings: Settings, model: Model, curves: Sequence[Curve], static: StaticTest | None = None):
        self.settings, self.curves, self.static = settings, list(curves), static
        self._model = model
        self.relative_step, self.tolerance = model.relative_step, model.tolerance
        self.is_costly = model.is_costly
        # By the measurement's own standard errors: residuals are then in these.
        self.is_weighted = settings.weights == "errors"
        self._whitening = Whitening(self.curves, SETTLED.tolerance) if self.is_weighted else None

    def thinned(self, points: int) -> Problem:
        """The same problem on a part: at most so many points of each curve, and steps of at least 2 ms.

        Good enough to find the right valley, ten or more times as fast.
        """
        curves = []
        for curve in self.curves:
            count = curve.frequency.size
            curves.append(curve.at(np.linspace(0, count - 1, min(points, count)).round().astype(int)))
        fixed = dict(self.settings.fixed)
        if "solver.step" in fixed:
            fixed["solver.step"] = max(fixed["solver.step"], COARSE_STEP)
        settings = self.settings.model_copy(update={"fixed": fixed})
        thinned = Problem(settings, self._model.with_curves(curves), curves, self.static)
        if self.is_costly:
            thinned.tolerance = max(self.tolerance, COARSE_TOLERANCE)
        return thinned

    @property
    def start(self) -> np.ndarray:
        """x (n,) of the start values."""
        return np.array([free.x(free.start) for free in self.settings.free.values()])

    def answers(self, xs: Sequence[np.ndarray], like: Answer | None = None) -> list[Answer]:
        """As Model.answers."""
        return self._model.answers([self.settings.parameters(x) for x in xs], like)

    def residuals(self, answer: Answer) -> np.ndarray:
        """Residuals (m,): real and imaginary part of each point, harmonics, then the static test; finite always.

        Logarithmic: log(H / measured), its real part the relative error of the magnitude, its imaginary part
        that of the phase in rad; where they are known, in standard errors and without what these have in common.
        Linear: difference over the root mean square of the measured curve.
        """
        return np.concatenate([part for _, part in self._parts(answer)])

    def variances(self, answer: Answer, parameters: int) -> np.ndarray:
        """Of each residual (m,) at the solution with so many parameters, by kind: see `variance`."""
        parts = self._parts(answer)
        share = 1 - parameters / max(sum(part.size for _, part in parts), parameters + 1)
        found: dict[str, float] = {}
        for kind in dict.fromkeys(kind for kind, _ in parts):
            values = np.concatenate([part for other, part in parts if other == kind])
            is_chance = self.is_weighted and kind == POINTS
            found[kind] = self._variance(values @ values, values.size * share, is_chance)
        return np.concatenate([np.full(part.size, found[kind]) for kind, part in parts])

    def _parts(self, answer: Answer) -> list[tuple[str, np.ndarray]]:
        """Residuals by kind; those of one kind are alike in size."""
        error = np.concatenate([self._off(curve, H) for curve, H in zip(self.curves, answer.curves)])
        off = _penalised(np.column_stack([error.real, error.imag]))
        parts = [(POINTS, (self._whitening(off) if self._whitening else off).T.ravel())]
        if self.settings.harmonics and answer.harmonics:
            kind = POINTS if self.is_weighted else "harmonics"
            parts += [(kind, self._harmonics(*each)) for each in zip(self.curves, answer.harmonics)]
        if self.static and self.settings.static and answer.static is not None:
            wanted, force = (f - f.mean() for f in (self.static.force, answer.static))
            points = sum(curve.frequency.size for curve in self.curves)
            # As heavy as all points of the curves together, if they are off as much; in their standard errors, if those
            # weigh.
            weight = np.sqrt(self.settings.static.weight * points / wanted.size / np.mean(wanted**2))
            if self.is_weighted:
                weight /= np.median(
                    np.concatenate([curve.error[:, 0] for curve in self.curves if curve.error is not None])
                )
            error = weight * (force - wanted)
            parts.append(("static test", _penalised(error)))
        return parts

    def _off(self, curve: Curve, H: np.ndarray) -> np.ndarray:
        """How far the receptance H (n,) is from the measured one, magnitude and phase as one complex number (n,)."""
        with np.errstate(invalid="ignore", divide="ignore"):
            if self.settings.error == "log":
                return np.log(H / curve.H)
            quantity = self.settings.quantity
            wanted = as_quantity(curve.H, quantity, curve.frequency)
            return (as_quantity(H, quantity, curve.frequency) - wanted) / np.sqrt(np.mean(np.abs(wanted) ** 2))

    def _harmonics(self, curve: Curve, computed: np.ndarray) -> np.ndarray:
        """Residuals (k,) of those that count, over the first harmonic, or over standard errors where those count."""
        assert curve.harmonics is not None  # settled_targets
        columns = [HARMONICS.index(order) for order in self.settings.harmonics]
        first = np.abs(curve.displacement / curve.H)[:, None]
        scale = np.hypot(curve.harmonics.error, SETTLED.tolerance * first) if self.is_weighted else first
        return _penalised(((computed - curve.harmonics.peak) / scale)[:, columns].ravel())

    def variance(self, cost: float, freedom: int) -> float:
        """Of a residual, at the solution with this cost; `freedom`: how many residuals more than parameters.

        Where they are in standard errors of the measurement it is 1, unless they are larger than by chance (Birge,
        The calculation of errors by the method of least squares, Physical Review 40, 1932).
        """
        return self._variance(2 * cost, freedom, self.is_weighted)

    def _variance(self, squares: float, freedom: float, is_weighted: bool) -> float:
        freedom = max(freedom, 1)
        is_chance = is_weighted and squares <= chi2.ppf(BY_CHANCE, freedom)
        return 1.0 if is_chance else float(squares / freedom)

    @property
    def rough(self) -> Answer | None:
        """What costly answers may be like to tell good candidates from bad ones."""
        periods = [(ROUGH_PERIODS,) * curve.frequency.size for curve in self.curves]
        return Answer([], None, periods) if self.is_costly else None

    def costs(self, xs: Sequence[np.ndarray], like: Answer | None = None) -> np.ndarray:
        """Half the sum of squared residuals for each x, shape (len(xs),); `like` as in Model.answers."""
        return np.array([self.cost(answer) for answer in self.answers(xs, like)])

    def cost(self, answer: Answer) -> float:
        """Half the sum of squared residuals."""
        return 0.5 * float(np.sum(self.residuals(answer) ** 2))

    def jacobian(self, x: np.ndarray, answer: Answer, columns: Collection[int]) -> np.ndarray:
        """d residuals / dx (m, len(columns)) at x, whose answer it is, by one-sided differences."""
        base, steps = self.residuals(answer), []
        frees = list(self.settings.free.values())
        for free, at in ((frees[i], x[i]) for i in columns):
            scale = max(abs(free.value(at)), 1e-3 * (free.maximum - free.minimum)) / free.slope(at)
            step = min(self.relative_step * scale, 0.25)
            steps.append(step if at + step <= 1 else -step)
        shifted = [x + step * np.eye(x.size)[i] for i, step in zip(columns, steps)]
        answers = self.answers(shifted, like=answer)
        columns = [(self.residuals(other) - base) / step for other, step in zip(answers, steps)]
        jacobian = np.column_stack(columns)
        jacobian[:, np.linalg.norm(jacobian, axis=0) < NO_EFFECT] = 0.0  # but rounding
        return jacobian
