"""Copies of the FMUs with other start values, names and types: what `zspring export` writes, run through fmpy."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import fmi2Error
from fmpy.validation import validate_fmu

from harness import Fmu as HarnessFmu
from harness import Instance, Message, callbacks_into
from zspring.errors import ZSpringError
from zspring.export import export as command
from zspring.exported_fmu import flat_names
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu


def export(folder: Path, *options: str) -> dict[str, Path]:
    command.main([str(folder), *options], standalone_mode=False)
    return {model: folder / f"{model}.fmu" for model in (PANTOGRAPH, CATENARY)}


@pytest.fixture(scope="module", params=[[], ["--plain"], ["--flat"]], ids=["as it is", "plain", "flat"])
def changed(request, tmp_path_factory) -> tuple[list[str], dict[str, Path]]:
    """The options, and copies with start values of their own."""
    given = ["--set", "drive=Wire", "--set", "zspring.Mf=0.5", "--set", "wire_height=0.001", "--set-line"]
    given += ["line.spans=4", "--set-line", "solver.energies=false", "--set-line", "pantograph[1].speed=60"]
    given += ["--set-line", "pantograph[1].force=100", "--set-line", "pantograph[1].start=30"]
    return request.param, export(tmp_path_factory.mktemp("export"), *given, *request.param)


def test_they_are_valid_and_begin_with_what_they_declare(changed, tmp_path):
    """Without a value set, as a tool may that trusts the model description."""
    for path in changed[1].values():
        assert validate_fmu(str(path)) == []
        fmu = HarnessFmu(path, Path(extract(str(path), unzipdir=str(tmp_path / path.stem))))
        p = Instance(fmu)
        try:
            for v in fmu.variables.values():
                if v.start is not None:
                    start = {"true": 1, "false": 0}.get(v.start, v.start)
                    assert float(p[v.name]) == float(start), v.name
        finally:
            p.close()


def run(path: Path, outputs: list[str], starts: Mapping[str, object] = {}) -> np.ndarray:
    result = simulate_fmu(str(path), stop_time=0.5, output_interval=1e-3, start_values=dict(starts), output=outputs)
    return np.column_stack([result[name] for name in outputs])


def test_they_give_what_the_packages_fmus_give_with_these_values(changed):
    options, paths = changed
    set_by_hand = {
        PANTOGRAPH: {"drive": 3, "zspring.Mf": 0.5, "wire_height": 0.001},
        CATENARY: {"line.spans": 4, "solver.energies": False, "pantograph[1].speed": 60.0, "pantograph[1].force": 100.0}
        | {"pantograph[1].start": 30.0},
    }
    outputs = {PANTOGRAPH: ["contact.force", "head.z"], CATENARY: ["pantograph[1].wire_height", "energy.work"]}
    for model, path in paths.items():
        with Fmu(installed_fmu(model)) as fmu:
            names = dict(zip((v.name for v in fmu.variables), flat_names(fmu))) if "--flat" in options else {}
        told = run(path, [names.get(name, name) for name in outputs[model]])
        np.testing.assert_array_equal(told, run(installed_fmu(model), outputs[model], set_by_hand[model]))
        assert np.ptp(told[:, 0]) > 0


def test_flat_names_are_identifiers_for_reals_alone(tmp_path):
    for path in export(tmp_path, "--flat").values():
        variables = read_model_description(str(path)).modelVariables
        assert {v.type for v in variables} == {"Real"} and all(v.name.isidentifier() for v in variables)
    with Fmu() as fmu:
        named = dict(zip((v.name for v in fmu.variables), flat_names(fmu)))
    assert named["zspring.Mf"] == "zspring_Mf"
    assert (named["contact_force"], named["contact.force"]) == ("contact_force", "contact_force_out")


def test_a_demo_moves_at_the_press_of_play(tmp_path):
    paths = export(tmp_path, "--demo")
    bench, line = (simulate_fmu(str(path)) for path in paths.values())
    assert bench["bench.periods"][-1] > 10 and bench["bench.change"][-1] < 1e-3
    assert np.ptp(bench["head.z"]) == pytest.approx(2 / (2 * np.pi * 5) ** 2, rel=1e-2)  # of 1 m/s2 at 5 Hz
    assert line["pantograph[1].x"][-1] == pytest.approx(30 + 7.5 * 69.44)
    assert 0.02 < line["point.uplift[1]"].max() < 0.2 and line["energy.work"][-1] > 0


def test_values_that_the_fmu_refuses_are_told_before_anything_is_written(tmp_path):
    with pytest.raises(ZSpringError, match="m1 = -1 kg: must be at least"):
        export(tmp_path, "--set", "m1=-1")
    assert list(tmp_path.iterdir()) == []


def bits(value: float) -> str:
    return struct.pack(">d", value).hex()


@pytest.mark.parametrize(
    "behind",
    [
        "x",
        " ",
        " real",
        " reals ",
        " 3",
        " 3=",
        " 3=zz",
        f" 3={bits(7.0)}0",
        f" 3={bits(7.0)[:-1]}",
        f" 3={bits(7.0).upper()}",
        f"  3={bits(7.0)}",
        f" -3={bits(7.0)}",
        f" 99999999999999999999={bits(7.0)}",
        f" 3={bits(-7.0)}",
        f" 3={bits(float('nan'))}",
        f" 0={bits(1.5)}",
        f" 60={bits(1.0)}",
        f" 3={bits(7.0)} reals",
    ],
)
def test_an_identity_that_no_export_writes_is_refused(fmu, behind):
    """m1 is variable 3, drive 0, and 60 an output."""
    variables = list(fmu.variables)
    assert (variables[0], variables[3], fmu.variables[variables[60]].causality) == ("drive", "m1", "output")
    log: list[Message] = []
    slave = fmu.slave()
    slave.guid += behind
    with pytest.raises(Exception, match="Failed to instantiate"):
        slave.instantiate(callbacks=callbacks_into(log), loggingOn=True)
    assert len(log) == 1 and log[0].status == fmi2Error
    assert any(part in log[0].text for part in ("fmuGUID", "m1 = ", "drive = 1.5: must be a whole number"))


def test_an_identity_with_start_values_survives_a_reset(fmu):
    slave = fmu.slave()
    references = [fmu.variables[name].valueReference for name in ("m1", "wire_height")]
    slave.guid += "".join(f" {reference}={bits(value)}" for reference, value in zip(references, (7.0, 0.01)))
    slave.instantiate(callbacks=callbacks_into([]), loggingOn=True)
    try:
        for _ in range(2):
            slave.setupExperiment()
            slave.enterInitializationMode()
            assert slave.getReal(references) == [7.0, 0.01]
            slave.setReal(references, [8.0, 0.0])
            slave.reset()
    finally:
        slave.freeInstance()
