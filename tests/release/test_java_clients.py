"""Other people's tools in Java, fetched with Maven: the FMUs run to the same results as with our own driver,
communication step by communication step.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from release_tools import TOOLS, fetch_jars, run_tool, tool

from client_runs import RUNS, Run
from zspring.exported_fmu import Copy
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.schemes import Coupling
from zspring.line.system import System
from zspring.variables import Value

FMI4J = "0.38.0"
MAESTRO = "3.1.1"
COMMONS_IO = "2.15.1"  # Maestro asks for an older one, and for a commons-compress that needs at least this


@pytest.fixture(scope="session")
def fmi4j(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Class path of FMI4j and the compiled Fmi4jRun."""
    jars = fetch_jars(TOOLS / f"fmi4j-{FMI4J}", [("info.laht.fmi4j", "fmi-import", FMI4J)])
    classes = tmp_path_factory.mktemp("fmi4j")
    run_tool(tool("javac"), "-cp", jars / "*", "-d", classes, Path(__file__).with_name("Fmi4jRun.java"))
    return f"{classes}{os.pathsep}{jars / '*'}"


@pytest.fixture(scope="session")
def maestro() -> Path:
    """With group ids in the names of its jars: it has two that are called core."""
    jars = [("org.into-cps.maestro", "maestro", MAESTRO), ("commons-io", "commons-io", COMMONS_IO)]
    return fetch_jars(TOOLS / f"maestro-{MAESTRO}", jars, "-DincludeScope=runtime", "-Dmdep.prependGroupId=true")


@pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)
def test_fmi4j_simulates(fmi4j: str, run: Run, tmp_path):
    """Its library that Java calls is for x86-64 only, on Linux and Windows."""
    inputs, outputs = tmp_path / "inputs.csv", tmp_path / "outputs.csv"
    with open(inputs, "w", newline="") as file:
        csv.writer(file).writerows([[*run.inputs], *zip(*(values.tolist() for values in run.inputs.values()))])
    outputs.write_text(",".join(run.outputs) + "\n")
    run_tool(
        *(tool("java"), f"-Djava.io.tmpdir={tmp_path}", "-cp", fmi4j, "Fmi4jRun"),
        *(run.path, str(run.step), inputs, outputs),
        *(f"{name}={value}" for name, value in run.parameters.items()),
    )
    run.check(np.loadtxt(outputs, delimiter=",", skiprows=1))


LINE, HEAD = "{line}.line.", "{head}.head."  # Maestro's names of the two instances


def maestro_run(
    maestro: Path, folder: Path, starts: Mapping[str, Mapping[str, Value]], connections: Mapping[str, str], step: float
) -> list[dict[str, float]]:
    """Rows of 0.6 s of both FMUs, side by side; each copy begins with its `starts`, inputs too, which Maestro sets only
    where they are connected. It adds up the time.
    """
    for model in CATENARY, PANTOGRAPH:
        with Fmu(installed_fmu(model)) as fmu:
            Copy(plain=True, starts=starts[model]).write(fmu, folder / f"{model}.fmu")
    model = {
        "fmus": {"{line}": f"{CATENARY}.fmu", "{head}": f"{PANTOGRAPH}.fmu"},
        "connections": {source: [target] for source, target in connections.items()},
        "parameters": {},
        "algorithm": {"type": "fixed-step", "size": step},
        "startTime": 0,
        "endTime": 0.6 + 0.5 * step,
    }
    (folder / "model.json").write_text(json.dumps(model))
    run_tool(
        *(tool("java"), f"-Djava.io.tmpdir={folder}", "-cp", maestro / "*", "org.intocps.maestro.Main"),
        *("import", "-fsp", folder, "-output", folder, "--interpret", "sg1", "model.json"),
        folder=folder,
    )
    with open(folder / "outputs.csv", newline="") as file:
        return [
            {name: float(value) for name, value in row.items() if name in connections} for row in csv.DictReader(file)
        ]


def test_maestro_couples_both_fmus(maestro: Path, tmp_path):
    """By last values; its start goes from the wire to the pantograph and back."""
    step, speed = 1e-3, "pantograph[1].speed"
    height, force, line_force = "pantograph[1].wire_height", "contact.force", "pantograph[1].force"
    line_parameters, drive = {"line.spans": 4, "pantograph[1].start": 60.0}, {"drive": 3}
    starts = {CATENARY: {**line_parameters, speed: 60.0}, PANTOGRAPH: drive}
    connections = {HEAD + force: LINE + line_force, LINE + height: HEAD + "wire_height"}
    rows = maestro_run(maestro, tmp_path, starts, connections, step)
    found = np.array([[row[HEAD + force], row[LINE + height]] for row in rows])

    expected = []
    with Fmu(installed_fmu(CATENARY)) as wire, Fmu(installed_fmu(PANTOGRAPH)) as pantograph:
        with wire.instances() as (line,), pantograph.instances() as (head,):
            line.start(line_parameters, {speed: 60.0})
            head.start(drive, {"wire_height": line.get([height])[0]})
            line.start(line_parameters, {speed: 60.0, line_force: head.get([force])[0]})
            for n in range(len(rows)):
                (f,), (h,) = head.get([force]), line.get([height])
                expected.append((f, h))
                line.set({line_force: f})
                head.set({"wire_height": h})
                line.step(n * step, step)
                head.step(n * step, step)
    assert np.sum(np.diff(expected, axis=0)[:, 0] != 0) > 300  # in contact for more than half of it
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)


def test_maestro_with_the_affine_map_gives_what_implicit_coupling_gives(maestro: Path, tmp_path):
    step, speed = 1e-3, 250 / 3.6
    line = {"exchange": 3, "exchange.step": step, "pantograph[1].static_force": 120.0, "pantograph[1].start": 60.0}
    starts = {CATENARY: {**line, "pantograph[1].speed": speed}, PANTOGRAPH: {"drive": 3}}
    wires = {"free_height": "wire_height"} | {name: f"wire.{name}" for name in ("compliance", "compliance_previous")}
    connections = {f"{LINE}pantograph[1].{name}": HEAD + target for name, target in wires.items()}
    connections[HEAD + "contact.force"] = LINE + "pantograph[1].force"
    rows = maestro_run(maestro, tmp_path, starts, connections, step)
    with Fmu(installed_fmu(CATENARY)) as wire, Fmu() as head:
        journey = Journey(speed, 60.0, 60.0 + 0.6005 * speed, step, start_up="direct")
        implicit = run_line(System(wire, head, {}, [{}], journey, Coupling("implicit")))
    found = [row[HEAD + "contact.force"] for row in rows]
    np.testing.assert_allclose(found, implicit.contact_force[: len(rows), 0], rtol=0, atol=1e-5)
    assert np.ptp(found) > 50
