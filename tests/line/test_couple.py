"""Coupling of pantographs and catenary: against a monolithic solution, its own limits, and its laws."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from catenary_line import Line, parameters_of
from catenary_reference import EN_50318_2002, History, Solver
from harness import PRECISE, fitted_order
from zspring.couple.compare import compare_steps
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.mean_force import mean_force
from zspring.line.result import LineResult
from zspring.line.run import LineRun, run_line
from zspring.line.schemes import Coupling
from zspring.line.system import System
from zspring.parameter_sets import find_set, read_set
from zspring.variables import parse

SPEED = 250 / 3.6
SHORT = {"line.spans": 4}  # enough for a passage of a few spans
EXTENT = {"start": 30.0, "stop": 120.0}
RIGID_BASE = {"k3": 1e11}  # the limit in which the set is a model of two masses
EXPLICIT, JACOBI = Coupling("explicit"), Coupling("jacobi")


@pytest.fixture(scope="module")
def fmus() -> Iterator[tuple[Fmu, Fmu]]:
    """Catenary and pantograph."""
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        yield catenary, pantograph


@pytest.fixture(scope="module")
def two_masses(fmus) -> dict:
    """The two-mass pantograph of EN 50318:2002, linear."""
    return read_set(find_set("en-50318-2002"), fmus[1])


@pytest.fixture(scope="module")
def along(fmus, two_masses) -> Callable[..., LineResult]:
    """run_line on the short line with the two-mass pantograph, unless told otherwise."""

    def run(pantographs=None, line=None, **settings) -> LineResult:
        coupling = settings.pop("coupling", Coupling())
        journey = Journey(**{"speed": SPEED, **EXTENT, **settings})
        return run_line(System(*fmus, {**SHORT, **(line or {})}, pantographs or [two_masses], journey, coupling))

    return run


def monolithic(line: Line, starts: list[float], stop: float, step: float, alpha: float, ramp: bool) -> History:
    """Two-mass pantographs and line as one system, by an implementation that shares nothing with the FMUs."""
    pantograph = EN_50318_2002
    lifted = line.wires[0].at(starts) @ (line.equilibrium(starts, [pantograph.F0] * len(starts))[0] + line.shape)

    def offset(t: float) -> np.ndarray:
        done = min(1.0, SPEED * t / line.span) if ramp else 0.0
        return lifted * 0.5 * (1 + np.cos(np.pi * done))

    solver = Solver(line, step, alpha, [pantograph] * len(starts))
    steps = int((stop - starts[0]) / (SPEED * step) + 1e-9)
    return solver.run(steps, lambda t: [x + SPEED * t for x in starts], offset=offset)


PLAIN = Line(spans=4)
EQUIPPED = Line(
    spans=4,
    dropper_sag=(0, 0.02, 0.035, 0.045, 0.05, 0.045, 0.035, 0.02, 0),
    dropper_mass=0.117,
    clamp_contact=0.165,
    clamp_messenger=0.195,
    arm_mass=0.5,
    arm_stiffness=200.0,
    damping_mass=0.0125,
    damping_stiffness=1e-4,
)


@pytest.mark.parametrize(
    "line, starts, start_up, drive",
    [
        (PLAIN, [30.0], "ramp", "Wire"),
        (PLAIN, [30.0], "direct", "Force"),
        (EQUIPPED, [30.0], "ramp", "Force"),
        (EQUIPPED, [75.0, 40.0], "ramp", "Wire"),
        (PLAIN, [75.0, 40.0], "direct", "Force"),
    ],
)
def test_implicit_coupling_is_the_monolithic_solution(along, two_masses, line, starts, start_up, drive):
    """At a communication step of one internal step both are the same HHT equations, solved differently."""
    alpha, step, stop = -0.1, 2e-3, 150.0
    exact = monolithic(line, starts, stop, step, alpha, start_up == "ramp")
    own = {"solver.alpha": alpha, "solver.step": step}  # of both
    found = along(
        [two_masses | own | PRECISE | RIGID_BASE] * len(starts),
        parameters_of(line) | own,
        start=starts[0],
        stop=stop,
        spacing=starts[0] - starts[-1],
        step=step,
        coupling=Coupling("implicit", drive, tolerance=1e-9),
        start_up=start_up,
    )
    assert found.time == pytest.approx(exact.time)
    assert np.ptp(exact.force) > 50 and found.slack_droppers.max() >= 1
    assert found.contact_force == pytest.approx(exact.force, abs=1e-5)
    assert found.wire_height == pytest.approx(exact.wire, abs=1e-9)
    assert found.support_uplift == pytest.approx(exact.uplift, abs=1e-9)


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
def test_it_does_not_matter_who_solves_the_contact(fmus, along, friction):
    """Z-spring: contact in the pantograph (drive Wire) or in the master (drive Force), converged."""
    own = {"friction": parse(fmus[1].variables["friction"], friction)}
    wire, force = (along([own], coupling=Coupling("implicit", drive)) for drive in ("Wire", "Force"))
    assert np.max(np.abs(wire.moment[:, 0])) > 0.9 * wire.friction_bound[0]  # the joints slip
    assert force.contact_force == pytest.approx(wire.contact_force, abs=0.05)


@pytest.mark.parametrize("coupling", [Coupling(), Coupling("implicit"), Coupling("implicit", "Force"), EXPLICIT])
def test_the_force_is_that_of_the_contact_law_with_the_wire_at_the_same_time(along, coupling):
    """A light static force at 350 km/h loses the contact; the law holds before, in and after the loss.

    Explicit coupling has the wire of an extrapolation in the law: there it holds only roughly.
    """
    result = along([{"static_force": 30.0, "suspension": 2}], speed=350 / 3.6, coupling=coupling)
    force = result.contact_force
    law = np.maximum(0.0, 30.0 + 50e3 * (result.head_height - result.wire_height))
    assert 10 < np.sum(np.abs(force) < 1e-12) < 0.9 * force.size
    assert np.all(force >= -1e-12)  # a force that falls to 0 along a slope ends there to rounding
    if coupling.scheme in ("implicit", "sequential"):
        assert force == pytest.approx(law, abs=2 * 1e-6 * 30.0)
    else:
        assert 1e-3 < np.sqrt(np.mean((force - law) ** 2)) < 15


def test_slowly_drawn_along_the_force_is_the_static_balance(along, two_masses):
    """static_force + uplift = contact force + k2 times the rise of the frame, at every place of the line."""
    settings = {"speed": 2.0, "start": 30.0, "stop": 105.0, "step": 0.02}
    fixed = {"solver.step": 0.02, "solver.alpha": -0.3}
    pantograph = two_masses | {"solver.step": 0.02, "c1": 500.0}
    for uplift in 0.0, 40.0:
        result = along([pantograph], fixed | {"damping.mass": 2.0}, uplift=uplift, coupling=Coupling(), **settings)
        settled = result.position[:, 0] > 95.0
        balance = (result.contact_force + two_masses["k2"] * result.head_height)[settled]
        assert np.mean(balance) == pytest.approx(120.0 + uplift, abs=0.5)
        assert np.max(np.abs(balance - np.mean(balance))) < 6


def test_the_uplift_comes_to_the_head_from_any_mass(along):
    """Nothing but the weak base spring holds the DSA-380: statically each mass passes its uplift on."""
    means = []
    for mass in "head", "upper_frame", "lower_frame":
        result = along([{"suspension": 2}], uplift=40.0, uplift_on=mass)
        means.append(result.contact_force[result.position[:, 0] > 90].mean())
    without = along([{"suspension": 2}])
    assert means == pytest.approx([means[0]] * 3, rel=2e-3)
    assert means[0] > without.contact_force[without.position[:, 0] > 90].mean() + 30


def test_errors_of_the_coupling_fall_with_the_step(fmus, two_masses):
    """Explicit coupling is of second order in the communication step and implicit coupling far more exact."""

    def run(step, coupling, of_line, of_pantograph):
        journey = Journey(SPEED, **EXTENT, step=step)
        return run_line(System(*fmus, SHORT | of_line, [two_masses | of_pantograph], journey, coupling))

    steps = (0.5e-3, 1e-3, 2e-3)
    rows = list(compare_steps(run, Coupling(), 30.0, steps))
    assert (rows[0].scheme, rows[0].step, rows[0].rms) == ("implicit", 0.5e-3, 0.0)
    explicit = [row for row in rows if row.scheme == "explicit"]
    implicit = [row for row in rows[1:] if row.scheme == "implicit"]
    assert fitted_order(steps, [row.rms for row in explicit]) == pytest.approx(2.0, abs=0.3)
    assert fitted_order(steps[1:], [row.rms for row in implicit]) > 1.7
    assert all(b.rms < 0.15 * a.rms for a, b in zip(explicit[1:], implicit))
    assert all(row.largest >= row.rms for row in rows)
    assert rows[0].mean == pytest.approx(explicit[0].mean, abs=0.5)


def test_side_by_side_coupling_is_one_order_worse(along):
    """Each side with the other's last value: first order, and at 1 ms several times the error of explicit."""
    fixed = {"solver.step": 0.5e-3}
    pantograph = {"suspension": 2, "solver.step": 0.5e-3}
    exact = along([pantograph], fixed, step=0.5e-3).contact_force
    errors = {}
    for coupling in EXPLICIT, JACOBI:
        force = along([pantograph], fixed, coupling=coupling).contact_force
        errors[coupling.scheme] = np.sqrt(np.mean((force - exact[::2][: len(force)]) ** 2))
    assert errors["jacobi"] > 3 * errors["explicit"]


