"""Where the release is, for which platforms, and the tools its tests need."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

sys.path += [str(Path(__file__).parents[1] / "helpers"), str(Path(__file__).parents[2] / "scripts" / "tooling")]
from paths import ROOT as ROOT
from release import PLATFORMS as PLATFORMS

DIST = ROOT / "dist"

# What must be on this machine, and how it gets there.
INSTALL = {
    "c++": "apt install g++",
    "cargo": "install Rust from rustup.rs",
    "clang++": "apt install clang libclang-rt-dev",
    "java": "apt install default-jre",
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
