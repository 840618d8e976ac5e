"""What a comparison of communication steps makes of runs whose forces are made up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zspring.couple.compare import STEPS, compare_steps, compared, comparison_table
from zspring.line.result import LineResult
from zspring.line.schemes import SCHEMES, Coupling

SPEED, FINE = 50.0, 1e-3
OFF = {"sequential": 0.5, "parallel": 1.0, "implicit": 2.0, "explicit": 5.0, "jacobi": 7.0}


def made_up(step: float, coupling: Coupling, of_line, of_pantograph) -> LineResult:
    """100 + t, and beyond 10 m from the start off by so many N, up and down in turn, in proportion to the step.

    Before it is off by 1000 N. Each run stops by a step short of the same place.
    """
    assert of_line == of_pantograph == {"solver.step": FINE}
    assert (coupling.drive, coupling.tolerance) == ("Wire", 1e-5)
    time = step * np.arange(round(0.4 / step))
    turns = np.where(np.arange(len(time)) % 2, 1.0, -1.0)
    turns[-1] *= 3
    off = OFF[coupling.scheme] * (step / FINE - (coupling.scheme == "implicit")) * turns
    force = 100 + time + np.where(SPEED * time >= 10 - 1e-9, off, 1000 * off)
    column, nothing = force[:, None], np.zeros((len(time), 1))
    position = 30 + SPEED * time[:, None]
    places, moments = np.array([60.0]), np.zeros((len(time), 1, 2))
    return LineResult(time, position, column, nothing, nothing, places, nothing, time * 0, moments, {}, 7 * step)


def test_errors_are_those_after_the_start_at_the_same_times():
    rows = list(compare_steps(made_up, Coupling("jacobi", tolerance=1e-5), 10.0, (FINE, 2e-3, 4e-3)))
    assert [(row.scheme, row.step) for row in rows] == [
        ("implicit", FINE),
        *((scheme, step) for scheme in ("sequential", "parallel") for step in (FINE, 2e-3, 4e-3)),
        *(("implicit", step) for step in (2e-3, 4e-3)),
        *((scheme, step) for scheme in ("explicit", "jacobi") for step in (FINE, 2e-3, 4e-3)),
    ]
    for row in rows:
        factor = OFF[row.scheme] * (row.step / FINE - (row.scheme == "implicit"))
        count = round(0.2 / row.step)  # from 10 m, 0.2 s, on
        np.testing.assert_allclose(row.rms, factor * np.sqrt((count - 1 + 9) / count), atol=1e-9)
        np.testing.assert_allclose(row.largest, 3 * factor, atol=1e-9)
        assert row.elapsed == 7 * row.step
        time = 0.2 + row.step * np.arange(count)
        turns = np.where(np.arange(count) % 2, 1.0, -1.0) * np.where(np.arange(count) == count - 1, 3, 1)
        force = 100 + time + factor * turns * (-1) ** (round(0.2 / row.step) % 2)
        np.testing.assert_allclose((row.mean, row.deviation), (force.mean(), force.std()), rtol=1e-9)


def test_the_table_has_the_reference_first():
    rows = list(compare_steps(made_up, Coupling(tolerance=1e-5), 10.0, (FINE, 2e-3)))
    lines = [line.split() for line in comparison_table([replace(row, elapsed=1.234) for row in rows])]
    assert lines[1][:4] == ["implicit", "1", "ms", "reference"] and lines[1][-2:] == ["1.23", "s"]
    assert lines[8][:3] == ["explicit", "2", "ms"] and lines[8][5:7] == ["30", "N"]


def test_side_by_side_coupling_is_compared_where_it_is_possible():
    assert compared("Wire") == SCHEMES and compared("Force") == ("implicit", "explicit")
    assert STEPS == (5e-4, 1e-3, 2e-3, 5e-3)
