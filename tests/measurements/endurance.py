"""The native program tests/native/endurance.cpp on a built FMU: times of steps, memory, many instances (Linux)."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from probe import probe_folder
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu

# What drives the FMUs in these measurements, by model: integers, sines (offset, amplitude, Hz); what is read.
LOADS = {
    PANTOGRAPH: (
        {"drive": 3},
        {"wire_height": (0.0, 0.005, 1.0)},
        ["head.z", "contact.force", "zspring.alpha", "energy.work"],
    ),
    # To and fro, at up to 250 km/h.
    CATENARY: (
        {"travel": 2},
        {"pantograph[1].force": (120.0, 40.0, 1.0), "pantograph[1].position": (300.0, 250.0, 0.044)},
        ["pantograph[1].wire_height", "pantograph[1].wire_velocity", "support.uplift[2]", "energy.work"],
    ),
}
COMMUNICATION_STEP = 1e-3  # s


def command(fmu: Fmu, mode: str, count: int, also: Mapping[str, int] = {}) -> list[Path | str]:
    """The program with its arguments; `also`: further integer parameters."""
    integers, sines, outputs = LOADS[fmu.description.modelName]

    def vr(name: str) -> int:
        return fmu.variables[name].valueReference

    settings = [f"i{vr(name)}={value}" for name, value in (integers | dict(also)).items()]
    settings += [f"s{vr(name)}=" + ",".join(map(repr, sine)) for name, sine in sines.items()]
    settings += [f"o{vr(name)}" for name in outputs]
    return [
        probe_folder() / "endurance",
        fmu.binary,
        fmu.description.guid,
        mode,
        str(count),
        repr(COMMUNICATION_STEP),
        *settings,
    ]


def measure(model: str, mode: str, count: int, also: Mapping[str, int] = {}) -> list[float]:
    """The numbers that `mode` prints, see endurance.cpp."""
    with Fmu(installed_fmu(model)) as fmu:
        done = subprocess.run(command(fmu, mode, count, also), capture_output=True, text=True)
    assert done.returncode == 0, f"{mode}: status {done.returncode}\n{done.stderr[-2000:]}"
    return [float(number) for number in done.stdout.split()]


@dataclass(frozen=True)
class Latency:
    """Times in us."""

    median: float
    p99: float
    p999: float
    p9999: float
    worst: float


def latency(model: str, count: int) -> tuple[Latency, Latency]:
    """Of fmi2DoStep alone, and of setting the inputs, a step and reading four outputs."""
    numbers = measure(model, "latency", count)
    return Latency(*numbers[:5]), Latency(*numbers[5:])