# N rms, of the unfiltered contact force, by communication step: what side by side with last values makes 3 to 155 N.
REACHED = {"sequential": {1e-3: 1e-5, 2e-3: 1e-4, 5e-3: 0.1}, "parallel": {1e-3: 1e-3, 2e-3: 0.01, 5e-3: 0.5}}


@pytest.mark.parametrize("speed", [250.0, 300.0])
@pytest.mark.parametrize("pantograph", [{}, {"suspension": 2, "static_force": 20.0}], ids=["Z-spring", "that jumps"])
def test_the_affine_map_gives_what_steps_taken_back_give(along, pantograph, speed):
    """Also two pantographs, slack droppers and a head that leaves the wire; no state saved, no step repeated."""
    for step in (1e-3, 2e-3, 5e-3):
        settings = {"speed": speed / 3.6, "step": step, "spacing": 60.0, "start": 70.0}
        precise = Coupling("implicit", tolerance=1e-9)
        exact = along([pantograph] * 2, coupling=precise, **settings).contact_force
        assert exact.std() > 10 and ((exact == 0).any() == (pantograph != {}))
        for scheme, errors in REACHED.items():
            force = along([pantograph] * 2, coupling=Coupling(scheme), **settings).contact_force
            assert np.sqrt(np.mean((force - exact) ** 2)) < errors[step], (scheme, step)


