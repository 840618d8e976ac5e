"""Other people's tools that need more than Python: Java with Maven, Rust with cargo, libraries of the system.

VDMCheck2 checks the model descriptions; the others run the FMUs to the same results as our own driver,
communication step by communication step.
"""

from __future__ import annotations

import csv
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from release_tools import TOOLS, fetch_jars, run_tool, tool

from client_runs import RUNS, Run
from zspring.exported_fmu import Copy, flat_names
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.schemes import Coupling
from zspring.line.system import System

each_run = pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)

VDMCHECK = "1.1.3"
FMI_SIM = "0.7.0"


@pytest.fixture(scope="session")
def vdmcheck() -> Path:
    """Folder with VDMCheck2 and what it needs, laid out as it wants."""
    folder = TOOLS / f"vdmcheck2-{VDMCHECK}"
    if not (folder / "fmi2-rule-model").is_dir():
        fetch_jars(folder, [("org.into-cps.vdmcheck.fmi2", "vdmcheck2", VDMCHECK)], "-Dmdep.stripVersion=true")
        for jar in "vdmcheck2.jar", "static-model.jar", "rule-model.jar":  # the last one last: see above
            with zipfile.ZipFile(folder / jar) as archive:
                archive.extractall(folder)
    return folder


def vdmchecked(folder: Path, file: Path) -> str:
    command = [tool("java"), "-cp", "vdmcheck2.jar", "VDMCheckPlus", file]
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.stdout


def test_vdmcheck_finds_no_error(vdmcheck, any_fmu):
    assert vdmchecked(vdmcheck, any_fmu.path).strip() == "No errors found."


def test_vdmcheck_would_find_one(vdmcheck, any_fmu, tmp_path):
    bad = tmp_path / "bad.fmu"
    with zipfile.ZipFile(any_fmu.path) as old, zipfile.ZipFile(bad, "w") as new:
        text = old.read("modelDescription.xml").decode()
        text = text.replace('causality="input"', 'causality="input" initial="exact"')
        new.writestr("modelDescription.xml", text)
    assert "validVariableAttributes" in vdmchecked(vdmcheck, bad)


@pytest.fixture(scope="session")
def fmi_sim() -> Path:
    """The program fmi-sim of the crate of that name; compiled once, in five to ten minutes."""
    folder = TOOLS / f"fmi-sim-{FMI_SIM}"
    program = folder / "bin" / ("fmi-sim.exe" if sys.platform == "win32" else "fmi-sim")
    if not program.exists():
        run_tool(
            *(tool("cargo"), "install", "--quiet", "--locked"), *("fmi-sim", "--version", FMI_SIM, "--root", folder)
        )
    return program


@each_run
def test_fmi_sim_simulates(fmi_sim: Path, run: Run, tmp_path):
    given, written = tmp_path / "inputs.csv", tmp_path / "outputs.csv"
    with open(given, "w", newline="") as file:
        csv.writer(file).writerows([["time", *run.inputs], *zip(run.time, *run.inputs.values())])
    starts = [text for name, value in run.parameters.items() for text in ("--init-values", f"{name}={value}")]
    run_tool(
        *(fmi_sim, "--model", run.path, "-i", given, "-o", written, "co-simulation", *starts),
        *("--step", str(run.step), "--output-interval", str(run.step), "-f", str(len(run.time) * run.step)),
    )
    with open(written, newline="") as file:
        rows = list(csv.DictReader(file))[1:]
    run.check(np.array([[float(row[name]) for name in run.outputs] for row in rows]))


