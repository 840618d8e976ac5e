"""What of the measurements counts in a fit, and by which weights: settled before it begins."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from ..bench.curves import Curve
from ..bench.responses import HARMONICS
from ..errors import ZSpringError
from .settings import Settings


def settled_targets(settings: Settings, curves: Sequence[Curve]) -> Settings:
    """The settings with the weights that hold. Raises ZSpringError for weights or harmonics that no file tells."""
    weights = _weights(settings, curves)
    more = [name for name, given in vars(settings.uncertainty).items() if name != "seed" and given]
    more += ["compare_models"] if settings.compare_models else []
    mixed = "[static]" if settings.static else "harmonics without standard errors"
    if more and (settings.static or (settings.harmonics and weights == "equal")):
        raise ZSpringError(f"{more[0]}: needs a likelihood, which {mixed} beside the points do not have")
    for order in settings.harmonics:
        for curve in curves:
            column = HARMONICS.index(order)
            if curve.harmonics is None or np.isnan(curve.harmonics.peak[:, column]).any():
                raise ZSpringError(f"harmonics: {order}: {curve.label} has no harmonic_{order} [N] at every point")
            if weights == "errors" and not np.all(curve.harmonics.error[:, column] > 0):
                raise ZSpringError(
                    f"harmonics: {order}: {curve.label} has no harmonic_{order}_error [N] above 0 at every point, by "
                    'which it would count: give it, or set weights = "equal"'
                )
    return settings.model_copy(update={"weights": weights})


def _weights(settings: Settings, curves: Sequence[Curve]) -> Literal["errors", "equal"]:
    unknown = [curve.label for curve in curves if curve.error is None]
    if settings.weights == "errors" and settings.error == "linear":
        raise ZSpringError('weights = "errors": standard errors are of magnitude and phase: needs error = "log"')
    if settings.weights == "errors" and unknown:
        raise ZSpringError(
            f'weights = "errors": {unknown[0]} has none: needs the columns magnitude_error and phase_error'
        )
    if settings.weights:
        return settings.weights
    if settings.error == "linear" or len(unknown) == len(curves):
        return "equal"
    if unknown:
        raise ZSpringError(
            f'{unknown[0]} has no standard errors, other measurements have: weights = "equal" counts all points alike'
        )
    return "errors"
