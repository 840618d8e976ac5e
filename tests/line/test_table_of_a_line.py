"""The table of a line: its bytes by hand, its digest by the published function, and where an FMU keeps it."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from zspring import line_table
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import LineExtent
from zspring.line_table import LineTable

SUPPORTS = [(0, 1.2, 0, 0, 0), (65, 1.25, 5e4, 0.5, 300), (120, 1.2, 0, 0, 0)]
DROPPERS = [(5, 0, -0.01, 1e5, 0, 0.1, 0.165, 0.195, 0, 0), (70, 1, 0.02, 1e5, 2e5, 0.1, 0.165, 0.195, 1.1, 10)]
STITCHES = [(56, 74, 2800, 0.31, 0.5)]
MASSES = [(30, 1, 2.5)]
PROFILE = [(10, 0, 0), (11, 0.001, 0.0005), (12, 0, 0)]


@pytest.fixture(scope="module")
def table() -> LineTable:
    kinds = line_table.SUPPORT, line_table.DROPPER, line_table.STITCH, line_table.POINT_MASS, line_table.PROFILE
    lists = SUPPORTS, DROPPERS, STITCHES, MASSES, PROFILE
    supports, *others = (np.array(entries, kind) for entries, kind in zip(lists, kinds))
    return LineTable(supports, (0.0, 0.05), *others)


def by_hand() -> bytes:
    """The file by struct, number by number."""
    numbers: list[float] = []
    for entries in (SUPPORTS, DROPPERS, STITCHES, MASSES, PROFILE):
        numbers += [len(entries), *(number for entry in entries for number in entry)]
        numbers += [0.0, 0.05] if entries is SUPPORTS else []
    return b"zspline1" + struct.pack(f"<{len(numbers)}d", *numbers)


def test_the_table_is_what_the_format_says(table, tmp_path):
    assert table.content == by_hand()
    table.write(tmp_path / "line.table")
    again = LineTable.read(tmp_path / "line.table")
    assert again.content == by_hand() and again.ends == (0.0, 0.05)
    np.testing.assert_array_equal(again.droppers["length_error"], [0, 10])
    assert again.boundaries.tolist() == [0, 65, 120]


@pytest.mark.parametrize("change", [slice(0, 7), slice(0, -1), slice(0, -8), slice(0, 16), slice(0, 24)])
def test_a_table_that_was_cut_is_none(change, tmp_path):
    path = tmp_path / "line.table"
    path.write_bytes(by_hand()[change])
    with pytest.raises(ZSpringError, match=r"line\.table is no table of a line"):
        LineTable.read(path)


@pytest.mark.parametrize("count", [-1.0, 1e300, float("nan"), float("inf"), 1.0, 4.0])
def test_a_table_with_another_number_of_supports_is_none(count, tmp_path):
    path = tmp_path / "line.table"
    path.write_bytes(b"zspline1" + struct.pack("<d", count) + by_hand()[16:])
    with pytest.raises(ZSpringError, match=r"is no table of a line"):
        LineTable.read(path)
    path.write_bytes(by_hand() + bytes(8))
    with pytest.raises(ZSpringError, match=r"is no table of a line"):
        LineTable.read(path)


def test_the_digest_is_the_published_fnv_1a(monkeypatch, table):
    """Values of the reference code's test suite for these texts."""
    for text, value in ((b"", "cbf29ce484222325"), (b"a", "af63dc4c8601ec8c"), (b"foobar", "85944171f73967e8")):
        monkeypatch.setitem(table.__dict__, "content", text)
        table.__dict__.pop("digest", None)
        assert table.digest == value
    table.__dict__.pop("digest")


def test_the_guid_tells_of_the_table_between_kind_and_starts(table):
    told = f"line={table.digest}"
    assert line_table.guid("{a}", table) == f"{{a}} {told}"
    assert line_table.guid("{a} 3=00ff", table) == f"{{a}} {told} 3=00ff"
    assert line_table.guid("{a} reals line=0123 3=00ff", table) == f"{{a}} reals {told} 3=00ff"


def test_an_fmu_with_a_line_has_the_line_s_extent_and_not_its_parameters(table):
    with Fmu(installed_fmu(CATENARY)) as catenary:
        lined = catenary.with_line(table)
        assert Path(lined.home, "resources", "line.table").read_bytes() == by_hand()
        assert lined.identity["GUID"] == line_table.guid(catenary.guid, table)
        assert LineExtent.of(lined, {}).boundaries.tolist() == [0, 65, 120]
        assert LineExtent.of(catenary, {}).length == 600
        gone = set(catenary.parameter_names) - set(lined.parameter_names)
        assert {"line.span", "dropper.sag[3]", "support.stiffness", "steady_arm.mass"} <= gone
        assert not gone & {"line.length", "dropper.static_force_min", "messenger.tension", "damping.mass"}
