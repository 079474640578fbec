"""Measure the size and the legibility of the sources, and compare both with ``budgets.toml``.

``python tests/support/legibility.py`` prints the figures of each root. ``--worst N`` adds the N worst files of each
figure, ``--lower`` writes improved figures into ``budgets.toml``; it refuses if a figure is worse than its budget.

Size is counted in statements: docstrings, comments, blank lines and imports are free, and code that is packed into
fewer lines costs as much as before. The figures do not depend on the version of Python that computes them.
"""

import argparse
import ast
import io
import keyword
import re
import sys
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import attrs

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
BUDGETS = HERE / "budgets.toml"
#: The roots of Python code: name in tables and budgets -> folder.
ROOTS = {
    "framework": "framework/rollslip",
    "models": "plugins/rollslip_plugins",
    "studies": "plugins/rollslip_studies",
    "campaigns": "plugins/rollslip_campaigns",
    "tests": "tests",
}
#: The roots that users install. Their statements have one budget, so that code may move between them.
PRODUCT = ("framework", "models", "studies", "campaigns")
#: Suffixes of compiled sources that are written by hand. Type stubs repeat their signatures and are left out.
KERNEL_SUFFIXES = {".pyx", ".pxd", ".h", ".c"}
#: A function with this many branches is branchy: hardly anybody follows more paths than that at once.
BRANCHY = 15
#: A budget may exceed its figure by this fraction: not every small improvement has to be written down at once.
SLACK = 0.01
#: Files with fewer lines of code are not listed among the worst: a few tokens decide their figures.
SMALLEST_LISTED = 100

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
BRANCHES = (
    ast.If, ast.For, ast.While, ast.IfExp, ast.ExceptHandler, ast.BoolOp, ast.comprehension, ast.Match,
)  # fmt: skip
COUNTED_TOKENS = {tokenize.NAME, tokenize.OP, tokenize.NUMBER, tokenize.STRING}
#: Tokens that open and close a string with fields. Python 3.11 reads such a string as one token and has none of them.
STRING_OPENERS = {getattr(tokenize, name, None) for name in ("FSTRING_START", "TSTRING_START")} - {None}
STRING_CLOSERS = {getattr(tokenize, name, None) for name in ("FSTRING_END", "TSTRING_END")} - {None}


@attrs.frozen
class Figure:
    """A column of the table: a count, or a count divided by another one."""

    title: str
    count: str
    per: str = ""  # the count that it is divided by
    scale: int = 1
    digits: int = 0
    larger_is_better: bool = False

    def value(self, counts: Mapping[str, int]) -> float:
        """Return the figure of a file or a root, rounded as it is printed."""
        if not self.per:
            return counts[self.count]
        return round(self.scale * counts[self.count] / max(counts[self.per], 1), self.digits or None)

    def is_worse(self, value: float, limit: float) -> bool:
        """Return whether a value is on the wrong side of a limit."""
        return value < limit if self.larger_is_better else value > limit

    def is_loose(self, value: float, limit: float) -> bool:
        """Return whether a limit leaves more room than the slack, which is one unit of the last digit or more."""
        room = round(abs(limit - value), 6)
        return not self.is_worse(value, limit) and room > max(SLACK * abs(value), 10.0**-self.digits)


#: Name in ``budgets.toml`` -> figure.
FIGURES = {
    # see `count_statements`
    "statements": Figure("statements", "statements"),
    # of lines that hold code: pluggy has 6.2, attrs 5.1, SciPy's optimize 7.9
    "tokens_per_line": Figure("tokens/line", "tokens", per="code_lines", digits=1),
    # assignments `a, b = x, y` of all assignments
    "tuple_assignments": Figure("tuple %", "tuple_assignments", per="assignments", scale=100, digits=1),
    # statements of a module that define two or more constants
    "packed_constants": Figure("packed", "packed_constants"),
    # constants of a module that are numbers, without a comment in their line or above it
    "bare_constants": Figure("bare", "bare_constants"),
    # identifiers with a word of `private_words.txt`
    "private_words": Figure("private/1000", "private_identifiers", per="identifiers", scale=1000, digits=1),
    # public functions and methods of two or more parameters, promised by `__all__`, that describe all of these
    "described_parameters": Figure(
        "described %", "described_functions", per="promised_functions", scale=100, larger_is_better=True
    ),
    "branchy_functions": Figure("branchy", "branchy_functions"),
    # of compiled sources, without docstrings, comments and blank lines
    "kernel_lines": Figure("kernel lines", "kernel_lines"),
}
#: The figures of Python code.
COLUMNS = [name for name in FIGURES if name != "kernel_lines"]


