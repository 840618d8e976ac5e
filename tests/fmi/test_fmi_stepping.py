"""Communication steps of any size, start times, rounding of time, and what inputs do within a step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy.fmi2 import fmi2LastSuccessfulTime

from models import each_case, each_case_but

OUTPUTS = ["head.z", "head.v", "contact.force", "upper_frame.z", "lower_frame.z", "zspring.alpha"]
SMOOTH = {"zspring.tau": 3.0, "c1": 20.0, "solver.step": 5e-4}


@pytest.mark.parametrize("step", [1e-7, 1e-4, 5e-4, math.pi / 1000, 0.01234, 0.5, 1.0])
def test_the_size_of_the_communication_step_does_not_shape_the_motion(pantograph, step):
    """A held force: the same motion at the same time whatever the steps, within the integrator's error."""

    def until(end: float, size: float) -> np.ndarray:
        p = pantograph(SMOOTH)
        p["contact_force"] = 135.0
        while p.time < end - 1e-12:
            p.step(min(size, end - p.time))
        return p.reals(OUTPUTS)

    end = 1.0 if step > 1e-6 else 2e-4
    expected = until(end, 5e-4 if step > 1e-6 else 1e-4)
    np.testing.assert_allclose(until(end, step), expected, rtol=2e-3, atol=2e-7)


@pytest.mark.parametrize("suspension", ["ZSpring", "Linear"])
@pytest.mark.parametrize("drive, name", [("Displacement", "head_displacement"), ("Wire", "wire_height")])
@pytest.mark.parametrize("derivatives", [(), (0.0, 0.0)])
def test_communication_steps_of_wild_sizes_stay_stable(pantograph, drive, name, suspension, derivatives):
    """Sizes over 2.5 decades, in random order; positions that a finite speed of 2 m/s can reach."""
    rng = np.random.default_rng(5)
    p = pantograph({"drive": drive, "suspension": suspension, "contact.k": 5e3})
    for _ in range(300):
        size = 10 ** rng.uniform(-3, -0.5)
        p[name] = float(np.clip(p[name] + rng.uniform(-2, 2) * size, -0.005, 0.005))
        if derivatives:
            p.set_derivatives(name, *derivatives)
        p.step(size)
        assert abs(p["head.v"]) < 20 and abs(p["contact.force"]) < 1e5


def test_one_huge_step_is_taken(pantograph):
    p = pantograph()
    p["contact_force"] = 119.0
    p.step(1000.0)
    assert p["solver.steps"] == 500_000
    assert p["lower_frame.z"] > 1


@each_case_but("Bench")  # which has its own grid, see test_bench.py
def test_a_communication_step_is_cut_into_equal_internal_steps(any_fmu, instance, case):
    """n = ceil(H / solver.step), and rounding adds none."""
    largest = any_fmu.start("solver.step")
    for steps, expected in ((1, 1), (50, 50), (1.5, 2), (0.95, 1), (150, 150), (5e-4, 1), (350, 350)):
        p = instance(case.parameters)
        p.step(steps * largest)
        assert p["solver.steps"] == expected, steps


@each_case_but("Bench")
def test_drift_of_time_in_the_last_bit_is_tolerated(model, instance, case):
    """Hosts add up steps or multiply them; either way, and with a bit too much or too little."""
    size, count = 0.01, 100
    added, multiplied = instance(case.parameters), instance(case.parameters)
    time = 0.0
    for n in range(count):
        for p in (added, multiplied):
            for name, signal in case.inputs.items():
                p[name] = signal(n * size)
        added.slave.doStep(time, size)
        multiplied.slave.doStep(n * size, (n + 1) * size - n * size)
        time += size
    assert time != count * size
    names = [model.moved, "energy.work", "energy.elastic"]
    np.testing.assert_allclose(added.reals(names), multiplied.reals(names), rtol=1e-6)
    steps = added["solver.steps"]
    added.slave.doStep(np.nextafter(time, 0), size)
    assert steps == multiplied["solver.steps"] == count / (count + 1) * added["solver.steps"]


@pytest.mark.parametrize("start", [100.0, -5.0, 1e6])
@each_case
def test_the_start_time_shifts_time_only(instance, case, start):
    early = instance(case.parameters)
    late = instance(case.parameters, start_time=start)
    for n in range(200):
        for p in (early, late):
            for name, signal in case.inputs.items():
                p[name] = signal(n * 2**-8)
        early.slave.doStep(n * 2**-8, 2**-8)
        late.slave.doStep(start + n * 2**-8, 2**-8)
    assert early.all_values() == late.all_values()
    assert late.slave.getRealStatus(fmi2LastSuccessfulTime) == start + 200 * 2**-8


@pytest.mark.parametrize(
    "drive, name, begin, rates",
    [
        ("Force", "contact_force", 120.0, (40.0, 0.0)),
        ("Force", "contact_force", 120.0, (30.0, -50.0)),
        ("Force", "uplift.lower_frame", 0.0, (30.0, -50.0)),
        ("Displacement", "head_displacement", 0.0, (0.0, 0.03)),
        ("Wire", "wire_height", 0.0, (0.0, 0.02)),
        ("Displacement", "uplift.upper_frame", 0.0, (30.0, 60.0)),
    ],
)
def test_an_input_with_derivatives_is_the_same_in_one_step_and_in_many(pantograph, drive, name, begin, rates):
    """The parabola, set once for a long step or anew at each of many short ones on the same internal grid."""
    parameters = SMOOTH | {"drive": drive, "solver.step": 2**-11}
    size, count = 2**-9, 256
    one = pantograph(parameters)
    one[name] = begin
    one.set_derivatives(name, *rates)
    one.step(size * count)
    many = pantograph(parameters)
    for n in range(count):
        t = n * size
        many[name] = begin + rates[0] * t + rates[1] * t**2 / 2
        many.set_derivatives(name, rates[0] + rates[1] * t, rates[1])
        many.step(size)
    np.testing.assert_allclose(one.reals(OUTPUTS), many.reals(OUTPUTS), rtol=1e-6, atol=1e-9)


