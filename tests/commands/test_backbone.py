"""Resonances by phase against closed forms, what belongs to which peak, and the table that `frf` writes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from linear import PUBLISHED, LinearPantograph
from zspring.bench.points import FrfPoint
from zspring.bench.refine import Extreme
from zspring.cli import main
from zspring.frf.backbone import PhaseResonance, Row, phase_resonances
from zspring.tables import read_rows


def linear() -> LinearPantograph:
    values = dict(PUBLISHED["DSA-380"])
    return LinearPantograph(head=values.pop("k1"), **values)


@pytest.mark.parametrize("step", [0.1, 0.25])
def test_a_resonance_by_phase_lies_where_the_real_part_of_the_receptance_vanishes(step):
    model = linear()
    points = [
        FrfPoint(1.0, f, "settled", model.receptance(f), remaining=0.0) for f in np.arange(2.0, 14.0, step).tolist()
    ]
    (found,) = phase_resonances(points)
    exact = brentq(lambda f: model.receptance(f).real, 6.0, 7.0)
    assert abs(found.frequency - exact) <= found.frequency_error < 0.02
    assert found.magnitude == pytest.approx(abs(model.receptance(exact)), rel=1e-2)
    # At the antiresonance the real part changes from negative to positive: no resonance.
    assert not phase_resonances([p for p in points if p.frequency < 5.5])


def test_it_belongs_to_the_peak_between_the_same_antiresonances():
    valley, peak, hollow, second = (Extreme(i % 2 == 1, 4.0 + i, 0.01, 1e-4, 1e-7) for i in range(4))
    found = [PhaseResonance(f, 1e-3, 1e-4) for f in (3.5, 5.4, 4.8, 6.5)]
    row = Row("1 m/s2", "up", [valley, peak, hollow, second], found, 1.0, "m/s2")
    assert [row.by_phase(i) for i in range(4)] == [None, found[2], None, found[3]]
    assert row.displacement(peak) == pytest.approx(1.0 / (2 * np.pi * 5) ** 2)
    assert Row("2 N", "up", [peak], (), 2.0, "N").displacement(peak) == pytest.approx(2e-4)
    assert Row("1 m/s", "up", [peak], (), 1.0, "m/s").displacement(peak) == pytest.approx(1 / (10 * np.pi))
    assert math.isnan(Row("locked", "", [peak]).displacement(peak))
    assert Row("1 m/s2", "up", [valley]).highest is None and row.highest in (peak, second)


def test_the_table_has_both_resonances_of_a_linear_pantograph(tmp_path):
    """Of every level the same, and those of the linear model exactly."""
    out = str(tmp_path / "out")
    chosen = ["--set", "suspension=Linear", "--amplitudes", "1,2", "--frequencies", "5:8:0.5", "--output", out]
    assert main(["frf", *chosen]) == 0
    _, rows = read_rows(tmp_path / "out/resonances.csv")
    model = linear()
    by_phase = brentq(lambda f: model.receptance(f).real, 6.0, 7.0)
    by_peak = minimize_scalar(lambda f: -abs(model.receptance(f)), bounds=(6, 7), options={"xatol": 1e-9}).x
    assert {row["curve"] for row in rows} == {"linear", "1 m/s2", "2 m/s2"}
    for row in rows:
        exact = row["curve"] == "linear"
        assert float(row["frequency [Hz]"]) == pytest.approx(by_peak, abs=1e-6 if exact else 2e-3)
        assert float(row["phase_frequency [Hz]"]) == pytest.approx(by_phase, abs=1e-9 if exact else 3e-3)
        if not exact:
            level, omega = float(row["curve"].split()[0]), 2 * np.pi * by_peak
            assert float(row["displacement [m]"]) == pytest.approx(level / omega**2, rel=2e-3)
    assert (tmp_path / "out/backbone.png").exists()
