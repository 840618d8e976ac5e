"""Drive Bench: the FMU's own stepped sine and harmonic analysis."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Pantograph, bench_point

FREQUENCY, ACCELERATION = 4.0, 2.0


def point(p: Pantograph) -> complex:
    return complex(*p.reals(["bench.H_re", "bench.H_im"]))


def first_harmonic(times: np.ndarray, values: np.ndarray, frequency: float) -> complex:
    return 2 * np.mean(values * np.exp(-2j * np.pi * frequency * times))


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("frequency, acceleration", [(2.0, 0.5), (4.0, 4.0), (11.0, 8.0)])
def test_bench_agrees_with_a_step_by_step_bench_outside(pantograph, friction, frequency, acceleration):
    """The same sine through head_displacement, analysed from the outputs, at the same internal steps."""
    step = 1 / (frequency * np.ceil(1 / (frequency * 5e-4)))
    per_period = round(1 / (frequency * step))
    inside = bench_point(
        pantograph({"drive": "Bench", "friction": friction, "solver.step": 5e-4}), frequency, acceleration, settled=1e-7
    )
    amplitude = acceleration / (2 * np.pi * frequency) ** 2
    p = pantograph({"drive": "Displacement", "friction": friction, "solver.step": step})
    settle, periods = int(np.ceil(8 * frequency)), 4

    def imposed(t: float) -> float:
        ramp = min(1.0, t * frequency)
        return amplitude * (ramp**3 * (10 - 15 * ramp + 6 * ramp**2)) * np.sin(2 * np.pi * frequency * t)

    p.run(step, settle * per_period, [], targets={"head_displacement": imposed})
    z, force = p.run(step, periods * per_period, ["head.z", "contact.force"], targets={"head_displacement": imposed}).T
    times = settle / frequency + step * np.arange(1, len(z) + 1)
    outside = -first_harmonic(times, z, frequency) / first_harmonic(times, force, frequency)
    assert abs(outside / inside - 1) < 5e-3


def test_the_imposed_motion_is_the_sine_asked_for(pantograph):
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    p.step(5 / FREQUENCY)
    history = p.run(1 / (64 * FREQUENCY), 64, ["head.z", "head.v", "head.a"])
    times = np.arange(1, 65) / (64 * FREQUENCY)
    omega = 2 * np.pi * FREQUENCY
    harmonic = [abs(first_harmonic(times, column, FREQUENCY)) for column in history.T]
    np.testing.assert_allclose(harmonic, [ACCELERATION / omega**2, ACCELERATION / omega, ACCELERATION], rtol=1e-6)
    np.testing.assert_allclose(history[:, 2], -(omega**2) * history[:, 0], atol=1e-6 * ACCELERATION)


def test_the_motion_is_on_the_sine_at_every_step_from_the_end_of_the_ramp_on(pantograph):
    """At many frequencies: rounding puts the ramp's end before, on or behind the step that ends it."""
    for frequency in np.arange(2.0, 22.0, 0.25):
        p = pantograph({"drive": "Bench", "bench.frequency": frequency, "bench.acceleration": ACCELERATION})
        count = int(p["bench.steps_per_period"])
        step = 1 / (frequency * count)
        p.run(step, count - 1, [])
        rows = p.run(step, 3 * count, ["head.z"])[:, 0]
        sine = ACCELERATION / (2 * np.pi * frequency) ** 2 * np.sin(2 * np.pi * np.arange(3 * count) / count)
        np.testing.assert_allclose(rows, sine, rtol=0, atol=1e-12, err_msg=f"{frequency} Hz")


@pytest.mark.parametrize("frequency, acceleration", [(9.0, 2.0), (4.0, 8.0), (1.5, 0.3), (4.0, 0.0)])
def test_retuning_is_continuous_in_phase(pantograph, frequency, acceleration):
    """Position and velocity never jump: both follow from a bounded acceleration, from the very start."""
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    step, outputs = 2e-4, ["head.z", "head.v"]
    before = p.run(step, 6100, outputs)  # not a whole number of periods
    p.set({"bench.frequency": frequency, "bench.acceleration": acceleration})
    history = np.vstack([[0, 0], before, p.run(step, 6000, outputs)])
    # A ramp within one period adds its own slopes to the sine's acceleration, hence the factor.
    bound = 8 * max(ACCELERATION, acceleration) * max(1, FREQUENCY / frequency, frequency / FREQUENCY) ** 2
    assert np.max(np.abs(np.diff(history[:, 1]))) < bound * step
    assert np.max(np.abs(np.diff(history[:, 0]) - step * history[:-1, 1])) < bound * step**2


def test_communication_steps_do_not_shape_the_result(pantograph):
    """Points anywhere between the internal steps give the same receptance, within the integrator's error."""

    def receptance(communication_step: float) -> complex:
        p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
        for _ in range(int(np.ceil(10 / communication_step))):
            p.step(communication_step)
        return point(p)

    whole = receptance(1 / FREQUENCY)
    for step in (10 / FREQUENCY, 0.1, 0.0137, np.sqrt(2) / 10):
        assert abs(receptance(step) / whole - 1) < 2e-3
    assert abs(receptance(10 / FREQUENCY) / whole - 1) < 1e-6


def test_whole_periods_are_counted_from_the_end_of_the_ramp(pantograph):
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    counts = []
    for _ in range(6):
        p.step(1 / FREQUENCY)
        counts.append(p["bench.periods"])
    assert counts == [0, 1, 2, 3, 4, 5]
    p.step(1 / FREQUENCY - 1e-4)
    assert p["bench.periods"] == 5
    p.step(1e-4)
    assert p["bench.periods"] == 6
    p["bench.acceleration"] = 2 * ACCELERATION
    p.step(0.5 / FREQUENCY)
    assert p["bench.periods"] == 0
    p.step(10 / FREQUENCY)
    assert p["bench.periods"] in (9, 10)


def test_setting_the_same_value_again_does_not_start_over(pantograph):
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    p.step(5 / FREQUENCY)
    p["bench.acceleration"] = ACCELERATION
    p.step(1 / FREQUENCY)
    assert p["bench.periods"] == 5


def test_change_tells_when_the_steady_state_is_reached(pantograph):
    p = pantograph({"drive": "Bench", "bench.frequency": FREQUENCY, "bench.acceleration": ACCELERATION})
    assert p["bench.change"] == 1
    previous = None
    for _ in range(2, 20):
        p.step(1 / FREQUENCY)
        current = point(p)
        if p["bench.periods"] >= 2:
            assert p["bench.change"] == pytest.approx(abs(current - previous) / abs(current), rel=0.05)
        previous = current
    p.step(20.0)
    assert p["bench.change"] < 1e-7


def test_no_excitation_no_receptance(pantograph):
    p = pantograph({"drive": "Bench", "bench.acceleration": 0.0})
    p.step(2.0)
    assert point(p) == 0
    assert p["head.z"] == pytest.approx(0, abs=1e-12)


def test_other_drives_report_no_receptance(pantograph):
    p = pantograph({"drive": "Displacement"})
    p.step(1.0)
    assert point(p) == 0 and p["bench.periods"] == 0
