"""Every sentence that the program can say, read from its source: in a result, in an error, on the screen.

``python tests/support/sentences.py`` writes them to ``docs/tables/sentences.csv``. A test holds that list up to date,
so that who adds or changes a sentence meets it there once more.
"""

import ast
import csv
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import attrs

ROOT = Path(__file__).parents[2]
LIST = ROOT / "docs" / "tables" / "sentences.csv"
SOURCES = (
    "framework/rollslip", "kernels/rollslip_kernels", "plugins/rollslip_plugins", "plugins/rollslip_studies",
    "plugins/rollslip_campaigns",
)  # fmt: skip
#: Templates of packages are files that their reader edits.
_SKIPPED = "templates"
#: Calls whose texts nobody reads: patterns and code.
_UNREAD = {
    "compile",
    "sub",
    "match",
    "fullmatch",
    "search",
    "findall",
    "startswith",
    "endswith",
    "removeprefix",
    "cast",
}
#: What is said by way of these is the meaning of a key, an option or a number.
_MEANING = re.compile(
    r"[a-z_]*(field|parameter|option|options|setting|submodel)|about|Output|from_scene|_column|own_unit|MappingProxyType"
)
#: What is said by way of these is a refusal.
_ERROR = re.compile(
    r"\w*(Error|Nonconformance|Inapplicable)|raise|says|refuse_unless|refuse_if|same|add_note|_fault|_Stuck|BrokenExecutor|fault"
)
_SOURCE = re.compile(r"references =|equation =|[A-Z0-9]+ =|Template")
#: A type, a query, a page or names of dimensions are no sentences.
_CODE = re.compile(
    r"\w\[\w.* \| |^\w+(\.\w+)* \| \w|^(select|insert|create|update|delete|pragma) |^<|^:root|^import "
    r"|^(?=.*_)[a-z_ ]+$"
)
_GAP = re.compile(r"\{.*?\}")


@attrs.frozen(order=True)
class Sentence:
    """A text of two words or more; its gaps stand in braces, as the code fills them.

    Attributes
    ----------
    module, where : str
        File, and class or function in it.
    kind : str
        error, meaning (of a key, an option, a number), source (equations, references), else told.
    text : str
        What is said.
    """

    module: str
    where: str
    kind: str
    text: str


def sentences(root: Path = ROOT) -> list[Sentence]:
    """Return all sentences, sorted; one that stands twice in a function is there once."""
    found = set[Sentence]()
    for source in SOURCES:
        for path in sorted((root / source).rglob("*")):
            module = path.relative_to((root / source).parent).as_posix()
            if path.suffix in (".py", ".pyx") and _SKIPPED not in path.parts:
                text = path.read_text(encoding="utf-8")
                found.update((of_python if path.suffix == ".py" else of_cython)(text, module))
    return sorted(found)


def is_prose(text: str) -> bool:
    """Whether a text reads as words, without what fills its gaps."""
    words = re.findall(r"[A-Za-z][a-z']*(?![\w(])", _GAP.sub(" ", text))
    return (
        len(words) >= 2
        and " " in text.strip()
        and any(len(word) > 2 for word in words)
        and not _CODE.search(text)
    )


def of_python(text: str, module: str) -> Iterator[Sentence]:
    """Yield the sentences of a module of Python."""
    yield from _below(ast.parse(text), module, "", "")


def _below(node: ast.AST, module: str, where: str, way: str) -> Iterator[Sentence]:
    """Yield the sentences below a node; one within the gap of another is part of that."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        where = f"{where}.{node.name}".removeprefix(".")
        way = ""
    elif isinstance(node, ast.Call):
        called = (
            node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        )
        if called in _UNREAD:
            return
        way = way if called in ("join", "append", "extend") else called
    elif isinstance(node, ast.Raise):
        way = "raise"
    elif isinstance(node, ast.Assign | ast.AnnAssign):
        way = f"{ast.unparse(node.targets[0] if isinstance(node, ast.Assign) else node.target)} ="
    if isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    ):
        if is_prose(said := _said(node)):
            yield Sentence(module, where, _kind(way), said)
        return
    types = [getattr(node, name, None) for name in ("annotation", "returns")]
    for child in ast.iter_child_nodes(node):
        docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
        if child not in types and not docstring:
            yield from _below(child, module, where, way)


def _kind(way: str) -> str:
    kinds = {"meaning": _MEANING, "error": _ERROR, "source": _SOURCE}
    return next((kind for kind, pattern in kinds.items() if pattern.fullmatch(way)), "told")


def _said(node: ast.expr) -> str:
    """A text on one line, with its gaps as they are written."""
    if isinstance(node, ast.Constant):
        return " ".join(str(node.value).split())
    parts = list[str]()
    assert isinstance(node, ast.JoinedStr)
    for part in node.values:
        if isinstance(part, ast.FormattedValue):
            how = f"!{chr(part.conversion)}" if part.conversion > 0 else ""
            parts.append(f"{{{ast.unparse(part.value)}{how}{':' if part.format_spec else ''}")
            parts.append(f"{_said(part.format_spec) if part.format_spec else ''}}}")
        else:
            parts.append(str(part.value) if isinstance(part, ast.Constant) else "")
    return " ".join("".join(parts).split())


def _tokens(text: str) -> Iterator[tokenize.TokenInfo]:
    """Yield the tokens of a text, an f-string as one: from Python 3.12 on it comes in pieces."""
    rows = text.splitlines(keepends=True)
    depth = 0
    begin = (0, 0)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        kind = tokenize.tok_name[token.type]
        if kind == "FSTRING_START":
            begin = begin if depth else token.start
            depth = depth + 1
        depth -= kind == "FSTRING_END"
        if kind == "FSTRING_END" and not depth:
            (first, left) = begin
            (last, right) = token.end
            whole = "".join(rows[first - 1 : last])[left : right - len(rows[last - 1]) or None]
            yield tokenize.TokenInfo(tokenize.STRING, whole, begin, token.end, token.line)
        elif not depth:
            yield token


def of_cython(text: str, module: str) -> Iterator[Sentence]:
    """Yield the sentences of a module of Cython, which has the words of Python but another grammar."""
    parts = list[str]()
    begins = True
    for token in _tokens(text):
        if token.type == tokenize.STRING:
            bare = token.string.lstrip("bBfFrRuU")
            parts.append("" if begins else bare.strip(bare[0]))
        elif token.type not in (tokenize.NL, tokenize.COMMENT):
            said = " ".join("".join(parts).split())
            if is_prose(said):
                yield Sentence(module, "", "error", said)
            parts = []
            begins = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)


def as_csv(found: list[Sentence]) -> str:
    """Return the list as it is stored."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in attrs.fields(Sentence)])
    writer.writerows(attrs.astuple(one) for one in found)
    return text.getvalue()


if __name__ == "__main__":
    LIST.write_text(as_csv(sentences()), encoding="utf-8")
