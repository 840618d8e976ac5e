"""Newton's tangents of the friction law: what each is shows in how it converges, and all solve the same step."""

from __future__ import annotations

import pytest

COUNTERS = ("solver.steps", "solver.iterations", "solver.iterations_max", "solver.refinements")


@pytest.fixture
def work(pantograph):
    def work(tangent: str, tau: float) -> tuple[list[float], float]:
        """Counters of 4 s on the bench, and where the upper frame is then, m."""
        bench = {"drive": "Bench", "bench.frequency": 5.0, "bench.acceleration": 4.0}
        solver = {"solver.tangent": tangent, "solver.max_iterations": 100, "solver.tolerance": 1e-10}
        p = pantograph({**bench, **solver, "zspring.tau": tau})
        p.step(4.0)
        return [p[name] for name in COUNTERS], p["upper_frame.z"]

    return work


def test_on_a_smooth_law_the_exact_slope_converges_at_second_order_and_the_secant_at_first(work):
    """The mean of both errors of the slope is half the secant's: faster than that, slower than the exact one."""
    found = {tangent: work(tangent, 5.0) for tangent in ("Resolvent", "Exact", "Mean", "Secant")}
    (steps, exact, worst, halved), place = found["Exact"]
    assert worst <= 4 and halved == 0 and exact < 2.5 * steps
    assert found["Resolvent"][0][2] <= 4
    assert 3 * exact < found["Mean"][0][1] < 0.85 * found["Secant"][0][1]
    for _, other in found.values():
        assert other == pytest.approx(place, abs=1e-10)


def test_on_a_steep_law_the_exact_slope_jumps_for_ever_and_the_resolvent_never(work):
    halved = {tangent: work(tangent, 1e3)[0][3] for tangent in ("Resolvent", "Mean", "Secant", "Exact")}
    assert halved["Resolvent"] == 0
    assert halved["Exact"] > 5 * max(halved["Mean"], halved["Secant"]) > 0
