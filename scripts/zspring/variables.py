"""The FMU's variables as its model description gives them: look up by name, read and write values as text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from fmpy.model_description import ScalarVariable

from .errors import ZSpringError, did_you_mean

Value = float | int | bool


class Variables:
    """Variables by name, in their order: those of a model description, for one."""

    def __init__(self, variables: Iterable[ScalarVariable]):
        self._by_name = {variable.name: variable for variable in variables}

    def __iter__(self) -> Iterator[ScalarVariable]:
        return iter(self._by_name.values())

    def __getitem__(self, name: str) -> ScalarVariable:
        """The variable of that name. Raises ZSpringError with the closest names."""
        if name not in self._by_name:
            raise ZSpringError(f"no variable {name!r} in the FMU{did_you_mean(name, self._by_name)}")
        return self._by_name[name]

    def names(self, *causalities: str) -> list[str]:
        """Names of the variables with one of these causalities."""
        return [variable.name for variable in self if variable.causality in causalities]

    def settable(self, name: str, kinds: Sequence[str] = ("parameter",)) -> ScalarVariable:
        """The parameter, or what else is among the kinds, of that name. Raises ZSpringError if it is none."""
        known = self.names(*kinds)
        if name not in known:
            what = " or ".join(kinds)
            if name in self._by_name:
                raise ZSpringError(f"{name} is not a {what} but {self._by_name[name].causality}")
            raise ZSpringError(f"no {what} {name!r} in the FMU{did_you_mean(name, known)}")
        return self._by_name[name]

    def parse_assignments(
        self, assignments: Iterable[str], but_not: Sequence[str] = (), kinds: Sequence[str] = ("parameter",)
    ) -> dict[str, Value]:
        """Parameter values from texts NAME=VALUE, VALUE a number or the name of an enumeration's item.

        kinds       of variables that can be set, "input" perhaps
        Bounds are left to the FMU. Raises ZSpringError for an unknown name, one that is in `but_not`, or a
        value of the wrong type.
        """
        values = {}
        for assignment in assignments:
            name, equals, text = (part.strip() for part in assignment.partition("="))
            if not equals:
                raise ZSpringError(f"{assignment!r}: must be NAME=VALUE, for example zspring.Mf=0.5")
            values[name] = parse(self.settable(name, kinds), text)
            if name in but_not:
                raise ZSpringError(f"{assignment}: the measurement itself sets {', '.join(but_not)}")
        return values

    def synthetic(self, values: Mapping[str, Value]) -> list[str]:
        """Those parameters whose value is the FMU's own and is, by its description, synthetic."""
        return [
            name
            for name, value in values.items()
            if "(synthetic)" in self[name].description and value == parse(self[name], self[name].start)
        ]


def parse(variable: ScalarVariable, text: str) -> Value:
    """A value of the variable's type. Raises ZSpringError with variable, text and what is allowed."""
    try:
        if variable.type == "Real":
            return float(text)
        if variable.type == "Integer":
            return int(text)
    except ValueError:
        allowed = "a number" if variable.type == "Real" else "a whole number"
        raise ZSpringError(f"{variable.name} = {text!r}: must be {allowed}") from None
    items = _items(variable)
    for name, value in items.items():
        if text.lower() in (name.lower(), str(value)):
            return value
    raise ZSpringError(f"{variable.name} = {text!r}: must be one of {', '.join(items)}")


def exact(number: float) -> str:
    """Shortest text that reads back as the same number."""
    return repr(float(number)).removesuffix(".0")


def exact_list(numbers: Iterable[float], unit: str) -> str:
    """Numbers as `exact` has them, and their unit."""
    return f"{' '.join(map(exact, numbers))} {unit}"


def text(variable: ScalarVariable, value: Value) -> str:
    """The value as `parse` reads it back: shortest exact number, or the name of the enumeration's item."""
    if variable.type in ("Real", "Integer"):
        return repr(value).removesuffix(".0")
    return next((name for name, item in _items(variable).items() if item == value), str(value))


def with_unit(variable: ScalarVariable, value: Value) -> str:
    """The value as `text` gives it, and its unit if it has one."""
    unit = "" if variable.unit in (None, "1") else f" {variable.unit}"
    return text(variable, value) + unit


def _items(variable: ScalarVariable) -> dict[str, int]:
    """Names and values that a Boolean or an enumeration can take."""
    if variable.type == "Boolean":
        return {"false": 0, "true": 1}
    return {item.name: int(item.value) for item in variable.declaredType.items}
