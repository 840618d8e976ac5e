"""What `zspring couple` does: run and write, compare communication steps, export the system."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from pathlib import Path

from tqdm import tqdm

from ..errors import ZSpringError, tell
from ..heads import synthetic_note
from ..interrupt import Interrupted
from ..line.evaluated import of_start_up, sections
from ..line.limits import near_wave_speed, of_series, untold_supports
from ..line.mean_force import run_aimed
from ..line.result import LineResult, write_result
from ..line.run import LineRun, run_line
from ..line.schemes import Coupling
from ..line.statistics import low_pass
from ..line.system import System
from ..records import keep_others
from ..tables import read_rows, replaced, write_table
from ..variables import Value
from .compare import STEPS, compare_steps, compared, comparison_table
from .report import summary
from .ssp import write_ssp

Parameters = Mapping[str, Value]


@dataclass(frozen=True)
class Aim:
    """The mean force that a run is to have, over its evaluated spans, by the uplifts."""

    force: float  # N
    name: str  # of the law, and its speed
    spans: tuple[int, int] | None = None  # evaluated; None: those of the summary


def aimed(system: System, aim: Aim, run: Callable[[System], LineResult] = run_line) -> System:
    """The system with the uplifts that give each pantograph the mean force, found by runs; tells what they gave.

    Errors as those of run_aimed.
    """
    uplifts, _, reached = run_aimed(system, aim.force, aim.spans, run)
    one = [f"{mean:.1f} N with an uplift of {uplift:.1f} N" for mean, uplift in zip(reached, uplifts)]
    print(f"mean force {aim.name}: target {aim.force:.1f} N, reached {' and '.join(one)}")
    return replace(system, journey=replace(system.journey, uplift=uplifts))


def run_and_write(
    system: System,
    folder: Path,
    suffix: str,
    parquet: bool,
    aim: Aim | None = None,
    spans: tuple[int, int] | None = None,
    what: str = "",
) -> None:
    """Run along the line and write line.csv, perhaps line.parquet, and the figure line.<suffix>.

    spans   to evaluate; None: those of the summary
    what    of the line and the pantograph, for the title
    Raises Interrupted after Ctrl-C and ZSpringError where the run cannot go on; the rows so far are kept.
    """
    path, made = folder / "line.csv", list[LineRun]()
    aims = {"mean force aimed at": f"{aim.force:g} N"} if aim else {}

    def finished(system: System) -> LineResult:
        with LineRun(system) as run:
            run.settings |= aims
            if not made:
                _keep_others(path, run.settings, ["elapsed", *(["uplift"] if aim else [])])
            try:
                run.finish(progress=True)
            except (Interrupted, ZSpringError) as error:
                write_result(run.result(), path)
                raise type(error)(f"{error}; the rows so far are kept in {path}") from None
            made[:] = [run]
            return run.result()

    if aim:
        system = aimed(system, aim, finished)
    else:
        finished(system)
    (run,) = made
    result, extent = run.result(), run.line
    written = [path, *([folder / "line.parquet"] if parquet else []), folder / f"line.{suffix}"]
    for file in written[:-1]:
        write_result(result, file)
    remarks = near_wave_speed(system.catenary, system.line, system.journey.speed)
    remarks += untold_supports(system.catenary, extent)
    try:
        filtered = low_pass(result.contact_force, system.journey.step)
        chosen = sections(result, extent, spans)
        print(*summary(result, chosen), sep="\n")
        for i, section in enumerate(chosen):
            remarks += [*of_start_up(result, i, section, extent), *of_series(result.series(i), section)]
    except ZSpringError as error:
        filtered = None
        print(f"no statistics: {error}")
    tell(remarks, path)
    from ..figures import save  # matplotlib is slow to load: not before the run
    from .plot import line_figure

    save(line_figure(result, filtered, _title(result, system, what)), written[-1])
    duration = result.time[-1]
    print(
        f"{len(result.time) - 1} communication steps, each of {run.wire_steps:.2f} steps of the catenary\n"
        f"{duration:.3g} s of line in {result.elapsed:.2f} s, {duration / result.elapsed:.1f} times faster than "
        "real time"
    )
    print("written:", *written)


def compare_and_write(system: System, folder: Path, suffix: str, what: str = "") -> None:
    """Compare communication steps; write steps.csv and the figure steps.<suffix>.

    Raises ZSpringError where the run is too short for it.
    """
    with LineRun(system) as run:
        extent, journey, head = run.line, run.journey, run.settings
    run_up = extent.run_up(journey.start)
    least = journey.start + run_up + journey.speed * max(STEPS)
    if journey.stop < least:
        raise ZSpringError(
            f"stop = {journey.stop:g} m: with --compare-steps must be at least {least:g} m, one step of "
            f"{max(STEPS):g} s more than a span of {run_up:g} m after the start, {journey.start:g} m"
        )
    paths = folder / "steps.csv", folder / f"steps.{suffix}"
    keep_others(paths[0], head)
    bar = tqdm(total=len(compared(system.coupling.drive)) * len(STEPS), unit=" runs", disable=None)

    def one(step: float, coupling: Coupling, of_line: Parameters, of_pantographs: Parameters) -> LineResult:
        journey = replace(system.journey, step=step)
        with LineRun(system.changed(of_line, of_pantographs, journey=journey, coupling=coupling)) as run:
            run.finish()
            bar.update()
            return run.result()

    rows, stopped, speed = [], None, f"{3.6 * system.journey.speed:g} km/h"
    try:
        with bar:
            for row in compare_steps(one, system.coupling, run_up):
                rows.append(row)
    except (Interrupted, ZSpringError) as error:
        stopped = error
    if stopped and not rows:
        raise stopped
    columns = ["scheme", "step [s]", "rms [N]", "largest [N]", "mean [N]", "deviation [N]", "elapsed [s]"]
    write_table(paths[0], head, columns, map(astuple, rows), digits=None)
    print(*comparison_table(rows), sep="\n")
    if stopped:
        raise type(stopped)(f"{stopped}; the rows so far are kept in {paths[0]}")
    from ..figures import save  # matplotlib is slow to load: not before the runs
    from .plot import comparison_figure

    save(comparison_figure(rows, f"Coupling at {speed}; {what}"), paths[1])
    print("written:", *paths)


def export_ssp(system: System, path: Path) -> None:
    """Write the archive of SSP 1.0. Raises ZSpringError where one of another system is there."""
    with replaced(path) as unfinished, LineRun(system) as run:
        write_ssp(run, unfinished)
        if path.exists() and _members(path) != _members(unfinished):
            raise ZSpringError(f"{path} is of other settings: remove it, or name another file")
    print("written:", path)


def _members(path: Path) -> dict[str, int] | None:
    """Check sums of the files in an archive, None for what is none."""
    try:
        with zipfile.ZipFile(path) as archive:
            return {each.filename: each.CRC for each in archive.infolist()}
    except zipfile.BadZipFile:
        return None


def _keep_others(path: Path, head: Mapping[str, str], but: Sequence[str]) -> None:
    """keep_others without what a run comes to: `but` these keys."""
    if path.exists():
        found, _ = read_rows(path)
        keep_others(path, *({key: value for key, value in each.items() if key not in but} for each in (head, found)))


def _title(result: LineResult, system: System, what: str) -> str:
    settings, variables = result.settings, system.pantograph.variables
    suspension, friction = (settings[f"pantograph 1 {name}"] for name in ("suspension", "friction"))
    head = f"{friction} friction" if suspension == "ZSpring" else f"suspension {suspension}"
    names = variables.names("parameter")
    sets = [dict(zip(names, values)) for values in zip(*(system.of_each(name) for name in names))]
    notes = {synthetic_note(system.pantograph, used) for used in sets}
    numerics = f"{settings['coupling']} coupling, step {settings['step']}{max(notes, key=len)}"
    return f"{what}, {head}, {settings['speed']}\n{numerics}"
