"""An identification from settings to result folder."""

from __future__ import annotations

import hashlib
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..bench.conditions import FILE_ORDER
from ..bench.curves import Curve, in_band, sign_warning
from ..bench.measure import FrfSettings
from ..bench.measured import read_curves
from ..bench.model import BenchModel
from ..bench.static_test import read_static_test
from ..errors import ZSpringError
from ..figures import save
from ..fmu import Fmu
from ..heads import file_head
from ..interrupt import Interrupted, stop_on_interrupt
from ..parameter_sets import write_set
from ..records import Record, keep_others
from ..tables import read_rows, write_table
from ..variables import Value, parse, with_unit
from . import report
from .fit import Fit, fit
from .plot import fit_figure, static_figure
from .problem import Model, Problem, ThreeMassModel, ZSpringModel
from .search import Cost, cost_record, search
from .settings import LINEAR_PARAMETERS, Settings
from .targets import settled_targets

# Of the bench, the line and the solver, so not of a pantograph.
OTHER_PARAMETERS = ("drive", "bench.", "static_force", "contact.", "solver.")
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

    _keep_others(folder / "fit.csv", _head(fmu, settings))
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
                x, record = _search(fmu, problem, folder, stop, log)
            result = _fit(problem, x, "least squares", stop, log)
            drawn = _drawn(problem, model, result, stop)
            if settings.search.samples:
                record.path.unlink()
        finally:
            bench.close()
        summary = [
            *report.parameter_table(fmu, problem, result),
            *report.doubts(problem, result),
            "",
            *report.correlation_table(problem, result),
            "",
            *report.residual_table(problem, result),
            f"fitted in {time.perf_counter() - begin:.1f} s",
        ]
        for line in summary:
            log.say(line)
    paths = [
        _write_set(fmu, problem, result, defaults, folder / "fitted.ssv"),
        _write_points(fmu, problem, result, folder / "fit.csv"),
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
    for name, figure in figures.items():
        paths.append(folder / f"{name}.{suffix}")
        save(figure, paths[-1])
    print("written:", *paths, folder / "identify.log")


def _head(fmu: Fmu, settings: Settings) -> dict[str, str]:
    """All that defines a fit."""
    files = [*(source.path for source in settings.sources), *([settings.static.path] if settings.static else [])]
    return {
        "SHA-256 of the FMU": fmu.sha256,
        **{f"setting {key}": repr(value) for key, value in settings},
        **{f"file {i}": f"{hashlib.sha256(path.read_bytes()).hexdigest()} {path}" for i, path in enumerate(files, 1)},
    }


def _keep_others(path: Path, head: Mapping[str, str]) -> None:
    """As keep_others; what was fitted stands in the head of fit.csv, too, and is no setting."""
    if path.exists():
        found = read_rows(path)[0]
        keep_others(path, head, {key: found[key] for key in head if key in found})


def _search(fmu: Fmu, problem: Problem, folder: Path, stop, log: _Log) -> tuple[np.ndarray, Record[Cost]]:
    """Where to begin the fit, and the record of the search, which may be removed after it.

    On a part of the points: the search, then least squares from the start values and from its best.
    """
    settings = problem.settings
    coarse = problem.thinned(settings.search.points)
    record = cost_record(folder / "search.partial.csv", _head(fmu, settings), list(settings.free))
    if record.results:
        print(f"going on after {len(record.results)} candidates in {record.path}")
    count = settings.search.candidates(problem.start.size)
    with record, tqdm(total=count, desc="search", unit=" candidates", disable=None) as bar:

        def progress(cost: float) -> None:
            bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
            bar.update()

        found = search(coarse, settings.search, record, stop, progress)
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
    return fits[best].x, record


def _fit(problem: Problem, x: np.ndarray, name: str, stop, log: _Log) -> Fit:
    """Least squares from x (n,), with a progress bar."""
    with tqdm(desc=name, unit=" evaluations", disable=None) as bar:

        def check() -> None:
            if stop.is_set():
                raise Interrupted("interrupted; the same command goes on after the search")

        def progress(cost: float) -> None:
            check()
            log.write(f"{name}: cost {cost:.6g}")
            bar.set_postfix_str(f"cost {cost:.4g}", refresh=False)
            bar.update()

        result = fit(problem, x, progress)
        check()  # answers of the last Jacobian may be NaN
        return result


def _drawn(problem: Problem, model: Model, result: Fit, stop) -> list[Curve]:
    """What the fitted model has at and between the points. Raises Interrupted after Ctrl-C."""
    fine = [replace(curve, H=H).refined(FINE) for curve, H in zip(problem.curves, result.answer.curves)]
    between = [curve.at(np.isnan(curve.H)) for curve in fine]
    (answer,) = model.with_curves(between).answers([problem.settings.parameters(result.x)])
    if stop.is_set():
        raise Interrupted("interrupted; the same command goes on after the search")
    for curve, H in zip(fine, answer.curves):
        curve.H[np.isnan(curve.H)] = H
    return fine


def _write_set(fmu: Fmu, problem: Problem, result: Fit, defaults: dict[str, Value], path: Path) -> Path:
    settings = problem.settings
    values = {**defaults, **settings.parameters(result.x)}
    if settings.model == "linear":
        names = ["suspension", *LINEAR_PARAMETERS]
    else:
        names = [name for name in values if not name.startswith(OTHER_PARAMETERS) and name != "k1"]
    remarks = {
        name: "identified, at its bound"
        if result.at_bound[i]
        else f"identified, standard error {result.standard_error[i]:.2g}"
        for i, name in enumerate(settings.free)
    }
    remarks |= {name: f"tied to {tie.to}" for name, tie in settings.tied.items()}
    files = ", ".join(source.path.name for source in settings.sources)
    date = datetime.now(timezone.utc).strftime("%Y-%m-%d")
    description = f"Identified from {files} on {date}, {settings.model} model{_preload(fmu, values, settings)}"
    description += f"; see {path.parent.name}/identify.log"
    write_set(path, fmu, {name: values[name] for name in names}, path.stem, description, remarks)
    return path


def _preload(fmu: Fmu, values: Mapping[str, Value], settings: Settings) -> str:
    """The bench's static force, which the set leaves to the line; the linear model depends on none."""
    if settings.model == "linear":
        return ""
    return f", at a static force of {with_unit(fmu.variables['static_force'], values['static_force'])}"


def _write_points(fmu: Fmu, problem: Problem, result: Fit, path: Path) -> Path:
    settings = problem.settings
    own = {**_head(fmu, settings), "H": FrfSettings().described()["H"]}
    columns = ["frequency [Hz]", "amplitude [m/s2]"]
    columns += [f"{kind}_{part} [m/N]" for kind in ("measured", "fitted") for part in ("re", "im")]
    columns += ["magnitude_error [%]", "phase_error [deg]"]
    rows: list[tuple[float, ...]] = []
    for curve, H in zip(problem.curves, result.answer.curves):
        errors = 100 * report.magnitude_error(curve, H), report.phase_error(curve, H)
        rows += zip(curve.frequency, curve.acceleration, curve.H.real, curve.H.imag, H.real, H.imag, *errors)
    return write_table(path, file_head(fmu, settings.parameters(result.x), own), columns, rows, digits=None)


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
