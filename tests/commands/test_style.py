"""The clone's own files: form, doubtful code and types, by the tools that pyproject.toml sets up."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from paths import ROOT

CPP = [str(file) for folder in ("fmu_src", "tests/native") for file in sorted((ROOT / folder).rglob("*.[ch]pp"))]


def finds_nothing(program: str, *arguments: str) -> None:
    """Run a program of this environment in the clone; if it finds something, fail with its first lines."""
    path = shutil.which(program, path=str(Path(sys.executable).parent))
    assert path, f"{program} is not beside {sys.executable}"
    command = [path, *arguments]
    found = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
    assert found.returncode == 0, "\n".join([program, *found.stdout.splitlines()[:20]])


def test_lint():
    finds_nothing("ruff", "check", "--no-cache", "--output-format=concise")


def test_python_is_formatted():
    finds_nothing("ruff", "format", "--check", "--no-cache")


def test_cpp_is_formatted():
    finds_nothing("clang-format", "--dry-run", "--Werror", *CPP)


def test_types():
    finds_nothing("mypy", f"--cache-dir={ROOT / '.pytest_cache' / 'mypy'}")
