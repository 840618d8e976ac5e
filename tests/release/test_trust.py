"""The figures of docs/trust.md come out of the release FMUs; the page with the new ones is build/release/trust.md."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from release_tools import ROOT

from rules_machine import run_rules
from trust_page import PAGE, PARTS, cells, measure_into, numbers, part
from zspring.fmu import CATENARY, PANTOGRAPH

GROWTH = 1024  # KiB, of resident memory: what the C library keeps at hand
SLACK = {"stress": 1, "random_sets": 5, "calls": 20}  # of counts, where 2 % is less
LARGEST = {PANTOGRAPH: 32, CATENARY: 4096}  # KiB, of an instance


@pytest.fixture(scope="module")
def page() -> Path:
    path = ROOT / "build" / "release" / "trust.md"
    shutil.copyfile(PAGE, path)
    return path


@pytest.mark.parametrize("name", PARTS)
def test_the_figures_of_the_page_are_those_of_the_release(name, page):
    """Counts nearly: the mathematical functions of another C library may move a few."""
    shown, measured = cells(part(PAGE.read_text("utf-8"), name)), cells(measure_into(page, name))
    assert [row[0] for row in measured] == [row[0] for row in shown]
    if name == "endurance":
        assert_flat_and_equal(measured)
    elif name != "time_of_a_step":
        for a, b in zip(shown, measured):
            expected = [pytest.approx(numbers(cell), rel=0.02, abs=SLACK[name]) for cell in a[1:]]
            assert [numbers(cell) for cell in b[1:]] == expected, a[0]
    if name == "random_sets":  # which tell the worst error too; one of above 1e-4 is a fault
        assert {row[-1] for row in measured} == {"0"}


def assert_flat_and_equal(rows: list[list[str]]) -> None:
    for test, result in rows:
        found = numbers(result)
        if "more memory" in result:
            assert found[0] < GROWTH, test
        else:
            assert found[-1] == 0, test  # with other results
        if "KiB each" in result:
            assert found[0] < LARGEST[test.partition(":")[0]], test


def test_any_order_of_calls_follows_the_rules(model, any_fmu):
    run_rules(model, any_fmu, 1000, 60, derandomize=False)
