"""modelDescription.xml: valid, true to the library, and with sound bounds, units and start values."""

from __future__ import annotations

import zipfile

import pytest
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu


def test_the_model_description_is_valid(fmu):
    """FMI's XML schema, and fmpy's checks of names, structure, start values, units, variability."""
    assert validate_fmu(str(fmu.path)) == []
    read_model_description(
        str(fmu.path), validate=True, validate_variable_names=True, validate_model_structure=True
    )


def test_every_start_value_lies_within_its_bounds(fmu):
    for v in fmu.description.modelVariables:
        low, high = (float(b) if b is not None else None for b in (v.min, v.max))
        if low is not None and high is not None:
            assert low < high, v.name
        if v.start is not None:
            assert low is None or low <= float(v.start), v.name
            assert high is None or float(v.start) <= high, v.name
        if v.type == "Enumeration":
            assert int(v.start) in [int(item.value) for item in v.declaredType.items], v.name


def test_every_parameter_and_input_starts_with_the_value_of_the_description(fmu, pantograph):
    p = pantograph(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    for name in fmu.names("parameter") + fmu.names("input"):
        assert p[name] == fmu.start(name), name


def test_every_real_variable_has_a_defined_unit_and_every_variable_a_description(fmu):
    units = {unit.name for unit in fmu.description.unitDefinitions}
    for v in fmu.description.modelVariables:
        assert v.description, v.name
        if v.type == "Real":
            assert v.unit in units, v.name


def test_synthetic_parameters_say_so(fmu):
    for v in fmu.description.modelVariables:
        if v.name.startswith("zspring.") and v.causality == "parameter" and v.name != "zspring.tau":
            assert "synthetic" in v.description, v.name


def test_value_references_and_names_are_unique(fmu):
    variables = fmu.description.modelVariables
    assert len({v.valueReference for v in variables}) == len({v.name for v in variables}) == len(variables)


def test_no_output_is_undefined_after_initialization(fmu, pantograph):
    """Every variable can be read in Initialization Mode and after it, and is a finite number."""
    p = pantograph(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    in_initialization = p.all_values()
    p.slave.exitInitializationMode()
    assert in_initialization == p.all_values()
    assert all(abs(value) < 1e9 for value in in_initialization.values())


@pytest.mark.parametrize("drive", ["Force", "Displacement", "Wire", "Bench"])
def test_declared_output_dependencies_hold(fmu, pantograph, drive):
    """No direct feedthrough: an input set after a step changes no output until the next step."""
    p = pantograph({"drive": drive})
    p.step(0.01)
    before = {name: p[name] for name in fmu.names("output")}
    for name, value in zip(fmu.names("input"), (100.0, 0.001, 0.001, 5.0, 5.0, 5.0)):
        p[name] = value
    assert {name: p[name] for name in fmu.names("output")} == before


def test_the_archive_is_one_that_every_host_can_read(fmu):
    """FMI 2.0, section 2.3: stored or deflated, no backslashes; licences, icon, documentation inside."""
    with zipfile.ZipFile(fmu.path) as archive:
        for member in archive.infolist():
            assert member.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert member.extract_version <= 20
            assert "\\" not in member.filename and not member.filename.startswith("/")
        names = archive.namelist()
        assert archive.testzip() is None
    for required in ("modelDescription.xml", "model.png", "documentation/index.html"):
        assert required in names
    assert any(name.startswith("documentation/licenses/license.") for name in names)
