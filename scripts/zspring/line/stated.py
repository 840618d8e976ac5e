"""What the head of a file with a contact force says of the line and the run.

Lines "# key: value unit" with the keys span, spans, first support and speed; in the files of `zspring couple` and
`zspring en50318` it stands under the parameters of the catenary, whose first support is at 0 m, or where all its spans
begin and end does; where the far end begins to tell stands beside it. Values that begin with no number say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import ZSpringError
from ..units import UnitError, conversion

UNDISTURBED = "pantograph {} undisturbed until"
BOUNDARIES = "catenary span boundaries"
SAME_SPEED = 0.02  # relative: speeds closer than this are one speed
_OUR_SPAN, _OUR_SPANS = "catenary line.span", "catenary line.spans"
_VALUE = re.compile(r"([-+]?\d+(?:\.\d+)?)(?:\s+(\S.*))?")


@dataclass(frozen=True)
class Stated:
    """None for what the file does not say."""

    span: float | None = None  # m
    spans: int | None = None
    first_support: float | None = None  # m, where span 1 begins
    speed: float | None = None  # m/s
    undisturbed_until: float | None = None  # m, by the far end: see waves.py
    boundaries: tuple[float, ...] | None = None  # m, of the spans, of a line by file

    @classmethod
    def in_head(cls, path: Path, head: Mapping[str, str], pantograph: int = 1) -> Stated:
        """Raises ZSpringError for a number without its unit, or with one of another kind."""

        def value(unit: str, *keys: str) -> float | None:
            for key in keys:
                if found := _VALUE.fullmatch(head.get(key, "")):
                    try:
                        return float(found[1]) * conversion(found[2] or "", unit)[1]
                    except UnitError as error:
                        raise ZSpringError(f"{path}, # {key}: {error}") from None
            return None

        spans, is_ours = value("1", "spans", _OUR_SPANS), _OUR_SPAN in head or BOUNDARIES in head
        boundaries = tuple(map(float, head[BOUNDARIES].split()[:-1])) if BOUNDARIES in head else None
        return cls(
            span=value("m", "span", _OUR_SPAN),
            spans=None if spans is None else int(spans),
            first_support=0.0 if is_ours else value("m", "first support"),
            speed=value("m/s", "speed"),
            undisturbed_until=value("m", UNDISTURBED.format(pantograph)),
            boundaries=boundaries,
        )


def agreed(what: str, unit: str, said: Mapping[str, float | None], tolerance: float = 1e-6) -> float | None:
    """The one value that all say, in `unit`, by who says it; None where nobody does.

    tolerance   relative, with which two are one: the first then counts
    Raises ZSpringError where two differ.
    """
    known = {name: value for name, value in said.items() if value is not None}
    for name, value in known.items():
        first, counted = next(iter(known.items()))
        if abs(value - counted) > tolerance * max(abs(value), abs(counted)):
            raise ZSpringError(f"{what}: {counted:.6g} {unit} by {first}, but {value:.6g} {unit} by {name}")
    return next(iter(known.values()), None)
