"""A communication step does not touch the heap: hosts with real-time demands rely on it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from any_line import LINES
from probe import probe_folder
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu
from zspring.line_table import LineTable

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="counting replaces glibc's malloc: only on Linux")


def count(
    model: str, integers: dict[str, int], reals: dict[str, float], line: LineTable | None = None
) -> tuple[int, int]:
    """Allocations in 500 steps of 11 ms and in the instantiation."""
    with Fmu(installed_fmu(model)) as original:
        fmu = original.with_line(line) if line else original
        settings = [
            f"{kind}{fmu.variables[name].valueReference}={value}"
            for kind, values in (("i", integers), ("r", reals))
            for name, value in values.items()
        ]
        program, resources = probe_folder() / "count_allocations", (fmu.home / "resources").as_uri()
        command = [program, fmu.binary, fmu.guid, resources, "0.011", "500", *settings]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    in_steps, in_instantiate = map(int, done.stdout.split())
    return in_steps, in_instantiate


@pytest.mark.parametrize("drive", [1, 2, 3, 4], ids=["Force", "Displacement", "Wire", "Bench"])
@pytest.mark.parametrize("friction", [1, 2], ids=["Regularized", "Coulomb"])
def test_steps_of_the_pantograph_do_not_allocate(drive, friction):
    gives_way = {"wire.compliance": 2e-6} if drive == 3 else {}
    in_steps, in_instantiate = count(PANTOGRAPH, {"drive": drive, "friction": friction}, gives_way)
    assert in_instantiate > 0  # so counting works
    assert in_steps == 0


@pytest.mark.parametrize("line", [None, *LINES.values()], ids=["like spans", *LINES])
@pytest.mark.parametrize("exchange", [1, 2, 3], ids=["Target", "Sequential", "Parallel"])
def test_steps_of_the_catenary_do_not_allocate(exchange, line):
    """With two pantographs that make droppers slack."""
    reals = {
        f"pantograph[{i}].{name}": value
        for i, start in ((1, 20.0), (2, 50.0))
        for name, value in (("start", start), ("speed", 25.0), ("force", 300.0))
    }
    in_steps, in_instantiate = count(CATENARY, {"exchange": exchange}, {**reals, "exchange.step": 0.011}, line)
    assert in_instantiate > 0
    assert in_steps == 0