def test_a_tighter_line_rises_less(along, two_masses):
    """Statically by half with twice the tension; in passing a little more."""
    loose, tight = (
        along([two_masses], {"contact_wire.tension": tension, "messenger.tension": tension}) for tension in (15e3, 30e3)
    )
    assert 0.5 < np.max(tight.wire_height) / np.max(loose.wire_height) < 0.6


@pytest.mark.parametrize("pantograph", [{}, {"friction": 2}, {"suspension": 2, "static_force": 40.0}])
@pytest.mark.parametrize("drive", ["Wire", "Force"])
def test_two_steps_of_the_catenary_do_for_an_implicit_step(fmus, pantograph, drive):
    """Friction, loss of contact and slack droppers seldom take a third one."""
    journey = Journey(300 / 3.6, **EXTENT)
    with LineRun(System(*fmus, SHORT, [pantograph], journey, Coupling("implicit", drive))) as run:
        run.finish()
        assert 1.9 < run.wire_steps < 2.02
        assert run.result().slack_droppers.max() > 0


def test_mean_force_laws():
    """0.00097 v^2 + 70, 110 and 140 N: at 300 km/h 87.3 N more than at a stand."""
    assert mean_force("AC", 300) == pytest.approx(157.3)
    assert mean_force("DC-3kV", 200) == pytest.approx(148.8)
    assert mean_force("DC-1.5kV", 0) == 140


