"""A Python for Windows under wine in which the release's wheel is installed, as a user's pip does it."""

from __future__ import annotations

import csv
import hashlib
import importlib.metadata
import math
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path

import pytest
from release_tools import DIST, TOOLS, fetch_jars, run_tool, tool

# CPython as Maven has it, by the Python that runs the tests, so that both have the same packages.
CPYTHON = {(3, 11): "3.11.3-1.5.9"}
LIBRARIES = "1.5.9"  # of the jar that has Microsoft's C library
WINDOWS_ALONE = "-Dclassifier=windows-x86_64", "-DexcludeTransitive=true"

# What the wheels need that wine 8 lacks: a DLL of Windows 10 whose one function has another name in all Windows.
RANDOM = """#include <windows.h>
#include <ntsecapi.h>
__declspec(dllexport) BOOL ProcessPrng(PBYTE data, SIZE_T size) { return RtlGenRandom(data, (ULONG)size); }
"""


class WindowsPython:
    """Programs of a Python for Windows, under wine, with Microsoft's own C library."""

    def __init__(self, home: Path, wine: Mapping[str, str]):
        """wine     environment of programs under wine"""
        self.home = home
        self._variables = {name: value for name, value in wine.items() if not name.startswith("PYTHON")}
        self._variables["PYTHONHOME"] = f"Z:{home}"

    def run(self, *command: str | Path, folder: Path, shell: str = "") -> tuple[int, str]:
        """Status, and standard output and error, of a program of this Python; by cmd, with `shell` after it."""
        words = ["cmd", "/c", f"Z:{command[0]}".replace("/", "\\"), *command[1:], *shell.split()] if shell else command
        done = subprocess.run(
            [tool("wine"), *words],
            cwd=folder,
            env=self._variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=900,
        )
        return done.returncode, done.stdout.decode("cp1252").replace("\r\n", "\n")

    def python(self, *arguments: str | Path) -> str:
        status, out = self.run(self.home / "python.exe", *arguments, folder=self.home)
        assert status == 0, out
        return out

    def zspring(self, folder: Path, *arguments: str, shell: str = "") -> tuple[int, str]:
        """Status and what it tells: `zspring`, as pip has installed it."""
        return self.run(self.home / "Scripts" / "zspring.exe", *arguments, folder=folder, shell=shell)


def same_packages() -> list[str]:
    """What is installed here, as constraints: other versions of NumPy or SciPy could have other last digits."""
    return sorted(f"{found.name}=={found.version}" for found in importlib.metadata.distributions())


def with_wheel(wine: Mapping[str, str]) -> WindowsPython:
    """With the release's wheel and what it needs; all but the wheel is kept from one run to the next."""
    if sys.version_info[:2] not in CPYTHON:
        pytest.fail(
            f"Python {sys.version.split()[0]}: must be one of {CPYTHON}, which the test has for Windows too",
            pytrace=False,
        )
    (wheel,) = DIST.glob("*.whl")
    cpython = CPYTHON[sys.version_info[:2]]
    constraints = same_packages()
    key = hashlib.sha256("\n".join([cpython, *constraints]).encode()).hexdigest()[:12]
    home, complete = TOOLS / f"windows-{key}", TOOLS / f"windows-{key}" / "complete"
    python = WindowsPython(home, wine)
    install = ("-m", "pip", "install", "--quiet", "--no-index", "--no-warn-script-location")
    if not complete.exists():
        _extract("cpython", cpython, "", home)
        place_c_library(home)
        (home / "random.c").write_text(RANDOM)
        zig = (
            sys.executable,
            "-m",
            "ziglang",
            "cc",
            "--target=x86_64-windows-gnu",
            "-shared",
            "random.c",
            "-ladvapi32",
        )
        run_tool(*zig, "-o", "bcryptprimitives.dll", folder=home)
        (home / "constraints.txt").write_text("\n".join(constraints))
        target = ("--platform=win_amd64", f"--python-version={cpython[:4]}", "--only-binary=:all:")
        wanted = (wheel, "colorama")  # the latter click and tqdm want on Windows
        download = (sys.executable, "-m", "pip", "download", "--quiet", "--constraint", "constraints.txt", *target)
        run_tool(*download, "--dest", "wheels", *wanted, folder=home)
        python.python(*install, "--find-links=wheels", f"Z:{wheel}")
        complete.touch()
    python.python(*install, "--no-deps", "--force-reinstall", f"Z:{wheel}")
    python.python("-m", "pip", "check")
    return python


def place_c_library(folder: Path) -> None:
    """Microsoft's C library beside a program: wine's has other last digits, and lacks complex numbers."""
    _extract("javacpp", LIBRARIES, "ucrtbase.dll", folder)


def _extract(name: str, version: str, only: str, folder: Path) -> None:
    """What a jar has for Windows, but for Python's own tests; or `only` a file."""
    jars = fetch_jars(TOOLS / f"{name}-{version}", [("org.bytedeco", name, version)], *WINDOWS_ALONE)
    inside = f"org/bytedeco/{name}/windows-x86_64/"
    with zipfile.ZipFile(jars / f"{name}-{version}-windows-x86_64.jar") as archive:
        for entry in archive.infolist():
            path = entry.filename.removeprefix(inside)
            if entry.is_dir() or path == entry.filename or path.startswith("lib/test/") or (only and path != only):
                continue
            entry.filename = path
            archive.extract(entry, folder)


def differences(expected: Path, found: Path, passing: Sequence[str], within: float = 0) -> list[str]:
    """What is not alike in two CSV tables.

    passing     begins of the lines of the head that tell of the run itself: its date, its time
    within      by how much two numbers may differ, as a share of the largest of their column, in the head of themselves
    """
    heads, tables = [], []
    for path in (expected, found):
        lines = path.read_bytes().decode().split("\n")
        heads.append([line.split() for line in lines if line.startswith("#") and not line.startswith(tuple(passing))])
        tables.append(list(csv.reader(line for line in lines if line and line[0] != "#")))
    largest = [max(map(_size, column)) for column in zip(*tables[0])]
    pairs = [
        (a, b, _size(a)) for rows in zip_longest(*heads, fillvalue=[]) for a, b in zip_longest(*rows, fillvalue="")
    ]
    for rows in zip_longest(*tables, fillvalue=[]):
        pairs += zip_longest(*rows, largest, fillvalue="")
    return [
        f"{a} | {b} | of {size}" for a, b, size in pairs if a != b and not abs(_number(a) - _number(b)) <= within * size
    ]


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _size(cell: str) -> float:
    value = abs(_number(cell))
    return value if math.isfinite(value) else 0.0
