"""The Z-spring element, the static state and the friction laws, each as a physical statement of its own."""

from __future__ import annotations

import numpy as np
import pytest

from probe import COULOMB, FREE, LOCKED, TANH, resolvent, static_state, zspring

RNG = np.random.default_rng(380)
# k, l0, L1, L2, d; then alpha, beta, gap: far beyond what a pantograph reaches.
STATES = [
    (RNG.uniform([1e3, 0.005, 0.03, 0.03, 0.1], [1e5, 0.05, 0.1, 0.1, 0.3]), RNG.uniform([-1, -1, -0.2], [1, 1, 0.2]))
    for _ in range(200)
]


def moved(coordinates, dof: int, step: float) -> np.ndarray:
    """alpha, beta, gap after a move of one of u1, alpha, beta, u2."""
    alpha, beta, gap = coordinates
    change = np.zeros(4)
    change[dof] = step
    return np.array([alpha + change[1], beta + change[2], gap + change[3] - change[0]])


def central(function, coordinates, dof: int, step: float = 1e-6):
    return (function(moved(coordinates, dof, step)) - function(moved(coordinates, dof, -step))) / (2 * step)


@pytest.mark.parametrize("parameters, x", STATES)
def test_force_is_the_gradient_of_the_energy(parameters, x):
    _, force, _ = zspring(parameters, x)
    differences = [central(lambda y: zspring(parameters, y)[0], x, dof) for dof in range(4)]
    np.testing.assert_allclose(force, differences, rtol=1e-6, atol=1e-6 * np.abs(force).max())


@pytest.mark.parametrize("parameters, x", STATES)
def test_tangent_is_the_gradient_of_the_force(parameters, x):
    _, _, tangent = zspring(parameters, x)
    differences = np.column_stack([central(lambda y: zspring(parameters, y)[1], x, dof) for dof in range(4)])
    np.testing.assert_allclose(tangent, differences, rtol=1e-6, atol=1e-6 * np.abs(tangent).max())
    np.testing.assert_allclose(tangent, tangent.T, rtol=0, atol=1e-12 * np.abs(tangent).max())


def test_a_lift_of_head_and_frame_together_changes_nothing():
    for parameters, x in STATES[:20]:
        _, force, tangent = zspring(parameters, x)
        assert force[0] + force[3] == pytest.approx(0, abs=1e-12 * abs(force[0]))
        np.testing.assert_allclose(tangent @ [1, 0, 0, 1], 0, atol=1e-12 * np.abs(tangent).max())


def test_a_spring_at_its_natural_length_has_no_force():
    # alpha = beta = 0: the spring spans the horizontal gap d - L1 - L2 and the vertical one.
    k, L1, L2, d, gap = 13000.0, 0.075, 0.06, 0.17, 0.02
    l0 = np.hypot(d - L1 - L2, gap)
    energy, force, _ = zspring((k, l0, L1, L2, d), (0, 0, gap))
    assert energy == pytest.approx(0, abs=1e-20)
    np.testing.assert_allclose(force, 0, atol=1e-10)


@pytest.mark.parametrize("load", [1.0, 50.0, 190.0, 1000.0])
def test_static_state_balances_the_load_and_has_the_closed_form_stiffness(load):
    for parameters, _ in STATES[:50]:
        k, l0, L1, L2, d = parameters
        state = static_state(parameters, load)
        theta, T = state["theta"], state["tension"]
        s, c = np.sin(theta), np.cos(theta)
        assert k * (d / c - L1 - L2 - l0) * s == pytest.approx(load, rel=1e-9)
        assert T > 0
        _, force, K = zspring(parameters, (theta, theta, state["gap"]))
        assert force[0] == pytest.approx(-load, rel=1e-9)
        np.testing.assert_allclose(force[1:3], 0, atol=1e-12 * T)

        locked = k * s**2 + T / state["length"] * c**2
        free = k * s**2 + T / (d / c) * c**2
        assert state["k_locked"] == pytest.approx(locked, rel=1e-12) == pytest.approx(K[0, 0], rel=1e-9)
        # Free rods give way until their moments vanish: condense them out of the tangent.
        condensed = K[0, 0] - K[0, 1:3] @ np.linalg.solve(K[1:3, 1:3], K[1:3, 0])
        assert state["k_free"] == pytest.approx(free, rel=1e-12) == pytest.approx(condensed, rel=1e-8)


def test_without_load_and_without_tension_there_is_no_static_state():
    assert static_state((1e4, 0.0171, 0.075, 0.075, 0.160), 0.0) is None
    taut = static_state((1e4, 0.0171, 0.075, 0.075, 0.170), 0.0)
    assert taut["theta"] == 0 and taut["k_free"] == pytest.approx(1e4 * 0.0029 / 0.170, rel=1e-9)


@pytest.mark.parametrize("law", [FREE, TANH, COULOMB, LOCKED])
def test_resolvent_solves_z_for_rate_and_moment(law):
    for rho, tau, z in zip(10 ** RNG.uniform(-3, 2, 500), 10 ** RNG.uniform(0, 7, 500), RNG.uniform(-5, 5, 500)):
        w, s, dw, ds = resolvent(law, rho, tau, z, w_guess=RNG.uniform(-1, 1))
        assert rho * w + s == pytest.approx(z, rel=1e-12, abs=1e-14)
        assert rho * dw + ds == pytest.approx(1, rel=1e-9)
        assert dw >= 0 and ds >= 0
        if law == TANH:
            assert s == pytest.approx(np.tanh(tau * w), abs=1e-11)
        elif law == COULOMB:
            assert abs(s) <= 1 and (w == 0 or s == np.sign(w))
        elif law == LOCKED:
            assert w == 0
        else:
            assert s == 0


def test_tanh_resolvent_is_exact_from_any_guess():
    """From rods that all but stick to fast ones, with guesses that are far off, or just above the root."""
    for _ in range(5000):
        rho, tau, z = 10 ** RNG.uniform([-3, 0, -9], [2, 5, 1])
        exact, *_ = resolvent(TANH, rho, tau, z)
        for guess in 10 ** RNG.uniform(-9, 1) / tau, exact * (1 + 10 ** RNG.uniform(-8, 0)):
            w, s, *_ = resolvent(TANH, rho, tau, z, guess)
            assert s == pytest.approx(np.tanh(tau * w), abs=3e-15)
            assert rho * w == pytest.approx(rho * exact, rel=1e-13, abs=1e-14)


def test_tanh_resolvent_has_the_slope_of_its_differences():
    for rho, tau, z in zip(10 ** RNG.uniform(-1, 1, 100), 10 ** RNG.uniform(0, 3, 100), RNG.uniform(-3, 3, 100)):
        _, _, dw, ds = resolvent(TANH, rho, tau, z)
        (w1, s1, *_), (w0, s0, *_) = resolvent(TANH, rho, tau, z + 1e-6), resolvent(TANH, rho, tau, z - 1e-6)
        assert dw == pytest.approx((w1 - w0) / 2e-6, rel=1e-4, abs=1e-9)
        assert ds == pytest.approx((s1 - s0) / 2e-6, rel=1e-4, abs=1e-7)


def test_tanh_resolvent_tends_to_coulomb():
    for z in np.linspace(-3, 3, 61):
        w, s, *_ = resolvent(TANH, 1.0, 1e9, z)
        w_limit, s_limit, *_ = resolvent(COULOMB, 1.0, 1e9, z)
        assert abs(w - w_limit) < 2e-8 and abs(s - s_limit) < 2e-8
