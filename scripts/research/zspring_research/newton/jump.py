"""Steps at which the exact tangent jumps between two states for ever."""

from __future__ import annotations

import numpy as np

from .iteration import TANGENTS, Iteration, Step
from .recorded import Recording

COUNT = 60  # iterations looked at
SETTLED = 1e-9  # largest change of tau w between iterates a period apart
PERIOD = 2


def jumping_steps(recording: Recording) -> list[int]:
    """Indices of the steps whose exact Newton iteration ends in two states taken in turn."""
    return [
        index
        for index in range(1, len(recording.time) - 1)
        if jumps(Step(recording, index).iterate("Exact", COUNT), recording.parameters["zspring.tau"])
    ]


def jumps(iteration: Iteration, tau: float) -> bool:
    """Whether the iterates return every second time, but not every time."""
    x = tau * iteration.rates
    again = np.abs(x[-1] - x[-1 - PERIOD]).max()
    return bool(again <= SETTLED * np.abs(x[-1]).max() and np.abs(x[-1] - x[-2]).max() > 1e-3)


def iterations_of(recording: Recording, index: int) -> dict[str, Iteration]:
    """The iterates of every tangent at one step."""
    return {tangent: Step(recording, index).iterate(tangent, COUNT) for tangent in TANGENTS}
