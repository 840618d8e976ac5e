"""Makes the C++ table of variables and the final model description from a model description.

    python generate_variables.py MODEL_DESCRIPTION OUT_DIR

writes OUT_DIR/variables.inc and OUT_DIR/modelDescription.xml. The lists of its ModelStructure are made from what each
output and calculated parameter declares in the attribute initialDependencies, which is no part of FMI and is left
out. The GUID is a hash of the source XML, so that a library never meets a description it was not built from. Errors
in the XML that the compiler would not see (value references that are not 0, 1, 2, ..., a start outside its bounds,
dependencies that are not declared or name no variable) stop the build with one line.
"""

import re
import sys
import uuid
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import NoReturn

# In the models alpha is the angle of a rod; a member has no members of its own.
OTHER_MEMBER = {"solver.alpha": "solver.hht_alpha", "exchange.step": "exchange_step"}
DECLARED = "initialDependencies"


def refuse(message) -> NoReturn:
    sys.exit(f"model description: {message}")


def identifier_and_index(name):
    """C++ identifier shared by the elements of an array, and the element's place from 0: "a[2].b" is (a_dot_b, 1)."""
    parts = re.fullmatch(r"([^\[\]]*)(?:\[(\d+)\]([^\[\]]*))?", name)
    if not parts:
        refuse(f"{name}: only arrays of one dimension are supported")
    head, index, tail = parts.groups(default="")
    return (head + tail).replace(".", "_dot_"), int(index or 1) - 1


def macro(name, columns, rows):
    """Text that defines a macro which applies its argument to each row."""
    return f"// {columns}\n#define ZSPRING_{name}(X) \\\n" + " \\\n".join(f"  X({r})" for r in rows) + "\n"


def table(root, guid):
    """Text of variables.inc."""
    items = {
        t.get("name"): [f"{i.get('value')} {i.get('name')}" for i in t.iter("Item")] for t in root.iter("SimpleType")
    }
    identifiers: dict[str, str] = {}
    outputs: list[str] = []
    rows: list[str] = []
    for place, variable in enumerate(root.find("ModelVariables")):
        name, causality, value = variable.get("name"), variable.get("causality"), variable[0]
        if variable.get("valueReference") != str(place):
            refuse(f"{name}: valueReference must be {place}, its place in the list")
        allowed = items.get(value.get("declaredType"), [])
        low, high = ("1", str(len(allowed))) if allowed else (value.get("min"), value.get("max"))
        start = value.get("start")
        for bound, outside in ((low, float.__lt__), (high, float.__gt__)):
            if start is not None and bound is not None and outside(float(start), float(bound)):
                refuse(f"{name}: start = {start} is outside its bound {bound}")
        identifier, element = identifier_and_index(name)
        if causality == "output":
            continuous = value.tag == "Real" and variable.get("variability", "continuous") == "continuous"
            identifiers[identifier] = f"{identifier}, {str(continuous).lower()}"
            known_as = str(len(outputs))
            outputs.append(f"{identifier}, {element}")
        else:
            known_as = OTHER_MEMBER.get(name) or re.sub(r"\[\d+\]", f"[{element}]", name)
        rows.append(
            f'"{name}", {value.tag}, {causality[0].upper() + causality[1:]}, '
            f'{str(variable.get("variability") == "tunable").lower()}, "{value.get("unit", "")}", {start or 0}, '
            f'{low or "-HUGE_VAL"}, {high or "HUGE_VAL"}, "{", ".join(allowed)}", {known_as}'
        )
    columns = (
        "name, type, causality, tunable, unit, start, min, max, items of an enumeration, "
        "member of the model's struct or place among the outputs"
    )
    return (
        "// Generated from the model description.\n"
        f'#define ZSPRING_GUID "{guid}"\n'
        f"#define ZSPRING_OUTPUT_COUNT {len(outputs)}\n"
        + macro("IDENTIFIERS", "identifier, continuous", identifiers.values())
        + macro("VARIABLES", columns, rows)
        + macro("OUTPUTS", "identifier, index", outputs)
        + macro("LOG_CATEGORIES", "name", [c.get("name") for c in root.iter("Category")])
    )


def dependencies(root):
    """Of each output and calculated parameter, the indices from 1 that it declares; {its index: [index, ...]}."""
    groups = {g.get("name"): g.get("variables") for g in root.iter("Group")}
    variables = list(enumerate(root.find("ModelVariables"), 1))
    known = {v.get("name"): i for i, v in variables if v.get("causality") in ("parameter", "input")}

    def indices(names, where):
        if names is None:
            refuse(f"{where}: {DECLARED} is missing or names no group; it is empty where there are none")
        found = set()
        for name in names.split():
            pattern = re.escape(name).replace(r"\*", ".*")
            matches = {i for n, i in known.items() if re.fullmatch(pattern, n)}
            if name.startswith("@"):
                matches = indices(groups.get(name[1:]), where)
            if not matches:
                refuse(f"{where}: {DECLARED}: {name} is no parameter or input")
            found |= matches
        return found

    return {
        i: sorted(indices(v.get(DECLARED), v.get("name")))
        for i, v in variables
        if v.get("causality") in ("output", "calculatedParameter")
    }


def final_description(text, root, guid):
    """The model description as FMI has it: with GUID and ModelStructure, without what only the build reads."""
    variables, declared = list(root.find("ModelVariables")), dependencies(root)

    def unknowns(tag, listed):
        lines = [
            f'      <Unknown index="{i}" dependencies="{" ".join(map(str, known))}"/>'
            f" <!-- {variables[i - 1].get('name')} -->\n"
            for i, known in listed.items()
        ]
        return f"<{tag}>\n{''.join(lines)}    </{tag}>"

    # An input set between two steps acts in the next one only: no output has direct feedthrough.
    outputs = {i: () for i in declared if variables[i - 1].get("causality") == "output"}
    for pattern, replacement, count in (
        ('guid=""', f'guid="{guid}"', 1),
        (r"  <DependencyGroups>.*?</DependencyGroups>\n\n", "", 1),
        (rf'\s+{DECLARED}="[^"]*"', "", len(declared)),
        ("<Outputs/>", unknowns("Outputs", outputs), 1),
        ("<InitialUnknowns/>", unknowns("InitialUnknowns", declared), 1),
    ):
        text, found = re.subn(pattern, replacement, text, flags=re.DOTALL)
        if found != count:
            refuse(f"{pattern} is expected {count} times, not {found}")
    return text


def main(source, out_dir):
    text = Path(source).read_text(encoding="utf-8")
    root = ET.fromstring(text)
    guid = "{" + str(uuid.uuid5(uuid.NAMESPACE_URL, text)) + "}"
    out = Path(out_dir)
    out.mkdir(parents=True, exist_ok=True)
    (out / "variables.inc").write_text(table(root, guid), encoding="utf-8")
    (out / "modelDescription.xml").write_bytes(final_description(text, root, guid).encode("utf-8"))


if __name__ == "__main__":
    main(*sys.argv[1:])
