"""The native program tests/native/fuzz on the library of an FMU: sequences of FMI calls, each judged."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence

from paths import TESTS
from probe import probe_folder
from zspring.fmu import Fmu, installed_fmu

CORPUS = sorted((TESTS / "native" / "corpus").iterdir())
SEARCH_PATH = {"win32": "PATH", "darwin": "DYLD_LIBRARY_PATH"}.get(sys.platform, "LD_LIBRARY_PATH")


def fuzz(model: str, *arguments: object, under: Sequence[str] = ()) -> dict[str, int]:
    """What was done: calls, refused, steps, discarded, states, foreign, replays, situations.

    under   a program to run it under, with its options
    """
    command = [*under, str(probe_folder() / f"fuzz_{model}"), *map(str, arguments)]
    with Fmu(installed_fmu(model)) as fmu:
        path = os.pathsep.join(filter(None, [str(fmu.binary.parent), os.environ.get(SEARCH_PATH)]))
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, SEARCH_PATH: path})
    assert done.returncode == 0, done.stderr[-2000:]
    return {name: int(count) for name, count in re.findall(r"(\w+) (\d+)", done.stdout)}
