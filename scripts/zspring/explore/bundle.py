"""One HTML file from the page's parts: scripts for page and workers, both modules, parameter sets."""

from __future__ import annotations

import base64
import json
import re
import string
import zipfile
import zlib
from pathlib import Path

from ..errors import ZSpringError
from ..fmu import CATENARY, PANTOGRAPH, installed_fmu
from ..parameter_sets import LINES, PANTOGRAPHS, packaged_sets

HERE = Path(__file__).parent
_IMPORT = re.compile(r'^import \{ (.+) \} from "\./(\w+)\.mjs";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function\*?|class|const) (\w+))", re.MULTILINE)


def script(entry: str) -> str:
    """A script without imports: each module a function of its own, after those that it imports."""
    done: dict[str, str] = {}

    def add(name: str) -> None:
        if name in done:
            return
        source = (HERE / f"{name}.mjs").read_text("utf-8")
        needed = _IMPORT.findall(source)
        for _, other in needed:
            add(other)
        code = _EXPORT.sub("", _IMPORT.sub("", source))
        taken = "".join(f"const {{ {names} }} = $_{other};\n" for names, other in needed)
        if name == entry:
            done[name] = taken + code
        else:
            exports = ", ".join(_EXPORT.findall(source))
            done[name] = f"const $_{name} = (() => {{\n{taken}{code}return {{ {exports} }};\n}})();\n"

    add(entry)
    return "\n".join(done.values())


def module(model: str) -> bytes:
    """The WebAssembly module of a model, in this package. Raises ZSpringError where there is none."""
    path = HERE / f"{model}.wasm"
    if not path.is_file():
        raise ZSpringError(
            "this installation has no WebAssembly modules: in a clone use scripts/explore, else the release's wheel"
        )
    return path.read_bytes()


def page() -> str:
    """The text of the page. Raises ZSpringError where modules are missing or are not those of the FMUs."""
    models = {}
    for model in (PANTOGRAPH, CATENARY):
        with zipfile.ZipFile(installed_fmu(model)) as fmu:
            description = fmu.read("modelDescription.xml").decode()
        found = re.search(r'guid="([^"]*)"', description)
        code = module(model)
        if found is None or found[1].encode() not in code:
            raise ZSpringError(f"{HERE / model}.wasm is of another version than the FMU: build it anew")
        packed = zlib.compress(code, 9)
        models[model] = {"module": base64.b64encode(packed).decode(), "description": description}
    sets, lines = (
        {name: path.read_text("utf-8") for name, path in packaged_sets(kind).items() if path.suffix == ".ssv"}
        for kind in (PANTOGRAPHS, LINES)
    )
    data = json.dumps({"models": models, "sets": sets, "lines": lines}).replace("<", "\\u003c")
    template = string.Template((HERE / "page.html").read_text("utf-8"))
    style = (HERE / "page.css").read_text("utf-8")
    return template.substitute(style=style, data=data, worker=script("worker"), page=script("main"))
