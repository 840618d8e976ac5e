"""A step much longer than those before it: what was seen over short ones tells nothing of its end."""

from __future__ import annotations

import pytest

from harness import Signal

MOTION = Signal.cubed_sines([0.01], [1.2])


def test_the_acceleration_after_a_long_step_is_the_one_that_was_told(pantograph):
    """300 steps of 1 ms, then one of 0.2 s: over that the input has the curvature given at its begin."""
    p = pantograph({"drive": "Displacement"})
    p.run(0.001, 300, [], signals={"head_displacement": MOTION})
    p.run(0.2, 1, [], signals={"head_displacement": MOTION})
    assert p["head.a"] == pytest.approx(MOTION(0.3, 2), rel=1e-9)


def test_over_even_steps_the_acceleration_is_continued_to_their_end(pantograph):
    p = pantograph({"drive": "Displacement"})
    p.run(0.001, 300, [], signals={"head_displacement": MOTION})
    assert p["head.a"] == pytest.approx(MOTION(0.3, 2), rel=1e-3)
