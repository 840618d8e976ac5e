"""Against the bench of the independent model: harmonics of the contact force, and the example of `zspring identify`."""

from __future__ import annotations

import numpy as np
import pytest

from harness import bench_point
from paths import ROOT
from reference import Reference
from reference_bench import SAMPLES, one_period, receptance

EXAMPLE = ROOT / "resources" / "examples" / "independent.csv"
MADE_WITH = {"zspring.k": 11500.0, "zspring.l0": 0.019, "zspring.Mf": 0.25, "static_force": 90.0}
NOISE = 0.01


@pytest.mark.parametrize("frequency, acceleration", [(3.0, 0.5), (12.0, 6.0)])
def test_a_point_of_the_example_is_that_of_the_independent_model(fmu, frequency, acceleration):
    parameters = {"drive": "Displacement", "suspension": "ZSpring", "friction": "Regularized"}
    reference = Reference(fmu, {**parameters, **MADE_WITH})
    columns = "real [m/N]", "imaginary [m/N]"
    rows = [line for line in EXAMPLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert rows[0].endswith(",".join(columns))
    found = {(f, a): re + 1j * im for f, a, re, im in (map(float, row.split(",")) for row in rows[1:])}
    assert abs(found[frequency, acceleration] / receptance(reference, frequency, acceleration) - 1) < 4 * NOISE


def test_harmonics_of_the_contact_force_are_those_of_the_independent_model(fmu, pantograph):
    """Rods that slide; errors of both integrators."""
    frequency, acceleration = 9.0, 3.0
    parameters = {"drive": "Displacement", "suspension": "ZSpring", "friction": "Regularized"}
    force = one_period(Reference(fmu, parameters), frequency, acceleration)["contact.force"]
    expected = 2 / SAMPLES * np.abs(np.fft.rfft(force))
    p = pantograph({"drive": "Bench", "solver.step": 5e-4})
    bench_point(p, frequency, acceleration, settled=1e-6)
    found = p.reals([f"bench.harmonic[{n}]" for n in range(2, 8)])
    np.testing.assert_allclose(found, expected[2:8], rtol=0, atol=2e-4 * expected[1])
