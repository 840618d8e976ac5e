"""The system of pantographs and catenary as an archive of System Structure and Parameterization 1.0 (SSP)."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

from ..exported_fmu import Copy
from ..fmu import Fmu
from ..line.run import LineRun
from ..parameter_sets import write_set

_SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
_SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
_OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
_OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"

LINE_ELEMENT = "catenary"
SET_NAME = "initialValues"  # of both sets: Ecos applies one name to all components
UNITS = {"m": {"m": "1"}, "N": {"kg": "1", "m": "1", "s": "-2"}, "m/N": {"kg": "-1", "s": "2"}}


def element_name(i: int) -> str:
    """Name of pantograph i, counted from 0, in the system."""
    return f"pantograph{i + 1}" if i else "pantograph"


def write_ssp(run: LineRun, path: Path) -> None:
    """Write the archive of a run that is set up, with its parameters, first inputs and communication step.

    A system structure says what is connected, not when values are exchanged: tools that do it once a step,
    side by side, give what start_up "direct" with the scheme "parallel" gives: the wire is exchanged as an affine map
    of the force, its heights measured from where static_force lifts it at the start.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        sources, line_fmu, pantograph = {}, run.system.catenary, run.system.pantograph
        for fmu in line_fmu, pantograph:
            copy = Path(folder, fmu.path.name)
            Copy(plain=True).write(fmu, copy)
            sources[fmu] = f"resources/{copy.name}"
            archive.write(copy, sources[fmu])
        system = ET.Element(_tag("System"), name="line", description="Pantographs on an overhead contact line")
        elements = ET.SubElement(system, _tag("Elements"))
        parameters, inputs = run.wire_start
        starts = {LINE_ELEMENT: (line_fmu, ({**parameters, **run.exchange}, inputs))}
        count = len(run.head_starts)
        starts |= {element_name(i): (pantograph, start) for i, start in enumerate(run.head_starts)}
        for name, (fmu, (parameters, inputs)) in starts.items():
            values = Path(folder, f"{name}.ssv")
            with Fmu(Path(folder, fmu.path.name)) as stripped:
                write_set(values, stripped, {**parameters, **inputs}, SET_NAME, f"Parameters and inputs: {name}")
            archive.write(values, f"resources/{values.name}")
            component = ET.SubElement(
                elements,
                _tag("Component"),
                {"name": name, "type": "application/x-fmu-sharedlibrary", "source": sources[fmu]},
                implementation="CoSimulation",
            )
            _add_connectors(component, fmu, name, count)
            bindings = ET.SubElement(component, _tag("ParameterBindings"))
            ET.SubElement(bindings, _tag("ParameterBinding"), source=f"resources/{values.name}")
        _add_connections(system, count)
        _annotate_for_omsimulator(system, run.journey.step)
        archive.writestr("SystemStructure.ssd", _description(run, system))


def _tag(name: str) -> str:
    return f"{{{_SSD}}}{name}"


# From the pantograph's side: its input by the catenary's output, pantograph[p].OUTPUT.
MAP = {"wire_height": "free_height", "wire.compliance": "compliance", "wire.compliance_previous": "compliance_previous"}


def _add_connectors(component: ET.Element, fmu: Fmu, name: str, count: int) -> None:
    if name == LINE_ELEMENT:
        names = [f"pantograph[{i + 1}].{kind}" for kind in ("force", *MAP.values()) for i in range(count)]
    else:
        names = [*MAP, "contact.force"]
    connectors = ET.SubElement(component, _tag("Connectors"))
    for connector in names:
        variable = fmu.variables[connector]
        element = ET.SubElement(connectors, _tag("Connector"), name=connector, kind=variable.causality)
        ET.SubElement(element, f"{{{_SSC}}}Real", unit=variable.unit)


def _add_connections(system: ET.Element, count: int) -> None:
    connections = ET.SubElement(system, _tag("Connections"))
    for i in range(count):
        name, contact = element_name(i), f"pantograph[{i + 1}]"
        _connect(connections, name, "contact.force", LINE_ELEMENT, f"{contact}.force")
        for head_input, output in MAP.items():
            _connect(connections, LINE_ELEMENT, f"{contact}.{output}", name, head_input)


def _annotate_for_omsimulator(system: ET.Element, step: float) -> None:
    """Its fixed-step master, without which OMSimulator ends in a crash."""
    annotations = ET.SubElement(system, _tag("Annotations"))
    annotation = ET.SubElement(annotations, f"{{{_SSC}}}Annotation", type="org.openmodelica")
    own = ET.SubElement(annotation, f"{{{_OMS}}}Annotations")
    information = ET.SubElement(own, f"{{{_OMS}}}SimulationInformation")
    tolerances = {"absoluteTolerance": "0.0001", "relativeTolerance": "0.0001"}
    master = {"description": "oms-ma", "stepSize": repr(step), **tolerances}
    ET.SubElement(information, f"{{{_OMS}}}FixedStepMaster", master)


def _connect(connections: ET.Element, source: str, output: str, target: str, name: str) -> None:
    ET.SubElement(
        connections,
        _tag("Connection"),
        startElement=source,
        startConnector=output,
        endElement=target,
        endConnector=name,
    )


def _description(run: LineRun, system: ET.Element) -> bytes:
    """SystemStructure.ssd, with the communication step as the Open Simulation Platform annotates it."""
    for prefix, uri in ("ssd", _SSD), ("ssc", _SSC), ("osp", _OSP), ("oms", _OMS):
        ET.register_namespace(prefix, uri)
    tool = run.system.catenary.description
    root = ET.Element(_tag("SystemStructureDescription"), version="1.0", name="pantograph_and_catenary")
    root.set("generationTool", f"{tool.generationTool} {tool.version}")
    root.append(system)
    units = ET.SubElement(root, _tag("Units"))
    for unit, base in UNITS.items():
        element = ET.SubElement(units, f"{{{_SSC}}}Unit", name=unit)
        ET.SubElement(element, f"{{{_SSC}}}BaseUnit", base)
    step = run.journey.step
    experiment = ET.SubElement(
        root, _tag("DefaultExperiment"), startTime="0.0", stopTime=repr(round(run.steps * step, 12))
    )
    annotations = ET.SubElement(experiment, _tag("Annotations"))
    annotation = ET.SubElement(annotations, f"{{{_SSC}}}Annotation", type="com.opensimulationplatform")
    algorithm = ET.SubElement(annotation, f"{{{_OSP}}}Algorithm")
    ET.SubElement(algorithm, f"{{{_OSP}}}FixedStepAlgorithm", baseStepSize=repr(step))
    ET.indent(root)
    return ET.tostring(root, encoding="utf-8", xml_declaration=True)
