"""Core and FMI layer of both FMUs under sanitizers, valgrind and libFuzzer, driven by tests/native/fuzz."""

from __future__ import annotations

import pytest
from release_tools import ROOT, tool

from fuzzing import CORPUS, fuzz
from sanitizers import MEMORY_AND_UB, check_memory_and_ub, run, sanitized, sanitizing_compiler
from zspring.fmu import CATENARY, PANTOGRAPH

MODELS = [PANTOGRAPH, CATENARY]
SEQUENCES = {PANTOGRAPH: 20_000, CATENARY: 1000}
SECONDS_OF_LIBFUZZER = 300
VALGRIND = "--error-exitcode=1 --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all --quiet".split()


@pytest.fixture(scope="module")
def compiler() -> str:
    found = sanitizing_compiler()
    if found is None:
        pytest.fail("no compiler with sanitizers: apt install g++", pytrace=False)
    return found


@pytest.mark.parametrize("model", MODELS)
def test_no_memory_error_no_undefined_behaviour_no_leak(model, compiler):
    check_memory_and_ub(model, SEQUENCES[model], compiler)


@pytest.mark.parametrize("model", MODELS)
def test_no_data_race(model, compiler):
    program = sanitized("thread", "thread", compiler) / f"fuzz_{model}"
    run(program, "--random", 1, SEQUENCES[model] // 8, 8)


@pytest.mark.parametrize("model", MODELS)
def test_valgrind_finds_no_error_and_no_leak(model):
    valgrind = [tool("valgrind"), *VALGRIND]
    assert fuzz(model, "--random", 1, SEQUENCES[model] // 100, under=valgrind)["calls"] > 0


@pytest.mark.parametrize("model", MODELS)
def test_libfuzzer_finds_no_fault(model, tmp_path):
    """Goes on with the sequences that earlier runs found worth keeping, in build/fuzz."""
    clang = tool("clang++")
    program = sanitized("libfuzzer", MEMORY_AND_UB, clang, "-DZSPRING_LIBFUZZER=ON") / f"fuzz_{model}"
    found = ROOT / "build" / "fuzz" / model
    found.mkdir(parents=True, exist_ok=True)
    if not any(found.iterdir()):
        fuzz(model, "--write", 1, 200, found)
    limits = [f"-max_total_time={SECONDS_OF_LIBFUZZER}", "-max_len=1500", "-timeout=60", "-rss_limit_mb=4000"]
    run(program, *limits, f"-artifact_prefix={tmp_path}/", found, CORPUS[0].parent)
