"""Draw faults at random from the whole product, plant each in a copy of the tree, and report which tests see it.

``python tools/random_faults.py N --seed S`` draws N places of all modules of the product with equal probability, so
that no file and no line is chosen. A fault exchanges min and max, a strict and a weak comparison, plus and minus, times
and over, ``and`` and ``or``; or it doubles a number, or drops ``abs``, ``not`` or a sign. The tests are those of the
file, by its name and by ``tests/mutants/faults.toml``, or the folder of tests of its package where there are none;
``--tests package`` takes that folder as well, ``--tests suite`` the default run. Rows are CSV. What survives is judged
by hand: some faults are equivalent to what they replace.
"""

import argparse
import ast
import csv
import random
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

TREE = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TREE / "tests" / "mutants"))

import plant  # noqa: E402

#: Folder of sources -> folder of tests: the folders inside have the same names on both sides.
PACKAGES = {
    "framework/rollslip": "tests",
    "plugins/rollslip_plugins": "tests/plugins",
    "plugins/rollslip_studies": "tests/studies",
    "plugins/rollslip_campaigns": "tests/campaigns",
}
#: What stands between two operands -> what is planted.
OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "+": "-", "-": "+", "*": "/", "/": "*", "and": "or", "or": "and",
}  # fmt: skip
#: Name of a function or method -> that which takes its place.
NAMES = {
    "min": "max",
    "max": "min",
    "minimum": "maximum",
    "maximum": "minimum",
    "any": "all",
    "all": "any",
}


class Place(NamedTuple):
    """A place in a line of a file, and what is planted there."""

    file: str
    line: int  # from 0 on
    start: int
    end: int
    new: str


def places(file: str, text: str) -> Iterator[Place]:
    """Yield all faults of a module whose place is within one line of ASCII, where columns are bytes."""
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        for start, end, new in edits(node, lines):
            if lines[start[0] - 1].isascii() and start[0] == end[0]:
                yield Place(file, start[0] - 1, start[1], end[1], new)


def edits(
    node: ast.AST, lines: list[str]
) -> Iterator[tuple[tuple[int, int], tuple[int, int], str]]:
    """Yield start, end and new text of each fault of a node."""
    pairs: list[tuple[ast.expr, ast.expr]] = []
    if isinstance(node, ast.Compare):
        pairs = list(zip([node.left, *node.comparators], node.comparators, strict=False))
    elif isinstance(node, ast.BinOp):
        pairs = [(node.left, node.right)]
    elif isinstance(node, ast.BoolOp):
        pairs = list(zip(node.values, node.values[1:], strict=False))
    for left, right in pairs:
        yield from operator_between(left, right, lines)
    if isinstance(node, ast.Call):
        name = (
            node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        )
        at = (node.func.end_lineno or 0, (node.func.end_col_offset or 0) - len(name))
        if new := NAMES.get(name, "" if name == "abs" else name):
            if new != name:
                yield at, (at[0], at[1] + len(name)), new
        elif isinstance(node.func, ast.Name):
            yield at, (at[0], at[1] + len(name)), ""
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        line, column = begin(node)
        yield (
            (line, column),
            (line, column + len("not " if isinstance(node.op, ast.Not) else "-")),
            "",
        )
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value:
        yield begin(node), (node.end_lineno or 0, node.end_col_offset or 0), repr(2 * node.value)


def begin(node: ast.expr) -> tuple[int, int]:
    """Return line, from 1 on, and column of a node."""
    return node.lineno, node.col_offset


def operator_between(
    left: ast.expr, right: ast.expr, lines: list[str]
) -> Iterator[tuple[tuple[int, int], tuple[int, int], str]]:
    """Yield the fault of the operator between two operands of one line."""
    if left.end_lineno == right.lineno:
        line = lines[right.lineno - 1]
        between = line[left.end_col_offset : right.col_offset]
        if new := OPERATORS.get(between.strip(" ()")):
            at = (left.end_col_offset or 0) + between.index(between.strip(" ()"))
            yield (right.lineno, at), (right.lineno, at + len(between.strip(" ()"))), new


def fault_of(place: Place, text: str, tests: tuple[str, ...]) -> plant.Fault:
    """Return a place as a fault of `plant`: the line with as many lines before it as make it unique."""
    lines = text.splitlines(keepends=True)
    line = lines[place.line]
    changed = line[: place.start] + place.new + line[place.end :]
    first = place.line
    while text.count("".join(lines[first : place.line + 1])) > 1 and first > 0:
        first = first - 1
    before = "".join(lines[first : place.line])
    return plant.Fault(place.file, tests, before + line, before + changed)


def tests_of(file: str, which: str) -> tuple[str, ...]:
    """Return the tests of a file: named ones, those of its package too, or none for the whole suite."""
    if which == "suite":
        return ()
    package = next(package for package in PACKAGES if file.startswith(f"{package}/"))
    module = ".".join(Path(file).relative_to(Path(package).parent).with_suffix("").parts)
    named = [test for fault in plant.faults() if fault.file == file for test in fault.tests]
    named += [
        str(path.relative_to(TREE))
        for path in sorted((TREE / "tests").rglob("test_*.py"))
        if path.stem == f"test_{Path(file).stem}"
        or f"from {module} import" in path.read_text("utf-8")
    ]
    folder = Path(PACKAGES[package]) / Path(file).relative_to(package).parts[0]
    folders = [folder if (TREE / folder).is_dir() else folder.parent / "top_level"]
    if not (TREE / folders[0]).is_dir():
        folders = [folder.parent]
    return tuple(
        dict.fromkeys([*named, *map(str, folders if which == "package" or not named else [])])
    )


def main() -> None:
    """Draw, plant and report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tests", choices=["named", "package", "suite"], default="named")
    requested = parser.parse_args()
    texts = {
        str(path.relative_to(TREE)): path.read_text(encoding="utf-8")
        for package in PACKAGES
        for path in sorted((TREE / package).rglob("*.py"))
    }
    every = [place for file, text in texts.items() for place in places(file, text)]
    drawn = random.Random(requested.seed).sample(every, requested.count)
    plant.prepare()
    out = csv.writer(sys.stdout)
    out.writerow(["place", "line", "planted", "outcome", "test", "seconds"])
    with tempfile.TemporaryDirectory(prefix="rollslip-faults-") as folder:
        tree = Path(folder) / "tree"
        pristine = plant.copied(tree)
        for place in drawn:
            tests = tests_of(place.file, requested.tests)
            fault = fault_of(place, texts[place.file], tests)
            with plant.planted(fault, tree, pristine):
                outcome, test, seconds = plant.outcome_of(tree, fault.tests)
            old, new = (part.splitlines()[-1].strip() for part in (fault.old, fault.new))
            out.writerow(
                [f"{place.file}:{place.line + 1}", old, new, outcome, test, round(seconds, 1)]
            )
            sys.stdout.flush()


if __name__ == "__main__":
    main()
