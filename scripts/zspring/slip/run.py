"""The map of stick and slip from settings to result folder."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ..bench.measure import BENCH_PARAMETERS, at_a_time
from ..bench.points import FAILED, NOT_SETTLED, FrfSettings, left_out
from ..bench.slip import FULL, PARTIAL, SLIDES, SLIP, WIDTH, Kept, Raising, SlipPoint, bounds, raise_amplitude
from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu
from ..heads import file_head, model_note, now, synthetic_note
from ..records import Record, fill, keep_others
from ..tables import write_table
from ..variables import Value, exact, text
from .plot import slip_figure

COLUMNS = [
    *("frequency [Hz]", "amplitude [m/s2]", "status", "moment_alpha [1]", "moment_beta [1]"),
    *("sliding_alpha [1]", "sliding_beta [1]", "state"),
]


def run_slip(fmu: Fmu, settings: FrfSettings, folder: Path, pantograph: str, suffix: str, jobs: int) -> None:
    """Measure, going on where an interrupted run in the folder stopped, then write and print all results.

    Raises ZSpringError for a pantograph whose rods never slide or never stick, where the stroke leaves no point, and
    where points failed; Interrupted after Ctrl-C, with finished points kept.
    """
    used = fmu.used_parameters(settings.parameters)
    for name, allowed in (("suspension", ["ZSpring"]), ("friction", ["Regularized", "Coulomb"])):
        if (chosen := text(fmu.variables[name], used[name])) not in allowed:
            raise ZSpringError(f"{name} = {chosen}: must be {' or '.join(allowed)}, for rods that stick and slide")
    if not used["zspring.Mf"]:
        raise ZSpringError("zspring.Mf = 0 N.m: must be above 0, for rods that stick and slide")
    head = _head(fmu, settings, used)
    points, lines = folder / "slip.csv", folder / "onset.csv"
    for path in (points, lines):
        keep_others(path, head)
    record = Record(folder / "slip.partial.csv", head, [*COLUMNS, "bench"], _row, _kept)

    def tasks() -> list[Raising]:
        return [_raising(settings, f, record.results) for f in settings.frequencies if _allowed(settings, f)]

    def work(stop: threading.Event) -> Iterator[Kept]:
        return at_a_time(raise_amplitude, fmu, settings, tasks(), jobs, stop)

    if not tasks():
        raise ZSpringError(f"nothing to measure: all points need more stroke than {settings.stroke:g} m")
    seconds = fill(record, None, 0, "points", work)
    found = {task.frequency: [point for point, _ in task.done] for task in tasks()}
    every = [point for some in found.values() for point in some]
    write_table(points, head, COLUMNS, (_cells(point) for point in every), digits=None)
    changes = ["onset_low [m/s2]", "onset_high [m/s2]", "full_low [m/s2]", "full_high [m/s2]"]
    rows = ([f, *bounds(some, PARTIAL), *bounds(some, SLIP)] for f, some in found.items())
    write_table(lines, head, ["frequency [Hz]", *changes], rows)
    figure = folder / f"slip.{suffix}"
    title = f"Stick and slip of the rods, {pantograph}\n{model_note(fmu, used)}{synthetic_note(fmu, used)}"
    save(slip_figure(found, settings.stroke, title), figure)
    record.path.unlink()
    print(*_summary(found), f"{len(every)} points in {seconds:.2f} s", sep="\n")
    print("written:", points, lines, figure)
    doubtful = [p for p in every if p.status == NOT_SETTLED or p.status.startswith(FAILED)]
    tell([f"{p.amplitude:g} m/s2, {p.frequency:g} Hz: {p.status}" for p in doubtful], points)
    if failed := sum(p.status.startswith(FAILED) for p in every):
        raise ZSpringError(f"{failed} of {len(every)} points could not be solved; the others are written")


def _head(fmu: Fmu, settings: FrfSettings, used: Mapping[str, Value]) -> dict[str, str]:
    measured = settings.described()
    own = {
        "date": now(),
        "SHA-256 of the FMU": fmu.sha256,
        "slides": f"a joint whose moment is at least {SLIDES:g} Mf",
        "full slip": f"both joints slide for at least {FULL:g} of the period",
        "amplitudes between two states": f"at most {WIDTH:g} apart, relative, where both states were found",
        **{key: measured[key] for key in ("amplitudes", "frequencies", "tolerance", "periods")},
        "stroke": f"{exact(settings.stroke)} m",
    }
    return file_head(fmu, used, own, but_not=BENCH_PARAMETERS)


def _allowed(settings: FrfSettings, frequency: float) -> tuple[float, ...]:
    """The amplitudes that the stroke leaves."""
    beyond = {point.place for point in left_out(settings)}
    return tuple(a for a in settings.amplitudes if (a, frequency) not in beyond)


def _raising(settings: FrfSettings, frequency: float, results: Sequence[Kept]) -> Raising:
    done = sorted((kept for kept in results if kept[0].frequency == frequency), key=lambda kept: kept[0].amplitude)
    return Raising(frequency, _allowed(settings, frequency), done)


def _summary(found: Mapping[float, Sequence[SlipPoint]]) -> list[str]:
    """Where slip begins first, and at how many frequencies it has no beginning or no end in the map."""
    onset = {f: bounds(points, PARTIAL) for f, points in found.items()}
    lines = []
    if known := {f: (low, high) for f, (low, high) in onset.items() if low > 0}:
        least, most = (pick(known, key=lambda f: known[f][1]) for pick in (min, max))
        lines.append(
            f"slip begins at {_between(known[least])} m/s2 ({least:g} Hz) to {_between(known[most])} m/s2 ({most:g} Hz)"
        )
    everywhere = [f for f, (low, _) in onset.items() if low == 0]
    nowhere = [f for f, (_, high) in onset.items() if math.isnan(high)]
    full = [f for f, points in found.items() if math.isfinite(bounds(points, SLIP)[1])]
    if everywhere:
        lines.append(f"rods slide at the lowest amplitude already: {_frequencies(everywhere, found)}")
    if nowhere:
        lines.append(f"rods stick at the highest amplitude still: {_frequencies(nowhere, found)}")
    lines.append(f"full slip is reached: {_frequencies(full, found)}")
    return lines


def _between(ends: tuple[float, float]) -> str:
    return f"{math.sqrt(ends[0] * ends[1]):.2g}"


def _frequencies(some: Sequence[float], of: Mapping[float, object]) -> str:
    band = f", from {some[0]:g} to {some[-1]:g} Hz" if some else ""
    return f"at {len(some)} of {len(of)} frequencies{band}"


def _cells(point: SlipPoint) -> list[object]:
    return [point.frequency, point.amplitude, point.status, *point.moment, *point.sliding, point.state]


def _row(kept: Kept) -> list[object]:
    return [*_cells(kept[0]), json.dumps(kept[1])]


def _kept(row: Mapping[str, str]) -> Kept:
    moment, sliding = (
        tuple(float(row[f"{name}_{joint} [1]"] or "nan") for joint in ("alpha", "beta"))
        for name in ("moment", "sliding")
    )
    point = SlipPoint(
        float(row["frequency [Hz]"]),
        float(row["amplitude [m/s2]"]),
        row["status"],
        (moment[0], moment[1]),
        (sliding[0], sliding[1]),
    )
    return point, json.loads(row["bench"])
