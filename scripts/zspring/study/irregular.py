"""Lines that are not as designed: realisations of a distribution, by number. This runs on the workers.

Each kind of irregularity has random numbers of its own, which hang on the seed and the line's number alone: another
standard deviation scales the same line, and all that run along line 7 run along the same one (common random numbers).

Contact wire: a Gaussian process along the line, of which the one-sided power spectrum G(k) [m2/(1/m)] over wavenumber k
[1/m] is given: h = sum of a_j cos(2 pi k_j x) + b_j sin(2 pi k_j x), a_j and b_j normal with the variance that G has
within dk about k_j (Shinozuka, Deodatis, Applied Mechanics Reviews 44, 1991). It repeats after twice the line's length.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import cumulative_trapezoid

from ..errors import ZSpringError
from ..line_table import NEVER_PULLS, PROFILE, LineTable
from ..variables import Value

KINDS = "dropper_length", "missing", "slack", "contact_tension", "messenger_tension", "clamp_mass", "contact_wire"
CUT = 3.0  # standard deviations at which tensions and masses are cut off
LENGTHS = 3.0  # of the line, that a measured profile has at least: lines that are cut out of less are nearly the same
PER_WAVE = 6  # points of the profile on the shortest wave: cubic between them, to 0.3 % of that wave


@dataclass(frozen=True)
class Roughness:
    """Irregularity of the contact wire's height with a standard deviation of 1 m, as its source has it.

    wavenumber, spectrum    1/m, ascending, and the one-sided spectrum there in m3; straight between, 0 outside. (n,)
    profile                 or what was measured, (n,) PROFILE: each line begins it elsewhere
    """

    wavenumber: np.ndarray | None = None
    spectrum: np.ndarray | None = None
    profile: np.ndarray | None = None

    @property
    def longest_wave(self) -> float:
        """Of a spectrum, m; 0 of what was measured."""
        if self.wavenumber is None or self.spectrum is None:
            return 0.0
        lowest = self.wavenumber[max(0, np.flatnonzero(self.spectrum)[0] - 1)]  # it rises from the 0 before
        return 1 / float(lowest) if lowest > 0 else math.inf

    @property
    def extent(self) -> float:
        """Of what was measured, m; a spectrum has no end."""
        return math.inf if self.profile is None else float(np.ptp(self.profile["x"]))

    @property
    def digest(self) -> str:
        """SHA-256 of all numbers."""
        parts = [part for part in (self.wavenumber, self.spectrum, self.profile) if part is not None]
        return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()


@dataclass(frozen=True)
class Irregularity:
    """A distribution of lines about a design.

    roughness   of the contact wire, scaled by the case's standard deviation; None: there is none
    Raises ZSpringError for waves that are longer than the line, and for a profile shorter than LENGTHS of it.
    """

    design: LineTable
    seed: int
    roughness: Roughness | None = None

    def __post_init__(self) -> None:
        if self.roughness and self.roughness.longest_wave > self._length * (1 + 1e-9):
            longest = f"waves of up to {self.roughness.longest_wave:.4g} m"
            raise ZSpringError(f"contact_wire: {longest}: must be no longer than the line, {self._length:g} m")
        if self.roughness and self.roughness.extent < LENGTHS * self._length:
            needed = f"at least {LENGTHS:g} times as long as the line, {LENGTHS * self._length:g} m"
            raise ZSpringError(f"profile: {self.roughness.extent:.4g} m: must be {needed}")

    def described(self) -> dict[str, str]:
        """What the lines hang on as text, by key."""
        told = {"seed of the lines": str(self.seed)}
        if self.roughness:
            told["irregularity of the contact wire"] = self.roughness.digest
        return told

    def doubts(self, lines: int) -> list[str]:
        """A line on so many irregular lines if parts of a measured profile have to overlap."""
        independent = self.roughness.extent / self._length if self.roughness else math.inf
        if lines <= independent:
            return []
        return [
            f"profile: {independent:.1f} times as long as the line, {lines} lines cut out of it overlap: where they "
            "count as independent, intervals are too narrow"
        ]

    @property
    def _length(self) -> float:
        return float(self.design.boundaries[-1])

    def line(self, number: int, by: Mapping[str, float]) -> LineTable:
        """Line `number`.

        by  dropper_length, contact_wire: standard deviations, m; clamp_mass: as a share; missing, slack: share of the
            droppers, these slack_by m too long
        """
        droppers = self.design.droppers.copy()
        count, places = len(droppers), self._draws(number, "dropper_length").normal(size=len(droppers))
        droppers["length_error"] += by.get("dropper_length", 0.0) * places
        is_slack = self._draws(number, "slack").random(count) < by.get("slack", 0.0)
        droppers["length_error"] += by.get("slack_by", 0.0) * is_slack
        is_missing = self._draws(number, "missing").random(count) < by.get("missing", 0.0)
        droppers["length_error"][is_missing] = NEVER_PULLS
        factors = 1 + by.get("clamp_mass", 0.0) * self._cut(number, "clamp_mass", (2, count))
        droppers["clamp_contact"] *= factors[0]
        droppers["clamp_upper"] *= factors[1]
        line = replace(self.design, droppers=droppers)
        deviation = by.get("contact_wire", 0.0)
        if deviation and self.roughness:
            line = replace(line, profile=self._profile(self._draws(number, "contact_wire"), deviation))
        return line

    def tensions(self, number: int, by: Mapping[str, float]) -> dict[str, float]:
        """Factors of the wires' tensions by the parameter's name."""
        return {
            f"{wire}.tension": 1 + by.get(key, 0.0) * float(self._cut(number, key, ()))
            for wire, key in (("contact_wire", "contact_tension"), ("messenger", "messenger_tension"))
        }

    def _draws(self, number: int, kind: str) -> np.random.Generator:
        return np.random.default_rng([self.seed, number, KINDS.index(kind)])

    def _cut(self, number: int, kind: str, shape: tuple[int, ...]) -> np.ndarray:
        return np.clip(self._draws(number, kind).normal(size=shape), -CUT, CUT)

    def _profile(self, draws: np.random.Generator, deviation: float) -> np.ndarray:
        """(n,) PROFILE over the whole line."""
        assert self.roughness
        made = _process if self.roughness.profile is None else _cut_out
        profile = made(self.roughness, self._length, draws)
        profile["height"] *= deviation
        profile["slope"] *= deviation
        return profile


def of_case(by: Mapping[str, Value]) -> tuple[int, dict[str, float]]:
    """Number of the line, and the rest, of what a case says of its irregularity."""
    return int(by.get("line", 1)), {name: float(value) for name, value in by.items() if name != "line"}


def _process(rough: Roughness, length: float, draws: np.random.Generator) -> np.ndarray:
    """(n,) PROFILE from 0 to the length, m."""
    assert rough.wavenumber is not None and rough.spectrum is not None
    period = 2 * length
    count = 2 * math.ceil(PER_WAVE * period * rough.wavenumber[-1] / 2)
    k = np.arange(count // 2 + 1) / period
    # Integrated from the middle between two waves to the next one: straight between the nodes, so the sum is exact.
    edges = np.clip((np.arange(len(k) + 1) - 0.5) / period, rough.wavenumber[0], rough.wavenumber[-1])
    nodes = np.union1d(edges, rough.wavenumber)
    below = cumulative_trapezoid(np.interp(nodes, rough.wavenumber, rough.spectrum), nodes, initial=0.0)
    variance = np.diff(np.interp(edges, nodes, below))
    # a cos + b sin is the real part of (a - ib) exp: half of it at k, half at -k, which irfft fills in.
    waves = np.sqrt(variance) * (draws.normal(size=k.shape) - 1j * draws.normal(size=k.shape)) * count / 2
    profile = np.zeros(count // 2 + 1, PROFILE)
    profile["x"] = np.arange(len(profile)) * (period / count)
    profile["height"] = np.fft.irfft(waves, count)[: len(profile)]
    profile["slope"] = np.fft.irfft(2j * np.pi * k * waves, count)[: len(profile)]
    return profile


def _cut_out(rough: Roughness, length: float, draws: np.random.Generator) -> np.ndarray:
    """As _process: a part of what was measured, its mean taken off."""
    assert rough.profile is not None
    first, last = rough.profile["x"][[0, -1]]
    begin = first + (last - first - length) * draws.random()
    low = np.searchsorted(rough.profile["x"], begin, "right") - 1
    high = np.searchsorted(rough.profile["x"], begin + length)
    profile = rough.profile[low : high + 1].copy()
    profile["x"] -= begin
    profile["height"] -= np.mean(profile["height"])
    return profile
