"""What a study can vary, all as variables.

Parameters of the pantograph by their names; with [couple] those of the line with `catenary.` before them, and what a
run is given, as `couple.speed`.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable
from typing import Any

from fmpy.model_description import Item, ScalarVariable, SimpleType

from ..bench.measure import BENCH_PARAMETERS
from ..errors import ZSpringError
from ..line.journey import MOST_PANTOGRAPHS
from ..variables import Value, Variables
from .coupled import CHOICES, COUPLE, IRREGULARITY, LINE

SET_BY_THE_RUN = ("travel", "exchange", "exchange.step")  # of the catenary
# Numbers that a run can be given: unit, smallest and largest value; limits that hang on others are left to the run.
NUMBERS: dict[str, tuple[str, str | None]] = {
    "speed": ("km/h", "0"),
    "spacing": ("m", "0"),
    "start": ("m", None),
    "stop": ("m", None),
    "uplift": ("N", None),
    "step": ("s", "0"),
}
# How a line may differ from its design: unit, largest value; the smallest is 0.
IRREGULARITIES: dict[str, tuple[str, str | None]] = {
    "dropper_length": ("m", "0.5"),
    "missing": ("1", "1"),
    "slack": ("1", "1"),
    "slack_by": ("m", "0.5"),
    "clamp_mass": ("1", "0.33"),
    "contact_tension": ("1", "0.3"),
    "messenger_tension": ("1", "0.3"),
    "contact_wire": ("m", "0.1"),
}
LINE_NUMBER = f"{IRREGULARITY}line"


def own_variable(name: str, kind: str = "Real", **fields: Any) -> ScalarVariable:
    """A variable that no FMU has."""
    return ScalarVariable(name=name, valueReference=0, type=kind, causality="parameter", **fields)


def choice_variable(name: str, items: Iterable[str]) -> ScalarVariable:
    """One with these texts as values 1, 2, ..."""
    named = [Item(name=item, value=str(i)) for i, item in enumerate(items, 1)]
    return own_variable(name, "Enumeration", declaredType=SimpleType(name=name, items=named))


def factors(pantograph: Variables, catenary: Variables | None) -> Variables:
    """All that can vary.

    catenary    None: a study without a line
    """
    if catenary is None:
        return pantograph
    line = []
    for variable in catenary:
        if not is_set_by_the_run(variable.name):
            line.append(copy.copy(variable))
            line[-1].name = LINE + variable.name
    run = [own_variable(COUPLE + name, unit=unit, min=least) for name, (unit, least) in NUMBERS.items()]
    run.append(own_variable(f"{COUPLE}pantographs", "Integer", min="1", max=str(MOST_PANTOGRAPHS)))
    run += [choice_variable(COUPLE + name, items) for name, items in CHOICES.items()]
    for name, (unit, most) in IRREGULARITIES.items():
        run.append(own_variable(IRREGULARITY + name, unit=unit, min="0", max=most))
    return Variables([*pantograph, *line, *run])


def is_set_by_the_run(name: str) -> bool:
    """Whether a variable of the catenary is none that a study sets."""
    return name in SET_BY_THE_RUN or name.startswith("pantograph[")


def run_keys() -> list[str]:
    """Keys of [couple] that can vary."""
    return [*NUMBERS, "pantographs", *CHOICES]


def value_of(variables: Variables, name: str, given: Any) -> Value:
    """A value of what a study can vary, within its bounds."""
    value = variables.parse_assignments([f"{name}={given}"], but_not=BENCH_PARAMETERS)[name]
    variable = variables[name]
    if variable.type in ("Real", "Integer"):
        shown = f"{name} = {given} {variable.unit or ''}".rstrip()
        if not math.isfinite(value):
            raise ZSpringError(f"{shown}: must be finite")
        if variable.min is not None and value < float(variable.min):
            raise ZSpringError(f"{shown}: must be at least {variable.min}")
        if variable.max is not None and value > float(variable.max):
            raise ZSpringError(f"{shown}: must be at most {variable.max}")
    return value
