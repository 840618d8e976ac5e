"""modelDescription.xml and archive of both FMUs: valid, true to the library, and what no checker looks at: sound
bounds and start values, flags that agree with each other and the code, dependencies that hold.
"""

from __future__ import annotations

import stat
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Error, fmi2OK
from fmpy.model_description import ScalarVariable, read_model_description
from fmpy.validation import validate_fmu

from harness import Fmu, Value, refusal
from models import each_case
from paths import ROOT

SOURCES = {"ZSpringPantograph": "modelDescription.xml", "Catenary": "modelDescription.catenary.xml"}


def xml(fmu: Fmu) -> ElementTree.Element:
    return ElementTree.parse(fmu.folder / "modelDescription.xml").getroot()


def test_the_model_description_is_valid(any_fmu):
    """FMI's XML schema, and fmpy's checks of names, structure, start values, units, variability."""
    assert validate_fmu(str(any_fmu.path)) == []
    read_model_description(
        str(any_fmu.path), validate=True, validate_variable_names=True, validate_model_structure=True
    )


def test_every_start_value_lies_within_its_bounds(any_fmu):
    for v in any_fmu.description.modelVariables:
        low, high = (float(b) if b is not None else None for b in (v.min, v.max))
        if low is not None and high is not None:
            assert low < high, v.name
        if v.start is not None:
            assert low is None or low <= float(v.start), v.name
            assert high is None or float(v.start) <= high, v.name
        if v.type == "Enumeration":
            assert int(v.start) in [int(item.value) for item in v.declaredType.items], v.name


