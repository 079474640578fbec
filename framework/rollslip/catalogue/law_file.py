"""Reads what a file offers whose functions stand under `rollslip.model`, so that it can be the module of a package.

- The file stays as it is: an entry point may name a module that offers by `rollslip.model` in place of a hook.
- It is run once, to know what its decorators say; what it offers meanwhile is taken back.
- What would run whenever the package is imported is refused, but for a block under ``if __name__ == "__main__"``.
"""

import ast
from collections.abc import Mapping
from pathlib import Path

import attrs

from rollslip.catalogue.discovery import taken_back
from rollslip.errors import in_words
from rollslip.fields import FieldError

__all__ = ["LawFile", "class_name", "read_law_file"]


@attrs.frozen
class LawFile:
    """What a file offers: the kind, what classes of tests are called after, by the names of models, and its text."""

    kind: str
    classes: Mapping[str, str]
    module: str


def read_law_file(path: Path) -> LawFile:
    """Return what a file offers."""

    def refused(reason: str) -> FieldError:
        return FieldError("from", f"{path}{reason}")

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise refused(f": cannot be read: {reason}") from None
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError) as error:
        raise refused(f":{getattr(error, 'lineno', None) or 1}: is not Python: {error.args[0]}") from None
    for node in tree.body:
        if isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant):
            raise refused(
                f":{node.lineno}: {ast.unparse(node)[:60]} would run whenever the package is imported; put it below "
                'if __name__ == "__main__":'
            )
    with taken_back() as offered:
        try:
            exec(compile(text, str(path), "exec"), {"__name__": path.stem, "__file__": str(path)})
        except Exception as error:
            raise refused(f": cannot be run: {in_words(error)}") from error
    kinds = sorted({kind for kind, _ in offered})
    if not kinds:
        raise refused(': offers nothing; put @rollslip.model("traction", "my-law", reads=...) above a function')
    if len(kinds) != 1:
        raise refused(f": offers models of kinds {' and '.join(kinds)}; make a file and a package of each")
    return LawFile(kinds[0], {name: class_name(name) for _, name in offered}, text)


def class_name(model: str) -> str:
    """Return what the class of a model is called."""
    return "".join(word.capitalize() for word in model.replace("_", "-").split("-"))
