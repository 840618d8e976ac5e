"""Kinds of frequency response: as receptance H = -Z/F in m/N, in which unit they are shown, and their phase.

F is the contact force, which pushes the head down, Z the head's displacement, upward. A bench that counts the
force on the specimen positive in the direction of the displacement measures +Z/F, which is the same H. With
s = i omega and v the measured value, exp(i omega t):

    receptance      H = v              dynamic stiffness      H = 1/v
    mobility        H = v/s            mechanical impedance   H = 1/(v s)
    accelerance     H = v/s^2          apparent mass          H = 1/(v s^2)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ..units import conversion

Number = TypeVar("Number", complex, np.ndarray)


HARMONICS = range(2, 8)  # of the contact force, which the benches tell beside the first


@dataclass(frozen=True)
class Response:
    """A kind of frequency response: motion over force, or the inverse."""

    name: str
    derivatives: int  # of the displacement: 0, 1 velocity, 2 acceleration
    inverse: bool
    factor: float = 1.0  # from the unit to the SI unit

    def receptance(self, frequency: np.ndarray, value: np.ndarray) -> np.ndarray:
        """H (n,) in m/N from measured values (n,) at frequencies (n,) in Hz."""
        s = 2j * np.pi * frequency
        value = self.factor * value
        return (1 / value if self.inverse else value) / s**self.derivatives

    def of(self, H: Number, frequency: float | np.ndarray) -> Number:
        """The value from H (n,) in m/N at frequencies (n,) in Hz; NaN where H is, a point that was left out."""
        with np.errstate(invalid="ignore"):
            motion: Any = H * (2j * np.pi * frequency) ** self.derivatives if self.derivatives else H
            return 1 / motion if self.inverse else motion

    @property
    def middle(self) -> float:
        """Phase in degrees that a driving point is never more than a right angle from."""
        return 90.0 * (1 - self.derivatives if self.inverse else self.derivatives - 1)


# The unit tells the kind.
RESPONSES = {
    "m/N": Response("receptance", 0, False),
    "N/m": Response("dynamic stiffness", 0, True),
    "m/(N.s)": Response("mobility", 1, False),
    "N.s/m": Response("mechanical impedance", 1, True),
    "1/kg": Response("accelerance", 2, False),
    "kg": Response("apparent mass", 2, True),
}
QUANTITIES = {  # in which an FRF is shown, by the names that options take
    "receptance": "m/N",
    "stiffness": "N/m",
    "mobility": "m/(N.s)",
    "impedance": "N.s/m",
    "accelerance": "1/kg",
    "mass": "kg",
}
AMPLITUDES = {"m/s2": 2, "m/s": 1, "m": 0}  # peak of the imposed sine: derivatives of the displacement


def response_of(unit: str) -> Response:
    """The kind of response with this unit. Raises UnitError for none."""
    kind, factor = conversion(unit, *RESPONSES)
    return replace(RESPONSES[kind], factor=factor)


def acceleration_of(unit: str, frequency: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
    """Peak acceleration in m/s2 from a peak displacement, velocity or acceleration in `unit`; UnitError for others."""
    kind, factor = conversion(unit, *AMPLITUDES)
    return factor * amplitude * (2 * np.pi * frequency) ** (2 - AMPLITUDES[kind])


def as_quantity(H: Number, quantity: str, frequency: float | np.ndarray) -> Number:
    """One of QUANTITIES from the receptance H in m/N at a frequency in Hz."""
    return RESPONSES[QUANTITIES[quantity]].of(H, frequency)


def phase_degrees(value: complex | np.ndarray, quantity: str) -> float | np.ndarray:
    """Phase in degrees, cut far from where a driving point has it: -180 to 0 (receptance), -90 to 90 (mobility) ..."""
    middle = RESPONSES[QUANTITIES[quantity]].middle
    return middle - (middle - np.degrees(np.angle(value)) + 180) % 360 + 180
