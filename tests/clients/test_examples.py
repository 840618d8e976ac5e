"""The example hosts in resources/examples: the C program compiled and run, the Modelica model parsed."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import fmpy
import numpy as np
import pytest
from pymoca import ast, parser

from paths import ROOT
from zspring.exported_fmu import Copy
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, Instance, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.schemes import Coupling
from zspring.line.system import System

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


def test_the_modelica_model_of_both_connects_them_as_if_solved_as_one(tmp_path):
    """Its modifications and equations, as parsed, carried out on flat FMUs side by side: against implicit coupling."""
    text = (EXAMPLES / "PantographUnderLine.mo").read_text()
    model = parser.parse(text).classes["PantographUnderLine"]
    assert isinstance(model, ast.Class)
    values = {name: float(value) for name, value in re.findall(r"parameter Real (\w+)\(.*?\) = ([\d.]+)", text)}
    values["speed"] /= 3.6
    step, speed = values["step"], values["speed"]
    assert (step, speed, values["staticForce"]) == (1e-3, 250 / 3.6, 120.0)
    equations = re.findall(r"^  (\w+)\.(\w+) = (?:(\w+)\.)?(\w+);$", text, re.MULTILINE)
    assert len(equations) == len(model.equations) == 5

    blocks: dict[str, Instance] = {}
    with ExitStack() as stack:
        for block, name in ("catenary", CATENARY), ("pantograph", PANTOGRAPH):
            with Fmu(installed_fmu(name)) as fmu:
                Copy(flat=True).write(fmu, tmp_path / f"{name}.fmu")
            flat = stack.enter_context(Fmu(tmp_path / f"{name}.fmu"))
            (blocks[block],) = stack.enter_context(flat.instances())
            (told,) = re.findall(rf"{name}_fmu {block}\((.*?)\);", text, re.DOTALL)
            given = {key: values.get(value) or float(value) for key, value in re.findall(r"(\w+) = (\w+)", told)}
            assert given.pop("fmi_CommunicationStepSize") == step
            blocks[block].start(
                given, {to: values[of] for at, to, source, of in equations if at == block and not source}
            )
        forces = []
        for n in range(1500):
            told = [(at, to, blocks[source].get([of])[0]) for at, to, source, of in equations if source]
            for at, to, value in told:
                blocks[at].set({to: value})
            for instance in blocks.values():
                instance.step(n * step, step)
            forces += blocks["pantograph"].get(["contact_force_out"])

    with Fmu(installed_fmu(CATENARY)) as wire, Fmu() as head:
        journey = Journey(speed, 60.0, 60.0 + 1.5 * speed + 0.01, step, start_up="direct")
        implicit = run_line(System(wire, head, {}, [{}], journey, Coupling("implicit")))
    np.testing.assert_allclose(forces, implicit.contact_force[1:, 0], rtol=0, atol=1e-5)
    assert np.ptp(forces) > 50
