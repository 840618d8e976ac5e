"""What a file of results says at its head, and a figure in its title, of the FMU and its parameters."""

from __future__ import annotations

import hashlib
from collections.abc import Container, Iterable, Mapping
from datetime import datetime, timezone
from pathlib import Path

from .fmu import Fmu
from .variables import Value, text, with_unit


def file_head(
    fmu: Fmu, parameters: Mapping[str, Value], settings: Mapping[str, str] | None = None, but_not: Container[str] = ()
) -> dict[str, str]:
    """FMU and GUID, the run's own settings, which parameters are synthetic, then all of them with their units.

    parameters  of the FMU, calculated ones included
    but_not     names of parameters that say nothing of this run
    """
    listed = {name: with_unit(fmu.variables[name], value) for name, value in parameters.items() if name not in but_not}
    synthetic = " ".join(fmu.variables.synthetic(parameters))
    return {**fmu.identity, **(settings or {}), "synthetic": synthetic, **listed}


def content_of(paths: Iterable[Path]) -> dict[str, str]:
    """For a head: the files that went into the results, each with the SHA-256 of what it held."""
    digests = ((hashlib.sha256(path.read_bytes()).hexdigest(), path) for path in paths)
    return {f"file {i}": f"{digest} {path.as_posix()}" for i, (digest, path) in enumerate(digests, 1)}


def now() -> str:
    """Date and time (UTC) for a head."""
    return datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def synthetic_note(fmu: Fmu, parameters: Mapping[str, Value]) -> str:
    """What a title says of Z-spring parameters that nobody measured; empty if there are none or no Z-spring."""
    if text(fmu.variables["suspension"], parameters["suspension"]) == "Linear":
        return ""
    return "; Z-spring parameters synthetic" if fmu.variables.synthetic(parameters) else ""


def model_note(fmu: Fmu, parameters: Mapping[str, Value]) -> str:
    """What a title says of suspension, friction and internal step."""
    suspension, friction = (text(fmu.variables[name], parameters[name]) for name in ("suspension", "friction"))
    model = f"friction {friction}" if suspension == "ZSpring" else f"suspension {suspension}"
    return f"{model}, step {1e3 * parameters['solver.step']:g} ms"
