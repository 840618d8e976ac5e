"""The linear models between which an FRF is, and their extremes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.optimize import brentq

from ..bench.refine import Extreme, turns
from ..receptance import LinearModel, linear_model
from ..variables import Value

FINE = 4001  # frequencies between which the slope of |H| has one zero at most


def linear_bounds(parameters: Mapping[str, Value], linear: bool) -> dict[str, LinearModel]:
    """The models "locked" and "free", or "linear" alone."""
    return {model: linear_model(parameters, model) for model in (["linear"] if linear else ["locked", "free"])}


def exact_extremes(model: LinearModel, band: tuple[float, float]) -> list[Extreme]:
    """Those of a linear model within a band (Hz), from zeros of the slope of log |H|; its errors are 0."""
    frequency = np.linspace(*band, FINE)
    slope = [model.level_slope(f) for f in frequency]
    zeros = [brentq(model.level_slope, *frequency[i : i + 2]) for i in np.flatnonzero(np.diff(np.sign(slope)))]
    magnitude = np.abs(model.receptance(np.array([band[0], *zeros, band[1]])))
    return [
        Extreme(bool(magnitude[i] > magnitude[i - 1]), zeros[i - 1], 0.0, float(magnitude[i]), 0.0)
        for i in turns(np.log(magnitude))
    ]
