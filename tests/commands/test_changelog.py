"""One version for the package and both FMUs, and the changelog tells what it brings."""

from __future__ import annotations

import importlib.metadata
import re

import fmpy
import pytest

from paths import ROOT
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

CHANGELOG = ROOT / "CHANGELOG.md"
HEADING = re.compile(r"^## \[(\d+)\.(\d+)\.(\d+)\] - \d{4}-\d{2}-\d{2}$", re.MULTILINE)
KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}


@pytest.mark.parametrize("model", [PANTOGRAPH, CATENARY])
def test_one_version(model):
    description = fmpy.read_model_description(str(installed_fmu(model)))
    assert description.version == importlib.metadata.version("zspring")


def test_changelog():
    text = CHANGELOG.read_text("utf-8")
    versions = [tuple(map(int, version)) for version in HEADING.findall(text)]
    assert versions == sorted(set(versions), reverse=True)
    assert ".".join(map(str, versions[0])) == importlib.metadata.version("zspring")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert len(headings) - len(versions) == ("[Unreleased]" in headings)
    assert set(re.findall(r"^### (.*)$", text, re.MULTILINE)) <= KINDS


def test_the_citation_names_the_last_release():
    newest = re.search(r"^## \[(\d+\.\d+\.\d+)\] - (\S+)$", CHANGELOG.read_text("utf-8"), re.MULTILINE)
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert newest and f"\nversion: {newest[1]}\n" in citation and f'\ndate-released: "{newest[2]}"\n' in citation
