"""Readers of time records: what their files have in common is a Recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ZSpringError, missing_extra
from ..tables import read_table
from .channels import Channel, Recording

EXTRA = "bench"
HDF5 = b"\x89HDF\r\n\x1a\n"  # at the begin of a file, or after MATLAB's 512 bytes
TIME_RECORD = 1  # function type of data sets 58


def read_recording(path: Path, skip: int = 0) -> Recording:
    """The channels of a file, whose suffix tells its form: .mat, .h5, .hdf5, .hdf, .tdms, .uff, .unv, .uf; else text.

    skip    lines of a text before that with the names
    Raises ZSpringError for a missing package, a file that is not what its suffix tells, or without channels.
    """
    readers: dict[str, Callable[[Path], dict[str, Channel]]] = {
        ".mat": _mat,
        ".h5": _hdf5,
        ".hdf5": _hdf5,
        ".hdf": _hdf5,
        ".tdms": _tdms,
        ".uff": _uff,
        ".unv": _uff,
        ".uf": _uff,
    }
    if not path.is_file():
        raise FileNotFoundError(2, "No such file", str(path))
    reader = readers.get(path.suffix.lower())
    channels = reader(path) if reader else _text(path, skip)
    if not channels:
        raise ZSpringError(f"{path}: no channel with values over time")
    return Recording(path, channels)


def _text(path: Path, skip: int) -> dict[str, Channel]:
    """Columns of a table as `tables.py` reads it; an empty cell or NaN is a missing value."""
    table = read_table(path, skip=skip)
    return {column.name: Channel(table.numbers(key, gaps=True), column.unit) for key, column in table.columns.items()}


def _mat(path: Path) -> dict[str, Channel]:
    """Variables of a MAT file: vectors, columns of matrices as NAME:1 and so on, fields of structs as NAME.FIELD."""
    from scipy.io import loadmat, matlab

    with open(path, "rb") as file:
        begin = file.read(520)
    if HDF5 in (begin[:8], begin[512:]):  # version 7.3
        return _hdf5(path)
    try:
        content = loadmat(path, simplify_cells=True)
    except (ValueError, TypeError, NotImplementedError, matlab.MatReadError, OSError) as error:
        raise ZSpringError(f"{path}: no MAT file: {error}") from None
    return dict(_vectors({k: v for k, v in content.items() if not k.startswith("__")}, ""))


def _vectors(content: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Channel]]:
    for key, item in content.items():
        if isinstance(item, Mapping):
            yield from _vectors(item, f"{prefix}{key}.")
        elif isinstance(item, np.ndarray):
            yield from _columns(f"{prefix}{key}", item)


def _columns(name: str, values: np.ndarray, unit: str | None = None) -> Iterator[tuple[str, Channel]]:
    """A vector, or the columns of a matrix along its longer side; nothing for what are no real numbers over time."""
    if values.dtype.kind not in "fiu" or values.ndim > 2 or values.size < 2:
        return
    values = np.atleast_2d(np.squeeze(values)).astype(float)
    if values.shape[0] > values.shape[1]:
        values = values.T
    for number, row in enumerate(values, 1):
        yield (name if len(values) == 1 else f"{name}:{number}"), Channel(row, unit)


def _hdf5(path: Path) -> dict[str, Channel]:
    """Data sets by their paths with / between; their attribute unit, units or Unit tells the unit."""
    try:
        import h5py
    except ImportError:
        raise missing_extra(["h5py"], EXTRA) from None
    found: dict[str, Channel] = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#"):
            return
        if item.dtype.names:  # a table
            for field in item.dtype.names:
                found.update(_columns(f"{name}/{field}", np.asarray(item[field])))
            return
        if item.attrs.get("MATLAB_class", b"double") in (b"char", b"cell", b"logical"):
            return
        unit = next((item.attrs[key] for key in ("unit", "units", "Unit", "Units") if key in item.attrs), None)
        unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else unit
        found.update(_columns(name, np.asarray(item), str(unit) if unit is not None else None))

    try:
        with h5py.File(path, "r") as file:
            file.visititems(visit)
    except OSError as error:
        raise ZSpringError(f"{path}: no HDF5 or MAT file: {error}") from None
    return found


def _tdms(path: Path) -> dict[str, Channel]:
    """Channels of a TDMS file, as GROUP/CHANNEL where two groups have one of a name."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise missing_extra(["npTDMS"], EXTRA) from None
    try:
        groups = TdmsFile.read(path).groups()
    except (ValueError, OSError, EOFError, KeyError) as error:
        raise ZSpringError(f"{path}: no TDMS file: {error}") from None
    names = [channel.name for group in groups for channel in group.channels()]
    found = {}
    for group in groups:
        for channel in group.channels():
            values, told = np.asarray(channel[:]), channel.properties
            if values.dtype.kind not in "fiu" or values.size < 2:
                continue
            name = channel.name if names.count(channel.name) == 1 else f"{group.name}/{channel.name}"
            unit = told.get("unit_string") or told.get("NI_UnitDescription")
            step, start = told.get("wf_increment"), told.get("wf_start_offset", 0.0)
            found[name] = Channel(values.astype(float), unit or None, float(step) if step else None, float(start))
    return found


def _uff(path: Path) -> dict[str, Channel]:
    """Data sets 58 of function type 1, by their first line of text, or by number where that does not tell them apart.

    Raises ZSpringError with the number of a data set that is no record over time.
    """
    from ..bench.uff_file import FUNCTION, UniversalFile

    found = {}
    with UniversalFile(path) as file:
        sets = [each for each in file.sets if each["type"] == FUNCTION and each["func_type"] == TIME_RECORD]
        names = [each.text("id1") for each in sets]
        for each, name in zip(sets, names):
            time, values = file.values(each)
            label = each.text("ordinate_axis_units_lab") or None
            key = name if name and names.count(name) == 1 else str(each.number)
            step = float((time[-1] - time[0]) / (time.size - 1)) if time.size > 1 else None
            found[key] = Channel(np.real(values).astype(float), label, step, float(time[0]))
    return found
