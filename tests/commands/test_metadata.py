"""What catalogues read of the project agrees with the project."""

from __future__ import annotations

import json
import re
import sys

import pytest
from fmpy import read_model_description

from paths import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

VERSION = read_model_description(str(ROOT / "modelDescription.xml"), validate=False).version
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
CITATION = (ROOT / "CITATION.cff").read_text("utf-8")
PAPER = (ROOT / "docs" / "publish" / "paper.md").read_text("utf-8")
TOOL_KEYS = "name license vendor description features platforms interfaces fmiVersions fmuExport fmuImport".split()


def test_all_tell_the_same_version_licence_and_authors():
    code = json.loads((ROOT / "codemeta.json").read_text("utf-8"))
    assert code["version"] == VERSION and f"\nversion: {VERSION}\n" in CITATION
    assert code["license"].endswith("/" + PROJECT["license"]) and f"\nlicense: {PROJECT['license']}\n" in CITATION
    assert code["name"] == PROJECT["name"] and f">= {PROJECT['requires-python'][2:]}" in code["softwareRequirements"][0]
    (author,) = (each["name"] for each in PROJECT["authors"])
    assert code["author"][0]["name"] == author
    assert f"name: {author}" in CITATION and f"name: {author}" in PAPER
    (keywords,) = re.findall(r"^keywords: \[(.*)\]$", CITATION, re.MULTILINE)
    assert code["keywords"] == keywords.split(", ")


def test_the_paper_has_what_the_journal_asks_for():
    """Sections, every reference known and used, and 250 to 1000 words."""
    head, text = PAPER.split("---\n", 2)[1:]
    for key in ("title", "tags", "authors", "affiliations", "date", "bibliography"):
        assert f"{key}:" in head
    assert {"Summary", "Statement of need", "References"} <= set(re.findall(r"^# (.*)$", text, re.MULTILINE))
    bibliography = (ROOT / "docs" / "publish" / "paper.bib").read_text("utf-8")
    assert set(re.findall(r"@(\w+)", text)) == set(re.findall(r"^@\w+\{(\w+),", bibliography, re.MULTILINE))
    assert 250 < len(text.split()) < 1000


def test_the_entry_for_the_list_of_fmi_tools_has_its_form():
    """Keys, values and rules for the description of fmi-standard.org's CONTRIBUTING.md."""
    (entry,) = json.loads((ROOT / "docs" / "publish" / "tools.json").read_text("utf-8"))
    assert list(entry) == TOOL_KEYS and entry["license"] == "osi"
    assert set(entry["platforms"]) <= {"macOS", "Linux", "Windows"} and entry["fmuExport"] == ["CS"]
    assert not entry["description"].endswith(".")


@pytest.mark.parametrize("page", ["README.md"])
def test_the_first_page_stays_short(page):
    assert len((ROOT / page).read_text("utf-8").split()) <= 900
