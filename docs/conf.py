"""How Sphinx makes the site (`scripts/docs`) of the pages of the clone, where they are; `_toc.yml` is their order."""

import logging
import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "site"))
os.environ.pop("MPLBACKEND", None)  # else Jupyter does not keep the notebooks' pictures
logging.getLogger("traitlets").setLevel(logging.ERROR)

project = "zspring"
author = copyright = "The zspring developers"
html_title = "Z-spring pantograph FMU"
extensions = [
    "myst_nb",
    "sphinx_click",
    "sphinx_external_toc",
    "sphinx_reredirects",
    "sphinx.ext.autodoc",
    *(path.stem for path in sorted((HERE / "site").glob("*.py"))),
]
include_patterns = ["*.md", "docs/**.md", "docs/**.rst", "docs/notebooks/*.py", "scripts/research/README.md"]
exclude_patterns = ["docs/publish/**"]
external_toc_path = "docs/_toc.yml"
redirects = {"index": "README.html"}

html_theme = "furo"
html_show_sourcelink = html_copy_source = False
html_show_search_summary = False  # would be fetched, which a page opened from a folder may not
html_static_path = ["site/static"]
html_css_files = ["site.css"]

myst_enable_extensions = ["amsmath", "dollarmath"]
myst_heading_anchors = 4
html_math_renderer = "mathml"

nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 120

default_role = "code"  # docstrings have single backticks
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
add_module_names = False
