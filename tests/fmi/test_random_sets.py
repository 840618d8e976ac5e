"""Any parameters: a run is finite, converged and balanced, or refused with a reason; 10 000 in tests/release."""

from __future__ import annotations

import pytest

from random_sets import DECADES, judge_all
from zspring.fmu import CATENARY, PANTOGRAPH


@pytest.mark.parametrize("kind", DECADES)
@pytest.mark.parametrize("model", [PANTOGRAPH, CATENARY])
def test_random_parameters_and_jumping_inputs_never_give_nonsense(model, kind):
    tally = judge_all(model, kind, range(200))
    assert not tally.faults
    assert tally.outcomes["ran"] > 40
    if kind == "far outside":
        assert tally.outcomes["refused"] > 5
