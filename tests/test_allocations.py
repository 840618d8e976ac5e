"""A communication step does not touch the heap: hosts with real-time demands rely on it."""

from __future__ import annotations

import subprocess
import sys

import pytest
from core import probe_folder

if sys.platform == "linux":  # counting replaces glibc's malloc

    @pytest.mark.parametrize("drive", [1, 2, 3, 4], ids=["Force", "Displacement", "Wire", "Bench"])
    @pytest.mark.parametrize("friction", [1, 2], ids=["Regularized", "Coulomb"])
    def test_steps_do_not_allocate(fmu, drive, friction):
        (library,) = (fmu.folder / "binaries").glob("*/*.so")
        settings = [f"{fmu.variables[name].valueReference}={value}"
                    for name, value in (("drive", drive), ("friction", friction))]
        command = [probe_folder() / "count_allocations", library, fmu.description.guid, "0.011", "500", *settings]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        in_steps, in_instantiate = map(int, done.stdout.split())
        assert in_instantiate > 0  # so counting works
        assert in_steps == 0
