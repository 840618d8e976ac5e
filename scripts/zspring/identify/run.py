"""An identification from settings to result folder."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..bench.conditions import FILE_ORDER
from ..bench.curves import in_band, sign_warning
from ..bench.measured import read_curves
from ..bench.model import BenchModel
from ..bench.static_test import read_static_test
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..interrupt import Interrupted, stop_on_interrupt
from ..records import keep_others
from ..tables import read_rows
from ..variables import parse, with_unit
from . import report
from .choice import Candidate, choice_table, name_of
from .files import fit_head, write_fitted, write_points, write_posterior
from .fit import Fit
from .fit_report import write_fit_report
from .plot import fit_figure, harmonics_figure, posterior_figure, static_figure
from .problem import Model, Problem, ThreeMassModel, ZSpringModel
from .settings import Settings
from .stages import PARTIAL, Log, Stages
from .targets import settled_targets


def identify(fmu: Fmu, settings: Settings, path: Path, folder: Path, suffix: str, jobs: int) -> Fit:
    """Fit, going on where an interrupted search in the folder stopped; write and print all results.

    path        of the settings, for the log
    suffix      of the figures, "png" or "svg"
    jobs        number of amplitudes measured at a time
    Raises ZSpringError for bad data, FmuError when the FMU refuses the start values, Interrupted after
    Ctrl-C.
    """
    curves = [curve for source in settings.sources for curve in read_curves(source)]
    curves.sort(key=lambda curve: float(np.median(curve.acceleration)))
    if settings.model == "linear":
        curves = [curve for curve in curves if curve.label == curves[0].label]
    curves = in_band(curves, settings.band)
    settings = settled_targets(settings, curves)
    count = 2 * sum(curve.frequency.size for curve in curves)
    if count <= len(settings.free):
        raise ZSpringError(f"{count} measured numbers cannot determine {len(settings.free)} parameters")
    static = None
    if settings.static:
        static = read_static_test(settings.static.path, settings.static.speed, settings.static.force)
    for warning in sign_warning(curves), static and static.sign_warning:
        if warning:
            print(warning, file=sys.stderr)
    defaults = {v.name: parse(v, v.start) for v in fmu.variables if v.causality == "parameter"}

    _keep_others(folder / "fit.csv", fit_head(fmu, settings))
    folder.mkdir(parents=True, exist_ok=True)
    with stop_on_interrupt() as stop, Log(folder / "identify.log") as log, fmu.instances(jobs) as instances:
        bench = BenchModel(instances, settings.direction or FILE_ORDER, stop)
        try:
            if settings.model == "linear":
                model: Model = ThreeMassModel(curves, defaults)
            else:
                model = ZSpringModel(bench, curves, static)
            problem = Problem(settings, model, curves, static)
            bench.check(settings.parameters(problem.start))
            log.write(f"settings {path}:\n{path.read_text(encoding='utf-8')}")
            begin, stages = time.perf_counter(), Stages(fmu, folder, stop, log)
            x = problem.start
            if settings.search.samples:
                x = stages.search(problem)
            result = stages.fit(problem, x, "least squares")
            paths = [
                write_fitted(fmu, problem, result, defaults, folder / "fitted.ssv"),
                write_points(fmu, problem, result, folder / "fit.csv"),
            ]
            with _told(paths):
                drawn = stages.drawn(problem, model, result)
                profiles = stages.profiles(problem, result) if settings.uncertainty.profiles else None
                posterior = stages.posterior(problem, result) if settings.uncertainty.draws else None
                if posterior:
                    paths.append(write_posterior(fmu, problem, posterior, folder / "draws.csv"))
                chosen = [Candidate(name_of(fmu, {**defaults, **settings.fixed}), problem, result)]
                if settings.compare_models:
                    chosen += stages.others(problem, result, defaults, model)
            for name in PARTIAL:
                (folder / name).unlink(missing_ok=True)
        finally:
            bench.close()
        tables = {
            "Parameters": [
                *report.parameter_table(fmu, problem, result),
                *report.doubts(problem, result),
                *report.posterior_doubts(posterior),
            ],
            "Intervals": report.interval_table(fmu, problem, result, profiles, posterior),
            "Correlations": report.correlation_table(problem, result),
            "Residuals": report.residual_table(problem, result),
            "Models": choice_table(chosen) if settings.compare_models else [],
        }
        log.say("\n\n".join("\n".join(lines) for lines in tables.values() if lines))
        log.say(f"fitted in {time.perf_counter() - begin:.1f} s")
    if settings.model == "zspring":
        force = with_unit(fmu.variables["static_force"], settings.parameters(result.x)["static_force"])
        print(
            f"identified at the bench's static force, {force}, which is not in fitted.ssv: the line has its own; "
            f"as on the bench: --parameters {paths[0]} --set static_force={force.split()[0]}"
        )
    title = f"Identified from {', '.join(source.path.name for source in settings.sources)}"
    figures = {"fit": fit_figure(curves, result.answer.curves, drawn, f"{title}: {settings.model} model")}
    if static and result.answer.static is not None:
        figures["static"] = static_figure(static, result.answer.static, f"{title}: static test")
    harmonics = harmonics_figure(curves, result.answer.harmonics or (), f"{title}: harmonics of the contact force")
    if harmonics and result.answer.harmonics:
        figures["harmonics"] = harmonics
    if posterior:
        units = {name: fmu.variables[name].unit or "1" for name in settings.free}
        figures["posterior"] = posterior_figure(problem, result, posterior, units, f"{title}: posterior")
    for name, figure in figures.items():
        paths.append(folder / f"{name}.{suffix}")
        save(figure, paths[-1])
    about = write_fit_report(fmu, problem, result, title, tables, figures, folder / "report.html")
    print("written:", *paths, about, folder / "identify.log")
    return result


@contextmanager
def _told(paths: Sequence[Path]) -> Iterator[None]:
    """What is written already is told where the rest is interrupted."""
    try:
        yield
    except Interrupted as stop:
        raise Interrupted(f"{stop}; written so far: {', '.join(map(str, paths))}") from None


def _keep_others(path: Path, head: Mapping[str, str]) -> None:
    """As keep_others; what was fitted stands in the head of fit.csv, too, and is no setting."""
    if path.exists():
        found = read_rows(path)[0]
        keep_others(path, head, {key: found[key] for key in head if key in found})
