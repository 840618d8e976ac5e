"""Data sets of universal files, by pyuff: from files as people have them, and of responses to write."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ZSpringError, missing_extra
from .curves import Curve

FUNCTION, UNITS = 58, 164  # types of data sets

_MARK = re.compile(rb"    -1[ \t]*\r?$", re.MULTILINE)
_BINARY = re.compile(rb"^    58[bB][^\n]*\n(?:[^\n]*\n){11}", re.MULTILINE)  # the head of a binary data set
_EXPONENT = re.compile(r"(?<=[\d.])[dD](?=[-+]\d)")


@dataclass(frozen=True)
class DataSet:
    """A data set as pyuff names its fields, without its values."""

    number: int  # in the file, from 1
    fields: Mapping[str, Any] = field(repr=False)

    def __getitem__(self, key: str) -> Any:
        return self.fields.get(key)

    def text(self, key: str) -> str:
        """A text; empty for NONE."""
        text = " ".join(str(self[key] or "").split())
        return "" if text.upper() == "NONE" else text


class UniversalFile:
    """A universal file; a context manager.

    Its text may be Windows-1252 and have exponents with D, which pyuff does not read.
    Raises ZSpringError for a missing package, a file that is none or not complete, and heads that cannot be read.
    """

    def __init__(self, path: Path):
        pyuff = pyuff_package()
        content = path.read_bytes()
        marks = len(_MARK.findall(content))
        if not marks:
            raise ZSpringError(f"{path}: no universal file: it has no data set between lines with -1")
        if marks % 2:
            raise ZSpringError(f"{path}: not complete: the last data set does not end with -1")
        self._path = path
        self._folder = tempfile.TemporaryDirectory(prefix="zspring-")
        copy = Path(self._folder.name) / "copy.uff"
        copy.write_bytes(_readable(content))
        self._file = pyuff.UFF(str(copy))
        count = self._file.get_n_sets()
        self.sets = [DataSet(number, self._read(number, header_only=True)) for number in range(1, count + 1)]

    def values(self, data: DataSet) -> tuple[np.ndarray, np.ndarray]:
        """Abscissa (n,) and ordinate (n,) of a data set 58. Raises ZSpringError if they cannot be read or some miss."""
        fields = self._read(data.number, header_only=False)
        x, ordinate = np.asarray(fields["x"], float), np.asarray(fields["data"])
        if not x.size == ordinate.size == data["num_pts"]:
            raise ZSpringError(f"{ordinate.size} values where {data['num_pts']} are announced")
        return x, ordinate

    def _read(self, number: int, header_only: bool) -> dict[str, Any]:
        try:
            with np.errstate(invalid="ignore"):  # of numbers that are not finite
                return self._file.read_sets(number - 1, header_only=header_only)
        except Exception as error:  # pyuff raises nothing more specific, about what went wrong before
            reason: BaseException = error
            while reason.__context__:
                reason = reason.__context__
            raise ZSpringError(f"{self._path}, data set {number}: cannot be read: {reason}") from None

    def __enter__(self) -> UniversalFile:
        return self

    def __exit__(self, *_) -> None:
        self._folder.cleanup()


def write_responses(path: Path, title: str, curves: Sequence[Curve]) -> Path:
    """A universal file with driving-point receptances in m/N, one data set 58 for each curve.

    The Z axis has the median of its amplitudes. Raises ZSpringError for a missing package.
    """
    pyuff = pyuff_package()
    sets = []
    for curve in curves:
        order = np.argsort(curve.frequency)
        fields = pyuff.prepare_58(
            func_type=4,
            x=curve.frequency[order],
            data=curve.H[order],
            id1=title[:80],
            id2=curve.label[:80],
            **{f"{which}_{what}": value for which in ("rsp", "ref") for what, value in (("node", 1), ("dir", 3))},
            binary=0,
            ord_data_type=6,  # complex, double
            abscissa_spacing=0,  # each frequency as it was
            abscissa_spec_data_type=18,
            abscissa_axis_units_lab="Hz",
            ordinate_spec_data_type=8,
            ordinate_axis_units_lab="m",
            orddenom_spec_data_type=13,
            orddenom_axis_units_lab="N",
            z_axis_spec_data_type=12,
            z_axis_axis_units_lab="m/s2",
            z_axis_value=float(np.median(curve.acceleration)),
        )
        sets.append({**fields, "type": FUNCTION})
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")
    return path


def pyuff_package() -> Any:
    """The package pyuff. Raises ZSpringError where it is missing."""
    try:
        import pyuff
    except ImportError:
        raise missing_extra(["pyuff"], "uff") from None
    return pyuff


def _readable(content: bytes) -> bytes:
    """What pyuff reads: UTF-8, exponents with E, no blanks at the ends of lines; of a binary file only its heads."""
    if _BINARY.search(content):
        return _BINARY.sub(lambda head: _text(head[0]).encode(), content)
    lines = (line.rstrip() for line in _EXPONENT.sub("E", _text(content)).splitlines())
    return "".join(f"{line}\n" for line in lines).encode()


def _text(content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")
