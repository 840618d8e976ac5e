"""Other people's tools in Java, fetched with Maven: the FMUs run to the same results as with our own driver,
communication step by communication step.
"""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path

import numpy as np
import pytest
from release_tools import TOOLS, fetch_jars, run_tool, tool

from client_runs import RUNS, Run
from zspring.exported_fmu import Copy
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu

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


def test_maestro_couples_both_fmus(maestro: Path, tmp_path):
    """Both step with what the other gave at the begin of the step; its start goes from the wire to the pantograph and
    back. It sets no inputs but those that are connected, so the speed is a start value of the copy.
    """
    step, count, speed = 1e-3, 600, "pantograph[1].speed"
    height, force, line_force = "pantograph[1].wire_height", "contact.force", "pantograph[1].force"
    line_parameters, drive = {"line.spans": 4, "pantograph[1].start": 60.0}, {"drive": 3}
    for model, starts in (CATENARY, {speed: 60.0}), (PANTOGRAPH, {}):
        with Fmu(installed_fmu(model)) as fmu:
            Copy(plain=True, starts=starts).write(fmu, tmp_path / f"{model}.fmu")
    line_name, head_name = "{line}.line.", "{head}.head."
    system = {
        "fmus": {"{line}": f"{CATENARY}.fmu", "{head}": f"{PANTOGRAPH}.fmu"},
        "connections": {head_name + force: [line_name + line_force], line_name + height: [head_name + "wire_height"]},
        "parameters": {
            **{line_name + name: value for name, value in line_parameters.items()},
            **{head_name + name: value for name, value in drive.items()},
        },
        "algorithm": {"type": "fixed-step", "size": step},
        "startTime": 0,
        "endTime": (count + 0.5) * step,  # it adds up the time
    }
    (tmp_path / "system.json").write_text(json.dumps(system))
    run_tool(
        *(tool("java"), f"-Djava.io.tmpdir={tmp_path}", "-cp", maestro / "*", "org.intocps.maestro.Main"),
        *("import", "-fsp", tmp_path, "-output", tmp_path, "--interpret", "sg1", "system.json"),
        folder=tmp_path,
    )
    with open(tmp_path / "outputs.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    found = np.array([[float(row[head_name + force]), float(row[line_name + height])] for row in rows])

    expected = []
    with Fmu(installed_fmu(CATENARY)) as wire, Fmu(installed_fmu(PANTOGRAPH)) as pantograph:
        with wire.instances() as (line,), pantograph.instances() as (head,):
            line.start(line_parameters, {speed: 60.0})
            head.start(drive, {"wire_height": line.get([height])[0]})
            line.start(line_parameters, {speed: 60.0, line_force: head.get([force])[0]})
            for n in range(count + 1):
                (f,), (h,) = head.get([force]), line.get([height])
                expected.append((f, h))
                line.set({line_force: f})
                head.set({"wire_height": h})
                line.step(n * step, step)
                head.step(n * step, step)
    assert np.sum(np.diff(expected, axis=0)[:, 0] != 0) > 300  # in contact for more than half of it
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)
