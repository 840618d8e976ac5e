"""Runs that every client repeats, and what our own driver makes of them.

An input holds its value from the begin of a communication step to the next; all begin with their start values, so
that it does not matter which of them a client sets before the first step.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness import Value
from zspring.fmu import CATENARY, PANTOGRAPH, Fmu, installed_fmu


@dataclass(frozen=True)
class Run:
    """One FMU alone.

    parameters  by name, enumerations by number
    step        communication step, s
    inputs      values at the begin of each step (n,), by name
    outputs     those to compare
    """

    model: str
    parameters: Mapping[str, Value]
    step: float
    inputs: Mapping[str, np.ndarray]
    outputs: tuple[str, ...]

    @property
    def path(self) -> str:
        return str(installed_fmu(self.model))

    @property
    def time(self) -> np.ndarray:
        """Begin of each step, s, shape (n,)."""
        return self.step * np.arange(len(next(iter(self.inputs.values()))))

    def reference(self) -> np.ndarray:
        """Outputs after each step from our own driver, shape (n, len(outputs))."""
        rows = []
        with Fmu(installed_fmu(self.model)) as fmu, fmu.instances() as (instance,):
            instance.start(self.parameters)
            for n, time in enumerate(self.time):
                instance.set({name: float(values[n]) for name, values in self.inputs.items()})
                instance.step(time, self.step)
                rows.append(instance.get(self.outputs))
        return np.array(rows, float)

    def check(self, found: np.ndarray) -> None:
        """Whether a client found the same, shape as reference(); it may add up the time, so last bits may differ."""
        reference = self.reference()
        scale = np.abs(reference).max(axis=0)
        assert np.all(scale > 0)
        np.testing.assert_allclose(found / scale, reference / scale, rtol=0, atol=1e-9)


def waves(count: int, amplitude: float, periods: float) -> np.ndarray:
    return amplitude * np.sin(2 * np.pi * periods * np.arange(count) / count) ** 3


RUNS = {
    "force": Run(
        PANTOGRAPH,
        {"friction": 2, "zspring.Mf": 0.25},  # Coulomb
        0.002,
        {"contact_force": 120.0 + waves(500, 60.0, 4.0), "uplift.lower_frame": waves(500, 10.0, 1.5)},
        ("head.z", "lower_frame.v", "contact.force", "zspring.moment_alpha", "energy.dissipated"),
    ),
    "displacement": Run(
        PANTOGRAPH,
        {"drive": 2, "solver.max_iterations": 60},
        0.002,
        {"head_displacement": waves(500, 0.02, 3.0)},
        ("head.z", "lower_frame.v", "contact.force", "zspring.moment_alpha", "energy.dissipated"),
    ),
    "moving force": Run(
        CATENARY,
        {"line.spans": 4, "pantograph[1].start": 60.0, "damping.mass": 0.02},
        0.001,
        {
            "pantograph[1].force": 150.0 * np.sin(np.linspace(0, np.pi, 800)) ** 2,
            "pantograph[1].speed": np.minimum(60.0, np.arange(800.0)),
        },
        ("pantograph[1].x", "pantograph[1].wire_height", "support.uplift[3]", "droppers.force_max", "energy.work"),
    ),
}
