"""Docstrings and help for Sphinx: lines `name    what it is` become a list, blocks below a colon stay as they are."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

ITEM = re.compile(r"^(`?\w[\w.]*`?(?:, `?\w[\w.]*`?)*)\s{2,}(\S.*)$")
MARKUP = re.compile(r"`[^`]*`|\||_(?=\W|$)")  # what is in backticks is code; the rest would mean something to Sphinx


def escaped(line: str) -> str:
    return MARKUP.sub(lambda found: found[0] if found[0].startswith("`") else "\\" + found[0], line)


def as_fields(_app: Sphinx, _what: str, _name: str, _object: object, _options: object, lines: list[str]) -> None:
    """Lists become definition lists of reStructuredText, each item with its indented continuations; in place."""
    found: list[str] = []
    inside = literal = False
    for number, line in enumerate(lines):
        following = next((text for text in lines[number + 1 :] if text.strip()), "")
        literal = literal and (line.startswith("    ") or not line.strip())
        item = ITEM.match(line)
        if literal:
            found.append(line)
        elif item:
            names = ", ".join(f"``{name.strip(' `')}``" for name in item[1].split(","))
            found += [*([] if inside else [""]), names, "    " + escaped(item[2])]
            inside = True
        elif inside and line.startswith(" "):
            found.append("    " + escaped(line.strip()))
        else:
            literal = line.endswith(":") and following.startswith("    ")
            found += [*([""] if inside else []), escaped(line) + (":" if literal else "")]
            inside = False
    lines[:] = found


def escape_help(_app: Sphinx, _context: object, lines: list[str]) -> None:
    lines[:] = map(escaped, lines)


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("autodoc-process-docstring", as_fields)
    app.connect("sphinx-click-process-description", escape_help)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
