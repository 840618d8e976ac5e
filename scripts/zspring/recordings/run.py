"""From settings of recordings to a folder of results."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..bench.uff_file import pyuff_package
from ..bench.uff_file import write_responses as write_universal
from ..errors import ZSpringError, tell
from ..figures import save
from ..heads import content_of
from ..records import keep_others
from . import report
from .cycle import cycle_of
from .evaluate import evaluate, told
from .files import write_holds, write_responses
from .groups import Group, asked_for, grouped
from .plot import harmonics_figure, hold_figure, response_figure
from .points import Point
from .settings import Settings
from .signals import Record, read_record
from .slow import swept_points
from .track import Turns, holds_of, turns_of


def run_recordings(settings: Settings, path: Path, folder: Path, suffix: str, uff: bool) -> None:
    """Read, evaluate, write and print.

    path    of the settings
    suffix  of the figures, "png" or "svg"
    uff     write universal files, too
    Raises ZSpringError for what cannot be read, and where no hold can be used.
    """
    if uff:
        pyuff_package()
    head = _head(settings)
    keep_others(folder / "holds.csv", head)
    points: list[Point] = []
    shown: tuple[Record, Point] | None = None
    said: list[str] = []
    for file in tqdm(settings.recording, unit=" files", disable=None):
        record = read_record(file, settings)
        found, remarks = holds_in(record, settings)
        points += found
        said += [*record.remarks, *remarks]
        clear = [point for point in found if not point.left_out]
        loudest = max(clear, key=lambda point: point.force[2] / point.force[0], default=None)
        if loudest and (shown is None or loudest.force[2] / loudest.force[0] > shown[1].force[2] / shown[1].force[0]):
            shown = record, loudest
    groups = grouped(points, settings.sweep.direction)
    tell([*said, *report.doubts(points)], folder / "holds.csv")
    paths = [write_holds(folder / "holds.csv", head, points)]
    if shown is None:
        raise ZSpringError(f"no hold can be used: see {paths[0]}")
    what = "holds" if settings.sweep.kind == "holds" else "stretches"
    for line in (report.count_line(points, what), *report.level_table(groups), *report.up_against_down(groups)):
        print(line)
    for line in report.remarks(groups, settings.static_force):
        print(line, file=sys.stderr)
    title = f"Measured response, {path.stem}"
    paths += _write_responses(folder, head, groups, title, uff)
    figures = {
        "frf": response_figure(groups, title),
        "harmonics": harmonics_figure(groups, title),
        "hold": hold_figure(cycle_of(*shown, settings), shown[1]),
    }
    for name, figure in figures.items():
        paths.append(folder / f"{name}.{suffix}")
        save(figure, paths[-1])
    print("written:", *paths)


def holds_in(record: Record, settings: Settings) -> tuple[list[Point], list[str]]:
    """The points of a file, and what to say of it. Raises ZSpringError where it has no steady part."""
    name, motion = next(iter(record.motions.items()))
    parts: list[Turns] = []
    for first, last in record.parts:
        values = _filled(motion.values[first:last])
        driven = values if name == "acceleration" or values.size < 2 else np.gradient(values) * record.rate
        parts.append(turns_of(float(record.time[first]), record.rate, driven, settings.sweep.band))
    if settings.sweep.kind == "slow":
        return swept_points(record, parts, settings), []
    low, high = settings.sweep.band
    holds = [hold for turns in parts for hold in holds_of(turns) if low <= hold.frequency <= high]
    if not holds:
        noise = [float(np.median(turns.noise)) if turns.noise.size else np.inf for turns in parts]
        text = f"{record.path}: no steady part: no {low:g} to {high:g} Hz held in {name}"
        why = "is it a slow sweep?" if min(noise) < 0.02 else f"its turns scatter by {100 * min(noise):.0f} %"
        raise ZSpringError(f"{text}; {why}")
    points = told([evaluate(record, hold, settings) for hold in holds], settings)
    if settings.sweep.frequencies:
        return asked_for(points, settings.sweep.frequencies, record.path.name)
    return points, []


def _filled(values: np.ndarray) -> np.ndarray:
    """Values (n,) with straight lines over what is missing."""
    there = np.isfinite(values)
    if there.all() or not there.any():
        return np.nan_to_num(values)
    return np.interp(np.arange(values.size), np.flatnonzero(there), values[there])


def _write_responses(folder: Path, head: dict[str, str], groups: Sequence[Group], title: str, uff: bool) -> list[Path]:
    """One file, or one for each direction."""
    ways = list(dict.fromkeys(group.direction for group in groups))
    paths = []
    for way in ways:
        own = [group for group in groups if group.direction == way]
        name = f"frf-{way or 'file-order'}" if len(ways) > 1 else "frf"
        about = {**head, **({"direction": way} if way else {})}
        paths.append(write_responses(folder / f"{name}.csv", about, own))
        if uff:
            paths.append(write_universal(folder / f"{name}.uff", title, [group.curve for group in own]))
    return paths


def _head(settings: Settings) -> dict[str, str]:
    """All that defines the numbers."""
    head = {
        "H": "-Z/F, components at the drive frequency of head displacement Z and contact force F",
        "to read it": 'force = "specimen", fixture_mass = 0: signs and fixture are accounted for',
        "errors": "standard errors, +- 1.96 of which is a 95 % interval",
        **{f"setting {key}": repr(value) for key, value in settings if key != "recording"},
        **content_of(file.path for file in settings.recording),
    }
    if settings.static_force is not None:
        head["static_force"] = f"{settings.static_force:g} N"
    return head