def read_private_terms(path: Path = HERE / "private_words.txt") -> tuple[re.Pattern[str], re.Pattern[str]]:
    """Return a pattern of private words and a pattern of sequences that are fine, for words between spaces."""
    lines = [line.partition("#")[0].split() for line in path.read_text(encoding="utf-8").splitlines()]
    terms = [" ".join(line) for line in lines if line]
    private = [term for term in terms if not term.startswith("!")]
    fine = [term.removeprefix("! ") for term in terms if term.startswith("!")]
    return re.compile(rf" (?:{'|'.join(private)})(?= )"), re.compile(rf" (?:{'|'.join(fine)})(?= )")


PRIVATE, FINE = read_private_terms()


@cache
def is_private(identifier: str) -> bool:
    """Return whether an identifier contains a private word or a private sequence of words."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", identifier)
    return PRIVATE.search(FINE.sub(" |", f" {' '.join(parts)} ".lower())) is not None


def is_tuple_assignment(node: ast.AST) -> bool:
    """Return whether a statement has the form ``a, b = x, y``."""
    if not isinstance(node, ast.Assign):
        return False
    return isinstance(node.targets[0], ast.Tuple) and isinstance(node.value, ast.Tuple)


def count_statements(node: ast.AST) -> int:
    """Return the statements of a node without its children: ``a, b = x, y`` is two, ``x if c else y`` is two more."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        return 0
    if is_tuple_assignment(node):
        return len(node.targets[0].elts)
    if isinstance(node, ast.IfExp):
        return 2
    return int(isinstance(node, (ast.stmt, *COMPREHENSIONS)))


def docstrings(nodes: list[ast.AST]) -> list[ast.Expr]:
    """Return the docstrings of modules, classes and functions."""
    bodies = [node.body for node in nodes if isinstance(node, (ast.Module, ast.ClassDef, *FUNCTIONS))]
    return [
        body[0]
        for body in bodies
        if body
        and isinstance(body[0], ast.Expr)
        and isinstance(body[0].value, ast.Constant)
        and isinstance(body[0].value.value, str)
    ]


def is_branchy(function: ast.AST) -> bool:
    """Return whether a function, with the functions inside it, has too many branches."""
    return sum(isinstance(node, BRANCHES) for node in ast.walk(function)) >= BRANCHY


def promised_functions(module: ast.Module) -> Iterator[ast.FunctionDef]:
    """Yield the public functions of two or more parameters in ``__all__``, and such methods of its classes."""
    promised = {
        node.value
        for statement in module.body
        if isinstance(statement, ast.Assign)
        and any(isinstance(target, ast.Name) and target.id == "__all__" for target in statement.targets)
        for node in ast.walk(statement.value)
        if isinstance(node, ast.Constant)
    }
    for statement in module.body:
        if getattr(statement, "name", None) in promised:
            members = statement.body if isinstance(statement, ast.ClassDef) else [statement]
            for function in members:
                is_public = isinstance(function, ast.FunctionDef) and not function.name.startswith("_")
                if is_public and len(parameters(function)) >= 2:
                    yield function


def parameters(function: ast.FunctionDef) -> list[str]:
    """Return the names of the parameters of a function, without ``self``, ``cls``, ``*args`` and ``**kwargs``."""
    arguments = function.args
    names = [argument.arg for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    return [name for name in names if name not in ("self", "cls")]


def is_described(function: ast.FunctionDef) -> bool:
    """Return whether a docstring has a section on parameters, or names each of them in backticks."""
    text = ast.get_docstring(function) or ""
    return "Parameters\n---" in text or all(f"`{name}`" in text for name in parameters(function))


def is_number(expression: ast.expr) -> bool:
    """Return whether an expression is a number, or is made of numbers only."""
    nodes = list(ast.walk(expression))
    if any(isinstance(node, ast.Name | ast.Call | ast.Attribute) for node in nodes):
        return False
    return any(isinstance(node, ast.Constant) and type(node.value) in (int, float) for node in nodes)


def count_constants(module: ast.Module, lines: list[str]) -> Counter[str]:
    """Count the constants of a module that share a statement, and those that are numbers without a comment."""
    counts = Counter[str]()
    for statement in module.body:
        if isinstance(statement, ast.Assign):
            targets = statement.targets
        elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
            targets = [statement.target]
        else:
            continue
        names = [node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)]
        if not names or any(name != name.upper() for name in names):
            continue
        counts["packed_constants"] += len(names) > 1
        if is_number(statement.value):
            above = lines[statement.lineno - 2].strip() if statement.lineno > 1 else ""
            counts["bare_constants"] += "#" not in lines[statement.lineno - 1] and not above.startswith("#")
    return counts


