"""Equations as MathML, which browsers draw themselves: no script, no font, no request."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx


def write(display: str):
    def visit(translator: Any, node: nodes.Element) -> None:
        translator.body.append(convert(node.astext().strip(), display=display))
        raise nodes.SkipNode

    return visit, None


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", write("inline"), write("block"))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
