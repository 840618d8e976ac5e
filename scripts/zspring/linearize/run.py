"""The linear models from the FMU's parameters to tables and files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from scipy.io import savemat

from ..fmu import Fmu
from ..heads import file_head
from ..receptance import MODELS, LinearModel, linear_model
from ..records import keep_others
from ..variables import Value, exact_list
from .modes import NEGLIGIBLE, Modes, complex_modes, natural_frequencies

TITLES = {
    "linear": "three masses, head spring k1",
    "locked": "linear model 1: rods locked",
    "free": "linear model 2: rods free, without friction",
}
UNITS = {"u1": "m", "alpha": "rad", "beta": "rad", "u2": "m", "u3": "m"}


def run_linearize(fmu: Fmu, parameters: Mapping[str, Value], frequency: np.ndarray, folder: Path) -> None:
    """Print the modes of all linear models and write each to linear-NAME.npz and .mat.

    frequency   (n,) in Hz, > 0, of the receptance in the files
    """
    used = fmu.used_parameters(parameters)
    head = file_head(fmu, used, {"frequencies": exact_list(frequency, "Hz")}, but_not=("drive", "suspension"))
    for name in MODELS:
        path = folder / f"linear-{name}.npz"
        keep_others(path, head, _found_head(path))
    folder.mkdir(parents=True, exist_ok=True)
    synthetic = fmu.variables.synthetic(used)
    written = []
    for name in MODELS:
        model = linear_model(used, name)
        reach = np.array([{"alpha": used["zspring.L1"], "beta": used["zspring.L2"]}.get(n, 1.0) for n in model.names])
        modes = complex_modes(model, reach)
        note = "  (of synthetic parameters)" if synthetic and name != "linear" else ""
        print(f"{TITLES[name]}{note}", *_table(model, modes), "", sep="\n")
        arrays: dict[str, Any] = {
            "M": model.M,
            "C": model.C,
            "K": model.K,
            "eigenvalues": modes.eigenvalues,
            "eigenvectors": modes.shapes,
            "natural_frequencies": natural_frequencies(model),
            "head_held_frequencies": natural_frequencies(model, head_held=True),
            "frequency": frequency,
            "receptance": model.receptance(frequency),
        }
        lines = [f"{key}: {value}" for key, value in head.items()]
        names, units = list(model.names), [UNITS[dof] for dof in model.names]
        paths = [folder / f"linear-{name}{suffix}" for suffix in (".npz", ".mat")]
        np.savez(paths[0], dof=np.array(names), unit=np.array(units), head=np.array(lines), **arrays)
        texts = {"dof": names, "unit": units, "head": lines}
        cells = {key: np.array(value, dtype=object) for key, value in texts.items()}
        savemat(paths[1], {**arrays, **cells}, oned_as="column")
        written += paths
    print("written:", *written)


def _found_head(path: Path) -> dict[str, str]:
    """That of a file that run_linearize wrote; empty for another, or none."""
    try:
        with np.load(path) as file:
            return dict(line.split(": ", 1) for line in file["head"].tolist())
    except (OSError, ValueError, KeyError, BadZipFile):
        return {}


def _table(model: LinearModel, modes: Modes) -> list[str]:
    """Frequencies, damping and shapes; a shape as magnitude and phase in degrees."""
    lines = [
        f"natural frequencies, undamped:  {_numbers(natural_frequencies(model))} Hz",
        f"with the head held:             {_numbers(natural_frequencies(model, head_held=True))} Hz",
        f"{'mode, Hz':>10}{'damping':>9}   " + "".join(f"{name:<16}" for name in model.names),
    ]
    for f, zeta, shape in zip(modes.frequencies, modes.damping, modes.shapes.T):
        cells = "".join(f"{_polar(value):<16}" for value in shape)
        ratio = "rigid" if np.isnan(zeta) else f"{abs(zeta):.4f}"
        lines.append(f"{f:>10.4f}{ratio:>9}   {cells}".rstrip())
    return lines


def _numbers(values: np.ndarray) -> str:
    return ", ".join(f"{value:.3f}" for value in values)


def _polar(value: complex) -> str:
    if abs(value) <= 10 * NEGLIGIBLE:
        return "0"
    angle = round(np.degrees(np.angle(value)))
    return f"{abs(value):.4g} at {180 if angle == -180 else angle}°"
