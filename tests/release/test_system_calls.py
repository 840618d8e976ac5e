"""While an FMU runs, the system sees it ask for memory and nothing else."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from release_tools import tool

from endurance import command
from libraries import C_LIBRARY
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu

MEMORY = {"mmap", "munmap", "mremap", "brk", "mprotect", "madvise"}
OF_THE_PROGRAM = {"clock_gettime"}  # where the system has no faster way to tell the time
ONCE = {"gettid"}  # by the C++ runtime, that only one thread fills Eigen's table of cache sizes, in initialization


@pytest.mark.parametrize("model", [PANTOGRAPH, CATENARY])
def test_a_running_fmu_asks_the_system_for_memory_only(model, tmp_path):
    trace = tmp_path / "trace"
    with Fmu(installed_fmu(model)) as fmu:
        run = command(fmu, "latency", 1000)  # prints at its end, and does nothing else beside calling the FMU
        done = subprocess.run([tool("strace"), "-f", "-o", trace, *run], capture_output=True)
    assert done.returncode == 0, done.stderr
    calls = trace.read_text().splitlines()
    loaded = next(i for i, line in enumerate(calls) if f"{model}.so" in line and "open" in line)
    opened = {i: re.search(r'"(.*?)"', calls[i])[1] for i in range(loaded + 1, len(calls)) if "open" in calls[i]}
    for name in opened.values():  # by the loader: what of the C library the program itself did not need
        assert name == "/etc/ld.so.cache" or re.fullmatch(C_LIBRARY["linux"], Path(name).name)
    mapped = next(i for i in range(max(opened, default=loaded), len(calls)) if " close(" in calls[i])
    end = next(i for i in range(mapped, len(calls)) if re.search(r" (newfstatat|fstat|write)\(1,", calls[i]))
    names = [re.match(r"\d+\s+(\w+)", line)[1] for line in calls[mapped + 1 : end]]
    assert set(names) <= MEMORY | OF_THE_PROGRAM | ONCE
    assert all(names.count(name) <= 1 for name in ONCE)
