"""Package the FMU: model description, binaries, documentation, licences and icon in one zip.

    python package_fmu.py MODEL_DESCRIPTION MODEL_RESOURCES FMU PLATFORM=LIBRARY...

MODEL_RESOURCES is the folder of documentation.html, a template for the tables, and of the icon model.png.

The same content gives the same bytes: entries are sorted and carry a fixed time.
"""

from __future__ import annotations

import html
import os
import string
import sys
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from source_form import list_sources

ROOT = Path(__file__).resolve().parent.parent
LICENSES = ROOT / "resources" / "licenses"
STYLE = ROOT / "resources" / "documentation.css"

# In the order of the documentation: (causality, heading)
CAUSALITIES = [
    ("parameter", "Parameters"),
    ("calculatedParameter", "Calculated parameters"),
    ("input", "Inputs"),
    ("output", "Outputs"),
]


def licenses() -> str:
    """The project's licence and those of what is compiled into the library."""
    parts = [("This FMU", ROOT / "LICENSE")]
    parts += [(f"Built in: {p.stem}", p) for p in sorted(LICENSES.glob("*.txt"))]
    rule = "=" * 78
    texts = [f"{rule}\n{title}\n{rule}\n\n{path.read_text('utf-8').strip()}\n" for title, path in parts]
    return "\n\n".join(texts)


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """HTML table of plain-text cells; the first column is set as code."""
    lines = ["<table>", "<tr>" + "".join(f"<th>{html.escape(h)}</th>" for h in header) + "</tr>"]
    for first, *others in rows:
        cells = "".join(f"<td>{html.escape(cell)}</td>" for cell in others)
        lines.append(f"<tr><td><code>{html.escape(first)}</code></td>{cells}</tr>")
    return "\n".join([*lines, "</table>"])


def bounds(typed: ET.Element) -> str:
    """Allowed range in words; empty when there is none."""
    low, high = typed.get("min"), typed.get("max")
    if low and high:
        return f"{low} to {high}"
    if low:
        return f"\N{GREATER-THAN OR EQUAL TO} {low}"
    return f"\N{LESS-THAN OR EQUAL TO} {high}" if high else ""


def variable_tables(model: ET.Element) -> str:
    """One table per causality, with unit, start value and bounds as the model description has them."""
    items = {
        (t.get("name"), i.get("value")): i.attrib["name"] for t in model.iter("SimpleType") for i in t.iter("Item")
    }
    parts = []
    for causality, heading in CAUSALITIES:
        rows = [["Name", "Unit or type", "Start", "Allowed", "Meaning"]]
        for variable in model.iterfind(f"ModelVariables/ScalarVariable[@causality='{causality}']"):
            typed = variable[0]
            declared, start = typed.get("declaredType"), typed.get("start", "")
            note = "; may be changed during the simulation" if variable.get("variability") == "tunable" else ""
            unit_or_type = declared or typed.get("unit") or typed.tag
            meaning = variable.get("description", "") + note
            rows.append(
                [variable.attrib["name"], unit_or_type, items.get((declared, start), start), bounds(typed), meaning]
            )
        # Without the columns that are empty in the whole table.
        used = [column for column in zip(*rows) if any(column[1:])]
        header, *cells = zip(*used)
        parts += [f'<h3 id="{causality}">{heading}</h3>', table(header, cells)]
    return "\n".join(parts)


def enumeration_tables(model: ET.Element) -> str:
    """One table per enumeration type."""
    parts = []
    for simple_type in model.iter("SimpleType"):
        rows = [[i.attrib["name"], i.attrib["value"], i.get("description", "")] for i in simple_type.iter("Item")]
        parts += [f"<h3>{html.escape(simple_type.attrib['name'])}</h3>", table(["Item", "Value", "Meaning"], rows)]
    return "\n".join(parts)


def documentation(model_description: Path, resources: Path) -> str:
    """The page documentation/index.html, with its tables made from the model description."""
    model = ET.parse(model_description).getroot()
    template = string.Template((resources / "documentation.html").read_text("utf-8"))
    return template.substitute(
        style=STYLE.read_text("utf-8"),
        version=html.escape(model.attrib["version"]),
        variables=variable_tables(model),
        enumerations=enumeration_tables(model),
    )


def write_fmu(
    model_description: Path,
    resources: Path,
    fmu: Path,
    libraries: dict[str, Path],
    sources: dict[str, bytes] | None = None,
) -> None:
    """Write the FMU. Never leaves half a file.

    libraries   shared libraries by FMI platform name
    sources     files of the folder sources/ by their path in it, where the FMU is to have its source form
    """
    description = model_description.read_bytes()
    entries = {
        "modelDescription.xml": list_sources(description, sources) if sources else description,
        "model.png": (resources / "model.png").read_bytes(),
        "documentation/index.html": documentation(model_description, resources).encode(),
        "documentation/licenses/license.txt": licenses().encode(),
    }
    entries |= {f"binaries/{platform}/{file.name}": file.read_bytes() for platform, file in libraries.items()}
    entries |= {f"sources/{path}": content for path, content in (sources or {}).items()}

    unfinished = fmu.with_name(fmu.name + ".part")
    with zipfile.ZipFile(unfinished, "w") as archive:
        for name, content in sorted(entries.items()):
            info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # Unix, wherever it is packaged: the permissions below have this form
            info.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(info, content)
    os.replace(unfinished, fmu)


def main(model_description: str, resources: str, fmu: str, *libraries: str) -> None:
    by_platform = {platform: Path(library) for platform, library in (text.split("=", 1) for text in libraries)}
    write_fmu(Path(model_description), Path(resources), Path(fmu), by_platform)


if __name__ == "__main__":
    main(*sys.argv[1:])
