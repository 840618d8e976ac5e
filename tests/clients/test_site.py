"""The documentation as a site: made without a warning, notebooks run, and opened from a folder."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from browsing import opener
from paths import ROOT

PARTS = """Start
I have a measured pantograph
I have a line simulator
I want the paper's results
Theory
Reference
Trust
Contributing""".splitlines()
LOADS = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src"}


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("site with spaces")
    sphinx = "-m sphinx --fail-on-warning --keep-going -c docs . -d".split()
    command = [sys.executable, *sphinx, folder / "doctrees", folder / "pages"]
    made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    return folder / "pages"


class Page(HTMLParser):
    """What a page loads by itself, its links, and texts of the navigation's captions."""

    def __init__(self, path: Path):
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.captions: list[str] = []
        self._in_caption = False
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag, attributes):
        told = dict(attributes)
        if tag in LOADS and told.get(LOADS[tag]) and told.get("rel") not in ("search", "next", "prev", "index"):
            self.loads.append(told[LOADS[tag]])
        if tag == "a":
            self.links.append(told.get("href") or "")
        self._in_caption = self._in_caption or told.get("class") == "caption"

    def handle_endtag(self, tag):
        self._in_caption = self._in_caption and tag != "p"

    def handle_data(self, data):
        if self._in_caption and data.strip():
            self.captions.append(data.strip().replace("\N{RIGHT SINGLE QUOTATION MARK}", "'"))


def test_nothing_comes_from_elsewhere_and_every_link_leads_somewhere(site):
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 30
    for path in pages:
        page = Page(path)
        for target in page.loads:
            assert "//" not in target or target.startswith("data:"), f"{path.name} loads {target}"
        for target in page.loads + page.links:
            file = target.partition("#")[0].partition("?")[0]
            if file and "//" not in target and not target.startswith(("data:", "mailto:")):
                assert (path.parent / file).exists(), f"{path.name}: {target}"


def test_the_order_is_by_what_people_came_for_and_every_page_has_a_place(site):
    front = Page(site / "README.html")
    assert front.captions[: len(PARTS)] == PARTS
    placed = {Path(link).stem for link in front.links}
    for page in [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "reference").iterdir()]:
        assert page.stem in placed, f"{page.name} is in no part of docs/_toc.yml"


def test_equations_are_drawn_notebooks_have_run_and_the_package_is_there(site):
    assert len(re.findall("<math", (site / "docs" / "theory.html").read_text("utf-8"))) > 30
    assert not re.search(r"\\frac|\\sqrt", (site / "docs" / "theory.html").read_text("utf-8"))
    for name, pictures in {"frequency_response": 3, "co_simulation": 1}.items():
        notebook = (site / "docs" / "notebooks" / f"{name}.html").read_text("utf-8")
        assert notebook.count("<img") >= pictures and "Traceback" not in notebook
    package = (site / "docs" / "reference" / "python.html").read_text("utf-8")
    for name in ("zspring.fmu.Fmu", "zspring.bench.measure.measure", "zspring.line.run.run_line"):
        assert f'id="{name}"' in package
    variables = (site / "docs" / "reference" / "variables.html").read_text("utf-8")
    assert "zspring.k_locked" in variables and "stitch_height" in variables


def test_a_browser_opens_it_from_its_folder_and_finds_words(site, tmp_path):
    browse = opener(tmp_path)
    for path, query in ((site / "docs" / "theory.html", ""), (site / "search.html", "?q=resolvent")):
        page = browse(path, query)
        assert page["errors"] == []
        assert all(request.startswith("file:") for request in page["requests"])
    assert "Theory: the pantograph" in page["links"] and "The explorer" not in page["links"]
