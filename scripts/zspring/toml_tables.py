"""TOML files: typed look-ups that name the key they fail on."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from .errors import ZSpringError, did_you_mean

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def read_toml(path: Path) -> tuple[str, Table]:
    """Text and content of a TOML file. Raises ZSpringError for one that is none."""
    try:
        text = path.read_text(encoding="utf-8")
        return text, Table(tomllib.loads(text), "")
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ZSpringError(f"{path}: no TOML: {error}") from None


class Table:
    """Typed look-ups in a TOML table. `finish` refuses keys that nobody has asked for."""

    def __init__(self, content: Any, name: str):
        self._prefix = f"{name}: " if name else ""
        if not isinstance(content, Mapping):
            raise ZSpringError(f"{self._prefix}must be a table")
        self.content = content
        self._asked: set[str] = set()

    def _get(self, key: str, default: Any, wanted: str, fits: Callable[[Any], bool]) -> Any:
        self._asked.add(key)
        if key not in self.content:
            if default is ...:
                raise ZSpringError(f"{self._prefix}{key} is missing")
            return default
        value = self.content[key]
        if isinstance(value, bool) or not fits(value):
            raise ZSpringError(f"{self._prefix}{key} = {value!r}: must be {wanted}")
        return value

    def text(self, key: str, default: Any = ...) -> str:
        return self._get(key, default, "a text", lambda value: isinstance(value, str))

    def choice(self, key: str, allowed: tuple[str, ...], default: str | None) -> str:
        wanted = " or ".join(f'"{item}"' for item in allowed)
        return self._get(key, ... if default is None else default, wanted, lambda value: value in allowed)

    def number(self, key: str, default: Any = ..., above: float = -math.inf, least: float = -math.inf) -> float:
        wanted = "a number" + (" above 0" if above == 0 else " of 0 or more" if least == 0 else "")
        value = self._get(key, default, wanted, lambda v: is_number(v) and v > above and v >= least)
        return value if value is None else float(value)

    def integer(self, key: str, default: int, least: int) -> int:
        wanted = f"a whole number of at least {least}"
        return self._get(key, default, wanted, lambda v: isinstance(v, int) and v >= least)

    def band(self, key: str) -> tuple[float, float]:
        def fits(value: Any) -> bool:
            return (
                isinstance(value, list) and len(value) == 2 and all(map(is_number, value)) and 0 <= value[0] < value[1]
            )

        low, high = self._get(key, [0.0, math.inf], "[lowest, highest] frequency in Hz", fits)
        return float(low), float(high)

    def table(self, key: str) -> Mapping[str, Any]:
        return self._get(key, {}, "a table", lambda value: isinstance(value, Mapping))

    def list(self, key: str) -> list:
        return self._get(key, [], f"tables [[{key}]]", lambda value: isinstance(value, list))

    def finish(self) -> None:
        """Raises ZSpringError for a key that no look-up asked for."""
        for key in self.content:
            if key not in self._asked:
                close = did_you_mean(key, self._asked)
                raise ZSpringError(f"{self._prefix}unknown key {key!r}{close}")


def flatten(table: Mapping[str, Any], is_leaf: Callable[[Any], bool]) -> dict[str, Any]:
    """By full name: TOML reads the key zspring.k without quotes as k within zspring."""
    flat = {}
    for name, item in table.items():
        if isinstance(item, Mapping) and not is_leaf(item):
            flat.update({f"{name}.{rest}": leaf for rest, leaf in flatten(item, is_leaf).items()})
        else:
            flat[name] = item
    return flat


def is_plain(item: Any) -> bool:
    return not isinstance(item, Mapping)


def has_table(item: Any) -> bool:
    return isinstance(item, Mapping) and any(isinstance(value, Mapping) for value in item.values())


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)
