"""What is said about recordings: the responses by level, and what is marked or left out, and why."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..bench.curves import sign_warning
from ..text_tables import aligned
from .groups import Group
from .points import Point

MEAN_OFF = 0.05  # relative distance of the mean force from the static force of the settings that is told
NO_MEAN = 0.02  # of the static force: less is that of a load cell without its mean


def level_table(groups: Sequence[Group]) -> list[str]:
    """A line for each level and direction."""
    worst = "at worst"
    rows = [
        ["level", "sweep", "points", "Hz", "amplitude, m/s2", "distortion", "|H| error", worst, "phase error", worst]
    ]
    for group in groups:
        points = group.points
        magnitude, phase = (np.array([getattr(p, name) for p in points]) for name in ("magnitude_error", "phase_error"))
        reached, frequency = ([getattr(p, name) for p in points] for name in ("acceleration", "frequency"))
        rows.append(
            [
                *(group.label, group.direction or "", f"{len(points)}"),
                *(_range(frequency, 4), _range(reached, 3), f"{100 * max(p.distortion for p in points):.1f} %"),
                *(f"{100 * np.median(magnitude):.2g} %", f"{100 * magnitude.max():.2g} %"),
                *(f"{np.degrees(np.median(phase)):.2g} deg", f"{np.degrees(phase.max()):.2g} deg"),
            ]
        )
    return [*aligned(rows), "errors: standard errors, median and worst; distortion: of the motion, worst"]


def _range(values: Sequence[float], digits: int) -> str:
    low, high = (f"{value:.{digits}g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def count_line(points: Sequence[Point], what: str) -> str:
    """How many there are of what they are, and what became of them."""
    out, marked = sum(bool(p.left_out) for p in points), sum(bool(p.marks) and not p.left_out for p in points)
    text = f"{len(points)} {what}: {len(points) - out} used"
    return text + (f", {marked} of them marked" if marked else "") + (f", {out} left out" if out else "")


def doubts(points: Sequence[Point]) -> list[str]:
    """A line for each hold that is marked or left out."""
    return [
        f"{p.record}, {p.begin:.1f} to {p.end:.1f} s, {p.frequency:.4g} Hz: {p.status}"
        for p in sorted(points, key=lambda point: not point.left_out)
        if p.status != "used"
    ]


def remarks(groups: Sequence[Group], static_force: float | None) -> list[str]:
    """What the responses as a whole make doubtful."""
    lines = []
    if warning := sign_warning([group.curve for group in groups]):
        lines.append(warning.replace('force = "contact"', '[force] sense = "contact"'))
    if static_force is None:
        lines.append("static_force is not given: identify needs it, and what it finds depends on it")
    means = [p.static_force for group in groups for p in group.points]
    mean = float(np.median(means)) if means else math.nan
    if static_force and NO_MEAN < abs(mean / static_force) and abs(mean / static_force - 1) > MEAN_OFF:
        lines.append(f"the force has a mean of {mean:.4g} N, static_force is {static_force:g} N: is its zero right?")
    return lines


def up_against_down(groups: Sequence[Group]) -> list[str]:
    """By level, how far H differs where a frequency was measured in both directions."""
    lines = []
    for up in (group for group in groups if group.direction == "up"):
        for down in (group for group in groups if group.direction == "down" and group.label == up.label):
            pairs = [(a, b) for a in up.points for b in down.points if abs(a.frequency / b.frequency - 1) < 0.002]
            if not pairs:
                continue
            apart = [abs(b.H / a.H - 1) for a, b in pairs]
            clear = sum(
                abs(b.H / a.H - 1) > 3 * math.hypot(*(max(p.magnitude_error, p.phase_error) for p in (a, b)))
                for a, b in pairs
            )
            worst, (at, _) = max(apart), pairs[int(np.argmax(apart))]
            lines.append(
                f"{up.label}, up and down: {len(pairs)} frequencies, {clear} of them beyond 3 standard errors; "
                f"largest {100 * worst:.2g} % at {at.frequency:.4g} Hz"
            )
    return lines
