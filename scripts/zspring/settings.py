"""Settings in TOML files: pydantic checks them, and what it refuses is told in one line."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    Strict,
    ValidationError,
    ValidationInfo,
    WrapValidator,
    model_validator,
)

from .errors import ZSpringError, did_you_mean
from .parameter_sets import packaged_sets

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# What must be, by pydantic's type of error and in its terms.
ALLOWED = {
    "bool_type": "true or false",
    "dict_type": "a table",
    "finite_number": "a finite number",
    "float_type": "a number",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a {number} of at least {ge:g}",
    "int_type": "a whole number",
    "less_than_equal": "at most {le}",
    "list_type": "tables [[{key}]]",
    "literal_error": "{expected}",
    "model_type": "a table",
    "path_type": "a text",
    "string_type": "a text",
}


class Table(BaseModel):
    """A table of settings. Numbers are finite; a whole one may stand for any number, true and false may not."""

    refused: ClassVar[Mapping[str, str]] = {}  # keys that one could think of and that cannot be, with the reason

    # Other keys are let in, so that the table, which knows its own, can refuse them.
    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)

    @model_validator(mode="after")
    def _no_other_key(self) -> Table:
        for key in self.model_extra or ():
            if key in self.refused:
                raise ValueError(f"{key}: {self.refused[key]}")
            raise ValueError(f"unknown key {key!r}{did_you_mean(key, keys_of(type(self)))}")
        return self


_T = TypeVar("_T", bound=Table)


@contextmanager
def settings_of(path: Path, kind: type[_T], brackets: bool = False) -> Iterator[_T]:
    """The settings of a TOML file, for a block that may check them further.

    brackets    tell the file's tables as [table]
    Raises ZSpringError for what is no TOML, unknown, missing or out of range. It begins with the file and the key,
    one of the block with the file.
    """
    with named(f"{path}: "):
        try:
            settings = kind.model_validate(tomllib.loads(path.read_text(encoding="utf-8-sig")), context=path.parent)
        except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise ZSpringError(f"no TOML: {error}") from None
        except ValidationError as error:
            raise ZSpringError(_refusal(error, brackets)) from None
        yield settings


@contextmanager
def named(where: str) -> Iterator[None]:
    """Puts `where` before the ZSpringErrors of a block."""
    try:
        yield
    except ZSpringError as error:
        raise ZSpringError(f"{where}{error}") from None


def _refusal(refused: ValidationError, brackets: bool) -> str:
    """The first error: where, key, value and what is allowed, case 1: ranges.mean_force = 110: must be ..."""
    error = refused.errors()[0]
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    # An error of a table as a whole, or of one of its keys.
    is_whole = kind == "too_short" or (kind == "value_error" and isinstance(value, Mapping))
    names: list[str] = []
    for step in error["loc"]:  # a number counts the tables of the name before
        names += [f"{names.pop()} {step + 1}"] if isinstance(step, int) else [step]
    tables = 1 if len(names) < len(error["loc"]) else len(names) - (not is_whole)
    if brackets and tables:
        names[0], tables = f"[{names[0]}]", 1
    place = ": ".join(".".join(part) for part in (names[:tables], names[tables:]) if part).replace("]: ", "] ")
    if kind == "missing":
        return f"{place} is missing"
    if kind == "too_short":
        return f"{place}: needs at least one"
    message = str(context.get("error", error["msg"]))
    if kind in ALLOWED:
        number = "whole number" if isinstance(context.get("ge"), int) else "number"
        message = "must be " + ALLOWED[kind].format(key=names[-1], number=number, **context).replace("'", '"')
    if is_whole:
        return f"{place}: {message}" if place else message
    return f"{place} = {value!r}: {message}"


def keys_of(kind: type[Table]) -> list[str]:
    """The keys of a table as they stand in the file."""
    return [field.alias or name for name, field in kind.model_fields.items()]


def by_full_name(kind: type[Table] | None = None) -> BeforeValidator:
    """For a table of parameters: TOML reads the key zspring.k without quotes as k within zspring.

    kind    of tables that are values
    """
    own = set(keys_of(kind)) if kind else set()

    def is_value(item: Any) -> bool:
        return not isinstance(item, Mapping) or bool(own & item.keys()) or (kind is not None and not item)

    def flatten(table: Any) -> Any:
        if not isinstance(table, Mapping):
            return table
        flat: dict[str, Any] = {}
        for name, item in table.items():
            flat |= {name: item} if is_value(item) else {f"{name}.{rest}": x for rest, x in flatten(item).items()}
        return flat

    return BeforeValidator(flatten)


def fitting(message: str, fits: Callable[[Any], bool] = lambda value: True) -> WrapValidator:
    """For a value, often a list, that is refused as a whole with this message."""

    def validate(content: Any, validator: Callable[[Any], Any]) -> Any:
        try:
            value = validator(content)
        except ValidationError:
            raise ValueError(message) from None
        if not fits(value):
            raise ValueError(message)
        return value

    return WrapValidator(validate)


def set_name(kind: str) -> AfterValidator:
    """For a text: a set's name in the package, or else the path of a file beside the settings."""
    known = packaged_sets(kind)
    return AfterValidator(lambda name, info: name if not name or name in known else str(_beside(name, info)))


def _beside(path: Path | str, info: ValidationInfo) -> Path:
    """The path as seen from the folder of the settings."""
    if "\0" in str(path):
        raise ValueError("must be a path")
    return (info.context or Path()) / path


ALL_FREQUENCIES = (0.0, math.inf)
Pair = Annotated[tuple[float, float], Strict(False)]  # strictly, TOML's lists are no tuples, and its texts no paths
Band = Annotated[Pair, fitting("must be [lowest, highest] frequency in Hz", lambda band: 0 <= band[0] < band[1])]
BesidePath = Annotated[
    Path, Strict(False), AfterValidator(_beside), PlainSerializer(Path.as_posix, return_type=str, when_used="json")
]
Positive = Annotated[float, Field(gt=0)]
