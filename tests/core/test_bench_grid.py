"""The bench's grid of steps has one rule, and whoever imposes the sine from outside asks the FMU for it."""

from __future__ import annotations

import pytest

from zspring.bench.input_bench import InputBench
from zspring.fmu import Fmu
from zspring_research.newton.recorded import record

ON_THE_EDGE = 7.1428571428  # Hz: 70.0000000006 steps of 2 ms


@pytest.fixture(scope="module")
def instance():
    with Fmu() as fmu, fmu.instances() as (instance,):
        yield instance


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire", "Bench"])
@pytest.mark.parametrize("frequency, count", [(5.0, 100), (3.3, 152), (ON_THE_EDGE, 70), (200.0, 16)])
def test_the_steps_of_a_period_are_told_from_initialization_on(pantograph, drive, frequency, count):
    p = pantograph({"drive": drive, "bench.frequency": frequency}, initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    assert p["bench.steps_per_period"] == count
    p.slave.exitInitializationMode()
    p["bench.frequency"] = 2.5  # tunable: told at once
    assert p["bench.steps_per_period"] == 200
    p.step(0.01)
    assert p["bench.steps_per_period"] == 200


@pytest.mark.parametrize("frequency", [ON_THE_EDGE, 3.3, 5.0])
def test_the_bench_makes_as_many_steps_as_it_tells(pantograph, frequency):
    p = pantograph({"drive": "Bench", "bench.frequency": frequency})
    p.step(2 / frequency)
    before = p["solver.steps"]
    p.step(5 / frequency)
    assert p["solver.steps"] - before == 5 * p["bench.steps_per_period"]


def test_the_bench_outside_has_the_grid_of_the_one_inside(instance):
    parameters = {"static_force": 120.0}
    outside = InputBench(instance, parameters)
    outside.start(ON_THE_EDGE, 1.0)
    outside.run(1)  # the ramp
    (before,) = instance.get(["solver.steps"])
    outside.run(1)
    (after,) = instance.get(["solver.steps"])
    assert after - before == 70


def test_a_recording_has_the_grid_of_the_bench(instance):
    recording = record(instance, {}, ON_THE_EDGE, 1.0, settling_periods=2)
    assert len(recording.time) == 71
    assert recording.step == pytest.approx(1 / (70 * ON_THE_EDGE), rel=1e-15)
    # On the grid each communication step is one internal one: none is cut in two.
    (steps,) = instance.get(["solver.steps"])
    assert steps == (2 + 1) * 70 + 1
