"""Virtual recordings: the FMU on a shaker that is as imperfect as a real one, through drive Displacement."""

from __future__ import annotations

import importlib.resources
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..bench.input_bench import move_head
from ..errors import ZSpringError
from ..fmu import Fmu, Instance
from ..parameter_sets import ACCURATE_STEP
from ..tables import write_table

SETTINGS = "bench.toml"
FREQUENCIES = (2, 2.5, 3, 3.5, 4, 4.25, 4.5, 5, 5.5, 6, 6.5, 7, 8, 10, 11, 12, 13)  # Hz
FEWEST_PERIODS, SHORTEST, RAMP = 14, 4.0, 0.5  # of a hold; s; s
RATE = 500.0  # Hz
FIXTURE_MASS = 0.4  # kg, between load cell and head
SENSITIVITY = 0.01  # V/N
GRAVITY = 9.80665  # m/s2, of the unit g
BITS = 16


@dataclass(frozen=True)
class Shaker:
    """What it does wrong; relative but where a unit is told."""

    amplitude: float = 0.02  # largest distance from the one that was asked for, of each hold
    hunting: float = 0.003  # slow waving of the amplitude
    distortion: tuple[float, float] = (0.004, 0.006)  # second and third harmonic of the velocity
    offset: float = 0.7e-3  # m, of the displacement sensor
    drift: float = 0.2e-3  # m, of the same, over a file
    noise: tuple[float, float, float] = (0.15, 3e-6, 0.02)  # rms in N, m, m/s2
    ranges: tuple[float, float, float] = (800.0, 0.1, 40.0)  # N, m, m/s2
    late: int = 1  # values, of the force


FILES = {  # level in m/s2, direction, hold (from 0) with a dropout of the force
    "level-0.25.csv": (0.25, 1, None),
    "level-1.csv": (1.0, 1, 8),
    "level-1-down.csv": (1.0, -1, None),
    "level-4.csv": (4.0, 1, None),
}


def write_example(folder: Path) -> None:
    """Settings and recordings, always the same. Raises ZSpringError where one is there already."""
    for name in (SETTINGS, *FILES):
        if (folder / name).exists():
            raise ZSpringError(f"{folder / name} exists and is kept: name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(380)
    with Fmu() as fmu, fmu.instances() as (instance,):
        for name, (level, direction, dropout) in FILES.items():
            frequencies = np.array(FREQUENCIES, float)[::direction]
            columns = recorded(instance, level, frequencies, random, dropout)
            head = {**fmu.identity, "virtual": f"drive Displacement, {level:g} m/s2, synthetic Z-spring parameters"}
            write_table(folder / name, head, list(columns), zip(*columns.values()), digits=7)
    source = importlib.resources.files("zspring") / "resources" / "examples" / "recordings.toml"
    (folder / SETTINGS).write_bytes(source.read_bytes())
    print("written:", *(folder / name for name in (SETTINGS, *FILES)))


def recorded(
    instance: Instance,
    level: float,
    frequencies: np.ndarray,
    random: np.random.Generator,
    dropout: int | None = None,
    shaker: Shaker = Shaker(),
) -> dict[str, np.ndarray]:
    """The columns of a file: frequencies (n,) in Hz one after the other at a peak acceleration `level` in m/s2.

    dropout     number of the hold, from 0, in which the load cell's plug is loose for 0.2 s
    """
    step = ACCURATE_STEP
    position, begins = _driven(level, frequencies, step, random, shaker)
    acceleration = np.gradient(np.gradient(position, step), step)
    instance.start({"solver.step": step, **instance.variables.parse_assignments(["drive=Displacement"])})
    # What speeds the fixture up comes through the cell as well: upward, so it presses less.
    force = move_head(instance, 0.0, step, position) - FIXTURE_MASS * acceleration
    thin = round(1 / (RATE * step))
    clean = [values[thin - 1 :: thin] for values in (force, position, acceleration)]
    count = clean[0].size
    clean[0] = np.concatenate([np.full(shaker.late, clean[0][0]), clean[0][: count - shaker.late]])
    clean[1] = clean[1] + shaker.offset + shaker.drift * np.linspace(0, 1, count)
    if dropout is not None:
        first = round((begins[dropout] + 2.0) * RATE)
        clean[0][first : first + round(0.2 * RATE)] = 0.0
    seen = []
    for values, rms, largest in zip(clean, shaker.noise, shaker.ranges):
        bit = 2 * largest / 2**BITS
        seen.append(bit * np.round(np.clip(values + rms * random.standard_normal(count), -largest, largest) / bit))
    return {
        "time [s]": np.arange(count) / RATE,
        "load cell [V]": SENSITIVITY * seen[0],
        "LVDT [mm]": 1e3 * seen[1],
        "accelerometer [g]": -seen[2] / GRAVITY,  # it hangs upside down
    }


def _driven(
    level: float, frequencies: np.ndarray, step: float, random: np.random.Generator, shaker: Shaker
) -> tuple[np.ndarray, list[float]]:
    """Positions (n,) in m, one each `step` in s, and when each hold begins in s.

    From rest to the first hold, and from each to the next, frequency and amplitude go by a quintic.
    """
    asked, peaks, begins = [], [], []
    frequency, peak, time = frequencies[0], 0.0, 0.0
    for f in frequencies:
        reached = level / (2 * np.pi * f) ** 2 * (1 + shaker.amplitude * random.uniform(-1, 1))
        x = np.arange(1, round(RAMP / step) + 1) / round(RAMP / step)
        blend = x**3 * (10 - 15 * x + 6 * x**2)
        held = np.ones(round(max(SHORTEST, FEWEST_PERIODS / f) / step))
        asked += [frequency + (f - frequency) * blend, f * held]
        peaks += [peak + (reached - peak) * blend, reached * held]
        begins.append(time + RAMP)
        time += RAMP + held.size * step
        frequency, peak = f, reached
    phase = 2 * np.pi * step * np.cumsum(np.concatenate(asked))
    waving = 1 + shaker.hunting * np.sin(2 * np.pi * 0.37 * step * np.arange(phase.size))
    second, third = shaker.distortion
    shape = np.sin(phase) + second / 2 * np.sin(2 * phase + 1.0) + third / 3 * np.sin(3 * phase + 2.0)
    return np.concatenate(peaks) * waving * shape, begins
