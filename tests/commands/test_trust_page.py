"""docs/trust.md: the deterministic figures come out again, and none of the others shows a fault."""

from __future__ import annotations

import pytest

from trust_page import PAGE, PARTS, cells, numbers, part, stress


def test_the_effort_of_hard_steps_is_that_of_the_page():
    """Nearly: the mathematical functions of another C library may move a few iterations."""
    shown, measured = cells(part(PAGE.read_text("utf-8"), "stress")), cells(stress())
    assert [row[:2] for row in shown] == [row[:2] for row in measured]
    for a, b in zip(shown, measured):
        assert [numbers(cell) for cell in b[2:]] == [pytest.approx(numbers(cell), rel=0.02, abs=1) for cell in a[2:]]


@pytest.mark.parametrize("name", PARTS)
def test_every_part_of_the_page_is_there(name):
    rows = cells(part(PAGE.read_text("utf-8"), name))
    assert len(rows) >= 2 and all(all(cell for cell in row[:2]) for row in rows)
    if name == "random_sets":
        assert {row[-1] for row in rows} == {"0"}  # faults
    if name == "endurance":
        assert all(numbers(result)[-1] == 0 for _, result in rows if "other results" in result)
