"""What counts of a line file: the values of its set, over these its own, and over those the exceptions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..errors import ZSpringError
from ..line_table import replaces
from ..variables import Value
from .schema import Dropper, Part

Values = dict[str, Any]


def by_table(of_set: Mapping[str, Value], others: dict[str, Value]) -> dict[str, Values]:
    """The values of a set by table and key of a line file; what has no place there goes to `others`."""
    own = {"line.span": ("span", "length"), "line.encumbrance": ("support", "encumbrance")}
    tables: dict[str, Values] = {}
    for name, value in of_set.items():
        table, _, key = name.partition(".")
        table, key = own.get(name, (table, key))
        if table in ("contact_wire", "messenger", "damping") or replaces(name):
            tables.setdefault(table, {})[key] = value
        else:
            others[name] = value
    dropper, span = tables.setdefault("dropper", {}), tables.setdefault("span", {})
    if "count" in dropper:
        numbers = range(1, dropper["count"] + 1)
        span["droppers"] = [dropper.get(f"position[{i}]", 0.0) for i in numbers]
        span["sag"] = [dropper.get(f"sag[{i}]", 0.0) for i in numbers]
    dropper.pop("stiffness" if dropper.get("EA", 0.0) > 0 else "EA", None)
    tables["dropper"] = {key: value for key, value in dropper.items() if key in Dropper.model_fields}
    return tables


def over(base: Mapping[str, Any], part: Part) -> Values:
    """What a part says, and of the rest what `base` does, but no other of its alternatives."""
    given = part.given
    choices = {key for group in part.alternatives for key in group}
    hidden = choices if choices & given.keys() else set()
    return {**{key: value for key, value in base.items() if key not in hidden}, **given}


def chosen_at(
    number: int, first: int, last: int, exceptions: Iterable[tuple[Sequence[int], Any]], table: str, key: str
) -> list[Any]:
    """The exceptions for a span or support. Raises ZSpringError for one that is not there, or told twice."""
    found, told = [], set[str]()
    for numbers, exception in exceptions:
        for other in numbers:
            if not first <= other <= last:
                raise ZSpringError(f"[[{table}]] {key} = {other}: must be in {first} .. {last}")
        if number in numbers:
            tells = [name for name in exception.given if name != key]
            for name in tells:
                if name in told:
                    raise ZSpringError(f"[[{table}]] {key} = {number}: {name} is told twice")
            told.update(tells)
            found.append(exception)
    return found


def needed(values: Mapping[str, Any], where: str, key: str) -> Any:
    if key not in values:
        raise ZSpringError(f"{where}: {key} is missing; give it, or name a set that has it: parameters = ...")
    return values[key]