def test_every_parameter_and_input_starts_with_the_value_of_the_description(any_fmu, instance):
    p = instance(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    for name in any_fmu.names("parameter") + any_fmu.names("input"):
        assert p[name] == any_fmu.start(name), name


def test_every_real_variable_has_a_defined_unit_and_every_variable_a_description(any_fmu):
    units = {unit.name for unit in any_fmu.description.unitDefinitions}
    for v in any_fmu.description.modelVariables:
        assert v.description, v.name
        if v.type == "Real":
            assert v.unit in units, v.name


def test_synthetic_parameters_say_so(fmu):
    for v in fmu.description.modelVariables:
        if v.name.startswith("zspring.") and v.causality == "parameter" and v.name != "zspring.tau":
            assert "synthetic" in v.description, v.name


def test_value_references_and_names_are_unique(any_fmu):
    variables = any_fmu.description.modelVariables
    assert len({v.valueReference for v in variables}) == len({v.name for v in variables}) == len(variables)
    types = xml(any_fmu).findall("TypeDefinitions/SimpleType")
    assert not {t.get("name") for t in types} & {v.name for v in variables}


def test_causality_variability_initial_and_start_go_together(any_fmu):
    """The table of FMI 2.0, section 2.2.7: no `initial` on inputs, start values exactly where they belong."""
    defaults = {"parameter": "exact", "calculatedParameter": "calculated", "input": None, "output": "calculated"}
    for element in xml(any_fmu).find("ModelVariables"):
        name, causality, kind = element.get("name"), element.get("causality"), element[0]
        fixed = causality in ("parameter", "calculatedParameter")
        if fixed:
            assert element.get("variability") in ("fixed", "tunable"), name
        else:
            assert element.get("variability", "continuous") in ("discrete", "continuous"), name
        if kind.tag != "Real":
            assert fixed or element.get("variability") == "discrete", name
        assert element.get("initial", defaults[causality]) == defaults[causality], name
        assert ("start" in kind.attrib) == (causality in ("parameter", "input")), name
        assert "reinit" not in kind.attrib and "canHandleMultipleSetPerTimeInstant" not in element.attrib, name
        assert (kind.tag == "Enumeration") <= ("declaredType" in kind.attrib), name


def test_the_flags_agree_with_each_other_and_with_what_the_library_does(any_fmu, model, instance):
    root = xml(any_fmu)
    flags = root.find("CoSimulation").attrib
    assert root.get("fmiVersion") == "2.0" and root.find("ModelExchange") is None

    def told(name: str) -> bool:
        return flags.get(name, "false") == "true"

    assert told("canHandleVariableCommunicationStepSize")
    assert told("canGetAndSetFMUstate") and told("canSerializeFMUstate")
    assert told("canInterpolateInputs") and told("providesDirectionalDerivative")
    assert told("canNotUseMemoryManagementFunctions")  # the C++ library allocates by itself
    for never in ("needsExecutionTool", "canRunAsynchronuously", "canBeInstantiatedOnlyOncePerProcess"):
        assert not told(never)

    p = instance(model.case.parameters)
    p.set_derivatives(model.force, 100.0)
    p.step(0.02)
    held = instance(model.case.parameters)
    held.step(0.02)
    assert p[model.moved] != held[model.moved]
    for order in (1, 2, 3):
        status = refusal(p.slave.getRealOutputDerivatives, [p.reference(model.moved)], [order])
        assert status == (fmi2OK if order <= int(flags["maxOutputDerivativeOrder"]) else fmi2Error)
    p.slave.getDirectionalDerivative([p.reference(model.moved)], [p.reference(model.force)], [1.0])


def test_the_guid_is_a_fingerprint_of_the_description(any_fmu, model, tmp_path):
    """Anything changed in the description gives another GUID, nothing changed the same."""

    def guid(text: str) -> str:
        source = tmp_path / "modelDescription.xml"
        source.write_text(text, encoding="utf-8")
        command = [sys.executable, ROOT / "fmu_src" / "generate_variables.py", source, tmp_path / "out"]
        subprocess.run(command, check=True)
        return ElementTree.parse(tmp_path / "out" / "modelDescription.xml").getroot().get("guid")

    text = (ROOT / SOURCES[model.name]).read_text(encoding="utf-8")
    assert guid(text) == any_fmu.description.guid
    changed = text.replace('description="Kinetic energy"', 'description="Kinetic energy "')
    assert changed != text and guid(changed) != any_fmu.description.guid


def test_the_model_structure_lists_all_outputs_and_initial_unknowns(any_fmu):
    root = xml(any_fmu)
    variables = list(root.find("ModelVariables"))

    def listed(what: str) -> list[int]:
        return [int(u.get("index")) for u in root.findall(f"ModelStructure/{what}/Unknown")]

    def of(*causalities: str) -> list[int]:
        return [i for i, v in enumerate(variables, start=1) if v.get("causality") in causalities]

    assert listed("Outputs") == of("output")
    assert listed("InitialUnknowns") == of("calculatedParameter", "output")
    for unknown in root.iterfind("ModelStructure/*/Unknown"):
        dependencies = [int(i) for i in unknown.get("dependencies").split()]
        assert dependencies == sorted(set(dependencies)) and set(dependencies) <= set(of("parameter", "input"))
        kinds = unknown.get("dependenciesKind")
        assert kinds is None or len(kinds.split()) == len(dependencies)


def test_no_output_is_undefined_after_initialization(instance):
    """Every variable can be read in Initialization Mode and after it, and is a finite number."""
    p = instance(initialize=False)
    p.slave.setupExperiment()
    p.slave.enterInitializationMode()
    in_initialization = p.all_values()
    p.slave.exitInitializationMode()
    assert in_initialization == p.all_values()
    assert all(abs(value) < 1e9 for value in in_initialization.values())


@each_case
def test_declared_output_dependencies_hold(any_fmu, instance, case):
    """No direct feedthrough: an input set after a step changes no output until the next step."""
    structure = xml(any_fmu).findall("ModelStructure/Outputs/Unknown")
    assert {unknown.get("dependencies") for unknown in structure} == {""}
    p = instance(case.parameters)
    p.step(0.01)
    before = {name: p[name] for name in any_fmu.names("output")}
    for name in any_fmu.names("input"):
        p[name] = p[name] + (20.0 if any_fmu.variables[name].unit == "N" else 0.001)
    assert {name: p[name] for name in any_fmu.names("output")} == before


def neighbours(v: ScalarVariable, value: Value) -> list[Value]:
    """Values near that of a variable, within its bounds."""
    if v.type == "Enumeration":
        return [int(item.value) for item in v.declaredType.items if int(item.value) != value]
    if v.type == "Boolean":
        return [not value]
    near = [value + 1, value - 1] if v.type == "Integer" else [1.01 * value + 1e-4, 0.99 * value - 1e-4]
    low, high = (float(b) if b is not None else None for b in (v.min, v.max))
    return [x for x in near if (low is None or x >= low) and (high is None or x <= high)]


@each_case
def test_declared_initial_dependencies_hold(any_fmu, instance, case):
    """In Initialization Mode nothing changes an initial unknown but what the description declares."""
    p = instance(initialize=False)

    def initial(values: dict[str, Value]) -> dict[str, Value]:
        p.reset()
        p.set(case.parameters)
        p.slave.enterInitializationMode()
        p.set(values)
        return {name: p[name] for name in unknowns}

    names = list(any_fmu.variables)
    unknowns = {
        names[int(u.get("index")) - 1]: {names[int(i) - 1] for i in u.get("dependencies").split()}
        for u in xml(any_fmu).findall("ModelStructure/InitialUnknowns/Unknown")
    }
    base = initial({})
    settable = any_fmu.names("parameter") + any_fmu.names("input")
    start = {name: p[name] for name in settable}
    for known in settable:
        answers = []
        for value in neighbours(any_fmu.variables[known], start[known]):
            try:
                answers.append(initial({known: value}))
            except FMICallException:  # such as a slope of the friction law together with Coulomb's
                continue
        assert answers or known == "solver.tangent", known
        changed = {name for answer in answers for name in unknowns if answer[name] != base[name]}
        undeclared = {name for name in changed if known not in unknowns[name]}
        assert not undeclared, f"{known} changes {sorted(undeclared)}"


def test_the_archive_is_one_that_every_host_can_read(any_fmu):
    """FMI 2.0, section 2.3: stored or deflated, plain relative paths; licences, icon, documentation inside."""
    with zipfile.ZipFile(any_fmu.path) as archive:
        for member in archive.infolist():
            assert member.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert member.extract_version <= 20 and not member.flag_bits & 1
            assert "\\" not in member.filename and not member.filename.startswith("/")
            assert ".." not in member.filename.split("/") and not stat.S_ISLNK(member.external_attr >> 16)
        names = archive.namelist()
        assert archive.testzip() is None
    assert len(set(names)) == len(names)
    for required in ("modelDescription.xml", "model.png", "documentation/index.html"):
        assert required in names
    assert any(name.startswith("documentation/licenses/license.") for name in names)
