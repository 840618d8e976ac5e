"""Levels of a measurement: which points were driven with the same nominal amplitude.

A bench writes the amplitude that it reached, which scatters about the one that was asked for. What is asked for is a
displacement, a velocity or an acceleration: the one that is steady over the frequencies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage

from .responses import AMPLITUDES

APART = 0.25  # of the logarithm: mean distance of amplitudes of different levels
STEADY = 0.03  # of the logarithm: less scatter than this tells nothing


@dataclass(frozen=True)
class Level:
    """Points of one nominal amplitude, in the order of the file."""

    label: str
    points: np.ndarray  # indices


def named_levels(names: Sequence[str]) -> list[Level]:
    """By the cells of a column that tells them."""
    return [Level(name, np.flatnonzero([other == name for other in names])) for name in dict.fromkeys(names)]


def levels_of(frequency: np.ndarray, acceleration: np.ndarray, written: np.ndarray, unit: str) -> list[Level]:
    """The levels of points with frequency (n,) in Hz and peak acceleration (n,) in m/s2.

    written     amplitude (n,) as the file has it, in `unit`: levels that differ by less than measured ones do are
                told by equal numbers, each over the same frequencies
    Of displacement, velocity and acceleration the one counts that needs few levels and scatters little within them
    (Bayesian information criterion for groups with one standard deviation); on equality the file's own.
    """
    own = next((kind for kind in AMPLITUDES if unit == kind), "")
    grouped = {}
    for kind, derivatives in AMPLITUDES.items():
        value = acceleration * (2 * np.pi * frequency) ** (derivatives - 2)
        groups = _groups(np.log(value))
        scatter = np.concatenate([np.log(value[group] / np.median(value[group])) for group in groups])
        cost = scatter.size * np.log(np.mean(scatter**2) + STEADY**2) + len(groups) * np.log(scatter.size)
        grouped[kind] = cost, value, groups
    steady = min(grouped, key=lambda kind: (round(grouped[kind][0], 9), kind != own))
    _, value, groups = grouped[steady]
    levels = []
    for group in groups:
        for points in _equal(group, written, frequency):
            nominal = dict.fromkeys(written[points].tolist())
            label = (
                f"{written[points[0]]:g} {unit}" if len(nominal) == 1 else f"{np.median(value[points]):.3g} {steady}"
            )
            levels.append(Level(label, points))
    return sorted(levels, key=lambda level: level.points[0])


def _groups(logarithm: np.ndarray) -> list[np.ndarray]:
    """Indices of values (n,) by average linkage, each group in the order of the file."""
    rounded, place = np.unique(logarithm.round(2), return_inverse=True)
    if rounded.size == 1:
        return [np.arange(logarithm.size)]
    cluster = fcluster(linkage(rounded[:, None], "average"), APART, "distance")[place]
    return [np.flatnonzero(cluster == number) for number in np.unique(cluster)]


def _equal(group: np.ndarray, written: np.ndarray, frequency: np.ndarray) -> list[np.ndarray]:
    """The group by equal numbers, if each of them has the same frequencies, more than one; else as it is."""
    parts = [group[written[group] == number] for number in dict.fromkeys(written[group].tolist())]
    over = {tuple(sorted(frequency[part].tolist())) for part in parts}
    return parts if len(over) == 1 and parts[0].size > 1 else [group]
