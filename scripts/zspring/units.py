"""Units as people write them: one list of spellings for all readers, converted by pint.

A unit is made of the symbols below: m/s2, m/s^2, m/s**2, m/s², (m/s2)/N, N.m, N·m, N m, kN/mm. "g" is the standard
acceleration of gravity, as analysers write it. Nothing is guessed: what is not in the list is refused, and so is
m/N.s, which could be m/(N.s) or (m/N).s.
"""

from __future__ import annotations

import math
import re
from functools import cache

from .errors import ZSpringError

SYMBOLS = {
    "m": "meter",
    "mm": "millimeter",
    "cm": "centimeter",
    "um": "micrometer",
    "µm": "micrometer",
    "μm": "micrometer",
    "km": "kilometer",
    "s": "second",
    "ms": "millisecond",
    "min": "minute",
    "h": "hour",
    "N": "newton",
    "kN": "kilonewton",
    "mN": "millinewton",
    "daN": "decanewton",
    "kgf": "kilogram_force",
    "kg": "kilogram",
    "J": "joule",
    "W": "watt",
    "V": "volt",
    "mV": "millivolt",
    "rad": "radian",
    "mrad": "milliradian",
    "deg": "degree",
    "°": "degree",
    "%": "percent",
    "g": "standard_gravity",
    # As turns in a second, so that they are told from rad/s.
    "Hz": "turn/second",
    "kHz": "kiloturn/second",
    "rpm": "turn/minute",
}
SPELLINGS = {"sec": "s", "SEC": "s", "hz": "Hz", "hertz": "Hz", "Hertz": "Hz", "HERTZ": "Hz"}  # of symbols
# Capitals as analysers write them; not MN, which could be mN.
SPELLINGS |= {symbol.upper(): symbol for symbol in ("m", "mm", "um", "s", "rad", "g", "kg", "kN", "Hz", "kHz", "rpm")}
SUPERSCRIPTS = str.maketrans("⁻¹²³⁴", "-1234")
PRODUCTS = "*.·⋅ "
NONE = ("", "1", "-")  # of a number without dimension

_TOKEN = re.compile(r"([^\W\d_]+|°|%)(?:\^|\*\*)?(-?\d+)?|(\d+)|([/*().·⋅ ])")


class UnitError(ZSpringError):
    """The unit is unknown, or of another kind than wanted."""


def conversion(unit: str, *wanted: str) -> tuple[str, float]:
    """The first of the `wanted` units that `unit` is a multiple of, and the factor to it.

    Raises UnitError for a unit that is not known, or that is of the kind of none of these.
    """
    if unit in wanted:
        return unit, 1.0
    quantity = _pint(unit)
    for target in wanted if quantity is not None else ():
        other = _pint(target)
        if quantity.dimensionality == other.dimensionality:
            factor = float((1 * _counting(quantity, other)).m_as(other))
            short = float(f"{factor:.12g}")  # a millimetre is 0.001 m, not what a division leaves in the last bit
            return target, short if math.isclose(short, factor, rel_tol=1e-15) else factor
    raise UnitError(f"unit [{unit}]: must be one of {', '.join(offered(*wanted))}")


def offered(*wanted: str) -> list[str]:
    """The wanted units, each with the symbols that are multiples of it; what a message offers."""
    found: dict[str, None] = {}
    for target in wanted:
        kind = _pint(target).dimensionality
        found |= dict.fromkeys([target, *(s for s in SYMBOLS if s.isascii() and _pint(s).dimensionality == kind)])
    return list(found)


def is_unit(text: str) -> bool:
    """Whether this is how a unit is written."""
    return text.strip() in NONE or _pint(text) is not None


def _counting(quantity, other):
    """The same unit in turns, if `other` is and it has no angle at all, or without them: 1/s is Hz, rad/s is not."""
    turn, angle = _registry().turn, re.compile("turn|radian|degree")
    if "turn" in str(other) and not angle.search(str(quantity)):
        return quantity * turn
    if "turn" in str(quantity) and not angle.search(str(other)):
        return quantity / turn
    return quantity


@cache
def _registry():
    import pint  # slow to load

    return pint.UnitRegistry()


@cache
def _pint(unit: str):
    """pint's unit; None for one that is not of the SYMBOLS."""
    text = unit.strip().translate(SUPERSCRIPTS)
    if text in NONE:
        return _registry().dimensionless
    parts, end, divides = [], 0, [False]  # whether a / was met, by depth of the brackets
    for token in _TOKEN.finditer(text):
        symbol, exponent, number, operator = token.groups()
        symbol = SPELLINGS.get(symbol, symbol)
        if token.start() != end or (symbol and symbol not in SYMBOLS):
            return None
        end = token.end()
        if symbol:
            parts.append(f"({SYMBOLS[symbol]})" + (f"**({exponent})" if exponent else ""))
            continue
        if operator == "(":
            divides.append(False)
        elif operator == ")":
            divides.pop()
        if not divides or (operator and operator in PRODUCTS and divides[-1]):
            return None
        if operator == "/":
            divides[-1] = True
        parts.append("*" if operator and operator in PRODUCTS else number or operator)
    try:
        return _registry().Unit("".join(parts)) if end == len(text) else None
    except Exception:  # pint's parser raises many kinds for what is no expression
        return None
