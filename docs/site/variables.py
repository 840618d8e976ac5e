"""The directive {model-variables}: a table of what `zspring info` tells of a model description of this clone."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy
from docutils import nodes
from fmpy.model_description import ScalarVariable
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from zspring.info import HEAD, row_of

NUMBER = re.compile(r"\[(\d+)\]")


def families(variables: list[ScalarVariable]) -> list[list[str]]:
    """Rows of all variables; members of an array that differ in their number alone are one row, first to last."""
    rows: dict[tuple[str, ...], list[str]] = {}
    for variable in variables:
        row = row_of(variable)
        key = tuple(NUMBER.sub("[]", cell) if i in (0, 5) else cell for i, cell in enumerate(row))
        rows[key] = [f"{rows[key][0].split(' ... ')[0]} ... {row[0]}", *rows[key][1:]] if key in rows else row
    return list(rows.values())


class ModelVariables(SphinxDirective):
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        path = Path(self.env.srcdir, self.arguments[0])
        self.env.note_dependency(str(path))
        description = fmpy.read_model_description(str(path), validate=False)
        group = nodes.tgroup(cols=len(HEAD))
        group += [nodes.colspec(colwidth=width) for width in (3, 2, 1, 1, 2, 5)]
        head, body = nodes.thead(), nodes.tbody()
        head += self.row(HEAD)
        body += [self.row(row) for row in families(description.modelVariables)]
        group += [head, body]
        table = nodes.table()
        table += group
        return [table]

    @staticmethod
    def row(texts) -> nodes.row:
        row = nodes.row()
        for column, text in enumerate(texts):
            entry = nodes.entry()
            entry += nodes.paragraph("", "", nodes.literal(text, text) if column == 0 else nodes.Text(text))
            row += entry
        return row


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("model-variables", ModelVariables)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