def tokens_with_whole_strings(text: str) -> Iterator[tuple[int, str, int, int]]:
    """Yield type, text, first and last line of each token; a string with fields is one token."""
    depth = 0
    first_line = 0
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in STRING_OPENERS:
            first_line = first_line if depth else token.start[0]
            depth += 1
        elif token.type in STRING_CLOSERS:
            depth -= 1
            if not depth:
                yield tokenize.STRING, "", first_line, token.end[0]
        elif not depth:
            yield token.type, token.string, token.start[0], token.end[0]


def count_tokens(text: str, skipped_lines: set[int]) -> Counter[str]:
    """Count tokens, lines of code and identifiers, without the lines of docstrings."""
    counts = Counter[str]()
    code_lines = set[int]()
    for kind, string, first_line, last_line in tokens_with_whole_strings(text):
        if kind not in COUNTED_TOKENS or first_line in skipped_lines:
            continue
        counts["tokens"] += 1
        code_lines.update(range(first_line, last_line + 1))
        if kind == tokenize.NAME and not keyword.iskeyword(string):
            counts["identifiers"] += 1
            counts["private_identifiers"] += is_private(string)
    counts["code_lines"] = len(code_lines)
    return counts


@cache
def measure(text: str) -> Counter[str]:
    """Return all counts of the text of a Python module."""
    module = ast.parse(text)
    nodes = list(ast.walk(module))
    documentation = docstrings(nodes)
    documented_lines = {line for node in documentation for line in range(node.lineno, node.end_lineno + 1)}
    counts = count_tokens(text, documented_lines) + count_constants(module, text.splitlines())
    counts["statements"] = sum(map(count_statements, nodes)) - len(documentation)
    counts["assignments"] = sum(isinstance(node, ast.Assign) for node in nodes)
    counts["tuple_assignments"] = sum(map(is_tuple_assignment, nodes))
    counts["branchy_functions"] = sum(isinstance(node, FUNCTIONS) and is_branchy(node) for node in nodes)
    promised = list(promised_functions(module))
    counts["promised_functions"] = len(promised)
    counts["described_functions"] = sum(map(is_described, promised))
    return counts


def measure_files(repository: Path = REPOSITORY) -> dict[str, dict[Path, Counter[str]]]:
    """Return the counts of each Python file: root -> path in the repository -> counts."""
    return {
        root: {
            path.relative_to(repository): measure(path.read_text(encoding="utf-8"))
            for path in sorted((repository / folder).rglob("*.py"))
        }
        for root, folder in ROOTS.items()
    }


def count_kernel_lines(text: str, is_c: bool) -> int:
    """Return the lines of a compiled source that are neither blank nor comments nor docstrings."""
    if is_c:
        code = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
        return sum(bool(line.strip()) for line in code.splitlines())
    code = re.sub(r'^[ \t]*r?"""(.*?)"""[ \t]*$', "", text, flags=re.DOTALL | re.MULTILINE)
    return sum(bool(line.strip()) and not line.strip().startswith("#") for line in code.splitlines())


def measure_kernels(repository: Path = REPOSITORY) -> int:
    """Return the lines of code of the compiled sources, without the C files that Cython generates from them."""
    sources = [path for path in sorted((repository / "kernels").rglob("*")) if path.suffix in KERNEL_SUFFIXES]
    texts = {path: path.read_text(encoding="utf-8") for path in sources}
    return sum(
        count_kernel_lines(text, is_c=path.suffix in (".h", ".c"))
        for path, text in texts.items()
        if not text.startswith("/* Generated by Cython")
    )


def total(files: Mapping[Path, Counter[str]]) -> Counter[str]:
    """Return the counts of all files of a root together."""
    return sum(files.values(), Counter[str]())


def budgeted_figures(repository: Path = REPOSITORY) -> dict[str, dict[str, float]]:
    """Return the figures that have a budget, in the layout of ``budgets.toml``: figure -> place -> value."""
    counts = {root: total(files) for root, files in measure_files(repository).items()}
    figures = {
        name: {root: FIGURES[name].value(counts[root]) for root in ROOTS} for name in COLUMNS if name != "statements"
    }
    product = sum(counts[root]["statements"] for root in PRODUCT)
    return {
        "statements": {"product": product, "tests": counts["tests"]["statements"]},
        "kernel_lines": {"kernels": measure_kernels(repository)},
        **figures,
    }


