"""The peers of `zspring integrators`: right-hand side, orders, agreement with each other and with the FMU."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import zspring.fmu
from harness import fitted_order
from reference import ALPHA, BETA, U1, Reference
from zspring.errors import ZSpringError
from zspring.records import Record
from zspring.tables import read_rows
from zspring_research.integrators.command import integrators
from zspring_research.integrators.measure import COLUMNS, STABILITY, Laboratory, Result, Variant, from_row, to_row
from zspring_research.integrators.model import UPPER_FRAME, bench_model, contact_force, dynamics, head_motion
from zspring_research.integrators.peers import ADAPTIVE, rk4, solve
from zspring_research.integrators.problem import Problem
from zspring_research.integrators.report import cheapest
from zspring_research.integrators.run import Run, _measure, runs_of

FREQUENCY, ACCELERATION = 5.0, 1.0


@pytest.fixture(scope="module")
def installed():
    with zspring.fmu.Fmu() as fmu, fmu.instances() as (instance,):
        yield instance


@pytest.fixture(scope="module")
def parameters(installed):
    """Of the FMU as it starts, calculated ones included."""
    installed.start({})
    names = installed.variables.names("parameter", "calculatedParameter")
    return dict(zip(names, installed.get(names)))


@pytest.fixture(scope="module")
def gentle(parameters):
    """A problem without steep friction, so that the methods show their orders at steps of a millisecond."""
    return bench_model({**parameters, "zspring.tau": 1.0}, FREQUENCY, ACCELERATION)


def test_right_hand_side_is_that_of_the_energy(fmu, parameters):
    """Against the independent model, whose forces are the complex-step gradient of its energy."""
    damped = {"c1": 5.0, "c2": 20.0, "zspring.J2": 4e-4}
    reference = Reference(fmu, {**damped, "drive": "Displacement", "suspension": "ZSpring", "friction": "Regularized"})
    p = bench_model({**parameters, **damped}, FREQUENCY, ACCELERATION)
    random = np.random.default_rng(1)
    for t in random.uniform(0, 2 / FREQUENCY, 20):
        y = random.normal(size=8) * np.repeat([0.05, 0.02, 0.003, 0.3], 2)
        u1, v1, a1 = head_motion(t, p[0])
        q, v = np.array([u1, *y[:4]]), np.array([v1, *y[4:]])
        q[[ALPHA, BETA]] += reference.theta
        force = reference.unbalanced(t, q, v, {})
        dy = np.empty(8)
        contact = dynamics(dy, t, y, p[0])
        assert contact == pytest.approx(force[U1] - reference.mass[U1] * a1, rel=1e-9, abs=1e-8)
        np.testing.assert_array_equal(dy[:4], y[4:])
        # Forces of some 100 N balance in the static state: 1e-9 of that remains of rounding.
        np.testing.assert_allclose(dy[4:] * reference.mass[1:], force[1:], rtol=1e-9, atol=1e-8)


def test_head_motion_is_differentiable_twice(parameters):
    """Central differences of step 1e-5 s: an error of f''' h^2 / 6, some 1e-7 of the acceleration's peak."""
    p = bench_model(parameters, FREQUENCY, ACCELERATION)[0]
    h = 1e-5
    for t in np.linspace(0.01, 0.39, 20):
        before, now, after = (head_motion(t + d, p) for d in (-h, 0, h))
        assert (after[0] - before[0]) / (2 * h) == pytest.approx(now[1], abs=1e-8)
        assert (after[1] - before[1]) / (2 * h) == pytest.approx(now[2], abs=1e-6)


def test_energy_is_balanced(fmu, parameters):
    """Work of the contact force = kinetic + elastic energy + what dampers and joints dissipated, over a run.

    Integrals by the trapezoidal rule on 20000 intervals, an error of some 1e-6; the solver's is 1e-9.
    """
    reference = Reference(fmu, {"drive": "Displacement", "suspension": "ZSpring", "friction": "Regularized"})
    model = bench_model(parameters, FREQUENCY, 4.0)
    t = np.linspace(0, 3 / FREQUENCY, 20001)
    y = np.vstack([np.zeros(8), solve("Radau", model, t[1:], 1e-9, 0.01).states])
    head = np.array([head_motion(time, model[0]) for time in t])
    q = np.column_stack([head[:, 0], y[:, :4]])
    q[:, [ALPHA, BETA]] += reference.theta
    v = np.column_stack([head[:, 1], y[:, 4:]])

    energy = 0.5 * v**2 @ reference.mass + reference.energy(q.T) - reference.energy(reference.static)
    friction = parameters["zspring.Mf"] * np.tanh(parameters["zspring.tau"] * v[:, 1:3])
    dissipated = (friction * v[:, 1:3]).sum(axis=1) + parameters["c3"] * v[:, 4] ** 2
    # The constant preload, which the static gradient is, works too.
    work = v @ reference.static_gradient - contact_force(t, y, model) * v[:, 0]
    supplied = np.cumsum((work - dissipated)[1:] + (work - dissipated)[:-1]) * t[1] / 2
    assert np.abs(energy[1:] - supplied).max() < 1e-5 * energy.max()
    assert np.trapezoid(dissipated, t) > 0.1 * energy.max()


def test_order_of_rk4(gentle):
    times = np.array([2 / FREQUENCY])
    exact = solve("DOP853", gentle, times, 1e-13, 1e-3).states
    steps = [2e-3, 1e-3, 5e-4, 2.5e-4]
    errors = [np.abs(rk4(gentle, times, step).states - exact)[0, UPPER_FRAME] for step in steps]
    assert fitted_order(steps, errors) == pytest.approx(4, abs=0.3)


def test_order_of_dormand_prince(gentle):
    """The error falls as the fifth power of the mean step, once the controller is steady."""
    times = np.array([10 / FREQUENCY])
    exact = solve("DOP853", gentle, times, 1e-13, 1e-3).states
    runs = [solve("RK45", gentle, times, rtol, 0.1) for rtol in 10.0 ** -np.arange(6, 10.5, 0.5)]
    errors = [np.abs(run.states - exact).max() for run in runs]
    assert fitted_order([1 / run.steps for run in runs], errors) == pytest.approx(5, abs=0.4)


@pytest.mark.parametrize(
    "method, coefficients",
    # Of the stability functions in Hairer, Wanner, Solving Ordinary Differential Equations II, section IV.2.
    [("RK4", [1, 1, 1 / 2, 1 / 6, 1 / 24]), ("RK45", [1, 1, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 600])],
)
def test_stability_limits(method, coefficients):
    growth = np.abs(np.polynomial.Polynomial(coefficients)(-STABILITY[method] * np.array([1 - 1e-4, 1 + 1e-4])))
    assert growth[0] < 1 < growth[1]


def test_stuck_rods_limit_the_explicit_step_and_not_the_stiff_one(parameters):
    """Small motions, rods creeping: RK4 chatters just beyond the limit; LSODA steps far beyond it."""
    model = bench_model(parameters, FREQUENCY, 0.05)
    limit = STABILITY["RK4"] * parameters["zspring.J1"] / (parameters["zspring.Mf"] * parameters["zspring.tau"])
    times = np.array([2 / FREQUENCY])
    exact = solve("Radau", model, times, 1e-10, 0.01).states[0]
    below, beyond = (rk4(model, times, factor * limit).states[0] for factor in (0.97, 1.1))
    # Chatter moves a rod's rate where the law is flat, at some multiple of 1 / tau.
    assert np.abs(below - exact)[4:6].max() < 1e-8
    assert np.abs(beyond - exact)[4:6].max() > 0.1 / parameters["zspring.tau"]
    stiff = solve("LSODA", model, times, 1e-5, 0.1)
    assert times[0] / stiff.steps > 5 * limit
    assert np.abs(stiff.states[0] - exact)[4:6].max() < 1e-5


def test_peers_agree(parameters):
    """At a tolerance of 1e-8 all are within 1e-5 of the reference, after 3 periods."""
    problem = Problem(parameters, FREQUENCY, ACCELERATION, 2)
    assert max(problem.doubt.H, problem.doubt.frame, problem.doubt.force) < 1e-6
    for method in ADAPTIVE:
        run = solve(method, problem.model, problem.times, 1e-8, 0.1)
        errors = problem.errors_of_states(run.states)
        assert max(errors.H, errors.frame, errors.force) < 1e-5, method
    errors = problem.errors_of_states(rk4(problem.model, problem.times, 5e-6).states)
    assert max(errors.H, errors.frame, errors.force) < 1e-6


def test_the_fmu_converges_to_the_peers(installed, parameters):
    laboratory = Laboratory(installed, parameters, FREQUENCY, ACCELERATION)
    coarse = Variant("precision", parameters["zspring.J1"], 2, "HHT", step=4e-4, hht_alpha=-0.3)
    steps = [4e-4, 2e-4, 1e-4, 5e-5]
    results = [laboratory.run(replace(coarse, step=step)) for step in steps]
    assert all(result.status == "ok" for result in results)
    assert results[-1].steps == pytest.approx(3 / FREQUENCY / steps[-1])
    for quantity in ("H", "frame", "force"):
        errors = [getattr(result, quantity) for result in results]
        assert errors[-1] < 2e-4
        assert fitted_order(steps, errors) == pytest.approx(2, abs=0.4), quantity


def test_a_lucky_zero_of_the_error_does_not_count():
    base = Variant("precision", 1e-3, 2, "HHT", hht_alpha=-0.3)
    cases = [(8e-3, 1.0, 0.001), (4e-3, 2.0, 0.05), (2e-3, 4.0, 0.009), (1e-3, 8.0, 0.002)]
    runs = {replace(base, step=step): Result(seconds, 1, H=error) for step, seconds, error in cases}
    choice = cheapest(runs, 0.01, "H", FREQUENCY)
    assert (choice.variant.step, choice.result.seconds, choice.mean_step) == (2e-3, 4.0, 0.6)
    assert cheapest(runs, 1e-3, "H", FREQUENCY) is None
    runs[replace(base, step=5e-4)] = Result(status="no solution")
    assert cheapest(runs, 0.01, "H", FREQUENCY) is None


def test_finished_runs_are_kept_and_not_repeated(tmp_path):
    planned = [Variant("precision", 7.5e-4, 2, "RK4", step=step) for step in (1e-5, 2e-5)]
    planned.append(replace(planned[0], method="RK45", step=0, rtol=1e-3, atol_factor=0.1))
    asked = []

    class Counter:
        def run(self, variant):
            asked.append(variant)
            return Result(2.0 if variant.step == 2e-5 else 0.1 * len(asked), 10, 1e-3, 2e-3, 3e-3)

    def opened(frequency: str = "5") -> Record[Run]:
        return Record(tmp_path / "runs.csv", {"frequency": frequency}, list(COLUMNS.values()), to_row, from_row)

    _measure(Counter(), planned[:1], opened(), rounds=1)
    record = opened()
    _measure(Counter(), planned, record, rounds=2)
    first, long, last = planned
    assert asked == [first, long, last, first, last]
    runs = runs_of(record, planned)
    assert min(run.seconds for run in runs[first]) == 0.1 and len(runs[long]) == 1
    assert opened().results == record.results  # to the last bit
    with pytest.raises(ZSpringError, match="is of other settings"):
        opened("6")


def test_quick_study_writes_its_files(tmp_path):
    arguments = ["--quick", "--periods", "1", "--rounds", "1", "--output", str(tmp_path)]
    done = CliRunner().invoke(integrators, arguments, catch_exceptions=False)
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["inertia.png", "integrators.csv", "precision.png"]
    head, rows = read_rows(tmp_path / "integrators.csv")
    assert head["bench"].startswith("5.0 Hz, 1.0 m/s2") and head["zspring.tau"] == "1000 s"
    results = dict(from_row(row) for row in rows)
    assert {variant.method for variant in results} == {"HHT", "RK4", "RK45", "LSODA", "Radau", "CVODE"}
    assert {variant.inertia for variant in results if variant.study == "inertia"} == {7.5e-4, 1e-5}
    # Stability, not accuracy, sets the explicit step: steps grow as 1 / J, by 75.
    explicit = {
        v.inertia: r.steps for v, r in results.items() if v.method == "RK45" and v.rtol == 1e-4 and v.study == "inertia"
    }
    assert explicit[1e-5] / explicit[7.5e-4] == pytest.approx(75, rel=0.3)
    assert all(text in done.output for text in ("step ratio", "goal: 50 times", "written:"))


def test_no_inertia_is_refused():
    done = CliRunner().invoke(integrators, ["--quick", "--set", "zspring.J1=0"])
    assert str(done.exception) == "zspring.J1 = 0 kg.m2: must be more than 0 for the explicit methods"


@pytest.mark.parametrize("missing", ["numba", "CyRK"])
def test_a_missing_extra_is_named(missing):
    code = f"import sys; sys.modules[{missing!r}] = None; from zspring.cli import main; sys.exit(main())"
    done = subprocess.run([sys.executable, "-c", code, "integrators"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert done.stderr == f'zspring: {missing} not installed: {sys.executable} -m pip install "zspring[research]"\n'
