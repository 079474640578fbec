"""Sphinx configuration.  A build needs the installed package and no network.

- Equations become MathML (`_ext/mathml.py`), which browsers draw by themselves: no JavaScript, nothing to download,
  neither when the pages are built nor when they are read, and no TeX installation as pictures of formulas would need.
- Tables of keys, models, commands and columns are made from the program (`_ext/from_program.py`).
- No intersphinx: its inventories are downloaded at build time.
"""

import importlib.metadata
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent / "tests" / "support")]  # what the layout promises stands there

project = "rollslip"
author = "The rollslip developers"
copyright = author
release = version = importlib.metadata.version("rollslip")

extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon", "from_program", "mathml"]
exclude_patterns = ["_build", "example-plugins"]
html_math_renderer = "mathml"
smartquotes = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

html_theme = "pydata_sphinx_theme"
html_title = f"rollslip {release}"
html_static_path = ["_static"]
html_css_files = ["rollslip.css"]
html_show_copyright = False
html_show_sourcelink = False
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": False,
    "footer_start": ["sphinx-version"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
}
html_sidebars = {"**": ["sidebar-nav-bs"], "index": []}
