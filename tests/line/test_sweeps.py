"""The loops over the line's stations, and lines of any length."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest

from probe import probe_folder


def test_both_kinds_of_processors_give_the_same_bits():
    done = subprocess.run([probe_folder() / "sweeps_probe"], check=True, capture_output=True, text=True)
    assert done.stdout.strip() in ("same", "one kind")  # the second on what is not x86-64, or without AVX2


@pytest.mark.parametrize("spans", [60, 400])
def test_the_length_of_the_line_does_not_matter_before_waves_have_come_back(catenary, spans):
    """In 0.2 s the waves go less than a span; the static lift is felt some spans away."""
    heights = []
    for total in (20, spans):
        p = catenary(
            {
                "line.spans": total,
                "pantograph[1].start": 600.0,
                "pantograph[1].speed": 70.0,
                "pantograph[1].force": 120.0,
            }
        )
        rows = []
        for n in range(200):
            p["pantograph[1].force"] = 120.0 + 100.0 * np.sin(0.1 * n)
            p.step(1e-3)
            rows.append(p.reals(["pantograph[1].wire_height", "pantograph[1].wire_velocity", "support.uplift[12]"]))
        heights.append(rows)
    np.testing.assert_allclose(heights[1], heights[0], rtol=0, atol=1e-9)
