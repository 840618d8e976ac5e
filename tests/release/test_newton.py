"""The Newton study: the iteration done again is the FMU's, and what it shows of the tangents."""

from __future__ import annotations

import numpy as np
import pytest

from commands import PNG, table, zspring
from zspring.bench.fixed_work import run_points
from zspring.fmu import Fmu
from zspring_research.newton.accuracy import accuracy, coulomb_reference
from zspring_research.newton.iteration import Step
from zspring_research.newton.jump import COUNT, iterations_of, jumping_steps
from zspring_research.newton.recorded import record
from zspring_research.newton.work import tangent_work

BENCH = (5.0, 1.0)  # Hz, m/s2: the rods stick and slip in every period
POINTS = [(a, f) for a in (0.5, 2.0, 8.0) for f in (3.0, 5.0, 9.0, 14.0)]


@pytest.fixture(scope="module")
def instance():
    with Fmu() as fmu, fmu.instances() as (instance,):
        yield instance


@pytest.mark.parametrize(
    "settings",
    [{}, {"zspring.tau": 1e5}, {"zspring.L1": 0.05, "zspring.L2": 0.09, "zspring.J2": 3e-4}, {"solver.alpha": -0.1}],
)
def test_the_iteration_done_again_ends_in_the_state_that_the_fmu_reached(instance, settings):
    """In every step of a period. Newton's own tolerance is 1e-12 of the load on a rod, 300 N times 0.1 m.

    Over the smallest J / (beta h^2), 200 N.m/rad, that is 2e-13 rad; the recorded accelerations, from
    positions exact to 1e-16, add 1e-16 / (hht_alpha^2 / 4), 4e-14 rad.
    """
    recording = record(instance, {**settings, "solver.tolerance": 1e-12}, *BENCH)
    indices = range(1, len(recording.time) - 1)
    ends = np.array([Step(recording, index).iterate("Resolvent", 6).q for index in indices])
    np.testing.assert_allclose(ends, recording.q[2:], rtol=0, atol=1e-12)


def test_the_exact_tangent_jumps_between_two_states_on_both_sides_of_the_solution(instance):
    recording = record(instance, {}, *BENCH)
    jumping = jumping_steps(recording)
    assert jumping
    for index in jumping:
        iterations = iterations_of(recording, index)
        solution = iterations["Resolvent"]
        rates = iterations["Exact"].rates[-4:, 0]
        assert rates[0] == pytest.approx(rates[2], rel=1e-8) and rates[1] == pytest.approx(rates[3], rel=1e-8)
        assert min(rates) < solution.rates[-1, 0] < max(rates)
        assert iterations["Exact"].unbalance[-1] > 1e-3
        assert np.all(solution.unbalance[4:] < 1e-10)
        # The mean's error falls in all steps, though slowly.
        assert iterations["Mean"].unbalance[COUNT] < 0.1 * iterations["Mean"].unbalance[1]


def test_the_fmu_with_the_exact_tangent_first_halves_the_step_that_jumps(instance):
    """Both from rest: until then every tangent has led to the same states."""
    frequency, acceleration = BENCH
    recording = record(instance, {}, frequency, acceleration, settling_periods=0)
    assert recording.time[-1] == pytest.approx(1 / frequency)
    first = jumping_steps(recording)[0]
    bench = {"bench.frequency": frequency, "bench.acceleration": acceleration}
    settings = instance.variables.parse_assignments(["drive=Bench", "solver.tangent=Exact"])
    instance.start({**settings, **bench})
    step = recording.step
    # Sample i of the recording is the state after step i + 1, so that the step from it is number i + 2.
    for number in range(first + 2):
        assert instance.get(["solver.refinements"]) == [0]
        instance.step(number * step, step)
    assert instance.get(["solver.refinements"])[0] > 0


def test_the_balance_of_the_rest_meets_the_friction_law_in_the_solution(instance):
    recording = record(instance, {}, *BENCH)
    index = jumping_steps(recording)[0]
    solution = iterations_of(recording, index)["Resolvent"].rates[-1]
    needed = Step(recording, index).balance(solution, solution[:1])
    assert needed[0] == pytest.approx(np.tanh(recording.parameters["zspring.tau"] * solution[0]), abs=1e-9)


