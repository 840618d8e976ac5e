"""The programs of tests/native/fuzz built with a compiler's sanitizers, core and FMI layer inside."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fuzzing import CORPUS
from paths import ROOT

MEMORY_AND_UB = "address,undefined,float-cast-overflow"  # address: leaks too


def run(*command: object) -> str:
    """What a program prints. Raises AssertionError, with the end of that, where it fails."""
    done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    return done.stdout


def sanitizing_compiler() -> str | None:
    """g++ or clang++ on Linux, where it has the sanitizers' libraries."""
    if not sys.platform.startswith("linux"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "main.cpp")
        source.write_text("int main() {}\n")
        for name in "g++", "clang++":
            command = [name, f"-fsanitize={MEMORY_AND_UB}", source, "-o", source.with_suffix("")]
            if shutil.which(name) and subprocess.run(command, capture_output=True).returncode == 0:
                return name
    return None


def sanitized(name: str, sanitizers: str, compiler: str, *options: str) -> Path:
    """Folder of the fuzz programs with these sanitizers; built anew where the sources have changed.

    name        of its folder in build
    options     more of CMake's
    """
    build = ROOT / "build" / f"sanitize-{name}"
    cmake = [sys.executable, "-m", "cmake"]
    settings = {
        "CMAKE_CXX_COMPILER": compiler,
        "CMAKE_BUILD_TYPE": "Debug",
        "CMAKE_CXX_FLAGS_DEBUG": "-O1 -g",
        "ZSPRING_TESTS": "ON",
        "ZSPRING_SANITIZE": sanitizers,
        "Python3_EXECUTABLE": sys.executable,
    }
    defined = [f"-D{key}={value}" for key, value in settings.items()]
    run(*cmake, "-S", ROOT, "-B", build, "-G", "Ninja", *defined, *options)
    run(*cmake, "--build", build, "--target", "fuzz")
    return build / "bin"


def check_memory_and_ub(model: str, sequences: int, compiler: str) -> None:
    """No memory error, no leak and no undefined behaviour in what once was a fault and in random sequences."""
    program = sanitized("memory", MEMORY_AND_UB, compiler) / f"fuzz_{model}"
    run(program, *CORPUS)
    run(program, "--random", 1, sequences)
    if model == "Catenary":
        run(program.with_name("fuzz_line_table"), 1, 3 * sequences)