# In a process of its own: JAX starts threads that other tests would fork with.
JAXONOMY = """import sys
import jax.numpy as jnp
import numpy as np
from jaxonomy import DiagramBuilder, SimulatorOptions, library as blocks, simulate
step, given = float(sys.argv[2]), np.load("inputs.npy")
parameters = {name: float(value) for name, value in (text.split("=") for text in sys.argv[4:])}
diagram, outputs = DiagramBuilder(), sys.argv[3].split(",")
names = dict(input_names=list(given.dtype.names), output_names=outputs)
block = diagram.add(blocks.ModelicaFMU(sys.argv[1], step, parameters=parameters, first_step_at_zero=True, **names))
for n, name in enumerate(given.dtype.names):
    table = jnp.asarray(given[name])
    lookup = lambda t, table=table: table[jnp.round(t / step).astype(int)]
    source = diagram.add(blocks.SourceBlock(lookup, name=f"input_{n}"))
    diagram.connect(source.output_ports[0], block.input_ports[n])
system, count = diagram.build(), len(given) - 1
signals = dict(zip(outputs, block.output_ports))
options = SimulatorOptions(max_major_steps=10 * count, max_major_step_length=step)
context = system.create_context()
result = simulate(system, context, (0.0, count * step), options=options, recorded_signals=signals)
np.testing.assert_allclose(result.time, step * np.arange(count + 1), atol=1e-9)
np.save("outputs.npy", np.column_stack([result.outputs[name] for name in outputs]))
"""


@each_run
def test_jaxonomy_simulates(run: Run, tmp_path):
    """A block diagram that JAX compiles; names of outputs must be Python's identifiers. Needs Python 3.11."""
    with Fmu(installed_fmu(run.model)) as fmu:
        Copy(flat=True).write(fmu, tmp_path / "model.fmu")
        flat = dict(zip((v.name for v in fmu.variables), flat_names(fmu)))
    table = np.zeros(len(run.time) + 1, dtype=[(flat[name], float) for name in run.inputs])
    for name, values in run.inputs.items():
        table[flat[name]][:-1] = values
    np.save(tmp_path / "inputs.npy", table)
    outputs = ",".join(flat[name] for name in run.outputs)
    parameters = (f"{flat[name]}={value}" for name, value in run.parameters.items())
    run_tool(*(sys.executable, "-c", JAXONOMY, "model.fmu", str(run.step), outputs, *parameters), folder=tmp_path)
    run.check(np.load(tmp_path / "outputs.npy")[1:])


