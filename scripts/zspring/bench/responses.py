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
from typing import TypeVar

import numpy as np

from ..units import conversion


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


# The unit tells the kind.
RESPONSES = {
    "m/N": Response("receptance", 0, False),
    "N/m": Response("dynamic stiffness", 0, True),
    "m/(N.s)": Response("mobility", 1, False),
    "N.s/m": Response("mechanical impedance", 1, True),
    "1/kg": Response("accelerance", 2, False),
    "kg": Response("apparent mass", 2, True),
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


Number = TypeVar("Number", complex, np.ndarray)
QUANTITIES = {"receptance": "m/N", "stiffness": "N/m"}  # in which an FRF is shown


def as_quantity(H: Number, quantity: str) -> Number:
    """Receptance H in m/N, or dynamic stiffness 1/H in N/m."""
    with np.errstate(invalid="ignore"):  # of NaN, a point that was left out
        return H if quantity == "receptance" else 1 / H


def phase_degrees(value: complex | np.ndarray, quantity: str) -> float | np.ndarray:
    """Phase in degrees, cut far from where a driving point has it: -180 to 0 (receptance), 0 to 180."""
    sign = -1 if quantity == "receptance" else 1
    return sign * ((sign * np.degrees(np.angle(value)) + 90) % 360 - 90)
