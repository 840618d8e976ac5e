"""Points of a frequency response: what is measured, what each point tells, and which ones a sweep has."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..variables import Value, exact
from .control import CONTROLS, acceleration_at
from .responses import HARMONICS

SETTLED, NOT_SETTLED, LEFT_OUT, FAILED = "settled", "not settled", "left out", "failed"
NOT_HELD = "not held"  # the force of force control, with the reason
REPEATS = "period"  # with a number: steady, but it repeats only after so many periods of the drive


@dataclass(frozen=True)
class FrfSettings:
    """What to measure, by default the standard figure; everything here changes the numbers."""

    amplitudes: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)  # levels of what is controlled, in its unit
    frequencies: tuple[float, ...] = tuple(i / 4 for i in range(2, 81))  # Hz, ascending
    parameters: Mapping[str, Value] = field(default_factory=dict)  # of the FMU
    direction: str = "up"  # "up", "down", or "rest": each point from the static state; a plan may say "both"
    through: str = "bench"  # key of BENCHES
    tolerance: float = 1e-3  # largest relative distance of H from its steady state, see settle
    min_periods: int = 8
    max_periods: int = 400
    stroke: float = 0.1  # m, largest displacement peak
    control: str = "acceleration"  # key of CONTROLS: whose peak is the same at all frequencies

    @property
    def unit(self) -> str:
        """Of the amplitudes."""
        return CONTROLS[self.control]

    def described(self) -> dict[str, str]:
        """All but the parameters as text, by key."""
        return {
            "H": "-Z/F, components at the drive frequency of head displacement Z and contact force F",
            "through": self.through,
            "direction": self.direction,
            "control": self.control,
            "amplitudes": " ".join(map(exact, self.amplitudes)) + f" {self.unit}",
            "frequencies": " ".join(map(exact, self.frequencies)) + " Hz",
            "tolerance": exact(self.tolerance),
            "periods": f"{self.min_periods} to {self.max_periods}",
            "stroke": f"{exact(self.stroke)} m",
        }


@dataclass(frozen=True)
class FrfPoint:
    """One point; H in m/N and what is told of it are NaN where nothing was measured, and where it failed.

    H and loss are of the last period, or of the last k together with the status "period k"; harmonics are of the last.
    """

    amplitude: float  # m/s2, peak acceleration
    frequency: float  # Hz
    status: str
    H: complex = complex(math.nan, math.nan)
    periods: int = 0
    change: float = math.nan
    steps: int = 0  # internal steps, Newton iterations and step halvings this point took
    iterations: int = 0
    refinements: int = 0
    iterations_max: int = 0  # of the worst step since the sweep began
    remaining: float = math.nan  # estimated distance of H from its steady state, relative to H
    harmonics: tuple[float, ...] = (math.nan,) * len(HARMONICS)  # N, peaks of the contact force's
    loss: float = math.nan  # J, what the FMU dissipates in a cycle, pi Z^2 Im(1/H) in the steady state
    level: float = math.nan  # of what is controlled, in `unit`; the amplitude where none is given
    unit: str = "m/s2"

    def __post_init__(self) -> None:
        if math.isnan(self.level):
            object.__setattr__(self, "level", self.amplitude)

    @property
    def place(self) -> tuple[float, float]:
        """Level and frequency: which point of a figure it is."""
        return self.level, self.frequency

    @property
    def label(self) -> str:
        """The level with its unit."""
        return f"{self.level:g} {self.unit}"

    @property
    def displacement(self) -> float:
        """Peak displacement of the head in m."""
        omega = 2 * math.pi * self.frequency
        return self.amplitude / omega / omega  # whose square may be beyond what numbers can be

    @property
    def force(self) -> float:
        """Peak of the contact force's first harmonic in N."""
        return self.displacement / abs(self.H) if self.H else math.nan

    @property
    def stiffness(self) -> float:
        """Equivalent one of all that the head feels, inertia included, in N/m: k of 1/H = k + i omega c."""
        return (1 / self.H).real if self.H else math.nan

    @property
    def damping(self) -> float:
        """Equivalent one in N.s/m: c of 1/H, from the loss, which is known far better where inertia is all of 1/H."""
        return self.loss / (2 * math.pi**2 * self.frequency * self.displacement**2)


@dataclass(frozen=True)
class Sweep:
    """Points that one instance measures one after the other, from `state` of the bench or from rest."""

    level: float  # in the unit of the control
    frequencies: tuple[float, ...]
    state: Mapping[str, Any] | None = None


Kept = tuple[FrfPoint, Mapping[str, Any] | None]  # with the bench's state; None: the next point starts from rest


def differences(some: Sequence[FrfPoint], others: Sequence[FrfPoint]) -> dict[tuple[float, float], float]:
    """How far H of others is from that of some, relatively, by level and frequency, where both have one."""
    H = {p.place: p.H for p in others}
    found = {p.place: abs(H.get(p.place, math.nan) / p.H - 1) for p in some}
    return {place: difference for place, difference in found.items() if math.isfinite(difference)}


def left_out(settings: FrfSettings) -> list[FrfPoint]:
    """The points that need more stroke than there is, as far as that is known before."""
    points = (_point(settings, level, f, LEFT_OUT) for level in settings.amplitudes for f in settings.frequencies)
    return [point for point in points if point.displacement > settings.stroke]


def sweeps(settings: FrfSettings) -> list[Sweep]:
    """All sweeps of the figure: one for each amplitude, or one for each point with direction "rest"."""
    result = []
    beyond = {point.place for point in left_out(settings)}
    for level in settings.amplitudes:
        frequencies = tuple(f for f in settings.frequencies if (level, f) not in beyond)
        if settings.direction == "rest":
            result += [Sweep(level, (frequency,)) for frequency in frequencies]
        elif frequencies:
            result.append(Sweep(level, frequencies if settings.direction == "up" else frequencies[::-1]))
    return result


def _point(settings: FrfSettings, level: float, frequency: float, status: str) -> FrfPoint:
    """One without a measurement."""
    acceleration = acceleration_at(level, settings.unit, frequency)
    return FrfPoint(acceleration, frequency, status, level=level, unit=settings.unit)
