"""The tables of the Newton study, for files and for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

from .accuracy import Errors
from .iteration import TANGENTS
from .work import TangentWork, total

WORK_COLUMNS = [
    "friction",
    "tangent",
    "tau [s]",
    "amplitude [m/s2]",
    "points",
    "steps",
    "iterations",
    "iterations_max",
    "halvings",
    "discards",
    "time [s]",
]
ERROR_COLUMNS = ["tau [s]", "H median [1]", "H largest [1]", "contact force [1]", "head position [1]"]


def work_row(work: TangentWork) -> list[float | str]:
    """The work in the order of WORK_COLUMNS."""
    row = astuple(work)
    return ["all" if cell is None else cell for cell in row]


def tables(by_amplitude: Sequence[TangentWork], by_tau: Sequence[TangentWork], errors: Sequence[Errors]) -> list[str]:
    """Lines of the three tables: work by amplitude, work by tau, errors by tau."""
    amplitudes = sorted({work.amplitude for work in by_amplitude if work.amplitude is not None})
    lines = [
        f"iterations a step (halved steps, %) by amplitude in m/s2, tau = {by_amplitude[0].tau:g} s",
        f"{'':<22}" + "".join(f"{a:>14g}" for a in amplitudes) + f"{'most':>6}{'discards':>10}{'time':>9}",
    ]
    for law, tangent in dict.fromkeys((work.law, work.tangent) for work in by_amplitude):
        own = [work for work in by_amplitude if (work.law, work.tangent) == (law, tangent)]
        cells = "".join(f"{f'{w.iterations_per_step:.2f} ({w.halved_percent:.2f})':>14}" for w in own)
        whole = total(own)
        costs = f"{whole.iterations_max:>6}{whole.discards:>10}{whole.seconds:>7.2f} s"
        lines.append(f"{f'{law} {tangent}':<22}{cells}{costs}")
    taus = list(dict.fromkeys(work.tau for work in by_tau))
    lines += [
        "",
        f"iterations a step (halved steps, %), time, by tau in s; {by_tau[0].points} points",
        f"{'':<11}" + "".join(f"{tau:>22g}" for tau in taus) + f"{'discards':>10}",
    ]
    for tangent in TANGENTS:
        own = [work for work in by_tau if work.tangent == tangent]
        cells = "".join(
            f"{f'{w.iterations_per_step:.2f} ({w.halved_percent:.1f}), {w.seconds:.2f} s':>22}" for w in own
        )
        lines.append(f"{tangent:<11}{cells}{sum(work.discards for work in own):>10}")
    lines += [
        "",
        "error against the Coulomb law, %, by tau in s",
        f"{'':<15}" + "".join(f"{error.tau:>10g}" for error in errors),
    ]
    for name, label in (
        ("H_median", "H, median"),
        ("H_largest", "H, worst"),
        ("contact_force", "contact force"),
        ("head_position", "head position"),
    ):
        lines.append(f"{label:<15}" + "".join(f"{100 * getattr(error, name):>10.3g}" for error in errors))
    return lines
