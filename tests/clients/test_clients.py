"""Other people's tools that are quick to install: they check the FMUs, and run them to the same results as our own
driver, communication step by communication step. More of them in release/test_more_clients.py.
"""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from pathsim import Connection, Simulation
from pathsim.blocks import Scope, Source
from pathsim_fmi import CoSimulationFMU

from client_runs import RUNS, Run
from zspring import export
from zspring.errors import ZSpringError
from zspring.exported_fmu import Copy, flat_names
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu

each_run = pytest.mark.parametrize("run", RUNS.values(), ids=RUNS)


@each_run
def test_fmpy_simulates(run: Run):
    names = list(run.inputs)
    table = np.zeros(len(run.time) + 1, dtype=[("time", float)] + [(name, float) for name in names])
    table["time"] = run.step * np.arange(len(table))
    for name in names:
        table[name][:-1] = run.inputs[name]
    result = simulate_fmu(
        run.path,
        stop_time=len(run.time) * run.step,
        step_size=run.step,
        output_interval=run.step,
        start_values=dict(run.parameters),
        input=table,
        output=list(run.outputs),
    )
    run.check(np.column_stack([result[name][1:] for name in run.outputs]))


def fmutool(*arguments: str) -> str:
    """Output of the command of fmu-manipulation-toolbox."""
    command = [Path(sys.executable).with_name("fmutool"), *arguments]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_fmutool_finds_nothing_to_complain_of(any_fmu):
    said = fmutool("-input", str(any_fmu.path), "-check")
    assert "compliant with FMI-2.0" in said and "No semantic error" in said
    assert "WARNING" not in said and "ERROR" not in said


def exported(run: Run, how: str, folder: Path) -> str:
    """A copy of an FMU for tools that cannot set enumerations."""
    subprocess.run([Path(sys.executable).with_name("zspring"), "export", how, folder], check=True)
    return str(folder / f"{run.model}.fmu")


@each_run
def test_pathsim_simulates(run: Run, tmp_path):
    """A block diagram in Python: a source for each input, a scope on the outputs.

    pathsim-fmi cannot set enumerations and reads all outputs as Reals.
    """
    path = exported(run, "--flat", tmp_path)
    with Fmu(installed_fmu(run.model)) as fmu:
        flat = dict(zip((v.name for v in fmu.variables), flat_names(fmu)))
    parameters = {flat[name]: float(value) for name, value in run.parameters.items()}
    block = CoSimulationFMU(path, start_values=parameters, dt=run.step)
    scope = Scope()
    blocks, connections = [block, scope], []
    for name, values in run.inputs.items():
        source = Source(lambda t, values=values: values[min(round(t / run.step), len(values) - 1)])
        blocks.append(source)
        connections.append(Connection(source, block[flat[name]]))
    for n, name in enumerate(run.outputs):
        connections.append(Connection(block[flat[name]], scope[n]))
    simulation = Simulation(blocks, connections, dt=run.step, log=False)
    simulation.run((len(run.time) - 1) * run.step)
    _, columns = scope.read()
    run.check(np.array(columns).T)


@each_run
def test_ecos_simulates(run: Run, tmp_path):
    """Ecos through ecospy; it cannot set enumerations. Wheels for x86-64 only."""
    if sys.platform == "linux":  # ecospy links libtbb.so.12 and leaves it to the system; PyPI's tbb has it
        ctypes.CDLL(f"{sys.prefix}/lib/libtbb.so.12", ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    rows = []
    with EcosSimulationStructure() as structure:
        structure.add_model("model", exported(run, "--plain", tmp_path))
        structure.add_parameter_set("start", {f"model::{k}": value for k, value in run.parameters.items()})
        with EcosSimulation(structure=structure, step_size=run.step) as simulation:
            simulation.init(parameter_set="start")
            for values in zip(*run.inputs.values()):
                for name, value in zip(run.inputs, values):
                    simulation.set_real(f"model::{name}", float(value))
                simulation.step()
                rows.append([simulation.get_real(f"model::{name}") for name in run.outputs])
            simulation.terminate()
    run.check(np.array(rows))


@pytest.mark.parametrize("options", [[], ["--plain"]])
def test_the_package_is_never_exported_into_itself(tmp_path, monkeypatch, options):
    """The package's FMUs in a folder of the test's, as copies."""
    for model in (PANTOGRAPH, CATENARY):
        shutil.copy(installed_fmu(model), tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    monkeypatch.setattr(export, "installed_fmu", lambda model: tmp_path / f"{model}.fmu")
    told = f"FOLDER {re.escape(str(tmp_path))}: .*the package's own .*; give another folder"
    with pytest.raises(ZSpringError, match=told):
        export.export.main([*options, str(tmp_path)], standalone_mode=False)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_an_export_that_fails_keeps_the_file_there(tmp_path, monkeypatch):
    def fail(copy: Copy, fmu: Fmu, path: Path) -> None:
        path.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(Copy, "write", fail)
    (tmp_path / "ZSpringPantograph.fmu").write_bytes(b"whole")
    with pytest.raises(OSError, match="disk full"):
        export.export.main(["--plain", str(tmp_path)], standalone_mode=False)
    (kept,) = tmp_path.iterdir()
    assert kept.name == "ZSpringPantograph.fmu" and kept.read_bytes() == b"whole"


def test_exported_fmus_are_those_of_the_package(tmp_path):
    command = [Path(sys.executable).with_name("zspring"), "export", tmp_path / "new" / "folder"]
    subprocess.run(command, check=True)
    copies = sorted((tmp_path / "new" / "folder").iterdir())
    assert [copy.name for copy in copies] == ["Catenary.fmu", "ZSpringPantograph.fmu"]
    for copy in copies:
        assert copy.read_bytes() == installed_fmu(copy.stem).read_bytes()
