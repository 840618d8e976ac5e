"""What `zspring couple` does: run and write, compare communication steps, export the system."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from tqdm import tqdm

from ..en50318.statistics import low_pass
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..interrupt import Interrupted
from ..tables import write_head
from ..variables import Value, parse
from .compare import COMPARED, STEPS, compare_steps, comparison_table
from .journey import Journey, LineExtent, parameter_value
from .plot import comparison_figure, line_figure
from .result import LineResult, write_result
from .run import LineRun
from .schemes import Coupling
from .ssp import write_ssp
from .summary import summary

Parameters = Mapping[str, Value]


def run_and_write(
    catenary: Fmu,
    pantograph: Fmu,
    line: Parameters,
    pantographs: Sequence[Parameters],
    journey: Journey,
    coupling: Coupling,
    folder: Path,
    suffix: str,
    parquet: bool,
) -> None:
    """Run along the line and write line.csv, perhaps line.parquet, and the figure line.<suffix>.

    Raises Interrupted after Ctrl-C and ZSpringError where the run cannot go on; the rows so far are kept.
    """
    path = folder / "line.csv"
    with LineRun(catenary, pantograph, line, pantographs, journey, coupling) as run:
        try:
            run.finish(progress=True)
        except (Interrupted, ZSpringError) as error:
            write_result(run.result(), path)
            raise type(error)(f"{error}; the rows so far are kept in {path}") from None
        result, extent, wire_steps = run.result(), run.line, run.wire_steps
    written = [path, *([folder / "line.parquet"] if parquet else []), folder / f"line.{suffix}"]
    for file in written[:-1]:
        write_result(result, file)
    try:
        filtered = low_pass(result.contact_force, journey.step)
        print(*summary(result, extent), sep="\n")
    except ZSpringError as error:
        filtered = None
        print(f"no statistics: {error}")
    save(line_figure(result, filtered, _title(result, pantograph, pantographs)), written[-1])
    duration = result.time[-1]
    print(
        f"{len(result.time) - 1} communication steps, each of {wire_steps:.2f} steps of the catenary\n"
        f"{duration:.3g} s of line in {result.elapsed:.2f} s, {duration / result.elapsed:.1f} times faster than "
        "real time"
    )
    print("written:", *written)


def compare_and_write(
    catenary: Fmu,
    pantograph: Fmu,
    line: Parameters,
    pantographs: Sequence[Parameters],
    journey: Journey,
    coupling: Coupling,
    folder: Path,
    suffix: str,
) -> None:
    """Compare communication steps; write steps.csv and the figure steps.<suffix>."""
    bar = tqdm(total=len(COMPARED) * len(STEPS), unit=" runs", disable=None)

    def one(
        step: float, with_coupling: Coupling, of_line: Parameters, of_pantograph: Parameters
    ) -> LineResult:
        each = [{**parameters, **of_pantograph} for parameters in pantographs]
        its_journey = replace(journey, step=step)
        with LineRun(catenary, pantograph, {**line, **of_line}, each, its_journey, with_coupling) as run:
            run.finish()
            bar.update()
            return run.result()

    rows, stopped = [], None
    try:
        with bar:
            for row in compare_steps(one, coupling, LineExtent.of(catenary, line).span):
                rows.append(row)
    except (Interrupted, ZSpringError) as error:
        stopped = error
    paths = folder / "steps.csv", folder / f"steps.{suffix}"
    if not rows:
        raise stopped
    folder.mkdir(parents=True, exist_ok=True)
    with open(paths[0], "w", encoding="utf-8", newline="") as file:
        head = {**catenary.identity, "speed": f"{3.6 * journey.speed:g} km/h", "drive": coupling.drive}
        columns = ["scheme", "step [s]", "rms [N]", "largest [N]", "mean [N]", "deviation [N]", "elapsed [s]"]
        write_head(file, head, columns)
        csv.writer(file, lineterminator="\n").writerows(asdict(row).values() for row in rows)
    print(*comparison_table(rows), sep="\n")
    if stopped:
        raise type(stopped)(f"{stopped}; the rows so far are kept in {paths[0]}")
    save(comparison_figure(rows, f"Coupling at {3.6 * journey.speed:g} km/h"), paths[1])
    print("written:", *paths)


def export_ssp(
    catenary: Fmu,
    pantograph: Fmu,
    line: Parameters,
    pantographs: Sequence[Parameters],
    journey: Journey,
    coupling: Coupling,
    path: Path,
) -> None:
    """Write the archive of SSP 1.0."""
    with LineRun(catenary, pantograph, line, pantographs, journey, coupling) as run:
        write_ssp(run, path)
    print("written:", path)


def _title(result: LineResult, pantograph: Fmu, pantographs: Sequence[Parameters]) -> str:
    settings = result.settings
    title = f"{settings['speed']}, {settings['coupling']} coupling, step {settings['step']}"
    suspension = pantograph.variables["suspension"]
    if any(
        parameter_value(pantograph, each, "suspension") == parse(suspension, "ZSpring")
        for each in pantographs
    ):
        names = pantograph.variables.names("parameter")
        if any(
            pantograph.variables.synthetic({name: parameter_value(pantograph, each, name) for name in names})
            for each in pantographs
        ):
            title += "; Z-spring parameters synthetic"
    return title
