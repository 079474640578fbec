"""Makes a module for a package of a file whose functions `rollslip.model` offers: each function becomes a class.

- The file is run once, to know what its decorators say; what it offers meanwhile is taken back.
- The text stays the author's: functions lose their decorator, and imports stand at the top with those of the classes.
- What would run whenever the package is imported is refused, but for a block under ``if __name__ == "__main__"``, which
  is left out.
"""

import ast
import inspect
import json
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

import attrs

from rollslip.catalogue.discovery import taken_back
from rollslip.catalogue.kinds import get_kind
from rollslip.errors import in_words
from rollslip.fields import FieldError
from rollslip.models import FINITE, NON_NEGATIVE, POSITIVE

__all__ = ["LawFile", "class_name", "read_law_file"]

_LIMITS: Final = {FINITE: "FINITE", POSITIVE: "POSITIVE", NON_NEGATIVE: "NON_NEGATIVE"}
_Function = ast.FunctionDef


@attrs.frozen
class LawFile:
    """What a file offers, as a package has it: the kind, its classes by the names of models, and the module."""

    kind: str
    classes: Mapping[str, str]
    module: str


def read_law_file(path: Path) -> LawFile:
    """Return the classes that the functions of a file become, and the module that holds them."""

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
    laws = {node.name: call for node in tree.body if isinstance(node, _Function) and (call := _offering(node))}
    if not laws:
        raise refused(': offers nothing; put @rollslip.model("traction", "my-law", reads=...) above a function')
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
    if len(kinds) != 1:
        raise refused(f": offers models of kinds {' and '.join(kinds)}; make a file and a package of each")
    functions = {node.name: node for node in tree.body if isinstance(node, _Function)}
    models = {cls.__name__: cls for cls in offered.values() if cls.__name__ in laws}
    classes = {cls.name: class_name(cls.name) for cls in models.values()}
    taken = {name for node in tree.body for name in _bound(node)}
    if twice := sorted(taken & set(classes.values())):
        raise refused(f": has a {twice[0]} of its own, as the class of a model will be called; rename it")
    written = [_class(cls, classes[cls.name], functions[name], laws[name], text) for name, cls in models.items()]
    (kind,) = kinds
    return LawFile(kind, classes, _module(text, tree, kind, written, classes))


def class_name(model: str) -> str:
    """Return what the class of a model is called."""
    return "".join(word.capitalize() for word in model.replace("_", "-").split("-"))


def _offering(function: ast.FunctionDef) -> ast.Call | None:
    """Return the decorator of a function that offers it."""
    for one in function.decorator_list:
        if isinstance(one, ast.Call) and ast.unparse(one.func).rpartition(".")[2] == "model":
            return one
    return None


def _bound(node: ast.stmt) -> set[str]:
    """Return the names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    if isinstance(node, ast.Import | ast.ImportFrom):
        return {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
    return {one.id for one in ast.walk(node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}


# The class of a function ----------------------------------------------------------------------------------------------


def _class(cls: Any, name: str, function: ast.FunctionDef, call: ast.Call, text: str) -> str:
    """Write the class of a function out."""
    said = {one.arg: one.value for one in call.keywords if one.arg}
    kind_base = cls.__mro__[1].__name__
    doc = inspect.cleandoc(ast.get_docstring(function) or f"{cls.equation}.").splitlines()
    lines = [
        "@attrs.frozen(kw_only=True)",
        f"class {name}({kind_base}):",
        f'    """{doc[0]}' + ('"""' if len(doc) == 1 else ""),
        *(f"    {line}".rstrip() for line in doc[1:]),
        *(['    """'] if len(doc) > 1 else []),
        "",
        f"    name: ClassVar[str] = {_quoted(cls.name)}",
        f"    equation: ClassVar[str] = {_quoted(cls.equation)}",
        f"    references: ClassVar = {_tuple(said.get('references'), text)}",
        *(['    location: ClassVar[str] = "not stated"'] if hasattr(cls, "location") else []),
        "    domain = MappingProxyType(",
        "        {",
        *(f"            {_quoted(member)}: {_limits(of)}," for member, of in cls.domain.items()),
        "        }",
        "    )",
        "    reads = frozenset(domain)",
    ]
    fields = {one.name: one.type for one in attrs.fields(cls)}
    if fields:
        lines.append("")
    for parameter, kind in fields.items():
        shown = kind.__name__ if isinstance(kind, type) else str(kind)
        lines.append(f"    {parameter}: {shown} = {_declared(said['parameters'], parameter, text)}")
    column = "film_thickness" if cls.__mro__[1].__name__ == "FilmModel" else "friction"
    arguments = ", ".join(("slices", *(f"{one}=self.{one}" for one in fields)))
    filled = f"slices.{column}[...] = " if _returns(function) else ""  # else the function fills the column itself
    lines += [
        "",
        "    def evaluate(self, slices: Slices) -> None:",
        f'        """Fill the {column.replace("_", " ").replace("friction", "traction coefficient")}."""',
        f"        {filled}{function.name}({arguments})",
    ]
    return "\n".join(lines)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _limits(of: tuple[float, float]) -> str:
    return _LIMITS.get(of, repr(of))


