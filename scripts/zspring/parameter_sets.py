"""Parameter sets as files of SSP 1.0 or 2.0: System Structure Parameter Values (SSV).

The sets in this package are found by name, those of the user by path; FILE#PREFIX are the parameters of a file whose
names begin with PREFIX and a dot, as sets of whole systems have them. Descriptions say where the numbers come from and
how far they are trusted; a parameter less certain than its set says so itself.

Every parameter of a set must be one of the FMU. What a command sets itself is passed over, and a set of which nothing
remains is refused.
"""

from __future__ import annotations

import importlib.resources
import math
import sys
import xml.etree.ElementTree as ET
from collections.abc import Container, Iterator, Mapping
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
# Elements: in which others they may be, and how SSP 2.0 names FMI 2.0's types.
_INSIDE = {
    f"{{{_SSV}}}ParameterSet": {f"{{{_SSV}}}{name}" for name in ("Parameters", "Enumerations", "Units", "Annotations")}
    | {f"{{{_SSC}}}{name}" for name in ("MetaData", "Signature")},
    f"{{{_SSV}}}Parameters": {f"{{{_SSV}}}Parameter"},
    f"{{{_SSV}}}Units": {f"{{{_SSC}}}Unit"},
}
_TYPES = {"Float64": "Real", "Float32": "Real"} | {f"{u}Int{n}": "Integer" for u in ("", "U") for n in (8, 16, 32, 64)}
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

BaseUnit = tuple[tuple[int, ...], float, float]  # exponents as in _BASE_UNITS; factor, offset to base units
_NUMBER: BaseUnit = (0,) * len(_BASE_UNITS), 1.0, 0.0


def packaged_sets(kind: str = PANTOGRAPHS) -> dict[str, Path]:
    """Files of the sets of a kind, PANTOGRAPHS or LINES, in this package by name."""
    folder = Path(str(importlib.resources.files(__package__) / "resources" / kind))
    return {path.stem: path for path in sorted(folder.glob(f"*{SUFFIX}"))}


def find_set(name_or_file: str, kind: str = PANTOGRAPHS) -> Path:
    """The file of a set in this package, or that of a path. Raises ZSpringError if there is neither."""
    return _file_and_prefix(name_or_file, kind)[0]


def chosen_set(name_or_file: str, fmu: Fmu, kind: str = PANTOGRAPHS, but_not: Container[str] = ()) -> dict[str, Value]:
    """Parameters of a set in this package, of a file, or of a FILE#PREFIX; see read_set.

    but_not     parameters that the command sets itself
    Raises ZSpringError as find_set and read_set, and for a set of which nothing remains.
    """
    path, prefix = _file_and_prefix(name_or_file, kind)
    values = read_set(path, fmu, prefix)
    used = {name: value for name, value in values.items() if name not in but_not}
    if not used:
        raise ZSpringError(f"{name_or_file}: the command itself sets {', '.join(values)}: nothing of the set is used")
    return used


def _file_and_prefix(name_or_file: str, kind: str) -> tuple[Path, str]:
    known = packaged_sets(kind)
    if name_or_file in known:
        return known[name_or_file], ""
    file, _, prefix = name_or_file.rpartition("#")
    for path, chosen in (Path(name_or_file), ""), (Path(file), prefix):
        if str(path) and path.is_file():
            return path, chosen
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


def read_set(path: Path, fmu: Fmu, prefix: str = "") -> dict[str, Value]:
    """Parameters by name, in the FMU's units.

    prefix  of names to read, which have it before a dot; others are passed over
    A unit that the file defines is converted through its base units; any other must be one that the FMU
    knows. Bounds are left to the FMU. Inputs, which the sets of an SSP archive have, are the commands' own business:
    they are passed over, and standard error says so. Raises ZSpringError for a file of another kind, an element that
    is none of SSV's, a name that is no parameter or comes twice, a wrong type or unit, a number that is not finite,
    and a set without parameters.
    """
    root = _root(path)
    values: dict[str, Value] = {}
    inputs: list[str] = []
    try:
        units = {
            unit.get("name", ""): _base_unit(base)
            for unit in _elements(root, "Units")
            if (base := unit.find("ssc:BaseUnit", _NAMESPACES)) is not None
        }
        for element in _elements(root, "Parameters"):
            whole = element.get("name", "")
            name = whole.removeprefix(f"{prefix}.") if prefix else whole
            if prefix and name == whole:
                continue
            if name in values:
                raise ZSpringError(f"two parameters {whole!r}")
            if name in fmu.variables.names("input"):
                inputs.append(name)
                continue
            if not prefix:
                _look_for_prefix(path, name, fmu)
            values[name] = _value(fmu, fmu.variables.settable(name), element, units)
        if not values:
            but = f" but inputs: {', '.join(inputs)}" if inputs else ""
            raise ZSpringError(f"no parameter whose name begins with {prefix}." if prefix else f"has no parameter{but}")
    except ZSpringError as error:
        raise ZSpringError(f"{path}: {error}") from None
    if inputs:
        print(f"{path}: inputs are passed over: {', '.join(inputs)}", file=sys.stderr)
    return values


