"""The FRF of many draws of the pantograph's parameters: bands between which it lies."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..bench.measure import measure
from ..bench.points import FrfSettings, sweeps
from ..bench.responses import QUANTITIES, as_quantity, phase_degrees
from ..draws import SHARE, doubts, head_of, quantiles
from ..errors import ZSpringError, tell
from ..figures import save
from ..fmu import Fmu
from ..records import Record, fill
from ..tables import write_table
from ..variables import Value
from . import report
from .bands_plot import Band, bands_figure
from .course import all_parameters

Drawn = tuple[int, float, float, complex]  # number, 0 for the parameters as given; level, frequency in Hz, H in m/N


def run_bands(
    fmu: Fmu,
    settings: FrfSettings,
    draws: Sequence[Mapping[str, Value]],
    source: Path,
    folder: Path,
    quantity: str,
    suffix: str,
    jobs: int,
    pantograph: str,
) -> None:
    """Measure each draw, going on where an interrupted run stopped; write bands.csv and bands.<suffix>.

    source  of the draws
    Raises Interrupted after Ctrl-C, ZSpringError where there is nothing to measure; points that are finished are kept.
    """
    planned = sweeps(settings)
    if not planned:
        raise ZSpringError(f"nothing to measure: all points need more stroke than {settings.stroke:g} m")
    parameters = all_parameters(fmu, settings)
    head = {**report.frf_head(fmu, settings, parameters, quantity), **head_of(source)}
    sets, places = [{}, *draws], [(sweep.level, f) for sweep in planned for f in sweep.frequencies]
    record = Record[Drawn](
        folder / "draws.partial.csv",
        head,
        ["draw", "level", "frequency [Hz]", "H_re [m/N]", "H_im [m/N]"],
        lambda row: [*row[:3], row[3].real, row[3].imag],
        _drawn,
    )
    known = {row[:3]: row[3] for row in record.results}
    missing = [n for n in range(len(sets)) if any((n, *place) not in known for place in places)]

    def work(stop: threading.Event) -> Iterator[Drawn]:
        for n in missing:
            changed = replace(settings, parameters={**settings.parameters, **sets[n]})
            for point, _ in measure(fmu, changed, planned, jobs, stop):
                yield n, point.level, point.frequency, point.H

    fill(record, len(sets) * len(places), len(missing) * len(places), "points", work, "draws")
    known = {row[:3]: row[3] for row in record.results}
    bands = []
    for level in dict.fromkeys(level for level, _ in places):
        frequency = np.array(sorted(f for at, f in places if at == level))
        H = np.array([[known[n, level, f] for f in frequency.tolist()] for n in range(len(sets))])
        label = f"{level:g} {settings.unit}"
        bands.append(_band(label, frequency, as_quantity(H, quantity, frequency), quantity))
    written = [_write(folder / "bands.csv", head, bands, quantity), folder / f"bands.{suffix}"]
    title = report.title(fmu, settings, parameters, pantograph)
    about = f"{100 * SHARE:g} % of {len(draws)} draws of {source.name}"
    save(bands_figure(bands, quantity, f"{title}\n{about}"), written[-1])
    record.path.unlink()
    print(*(_line(band, quantity) for band in bands), sep="\n")
    lost = sum(int(np.isnan(band.magnitude[1]).sum()) for band in bands)
    unsolved = [f"{lost} points have no band: not all draws could be solved there"] if lost else []
    width = max(float(np.nanmax(band.magnitude[2] - band.magnitude[0], initial=0.0)) for band in bands)
    tell([*doubts(len(draws), width), *unsolved], written[0])
    print("written:", *written)


def _band(label: str, frequency: np.ndarray, value: np.ndarray, quantity: str) -> Band:
    """Of values (1 + draws, n), the first of the parameters as given."""
    magnitude, phase = quantiles(np.abs(value[1:])), quantiles(np.asarray(phase_degrees(value[1:], quantity)))
    return Band(label, frequency, value[0], magnitude, phase)


def _write(path: Path, head: Mapping[str, str], bands: Sequence[Band], quantity: str) -> Path:
    unit, parts = QUANTITIES[quantity], ("low", "median", "high")
    columns = ["level", "frequency [Hz]", f"magnitude [{unit}]", *(f"magnitude_{part} [{unit}]" for part in parts)]
    columns += ["phase [deg]", *(f"phase_{part} [deg]" for part in parts)]
    rows: list[list[object]] = []
    for band in bands:
        for i, f in enumerate(band.frequency.tolist()):
            given = float(np.abs(band.given[i])), float(phase_degrees(band.given[i], quantity))
            rows.append([band.label, f, given[0], *band.magnitude[:, i], given[1], *band.phase[:, i]])
    return write_table(path, head, columns, rows)


def _line(band: Band, quantity: str) -> str:
    low, middle, high = band.magnitude
    width = (high - low) / middle / 2
    if not np.isfinite(width).any():
        return f"{band.label}: no band"
    worst = int(np.nanargmax(width))
    return (
        f"{band.label}: |{'H' if quantity == 'receptance' else quantity}| within ±{100 * np.nanmedian(width):.2g} % in "
        f"the median of {band.frequency.size} frequencies, ±{100 * width[worst]:.2g} % at {band.frequency[worst]:g} Hz"
    )


def _drawn(row: Mapping[str, str]) -> Drawn:
    H = complex(float(row["H_re [m/N]"] or "nan"), float(row["H_im [m/N]"] or "nan"))
    return int(row["draw"]), float(row["level"]), float(row["frequency [Hz]"]), H
