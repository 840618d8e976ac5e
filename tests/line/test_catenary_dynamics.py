"""The overhead line in motion: d'Alembert's and the modal solution of the bare wire, energy, orders of
convergence, dropper slackening in a model of four degrees of freedom, and an independent finite-element line.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from catenary_line import COMPLETE, Line, parameters_of
from catenary_reference import Solver
from harness import fitted_order

MASS, TENSION, EI = 1.35, 20e3, 195.0  # contact wire of EN 50318:2002
BARE = Line(spans=1, span=100.0, dropper_position=(), dropper_sag=())
UPLIFTS = [f"point.uplift[{i}]" for i in range(1, 9)]
ENERGIES = ["energy.kinetic", "energy.elastic", "energy.dissipated", "energy.work"]


def pulse(t: float, height: float, duration: float) -> float:
    """One smooth hump, sin^4, of a force."""
    return height * np.sin(np.pi * t / duration) ** 4 if 0 < t < duration else 0.0


def fixed(line: Line, x: float, points=(), **solver) -> dict[str, float]:
    """Parameters for a force that stays at x; `solver`: step, alpha."""
    return (
        parameters_of(line)
        | {"travel": "Position", "pantograph[1].position": x}
        | {f"point.position[{i}]": p for i, p in enumerate(points, start=1)}
        | {f"solver.{name}": value for name, value in solver.items()}
    )


# The bare wire


def test_waves_travel_at_the_square_root_of_tension_over_mass(catenary):
    """A wire without bending under F(t) at x0: u = c / (2 T) times the integral of F(t - |x - x0| / c)."""
    line = replace(BARE, span=200.0, contact_wire=(MASS, TENSION, 1e-3), element=0.25)
    points = np.array([60.0, 85.0, 115.0, 140.0])
    p = catenary(fixed(line, 100.0, points, step=2.5e-4, alpha=0.0))
    step, duration = 1e-3, 0.2
    force = {"pantograph[1].force": lambda t: pulse(t, 100.0, duration)}
    found = p.run(step, 450, UPLIFTS[:4], targets=force)

    t = step * np.arange(1, 451)
    s = np.clip(t[:, None] - np.abs(points - 100.0) / np.sqrt(TENSION / MASS), 0.0, duration) / duration
    integral = 3 / 8 * s - np.sin(2 * np.pi * s) / (4 * np.pi) + np.sin(4 * np.pi * s) / (32 * np.pi)
    exact = np.sqrt(TENSION / MASS) / (2 * TENSION) * 100.0 * duration * integral
    np.testing.assert_allclose(found, exact, atol=2e-3 * exact.max())
    half = [np.interp(exact[-1, 0] / 2, u, t) for u in found.T]  # when half of the final uplift is there
    speed = (points[[0, 3]] - points[[1, 2]]) / (np.array(half)[[0, 3]] - np.array(half)[[1, 2]])
    assert np.abs(speed) == pytest.approx(np.sqrt(TENSION / MASS), rel=1e-3)


class MovingLoad:
    """A constant force along a tensioned beam, w = w'' = 0 at both ends, from rest under it: its modes.

    q'' + w^2 q = 2 F / (m L) sin(k (x0 + v t)), q(0) = 2 F / (m L w^2) sin(k x0), q'(0) = 0
    """

    force, start, speed, length = 200.0, 20.0, 60.0, 100.0

    def __init__(self, terms: int = 3000):
        self.k = np.arange(1, terms + 1) * np.pi / self.length
        self.omega = np.sqrt((TENSION * self.k**2 + EI * self.k**4) / MASS)

    def modes(self, t: np.ndarray) -> np.ndarray:
        """q, shape (len(t), terms)."""
        p, drive = 2 * self.force / (MASS * self.length), self.k * self.speed
        amplitude = p / (self.omega**2 - drive**2)
        sin0, cos0 = np.sin(self.k * self.start), np.cos(self.k * self.start)
        t = t[:, None]
        return (
            amplitude * np.sin(self.k * self.start + drive * t)
            + (p / self.omega**2 - amplitude) * sin0 * np.cos(self.omega * t)
            - amplitude * drive / self.omega * cos0 * np.sin(self.omega * t)
        )

    def at(self, t: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Uplift (m) at times t (n,) and positions x (n,) or (n, p)."""
        return np.einsum("nm,nm...->n...", self.modes(t), np.sin(self.k[:, None] * x[:, None, :]))