@pytest.mark.parametrize("tau", [10.0, 1e3, 1e6])
def test_only_the_resolvent_needs_no_more_iterations_however_steep_the_law_is(instance, tau):
    work = {
        tangent: tangent_work(instance, {"solver.max_iterations": 100}, "Regularized", tangent, tau, POINTS)
        for tangent in ("Resolvent", "Mean", "Secant", "Exact")
    }
    for part in work["Resolvent"]:
        assert part.iterations_per_step < 2.5 and part.iterations_max <= 4 and part.halvings == part.discards == 0
    assert sum(part.discards for parts in work.values() for part in parts) == 0
    if tau >= 1e3:
        for tangent in ("Mean", "Secant"):
            assert all(part.iterations_per_step > 5 for part in work[tangent])
        assert all(part.halved_percent > 1 for part in work["Exact"])


def test_the_error_of_the_regularised_law_falls_with_tau_and_is_small_at_1000_s(instance):
    """First order in 1/tau, as creep and the width of the transition are; at a step that resolves it."""
    fine = {"solver.step": 5e-4}
    reference = coulomb_reference(instance, fine, POINTS, *BENCH)
    errors = {tau: accuracy(instance, fine, POINTS, *BENCH, tau, reference) for tau in (100.0, 1000.0, 10000.0)}
    for error in ("H_median", "contact_force", "head_position"):
        coarse, standard, steep = (getattr(errors[tau], error) for tau in errors)
        assert 4 < coarse / standard < 25 and 4 < standard / steep < 25
    standard = errors[1000.0]
    assert standard.H_median < 2e-3 and standard.contact_force < 1e-2 and standard.head_position < 1e-2


def test_a_discarded_point_is_counted_and_the_next_one_is_run(instance):
    """One iteration a step is too few for any step."""
    points = [(8.0, 5.0), (4.0, 5.0)]
    hopeless = {"solver.max_iterations": 1, "solver.tolerance": 1e-13}
    assert list(run_points(instance, hopeless, points).discarded) == [True, True]
    assert list(run_points(instance, {}, points).discarded) == [False, False]


def test_the_command_writes_its_files(tmp_path):
    arguments = ["newton", "--amplitudes", "1,4", "--frequencies", "4:12:4", "--taus", "100,1e4", "--output", "out"]
    out, _ = zspring(tmp_path, *arguments, "--tau-stride", "2")
    assert "the exact tangent jumps for ever in" in out and "error against the Coulomb law" in out
    works = table(tmp_path / "out/newton.csv")
    assert len(works) == 5 * 2 + 4 * 2
    assert {row["amplitude [m/s2]"] for row in works} == {"1", "4", "all"}
    assert [float(row["tau [s]"]) for row in table(tmp_path / "out/accuracy.csv")] == [100, 1e4]
    assert {row["tangent"] for row in table(tmp_path / "out/jump.csv")} == {"Resolvent", "Mean", "Secant", "Exact"}
    for name in ("jump.png", "newton.png"):
        assert (tmp_path / "out" / name).read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["--bench-acceleration", "0.01"], ["0.01 m/s2", "jump"]),
        (["--bench-frequency", "0"], ["bench.frequency", "0"]),
        (["--set", "zspring.Mf=0"], ["zspring.Mf", "0"]),
        (["--set", "solver.alpha=0"], ["solver.alpha", "0"]),
        (["--set", "solver.tangent=Mean"], ["solver.tangent", "sets"]),
        (["--amplitudes", "1000", "--frequencies", "0.5"], ["stroke"]),
    ],
)
def test_bad_settings_get_one_clear_line(tmp_path, arguments, named):
    _, err = zspring(tmp_path, "newton", *arguments, status=1)
    lines = [line for line in err.splitlines() if line.startswith("zspring: ")]
    assert len(lines) == 1 and all(word in lines[0] for word in named), err