def _tuple(value: ast.expr | None, text: str) -> str:
    """Write what a decorator gives for several as a tuple."""
    if value is None:
        return "()"
    segment = ast.get_source_segment(text, value) or ast.unparse(value)
    return segment if isinstance(value, ast.Tuple) and segment.startswith("(") else f"tuple({segment})"


def _declared(parameters: ast.expr, name: str, text: str) -> str:
    """Write how a parameter is declared."""
    if isinstance(parameters, ast.Dict):
        for key, value in zip(parameters.keys, parameters.values, strict=True):
            if isinstance(key, ast.Constant) and key.value == name:
                return ast.get_source_segment(text, value) or ast.unparse(value)
    return f"{ast.unparse(parameters)}[{_quoted(name)}]"


def _returns(function: ast.FunctionDef) -> bool:
    return any(isinstance(node, ast.Return) and node.value is not None for node in ast.walk(function))


# The module -----------------------------------------------------------------------------------------------------------


def _module(text: str, tree: ast.Module, kind: str, written: list[str], classes: Mapping[str, str]) -> str:
    """Put the module together: docstring, imports, what the file defines, the classes, and their hook."""
    base, hook = get_kind(kind).base.__name__, get_kind(kind).hook
    first = 1 if ast.get_docstring(tree) is not None else 0
    imports = first
    while imports < len(tree.body) and isinstance(tree.body[imports], ast.Import | ast.ImportFrom):
        imports += 1
    lines, dropped = text.splitlines(), set[int]()
    dropped.update(range(tree.body[imports - 1].end_lineno or 0) if imports else ())
    for node in tree.body:
        if isinstance(node, _Function) and (call := _offering(node)):
            dropped.update(range(call.lineno - 1, call.end_lineno or call.lineno))
        elif isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
            dropped.update(range(node.lineno - 1, node.end_lineno or node.lineno))
    kept = "\n".join(line for number, line in enumerate(lines) if number not in dropped).strip("\n")
    body = "\n\n\n".join([*filter(None, [kept]), *written])
    hooked = [
        "@hookimpl",
        f"def {hook}() -> list[type[{base}]]:",
        '    """Offer the models."""',
        f"    return [{', '.join(classes.values())}]",
    ]
    constants = [name for name in _LIMITS.values() if f": {name}," in body]
    ours = ast.parse(
        "from types import MappingProxyType\nfrom typing import ClassVar\nimport attrs\nfrom rollslip import Slices\n"
        f"from rollslip.hookspecs import hookimpl\nfrom rollslip.models import {', '.join([*constants, base])}\n"
    )
    used = {node.id for node in ast.walk(ast.parse(body)) if isinstance(node, ast.Name)}
    given = [one for one in tree.body[first:imports] if isinstance(one, ast.Import | ast.ImportFrom)]
    added = [one for one in ours.body if isinstance(one, ast.Import | ast.ImportFrom)]
    doc = ast.get_docstring(tree, clean=False) if first else f"The {kind} models of a file, as classes."
    imported = _imports([*given, *added], used | {name for node in added for name in _bound(node)})
    defines = body.startswith(("def ", "class ", "@"))
    return "\n".join([f'"""{doc}"""', "", *imported, *[""] * (1 + defines), body, "", "", *hooked, ""])


def _imports(nodes: Iterable[ast.Import | ast.ImportFrom], used: set[str]) -> list[str]:
    """Write imports as is usual: the language's, the standard library's, others; without what nothing uses."""
    plain, names = set[tuple[str, str]](), dict[str, set[str]]()
    for node in nodes:
        for alias in node.names:
            called = (alias.asname or alias.name).partition(".")[0]
            shown = alias.name + (f" as {alias.asname}" if alias.asname else "")
            if isinstance(node, ast.Import):
                if called in used:
                    plain.add((alias.name, shown))
            elif called in used or node.module == "__future__" or alias.name == "*":
                names.setdefault("." * node.level + (node.module or ""), set()).add(shown)

    def section(module: str) -> int:
        root = module.partition(".")[0]
        return 0 if root == "__future__" else 1 if root in sys.stdlib_module_names else 2

    found: list[str] = []
    for number in range(3):
        lines = [f"import {shown}" for module, shown in sorted(plain) if section(module) == number]
        lines += [
            f"from {module} import {', '.join(sorted(of, key=lambda one: (not one.isupper(), one)))}"
            for module, of in sorted(names.items())
            if section(module) == number
        ]
        found += ([""] if found and lines else []) + lines
    return found
