"""What a shared library for Linux, Windows or macOS exports and needs, read from the file with LIEF."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy
import lief

lief.logging.disable()  # it finds fault with the symbol tables of zig's Mach-O files, which it then reads right

# The C library of the platform, by the names under which a library loads its parts.
C_LIBRARY = {
    "linux": r"(libc|libm|libdl|libpthread|ld-linux-(x86-64|aarch64))\.so\.\d",
    "windows": r"KERNEL32\.dll|api-ms-win-crt-\w+-l1-1-0\.dll|ucrtbase\.dll",
    "macos": r"/usr/lib/libSystem\.B\.dylib",
}


def system(library: lief.Binary) -> str:
    return {lief.ELF.Binary: "linux", lief.PE.Binary: "windows", lief.MachO.Binary: "macos"}[type(library)]


def read(path: Path) -> lief.Binary:
    library = lief.parse(path)
    assert library is not None, f"{path} is no library"
    return library


def fmi2_functions() -> set[str]:
    """Names of the 34 functions of FMI 2.0 for co-simulation, from the standard's header."""
    header = (Path(fmpy.__file__).parent / "c-code" / "fmi2Functions.h").read_text("utf-8")
    for_all, _, rest = header[header.index("FMI2_Export fmi2GetTypesPlatform") :].partition("for Model Exchange")
    for_co_simulation = rest.partition("for FMI2 for Co-Simulation")[2]
    names = re.findall(r"FMI2_Export\s+\w+\s+(fmi2\w+);", for_all + for_co_simulation)
    assert len(names) == 34
    return set(names)


def exported(library: lief.Binary) -> set[str]:
    """Names that another program can look up."""
    if isinstance(library, lief.ELF.Binary):
        return {s.name for s in library.dynamic_symbols if s.exported}
    if isinstance(library, lief.PE.Binary):
        return {entry.name for entry in library.get_export().entries}
    trie = library.dyld_info if library.has_dyld_info else library.dyld_exports_trie
    # The linker itself adds the two names of every image, which lead to its own header.
    names = {entry.symbol.name for entry in trie.exports} - {"__mh_dylib_header", "___dso_handle"}
    return {name.removeprefix("_") for name in names}


def foreign(library: lief.Binary) -> list[str]:
    """Libraries that it needs beside the platform's C library."""
    if isinstance(library, lief.MachO.Binary):
        own = lief.MachO.LoadCommand.TYPE.ID_DYLIB
        needed = [entry.name for entry in library.libraries if entry.command != own]
    else:
        needed = list(library.libraries)
    return [name for name in needed if not re.fullmatch(C_LIBRARY[system(library)], name)]


def glibc_needed(library: lief.ELF.Binary) -> tuple[int, ...]:
    """The newest version of glibc of which it needs a function, (2, 17) for 2.17."""
    names = [need.name for file in library.symbols_version_requirement for need in file.get_auxiliary_symbols()]
    assert names and all(name.startswith("GLIBC_") for name in names)
    return max(tuple(map(int, name.removeprefix("GLIBC_").split("."))) for name in names)
