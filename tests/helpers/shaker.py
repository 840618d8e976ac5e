"""Time records of a linear pantograph on a shaker, in closed form; what `zspring recordings` must find in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import lsim

from commands import in_process
from linear import PUBLISHED, LinearPantograph
from zspring.bench.curves import Curve, Source
from zspring.bench.measured import read_curves

FOUR = (2.0, 3.3, 5.2, 9.1)  # Hz
BASE = """
static_force = 90
[[recording]]
file = "a.csv"
[time]
channel = "time"
[force]
channel = "force"
sense = "contact"
[displacement]
channel = "position"
positive = "up"
"""

_TABLE = dict(PUBLISHED["DSA-250"])
LINEAR = LinearPantograph(head=_TABLE.pop("k1"), **_TABLE)
STATIC_FORCE = 90.0  # N


@dataclass(frozen=True)
class Shaken:
    """One frequency after the other: displacement in m, upward, contact force in N, over even times in s."""

    rate: float
    displacement: np.ndarray
    force: np.ndarray
    acceleration: np.ndarray  # m/s2

    @property
    def time(self) -> np.ndarray:
        return np.arange(self.displacement.size) / self.rate


def shaken(
    frequencies: Sequence[float],
    acceleration: float = 1.0,
    rate: float = 500.0,
    periods: float = 12.0,
    late: float = 0.0,
    fixture_mass: float = 0.0,
    harmonics: dict[int, float] | None = None,
) -> Shaken:
    """Every frequency (Hz) for that many periods, in phase with the one before, at one peak acceleration in m/s2.

    late            s, by which the force comes late
    fixture_mass    kg, between load cell and head
    harmonics       of the displacement beside its fundamental, by number
    """
    parts, phase = [], 0.0
    for f in frequencies:
        time = np.arange(round(periods / f * rate)) / rate
        omega, peak = 2 * np.pi * f, acceleration / (2 * np.pi * f) ** 2
        z, a, force = (np.zeros(time.size) for _ in range(3))
        for k, size in {1: 1.0, **(harmonics or {})}.items():
            amplitude = peak * size * np.exp(1j * (k * phase - np.pi / 2 + 0.7 * (k > 1)))
            stiffness = LINEAR.dynamic_stiffness(k * f) - fixture_mass * (k * omega) ** 2
            turning = np.exp(1j * k * omega * time)
            z += (amplitude * turning).real
            a += (-((k * omega) ** 2) * amplitude * turning).real
            force -= (stiffness * amplitude * np.exp(-1j * k * omega * late) * turning).real
        parts.append((z, force, a))
        phase += omega * time.size / rate
    z, force, a = (np.concatenate(columns) for columns in zip(*parts))
    return Shaken(rate, z, STATIC_FORCE + force, a)


def write_text(path: Path, columns: dict[str, np.ndarray], digits: int = 12) -> Path:
    """A table of text."""
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, fmt=f"%.{digits}g", delimiter=",", header=",".join(columns), comments="", encoding="utf-8")
    return path


def written(folder: Path, settings: str, **columns: np.ndarray) -> Path:
    if columns:
        write_text(folder / "a.csv", {name.replace("__", " [") + "]": values for name, values in columns.items()})
    (folder / "a.toml").write_text(settings)
    return folder / "a.toml"


def found(settings: Path, status: int = 0) -> tuple[list[Curve], str, str]:
    """The curves that `identify` would read from the results, and what was said."""
    code, out, err = in_process("recordings", settings, "--output", settings.parent / "out")
    assert code == status, err
    files = sorted((settings.parent / "out").glob("frf*.csv")) if status == 0 else []
    return [curve for file in files for curve in read_curves(Source(file))], out, err


def assert_linear(curves: list[Curve], frequencies, tolerance: float = 1e-6) -> None:
    frequency = np.concatenate([curve.frequency for curve in curves])
    H = np.concatenate([curve.H for curve in curves])
    np.testing.assert_allclose(frequency, frequencies, rtol=1e-6)
    np.testing.assert_allclose(H, [LINEAR.receptance(f) for f in frequencies], rtol=tolerance)


def swept(first: float, last: float, duration: float, octaves: bool = False, rate: float = 200.0) -> Shaken:
    """A slow sweep from one frequency to another (Hz) in s at 1 m/s2, from rest; in even Hz/s or octaves.

    The masses below the head by SciPy's solution of linear systems, with eight steps in a value.
    """
    step, fine = 1 / (8 * rate), np.arange(round(8 * rate * duration)) / (8 * rate)
    growth = np.log(last / first) / duration
    linear = (last - first) / duration
    frequency = first * np.exp(growth * fine) if octaves else first + linear * fine
    phase = 2 * np.pi * (first * np.expm1(growth * fine) / growth if octaves else first * fine + linear * fine**2 / 2)
    z = np.sin(phase) / (2 * np.pi * frequency) ** 2 * np.minimum(fine, 1.0) ** 2
    m, c, k = LINEAR.matrices()
    assert not c[0].any()  # the head has no damper
    below = np.linalg.inv(m[1:, 1:])
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-below @ k[1:, 1:], -below @ c[1:, 1:]]])
    b = np.vstack([np.zeros((2, 1)), -below @ k[1:, :1]])
    _, states, _ = lsim((a, b, np.eye(4), np.zeros((4, 1))), z, fine)
    acceleration = np.gradient(np.gradient(z, step), step)
    force = m[0, 0] * acceleration + k[0, 0] * z + states[:, :2] @ k[0, 1:]
    return Shaken(rate, z[::8], STATIC_FORCE - force[::8], acceleration[::8])
