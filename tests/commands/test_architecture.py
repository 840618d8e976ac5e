"""The layout that CONTRIBUTING.md describes: its places exist, and imports go down it only."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from paths import ROOT, SCRIPTS
from zspring.cli import RESEARCH, commands, research_command
from zspring.errors import ZSpringError

PACKAGE = SCRIPTS / "zspring"
SHARED = {"bench", "line", "line_file"}
NAMES = {"line_file": "line"}  # of commands whose folder has another one
COMMANDS = {path.parent.name for path in PACKAGE.glob("*/command.py")} | {"info", "export"}
FOLDERS = [ROOT, PACKAGE, ROOT / "tests", ROOT / "fmu_src", *(ROOT / "fmu_src").glob("*/")]
PYTHON = [path for folder in ("scripts", "fmu_src", "tests") for path in (ROOT / folder).rglob("*.py")]


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(SCRIPTS).with_suffix("").parts).removesuffix(".__init__")


def imports(path: Path) -> Iterator[str]:
    """Modules of the package that a module imports, at its head or within functions."""
    package = module_name(path).split(".")[: None if path.name == "__init__.py" else -1]
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = [*package[: len(package) + 1 - node.level], *([node.module] if node.module else [])]
            module = ".".join(base if node.level else [node.module or ""])
            for name in node.names:
                inner = f"{module}.{name.name}"
                yield inner if inner in MODULES else module
        elif isinstance(node, ast.Import):
            yield from (name.name for name in node.names)


MODULES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}
GRAPH = {name: {found for found in imports(path) if found in MODULES} for name, path in MODULES.items()}


def part(module: str) -> str:
    """The folder or module right below the package."""
    return module.split(".")[1] if "." in module else ""


def test_there_is_no_circle_of_imports():
    assert len(GRAPH) > 80
    TopologicalSorter({name: needed - {"zspring"} for name, needed in GRAPH.items()}).prepare()


@pytest.mark.parametrize("module", ["cli", "couple.run", "line.run", "en50318.workers"])
def test_slow_libraries_wait_until_they_are_needed(module):
    """Half a second each, of a command whose run takes a fraction of that, and of each of its processes."""
    slow = ["scipy.signal", "matplotlib", "pint"]
    told = f"import sys, zspring.{module}; print([name for name in {slow} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", told], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("module", sorted(GRAPH))
def test_imports_go_down_only(module):
    """From the command line to commands, from these to what they share, and never back or across."""
    here, below = part(module), {part(name) for name in GRAPH[module]} - {""}
    if here in ("cli", "__main__"):
        return
    allowed = {here} | (SHARED if here in COMMANDS else set())
    others = (below & (COMMANDS | SHARED | {"cli"})) - allowed
    assert not others, f"{module} imports {others}"
    if module.endswith(".plot"):
        assert not below & {"fmu", "records"}, "a plot draws what others made"


def test_every_command_is_in_the_command_line_and_on_a_page():
    pages = "".join(
        page.read_text("utf-8")
        for page in (ROOT / "README.md", SCRIPTS / "research/README.md", *(ROOT / "docs").glob("*.md"))
    )
    known = set(commands.commands)
    assert {NAMES.get(name, name) for name in COMMANDS} | set(RESEARCH) == known
    assert {path.parent.name for path in (SCRIPTS / "research").rglob("command.py")} == set(RESEARCH)
    for name in known:
        shows = rf"scripts/{name}" if name in ("en50318", "explore") else rf"^\$ (zspring |scripts/){name}\b"
        assert re.search(shows, pages, re.MULTILINE), f"{name}: no page shows it with its output"
        assert commands.commands[name].get_short_help_str(), name


def test_the_core_knows_no_fmi():
    for folder in ("pantograph", "catenary", "common"):
        for path in (ROOT / "fmu_src" / folder).glob("*.?pp"):
            assert not re.search(r"fmi2[A-Z]|#include .*fmi", path.read_text("utf-8")), path


def test_what_is_written_is_alike_on_every_system():
    """Text goes out with its encoding and ends of lines told, as Windows has others."""
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            modes = {argument.value for argument in node.args if isinstance(argument, ast.Constant)}
            told = {keyword.arg for keyword in node.keywords}
            if name == "write_text" or (name == "open" and modes & {"w", "a", "x"}):
                assert {"newline"} <= told and ("encoding" in told or "utf-8" in modes), f"{path}:{node.lineno}"


def test_no_file_is_too_long_to_read():
    lengths = {path: len(path.read_text("utf-8").splitlines()) for path in PYTHON}
    assert not {path.name: count for path, count in lengths.items() if count > 300 and "tests" not in path.parts}


def test_the_places_that_contributing_names_exist():
    """Names in code style that look like files, in one of the folders that the page speaks of."""
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    names = {name for name in re.findall(r"`([^`\s]+)`", text) if re.search(r"\.(py|[ch]pp|xml|md|\*)$|/", name)}
    assert len(names) > 30
    for name in names - {"scripts/zspring/NAME", "scripts/zspring/NAME/command.py"}:
        own = [*FOLDERS, *PACKAGE.glob("*/")]
        assert any(any(folder.glob(name)) for folder in own), name


def test_a_research_command_that_is_not_installed_tells_how_to(monkeypatch):
    monkeypatch.setattr("zspring.cli.entry_points", lambda **_: ())
    command = research_command("newton")
    with pytest.raises(ZSpringError, match=r"^newton is not installed: in the clone, pip install \./scripts/research$"):
        command.main(["--amplitudes", "1,4", "--quick"], standalone_mode=False)
