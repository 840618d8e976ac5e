"""Any sequence of FMI calls, any bytes as a state: judged call by call in C++ against a small model of the rules.

tests/native/fuzz judges; here it replays what once was a fault and runs some random sequences, also with sanitizers
where a compiler has them. Longer, and with other sanitizers and libFuzzer: tests/release/test_sanitizers.py.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from fuzzing import CORPUS, fuzz
from probe import probe_folder
from sanitizers import check_memory_and_ub, sanitizing_compiler

COMPILER = sanitizing_compiler()


@pytest.mark.parametrize("model", ["ZSpringPantograph", "Catenary"])
def test_what_once_was_a_fault_is_none_any_more(model):
    assert fuzz(model, *CORPUS)["calls"] > 100


@pytest.mark.parametrize("model, sequences", [("ZSpringPantograph", 3000), ("Catenary", 600)])
def test_random_sequences_of_calls_break_no_rule(model, sequences):
    done = fuzz(model, "--random", 1, sequences)
    assert done["calls"] > 100 * sequences
    for kind in ("refused", "steps", "discarded", "states", "foreign", "replays"):
        assert done[kind] > 0.05 * sequences, kind
    assert done["situations"] > 0.9 * 27 * 5  # kinds of call, states of an instance


@pytest.mark.parametrize("model", ["ZSpringPantograph", "Catenary"])
def test_eight_threads_with_their_own_instances_break_no_rule(model):
    assert fuzz(model, "--random", 100_000, 20, 8)["calls"] > 100 * 160


def test_a_damaged_table_of_a_line_is_refused_or_moves():
    done = subprocess.run([probe_folder() / "fuzz_line_table", "1", "4000"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    refused, moved = map(int, re.findall(r"\d+", done.stdout))
    assert refused + moved == 4000 and min(refused, moved) > 400


@pytest.mark.skipif(not COMPILER, reason="needs g++ or clang++ with sanitizers, on Linux")
@pytest.mark.parametrize("model, sequences", [("ZSpringPantograph", 1000), ("Catenary", 200)])
def test_no_memory_error_no_undefined_behaviour_no_leak(model, sequences):
    check_memory_and_ub(model, sequences, COMPILER)
