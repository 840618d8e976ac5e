"""The example hosts in resources/examples: the C program compiled and run, the Modelica model parsed."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from pymoca import ast, parser

from paths import ROOT
from zspring.fmu import Fmu

EXAMPLES = ROOT / "resources" / "examples"


def compiler() -> list[str]:
    """Command of the C++ compiler that scripts/test has built the FMUs with, for C."""
    return [*shlex.split(json.loads(Path(sys.prefix, "stages.json").read_text())["compiler"]), "-x", "c"]


@pytest.fixture(scope="module")
def host(tmp_path_factory) -> Path:
    """The program of host.c."""
    program = tmp_path_factory.mktemp("host") / "host.exe"
    headers = Path(fmpy.__file__).with_name("c-code")
    libraries = [] if sys.platform in ("win32", "darwin") else ["-ldl", "-lm"]
    command = [*compiler(), "-Wall", "-Wextra", "-Werror", EXAMPLES / "host.c", f"-I{headers}", *libraries]
    subprocess.run([*command, "-o", program], check=True)
    return program


def test_the_c_host_couples_implicitly(host):
    """Height and force agree in every step, in few iterations; our driver finds the same forces."""
    source = (EXAMPLES / "host.c").read_text()
    step, stiffness = (float(re.search(rf"double {n} = (\S+);", source)[1]) for n in "HK")
    with Fmu() as fmu, fmu.instances() as (pantograph,):
        out = subprocess.run([host, fmu.folder], check=True, capture_output=True, text=True)
        time, height, force, iterations = np.loadtxt(out.stdout.splitlines(), delimiter=",", skiprows=1).T
        path = 0.02 * np.sin(2 * np.pi * time / 0.5) ** 3
        np.testing.assert_allclose(height, path + (force - 120) / stiffness, atol=2e-9)
        assert np.mean(iterations) < 2 and np.ptp(force) > 100 and out.stderr == ""

        pantograph.start({"drive": 3, "contact.c": 50.0})
        found = []
        for n, z in enumerate(height):
            pantograph.set({"wire_height": float(z)})
            pantograph.step(n * step, step)
            found += pantograph.get(["contact.force"])
    np.testing.assert_allclose(found, force, rtol=1e-12)


def test_the_c_host_says_what_it_misses(host, tmp_path):
    for arguments, named in (([], "usage"), ([tmp_path], "modelDescription.xml")):
        done = subprocess.run([host, *arguments], capture_output=True, text=True)
        assert done.returncode == 1 and named in done.stderr


def test_the_modelica_example_is_modelica_and_names_what_the_fmu_has():
    """Syntax only, as the class of the imported FMU is made by the tool that imports it."""
    text = (EXAMPLES / "PantographUnderWire.mo").read_text()
    model = parser.parse(text).classes["PantographUnderWire"]
    assert isinstance(model, ast.Class)
    assert model.symbols["pantograph"].type.name == "ZSpringPantograph_fmu"
    used = set(re.findall(r"\bpantograph\.([\w.]+)", text)) | {"contact_force"}
    with Fmu() as fmu:
        assert used <= {v.name for v in fmu.variables} and used >= {"head.z", "contact_force"}


def test_the_modelica_coupling_is_stable_at_its_communication_step():
    """The same loop in Python: the explicit force neither adds energy nor lets the head escape."""
    stiffness, step = 1 / (1 / 50000 + 1 / 3000), 1e-3
    with Fmu() as fmu, fmu.instances() as (pantograph,):
        pantograph.start({})
        heads, forces = [], []
        for n in range(4000):
            support = 0.02 * np.sin(2 * np.pi * n * step / 0.5) ** 3 if n < 2000 else 0.0
            (head,) = pantograph.get(["head.z"])
            force = max(0.0, 120 + stiffness * (head - support))
            pantograph.set({"contact_force": force})
            pantograph.step(n * step, step)
            heads.append(head)
            forces.append(force)
    assert np.ptp(heads[:2000]) > 0.02
    assert np.ptp(forces[3500:]) < 0.2 * np.ptp(forces[:2000])
