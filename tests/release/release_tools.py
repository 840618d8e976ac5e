"""Where the release is, for which platforms, and the tools its tests need."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

sys.path += [str(Path(__file__).parents[1] / "helpers"), str(Path(__file__).parents[2] / "scripts" / "tooling")]
from paths import ROOT as ROOT
from release import PLATFORMS as PLATFORMS

DIST = ROOT / "dist"
TOOLS = ROOT / "build" / "clients"  # kept from one run to the next

# What must be on this machine, and how it gets there.
INSTALL = {
    "c++": "apt install g++",
    "cargo": "install Rust from rustup.rs",
    "clang++": "apt install clang libclang-rt-dev",
    "firefox": "apt install firefox-esr",
    "java": "apt install default-jre",
    "javac": "apt install default-jdk",
    "mvn": "apt install maven",
    "qemu-aarch64": "apt install qemu-user libc6-arm64-cross",
    "strace": "apt install strace",
    "valgrind": "apt install valgrind",
    "wine": "apt install wine64 wine",
}


def missing() -> list[str]:
    """A line for each program that is not there."""
    return [f"{name} is missing: {install}" for name, install in INSTALL.items() if shutil.which(name) is None]


def tool(name: str) -> str:
    """Path of a program of INSTALL."""
    path = shutil.which(name)
    if path is None:
        pytest.fail(f"{name} is missing: {INSTALL[name]}", pytrace=False)
    return path


def run_tool(*command: str | Path, folder: Path | None = None) -> str:
    """Output of a command."""
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout
    return done.stdout


def fetch_jars(folder: Path, jars: Iterable[tuple[str, str, str]], *options: str) -> Path:
    """The folder, with these jars by group, name and version and with what they need; fetched with Maven once.

    options     of its goal dependency:copy-dependencies
    """
    complete = folder / "complete"
    if not complete.exists():
        folder.mkdir(parents=True, exist_ok=True)
        dependencies = "".join(
            f"<dependency><groupId>{group}</groupId><artifactId>{name}</artifactId>"
            f"<version>{version}</version></dependency>"
            for group, name, version in jars
        )
        (folder / "pom.xml").write_text(
            '<project xmlns="http://maven.apache.org/POM/4.0.0"><modelVersion>4.0.0</modelVersion>'
            "<groupId>zspring</groupId><artifactId>clients</artifactId><version>1</version>"
            f"<dependencies>{dependencies}</dependencies></project>"
        )
        copy = ("dependency:copy-dependencies", f"-DoutputDirectory={folder}", *options)
        run_tool(tool("mvn"), "-q", "-B", *copy, folder=folder)
        complete.touch()
    return folder
