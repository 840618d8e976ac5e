"""What is kept of every communication point of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .calls import PreparedCalls
from .result import LineResult


class Recorder:
    """What is kept of every communication point."""

    def __init__(
        self,
        rows: int,
        wire: PreparedCalls,
        heads: Sequence[PreparedCalls],
        supports: np.ndarray,
        datum: Sequence[float],
        points: Mapping[int, float],
    ):
        """Where to keep what.

        datum       m, what the catenary's heights under the pantographs are measured from
        points      positions in m of the watched points by their numbers in the FMU
        """
        count = len(heads)
        names = [f"pantograph[{i + 1}].{name}" for name in ("x", "wire_height") for i in range(count)]
        names += [f"support.uplift[{i + 2}]" for i in range(len(supports))]  # the first is the anchor
        names += [f"point.uplift[{number}]" for number in points]
        self._supports, self._points, self._datum = supports, points, np.array(datum)
        self._wire, self._slack = wire.reals(names), wire.integers(["droppers.slack"])
        self._heads = [
            head.reals(["contact.force", "head.z", "zspring.moment_alpha", "zspring.moment_beta"]) for head in heads
        ]
        self._wire_rows = np.empty((rows, len(names)))
        self._slack_rows = np.empty(rows, dtype=int)
        self._head_rows = np.empty((rows, count, 4))

    def take(self, row: int, shifts: Sequence[float]) -> None:
        """Keep the FMUs' outputs as they are now."""
        self._wire_rows[row] = self._wire.get()
        self._slack_rows[row] = self._slack()[0]
        for i, head in enumerate(self._heads):
            values = head.get()
            values[1] += shifts[i]
            self._head_rows[row, i] = values

    def result(self, rows: slice, step: float, settings: dict[str, str], elapsed: float) -> LineResult:
        """The result of the rows taken."""
        wire, slack, heads = self._wire_rows[rows], self._slack_rows[rows], self._head_rows[rows]
        count, supports = heads.shape[1], len(self._supports)
        at_points = wire[:, 2 * count + supports :]
        return LineResult(
            time=step * np.arange(len(slack)),
            position=wire[:, :count],
            contact_force=heads[:, :, 0],
            wire_height=wire[:, count : 2 * count] + self._datum,
            head_height=heads[:, :, 1],
            support_position=self._supports,
            support_uplift=wire[:, 2 * count : 2 * count + supports],
            slack_droppers=slack,
            moment=heads[:, :, 2:],
            settings=settings,
            elapsed=elapsed,
            points=dict(zip(self._points.values(), at_points.T)),
        )
