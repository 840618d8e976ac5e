"""The uplift with which a run has a mean force: on laws whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from zspring.errors import ZSpringError
from zspring.line.mean_force import uplifts_for


def solved(law, target: float = 169.3, first=(49.3,)) -> tuple[tuple[float, ...], list[tuple[float, ...]]]:
    """The uplifts, and those of all runs."""
    made = []

    def means(uplifts):
        made.append(uplifts)
        return law(np.array(uplifts))

    return uplifts_for(target, first, means), made


def test_a_mean_force_that_is_met_takes_one_run():
    found, made = solved(lambda uplifts: 120.05 + uplifts)
    assert found == (49.3,) and len(made) == 1


@pytest.mark.parametrize("carried", [0.05, 0.3])
def test_where_a_spring_carries_a_part_it_takes_three_runs(carried):
    """A mean force of 112 N and the uplift's rest: the first correction takes a slope of 1, the second the secant."""
    found, made = solved(lambda uplifts: 112 + (1 - carried) * uplifts)
    assert 112 + (1 - carried) * found[0] == pytest.approx(169.3, abs=0.1)
    assert len(made) <= 3 and made[-1] == found


def test_each_pantograph_has_an_uplift_of_its_own():
    """The second one's mean depends a little on the first one's uplift."""
    found, made = solved(lambda u: [110 + 0.9 * u[0], 105 + 0.8 * u[1] - 0.05 * u[0]], first=(49.3, 49.3))
    means = 110 + 0.9 * found[0], 105 + 0.8 * found[1] - 0.05 * found[0]
    assert means == pytest.approx((169.3, 169.3), abs=0.1) and len(made) <= 4


def test_a_force_that_bends_is_met_too():
    found, _ = solved(lambda uplifts: 120 + uplifts - 0.002 * uplifts**2)
    assert 120 + found[0] - 0.002 * found[0] ** 2 == pytest.approx(169.3, abs=0.1)


def test_a_force_that_no_uplift_gives_is_told():
    with pytest.raises(ZSpringError, match=r"mean force = 150\.0 N after 8 runs: 169\.3 N is not reached"):
        solved(lambda uplifts: np.minimum(150, 120 + uplifts))
