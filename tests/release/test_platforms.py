"""The libraries for other platforms run, under wine and qemu, and give the results of the one for linux64.

A small C host (host.c), compiled for each platform, makes the same calls everywhere and prints all outputs to
the last bit. All operations are the same everywhere, none is contracted; on Windows it has Microsoft's C library.
"""

from __future__ import annotations

import numpy as np
import pytest
from conftest import location
from platform_runs import RUNS

from any_line import STITCHED
from harness import forms_of


@pytest.mark.parametrize("name", RUNS)
def test_runs_are_worth_comparing(run, name):
    result = run(name, "linux64")
    assert np.isfinite(result).all()
    assert (np.ptp(result, axis=0) > 0).sum() >= 10  # outputs that move


@pytest.mark.parametrize("platform", ["win64", "aarch64-linux"])
@pytest.mark.parametrize("name", RUNS)
def test_results_as_on_linux64(run, name, platform):
    expected, result = run(name, "linux64"), run(name, platform)
    different = (expected.view("u8") != result.view("u8")).any(axis=1)
    assert not different.any(), f"other bits in {different.sum()} of {len(different)} steps"


def test_windows_finds_a_line_in_every_form_that_hosts_tell(release, host, emulated, tmp_path):
    fmu = release["Catenary"]
    resources = fmu.with_line(STITCHED.content, tmp_path / "Fahrleitung über 100 %").folder / "resources"
    guid = fmu.with_line(STITCHED.content, tmp_path / "for its GUID").told
    uri, path = location(resources, "win64"), f"Z:{resources}"
    library = next((fmu.folder / "binaries/win64").iterdir())
    for told in (
        *forms_of(uri),
        uri.replace("file:///", "file://"),
        uri.replace("file:///", "FILE:///").replace("%20", " "),
        path,
        path.replace("/", "\\"),
        path.replace("/", "\\") + "\\",
    ):
        command = [host("win64"), library, fmu.description.guid + guid, told]
        assert emulated("win64", command, "initialize\n") == "", told
