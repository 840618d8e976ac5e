"""Builds both models as WebAssembly modules with zig, from the same sources as the FMUs, for browsers and node.

A module has the functions of FMI 2.0 for co-simulation, malloc and free, its memory and its table of functions. It
asks for nothing but WASI's calls for files, and is content where these find none. zig's libraries for WASI lack what
throws exceptions: that is compiled here from zig's own sources of libunwind and libc++abi, with WebAssembly's own
exceptions. Never with -flto: catches are then lost.
"""

from __future__ import annotations

import importlib.util
import os
import re
import sys
import sysconfig
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from bootstrap import BUILD, DESCRIPTIONS, ROOT, fingerprint
from setup_tools import Runner, SetupError

sys.path.insert(0, str(ROOT / "fmu_src"))
import generate_variables

MODULES = BUILD / "webassembly"
STAMP = MODULES / "sources.sha256"
SOURCES = [*DESCRIPTIONS, "fmu_src", "scripts/tooling/webassembly.py"]
SITE = Path(sysconfig.get_paths()["purelib"])
EIGEN = SITE / "cmeel.prefix" / "include" / "eigen3"
FMI_HEADERS = SITE / "fmpy" / "c-code"

TARGET = ["-target", "wasm32-wasi", "-mcpu=baseline+exception_handling+simd128", "-O2"]
EXCEPTIONS = [*TARGET, "-fwasm-exceptions"]
# As CMakeLists.txt has them, so that the results are those of the FMUs.
MODEL = ["-std=c++17", "-DNDEBUG", "-DEIGEN_MPL2_ONLY", "-Wall", "-Wextra", "-fno-math-errno", "-ffp-contract=off"]
LINK = [
    "-mexec-model=reactor",  # a library: no main
    "-Wl,-z,stack-size=262144",  # bytes; zig's default is 16 MiB for each instance
    "-Wl,--export-table",
    "-Wl,--growable-table",  # for the logger
    "-s",
]
TAG = "\t.tagtype __cpp_exception i32\n\t.globl __cpp_exception\n__cpp_exception:\n"  # what C++ throws


def functions() -> list[str]:
    """Names of the functions of FMI 2.0 for co-simulation, from the standard's header."""
    header = (FMI_HEADERS / "fmi2Functions.h").read_text("utf-8")
    for_all, _, rest = header[header.index("FMI2_Export fmi2GetTypesPlatform") :].partition("for Model Exchange")
    for_co_simulation = rest.partition("for FMI2 for Co-Simulation")[2]
    return re.findall(r"FMI2_Export\s+\w+\s+(fmi2\w+);", for_all + for_co_simulation)


class Compiler:
    """zig for WebAssembly, into a folder of objects; `run` logs and raises SetupError."""

    def __init__(self, runner: Runner, objects: Path):
        self._runner, self._objects = runner, objects

    def __call__(self, source: Path, *options: str | Path) -> Path:
        """The object of one source."""
        made = self._objects / f"{source.parent.name}-{source.name}.o"
        language = "c++" if source.suffix == ".cpp" else "cc"
        self._zig(language, *options, "-c", source, "-o", made)
        return made

    def link(self, objects: list[Path], module: Path) -> None:
        exports = [f"-Wl,--export={name}" for name in [*functions(), "malloc", "free"]]
        self._zig("c++", *EXCEPTIONS, *objects, *LINK, *exports, "-o", module)

    def _zig(self, *arguments: str | Path) -> None:
        command: list[str | Path] = [sys.executable, "-m", "ziglang", *arguments]
        self._runner.run("cannot build the WebAssembly modules", command)


def runtime(folder: Path) -> list[tuple[Path, list[str]]]:
    """What throws and catches: sources with their options."""
    found = importlib.util.find_spec("ziglang")
    if found is None or found.origin is None:
        raise SetupError("ziglang is missing: scripts/explore and scripts/package install it")
    library = Path(found.origin).parent / "lib"
    unwind, abi = library / "libunwind", library / "libcxxabi"
    tag = folder / "tag.s"
    tag.write_text(TAG)
    headers = [f"-I{unwind / 'include'}", f"-I{unwind / 'src'}", f"-I{abi / 'include'}", f"-I{abi / 'src'}"]
    internal = [f"-I{library / 'libcxx' / 'src'}", "-D_LIBCXXABI_BUILDING_LIBRARY", "-D_LIBCPP_BUILDING_LIBRARY"]
    internal += ["-D_LIBCXXABI_HAS_NO_THREADS", "-DLIBCXXABI_NON_DEMANGLING_TERMINATE", "-std=c++23"]
    return [
        (tag, TARGET),
        (unwind / "src" / "Unwind-wasm.c", [*EXCEPTIONS, *headers, "-D_LIBUNWIND_HIDE_SYMBOLS"]),
        *(
            (abi / "src" / f"cxa_{name}.cpp", [*EXCEPTIONS, *headers, *internal])
            for name in ("exception", "personality")
        ),
    ]


def models() -> dict[str, tuple[str, Path]]:
    """Folder in fmu_src and description of each model, by its identifier."""
    found = {}
    for file in DESCRIPTIONS:
        identifier = next(ET.parse(ROOT / file).iter("CoSimulation")).attrib["modelIdentifier"]
        found[identifier] = "catenary" if "catenary" in file else "pantograph", ROOT / file
    return found


def module_files() -> dict[str, Path]:
    """Where the modules are, or will be, by their models' identifiers."""
    return {identifier: MODULES / f"{identifier}.wasm" for identifier in models()}


def are_built() -> bool:
    """Whether they are there, of the sources as they are now."""
    known = STAMP.read_text() if STAMP.exists() else ""
    return known == fingerprint(*SOURCES) and all(module.exists() for module in module_files().values())


def build(runner: Runner) -> dict[str, Path]:
    """The modules by their models' identifiers, built where the sources have changed. Raises SetupError."""
    modules = module_files()
    if are_built():
        return modules
    wanted = fingerprint(*SOURCES)
    MODULES.mkdir(parents=True, exist_ok=True)
    STAMP.unlink(missing_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        common = Compiler(runner, MODULES)
        shared = [pool.submit(common, source, *options) for source, options in runtime(MODULES)]
        compiled = {}
        for identifier, (model, description) in models().items():
            folder = MODULES / model
            generate_variables.main(description, folder)
            includes = [ROOT / "fmu_src", folder, ROOT / "fmu_src" / "fmi", ROOT / "fmu_src" / "fmi" / model]
            options = [*EXCEPTIONS, *MODEL, *(f"-I{path}" for path in includes)]
            options += ["-isystem", str(EIGEN), "-isystem", str(FMI_HEADERS)]
            sources = sorted(path for part in (model, "fmi") for path in (ROOT / "fmu_src" / part).glob("*.cpp"))
            compiler = Compiler(runner, folder)
            compiled[identifier] = compiler, [pool.submit(compiler, source, *options) for source in sources]
        for identifier, (compiler, objects) in compiled.items():
            compiler.link([made.result() for made in [*objects, *shared]], modules[identifier])
    STAMP.write_text(wanted)
    return modules
