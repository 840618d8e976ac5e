"""The one exception for everything a user can put right, and help with mistyped names."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path


class ZSpringError(Exception):
    """One line that says what is wrong, its value, and what is allowed."""


def tell(lines: Sequence[str], path: Path, most: int = 10) -> None:
    """Lines on standard error, if there are too many the first ones and where the rest is."""
    for line in lines[:most]:
        print(line, file=sys.stderr)
    if len(lines) > most:
        print(f"and {len(lines) - most} more, see {path}", file=sys.stderr)


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """ "; did you mean a or b?" for the closest known names, or an empty string."""
    by_lower = {other.lower(): other for other in known}
    close = difflib.get_close_matches(name.lower(), by_lower, n=2, cutoff=0.6)
    return f"; did you mean {' or '.join(by_lower[other] for other in close)}?" if close else ""


def missing_extra(packages: Iterable[str], extra: str) -> ZSpringError:
    """What to tell when packages of an extra of pyproject.toml are not installed.

    The command adds them to the environment that runs, without building the package again.
    """
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return ZSpringError(f'{", ".join(packages)} not installed: {python} -m pip install "zspring[{extra}]"')
