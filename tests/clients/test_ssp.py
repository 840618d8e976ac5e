"""The SSP archive: valid by the schemas of SSP 1.0, and in Ecos the same as `zspring couple`."""

from __future__ import annotations

import ctypes
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy.ssp
import numpy as np
import pytest
from fmpy import read_model_description
from lxml import etree

from paths import ROOT
from ssp_archive import archive, check
from zspring.couple.ssp import LINE_ELEMENT, element_name
from zspring.fmu import PANTOGRAPH, installed_fmu
from zspring.line.result import LineResult

SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"
SCHEMA = {".ssd": "SystemStructureDescription.xsd", ".ssv": "SystemStructureParameterValues.xsd"}


@pytest.fixture(scope="module", params=[1, 2], ids=["one pantograph", "two pantographs"])
def exported(request, tmp_path_factory) -> Iterator[tuple[Path, LineResult]]:
    """An archive, and the run that it describes."""
    yield from archive(tmp_path_factory.mktemp("archives") / "line.ssp", request.param)


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


def test_the_archive_keeps_the_rules_of_omsimulator(exported):
    """Names are identifiers, connections have no transformation, its own master is annotated: docs/modelica.md."""
    path, result = exported
    root = etree.fromstring(members(path, ".ssd")["SystemStructure.ssd"])
    named = [
        element.get("name") for element in root.iter() if etree.QName(element).localname in ("System", "Component")
    ]
    assert all(name.isidentifier() for name in [root.get("name"), *named])
    assert not [element for element in root.iter() if etree.QName(element).localname == "LinearTransformation"]
    (master,) = (element for element in root.iter() if etree.QName(element).localname == "FixedStepMaster")
    annotation = next(a for a in master.iterancestors() if etree.QName(a).localname == "Annotation")
    assert annotation.get("type") == "org.openmodelica"
    assert etree.QName(annotation.getparent().getparent()).localname == "System"
    assert float(master.get("stepSize")) == result.time[1]


def test_ecos_runs_the_archive_to_the_same_result(exported):
    """Another tool's fixed-step algorithm, at every communication step, to the precision of files."""
    check_in_ecos(*exported)


def test_ecos_runs_a_line_of_a_file_whose_table_it_has_to_locate(tmp_path):
    for path, result in archive(tmp_path / "line.ssp", 1, ROOT / "resources/lines/stitched-synthetic.toml"):
        check_in_ecos(path, result)


def check_in_ecos(path: Path, result: LineResult) -> None:
    """ecospy has wheels for Linux and Windows on x86-64."""
    if sys.platform == "linux":  # ecospy links libtbb.so.12 and leaves it to the system; PyPI's tbb has it
        ctypes.CDLL(f"{sys.prefix}/lib/libtbb.so.12", ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation

    names = [f"{element_name(i)}::contact.force" for i in range(result.position.shape[1])]
    names += [f"{LINE_ELEMENT}::pantograph[{i + 1}].wire_height" for i in range(len(names))]
    rows = []
    with EcosSimulation(ssp_path=str(path), step_size=result.time[1]) as simulation:
        simulation.init(parameter_set="initialValues")
        for _ in result.time[1:]:
            simulation.step()
            rows.append([simulation.get_real(name) for name in names])
        simulation.terminate()
    check(np.array(rows), result)


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
                before, after = (archive.read(entry) for archive in (old, new))
                if entry != "modelDescription.xml":
                    assert before == after, entry
                    continue
                for a, b in zip(*(list(etree.fromstring(text).iter("*")) for text in (before, after)), strict=True):
                    assert (a.tag, a.attrib) == (b.tag, b.attrib) or (a.tag, b.tag) == ("Enumeration", "Integer")
        integers = {v.name: v for v in read_model_description(str(copy)).modelVariables if v.type == "Integer"}
        assert not [v for v in read_model_description(str(copy)).modelVariables if v.type == "Enumeration"]
        if copy.stem == PANTOGRAPH:
            assert (integers["drive"].min, integers["drive"].max, integers["drive"].start) == ("1", "4", "1")