def moving_load(catenary, exact: MovingLoad, step: float, element: float) -> float:
    """Largest error of the uplift under the load and at two points, against the largest uplift."""
    line = replace(BARE, element=element)
    p = catenary(
        parameters_of(line)
        | {f"pantograph[1].{n}": getattr(exact, n) for n in ("force", "start", "speed")}
        | {"point.position[1]": 30.0, "point.position[2]": 70.0, "solver.step": step, "solver.alpha": -0.1}
    )
    found = p.run(0.02, 50, ["pantograph[1].uplift", *UPLIFTS[:2]])
    t = 0.02 * np.arange(1, 51)
    places = np.column_stack([exact.start + exact.speed * t, np.full(50, 30.0), np.full(50, 70.0)])
    solution = exact.at(t, places)
    return np.abs(found - solution).max() / solution.max()


def test_a_moving_load_on_the_wire_has_its_modal_solution(catenary):
    """At half the wave speed, over four fifths of the wire; the error falls with the step."""
    exact = MovingLoad()
    steps = [1e-3, 5e-4, 2.5e-4]
    errors = [moving_load(catenary, exact, step, 0.25) for step in steps]
    assert errors[0] < 1.5e-3 and errors[-1] < 3e-4
    assert fitted_order(steps, errors) > 0.9  # the load starts at full speed: no smoother solution


def test_the_wires_velocity_is_the_rate_of_its_height_along_the_way(catenary):
    """Travel and static shape included: its integral by the trapezoidal rule, of second order in the step."""
    line = Line(spans=4, damping_mass=0.0125, damping_stiffness=1e-4)
    load = {"pantograph[1].force": 120.0, "pantograph[1].start": 70.0, "pantograph[1].speed": 70.0}
    steps, errors = [1e-3, 5e-4, 2.5e-4], []
    for step in steps:
        p = catenary(parameters_of(line) | load | {"solver.step": step})
        names = [f"pantograph[1].{name}" for name in ("x", "wire_height", "wire_velocity")]
        x, z, v = p.run(step, round(1.5 / step), names).T
        np.testing.assert_allclose(x, 70.0 + 70.0 * step * np.arange(1, len(x) + 1), rtol=1e-12)
        rise = np.cumsum(0.5 * (v[1:] + v[:-1])) * step
        errors.append(np.abs(rise - (z[1:] - z[0])).max() / np.ptp(z))
    assert errors[-1] < 1e-3
    assert fitted_order(steps, errors) > 1.8


@pytest.mark.parametrize("damping", [(0.6, 0.0), (0.0, 0.06), (0.3, 0.04)])
def test_the_wires_first_mode_decays_as_rayleigh_says(catenary, damping):
    """Free, at the middle: u(t + s) = A u(t) + B u(t - s) with the roots exp(lambda s) of its mode.

    Higher modes, odd only, have died by stiffness damping; by mass damping they are fitted as well.
    """
    line = replace(BARE, damping_mass=damping[0], damping_stiffness=damping[1], element=0.5)
    k = np.pi / line.length
    stiffness = TENSION * k**2 + EI * k**4
    rate = damping[0] + damping[1] * stiffness / MASS
    exact = np.roots([1.0, rate, stiffness / MASS])

    p = catenary(fixed(line, 50.0, (50.0,), step=1e-3, alpha=0.0))
    force = {"pantograph[1].force": lambda t: pulse(t, 300.0, 1.0)}
    p.run(0.01, 250 if damping[1] else 100, [], targets=force)
    terms = 1 if damping[1] else 4  # modes 1, 3, 5, 7
    u = p.run(0.05, 60, UPLIFTS[:1])[:, 0]
    window = np.lib.stride_tricks.sliding_window_view(u, 2 * terms + 1)
    recurrence = np.linalg.lstsq(window[:, :-1], window[:, -1], rcond=None)[0]
    roots = np.log(np.roots([1.0, *-recurrence[::-1]]).astype(complex)) / 0.05
    nearest = roots[np.argmin(np.abs(roots - exact[0]))]
    assert nearest == pytest.approx(exact[0], rel=2e-3)


