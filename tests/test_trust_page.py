"""docs/trust.md: the deterministic figures come out again, and none of the others shows a fault."""

from __future__ import annotations

import pytest

from trust_page import PAGE, PARTS, part, stress


def cells(table: str) -> list[list[str]]:
    """Rows of a table without its head."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


def test_the_effort_of_hard_steps_is_that_of_the_page():
    """Nearly: the mathematical functions of another C library may move a few iterations."""
    shown, measured = cells(part(PAGE.read_text("utf-8"), "stress")), cells(stress())
    assert [row[:2] for row in shown] == [row[:2] for row in measured]
    for a, b in zip(shown, measured):
        numbers = [[float(cell.replace(" ", "")) for cell in row[2:]] for row in (a, b)]
        assert numbers[1] == pytest.approx(numbers[0], rel=0.02, abs=1)


@pytest.mark.parametrize("name", PARTS)
def test_every_part_of_the_page_is_there(name):
    rows = cells(part(PAGE.read_text("utf-8"), name))
    assert len(rows) >= 2 and all(all(cell for cell in row[:2]) for row in rows)
    if name == "random_sets":
        assert {row[-1] for row in rows} == {"0"}
