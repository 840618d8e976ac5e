"""The long form of the tests behind docs/trust.md: many more random sets, sequences of calls, resets and steps."""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor

import pytest
from endurance import measure
from random_sets import DECADES, Tally, judge_all
from test_fmi_rules_machine import run_rules
from test_fuzz import fuzz
from zspring.fmu import CATENARY, PANTOGRAPH

MODELS = [PANTOGRAPH, CATENARY]
SETS = 10_000
GROWTH = 1024  # KiB, of resident memory: what the C library keeps at hand


@pytest.mark.parametrize("kind", DECADES)
@pytest.mark.parametrize("model", MODELS)
def test_ten_thousand_random_parameter_sets(model, kind):
    seeds = range(SETS)
    with ProcessPoolExecutor() as pool:
        parts = [pool.submit(judge_all, model, kind, seeds[i::8]) for i in range(8)]
        tallies: list[Tally] = [part.result() for part in parts]
    faults = [fault for tally in tallies for fault in tally.faults]
    assert not faults, f"{len(faults)} faults: {faults[:10]}"
    assert sum(tally.outcomes["ran"] for tally in tallies) > SETS / 5
    assert sum(tally.sensitive for tally in tallies) < SETS / 100


def test_any_order_of_calls_follows_the_rules(model, any_fmu):
    run_rules(model, any_fmu, 1000, 60, derandomize=False)


@pytest.mark.parametrize("model, sequences", [(PANTOGRAPH, 100_000), (CATENARY, 10_000)])
def test_random_sequences_of_calls_break_no_rule(model, sequences):
    assert fuzz(model, "--random", 1_000_000, sequences)["calls"] > 100 * sequences


if sys.platform == "linux":

    @pytest.mark.parametrize("model, steps", [(PANTOGRAPH, 100_000_000), (CATENARY, 500_000)])
    def test_memory_stays_flat_over_many_steps(model, steps):
        _, early, late = measure(model, "soak", steps)
        assert late - early < GROWTH

    @pytest.mark.parametrize("model, resets", [(PANTOGRAPH, 100_000), (CATENARY, 2_000)])
    def test_memory_stays_flat_over_many_resets(model, resets):
        _, early, late = measure(model, "resets", resets)
        assert late - early < GROWTH

    @pytest.mark.parametrize("model, bound", [(PANTOGRAPH, 32), (CATENARY, 4096)])
    def test_a_thousand_instances_at_once(model, bound):
        each, differing = measure(model, "instances", 1000)
        assert differing == 0
        assert each < bound  # KiB

    @pytest.mark.parametrize("model, steps", [(PANTOGRAPH, 1_000_000), (CATENARY, 20_000)])
    def test_eight_threads_give_what_one_gives(model, steps):
        assert measure(model, "threads", steps) == [0]
