"""What README and docs show is real: their commands run, each page's in order and in one folder, and print what
they say.

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

import pytest
from fmpy import read_model_description

from paths import ROOT
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
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


RUN = [page for page in PAGES if {"python", "console"} & dict(blocks(page)).keys()]


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_the_commands_run_and_print_what_the_page_shows(page, tmp_path):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    environment = {**os.environ, "PATH": path, "MPLBACKEND": "Agg", "COLUMNS": "120"}

    def run(command: list[str] | str) -> list[str]:
        done = subprocess.run(
            command,
            shell=isinstance(command, str),
            cwd=tmp_path,
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


@each_page
def test_what_a_page_links_to_exists(page):
    """Files, and headings in them."""
    for target, heading in re.findall(r"\]\(([^)#]*)(?:#([^)]*))?\)", page.read_text(encoding="utf-8")):
        if "://" not in target:
            linked = page.parent / target if target else page
            assert linked.exists(), target
            if heading:
                headings = re.findall(r"^#+ (.*)$", linked.read_text(encoding="utf-8"), re.MULTILINE)
                assert heading in [re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings], heading


def test_every_variable_that_a_page_names_exists():
    """Names with a dot or a bracket, in code style, of things that look like variables of the FMUs."""
    descriptions = [read_model_description(installed_fmu(model)) for model in (PANTOGRAPH, CATENARY)]
    known = {v.name for description in descriptions for v in description.modelVariables}
    families = {re.split(r"[.\[]", name)[0] for name in known if "." in name}
    for page in PAGES:
        for name in re.findall(r"`([a-z_]\w*(?:\[\d+\])?\.[\w.\[\]]+)`", page.read_text(encoding="utf-8")):
            if re.split(r"[.\[]", name)[0] in families:
                assert name in known, f"{page.name}: {name}"
