"""What README and docs show is real: see helpers/pages.py. The page of scripts/research is the second suite's."""

from __future__ import annotations

import re

import pytest
from fmpy import read_model_description

from pages import blocks, check
from paths import ROOT
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

COMMANDS_OF = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [*COMMANDS_OF, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", ROOT / "scripts/research/README.md"]
each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.parent.name + "/" + page.stem)
RUN = [page for page in COMMANDS_OF if {"python", "console"} & dict(blocks(page)).keys()]


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_the_commands_run_and_print_what_the_page_shows(page, tmp_path):
    check(page, tmp_path)


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
    """Names with a dot or a bracket, in code style, of things that look like variables of the FMUs and no files."""
    descriptions = [read_model_description(installed_fmu(model)) for model in (PANTOGRAPH, CATENARY)]
    known = {v.name for description in descriptions for v in description.modelVariables}
    families = {re.split(r"[.\[]", name)[0] for name in known if "." in name}
    for page in COMMANDS_OF:
        for name in re.findall(r"`([a-z_]\w*(?:\[\d+\])?\.[\w.\[\]]+)`", page.read_text(encoding="utf-8")):
            if re.split(r"[.\[]", name)[0] in families and not name.endswith((".csv", ".table")):
                assert name in known, f"{page.name}: {name}"
