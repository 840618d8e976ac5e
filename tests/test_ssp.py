"""The SSP archive: valid by the schemas of SSP 1.0, and in libcosim the same as `zspring couple`."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy.ssp
import numpy as np
import pytest
from fmpy import read_model_description
from lxml import etree
from zspring.couple.journey import Journey
from zspring.couple.result import LineResult
from zspring.couple.run import LineRun
from zspring.couple.schemes import Coupling
from zspring.couple.ssp import LINE_ELEMENT, element_name, write_ssp
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu

SPEED = 250 / 3.6
LINE = {"line.spans": 4, "steady_arm.mass": 0.5, "damping.mass": 0.0125, "contact_wire.tension": 22000.0}
COULOMB = {"friction": 2, "static_force": 100.0}
SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"
SCHEMA = {".ssd": "SystemStructureDescription.xsd", ".ssv": "SystemStructureParameterValues.xsd"}


@pytest.fixture(scope="module", params=[1, 2], ids=["one pantograph", "two pantographs"])
def exported(request, tmp_path_factory) -> Iterator[tuple[Path, LineResult]]:
    """An archive, and the run that it describes."""
    count = request.param
    path = tmp_path_factory.mktemp("archives") / "line.ssp"
    journey = Journey(SPEED, 90.0, 150.0, 2e-3, 50.0, start_up="direct", uplift=15.0)
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        with LineRun(catenary, pantograph, LINE, [COULOMB] * count, journey, Coupling("jacobi")) as run:
            write_ssp(run, path)
            run.finish()
            yield path, run.result()


def members(path: Path, *suffixes: str) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if Path(name).suffix in suffixes}


def test_every_file_is_valid_by_the_schema_of_ssp(exported):
    path, result = exported
    files = members(path, ".ssd", ".ssv")
    assert len(files) == 2 + result.position.shape[1]
    for name, content in files.items():
        schema = etree.XMLSchema(etree.parse(str(SCHEMAS / SCHEMA[Path(name).suffix])))
        schema.assertValid(etree.fromstring(content))


def test_libcosim_runs_the_archive_to_the_same_result(exported):
    """Another tool's fixed-step algorithm, at every communication step, to rounding: sums in another order.

    libcosimpy has wheels for Linux and Windows on x86-64.
    """
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    path, result = exported
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(str(path))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)

    def reader(element: str, names: list[str]):
        index = execution.slave_index_from_instance_name(element)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        return lambda: observer.last_real_values(index, [references[name] for name in names])

    count = result.position.shape[1]
    force = [reader(element_name(i), ["contact.force"]) for i in range(count)]
    heights = reader(LINE_ELEMENT, [f"pantograph[{i + 1}].wire_height" for i in range(count)])
    rows = []
    for _ in result.time[1:]:
        execution.step()
        rows.append([*(read()[0] for read in force), *heights()])
    assert execution.status().current_time == round(1e9 * result.time[-1])  # ns
    found = np.array(rows)
    assert np.ptp(result.contact_force[:, -1]) > 50
    assert found[:, :count] == pytest.approx(result.contact_force[1:], abs=1e-6)
    assert found[:, count:] == pytest.approx(result.wire_height[1:], abs=1e-10)


def test_the_fmus_inside_differ_in_the_type_of_enumerations_alone(exported, tmp_path):
    """So that tools without enumerations can set drive and suspension."""
    path, _ = exported
    for name, content in members(path, ".fmu").items():
        copy = tmp_path / Path(name).name
        copy.write_bytes(content)
        read_model_description(str(copy), validate=True)
        with zipfile.ZipFile(copy) as new, zipfile.ZipFile(installed_fmu(copy.stem)) as old:
            assert new.namelist() == old.namelist()
            for entry in old.namelist():
                before, after = (archive.read(entry).split(b"\n") for archive in (old, new))
                assert len(before) == len(after)
                for a, b in zip(before, after):
                    assert a == b or (b"<Enumeration " in a and b"<Integer " in b)
        integers = {
            v.name: v for v in read_model_description(str(copy)).modelVariables if v.type == "Integer"
        }
        assert not [v for v in read_model_description(str(copy)).modelVariables if v.type == "Enumeration"]
        if copy.stem == PANTOGRAPH:
            assert (integers["drive"].min, integers["drive"].max, integers["drive"].start) == ("1", "4", "1")
