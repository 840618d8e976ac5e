"""What the page of scripts/research shows is real; see helpers/pages.py."""

from __future__ import annotations

from pages import check
from paths import SCRIPTS


def test_the_commands_run_and_print_what_the_page_shows(tmp_path):
    check(SCRIPTS / "research" / "README.md", tmp_path)