def test_a_place_by_speed_is_a_place_by_position(catenary):
    """An accelerating load, one communication step a time step."""
    line, force = Line(spans=2, element=2.0), lambda t: 100.0 + 40.0 * np.sin(30.0 * t)
    speed, place = lambda t: 20.0 + 60.0 * t, lambda t: 15.0 + 20.0 * t + 30.0 * t**2
    common = parameters_of(line) | {"pantograph[1].force": force(0.0)}
    by_speed = catenary(common | {"pantograph[1].start": 15.0, "pantograph[1].speed": speed(0.0)})
    by_place = catenary(common | {"travel": "Position", "pantograph[1].position": place(0.0)})
    outputs = ["pantograph[1].x", "pantograph[1].wire_height", "support.uplift[2]", "energy.kinetic"]
    driven = {"pantograph[1].speed": speed, "pantograph[1].force": force}
    first = by_speed.run(1e-3, 800, outputs, targets=driven)
    driven = {"pantograph[1].position": place, "pantograph[1].force": force}
    second = by_place.run(1e-3, 800, outputs, targets=driven)
    np.testing.assert_allclose(first[:, 0], place(1e-3 * np.arange(1, 801)), rtol=1e-12)
    largest = np.abs(second).max(axis=0)
    np.testing.assert_allclose(first / largest, second / largest, atol=1e-9)


# Energy


