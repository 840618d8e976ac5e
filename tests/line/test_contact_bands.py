"""To which frequency contact forces are good: a row or two of the table in docs/en50318.md come out again."""

from __future__ import annotations

import re

import pytest

from contact_bands import BANDS, CASES, FINE, Bands, Variant
from paths import ROOT
from zspring.fmu import CATENARY, Fmu, installed_fmu

PAGE = ROOT / "docs/en50318.md"
ROWS = {"as all runs: elements of 1 m, steps of 1 ms": Variant(), "both, as for `--band` above 20 Hz": Variant(0.5, 2)}


def shown(row: str) -> list[float]:
    """Numbers of a row of the page's table, %."""
    found = re.search(rf"^\| {re.escape(row)} \|(.*)\|$", PAGE.read_text("utf-8"), re.MULTILINE)
    return [float(cell) for cell in found[1].split("|")]


def test_mesh_and_step_cost_what_the_page_says_of_each_band():
    """Of the worst of three cases, here one: no more than that, and not a tenth of it either.

    The standard deviation of 0-20 Hz does not change by 0.5 %.
    """
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        bands = Bands(catenary, pantograph)
        for row, variant in ROWS.items():
            found = [100 * change / whole for change, whole in bands.differences(CASES[0], variant)]
            for band, mine, worst in zip(BANDS, found, shown(row), strict=True):
                assert 0.1 * worst < mine < 1.1 * worst, (row, band)
        whole = [bands.deviations(CASES[0], variant)[0] for variant in (*ROWS.values(), FINE)]
        assert whole[:2] == pytest.approx([whole[2]] * 2, rel=0.005)
        assert [change for change, _ in bands.differences(CASES[0], FINE)] == pytest.approx([0.0] * len(BANDS))
