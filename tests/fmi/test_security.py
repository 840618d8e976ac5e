"""The archives stay in their folder and the libraries import nothing that reaches out; see SECURITY.md."""

from __future__ import annotations

import stat
import sys
import zipfile
from pathlib import PurePosixPath, PureWindowsPath

import pytest

from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

MODELS = [PANTOGRAPH, CATENARY]

# Environment, processes, threads, network, locale, signals, floating-point mode, output. open() and write() are
# not among them: the C++ runtime imports them for streams and random devices, never used (tests/release).
NEVER = {
    "getenv",
    "secure_getenv",
    "setenv",
    "putenv",
    "environ",
    "system",
    "popen",
    "fork",
    "execve",
    "posix_spawn",
    "dlopen",
    "pthread_create",
    "clone",
    "socket",
    "connect",
    "bind",
    "getaddrinfo",
    "gethostbyname",
    "setlocale",
    "signal",
    "sigaction",
    "fesetround",
    "fesetenv",
    "feenableexcept",
    "chdir",
    "unlink",
    "rename",
    "mkdir",
    "printf",
    "puts",
    "exit",
    "quick_exit",
    "atexit",
}


@pytest.mark.parametrize("model", MODELS)
def test_nothing_leaves_the_folder_an_archive_is_unpacked_in(model):
    with zipfile.ZipFile(installed_fmu(model)) as archive:
        entries = archive.infolist()
        assert archive.testzip() is None
    names = [entry.filename for entry in entries]
    assert len({name.lower() for name in names}) == len(names)
    for entry in entries:
        path = PurePosixPath(entry.filename)
        assert not path.is_absolute() and ".." not in path.parts and "\\" not in entry.filename
        assert not PureWindowsPath(entry.filename).drive and entry.filename.isascii()
        assert not stat.S_ISLNK(entry.external_attr >> 16)
        assert not entry.flag_bits & 1  # encrypted
        assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


@pytest.mark.parametrize("model", MODELS)
def test_the_model_description_needs_nothing_from_elsewhere(model):
    with zipfile.ZipFile(installed_fmu(model)) as archive:
        text = archive.read("modelDescription.xml").decode()
    assert "<!DOCTYPE" not in text and "<!ENTITY" not in text


def undefined_symbols(library: bytes) -> set[str]:
    """Names in the dynamic symbol table of a 64-bit little-endian ELF library that others must define."""

    def number(at: int, size: int) -> int:
        return int.from_bytes(library[at : at + size], "little")

    sections = [number(0x28, 8) + i * number(0x3A, 2) for i in range(number(0x3C, 2))]
    (table,) = (s for s in sections if number(s + 4, 4) == 11)  # SHT_DYNSYM
    begin, size = number(table + 0x18, 8), number(table + 0x20, 8)
    strings = number(sections[number(table + 0x28, 4)] + 0x18, 8)
    names = set()
    for symbol in range(begin, begin + size, 24):
        if number(symbol + 6, 2) == 0:
            at = strings + number(symbol, 4)
            names.add(library[at : library.index(b"\0", at)].decode())
    return names


@pytest.mark.parametrize("model", MODELS)
def test_the_libraries_import_nothing_that_reaches_out(model):
    with zipfile.ZipFile(installed_fmu(model)) as archive:
        libraries = [archive.read(name) for name in archive.namelist() if name.endswith(".so")]
    assert libraries or sys.platform != "linux"
    for library in libraries:
        imported = undefined_symbols(library)
        assert "malloc" in imported  # so reading works
        assert not imported & NEVER
