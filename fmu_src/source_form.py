"""The source form of an FMU: the files of its folder sources/, from which any tool can compile it.

Compiling needs a compiler for C++17 with the folder sources/ and the FMI 2.0 headers on its include path, as
buildDescription.xml says (the form of FMI 3.0, which FMI 2.0.4 takes over); tools that do not read it, fmpy among
them, find the list of files in the model description. By the standard the FMI headers are the tool's. The headers
of Eigen that the model includes, directly or not, are among the sources, unchanged and under their own licences
(MPL-2.0, one Apache-2.0, one BSD-3-Clause; see documentation/licenses and the headers).
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

FMU_SRC = Path(__file__).resolve().parent
INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"]', re.MULTILINE)
FOR_OTHER_LIBRARIES = re.compile(r"_(MKL|BLAS|LAPACKE)\.h$|misc/(blas|lapacke)")  # Eigen's headers to call them


def own_sources(model: str, generated: Path) -> dict[str, bytes]:
    """Sources of one model and of its FMI layer, by their path in sources/.

    generated   folder of the model's variables.inc
    """
    files = [file for part in ("common", model, "fmi") for file in (FMU_SRC / part).glob("*.[ch]pp")]
    sources = {file.relative_to(FMU_SRC).as_posix(): file.read_bytes() for file in files}
    sources["fmi/model.hpp"] = (FMU_SRC / "fmi" / model / "model.hpp").read_bytes()
    sources["variables.inc"] = (generated / "variables.inc").read_bytes()
    return sources


def eigen_headers(sources: dict[str, bytes], eigen: Path) -> dict[str, bytes]:
    """The headers of Eigen that `sources` include and what these include, on whatever platform.

    eigen   folder of Eigen/Core
    """
    headers: dict[str, bytes] = {}
    wanted = [eigen / name.decode() for content in sources.values() for name in INCLUDE.findall(content)]
    while wanted:
        file = wanted.pop().resolve()
        if not file.is_file():  # the system's, or of a library that Eigen may be told to use
            continue
        path = file.relative_to(eigen.resolve()).as_posix()
        if path not in headers and not FOR_OTHER_LIBRARIES.search(path):
            headers[path] = file.read_bytes()
            for name in INCLUDE.findall(headers[path]):
                wanted += [file.parent / name.decode(), eigen / name.decode()]
    return headers


def compiled_files(sources: dict[str, bytes]) -> list[str]:
    return sorted(path for path in sources if path.endswith(".cpp"))


def build_description(identifier: str, sources: dict[str, bytes]) -> bytes:
    """buildDescription.xml, with all of the compiled files in one set."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    files = ET.SubElement(configuration, "SourceFileSet", language="C++17")
    for path in compiled_files(sources):
        ET.SubElement(files, "SourceFile", name=path)
    ET.SubElement(files, "PreprocessorDefinition", name="EIGEN_MPL2_ONLY", value="1")
    ET.SubElement(files, "IncludeDirectory", name=".")
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def source_form(identifier: str, model: str, generated: Path, eigen: Path) -> dict[str, bytes]:
    """All files of sources/, by their path in it."""
    sources = own_sources(model, generated)
    return {**sources, **eigen_headers(sources, eigen), "buildDescription.xml": build_description(identifier, sources)}


def list_sources(model_description: bytes, sources: dict[str, bytes]) -> bytes:
    """The model description with the files to compile in its element CoSimulation, which is empty before."""
    files = "".join(f'      <File name="{path}"/>\n' for path in compiled_files(sources))
    element = rf"\1>\n    <SourceFiles>\n{files}    </SourceFiles>\n  </CoSimulation>"
    listed, count = re.subn(r"(<CoSimulation\b[^>]*?)\s*/>", element, model_description.decode())
    if count != 1:
        raise ValueError("modelDescription.xml: exactly one empty element CoSimulation is expected")
    return listed.encode()