def test_an_iteration_that_does_not_converge_is_told_and_keeps_what_was_done(fmus, two_masses):
    """One step of the catenary is not enough once the force changes; nothing unconverged is passed on.

    The tolerance is a millionth of the static force, 120 N.
    """
    coupling = Coupling("implicit", max_iterations=1)
    with LineRun(System(*fmus, SHORT, [two_masses], Journey(SPEED, **EXTENT), coupling)) as run:
        with pytest.raises(
            ZSpringError, match=r"converge at 0\.\d+ s: after 1 iterations it is .* N off, allowed are 0\.00012 N"
        ):
            run.finish()
        rows = run.result()
    assert 1 <= len(rows.time) < 100
    assert np.all(rows.contact_force > 0)


@pytest.mark.parametrize(
    "settings, message",
    [
        ({"stop": 241.0}, r"stop = 241 m: .* 240 m"),
        ({"start": -1.0}, r"start = -1 m: must be in 0 \.\. 240 m"),
        ({"start": 100.0, "stop": 90.0}, "stop = 90 m: must be above the start, 100 m"),
        ({"step": 0.0}, "step = 0 s: must be above 0"),
        ({"step": 50.0}, "step = 50 s: is longer than the run"),
        ({"speed": float("nan")}, "speed = nan m/s"),
        ({"uplift": float("inf")}, "uplift = inf N"),
        ({"count": 2, "spacing": 40.0}, r"start = 30 m: must be in 40 \.\. 240 m with a pantograph 40 m behind"),
        ({"count": 2, "spacing": 240.0}, "spacing = 240 m: must be above 0 and below"),
        ({"start_up": "jump"}, "start-up 'jump': must be ramp or direct"),
        ({"uplift_on": "roof"}, "uplift on 'roof': must be on head, upper_frame or lower_frame"),
        ({"count": 3, "spacing": 10.0}, "3 pantographs: must be 1 or 2"),
    ],
)
def test_what_does_not_fit_the_line_is_refused(along, two_masses, settings, message):
    count = settings.get("count", 1)
    with pytest.raises(ZSpringError, match=message):
        along([two_masses] * count, **{key: value for key, value in settings.items() if key != "count"})


@pytest.mark.parametrize(
    "arguments, message",
    [
        (("loose",), "coupling 'loose': must be one of sequential, parallel, implicit, explicit, jacobi"),
        (("implicit", "Bench"), "drive 'Bench'"),
        (("jacobi", "Force"), "needs drive Wire"),
        (("parallel", "Force"), "coupling parallel with drive Force: needs drive Wire"),
        (("implicit", "Wire", 0.0), "tolerance = 0: must be above 0"),
    ],
)
def test_couplings_that_do_not_exist_are_refused(arguments, message):
    with pytest.raises(ZSpringError, match=message):
        Coupling(*arguments)


def test_a_damper_in_a_contact_that_the_master_solves_is_refused(along):
    with pytest.raises(ZSpringError, match=r"contact\.c = 50 N\.s/m: must be 0 with drive Force"):
        along([{"contact.c": 50.0}], coupling=Coupling("implicit", "Force"))
