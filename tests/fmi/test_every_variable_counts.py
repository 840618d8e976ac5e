"""No parameter without effect, no output in another unit than its name says."""

from __future__ import annotations

import re

import numpy as np
import pytest

from harness import Signal

WIRE = Signal.cubed_sines([0.01], [1.2])
FORCE = Signal.cubed_sines([60.0], [1.2], 120.0)
SCENES = {  # parameters, and the inputs that move it
    "wire": ({"drive": "Wire", "friction": "Regularized"}, {"wire_height": WIRE}),
    "force": ({"drive": "Force", "friction": "Coulomb"}, {"contact_force": FORCE}),
    "bench": ({"drive": "Bench", "bench.acceleration": 3.0}, {}),
    "linear": ({"drive": "Force", "suspension": "Linear"}, {"contact_force": FORCE}),
    "short of iterations": ({"drive": "Wire", "solver.tangent": "Exact", "zspring.tau": 1e5}, {"wire_height": WIRE}),
}
# What a parameter is changed to where a tenth more would not show, or is not allowed.
CHANGED = {
    "drive": "Displacement",
    "suspension": "LinearFree",
    "friction": "Free",
    "solver.tangent": "Mean",
    "solver.tolerance": 1e-3,
    "solver.max_iterations": 2,
    "solver.alpha": -0.1,
    "solver.step": 0.001,
    "c1": 10.0,
    "c2": 10.0,
    "contact.c": 50.0,
    "k3": 100.0,
}
UNITS = {
    r".*\.(z|x|uplift|(wire_|free_|messenger_|stitch_)?height|length)|support\.uplift|point\.dropper_position": "m",
    r".*\.compliance(_previous)?": "m/N",
    r".*(\.v|velocity)": "m/s",
    r".*\.a": "m/s2",
    r".*force(_min|_max)?": "N",
    r".*moment_(alpha|beta)": "N.m",
    r".*\.(alpha|beta)": "rad",
    r"energy\..*": "J",
    r"bench\.H_(re|im)": "m/N",
    r"bench\.change": "1",
    r"bench\.harmonic": "N",
}


def motion(pantograph, parameters: dict, inputs: dict) -> np.ndarray:
    p = pantograph(parameters)
    outputs = [name for name in p.fmu.names("output") if p.fmu.variables[name].type == "Real"]
    counters = ["solver.steps", "solver.iterations", "solver.refinements"]
    rows = p.run(0.01, 60, outputs, signals=inputs)
    return np.append(rows.ravel(), [p[name] for name in counters])


def test_every_parameter_has_an_effect(pantograph, fmu):
    usual = {name: motion(pantograph, *scene) for name, scene in SCENES.items()}
    without = []
    for name in fmu.names("parameter"):
        value = CHANGED.get(name)
        if value is None:
            value = 1.1 * float(fmu.variables[name].start) or 0.1
        for scene, (parameters, inputs) in SCENES.items():
            found = motion(pantograph, {**parameters, name: value}, inputs)
            if np.max(np.abs(found - usual[scene])) > 1e-9:
                break
        else:
            without.append(name)
    assert not without


@pytest.mark.parametrize("model_fmu", ["fmu", "fmu_catenary"])
def test_every_output_has_the_unit_that_its_name_says(model_fmu, request):
    fmu = request.getfixturevalue(model_fmu)
    for name in fmu.names("output"):
        variable = fmu.variables[name]
        if variable.type == "Real":
            known = [unit for rule, unit in UNITS.items() if re.fullmatch(rule, re.sub(r"\[\d+\]", "", name))]
            assert known, f"{name}: which unit? add a rule"
            assert (variable.unit or None) in known, f"{name} [{variable.unit}]"
