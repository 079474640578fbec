"""Sphinx configuration.  A build needs the installed package and no network.

- Equations become MathML (`_ext/mathml.py`), which browsers draw by themselves: no JavaScript, nothing to download,
  neither when the pages are built nor when they are read, and no TeX installation as pictures of formulas would need.
- Tables of keys, models, commands and columns are made from the program (`_ext/from_program.py`).
- Commands of examples are run, and what they answer is shown whole (`_ext/answers.py`).
- Figures that take seconds are drawn at each build (`_ext/drawn.py`), and not kept with the source.
- Each model has a page (`_ext/model_pages.py`), with what it gives beside what was measured, computed at each build.
- Source is shown beside the reference (viewcode), since it needs no address on the network.
- The gallery is made by sphinx-gallery: it runs the scripts of `questions/`, again only those that have changed, shows
  what they print and draw, and offers them for download. Nothing lighter that is well kept does that.
- No intersphinx: its inventories are downloaded at build time.
"""

import importlib.metadata
import sys
from pathlib import Path

from sphinx.ext.napoleon import NumpyDocstring

HERE = Path(__file__).parent
sys.path[:0] = [
    str(HERE / "_ext"),
    str(HERE.parent / "tests" / "support"),
]  # what the layout promises stands there

project = "rollslip"
author = "The rollslip developers"
copyright = author
release = version = importlib.metadata.version("rollslip")

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "answers",
    "drawn",
    "from_program",
    "mathml",
    "model_pages",
]
exclude_patterns = ["_build", "example-plugins", "questions", "gallery/**/*.ipynb"]
html_math_renderer = "mathml"
smartquotes = False

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
maximum_signature_line_length = 60
autosummary_generate_overwrite = True
suppress_warnings = ["ref.python"]  # several classes have an attribute called name
templates_path = ["_templates"]
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
# What is said of a field is prose: what stands before its first colon is no type.
NumpyDocstring._parse_attribute_docstring = NumpyDocstring._consume_to_end

sphinx_gallery_conf = {
    "examples_dirs": "questions",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "subsection_order": [
        f"questions/{topic}" for topic in ("motion", "bearing", "contact", "oil", "decisions")
    ],
    "reset_modules": ("pictures.reset",),
    "image_srcset": ["2x"],
    "capture_repr": (),  # what is printed is enough
    "abort_on_example_error": True,
    "reference_url": {"rollslip": None},
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 3600,
    "notebook_images": False,
}

#: What is copied of an example is what can be typed: neither prompts nor answers.
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "pydata_sphinx_theme"
html_title = f"rollslip {release}"
html_static_path = ["_static"]
html_css_files = ["rollslip.css"]
html_show_copyright = False
html_show_sourcelink = False
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": True,
    "header_links_before_dropdown": 7,
    "footer_start": ["sphinx-version"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "show_toc_level": 1,
}
html_sidebars = {"**": ["sidebar-nav-bs"], "index": []}
