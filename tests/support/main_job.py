"""Count what a run enters of the product: modules whose functions run, and distinct statements.

``python tests/support/main_job.py [SCENE [STUDY]]`` prints both, with the statements of each module. Statements that
run while a module is imported do not count, and compiled code is not seen. Statements are counted rather than lines,
since the number of lines of a statement is a matter of format.
"""

import ast
import sys
from collections import defaultdict
from pathlib import Path

import rollslip

ROOTS = ("rollslip", "rollslip_plugins", "rollslip_studies", "rollslip_campaigns")
SCENE = "1032930-70C"
STUDY = "effective-friction"


class Tracer:
    """Notes the lines of the product that run, by file; it is a trace function of `sys.settrace`."""

    def __init__(self):
        self.lines = defaultdict(set)
        self._modules = {}

    def module(self, file):
        """Return the path of a file below its root; nothing for files of others."""
        if file not in self._modules:
            parts = Path(file).parts
            start = next((k for k in reversed(range(len(parts))) if parts[k] in ROOTS), None)
            self._modules[file] = "" if start is None else "/".join(parts[start:])
        return self._modules[file]

    def __call__(self, frame, event, _):
        """Follow the calls of functions of the product."""
        code = frame.f_code
        module = self.module(code.co_filename)
        if (
            event != "call"
            or not module
            or code.co_name == "<module>"
            or self._is_importing(frame.f_back)
        ):
            return None

        def note(inner, inner_event, _):
            if inner_event == "line":
                self.lines[code.co_filename].add(inner.f_lineno)
            return note

        self.lines[code.co_filename].add(frame.f_lineno)
        return note

    def _is_importing(self, frame):
        while frame is not None:
            if frame.f_code.co_name == "<module>" and self.module(frame.f_code.co_filename):
                return True
            frame = frame.f_back
        return False


def count_statements(file, lines):
    """Return the number of statements of a file that some lines belong to, each to the innermost one."""
    statement_of = {}
    for node in ast.walk(
        ast.parse(Path(file).read_text(encoding="utf-8"))
    ):  # outer statements first
        if isinstance(node, ast.stmt):
            statement_of |= dict.fromkeys(range(node.lineno, node.end_lineno + 1), node)
    return len({id(statement_of[line]) for line in lines if line in statement_of})


def entered(scene=SCENE, study=STUDY):
    """Return the number of statements that a second run of a study enters, by module."""
    rollslip.run(scene, study)  # imports
    tracer = Tracer()
    sys.settrace(tracer)
    try:
        rollslip.run(scene, study)
    finally:
        sys.settrace(None)
    return {
        tracer.module(file): count_statements(file, lines) for file, lines in tracer.lines.items()
    }


if __name__ == "__main__":
    found = entered(*sys.argv[1:])
    for name, count in sorted(found.items(), key=lambda each: -each[1]):
        print(f"{count:6}  {name}")
    print(f"{len(found)} modules, {sum(found.values())} statements")
