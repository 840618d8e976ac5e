"""The figures of docs/trust.md: measured here and written between the page's markers. Run it with scripts/trust.

    <!-- begin NAME --> table <!-- end NAME -->

Without names all parts are measured, which takes about a quarter of an hour; with names just these.
"""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from endurance import latency, measure
from fuzzing import fuzz
from paths import ROOT
from random_sets import DECADES, Tally, judge_all
from stress import Effort, grid
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu

PAGE = ROOT / "docs" / "trust.md"
MODELS = (PANTOGRAPH, CATENARY)
SETS, SHARES = 10_000, 16  # shares that processes take
SEQUENCES = {PANTOGRAPH: 100_000, CATENARY: 10_000}
LATENCY_STEPS = {PANTOGRAPH: 5_000_000, CATENARY: 200_000}
SOAK_STEPS = {PANTOGRAPH: 100_000_000, CATENARY: 500_000}
RESETS = {PANTOGRAPH: 100_000, CATENARY: 2_000}


def table(header: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    lines = [list(header), ["---", *["---:"] * (len(list(header)) - 1)], *(map(str, row) for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def thousands(n: float) -> str:
    return f"{n:,.0f}".replace(",", " ")


def stress() -> str:
    efforts: dict[tuple[str, str], Effort] = defaultdict(Effort)
    with Fmu() as fmu:
        for load, law, _, effort in grid(fmu):
            efforts[load, law].add(effort)
    return table(
        ["load", "law", "internal steps", "iterations a step", "worst", "halvings", "discarded"],
        (
            [load, law, thousands(e.steps), f"{e.iterations / e.steps:.2f}", e.worst, e.halvings, e.discarded]
            for (load, law), e in efforts.items()
        ),
    )


def random_sets() -> str:
    rows = []
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for model in MODELS:
            for kind, decades in DECADES.items():
                parts = [pool.submit(judge_all, model, kind, range(SETS)[i::SHARES]) for i in range(SHARES)]
                tally = sum((part.result() for part in parts), Tally())
                for fault in tally.faults:
                    print(fault, file=sys.stderr)
                counts = [tally.outcomes[kind] for kind in ("ran", "discarded", "refused")]
                error = f"{tally.worst_error:.0e}" if tally.worst_error else ""
                name = f"{model}, {kind} (a factor of {10**decades:.3g})"
                rows.append([name, *counts, tally.refined or "", error, tally.sensitive or "", len(tally.faults)])
    header = "sets, ran, a step discarded, refused, balanced by finer steps, worst error of Newton, sensitive, faults"
    return table(header.split(", "), rows)


def calls() -> str:
    kinds = ["calls", "situations", "refused", "steps", "discarded", "states", "foreign", "replays"]
    rows = []
    for model in MODELS:
        done = fuzz(model, "--random", 1_000_000, SEQUENCES[model])
        rows.append([model, thousands(SEQUENCES[model]), *(thousands(done[kind]) for kind in kinds)])
    header = "FMU, sequences, calls, kinds of call x states, refused, steps made, steps discarded, states kept".split(
        ", "
    )
    return table([*header, "damaged states that were accepted", "replays, bit for bit"], rows)


def time_of_a_step() -> str:
    rows = []
    for model in MODELS:
        step, cycle = latency(model, LATENCY_STEPS[model])
        for name, t in (("fmi2DoStep", step), ("inputs, step, outputs", cycle)):
            rows.append(
                [
                    f"{model}, {name}",
                    thousands(LATENCY_STEPS[model]),
                    *(f"{x:.3g}" for x in (t.median, t.p99, t.p999, t.p9999, t.worst)),
                ]
            )
    return table(["us", "steps", "median", "99 %", "99.9 %", "99.99 %", "worst"], rows)


def endurance() -> str:
    rows = []
    for model in MODELS:
        _, early, late = measure(model, "soak", SOAK_STEPS[model])
        rows.append([f"{model}: {thousands(SOAK_STEPS[model])} steps", f"{late - early:.0f} KiB more memory"])
        _, early, late = measure(model, "resets", RESETS[model])
        rows.append(
            [f"{model}: {thousands(RESETS[model])} resets with a step each", f"{late - early:.0f} KiB more memory"]
        )
        each, differing = measure(model, "instances", 1000)
        rows.append([f"{model}: 1 000 instances at once", f"{each:.0f} KiB each, {differing:.0f} with other results"])
        (differing,) = measure(model, "threads", SOAK_STEPS[model] // 100)
        rows.append([f"{model}: eight threads, an instance each", f"{differing:.0f} with other results"])
    return table(["test", "result"], rows)


PARTS: dict[str, Callable[[], str]] = {
    "stress": stress,
    "random_sets": random_sets,
    "calls": calls,
    "time_of_a_step": time_of_a_step,
    "endurance": endurance,
}


def markers(name: str) -> tuple[str, str]:
    return f"<!-- begin {name} -->\n", f"<!-- end {name} -->"


def part(page: str, name: str) -> str:
    """What stands between the markers."""
    begin, end = markers(name)
    return page[page.index(begin) + len(begin) : page.index(end)]


def cells(table: str) -> list[list[str]]:
    """Rows of a table without its head."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


def numbers(cell: str) -> list[float]:
    return [float(number.replace(" ", "")) for number in re.findall(r"\d[\d ]*(?:\.\d+)?(?:e[-+]\d+)?", cell)]


def measure_into(page: Path, name: str) -> str:
    """Measure a part and write it there; returns its table."""
    found, text = PARTS[name](), page.read_text("utf-8")
    begin, end = markers(name)
    page.write_text(text.replace(begin + part(text, name) + end, f"{begin}{found}\n{end}"), "utf-8")
    return found


if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        print(f"{name}\n{measure_into(PAGE, name)}\n", flush=True)