def read_budgets(path: Path = BUDGETS) -> dict[str, dict[str, float]]:
    """Return the budgets: figure -> place -> limit."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


def entries(table: Mapping[str, Mapping[str, float]]) -> dict[tuple[str, str], float]:
    """Return a table of budgets or figures with pairs of figure and place as keys."""
    return {(name, place): value for name, places in table.items() for place, value in places.items()}


def find_violations(
    figures: Mapping[str, Mapping[str, float]], budgets: Mapping[str, Mapping[str, float]]
) -> list[str]:
    """Return the figures that are worse than their budgets, in words, and budgets without figure or vice versa."""
    values = entries(figures)
    limits = entries(budgets)
    unmatched = sorted(values.keys() ^ limits.keys())
    violations = [f"{name} of {place}: has no budget, or a budget without a figure" for name, place in unmatched]
    return violations + [
        f"{name} of {place}: {value:,} is worse than the budget, {limits[name, place]:,}"
        for (name, place), value in values.items()
        if (name, place) in limits and FIGURES[name].is_worse(value, limits[name, place])
    ]


def find_loose_budgets(
    figures: Mapping[str, Mapping[str, float]], budgets: Mapping[str, Mapping[str, float]]
) -> list[str]:
    """Return the budgets that exceed their figures by more than the slack, in words."""
    limits = entries(budgets)
    return [
        f"{name} of {place}: set the budget to {value:,}, it is {limits[name, place]:,}"
        for (name, place), value in entries(figures).items()
        if (name, place) in limits and FIGURES[name].is_loose(value, limits[name, place])
    ]


def with_figures(text: str, figures: Mapping[str, Mapping[str, float]]) -> str:
    """Return the text of ``budgets.toml`` with the figures in place of its limits; comments stay."""
    lines = text.splitlines()
    name = ""
    for number, line in enumerate(lines):
        if header := re.fullmatch(r"\[(\w+)\]", line):
            name = header[1]
        elif entry := re.match(r"(\w+) = [\d_.]+", line):
            lines[number] = f"{entry[1]} = {figures[name][entry[1]]:_}{line[entry.end() :]}"
    return "\n".join(lines) + "\n"


def lower(path: Path, figures: Mapping[str, Mapping[str, float]]) -> None:
    """Write the figures into a file of budgets; ValueError, and nothing is written, if one is worse than its budget."""
    if violations := find_violations(figures, read_budgets(path)):
        raise ValueError("\n".join(violations))
    path.write_text(with_figures(path.read_text(encoding="utf-8"), figures), encoding="utf-8")


def format_table(rows: Mapping[str, Counter[str]]) -> str:
    """Return a table with a line for each root."""
    heads = "".join(f"{FIGURES[name].title:>14}" for name in COLUMNS)
    body = [
        f"{root:10}" + "".join(f"{FIGURES[name].value(counts):14,}" for name in COLUMNS)
        for root, counts in rows.items()
    ]
    return "\n".join([" " * 10 + heads, *body])


def format_worst(files: Mapping[Path, Counter[str]], length: int) -> str:
    """Return, for each figure, the files of the product that are worst in it."""
    large = {path: counts for path, counts in files.items() if counts["code_lines"] >= SMALLEST_LISTED}
    lines = list[str]()
    for name in COLUMNS:
        figure = FIGURES[name]
        # a file that promises nothing has nothing to describe
        values = {path: figure.value(counts) for path, counts in large.items() if not figure.per or counts[figure.per]}
        ordered = sorted(values, key=lambda path, values=values: values[path], reverse=not figure.larger_is_better)
        lines += ["", f"worst by {figure.title}:"]
        lines += [f"{values[path]:10,}  {path.as_posix()}" for path in ordered[:length]]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Print the figures, or write them into the budgets; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--worst", metavar="N", type=int, default=0, help="add the N worst files of each figure")
    parser.add_argument("--lower", action="store_true", help="write improved figures into budgets.toml")
    options = parser.parse_args(arguments)
    if options.lower:
        try:
            lower(BUDGETS, budgeted_figures())
        except ValueError as error:
            print(f"budgets.toml is unchanged:\n{error}", file=sys.stderr)
            return 1
        return 0
    files = measure_files()
    print(format_table({root: total(counts) for root, counts in files.items()}))
    size = sum(total(files[root])["statements"] for root in PRODUCT)
    print(f"\nproduct: {size:,} statements; kernels: {measure_kernels():,} lines of code")
    if options.worst:
        product = {path: counts for root in PRODUCT for path, counts in files[root].items()}
        print(format_worst(product, options.worst))
    return 0


if __name__ == "__main__":
    sys.exit(main())