def test_a_held_force_equals_derivatives_of_zero(pantograph):
    p, q = pantograph(), pantograph()
    for n in range(20):
        p["contact_force"] = q["contact_force"] = 120.0 + n
        q.set_derivatives("contact_force", 0.0, 0.0)
        p.step(0.01)
        q.step(0.01)
    assert p.all_values() == q.all_values()


@pytest.mark.parametrize("drive, name", [("Displacement", "head_displacement"), ("Wire", "wire_height")])
def test_a_position_is_a_target_reached_in_a_straight_line(pantograph, drive, name):
    """One long step equals short steps along the line; the target is reached at the end, without a jump."""
    parameters = {"drive": drive, "solver.step": 2**-10, "zspring.tau": 3.0}
    size, count, target = 2**-6, 32, 0.004
    line, many = pantograph(parameters), pantograph(parameters)
    line[name] = target
    line.step(size * count)
    for n in range(count):
        many[name] = target * (n + 1) / count
        many.step(size)
    positions = ["head.z", "upper_frame.z", "lower_frame.z", "zspring.alpha"]
    np.testing.assert_allclose(line.reals(positions), many.reals(positions), rtol=1e-6, atol=1e-9)
    if drive == "Displacement":
        assert line["head.z"] == pytest.approx(target, abs=1e-15)


def test_a_target_that_stays_is_held(pantograph):
    p = pantograph({"drive": "Displacement"})
    p["head_displacement"] = 0.003
    p.step(0.1)
    history = p.run(0.01, 50, ["head.z"])
    np.testing.assert_allclose(history, 0.003, atol=1e-15)


def test_a_gap_between_a_position_with_derivatives_and_where_it_was_is_closed_without_a_jump(pantograph):
    p = pantograph({"drive": "Displacement", "solver.step": 1e-3})
    p["head_displacement"] = 0.002  # but the head is at 0
    p.set_derivatives("head_displacement", 0.01)
    state = p.slave.getFMUstate()
    heights = []
    for size in (0.001, 0.025, 0.05, 0.1):
        p.slave.setFMUstate(state)
        p.slave.doStep(0.0, size)
        heights.append(p["head.z"])
    p.slave.freeFMUstate(state)
    # At the end of whatever step the gap is closed: the value plus the ramp since.
    np.testing.assert_allclose(heights, [0.002 + 0.01 * size for size in (0.001, 0.025, 0.05, 0.1)], atol=1e-15)


@each_case
def test_the_tolerance_of_the_experiment_changes_nothing(instance, case):
    """Some hosts always define one, as large as 0.1; the solvers have their own."""
    plain, loose = instance(case.parameters), instance(case.parameters, initialize=False)
    loose.slave.setupExperiment(tolerance=0.1)
    loose.slave.enterInitializationMode()
    loose.slave.exitInitializationMode()
    for p in (plain, loose):
        p.run(0.005, 100, [], signals=case.inputs)
    assert plain.all_values() == loose.all_values()


@each_case
def test_promising_not_to_go_back_changes_nothing(instance, case):
    p, q = instance(case.parameters), instance(case.parameters)
    for n in range(50):
        for name, signal in case.inputs.items():
            p[name] = q[name] = signal(n * 2**-7)
        p.slave.doStep(n * 2**-7, 2**-7, True)
        q.slave.doStep(n * 2**-7, 2**-7, False)
    assert p.all_values() == q.all_values()


@each_case
def test_inputs_set_before_the_experiment_count(instance, case):
    """And as much as in Initialization Mode, where the standard wants them."""
    inputs = {name: signal(0.1) for name, signal in case.inputs.items()}
    early = instance({**case.parameters, **inputs}, initialize=False)
    early.initialize()
    late = instance(case.parameters, initialize=False)
    late.slave.setupExperiment()
    late.slave.enterInitializationMode()
    late.all_values()  # as hosts do that log all of them from the first
    late.set(inputs)
    late.slave.exitInitializationMode()
    assert early.all_values() == late.all_values()
    for p in (early, late):
        p.run(0.01, 20, [])
    assert early.all_values() == late.all_values()


@each_case
def test_reading_all_variables_after_every_step_changes_nothing(instance, case):
    read, plain = instance(case.parameters), instance(case.parameters)
    for _ in range(30):
        for p in (read, plain):
            p.run(0.007, 1, [], signals=case.inputs)
        read.all_values()
    assert read.all_values() == plain.all_values()


def test_inputs_of_other_drives_do_not_matter(pantograph):
    p, q = pantograph(), pantograph()
    q.set({"head_displacement": 0.01, "wire_height": -0.2, "bench.frequency": 9.0})
    for r in (p, q):
        r["contact_force"] = 130.0
        r.step(0.5)
    np.testing.assert_array_equal(p.reals(OUTPUTS), q.reals(OUTPUTS))
