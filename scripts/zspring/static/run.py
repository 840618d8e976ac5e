"""The static study from settings to result folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from tqdm import tqdm

from ..bench.loops import CLAMP, POINTS, Loop, measure_loop
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..heads import file_head, synthetic_note
from ..interrupt import Interrupted, stop_on_interrupt
from ..records import keep_others
from ..tables import write_table
from ..text_tables import aligned
from ..variables import Value, exact_list, text
from .plot import LAW_STYLES, static_figure

STIFFNESS = "stiffness.csv"


def run_static(
    fmu: Fmu,
    parameters: Mapping[str, Value],
    amplitudes: Sequence[float],
    rates: Sequence[float],
    folder: Path,
    suffix: str,
    pantograph: str = "pantograph of the FMU",
) -> None:
    """Measure all loops, amplitudes in m and rates in m/s; write stiffness.csv, loops.csv and the figure.

    pantograph  in words, for the title of the figure
    Raises ZSpringError for a suspension without friction, FmuError when the FMU refuses a parameter,
    Interrupted after Ctrl-C (the loops so far are kept).
    """
    used = fmu.used_parameters(parameters)
    suspension = text(fmu.variables["suspension"], used["suspension"])
    if suspension != "ZSpring":
        raise ZSpringError(f"suspension = {suspension}: must be ZSpring, the others have no friction")
    head = _head(fmu, used, amplitudes, rates)
    keep_others(folder / STIFFNESS, head)
    cases = [(law, rate, amplitude) for law in LAW_STYLES for rate in rates for amplitude in amplitudes]
    loops: list[Loop] = []
    with fmu.instances() as (instance,), stop_on_interrupt() as stop:
        for case in tqdm(cases, unit=" loops", disable=None):
            loops.append(measure_loop(instance, parameters, *case))
            if stop.is_set():
                break
    paths = _write(head, loops, folder)
    if len(loops) < len(cases):
        raise Interrupted(f"interrupted after {len(loops)} of {len(cases)} loops, kept in {folder}")
    paths.append(folder / f"static.{suffix}")
    title = f"Head suspension under slow loading, {pantograph}{synthetic_note(fmu, used)}\n{POINTS} steps a loop"
    save(static_figure(loops, used, title), paths[-1])
    print(*_table(loops, used), sep="\n")
    print("written:", *paths)


def _head(fmu: Fmu, used: Mapping[str, Value], amplitudes: Sequence[float], rates: Sequence[float]) -> dict[str, str]:
    own = {
        "clamped frame": f"k2 = k3 = {CLAMP} N/m while measuring",
        "amplitudes": exact_list(amplitudes, "m"),
        "rates": exact_list(rates, "m/s"),
    }
    return file_head(fmu, used, own, but_not=("drive", "friction", "k2", "k3", "solver.step"))


def _write(head: Mapping[str, str], loops: Sequence[Loop], folder: Path) -> list[Path]:
    stiffness, curves = folder / STIFFNESS, folder / "loops.csv"
    key = ["friction", "rate [m/s]", "amplitude [m]"]
    write_table(
        stiffness,
        head,
        [*key, "stiffness [N/m]", "dissipated in a cycle [J]"],
        ([x.law, x.rate, x.amplitude, x.stiffness, x.dissipated] for x in loops),
    )
    write_table(
        curves,
        head,
        [*key, "compression [m]", "force [N]"],
        (
            [x.law, x.rate, x.amplitude, compression, force]
            for x in loops
            for compression, force in zip(x.compression, x.force)
        ),
    )
    return [stiffness, curves]


def _table(loops: Sequence[Loop], used: Mapping[str, Value]) -> list[str]:
    """Equivalent stiffness by law, rate and amplitude, and how much of it is the rate's doing."""
    found = {(loop.law, loop.rate, loop.amplitude): loop.stiffness for loop in loops}
    amplitudes = sorted({amplitude for _, _, amplitude in found})
    rates = sorted({rate for _, rate, _ in found})
    locked, free = used["zspring.k_locked"], used["zspring.k_free"]
    rows = [["amplitude, mm", *(f"{1e3 * a:g}" for a in amplitudes)]]
    for law in LAW_STYLES:
        for rate in rates:
            rows.append([f"{law}, {1e3 * rate:g} mm/s", *(f"{1e-3 * found[law, rate, a]:.3f}" for a in amplitudes)])
    title = f"equivalent stiffness in N/mm; {1e-3 * locked:.3f} with locked, {1e-3 * free:.3f} with free rods"
    lines = [title, *aligned(rows, right=True)]
    if len(rates) > 1:
        spread = {
            law: max(
                max(found[law, r, a] for r in rates) / min(found[law, r, a] for r in rates) - 1 for a in amplitudes
            )
            for law in LAW_STYLES
        }
        lines.append(
            "largest change with the rate: " + ", ".join(f"{law} {100 * x:.1f} %" for law, x in spread.items())
        )
    return lines
