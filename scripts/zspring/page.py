"""A report as HTML: chapters of text, tables and figures in one file that needs nothing else.

Figures are embedded as SVG. The page has no script, and its content security policy lets a browser load
nothing from outside.
"""

from __future__ import annotations

import base64
import html
import importlib.resources
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import jinja2
from matplotlib.figure import Figure

from .figures import save
from .records import keep_others
from .tables import replaced

GOOD, BAD, WORDS = "good", "bad", "words"


@dataclass(frozen=True)
class Cell:
    """Text of a table's cell and how it is set: GOOD, BAD, WORDS or as a number."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class Table:
    """Rows of texts or Cells; the first of each row is its head."""

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str | Cell]]

    @property
    def is_words(self) -> bool:
        """Whether the last column is of words, which are set to the left."""
        return bool(self.rows) and self.cells[0][-1].look == WORDS

    @property
    def cells(self) -> list[list[Cell]]:
        return [[cell if isinstance(cell, Cell) else Cell(cell) for cell in row] for row in self.rows]


@dataclass(frozen=True)
class Lines:
    """Lines as a terminal shows them."""

    lines: Sequence[str]


@dataclass(frozen=True)
class Picture:
    """A figure, its caption, and the file it is written to beside the report."""

    figure: Figure
    caption: str
    file: str

    @property
    def source(self) -> str:
        """As a data URI."""
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="svg", metadata={"Date": None})
        return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


@dataclass
class Chapter:
    """A heading and what follows it, in order; texts are paragraphs."""

    title: str
    blocks: list[str | Table | Lines | Picture] = field(default_factory=list)

    def kinds(self) -> list[tuple[str, str | Table | Lines | Picture]]:
        """Blocks with their kind, for the template."""
        names = {str: "text", Table: "table", Lines: "lines", Picture: "picture"}
        return [(names[type(block)], block) for block in self.blocks]


def keep_other_reports(path: Path, settings: Mapping[str, str]) -> None:
    """To call before the work for a report. Raises ZSpringError where one of other settings is there."""
    if path.exists():
        found = re.search(r'<meta name="settings" content="(.*)">', path.read_text(encoding="utf-8", errors="replace"))
        keep_others(path, settings, json.loads(html.unescape(found[1])) if found else {})


def write_page(path: Path, title: str, chapters: Sequence[Chapter], settings: Mapping[str, str]) -> Path:
    """Write the page alone. `settings` tells reports apart."""
    template = importlib.resources.files(__package__).joinpath("page.html").read_text(encoding="utf-8")
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    page = environment.from_string(template).render(title=title, chapters=chapters, settings=json.dumps(settings))
    with replaced(path) as unfinished:
        unfinished.write_text(page, encoding="utf-8", newline="\n")
    return path


def write_report(path: Path, title: str, chapters: Sequence[Chapter], settings: Mapping[str, str]) -> list[Path]:
    """Write the page, and its pictures as PNG beside it; all paths written."""
    write_page(path, title, chapters, settings)
    pictures = [block for chapter in chapters for block in chapter.blocks if isinstance(block, Picture)]
    for picture in pictures:
        save(picture.figure, path.parent / picture.file)
    return [path, *(path.parent / picture.file for picture in pictures)]