def _look_for_prefix(path: Path, name: str, fmu: Fmu) -> None:
    """Raises ZSpringError for a name of a system's set, pantograph.k1, with how to choose its prefix."""
    known = fmu.variables.names("parameter")
    parts = name.split(".")
    for n in range(1, len(parts)):
        if name not in known and ".".join(parts[n:]) in known:
            prefix = ".".join(parts[:n])
            raise ZSpringError(f"no parameter {name!r} in the FMU; to read those of {prefix!r} give {path}#{prefix}")


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
    path.write_bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True))


def _root(path: Path) -> ET.Element:
    try:
        root = ET.parse(path).getroot()
    except (ET.ParseError, ValueError, LookupError) as error:  # the latter for an unknown encoding
        raise ZSpringError(f"{path}: no XML: {error}") from None
    if root.tag != f"{{{_SSV}}}ParameterSet":
        raise ZSpringError(f"{path}: no parameter set of SSP (SSV) but {root.tag}")
    if root.get("version", "1.0") not in ("1.0", "2.0"):
        raise ZSpringError(f"{path}: version = {root.get('version')!r}: must be 1.0 or 2.0")
    return root


def _elements(root: ET.Element, name: str) -> Iterator[ET.Element]:
    """What the elements of that name hold. Raises ZSpringError for elements that SSV does not have there."""
    for parent in (root, *root.iterfind(f"ssv:{name}", _NAMESPACES)):
        for element in parent:
            if element.tag not in _INSIDE[parent.tag]:
                allowed = ", ".join(sorted(_shown(tag) for tag in _INSIDE[parent.tag]))
                raise ZSpringError(f"element {_shown(element.tag)} in {_shown(parent.tag)}: must be one of {allowed}")
            if parent is not root:
                yield element


def _shown(tag: str) -> str:
    space, _, name = tag.rpartition("}")
    known = {f"{{{_SSV}": "ssv:", f"{{{_SSC}": "ssc:", "": ""}
    return f"{known[space]}{name}{'' if space else ' (without namespace)'}" if space in known else tag


def _value(fmu: Fmu, variable: ScalarVariable, element: ET.Element, units: Mapping[str, BaseUnit]) -> Value:
    """The value of one parameter in the FMU's unit."""
    typed = next(iter(element), None)
    given = None if typed is None else typed.tag.removeprefix(f"{{{_SSV}}}")
    kind = _TYPES.get(given or "", given)
    if typed is None or (kind != variable.type and (kind, variable.type) != ("Integer", "Enumeration")):
        raise ZSpringError(f"{variable.name} is {given}: must be {variable.type}")
    items = [typed, *typed.iterfind("ssv:Value", _NAMESPACES)]  # of SSP 2.0, in place of the attribute
    texts = [text for item in items if (text := item.get("value")) is not None]
    if len(texts) != 1:
        raise ZSpringError(f"{variable.name} has {len(texts)} values: must be one")
    value, unit = parse(variable, texts[0]), typed.get("unit", "")
    if kind != "Real":
        return value
    if not math.isfinite(value):
        raise ZSpringError(f"{variable.name} = {value}: must be finite")
    if unit not in units:
        try:
            return value * conversion(unit or variable.unit or "1", variable.unit or "1")[1]
        except UnitError as error:
            raise ZSpringError(f"{variable.name}: {error}") from None
    definitions = {definition.name: definition.baseUnit for definition in fmu.description.unitDefinitions}
    own = _base_unit(definitions[variable.unit]) if variable.unit in definitions else _NUMBER
    exponents, factor, offset = units[unit]
    if exponents != own[0]:
        raise ZSpringError(f"{variable.name} [{unit}]: the unit must be convertible to {variable.unit}")
    if (factor, offset) == own[1:]:
        return value
    return (factor * value + offset - own[2]) / own[1]


def _base_unit(base) -> BaseUnit:
    """Exponents, factor and offset of an XML element or of fmpy's BaseUnit."""
    get = base.get if isinstance(base, ET.Element) else lambda key: getattr(base, key)
    try:
        exponents = tuple(int(get(key) or 0) for key in _BASE_UNITS)
        factor, offset = float(get("factor") or 1), float(get("offset") or 0)
    except ValueError as error:
        raise ZSpringError(f"a unit's definition: {error}") from None
    return exponents, factor, offset
