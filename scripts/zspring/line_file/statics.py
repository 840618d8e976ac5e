"""What a line is at rest, by its FMU: where its wires hang, what its droppers carry, how far a force lifts it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..fmu import Fmu
from ..variables import Value, parse

FORCE = 100.0  # N


@dataclass(frozen=True)
class AtRest:
    """Heights at n places along the line, m over the datum. Where there is no stitch wire, its is the messenger's."""

    x: np.ndarray  # (n,) m
    contact_wire: np.ndarray
    messenger: np.ndarray
    stitch_wire: np.ndarray
    dropper_force: np.ndarray  # N, of the dropper that is nearest
    irregularity: np.ndarray  # m, that is part of the contact wire's height, and no dropper's work

    @property
    def dropper_length(self) -> np.ndarray:
        """Between the wires, m, at places of droppers."""
        return self.stitch_wire - (self.contact_wire - self.irregularity)


def at_rest(catenary: Fmu, parameters: Mapping[str, Value], places: Iterable[float]) -> AtRest:
    """The line at these places, m. Raises FmuError for a line that the FMU refuses, in one line with the span."""
    points = [name.removeprefix("point.position") for name in catenary.parameter_names if "point.position" in name]
    names = "height", "messenger_height", "stitch_height", "dropper_force"
    x = np.asarray(list(places), float)
    rows: list[list[Value]] = []
    with catenary.instances() as (instance,):
        instance.start(parameters)
        for begin in range(0, len(x), len(points)):
            group = x[begin : begin + len(points)].tolist()
            instance.set({f"point.position{i}": place for i, place in zip(points, group)})
            rows += [instance.get([f"point.{name}{i}" for name in names]) for i, _ in zip(points, group)]
    contact_wire, messenger, stitch_wire, force = np.array(rows, float).reshape(-1, len(names)).T
    irregularity = catenary.line.irregularity(x) if catenary.line else np.zeros(len(x))
    return AtRest(x, contact_wire, messenger, stitch_wire, force, irregularity)


def elasticity(
    catenary: Fmu, parameters: Mapping[str, Value], places: Iterable[float], force: float = FORCE
) -> np.ndarray:
    """Static uplift of the contact wire under a force, where it acts, for each N of it, m/N; by place in m.

    Droppers slacken under the force: it is no linear measure. Raises FmuError as at_rest.
    """
    told = {**parameters, "travel": parse(catenary.variables["travel"], "Position")}
    found = []
    with catenary.instances() as (instance,):
        for place in places:
            instance.start(told, {"pantograph[1].position": place, "pantograph[1].force": force})
            found += instance.get(["pantograph[1].uplift"])
    return np.array(found) / force
