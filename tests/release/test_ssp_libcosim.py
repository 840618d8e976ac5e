"""The SSP archive in libcosim, whose library needs more of the system than the first suite may ask for."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from ssp_archive import archive, check
from zspring.couple.ssp import LINE_ELEMENT, element_name
from zspring.line.result import LineResult


@pytest.fixture(params=[1, 2], ids=["one pantograph", "two pantographs"])
def exported(request, tmp_path) -> Iterator[tuple[Path, LineResult]]:
    """An archive, and the run that it describes."""
    yield from archive(tmp_path / "line.ssp", request.param)


def test_libcosim_runs_the_archive_to_the_same_result(exported):
    """Another tool's fixed-step algorithm, at every communication step, to rounding: sums in another order.

    libcosimpy has wheels for Linux and Windows on x86-64.
    """
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    path, result = exported
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(str(path))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)

    def reader(element: str, names: list[str]):
        index = execution.slave_index_from_instance_name(element)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        return lambda: observer.last_real_values(index, [references[name] for name in names])

    count = result.position.shape[1]
    force = [reader(element_name(i), ["contact.force"]) for i in range(count)]
    heights = reader(LINE_ELEMENT, [f"pantograph[{i + 1}].wire_height" for i in range(count)])
    rows = []
    for _ in result.time[1:]:
        execution.step()
        rows.append([*(read()[0] for read in force), *heights()])
    assert execution.status().current_time == round(1e9 * result.time[-1])  # ns
    check(np.array(rows), result)
