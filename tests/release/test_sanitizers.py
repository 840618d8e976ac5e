"""Core and FMI layer of both FMUs under sanitizers, valgrind and libFuzzer, driven by tests/native/fuzz."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from release_tools import ROOT, tool
from fuzzing import CORPUS, fuzz
from zspring.fmu import CATENARY, PANTOGRAPH

MODELS = [PANTOGRAPH, CATENARY]
SEQUENCES = {PANTOGRAPH: 2000, CATENARY: 200}
SECONDS_OF_LIBFUZZER = 300
VALGRIND = "--error-exitcode=1 --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all --quiet".split()
MEMORY_AND_UB = "address,undefined,float-cast-overflow"


def run(*command: object) -> str:
    done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    return done.stdout


def built(name: str, sanitizers: str, compiler: str, *options: str) -> Path:
    """Folder of the fuzz programs with these sanitizers; built anew where the sources have changed."""
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
    defined = [f"-D{name}={value}" for name, value in settings.items()]
    run(*cmake, "-S", ROOT, "-B", build, "-G", "Ninja", *defined, *options)
    run(*cmake, "--build", build, "--target", "fuzz")
    return build / "bin"


@pytest.fixture(scope="module")
def compiler() -> str:
    return tool("g++", "apt install g++")


@pytest.mark.parametrize("model", MODELS)
def test_no_memory_error_no_undefined_behaviour_no_leak(model, compiler):
    program = built("memory", MEMORY_AND_UB, compiler) / f"fuzz_{model}"
    run(program, *CORPUS)
    run(program, "--random", 1, SEQUENCES[model])


@pytest.mark.parametrize("model", MODELS)
def test_no_data_race(model, compiler):
    program = built("thread", "thread", compiler) / f"fuzz_{model}"
    run(program, "--random", 1, SEQUENCES[model] // 8, 8)


@pytest.mark.parametrize("model", MODELS)
def test_valgrind_finds_no_error_and_no_leak(model):
    valgrind = [tool("valgrind", "apt install valgrind"), *VALGRIND]
    assert fuzz(model, "--random", 1, SEQUENCES[model] // 20, under=valgrind)["calls"] > 0


@pytest.mark.parametrize("model", MODELS)
def test_libfuzzer_finds_no_fault(model, tmp_path):
    """Goes on with the sequences that earlier runs found worth keeping, in build/fuzz."""
    clang = tool("clang++", "apt install clang libclang-rt-dev")
    program = built("libfuzzer", MEMORY_AND_UB, clang, "-DZSPRING_LIBFUZZER=ON") / f"fuzz_{model}"
    found = ROOT / "build" / "fuzz" / model
    found.mkdir(parents=True, exist_ok=True)
    if not any(found.iterdir()):
        fuzz(model, "--write", 1, 200, found)
    limits = [f"-max_total_time={SECONDS_OF_LIBFUZZER}", "-max_len=1500", "-timeout=60", "-rss_limit_mb=4000"]
    run(program, *limits, f"-artifact_prefix={tmp_path}/", found, CORPUS[0].parent)
