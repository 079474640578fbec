"""The directive ``answers``: commands with what they answer, run when the pages are built.

Its content is a session: ``$ rollslip ...`` and below each command the lines that it has to answer, where ``...``
stands for anything. A page shows the whole answer. One that is not as expected is a warning of the build.
"""

import doctest
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

EXAMPLES = Path(__file__).parents[1] / "examples"
COMMAND = "import sys; from rollslip.cli import main; sys.argv[0] = 'rollslip'; main()"
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def session(text):
    """Return commands and what each has to answer."""
    return re.findall(r"^\$ rollslip (.*)\n?((?:(?!\$).*(?:\n|\Z))*)", text, re.MULTILINE)


def answer(arguments, folder):
    """Run a command, and return all that it prints."""
    environment = {**os.environ, "COLUMNS": "118", "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, *arguments],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        check=False,
    )
    return done.stdout


class Answers(SphinxDirective):
    has_content = True

    def run(self):
        lines = []
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "work"
            shutil.copytree(EXAMPLES, folder)
            for command, wanted in session("\n".join(self.content)):
                given = answer(shlex.split(command), folder)
                if not doctest.OutputChecker().check_output(wanted, given, FLAGS):
                    self.state.document.reporter.warning(
                        f"rollslip {command} answers:\n{given}", line=self.lineno
                    )
                lines += [f"$ rollslip {command}", *given.rstrip().splitlines()]
        text = "\n".join(lines)
        return [nodes.literal_block(text, text, language="console", classes=["answers"])]


def setup(app):
    app.add_directive("answers", Answers)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
