"""The example of `zspring identify` that does not come from its own model is what its head says."""

from __future__ import annotations

import pytest

from paths import ROOT
from reference import Reference
from reference_bench import receptance

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
