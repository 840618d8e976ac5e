"""An SSP archive for other tools to run, and the run of `zspring couple` that it describes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from zspring.couple.ssp import write_ssp
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.result import LineResult
from zspring.line.run import LineRun
from zspring.line.schemes import Coupling
from zspring.line.system import System
from zspring.line_file.chosen import ChosenLine, line_of

SPEED = 250 / 3.6
LINE = {"line.spans": 4, "steady_arm.mass": 0.5, "damping.mass": 0.0125, "contact_wire.tension": 22000.0}
COULOMB = {"friction": 2, "static_force": 100.0}


def archive(path: Path, count: int, line_file: Path | None = None) -> Iterator[tuple[Path, LineResult]]:
    """Write an archive of so many pantographs, on a line by parameters or by a file; yields its path and the run."""
    journey = Journey(SPEED, 90.0, 150.0, 2e-3, 50.0, start_up="direct", uplift=15.0)
    with Fmu(installed_fmu(CATENARY)) as catenary, Fmu() as pantograph:
        line = line_of(str(line_file), catenary) if line_file else ChosenLine(catenary, LINE)
        system = System(line.catenary, pantograph, line.parameters, [COULOMB] * count, journey, Coupling("parallel"))
        with LineRun(system) as run:
            write_ssp(run, path)
            run.finish()
            yield path, run.result()


def check(found: np.ndarray, result: LineResult) -> None:
    """Whether a tool found, at the end of each step, these contact forces and then wire heights. (n, 2 p)

    The archive's heights count from the wire as static_force lifts it at the start.
    """
    count = result.position.shape[1]
    assert np.ptp(result.contact_force[:, -1]) > 50
    assert found[:, :count] == pytest.approx(result.contact_force[1:], abs=1e-6)
    assert found[:, count:] == pytest.approx(result.wire_height[1:] - result.wire_height[0], abs=1e-10)
