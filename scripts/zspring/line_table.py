"""The table of numbers by which an FMU of the catenary knows a line of any kind: resources/line.table in it.

    "zspline1", then little-endian IEEE doubles:
    number of supports, supports; contact wire height at begin and end; number of droppers, droppers;
    stitch wires, point masses and points of the profile in the same way

SI units, upward positive, places from the line's begin, in ascending order. `zspring line` makes it of a line file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ZSpringError

FILE = "line.table"  # in the FMU's resources
MAGIC = b"zspline1"
CONTACT, MESSENGER = 0.0, 1.0  # a point mass is on
ON_MESSENGER, ON_STITCH = 0.0, 1.0  # the upper end of a dropper is
NEVER_PULLS = 10.0  # m too long: a dropper that is missing or broken
_REPLACED = "line.", "dropper.", "support.", "steady_arm."


def _numbers(*names: str) -> np.dtype:
    return np.dtype([(name, "<f8") for name in names])


# m: place, height of the messenger over the datum; N/m under it; kg and N/m of the steady arm. Of span boundaries, the
# first and the last of which are the anchors, where the last three are 0.
SUPPORT = _numbers("x", "messenger", "stiffness", "arm_mass", "arm_stiffness")
# m: place; upper end; m: height of the contact wire there; N/m of any length where EA, N, is 0; kg/m; clamps, kg; m:
# unstretched length, 0 as the height asks for, else the height is what comes out; m added to the unstretched length.
DROPPER = _numbers(
    *("x", "upper", "height", "stiffness", "EA", "mass", "clamp_contact", "clamp_upper", "length", "length_error")
)
STITCH = _numbers("begin", "end", "tension", "mass", "clamp")  # m: clamps on the messenger; N; kg/m; kg of each clamp
POINT_MASS = _numbers("x", "wire", "mass")  # m; CONTACT or MESSENGER; kg
PROFILE = _numbers("x", "height", "slope")  # m, m, 1: irregularity of the contact wire, cubic between, 0 outside
_LISTS = {"supports": SUPPORT, "droppers": DROPPER, "stitches": STITCH, "masses": POINT_MASS, "profile": PROFILE}


def replaces(parameter: str) -> bool:
    """Whether a table stands in for this parameter of the catenary."""
    return parameter.startswith(_REPLACED)


def guid(of_fmu: str, line: LineTable) -> str:
    """The GUID of an FMU with this line: {GUID}[ reals] line=DIGEST[ REFERENCE=BITS]..."""
    whole, *told = (part for part in of_fmu.split(" ") if not part.startswith("line="))
    place = told[:1] == ["reals"]
    return " ".join([whole, *told[:place], f"line={line.digest}", *told[place:]])


@dataclass(frozen=True)
class LineTable:
    """Structured arrays of these types; ends: height of the contact wire at begin and end, m."""

    supports: np.ndarray  # (n + 1,) SUPPORT of n spans
    ends: tuple[float, float] = (0.0, 0.0)
    droppers: np.ndarray = field(default_factory=lambda: np.zeros(0, DROPPER))
    stitches: np.ndarray = field(default_factory=lambda: np.zeros(0, STITCH))
    masses: np.ndarray = field(default_factory=lambda: np.zeros(0, POINT_MASS))
    profile: np.ndarray = field(default_factory=lambda: np.zeros(0, PROFILE))

    @cached_property
    def content(self) -> bytes:
        """The file's."""
        parts = [MAGIC]
        for name in _LISTS:
            entries = getattr(self, name)
            parts += [np.array(len(entries), "<f8").tobytes(), entries.tobytes()]
            parts += [np.array(self.ends, "<f8").tobytes()] if name == "supports" else []
        return b"".join(parts)

    @cached_property
    def digest(self) -> str:
        """FNV-1a of the file, 64 bits as hexadecimal digits: an FMU with the table has it in its GUID."""
        value = 14695981039346656037
        for byte in self.content:
            value = ((value ^ byte) * 1099511628211) & 0xFFFFFFFFFFFFFFFF
        return f"{value:016x}"

    @classmethod
    def read(cls, path: Path) -> LineTable:
        """Raises ZSpringError for what is no table."""
        data, at = path.read_bytes(), len(MAGIC)
        found: dict[str, Any] = {}
        try:
            for name, kind in _LISTS.items():
                count = int(np.frombuffer(data, "<f8", 1, at)[0])
                found[name] = np.frombuffer(data, kind, max(count, 0), at + 8) if count else np.zeros(0, kind)
                at += 8 + found[name].nbytes
                if name == "supports":
                    found["ends"] = tuple(np.frombuffer(data, "<f8", 2, at).tolist())
                    at += 16
        except (ValueError, OverflowError):
            at = -1
        if at != len(data) or not data.startswith(MAGIC) or len(found["supports"]) < 2:
            raise ZSpringError(f"{path} is no table of a line")
        return cls(**found)

    def write(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(self.content)

    def irregularity(self, x: np.ndarray) -> np.ndarray:
        """Of the contact wire at places in m, m. (n,)"""
        if not len(self.profile):
            return np.zeros(len(x))
        from scipy.interpolate import CubicHermiteSpline  # slow to load

        points = (self.profile[name] for name in ("x", "height", "slope"))
        return np.nan_to_num(CubicHermiteSpline(*points, extrapolate=False)(x))

    @property
    def boundaries(self) -> np.ndarray:
        """Where spans begin and end, m. (n + 1,)"""
        return self.supports["x"]
