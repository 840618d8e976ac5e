"""The same run for each of many draws of the pantograph's parameters: what their uncertainty does to the values."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..draws import SHARE, doubts, head_of, quantiles
from ..errors import tell
from ..figures import save
from ..interrupt import Interrupted
from ..line.evaluated import sections
from ..line.limits import near_wave_speed
from ..line.run import LineRun, run_line
from ..line.statistics import FIGURES, Section, Statistics, statistics
from ..line.system import System
from ..records import Record, fill
from ..text_tables import aligned
from ..variables import Value
from .plot import draws_figure
from .report import SHOWN

Draw = tuple[int, int, Statistics]  # number, 0 for the parameters as given; pantograph, from 1; its values


def run_draws(
    system: System,
    draws: Sequence[Mapping[str, Value]],
    source: Path,
    folder: Path,
    suffix: str,
    spans: tuple[int, int] | None,
    what: str,
) -> None:
    """Run each draw, going on where an interrupted run stopped; write draws.csv and a figure, print the intervals.

    source  of the draws
    Raises Interrupted after Ctrl-C, ZSpringError where a run cannot go on or has no statistics; runs that are
    finished are kept.
    """
    with LineRun(system) as run:
        head = {**run.settings, **head_of(source), "spans": "{}:{}".format(*spans) if spans else "those of the summary"}
    columns = [f"{name} [{unit or 1}]" for name, (_, unit, _) in FIGURES.items()]
    count, sets = len(system.pantographs), [{}, *draws]
    record = Record[Draw](
        folder / "draws.csv",
        head,
        ["draw", "pantograph", *columns],
        lambda row: [row[0], row[1], *row[2].values()],
        lambda row: (int(row["draw"]), int(row["pantograph"]), _figures(row, columns)),
    )
    done = {number for number, pantograph, _ in record.results if pantograph == count}
    missing = [number for number in range(len(sets)) if number not in done]
    where: list[Section | None] = []

    def work(stop: threading.Event) -> Iterator[Draw]:
        for number in missing:
            if stop.is_set():
                return
            changed = system.changed({}, sets[number])
            try:
                result = run_line(changed)
            except Interrupted:
                stop.set()
                return
            where[:] = sections(result, changed.extent, spans)
            for i, section in enumerate(where):
                yield number, i + 1, statistics(result.series(i), section)

    fill(record, len(sets) * count, len(missing) * count, "runs", work)
    record.write(sorted(record.results, key=lambda row: row[:2]))
    lines, drawn = [], {}
    for i in range(count):
        rows = [figures for _, pantograph, figures in record.results if pantograph == i + 1]
        given, values = rows[0], {name: np.array([row[name] for row in rows[1:]]) for name in SHOWN}
        drawn[f"pantograph {i + 1}"] = given, values
        lines += _table(i, count, given, values)
    section = f"over {', '.join(dict.fromkeys(str(s or 'the whole run') for s in where))}, " if where else ""
    print(f"0-20 Hz, {section}{len(draws)} draws of {source.name}", *lines, sep="\n")
    width = max(float(np.ptp(each)) for _, values in drawn.values() for each in values.values())
    tell(
        [*doubts(len(draws), width), *near_wave_speed(system.catenary, system.line, system.journey.speed)], record.path
    )
    figure, speed = folder / f"draws.{suffix}", f"{3.6 * system.journey.speed:g} km/h"
    save(draws_figure(drawn, f"{what}, {speed}: {len(draws)} draws of {source.name}"), figure)
    print("written:", record.path, figure)


def _table(i: int, count: int, given: Statistics, values: Mapping[str, np.ndarray]) -> list[str]:
    rows = [[f"pantograph {i + 1}" if count > 1 else "", "as given", f"{100 * SHARE:g} % interval", "its width", ""]]
    for name in SHOWN:
        label, unit, digits = FIGURES[name]
        low, _, high = quantiles(values[name])
        interval = f"{low:.{digits}f} .. {high:.{digits}f}"
        rows.append([label, f"{given[name]:.{digits}f}", interval, f"{high - low:.2g}", unit])
    return aligned(rows)


def _figures(row: Mapping[str, str], columns: Sequence[str]) -> Statistics:
    return {name: float(row[column] or "nan") for name, column in zip(FIGURES, columns)}
