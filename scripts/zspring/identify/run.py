"""An identification from settings to result folder."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..bench.conditions import FILE_ORDER
from ..bench.curves import Curve, in_band, sign_warning
from ..bench.measured import read_curves
from ..bench.model import BenchModel
from ..bench.static_test import read_static_test
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..interrupt import Interrupted, stop_on_interrupt
from ..records import keep_others
from ..tables import read_rows
from ..variables import Value, parse, with_unit
from . import report
from .choice import Candidate, choice_table, name_of, others
from .costs import Costs, cost_record
from .files import fit_head, write_fitted, write_points, write_posterior
from .fit import Fit, fit
from .fit_report import write_fit_report
from .plot import fit_figure, harmonics_figure, posterior_figure, static_figure
from .posterior import Posterior, sample
from .problem import Answer, Model, Problem, ThreeMassModel, ZSpringModel
from .profile import profile_interval
from .search import search
from .settings import Settings
from .targets import settled_targets

PARTIAL = SEARCH, POSTERIOR = "search.partial.csv", "posterior.partial.csv"
FINE = 100  # points of a drawn curve
WORSE = 1.1  # times the cost: another minimum


def identify(fmu: Fmu, settings: Settings, path: Path, folder: Path, suffix: str, jobs: int) -> None:
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
    with stop_on_interrupt() as stop, _Log(folder / "identify.log") as log, fmu.instances(jobs) as instances:
        bench = BenchModel(instances, settings.direction or FILE_ORDER, stop)
        try:
            if settings.model == "linear":
                model: Model = ThreeMassModel(curves, defaults)
            else:
                model = ZSpringModel(bench, curves, static)
            problem = Problem(settings, model, curves, static)
            bench.check(settings.parameters(problem.start))
            log.write(f"settings {path}:\n{path.read_text(encoding='utf-8')}")
            begin = time.perf_counter()
            x = problem.start
            if settings.search.samples:
                x = _search(fmu, problem, folder, stop, log)
            result = _fit(problem, x, "least squares", stop, log)
            drawn = _drawn(problem, model, result, stop)
            profiles = _profiles(problem, result, stop, log) if settings.uncertainty.profiles else None
            posterior = _posterior(fmu, problem, result, folder, stop, log) if settings.uncertainty.draws else None
            chosen = [Candidate(name_of(fmu, {**defaults, **settings.fixed}), problem, result)]
            if settings.compare_models:
                chosen += _others(fmu, problem, result, defaults, model, stop, log)
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
    paths = [
        write_fitted(fmu, problem, result, defaults, folder / "fitted.ssv"),
        write_points(fmu, problem, result, folder / "fit.csv"),
    ]
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
        paths.append(write_posterior(fmu, problem, posterior, folder / "draws.csv"))
        figures["posterior"] = posterior_figure(problem, result, posterior, units, f"{title}: posterior")
    for name, figure in figures.items():
        paths.append(folder / f"{name}.{suffix}")
        save(figure, paths[-1])
    about = write_fit_report(fmu, problem, result, title, tables, figures, folder / "report.html")
    print("written:", *paths, about, folder / "identify.log")


def _keep_others(path: Path, head: Mapping[str, str]) -> None:
    """As keep_others; what was fitted stands in the head of fit.csv, too, and is no setting."""
    if path.exists():
        found = read_rows(path)[0]
        keep_others(path, head, {key: found[key] for key in head if key in found})


def _search(fmu: Fmu, problem: Problem, folder: Path, stop, log: _Log) -> np.ndarray:
    """Where to begin the fit.

    On a part of the points: the search, then least squares from the start values and from its best.
    """
    settings = problem.settings
    coarse = problem.thinned(settings.search.points)
    count = settings.search.candidates(problem.start.size)
    with _costs(fmu, coarse, coarse.rough, folder / SEARCH, count, "search", stop) as costs:
        found = search(problem.start, settings.search, costs)
    names = ["the start values", *(f"start {i} of the search" for i in range(1, len(found) + 1))]
    fits = {
        name: _fit(coarse, x, f"least squares on a part, from {name}", stop, log)
        for name, x in zip(names, [problem.start, *found])
    }
    best = min(fits, key=lambda name: fits[name].cost)
    for name, other in fits.items():
        if other.cost > WORSE * fits[best].cost + 1e-9:
            log.say(
                f"from {name} least squares end in a worse minimum (cost {other.cost:.4g}) than from {best} "
                f"({fits[best].cost:.4g})"
            )
    return fits[best].x


@contextmanager
def _costs(fmu: Fmu, problem: Problem, like: Answer | None, path: Path, total: int, name: str, stop) -> Iterator[Costs]:
    """Costs of so many candidates, kept in a file, with a progress bar."""
    record = cost_record(path, fit_head(fmu, problem.settings), list(problem.settings.free))
    if record.results:
        print(f"going on after {len(record.results)} candidates in {path}")
    with record, tqdm(total=total, desc=name, unit=" candidates", disable=None) as bar:

        def progress(cost: float) -> None:
            bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
            bar.update()

        yield Costs(problem, like, record, stop, progress)


def _posterior(fmu: Fmu, problem: Problem, result: Fit, folder: Path, stop, log: _Log) -> Posterior:
    """Draws from the posterior."""
    settings = problem.settings.uncertainty
    path = folder / POSTERIOR
    with _costs(fmu, problem, result.answer, path, settings.draws, "posterior", stop) as costs:
        posterior = sample(problem, result, settings.draws, settings.seed, costs)
    log.write(f"posterior: effective sample size {posterior.effective:.3g} of {posterior.drawn} draws")
    return posterior


def _profiles(problem: Problem, result: Fit, stop, log: _Log) -> list[tuple[float, float]]:
    """Intervals in x of all parameters by profile likelihood, with a progress bar."""
    intervals = []
    with tqdm(desc="profiles", unit=" evaluations", disable=None) as bar:

        def progress(cost: float) -> None:
            _check(stop)
            bar.update()

        for i, name in enumerate(problem.settings.free):
            intervals.append(profile_interval(problem, result, i, report.SHARE, progress))
            _check(stop)
            log.write(f"profile of {name}: {intervals[-1]} between its bounds")
    return intervals


def _others(
    fmu: Fmu, problem: Problem, result: Fit, defaults: Mapping[str, Value], model: Model, stop, log: _Log
) -> list[Candidate]:
    """The other models, each fitted from where this one ended, or from its own start values."""
    found = []
    for name, settings in others(fmu, problem.settings, defaults).items():
        other = Problem(settings, model, problem.curves, problem.static)
        x = result.x if list(settings.free) == list(problem.settings.free) else other.start
        found.append(Candidate(name, other, _fit(other, x, name, stop, log)))
    return found


def _check(stop) -> None:
    """Raises Interrupted after Ctrl-C: answers are NaN from then on."""
    if stop.is_set():
        raise Interrupted("interrupted; the same command goes on after the search")


def _fit(problem: Problem, x: np.ndarray, name: str, stop, log: _Log) -> Fit:
    """Least squares from x (n,), with a progress bar."""
    with tqdm(desc=name, unit=" evaluations", disable=None) as bar:

        def progress(cost: float) -> None:
            _check(stop)
            log.write(f"{name}: cost {cost:.6g}")
            bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
            bar.update()

        result = fit(problem, x, progress)
        _check(stop)  # answers of the last Jacobian may be NaN
        return result


def _drawn(problem: Problem, model: Model, result: Fit, stop) -> list[Curve]:
    """What the fitted model has at and between the points. Raises Interrupted after Ctrl-C."""
    fine = [replace(curve, H=H).refined(FINE) for curve, H in zip(problem.curves, result.answer.curves)]
    between = [curve.at(np.isnan(curve.H)) for curve in fine]
    (answer,) = model.with_curves(between).answers([problem.settings.parameters(result.x)])
    _check(stop)
    for curve, H in zip(fine, answer.curves):
        curve.H[np.isnan(curve.H)] = H
    return fine


class _Log:
    """The log of the run: a file, with the time of each entry."""

    def __init__(self, path: Path):
        self._file = open(path, "w", encoding="utf-8")

    def write(self, text: str) -> None:
        """To the file alone."""
        time_of_day = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        self._file.write(f"{time_of_day}  {text}\n")
        self._file.flush()

    def say(self, text: str) -> None:
        """To the file and to standard output."""
        self._file.write(f"{text}\n")
        print(text)

    def __enter__(self) -> _Log:
        return self

    def __exit__(self, *_) -> None:
        self._file.close()
