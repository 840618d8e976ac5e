"""Intervals of an identification hold the truth as often as they say, on data of an integrator that is not ours."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from reference import Reference
from reference_bench import receptance
from zspring.bench.curves import Curve
from zspring.bench.model import BenchModel
from zspring.fmu import Fmu
from zspring.identify.fit import fit
from zspring.identify.posterior import sample
from zspring.identify.problem import Problem, ZSpringModel
from zspring.identify.profile import profile_interval
from zspring.identify.settings import Free, Settings

TRUTH = {"zspring.k": 11500.0, "zspring.l0": 0.019, "zspring.Mf": 0.25}
STATIC_FORCE = 90.0
LEVELS = {0.5: (5.0, 6.0, 7.0), 2.0: (4.0, 6.0), 6.0: (4.0, 5.0, 8.0)}  # m/s2: Hz
NOISE = 0.01  # of magnitude (relative) and phase (rad)
SEEDS, DRAWS = 30, 90


@pytest.fixture(scope="module")
def exact(fmu) -> dict[float, np.ndarray]:
    """Receptances by level, of the independent model."""
    parameters = {"drive": "Displacement", "suspension": "ZSpring", "friction": "Regularized"}
    reference = Reference(fmu, {**parameters, **TRUTH, "static_force": STATIC_FORCE})
    return {a: np.array([receptance(reference, f, a) for f in frequencies]) for a, frequencies in LEVELS.items()}


def test_95_percent_intervals_hold_the_truth_in_90_to_100_percent(exact):
    """Three parameters, 30 measurements; by standard errors, profiles and posterior."""
    held = {"standard error": 0, "profile": 0, "posterior": 0}
    ranges = {"zspring.k": (5e3, 2.5e4), "zspring.l0": (0.01, 0.024), "zspring.Mf": (0.1, 0.5)}
    free = {name: Free(start=value, min=ranges[name][0], max=ranges[name][1]) for name, value in TRUTH.items()}
    truth = np.array([each.x(each.start) for each in free.values()])
    with Fmu() as model, model.instances(3) as instances:
        law = model.variables.parse_assignments(["friction=Regularized"])
        fixed = {**law, "static_force": STATIC_FORCE, "solver.step": 5e-4}
        settings = Settings.model_construct(model="zspring", free=free, fixed=fixed, weights="errors")
        bench = BenchModel(instances, "rest", threading.Event())
        for seed in range(SEEDS):
            rng, curves = np.random.default_rng(seed), []
            for a, frequencies in LEVELS.items():
                parts = NOISE * rng.standard_normal((2, len(frequencies)))
                error = np.full((len(frequencies), 2), NOISE)
                H = exact[a] * np.exp(parts[0] + 1j * parts[1])
                curves.append(Curve(f"{a} m/s2", np.array(frequencies), np.full(H.shape, a), H, error))
            problem = Problem(settings, ZSpringModel(bench, curves, None), curves)
            found = fit(problem, truth, lambda cost: None)
            held["standard error"] += np.sum(np.abs(found.values - list(TRUTH.values())) < 1.96 * found.standard_error)
            intervals = [profile_interval(problem, found, i, 0.95, lambda cost: None) for i in range(3)]
            held["profile"] += sum(low <= at <= high for at, (low, high) in zip(truth, intervals))

            def costs(xs: np.ndarray, problem: Problem = problem, found=found) -> np.ndarray:
                return problem.costs(list(xs), found.answer)

            low, high = sample(problem, found, DRAWS, seed, costs).interval(0.95)
            held["posterior"] += np.sum((low <= truth) & (truth <= high))
        bench.close()
    print("HELD", held)
    for kind, count in held.items():
        assert 0.9 <= count / (3 * SEEDS) <= 1, (kind, count)
