"""Parameter sets as files of SSP 1.0: System Structure Parameter Values (SSV).

The sets in this package are found by name, those of the user by path. Their descriptions say where the
numbers come from and how far they are trusted; a parameter less certain than its set says so itself.
"""

from __future__ import annotations

import importlib.resources
import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

from fmpy.model_description import ScalarVariable

from .errors import ZSpringError, did_you_mean
from .fmu import Fmu
from .units import UnitError, conversion
from .variables import Value, parse, text

SUFFIX = ".ssv"
PANTOGRAPHS, LINES = "parameter_sets", "lines"  # folders of resources
# The commands' internal step where neither a set nor the user says one. The FMU starts with the paper's 2 ms, at which
# |H| is off by up to 7 % near 12 Hz and Coulomb rods can cycle on the grid of the steps, where they truly settle.
ACCURATE_STEP = 5e-4  # s
_SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
_SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
_NAMESPACES = {"ssv": _SSV, "ssc": _SSC}
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

BaseUnit = tuple[tuple[int, ...], float, float]  # exponents as in _BASE_UNITS; factor, offset to base units


def packaged_sets(kind: str = PANTOGRAPHS) -> dict[str, Path]:
    """Files of the sets of a kind, PANTOGRAPHS or LINES, in this package by name."""
    folder = Path(str(importlib.resources.files(__package__) / "resources" / kind))
    return {path.stem: path for path in sorted(folder.glob(f"*{SUFFIX}"))}


def find_set(name_or_file: str, kind: str = PANTOGRAPHS) -> Path:
    """The file of a set in this package, or that of a path. Raises ZSpringError if there is neither."""
    known = packaged_sets(kind)
    if name_or_file in known:
        return known[name_or_file]
    path = Path(name_or_file)
    if path.is_file():
        return path
    raise ZSpringError(
        f"{name_or_file}: no such file, and no set of that name{did_you_mean(name_or_file, known)} "
        f"(there are {', '.join(known)})"
    )


def describe_set(path: Path) -> tuple[str, dict[str, list[str]]]:
    """Description of the set, and the parameters that have a description of their own, by that."""
    root = _root(path)
    remarks: dict[str, list[str]] = {}
    for parameter in root.iterfind("ssv:Parameters/ssv:Parameter", _NAMESPACES):
        if remark := parameter.get("description"):
            remarks.setdefault(remark, []).append(parameter.get("name", ""))
    return root.get("description", ""), remarks


def read_set(path: Path, fmu: Fmu) -> dict[str, Value]:
    """Parameters by name, in the FMU's units.

    A unit that the file defines is converted through its base units; any other must be one that the FMU
    knows. Bounds are left to the FMU. Raises ZSpringError for a file of another kind, a name that is no
    parameter or comes twice, a wrong type or unit, and a number that is not finite.
    """
    root = _root(path)
    units = {
        unit.get("name", ""): _base_unit(base)
        for unit in root.iterfind("ssv:Units/ssc:Unit", _NAMESPACES)
        if (base := unit.find("ssc:BaseUnit", _NAMESPACES)) is not None
    }
    values: dict[str, Value] = {}
    for element in root.iterfind("ssv:Parameters/ssv:Parameter", _NAMESPACES):
        name = element.get("name", "")
        try:
            if name in values:
                raise ZSpringError(f"two parameters {name!r}")
            values[name] = _value(fmu, fmu.variables.parameter(name), element, units)
        except ZSpringError as error:
            raise ZSpringError(f"{path}: {error}") from None
    return values


def write_set(
    path: Path,
    fmu: Fmu,
    values: Mapping[str, Value],
    name: str,
    description: str,
    remarks: Mapping[str, str] | None = None,
) -> None:
    """Write parameters, in the FMU's units, as an SSV file that defines every unit it uses.

    remarks     descriptions of single parameters by name
    """
    ET.register_namespace("ssv", _SSV)
    ET.register_namespace("ssc", _SSC)
    root = ET.Element(f"{{{_SSV}}}ParameterSet", version="1.0", name=name, description=description)
    root.set("generationTool", f"{fmu.description.generationTool} {fmu.description.version}")
    parameters = ET.SubElement(root, f"{{{_SSV}}}Parameters")
    used: dict[str, None] = {}  # in the order of first use
    for parameter, value in values.items():
        variable = fmu.variables[parameter]
        element = ET.SubElement(parameters, f"{{{_SSV}}}Parameter", name=parameter)
        if remarks and parameter in remarks:
            element.set("description", remarks[parameter])
        typed = ET.SubElement(element, f"{{{_SSV}}}{variable.type}", value=text(variable, value))
        if variable.unit:
            typed.set("unit", variable.unit)
            used[variable.unit] = None
    definitions = {unit.name: unit.baseUnit for unit in fmu.description.unitDefinitions}
    units = ET.SubElement(root, f"{{{_SSV}}}Units") if used else root
    for unit in used:
        element = ET.SubElement(units, f"{{{_SSC}}}Unit", name=unit)
        base = {key: str(getattr(definitions[unit], key)) for key in (*_BASE_UNITS, "factor", "offset")}
        neutral = {"factor": "1.0", "offset": "0.0"}
        base = {key: number for key, number in base.items() if number not in ("0", neutral.get(key))}
        ET.SubElement(element, f"{{{_SSC}}}BaseUnit", base)
    ET.indent(root)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _root(path: Path) -> ET.Element:
    try:
        root = ET.parse(path).getroot()
    except ET.ParseError as error:
        raise ZSpringError(f"{path}: no XML: {error}") from None
    if root.tag != f"{{{_SSV}}}ParameterSet":
        raise ZSpringError(f"{path}: no parameter set of SSP 1.0 (SSV) but {root.tag}")
    return root


def _value(fmu: Fmu, variable: ScalarVariable, element: ET.Element, units: Mapping[str, BaseUnit]) -> Value:
    """The value of one parameter in the FMU's unit."""
    typed = next(iter(element), None)
    kind = None if typed is None else typed.tag.removeprefix(f"{{{_SSV}}}")
    if typed is None or (kind != variable.type and (kind, variable.type) != ("Integer", "Enumeration")):
        raise ZSpringError(f"{variable.name} is {kind}: must be {variable.type}")
    value, unit = parse(variable, typed.get("value", "")), typed.get("unit", "")
    if kind != "Real":
        return value
    if not math.isfinite(value):
        raise ZSpringError(f"{variable.name} = {value}: must be finite")
    if unit not in units:
        try:
            return value * conversion(unit or variable.unit or "1", variable.unit or "1")[1]
        except UnitError as error:
            raise ZSpringError(f"{variable.name}: {error}") from None
    own = next(_base_unit(u.baseUnit) for u in fmu.description.unitDefinitions if u.name == variable.unit)
    exponents, factor, offset = units[unit]
    if exponents != own[0]:
        raise ZSpringError(f"{variable.name} [{unit}]: the unit must be convertible to {variable.unit}")
    if (factor, offset) == own[1:]:
        return value
    return (factor * value + offset - own[2]) / own[1]


def _base_unit(base) -> BaseUnit:
    """Exponents, factor and offset of an XML element or of fmpy's BaseUnit."""
    get = base.get if isinstance(base, ET.Element) else lambda key: getattr(base, key)
    exponents = tuple(int(get(key) or 0) for key in _BASE_UNITS)
    return exponents, float(get("factor") or 1), float(get("offset") or 0)