@each_run
def test_libcosim_simulates(run: Run, tmp_path):
    """The engine of the Open Simulation Platform; it cannot set enumerations. Wheels for x86-64."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    path = tmp_path / "model.fmu"
    with Fmu(installed_fmu(run.model)) as fmu:
        Copy(plain=True).write(fmu, path)
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(round(run.step * 1e9))
    slave = CosimLocalSlave(fmu_path=str(path), instance_name="model")
    index = execution.add_local_slave(slave)
    references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    for name, value in run.parameters.items():
        setter = execution.real_initial_value if isinstance(value, float) else execution.integer_initial_value
        assert setter(index, references[name], value)
    manipulator, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    inputs, outputs = ([references[name] for name in names] for names in (run.inputs, run.outputs))
    rows = []
    for values in zip(*run.inputs.values()):
        manipulator.slave_real_values(index, inputs, [float(value) for value in values])
        execution.step()  # in versions for Python 3.10 it returns False whatever happens
        rows.append(observer.last_real_values(index, outputs))
    assert execution.status().current_time == round(run.step * 1e9) * len(run.time)
    run.check(np.array(rows))


CONTAINER = """rule;from_fmu;from_port;to_fmu;to_port
FMU;Catenary.fmu;;;
FMU;ZSpringPantograph.fmu;;;
LINK;ZSpringPantograph.fmu;contact.force;Catenary.fmu;pantograph[1].force
INPUT;;speed;Catenary.fmu;pantograph[1].speed
OUTPUT;ZSpringPantograph.fmu;contact.force;;force
OUTPUT;Catenary.fmu;pantograph[1].wire_height;;height
START;Catenary.fmu;pantograph[1].start;60.0;
START;ZSpringPantograph.fmu;drive;3;
"""
LAST_VALUES = """LINK;Catenary.fmu;pantograph[1].wire_height;ZSpringPantograph.fmu;wire_height
START;Catenary.fmu;line.spans;4;
"""
AFFINE_MAP = """LINK;Catenary.fmu;pantograph[1].free_height;ZSpringPantograph.fmu;wire_height
LINK;Catenary.fmu;pantograph[1].compliance;ZSpringPantograph.fmu;wire.compliance
LINK;Catenary.fmu;pantograph[1].compliance_previous;ZSpringPantograph.fmu;wire.compliance_previous
START;Catenary.fmu;exchange;3;
START;Catenary.fmu;exchange.step;0.001;
START;Catenary.fmu;pantograph[1].static_force;120.0;
"""
# In a process of its own: what other tests have loaded into this one is no business of the container.
SIMULATE = """import sys
import numpy as np
from fmpy import simulate_fmu
table, step = np.load("speed.npy"), float(sys.argv[1])
options = dict(stop_time=table["time"][-1], step_size=step, output_interval=step, input=table)
np.save("result.npy", simulate_fmu("line.fmu", **options))
"""


def container_run(rules: str, speed: np.ndarray, step: float, folder: Path) -> np.ndarray:
    """Force and height, (n, 2), at the end of n steps at these speeds in m/s, in a container made by these rules."""
    for model in PANTOGRAPH, CATENARY:
        shutil.copy(installed_fmu(model), folder)
    (folder / "line.csv").write_text(rules)
    command = [Path(sys.executable).with_name("fmucontainer"), "-fmu-directory", folder]
    run_tool(*command, "-container", f"line.csv:{step}", "-no-auto-input", "-no-auto-output", folder=folder)
    table = np.zeros(len(speed) + 1, dtype=[("time", float), ("speed", float)])
    table["time"], table["speed"][:-1] = step * np.arange(len(table)), speed
    np.save(folder / "speed.npy", table)
    run_tool(sys.executable, "-c", SIMULATE, str(step), folder=folder)
    result = np.load(folder / "result.npy")
    return np.column_stack([result["force"], result["height"]])[1:]


def test_fmucontainer_couples_both_fmus_into_one(tmp_path):
    """The container's parallel mode: both step with what the other gave at the begin of the step."""
    step, speed = 1e-3, np.minimum(60.0, np.arange(600.0))
    found = container_run(CONTAINER + LAST_VALUES, speed, step, tmp_path)

    expected = []
    with Fmu(installed_fmu(CATENARY)) as wire, Fmu(installed_fmu(PANTOGRAPH)) as head:
        with wire.instances() as (line,), head.instances() as (pantograph,):
            line.start({"line.spans": 4, "pantograph[1].start": 60.0})
            (height,) = line.get(["pantograph[1].wire_height"])
            pantograph.start({"drive": 3}, {"wire_height": height})
            (force,) = pantograph.get(["contact.force"])
            for n, v in enumerate(speed):
                line.set({"pantograph[1].force": force, "pantograph[1].speed": float(v)})
                pantograph.set({"wire_height": height})
                line.step(n * step, step)
                pantograph.step(n * step, step)
                (height,), (force,) = line.get(["pantograph[1].wire_height"]), pantograph.get(["contact.force"])
                expected.append((force, height))
    assert np.ptp(expected, axis=0) == pytest.approx([np.ptp(found[:, 0]), np.ptp(found[:, 1])])
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)


def test_fmucontainer_with_the_affine_map_gives_what_implicit_coupling_gives(tmp_path):
    """That of zspring couple, with states taken back; no force is set for the start."""
    step, speed = 1e-3, 250 / 3.6
    found = container_run(CONTAINER + AFFINE_MAP, np.full(2000, speed), step, tmp_path)
    with Fmu(installed_fmu(CATENARY)) as wire, Fmu() as head:
        journey = Journey(speed, 60.0, 60.0 + 2.001 * speed, step, start_up="direct")
        implicit = run_line(System(wire, head, {}, [{}], journey, Coupling("implicit")))
    np.testing.assert_allclose(found[:, 0], implicit.contact_force[1:2001, 0], rtol=0, atol=1e-5)
    assert np.ptp(found[:, 0]) > 50
