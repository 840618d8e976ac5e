"""What README and docs/studies.md say of friction on irregular lines, by the example as a user runs it: minutes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from commands import start, table
from paths import ROOT

CONDITIONS = [(speed, count, i) for speed in (200, 225, 250, 275, 300) for count, i in ((1, 1), (2, 1), (2, 2))]
Figures = Mapping[tuple[float, int, int, str], np.ndarray]  # (30,) by speed, pantographs, which, head


@pytest.fixture(scope="module")
def deviations(tmp_path_factory) -> Figures:
    """Standard deviations in the order of the lines."""
    folder = tmp_path_factory.mktemp("friction")
    process = start(folder, "study", str(ROOT / "resources/examples/study-friction.toml"), "--output", "out")
    _, err = process.communicate(timeout=3600)
    assert process.returncode == 0, err
    rows = table(folder / "out/study.csv")
    assert len(rows) == 1500 and {row["status"] for row in rows} == {"ok"}
    found: dict[tuple[float, int, int, str], list[float]] = {}
    for row in sorted(rows, key=lambda row: int(row["irregularity.line"])):
        speed, count = float(row["couple.speed [km/h]"]), int(row["couple.pantographs"])
        for i in range(1, count + 1):
            key = speed, count, i, row["compare"]
            found.setdefault(key, []).append(float(row[f"standard_deviation {i} [N]"]))
    return {key: np.array(values) for key, values in found.items()}


def paired(deviations: Figures, other: str) -> tuple[np.ndarray, np.ndarray]:
    """Mean differences of the Z-spring from another head, N, and half their 95 % intervals, by condition."""
    by = np.array([deviations[(*where, "Z-spring")] - deviations[(*where, other)] for where in CONDITIONS])
    return by.mean(axis=1), 2.045 * by.std(axis=1, ddof=1) / 30**0.5  # Student's, of 29 degrees of freedom


def test_friction_lowers_the_deviation_against_linear_heads_as_stiff(deviations):
    for other in ("rods free", "matched stiffness"):
        mean, half = paired(deviations, other)
        assert np.all(mean + half < 0) and half.max() < 0.135
        assert -1.15 < mean.min() < -1.0 and -0.4 < mean.max() < -0.25
    levels = [deviations[(*where, "Z-spring")].mean() for where in CONDITIONS]
    assert min(levels) == pytest.approx(22, abs=0.5) and max(levels) == pytest.approx(45, abs=0.6)


def test_a_damper_does_what_friction_does(deviations):
    mean, _ = paired(deviations, "matched and damped")
    assert np.abs(mean).max() == pytest.approx(0.31, abs=0.02)


def test_against_locked_rods_the_sign_hangs_on_the_speed(deviations):
    mean, half = paired(deviations, "rods locked")
    assert mean.min() == pytest.approx(-4.3, abs=0.1) and mean.max() == pytest.approx(1.0, abs=0.1)
    assert np.any(mean - half > 0) and np.any(mean + half < 0)
