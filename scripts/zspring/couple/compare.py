"""What the coupling costs in accuracy: one run with several schemes and communication steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..line.result import LineResult
from ..line.schemes import Coupling
from ..text_tables import aligned

STEPS = (0.5e-3, 1e-3, 2e-3, 5e-3)  # s


def compared(drive: str) -> tuple[str, ...]:
    """The schemes that know this drive of the pantographs."""
    return ("sequential", "parallel", "implicit", "explicit", "jacobi") if drive == "Wire" else ("implicit", "explicit")


@dataclass(frozen=True)
class Comparison:
    """One run against the reference."""

    scheme: str
    step: float  # s
    rms: float  # N, error of the contact force
    largest: float  # N
    mean: float  # N, of the contact force
    deviation: float  # N
    elapsed: float  # s


def compare_steps(
    run: Callable[[float, Coupling, Mapping[str, float], Mapping[str, float]], LineResult],
    coupling: Coupling,
    travelled_from: float,
    steps: Sequence[float] = STEPS,
) -> Iterator[Comparison]:
    """Errors of all schemes at these communication steps, against implicit coupling at the smallest one.

    run             makes a run: step in s, coupling, more parameters of the catenary and of the pantographs
    travelled_from  distance from the start at which the comparison begins, m

    The FMUs' internal step is the smallest communication step in all runs. There implicit coupling is the
    monolithic solution, so that the coupling alone makes the difference. Unfiltered forces are compared at
    the communication points of each run. The first row is the reference.
    """
    fine = min(steps)
    internal = {"solver.step": fine}

    def compare(scheme: str, step: float, reference: LineResult | None) -> tuple[LineResult, Comparison]:
        result = run(step, replace(coupling, scheme=scheme), internal, internal)
        exact = (reference or result).contact_force[:: round(step / fine)]
        rows = min(len(exact), len(result.contact_force))
        used = (result.position[:rows] - result.position[0])[:, 0] >= travelled_from
        force = result.contact_force[:rows][used]
        error = np.abs(force - exact[:rows][used])
        rms = float(np.sqrt(np.mean(error**2)))
        numbers = float(error.max()), float(force.mean()), float(force.std()), result.elapsed
        return result, Comparison(scheme, step, rms, *numbers)

    reference, first = compare("implicit", fine, None)
    cases = [(scheme, step) for scheme in compared(coupling.drive) for step in steps]
    cases.remove(("implicit", fine))
    yield first
    for case in cases:
        yield compare(*case, reference)[1]


def comparison_table(rows: Sequence[Comparison]) -> list[str]:
    """Lines by scheme and step: error of the contact force, its mean and deviation, all in N; time."""
    lines = [["coupling", "step", "error, rms", "largest", "mean force", "deviation", "time"]]
    for i, row in enumerate(rows):
        errors = [f"{row.rms:.3g} N", f"{row.largest:.3g} N"] if i else ["reference", ""]
        figures = [f"{row.mean:.2f} N", f"{row.deviation:.2f} N", f"{row.elapsed:.2f} s"]
        lines.append([row.scheme, f"{1e3 * row.step:g} ms", *errors, *figures])
    return aligned(lines, right=True)
