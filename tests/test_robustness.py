"""Any admissible parameters: a run is finite and physical, or refused or discarded with a reason."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy.fmi2 import fmi2Discard, fmi2OK

from harness import Fmu, Pantograph, refusal

CHOICES = {
    "drive": ["Force", "Displacement", "Wire", "Bench"],
    "suspension": ["ZSpring", "ZSpring", "Linear", "LinearLocked", "LinearFree"],
    "friction": ["Regularized", "Coulomb", "Locked", "Free"],
}


def random_parameters(fmu: Fmu, rng: np.random.Generator) -> dict:
    """Physical parameters at their start value, at their lower bound, or up to 100 times more or less."""
    parameters = {name: str(rng.choice(items)) for name, items in CHOICES.items()}
    for v in fmu.variables.values():
        own = v.causality == "parameter" and not v.name.startswith(("solver", "bench"))
        if own and v.type == "Real":
            kind, low = rng.random(), float(v.min)
            if kind < 0.1:
                parameters[v.name] = low
            elif kind < 0.5:
                parameters[v.name] = max(low, (float(v.start) or 10.0) * 100 ** rng.uniform(-1, 1))
    steps = {"solver.step": 10 ** rng.uniform(-4, -2), "bench.frequency": 10 ** rng.uniform(-1, 1.5)}
    return parameters | steps


def shake(p: Pantograph, rng: np.random.Generator) -> int:
    """30 communication steps of many sizes with inputs that jump; the first status that is not OK."""
    for _ in range(30):
        p["contact_force"] = p["static_force"] * rng.uniform(0.5, 1.5)
        p["head_displacement"] = p["wire_height"] = rng.uniform(-0.02, 0.02)
        p["uplift.head"] = rng.uniform(-20, 20)
        status = refusal(p.step, 10 ** rng.uniform(-3, -0.5))
        if status != fmi2OK:
            return status
        values = p.all_values()
        assert all(np.isfinite(value) for value in values.values())
        assert p["energy.dissipated"] >= 0 and p["energy.kinetic"] >= 0
        assert p["contact.force"] >= 0 or CHOICES["drive"][p["drive"] - 1] in ("Displacement", "Bench")
    return fmi2OK


@pytest.mark.parametrize("seed", range(100))
def test_random_parameters_and_jumping_inputs_never_give_nonsense(fmu, pantograph, seed):
    rng = np.random.default_rng(seed)
    p = pantograph(random_parameters(fmu, rng), initialize=False)
    if refusal(p.initialize) == fmi2OK:
        status = shake(p, rng)
        assert status in (fmi2OK, fmi2Discard)
        if status == fmi2OK:
            return
    reasons = [m for m in p.log if m.status != fmi2OK]
    assert len(reasons) == 1 and reasons[0].text
