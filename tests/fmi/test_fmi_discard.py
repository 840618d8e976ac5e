"""A step that cannot be solved: fmi2Discard, the state as before it, and the last good time."""

from __future__ import annotations

import subprocess
import sys

import pytest
from fmpy.fmi2 import fmi2Discard, fmi2LastSuccessfulTime, fmi2Terminated

from harness import Instance, refusal
from models import MODELS, Model

PANTOGRAPH, CATENARY = MODELS


def discarded(instance, model: Model) -> tuple[Instance, dict, int]:
    """An instance whose last step of 0.1 s was discarded, its values before that, and the status."""
    parameters, force = model.discarded
    p = instance(parameters)
    p.step(0.002)
    values = p.all_values()
    p[model.force] = force
    p.log.clear()
    return p, values | {model.force: force}, refusal(p.slave.doStep, p.time, 0.1)


def test_an_unsolvable_step_is_discarded_and_leaves_the_state_as_it_was(model, instance):
    p, before, status = discarded(instance, model)
    assert status == fmi2Discard
    assert p.all_values() == before


def test_the_last_successful_time_is_that_before_the_step(model, instance):
    p, _, _ = discarded(instance, model)
    assert p.slave.getRealStatus(fmi2LastSuccessfulTime) == 0.002


def test_the_fmu_asks_for_the_end_where_the_line_ends_or_where_a_step_is_repeated_in_vain(model, instance):
    """fmpy repeats a discarded step until it does; a host that shortens the step is not asked."""
    p, _, _ = discarded(instance, model)
    assert p.slave.getBooleanStatus(fmi2Terminated) is (model is CATENARY)  # whose pantograph leaves the line
    assert refusal(p.slave.doStep, p.time, 0.09) == fmi2Discard
    assert p.slave.getBooleanStatus(fmi2Terminated) is (model is CATENARY)
    assert refusal(p.slave.doStep, p.time, 0.09) == fmi2Discard
    assert p.slave.getBooleanStatus(fmi2Terminated) is True
    p[model.force] = 100.0
    p.step(0.001)
    assert p.slave.getBooleanStatus(fmi2Terminated) is False


def test_fmpy_ends_at_the_end_of_the_line(fmu_catenary):
    """In a process of its own: fmpy knows one logger, and that of instances before is gone."""
    script = f"""
from fmpy import simulate_fmu
start = {{"line.spans": 2, "pantograph[1].start": 90, "pantograph[1].speed": 50, "pantograph[1].force": 120}}
result = simulate_fmu({str(fmu_catenary.path)!r}, stop_time=2, output_interval=0.01, start_values=start,
                      output=["pantograph[1].x"])
print(result["time"][-1], result["pantograph[1].x"][-1])
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert [float(x) for x in done.stdout.splitlines()[-1].split()] == pytest.approx([0.6, 120.0])


def test_the_reason_is_logged_once(model, instance):
    p, _, _ = discarded(instance, model)
    lines = [m for m in p.log if m.category == "logStatusDiscard"]
    assert len(lines) == 1 and lines[0].status == fmi2Discard
    assert "t = 0.0" in lines[0].text and "The state is that of 0.002 s" in lines[0].text


def test_newtons_method_tells_where_it_failed(pantograph):
    """Degree of freedom, residual, iterations."""
    p, _, _ = discarded(pantograph, PANTOGRAPH)
    text = p.log[-1].text
    assert "iteration" in text and "unbalanced" in text
    assert any(name in text for name in ("head", "alpha", "beta", "upper frame", "lower frame"))


def test_a_line_that_is_left_is_told_with_its_end(catenary):
    p, _, _ = discarded(catenary, CATENARY)
    assert "pantograph[1].x = 60." in p.log[-1].text and "0 to 60 m" in p.log[-1].text


def test_a_discarded_step_can_be_left_by_restoring_a_state_by_reset_or_by_terminate(model, instance):
    parameters, force = model.discarded
    p, _, _ = discarded(instance, model)
    p.reset()
    p.initialize()
    p.step(0.01)
    q = instance(parameters)
    q.step(0.002)
    state, values = q.slave.getFMUstate(), q.all_values()
    q[model.force] = force
    assert refusal(q.slave.doStep, 0.002, 0.1) == fmi2Discard
    q.slave.setFMUstate(state)
    assert q.all_values() == values
    q.slave.freeFMUstate(state)
    r, _, _ = discarded(instance, model)
    r.slave.terminate()


def test_a_discarded_step_leaves_no_trace_in_what_follows(model, instance):
    """Undone, with the force as it was, it goes on bit for bit like an instance that never tried."""
    parameters, force = model.discarded
    p, untouched = instance(parameters), instance(parameters)
    for q in (p, untouched):
        q.step(0.002)
    state = p.slave.getFMUstate()
    p[model.force] = force
    assert refusal(p.slave.doStep, 0.002, 0.1) == fmi2Discard
    p.slave.setFMUstate(state)
    p.slave.freeFMUstate(state)
    for q in (p, untouched):
        q.step(0.01)
    assert p.all_values() == untouched.all_values()


@pytest.mark.parametrize("tangent", ["Mean", "Secant", "Exact"])
def test_a_difficult_step_is_halved_and_counted(pantograph, tangent):
    """Few iterations allowed, but enough for shorter steps."""
    few = {"solver.tangent": tangent, "solver.max_iterations": 12, "bench.acceleration": 2.0}
    p = pantograph(few | {"drive": "Bench"}, categories=["logSolver"])
    p.step(0.5)
    assert p["solver.refinements"] > 0
    assert p["solver.steps"] == 250 + p["solver.refinements"]
    assert p["solver.iterations_max"] == 12
    assert [m.category for m in p.log] == ["logSolver"]


@pytest.mark.parametrize("tangent", ["Resolvent", "Mean", "Secant", "Exact"])
def test_every_tangent_leads_to_the_same_motion(pantograph, tangent):
    def motion(parameters: dict) -> list[float]:
        p = pantograph(
            {"drive": "Displacement", "zspring.tau": 50.0, "solver.tolerance": 1e-10, "solver.max_iterations": 200}
            | parameters
        )
        for n in range(200):
            p["head_displacement"] = 0.01 * (1 - (1 - min(1, n / 100) ** 2) ** 2)
            p.step(0.002)
        return list(p.reals(["contact.force", "zspring.alpha", "lower_frame.z"]))

    assert motion({"solver.tangent": tangent}) == pytest.approx(motion({}), rel=1e-6)
