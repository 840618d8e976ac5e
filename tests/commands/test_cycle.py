"""What a point tells of one cycle beside H: loss, equivalent stiffness and damping, harmonics of the contact force."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from linear import PUBLISHED, LinearPantograph
from zspring.bench.measure import BENCHES, measure
from zspring.bench.points import FrfPoint, FrfSettings, sweeps
from zspring.fmu import Fmu
from zspring.frf.files import frf_columns, frf_point, frf_row


@pytest.fixture(scope="module")
def own_fmu():
    with Fmu() as fmu:
        yield fmu


def points(fmu: Fmu, amplitude: float, frequencies: tuple[float, ...], parameters=(), **settings) -> list[FrfPoint]:
    chosen = fmu.variables.parse_assignments([*parameters, "solver.step=0.0005"])
    wanted = FrfSettings((amplitude,), frequencies, chosen, **settings)
    return [point for point, _ in measure(fmu, wanted, sweeps(wanted), 1, threading.Event())]


@pytest.mark.parametrize("through", BENCHES)
def test_of_a_linear_pantograph_they_are_those_of_its_dynamic_stiffness(own_fmu, through):
    """Loss and damping keep their digits where inertia is nearly all of 1/H, of which they are a hundred thousandth."""
    values = dict(PUBLISHED["DSA-380"])
    exact = LinearPantograph(head=values.pop("k1"), **values)
    for point in points(own_fmu, 2.0, (2.0, 5.0, 8.0, 16.0), ["suspension=Linear"], through=through):
        stiffness = 1 / exact.receptance(point.frequency)
        omega = 2 * np.pi * point.frequency
        assert point.stiffness == pytest.approx(stiffness.real, rel=1e-3)
        rel = 0.1 if point.frequency > 10 else 2e-3
        assert point.damping == pytest.approx(stiffness.imag / omega, rel=rel)
        assert point.loss == pytest.approx(np.pi * (2.0 / omega**2) ** 2 * stiffness.imag, rel=rel)
        assert max(point.harmonics) < 1e-3 * point.force  # of an imposed motion that is told by its positions


@pytest.mark.parametrize("through", BENCHES)
@pytest.mark.parametrize("friction, amplitude, frequency", [("Regularized", 1.0, 6.0), ("Coulomb", 4.0, 4.9)])
def test_of_sliding_rods_they_are_those_of_a_record_of_the_contact_force(
    own_fmu, pantograph, through, friction, amplitude, frequency
):
    """By Fourier's integral and the area of the loop, from drive Displacement with an analytic sine."""
    (point,) = points(own_fmu, amplitude, (frequency,), [f"friction={friction}"], through=through, tolerance=1e-5)
    count = round(1 / (frequency * 2.5e-4))
    step, peak = 1 / (frequency * count), amplitude / (2 * np.pi * frequency) ** 2

    def imposed(t: float) -> float:
        ramp = min(1.0, t * frequency / 2)
        return peak * ramp**3 * (10 - 15 * ramp + 6 * ramp**2) * np.sin(2 * np.pi * frequency * t)

    p = pantograph({"drive": "Displacement", "friction": friction, "solver.step": step})
    p.run(step, 20 * count, [], targets={"head_displacement": imposed})
    z, force = p.run(step, count, ["head.z", "contact.force"], targets={"head_displacement": imposed}).T
    spectrum = 2 / count * np.abs(np.fft.rfft(force))
    assert point.force == pytest.approx(spectrum[1], rel=2e-3)
    np.testing.assert_allclose(point.harmonics, spectrum[2:8], atol=2e-3 * spectrum[1])
    assert spectrum[3] > 0.1 * spectrum[1]
    area = np.sum(-(force + np.roll(force, 1)) / 2 * (z - np.roll(z, 1)))  # the force pushes down
    assert point.loss == pytest.approx(area, rel=3e-3)


def test_the_row_of_a_point_tells_it_again():
    harmonics = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    point = FrfPoint(1.0, 4.0, "settled", 1e-4 - 2e-5j, 8, 1e-4, 10, 11, 1, 3, 1e-4, harmonics, 0.25)
    row = dict(zip(frf_columns("receptance"), map(str, frf_row(point, "receptance"))))
    assert frf_point(row) == point
    assert row["harmonic_3 [N]"] == "0.2" and row["loss [J]"] == "0.25"
    assert float(row["stiffness [N/m]"]) == pytest.approx((1 / point.H).real)
