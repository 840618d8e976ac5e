"""Makes the C++ table of variables and the final model description from a model description.

    python generate_variables.py modelDescription.xml OUT_DIR

writes OUT_DIR/variables.inc and OUT_DIR/modelDescription.xml. The GUID is a hash of the source XML, so that a
library never meets a description it was not built from. Errors in the XML that the compiler would not see
(value references that are not 0, 1, 2, ..., a start outside its bounds) stop the build with one line.
"""

import re
import sys
import uuid
import xml.etree.ElementTree as ET
from pathlib import Path

UNBOUNDED = "HUGE_VAL"


def enumerations(root):
    """{type name: ["1 Force", ...]}"""
    return {
        t.get("name"): [f"{item.get('value')} {item.get('name')}" for item in t.find("Enumeration")]
        for t in root.iter("SimpleType")
    }


def identifier_and_index(name):
    """C++ identifier shared by the elements of an array, and the element's place from 0: "a[2].b" is (a_dot_b, 1)."""
    parts = re.fullmatch(r"([^\[\]]*)(?:\[(\d+)\]([^\[\]]*))?", name)
    if not parts:
        sys.exit(f"modelDescription.xml: {name}: only arrays of one dimension are supported")
    head, index, tail = parts.groups(default="")
    return (head + tail).replace(".", "_dot_"), int(index or 1) - 1


def row(index, variable, enums):
    """One X(...) line of the table, its columns as in the heading that main writes."""
    name = variable.get("name")
    identifier, element = identifier_and_index(name)
    value = variable[0]
    if variable.get("valueReference") != str(index):
        sys.exit(f"modelDescription.xml: {name}: valueReference must be {index}, its place in the list")
    items = enums.get(value.get("declaredType"), [])
    low, high = value.get("min"), value.get("max")
    if items:
        low, high = "1", str(len(items))
    start = value.get("start")
    if start is not None:
        for bound, outside in ((low, float.__lt__), (high, float.__gt__)):
            if bound is not None and outside(float(start), float(bound)):
                sys.exit(f"modelDescription.xml: {name}: start = {start} is outside its bound {bound}")
    causality = variable.get("causality")
    return (
        f'  X({identifier}, {element}, "{name}", {value.tag}, {causality[0].upper()}{causality[1:]}, '
        f'{str(variable.get("variability") == "tunable").lower()}, "{value.get("unit", "")}", {start or 0}, '
        f'{low or "-" + UNBOUNDED}, {high or UNBOUNDED}, "{", ".join(items)}")'
    )


def main(source, out_dir):
    text = Path(source).read_text(encoding="utf-8")
    guid = "{" + str(uuid.uuid5(uuid.NAMESPACE_URL, text)) + "}"
    final, placeholders = re.subn(r'guid=""', f'guid="{guid}"', text)
    if placeholders != 1:
        sys.exit('modelDescription.xml: exactly one guid="" is expected')
    root = ET.fromstring(text)
    enums = enumerations(root)
    rows = [row(i, v, enums) for i, v in enumerate(root.find("ModelVariables"))]
    identifiers = dict.fromkeys(identifier_and_index(v.get("name"))[0] for v in root.find("ModelVariables"))
    categories = [f"  X({c.get('name')})" for c in root.iter("Category")]
    table = [
        "// Generated from modelDescription.xml.",
        f'#define ZSPRING_GUID "{guid}"',
        f'#define ZSPRING_MODEL_IDENTIFIER "{root.find("CoSimulation").get("modelIdentifier")}"',
        "#define ZSPRING_IDENTIFIERS(X) \\",
        " \\\n".join(f"  X({identifier})" for identifier in identifiers),
        "// identifier, index, name, type, causality, tunable, unit, start, min, max, items of an enumeration",
        "#define ZSPRING_VARIABLES(X) \\",
        " \\\n".join(rows),
        "#define ZSPRING_LOG_CATEGORIES(X) \\",
        " \\\n".join(categories),
        "",
    ]
    out = Path(out_dir)
    out.mkdir(parents=True, exist_ok=True)
    (out / "variables.inc").write_text("\n".join(table), encoding="utf-8")
    (out / "modelDescription.xml").write_bytes(final.encode("utf-8"))


if __name__ == "__main__":
    main(*sys.argv[1:])
