"""Waves along a line: their speed, and where a pantograph meets what the far end reflects.

A run begins with the pantographs already at the wire: the front of waves that this start sends ahead runs with the
faster of the two wires' speeds, sqrt(tension / mass), comes back from the line's end and meets each pantograph. From
there on the contact force is that of a line that ends, and of no longer one. Bending stiffness lets only what is far
above 20 Hz run faster; clamps and droppers slow the wires down.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..fmu import Fmu
from ..variables import Value
from .journey import FittedJourney, LineExtent, parameter_value


def wave_speed(catenary: Fmu, line: Mapping[str, Value], wire: str) -> float:
    """m/s of the "contact_wire" or the "messenger"."""
    tension, mass = (parameter_value(catenary, line, f"{wire}.{name}") for name in ("tension", "mass"))
    return (tension / mass) ** 0.5


def fastest(catenary: Fmu, line: Mapping[str, Value]) -> float:
    """Wave speed of the faster wire, m/s."""
    return max(wave_speed(catenary, line, wire) for wire in ("contact_wire", "messenger"))


def undisturbed_until(extent: LineExtent, journey: FittedJourney, behind: float, wave: float) -> float:
    """Where a pantograph `behind` m behind the first one meets the reflected front, m along the line.

    The front leaves the first one's start. wave: m/s. A pantograph as fast as the wave has no front ahead.
    """
    ahead = extent.length - journey.start
    time = (2 * ahead + behind) / (wave + journey.speed)  # until front and pantograph have covered the way together
    return min(journey.start - behind + journey.speed * time, extent.length)
