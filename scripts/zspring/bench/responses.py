"""Kinds of frequency response: as receptance H = -Z/F in m/N, in which unit they are shown, and their phase.

F is the contact force, which pushes the head down, Z the head's displacement, upward. A bench that counts the
force on the specimen positive in the direction of the displacement measures +Z/F, which is the same H. With
s = i omega and v the measured value, exp(i omega t):

    receptance      H = v              dynamic stiffness      H = 1/v
    mobility        H = v/s            mechanical impedance   H = 1/(v s)
    accelerance     H = v/s^2          apparent mass          H = 1/(v s^2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import ZSpringError


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


def _units(name: str, derivatives: int, inverse: bool, units: dict[str, float]) -> dict[str, Response]:
    return {unit: Response(name, derivatives, inverse, factor) for unit, factor in units.items()}


# The unit tells the kind.
RESPONSES: dict[str, Response] = {
    **_units("receptance", 0, False, {"m/N": 1.0, "mm/N": 1e-3, "um/N": 1e-6}),
    **_units("dynamic stiffness", 0, True, {"N/m": 1.0, "kN/m": 1e3, "N/mm": 1e3}),
    **_units("mobility", 1, False, {"m/(N.s)": 1.0, "(m/s)/N": 1.0, "(mm/s)/N": 1e-3}),
    **_units("mechanical impedance", 1, True, {"N.s/m": 1.0, "N/(m/s)": 1.0}),
    **_units("accelerance", 2, False, {"(m/s2)/N": 1.0, "1/kg": 1.0}),
    **_units("apparent mass", 2, True, {"kg": 1.0, "N/(m/s2)": 1.0}),
}

# Peak of the imposed sine: derivatives of the displacement, factor to SI.
AMPLITUDES: dict[str, tuple[int, float]] = {
    "m/s2": (2, 1.0),
    "mm/s2": (2, 1e-3),
    "m/s": (1, 1.0),
    "mm/s": (1, 1e-3),
    "m": (0, 1.0),
    "mm": (0, 1e-3),
}


def response_of(unit: str | None) -> Response:
    """The kind of response with this unit. Raises ZSpringError for none."""
    if unit not in RESPONSES:
        raise ZSpringError(f"unit [{unit or ''}]: must be one of {', '.join(RESPONSES)}")
    return RESPONSES[unit]


def acceleration_of(unit: str | None, frequency: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
    """Peak acceleration in m/s2 from a peak displacement, velocity or acceleration in `unit`."""
    if unit not in AMPLITUDES:
        raise ZSpringError(f"unit [{unit or ''}]: must be one of {', '.join(AMPLITUDES)}")
    derivatives, factor = AMPLITUDES[unit]
    return factor * amplitude * (2 * np.pi * frequency) ** (2 - derivatives)


QUANTITIES = {"receptance": "m/N", "stiffness": "N/m"}  # in which an FRF is shown


def as_quantity(H: complex | np.ndarray, quantity: str) -> complex | np.ndarray:
    """Receptance H in m/N, or dynamic stiffness 1/H in N/m."""
    with np.errstate(invalid="ignore"):  # of NaN, a point that was left out
        return H if quantity == "receptance" else 1 / H


def phase_degrees(value: complex | np.ndarray, quantity: str) -> float | np.ndarray:
    """Phase in degrees, cut far from where a driving point has it: -180 to 0 (receptance), 0 to 180."""
    sign = -1 if quantity == "receptance" else 1
    return sign * ((sign * np.degrees(np.angle(value)) + 90) % 360 - 90)
