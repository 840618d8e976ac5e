"""Where the release is, for which platforms, and the tools its tests need."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DIST = ROOT / "dist"

sys.path.append(str(ROOT / "scripts"))
from release import PLATFORMS as PLATFORMS


def tool(name: str, install: str) -> str:
    """Path of a program that must be on this machine; `install` says how it gets there."""
    path = shutil.which(name)
    if path is None:
        pytest.fail(f"{name} is missing: {install}", pytrace=False)
    return path
