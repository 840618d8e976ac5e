"""The command `zspring explore`."""

from __future__ import annotations

import tempfile
import webbrowser
from pathlib import Path

import click

from ..errors import ZSpringError
from ..options import FILE, option
from ..tables import replaced


@click.command()
@option("--output", kind=FILE, metavar="FILE.html", help="Write the page there and do not open it.")
def explore(output) -> None:
    """Open an explorer of pantograph and line in the browser.

    One page that holds both FMUs as WebAssembly: the frequency response by amplitude while sliders move, static force,
    the run under the line, the map of slip. Parameter sets (SSV) and measured responses (CSV) can be dropped on it. It
    asks no server.
    """
    from .bundle import page

    text = page()
    if output:
        if output.suffix.lower() not in (".html", ".htm"):
            raise ZSpringError(f"--output {output}: must end in .html")
        with replaced(output) as unfinished:
            unfinished.write_text(text, "utf-8", newline="\n")
        click.echo(f"written: {output}")
        return
    path = Path(tempfile.mkdtemp(prefix="zspring-")) / "explorer.html"
    path.write_text(text, "utf-8", newline="\n")
    click.echo(f"opening: {path}")
    if not webbrowser.open(path.as_uri()):
        raise ZSpringError(f"found no browser: open {path}")