def energies(catenary, line: Line, force: float, step: float, alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Energies (n, 4) under a hump of force at a dropper, and the work (n,) of the force by its way."""
    p = catenary(fixed(line, 30.0, step=step, alpha=alpha))
    begin = p["pantograph[1].wire_height"]
    outputs, hump = [*ENERGIES, "pantograph[1].wire_height"], lambda t: pulse(t, force, 0.3)
    rows = p.run(step, round(0.6 / step), outputs, targets={"pantograph[1].force": hump})
    f = np.array([hump(t) for t in step * np.arange(len(rows) + 1)])
    work = np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(rows[:, 4], prepend=begin))
    return rows[:, :4], work


def test_work_is_kinetic_plus_elastic_energy_of_the_undamped_line(catenary):
    """By the trapezoidal rule (alpha = 0), droppers taut: to rounding. The work is force times way."""
    found, work = energies(catenary, Line(spans=2), 100.0, step=1e-3, alpha=0.0)
    kinetic, elastic, dissipated, reported = found.T
    np.testing.assert_allclose(reported, work, atol=1e-9 * work.max())
    np.testing.assert_allclose(kinetic + elastic, reported, atol=1e-9 * work.max())
    assert kinetic.max() > 0.1 * work.max() and elastic.max() > 0.1 * work.max()
    assert not dissipated.any()


def test_damping_takes_what_is_missing(catenary):
    line = Line(spans=2, damping_mass=0.2, damping_stiffness=1e-3)
    found, work = energies(catenary, line, 100.0, step=1e-3, alpha=0.0)
    kinetic, elastic, dissipated, reported = found.T
    np.testing.assert_allclose(reported, work, atol=1e-9 * work.max())
    np.testing.assert_allclose(kinetic + elastic + dissipated, work, atol=1e-9 * work.max())
    assert np.all(np.diff(dissipated) >= 0)
    assert dissipated[-1] > 0.1 * work.max()


def test_energy_is_kept_while_droppers_slacken_and_tighten(catenary):
    line, unbalanced = Line(spans=2), []
    for step in (1e-3, 2.5e-4):
        found, work = energies(catenary, line, 500.0, step=step, alpha=0.0)
        kinetic, elastic, dissipated, reported = found.T
        np.testing.assert_allclose(reported, work, atol=1e-9 * work.max())
        unbalanced.append(np.abs(kinetic + elastic + dissipated - work).max() / work.max())
    assert 1e-9 < unbalanced[0] < 2e-3  # droppers did slacken
    assert unbalanced[1] < 0.3 * unbalanced[0]


def test_numerical_damping_only_takes_energy(catenary):
    found, _ = energies(catenary, Line(spans=2), 100.0, step=1e-3, alpha=-0.3)
    kinetic, elastic, _dissipated, work = found.T
    after = slice(301, None)
    total = (kinetic + elastic)[after]
    assert np.all(np.diff(total) < 1e-6 * work.max())
    assert total[-1] > 0.9 * total[0]


# Convergence


def smooth_response(catenary, line: Line, step: float, alpha: float) -> np.ndarray:
    p = catenary(fixed(line, 30.0, (10.0, 30.0, 55.0, 75.0), step=step, alpha=alpha))
    force = {"pantograph[1].force": lambda t: pulse(t, 80.0, 0.4)}
    return p.run(0.02, 30, UPLIFTS[:4], targets=force)


def test_the_step_converges_with_second_order(catenary):
    """Droppers taut, a smooth force; against an eight times finer step."""
    line = Line(spans=2, element=3.0, damping_mass=0.1, damping_stiffness=1e-4)
    for alpha in (0.0, -0.1, -0.3):
        runs = {n: smooth_response(catenary, line, 0.02 / n, alpha) for n in (8, 16, 32, 256)}
        errors = [np.abs(runs[n] - runs[256]).max() for n in (8, 16, 32)]
        assert fitted_order([1 / 8, 1 / 16, 1 / 32], errors) == pytest.approx(2.0, abs=0.25), alpha


def test_the_mesh_converges(catenary):
    """Elements of 1 m err by half a percent of the largest uplift; the wire bends over sqrt(EI / T) = 0.1 m."""
    sizes = [2.0, 1.0, 0.5, 0.25]
    runs = [smooth_response(catenary, Line(spans=2, element=s), 2e-3, -0.1) for s in (*sizes, 0.0625)]
    errors = [np.abs(r - runs[-1]).max() / np.abs(runs[-1]).max() for r in runs[:-1]]
    assert errors[1] < 6e-3 and errors[3] < 3e-4
    assert fitted_order(sizes, errors) > 1.8


# Slackening, a model of four degrees of freedom


class OneDropper:
    """Two wires of one span, two elements each, one dropper at the middle; motion even about the middle.

    Degrees of freedom: slope at the end and uplift at the middle, of the contact wire and of the messenger.
    Element matrices as in textbooks (consistent mass, bending, tension), by hand for the even motion.
    """

    def __init__(self, line: Line):
        half = line.span / 2
        self.k, self.T0 = line.dropper_stiffness, line.T0[0]
        self.M, self.K = np.zeros((4, 4)), np.zeros((4, 4))
        for i, (mass, tension, bending) in enumerate((line.contact_wire, line.messenger)):
            a = slice(2 * i, 2 * i + 2)  # rows (w'0, w1) of the left half, doubled
            self.M[a, a] = 2 * mass * half / 420 * np.array([[4 * half**2, 13 * half], [13 * half, 156]])
            self.K[a, a] = 2 * tension / (30 * half) * np.array([[4 * half**2, -3 * half], [-3 * half, 36]])
            self.K[a, a] += 2 * bending / half**3 * np.array([[4 * half**2, -6 * half], [-6 * half, 12]])
        self.inverse = np.linalg.inv(self.M)

    def tension(self, u: np.ndarray) -> np.ndarray:
        return np.maximum(0.0, self.T0 + self.k * (u[3] - u[1]))

    def solve(self, force, times: np.ndarray) -> np.ndarray:
        """Uplifts of contact wire and messenger at the middle (m) and the dropper's tension (N), shape (3, n)."""

        def rate(t, y):
            pull = self.tension(y[:4]) - self.T0
            load = np.array([0.0, force(t) + pull, 0.0, -pull])
            return np.concatenate([y[4:], self.inverse @ (load - self.K @ y[:4])])

        y = solve_ivp(rate, (0, times[-1]), np.zeros(8), "DOP853", times, rtol=1e-9, atol=1e-12, max_step=1e-3).y
        return np.array([y[1], y[3], self.tension(y[:4])])


def test_a_dropper_slackens_as_in_a_model_of_four_degrees_of_freedom(catenary):
    line = Line(spans=1, span=12.0, dropper_position=(6.0,), dropper_sag=(0.0,), dropper_stiffness=2e4, element=6.0)

    def force(t: float) -> float:
        return pulse(t, 300.0, 0.15)

    times = 0.005 * np.arange(1, 81)
    exact = OneDropper(line).solve(force, times)
    slack = exact[2] == 0
    assert 0.2 < slack.mean() < 0.8 and np.count_nonzero(np.diff(slack)) >= 4
    steps, errors = [1e-3, 5e-4, 2.5e-4], []
    for step in steps:
        p = catenary(fixed(line, 6.0, step=step, alpha=0.0))
        rows = []
        for _ in range(80):  # the force as finely as the steps
            p.run(step, round(0.005 / step), [], targets={"pantograph[1].force": force})
            rows.append(p.reals(["pantograph[1].uplift", "droppers.force_max"]))
        found = np.array(rows).T
        errors.append(np.abs(found[0] - exact[0]).max() / exact[0].max())
        tension = np.abs(found[1] - exact[2]).max() / exact[2].max()
    assert errors[-1] < 2e-3 and tension < 2e-2
    assert fitted_order(steps, errors) > 1.5


# The independent line, step by step


@pytest.mark.parametrize("line", [Line(spans=3, damping_mass=0.0125, damping_stiffness=1e-4), COMPLETE])
@pytest.mark.parametrize("step, inner", [(1e-3, 1), (5e-3, 5)])
def test_every_step_is_that_of_an_independent_line(catenary, line, step, inner):
    """Two loads at different speeds and changing forces that slacken droppers; linear between the steps."""
    begin, speed, h = np.array([line.span, 0.4 * line.span]), np.array([70.0, 40.0]), step / inner

    def force(t: float) -> np.ndarray:
        return np.array([200 + 150 * np.sin(40 * t), 150 - 150 * np.cos(25 * t)])

    def sampled(t: float) -> np.ndarray:
        n = np.floor(t / step + 1e-9)
        share = t / step - n
        return (1 - share) * force(n * step) + share * force((n + 1) * step)

    count, points = round(1.0 / step), line.length * np.linspace(0.1, 0.9, 8)
    reference = Solver(line, h, -0.2, points=points)
    expected = reference.run(count * inner, lambda t: begin + speed * t, sampled)

    loads = {f"pantograph[{i}].start": begin[i - 1] for i in (1, 2)}
    loads |= {f"pantograph[{i}].speed": speed[i - 1] for i in (1, 2)}
    loads |= {f"pantograph[{i}].force": force(0.0)[i - 1] for i in (1, 2)}
    p = catenary(
        parameters_of(line)
        | loads
        | {f"point.position[{i}]": x for i, x in enumerate(points, start=1)}
        | {"solver.step": h, "solver.alpha": -0.2}
    )
    supports = [f"support.uplift[{i}]" for i in range(2, line.spans + 1)]
    heights = [f"pantograph[{i}].wire_height" for i in (1, 2)]
    outputs = [*heights, *supports, *UPLIFTS, "droppers.force_min", "droppers.force_max"]
    targets = {f"pantograph[{i}].force": lambda t, i=i: force(t)[i - 1] for i in (1, 2)}
    slack = []
    found = np.empty((count, len(outputs)))
    for n in range(count):
        found[n] = p.run(step, 1, outputs, targets=targets)
        slack.append(p["droppers.slack"])
    every = slice(inner, None, inner)
    uplift = np.column_stack([expected.wire, expected.uplift, expected.points])[every]
    np.testing.assert_allclose(found[:, :-2], uplift, atol=1e-8 * np.abs(uplift).max())
    np.testing.assert_array_equal(slack, np.sum(expected.tension[every] == 0, axis=1))
    assert 20 < np.count_nonzero(slack) and max(slack) > 1
    for column, tension in ((-2, expected.tension.min(axis=1)), (-1, expected.tension.max(axis=1))):
        np.testing.assert_allclose(found[:, column], tension[every], atol=1e-6 * expected.tension.max())
