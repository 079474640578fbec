"""Figures that take seconds are drawn when the pages are built, by the scripts that make their tables.

Each script draws in a process of its own, so that its style stays with it, and again only after a change of the script
or of a table. ``.gitignore`` lists what is drawn.
"""

import subprocess
import sys
from pathlib import Path

from sphinx.errors import ExtensionError

DOCS = Path(__file__).parents[1]
#: Script in docs/scripts, whose function ``plot`` draws them -> figures, and tables of which they are drawn.
FIGURES = {
    "misprint": (("misprint",), ()),
    "reproduction": (("fig1_contact", "fig2_effective", "fig3_rollers"), ()),
    "film_error_map": (("film_error", "film_error_pressure"), ("film_error",)),
    "rollers_cost": (("rollers_cost",), ("rollers_cost",)),
}


def is_old(script):
    """Whether a figure of the script is not there, or older than what it is made of."""
    figures, tables = FIGURES[script]
    sources = [
        DOCS / "scripts" / f"{script}.py",
        *(DOCS / "tables" / f"{table}.csv" for table in tables),
    ]
    made = [DOCS / "figures" / f"{figure}.svg" for figure in figures]
    return not all(path.is_file() for path in made) or min(
        path.stat().st_mtime for path in made
    ) < max(path.stat().st_mtime for path in sources)


def draw(app):
    """Draw what is old, all scripts at once."""
    running = {
        script: subprocess.Popen(
            [sys.executable, "-c", f"import {script}; {script}.plot()"],
            cwd=DOCS / "scripts",
            stderr=subprocess.PIPE,
        )
        for script in FIGURES
        if is_old(script)
    }
    told = {script: process.communicate()[1].decode() for script, process in running.items()}
    if failed := [script for script, process in running.items() if process.returncode]:
        raise ExtensionError(f"docs/scripts/{failed[0]}.py draws no figure: {told[failed[0]]}")


def setup(app):
    app.connect("builder-inited", draw)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
