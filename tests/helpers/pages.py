"""Pages whose commands run, each page's in order and in one folder, and print what they say.

Convention: in ```console blocks a line "$ command" (continued on lines "> ...") is run; its output
follows, where a line "..." stands for any lines. Blocks of ```python are run as a script; blocks of
```sh, for setting up and what needs a fresh clone, are not. `scripts/frf` is run as the `zspring frf`
that it starts.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
TIMING = re.compile(r"\d+(?:\.\d+)?(?= (?:s|ms|us|points/s|steps/s)\b)")


@dataclass
class Command:
    text: str
    output: list[str] = field(default_factory=list)


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and text of each fenced block."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def commands(text: str) -> list[Command]:
    found: list[Command] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append(Command(line[2:]))
        elif line.startswith("> ") and not found[-1].output:
            found[-1].text += "\n" + line[2:]
        elif line.strip():
            found[-1].output.append(line)
    return found


def same_line(expected: str, actual: str) -> bool:
    """Equal text, blanks apart; numbers equal to two units of the last digit shown; times may differ."""
    expected, actual = (TIMING.sub("#", " ".join(line.split())) for line in (expected, actual))
    if NUMBER.sub("#", expected) != NUMBER.sub("#", actual):
        return False
    for a, b in zip(NUMBER.findall(expected), NUMBER.findall(actual)):
        mantissa, _, exponent = a.partition("e")
        digit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])) if "." in a or exponent else 0.0
        if abs(float(a) - float(b)) > 2.001 * digit:
            return False
    return True


def matches(expected: list[str], actual: list[str]) -> bool:
    """Whether the lines agree, "..." for any number of them."""
    if not expected:
        return not actual
    if expected[0].strip() == "...":
        return any(matches(expected[1:], actual[i:]) for i in range(len(actual) + 1))
    return bool(actual) and same_line(expected[0], actual[0]) and matches(expected[1:], actual[1:])


def check(page: Path, folder: Path) -> None:
    """Run the page's commands in the folder. Raises AssertionError where they print something else."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    environment = {**os.environ, "PATH": path, "MPLBACKEND": "Agg", "COLUMNS": "120"}

    def run(command: list[str] | str) -> list[str]:
        done = subprocess.run(
            command,
            shell=isinstance(command, str),
            cwd=folder,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=120,
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}"
        return [line for line in done.stdout.splitlines() if line.strip()]

    for language, text in blocks(page):
        if language == "python":
            run([sys.executable, "-c", text])
        elif language == "console":
            for command in commands(text):
                actual = run(re.sub(r"^scripts/frf\b", "zspring frf", command.text))
                assert matches(command.output, actual), "\n".join([f"$ {command.text}", *actual])
