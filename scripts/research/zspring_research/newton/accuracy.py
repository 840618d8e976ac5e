"""What the steepness tau of the regularised law costs in accuracy: everything against the Coulomb law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from zspring.bench.fixed_work import Point, run_points
from zspring.fmu import Instance
from zspring.variables import Value

from .recorded import SETTLING_PERIODS


@dataclass(frozen=True)
class Errors:
    """Of one tau, relative. Force and position: largest in a period, over the Coulomb law's peak."""

    tau: float  # s
    H_median: float
    H_largest: float
    contact_force: float  # head imposed
    head_position: float  # force imposed


def accuracy(
    instance: Instance,
    parameters: Mapping[str, Value],
    points: Sequence[Point],
    frequency: float,
    acceleration: float,
    tau: float,
    coulomb: CoulombReference,
) -> Errors:
    """Errors of the regularised law with `tau` in s.

    points      of the figure, for H
    frequency   in Hz, and acceleration in m/s2: the bench for contact force and head position
    """
    regularized = {**parameters, **instance.variables.parse_assignments(["friction=Regularized"]), "zspring.tau": tau}
    error = np.abs(run_points(instance, regularized, points).H / coulomb.H - 1)
    force = contact_force(instance, regularized, frequency, acceleration)
    head = head_position(instance, regularized, frequency, coulomb.force_amplitude)
    return Errors(
        tau,
        float(np.nanmedian(error)),
        float(np.nanmax(error)),
        float(np.abs(force - coulomb.contact_force).max() / np.abs(coulomb.contact_force).max()),
        float(np.abs(head - coulomb.head_position).max() / np.abs(coulomb.head_position).max()),
    )


@dataclass(frozen=True)
class CoulombReference:
    """The Coulomb law's answers."""

    H: np.ndarray  # (points,) in m/N
    contact_force: np.ndarray  # (n,) in N, one period, without its mean
    head_position: np.ndarray  # (n,) in m, one period, without its mean
    force_amplitude: float  # N, with which the head was moved


def coulomb_reference(
    instance: Instance, parameters: Mapping[str, Value], points: Sequence[Point], frequency: float, acceleration: float
) -> CoulombReference:
    """The same as `accuracy` runs, under the Coulomb law."""
    coulomb = {**parameters, **instance.variables.parse_assignments(["friction=Coulomb"])}
    force = contact_force(instance, coulomb, frequency, acceleration)
    amplitude = float(np.abs(force).max())
    return CoulombReference(
        run_points(instance, coulomb, points).H,
        force,
        head_position(instance, coulomb, frequency, amplitude),
        amplitude,
    )


def contact_force(
    instance: Instance, parameters: Mapping[str, Value], frequency: float, acceleration: float
) -> np.ndarray:
    """One steady period of the contact force on the bench, (n,) in N, without its mean."""
    variables = instance.variables
    bench = {"bench.frequency": frequency, "bench.acceleration": acceleration}
    instance.start({**parameters, **bench, **variables.parse_assignments(["drive=Bench"])})
    (count,) = map(int, instance.get(["bench.steps_per_period"]))
    step, begin = 1 / (frequency * count), SETTLING_PERIODS / frequency
    instance.step(0, begin)
    force = []
    for i in range(count):
        instance.step(begin + i * step, step)
        force += instance.get(["contact.force"])
    return np.array(force) - np.mean(force)


def head_position(
    instance: Instance, parameters: Mapping[str, Value], frequency: float, amplitude: float
) -> np.ndarray:
    """One period of the head's position, (n,) in m, without its mean, under a sinusoidal contact force.

    amplitude of the force in N about the static one.
    """
    variables = instance.variables
    parameters = {**parameters, "bench.frequency": frequency, **variables.parse_assignments(["drive=Force"])}
    instance.start(parameters)
    static_force, steps = instance.get(["static_force", "bench.steps_per_period"])
    instance.start(parameters, {"contact_force": static_force})
    count = int(steps)
    step = 1 / (frequency * count)
    wave = static_force + amplitude * np.sin(2 * np.pi * np.arange(count + 1) / count)
    z = []
    for i in range(SETTLING_PERIODS * count):
        now, then = wave[i % count], wave[i % count + 1]
        instance.set({"contact_force": float(now)})
        instance.set_slopes({"contact_force": float(then - now) / step})
        instance.step(i * step, step)
        z += instance.get(["head.z"])
    last = np.array(z[-count:])
    return last - last.mean()
