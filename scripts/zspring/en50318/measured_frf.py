"""The pantograph's frequency response beside a measured one, as a chapter of a report on a user's own data."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..bench.compare import compare_frf, write_comparison
from ..bench.conditions import FILE_ORDER, STATED
from ..bench.curves import Source
from ..fmu import Fmu
from ..heads import synthetic_note
from ..interrupt import Interrupted, stop_on_interrupt
from ..page import Chapter, Picture
from ..variables import Value, with_unit
from . import plot, report


def frf_chapter(
    fmu: Fmu,
    source: Source,
    parameters: Mapping[str, Value],
    edges: Sequence[float],
    direction: str | None,
    folder: Path,
    jobs: int,
) -> tuple[Chapter, list[Path]]:
    """The FMU's frequency response beside a measured one; the files written. Raises Interrupted after Ctrl-C."""
    with stop_on_interrupt() as stop:
        comparison = compare_frf(fmu, source, parameters, edges, direction, jobs, stop)
        if stop.is_set():
            raise Interrupted("interrupted: the frequency response is not complete, nothing is written")
    path = folder / "frf-comparison.csv"
    comparisons, used = comparison.levels, fmu.used_parameters(comparison.parameters)
    write_comparison(path, fmu, source, comparisons)
    for remark in comparison.remarks:
        print(remark, file=sys.stderr)
    note = synthetic_note(fmu, used)
    title = f"{source.path.name} and {fmu.description.modelName}{note}"
    course = "in the order of the file" if comparison.direction == FILE_ORDER else comparison.direction
    bench = ", ".join(f"{name} {with_unit(fmu.variables[name], used[name])}" for name in STATED)
    text = (
        f"Measured: {source.path}, force counted as that on the {source.force}. Computed: the FMU on its own "
        f"bench, stepped sine at the same frequencies and amplitudes, sweep {course}, {bench}. Errors are relative to "
        "the measured value; a positive phase error means that the computed response is ahead."
    )
    failed = sum(int((c.computed != c.computed).sum()) for c in comparisons)
    missing = [f"{failed} points could not be computed."] if failed else []
    picture = Picture(plot.frf_comparison_figure(comparisons, edges, title), title, "frf-comparison.png")
    table = report.frf_table(comparisons)
    return Chapter(
        "Pantograph: measured and computed FRF",
        [text, *missing, *(f"{r}." for r in comparison.remarks), table, picture],
    ), [path]
