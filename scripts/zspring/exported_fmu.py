"""Copies of an FMU: other start values, another line, without enumerations, with plain names; the libraries stay."""

from __future__ import annotations

import re
import shutil
import struct
import xml.etree.ElementTree as ET
import zipfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .errors import ZSpringError
from .fmu import Fmu
from .line_table import FILE, replaces
from .variables import Value

DESCRIPTION = "modelDescription.xml"
UNUSED = f"Not used: resources/{FILE} tells the line"
TYPES = ("Real", "Integer", "Boolean", "Enumeration")


@dataclass(frozen=True)
class Copy:
    """How a copy differs.

    plain   enumerations are Integers of the same values, which FMI 2.0 sets with the same function
    flat    all variables are Reals, and their names have neither dots nor brackets
    starts  start values of parameters and inputs, in the FMU's units
    stop    s, of the DefaultExperiment; None: as it is
    files   more files of its resources, by name
    """

    plain: bool = False
    flat: bool = False
    starts: Mapping[str, Value] = field(default_factory=dict)
    stop: float | None = None
    files: Mapping[str, bytes] = field(default_factory=dict)

    def write(self, fmu: Fmu, path: Path) -> None:
        """With the line that the FMU has now. Raises ZSpringError as flat_names, OSError."""
        if self == Copy() and fmu.guid == fmu.description.guid:
            shutil.copyfile(fmu.path, path)
            return
        resources = {f"resources/{name}": content for name, content in self.files.items()}
        if fmu.line:
            resources[f"resources/{FILE}"] = fmu.line.content
        with zipfile.ZipFile(fmu.path) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
            for entry in old.infolist():
                if entry.filename not in resources:
                    content = old.read(entry)
                    new.writestr(entry, self._described(fmu, content) if entry.filename == DESCRIPTION else content)
            for name, content in resources.items():
                new.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)

    def _described(self, fmu: Fmu, content: bytes) -> bytes:
        root = ET.fromstring(content)
        root.set("guid", self._guid(fmu))
        if self.stop is not None:
            root.find("DefaultExperiment").set("stopTime", f"{self.stop:g}")  # type: ignore[union-attr]
        variables = root.findall("ModelVariables/ScalarVariable")
        for variable in variables:
            kind, name = next(child for child in variable if child.tag in TYPES), variable.attrib["name"]
            if fmu.line and variable.get("causality") == "parameter" and replaces(name):
                variable.set("description", UNUSED)
            if name in self.starts:
                value = self.starts[name]
                kind.set("start", str(value).lower() if kind.tag == "Boolean" else repr(value))
            if self.plain or self.flat:
                self._retype(fmu, name, kind)
        if self.flat:
            root.set("variableNamingConvention", "flat")
            for variable, name in zip(variables, flat_names(fmu)):
                variable.set("name", name)
        return ET.tostring(root, encoding="UTF-8", xml_declaration=True)

    def _retype(self, fmu: Fmu, name: str, kind: ET.Element) -> None:
        """An enumeration as an Integer between its first and last item; with flat names, whatever it is as a Real."""
        if kind.tag == "Enumeration":
            items = len(fmu.variables[name].declaredType.items)
            kind.attrib.update(min="1", max=str(items))
            del kind.attrib["declaredType"]
            kind.tag = "Integer"
        if self.flat and kind.tag == "Boolean":
            kind.attrib.update(min="0", max="1")
            if "start" in kind.attrib:
                kind.set("start", str(int(kind.get("start") == "true")))
        if self.flat:
            kind.tag = "Real"

    def _guid(self, fmu: Fmu) -> str:
        """That tells the library of the copy: fmu_src/fmi/origin.hpp."""
        whole, *told = fmu.guid.split(" ")
        kind = ["reals"] if self.flat and "reals" not in told else []
        starts = [f"{fmu.variables[n].valueReference}={struct.pack('>d', v).hex()}" for n, v in self.starts.items()]
        return " ".join([whole, *kind, *told, *starts])


def flat_names(fmu: Fmu) -> list[str]:
    """Names of all variables: pantograph[1].wire_height is pantograph_1_wire_height.

    An output that would share its name with an input ends on _out: contact.force, as there is contact_force. Raises
    ZSpringError where two names are the same all the same.
    """
    inputs = {_flat(name) for name in fmu.variables.names("input")}
    names = [_flat(v.name) + "_out" * (v.causality == "output" and _flat(v.name) in inputs) for v in fmu.variables]
    for name, count in Counter(names).items():
        if count > 1:
            raise ZSpringError(f"{fmu.path.name}: {count} variables would be {name} without dots and brackets")
    return names


def _flat(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
