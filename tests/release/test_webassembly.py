"""The FMUs as WebAssembly modules, run in node by the package's JavaScript: they answer as the libraries do."""

from __future__ import annotations

import threading
from functools import partial
from itertools import islice

import numpy as np
import pytest

import node_jobs
from client_runs import RUNS, Run
from models import MODELS
from zspring.bench.fmu_bench import FmuBench
from zspring.bench.loops import measure_loop
from zspring.bench.measure import measure
from zspring.bench.points import FrfSettings, sweeps
from zspring.bench.slip import STATES, Raising, raise_amplitude
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.system import System


@pytest.fixture(scope="module")
def node(fmus):
    return partial(node_jobs.answer, fmus=fmus)


def test_the_standard_figure(node):
    """All 465 points: the same periods, steps and Newton iterations, and H to 1e-12."""
    settings = FrfSettings(parameters={"solver.step": 5e-4})
    with Fmu() as fmu:
        native = [point for point, _ in measure(fmu, settings, sweeps(settings), 2, threading.Event())]
    given = {name: getattr(settings, name) for name in ("amplitudes", "frequencies", "parameters")}
    points = {(p["acceleration"], p["frequency"]): p for p in node("figure", **given)}
    assert len(native) == len(points) == 465
    for expected in native:
        point = points[expected.place]
        for name in ("status", "periods", "steps", "iterations", "refinements"):
            assert point[name] == getattr(expected, name), (expected.place, name)
        assert abs(complex(*point["H"]) / expected.H - 1) < 1e-12
        assert point["loss"] == pytest.approx(expected.loss, rel=1e-9)
        assert point["harmonics"] == pytest.approx(expected.harmonics, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_runs_that_other_tools_make_as_well(node, run: Run):
    inputs = {"names": list(run.inputs), "rows": np.column_stack(list(run.inputs.values())).tolist()}
    given = {"parameters": dict(run.parameters), "step": run.step, "outputs": list(run.outputs)}
    run.check(np.array(node("run", model=run.model, inputs=inputs, **given)))


def test_refusals_are_those_of_the_library(node):
    """They are exceptions inside, which a module that is linked wrongly does not catch."""
    below, item, name, running, fine = node("refusals")
    assert below[0] == item[0] == name[0] == running[0] == "refused" and fine is None
    assert "m1" in below[1] and "-1" in below[1] and "0.001" in below[1]
    assert item[1] == "friction = Sticky: must be one of Regularized, Coulomb, Locked, Free"
    assert "no.such" in name[1] and "m1" in running[1]


def test_a_discarded_step_leaves_the_state_as_it_was(node, fmus):
    cases = {}
    for model in MODELS:
        parameters, force = model.discarded
        outputs = [v.name for v in fmus[model.name].variables.values() if v.causality == "output"]
        cases[model.name] = {"parameters": parameters, "input": model.force, "force": force, "outputs": outputs}
    for name, told in node("discarded", cases=cases).items():
        assert told["told"][0] == "discarded" and "The state is that of 0.002 s" in told["told"][1], name
        assert told["before"] == told["after"] and told["then"] is None


def test_a_restored_state_replays_to_the_bit(node, fmu):
    outputs = [v.name for v in fmu.variables.values() if v.causality == "output"]
    first, again = node("replay", outputs=outputs)
    assert first == again and np.ptp(first) > 0


def test_20000_instances_leave_nothing(node):
    parameters = {model.name: model.smallest for model in MODELS}
    for name, sizes in node("instances", counts=[200, 9800, 10000], parameters=parameters).items():
        assert sizes[0] == sizes[1] == sizes[2], name


def test_the_coupled_force(node):
    """That of `zspring couple` as it is by default, to 1e-6 N."""
    line = {"line.spans": 4}
    start = {"suspension": "ZSpring", "friction": "Coulomb", "contact.c": 20.0, "solver.step": 5e-4}
    with Fmu() as pantograph, Fmu(installed_fmu(CATENARY)) as catenary:
        head = {**start, "suspension": 1, "friction": 2}
        result = run_line(System(catenary, pantograph, line, [head], Journey(250 / 3.6, uplift=20.0)))
        span = catenary.variables["line.span"].start
    forces = result.contact_force[:, 0]
    given = {"line": line, "pantograph": start, "speed": 250 / 3.6, "step": 1e-3, "uplift": 20.0}
    given |= {"start": float(span) / 2, "runUp": float(span)}
    told = np.array(node("line", run=given, rows=len(forces)))
    assert np.ptp(told) > 20
    assert np.abs(told - forces).max() < 1e-6


def test_a_static_loop(node):
    told = node("loop", parameters={"friction": "Coulomb"}, amplitude=2e-3, rate=1e-3)
    with Fmu() as fmu, fmu.instances() as (instance,):
        loop = measure_loop(instance, {}, "Coulomb", 1e-3, 2e-3)
    np.testing.assert_allclose(told["compression"], loop.compression, rtol=0, atol=1e-12)
    np.testing.assert_allclose(told["force"], loop.force, rtol=0, atol=1e-6)


def test_stick_and_slip_at_one_frequency(node):
    amplitudes = (0.05, 0.4, 3.2, 6.4)
    settings = FrfSettings(amplitudes, (4.0,))
    with Fmu() as fmu, fmu.instances() as (instance,):
        kept = raise_amplitude(FmuBench(instance, {}), Raising(4.0, amplitudes), settings, threading.Event())
        expected = {point.amplitude: point.state for point, _ in islice(kept, len(amplitudes))}
    told = node("slip", frequency=4.0, amplitudes=amplitudes)
    assert {point["amplitude"]: point["state"] for point in told} == expected
    assert set(expected.values()) == set(STATES)
