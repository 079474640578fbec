"""Write anew what the pages of ``docs`` show of commands and of Python: ``python tools/refresh_pages.py [PAGE ...]``.

An answer that still holds stays as it is, with its ellipses. Of one that no longer holds, each line with an ellipsis
that fits a new line stays, and a line that is an ellipsis alone keeps its distance from both ends. Read the difference
before you commit it: the sentences around an answer quote its numbers.
"""

import contextlib
import doctest
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from rollslip.catalogue import discovery
from rollslip.cli.main import main

DOCS = Path(__file__).parents[1] / "docs"
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
ANSWERS = re.compile(r"^\.\. answers::\n\n((?:(?:   .*)?\n)+)", re.MULTILINE)
COMMAND = re.compile(r"^\$ rollslip (.*)\n((?:(?!\$).*\n)*)", re.MULTILINE)
CHECKER = doctest.OutputChecker()


def holds(want: str, got: str) -> bool:
    """Whether a shown answer is what was printed."""
    return CHECKER.check_output(want, got, FLAGS)


def shown(want: str, got: str) -> str:
    """What a page shows of what was printed: the former answer where it holds, otherwise the new one."""
    if holds(want, got):
        return want
    old = want.rstrip("\n").split("\n")
    new = got.rstrip("\n").split("\n")
    patterns = [line for line in old if "..." in line and line.strip() != "..."]
    new = [
        next((pattern for pattern in patterns if holds(pattern + "\n", line + "\n")), line)
        for line in new
    ]
    alone = [index for index, line in enumerate(old) if line.strip() == "..."]
    if alone:
        first = alone[0]
        behind = len(old) - 1 - alone[-1]
        new = [*new[:first], old[first], *new[len(new) - behind :]]
    return "\n".join(new) + "\n"


@contextlib.contextmanager
def in_examples() -> Iterator[None]:
    """A new folder with the examples of the pages, as the working directory."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(DOCS / "examples", folder, dirs_exist_ok=True)
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def printed(command: str) -> str:
    """What a command of rollslip prints, on either stream."""
    out = io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(out),
        contextlib.suppress(SystemExit),
    ):
        main(shlex.split(command))
    return out.getvalue()


def refresh_commands(text: str) -> str:
    """The text of a page with its commands answered anew."""

    def answered(block: re.Match[str]) -> str:
        lines = re.sub(r"^   ", "", block[1], flags=re.MULTILINE)
        body = lines.rstrip("\n") + "\n"
        with in_examples():
            body = COMMAND.sub(
                lambda found: f"$ rollslip {found[1]}\n{shown(found[2], printed(found[1]))}", body
            )
        blank = lines[len(lines.rstrip("\n")) + 1 :]
        return ".. answers::\n\n" + re.sub(r"^(?=.)", "   ", body, flags=re.MULTILINE) + blank

    return ANSWERS.sub(answered, text)


def refresh_python(text: str, name: str) -> str:
    """The text of a page with its examples in Python answered anew."""
    test = doctest.DocTestParser().get_doctest(text, {"__name__": "__main__"}, name, name, 0)
    lines = text.split("\n")
    answers: list[str] = []

    class Runner(doctest.DocTestRunner):
        def report_success(self, out: object, test: object, example: object, got: str) -> None:
            answers.append(got)

        def report_failure(self, out: object, test: object, example: object, got: str) -> None:
            answers.append(got)

        def report_unexpected_exception(
            self, out: object, test: object, example: doctest.Example, exc_info: object
        ) -> None:
            print(f"{name}: {example.source.strip()} raises", file=sys.stderr)
            answers.append(example.want)

    registered = discovery._registered
    discovery._registered = {}  # what a page registers stays on the page
    with in_examples():
        Runner(optionflags=FLAGS).run(test, out=lambda text: None)
    discovery._registered = registered
    for example, got in reversed(list(zip(test.examples, answers, strict=True))):
        if example.exc_msg is None and not holds(example.want, got):
            start = example.lineno + example.source.count("\n")
            margin = " " * example.indent
            body = shown(example.want, got).rstrip("\n").split("\n")
            lines[start : start + example.want.count("\n")] = [margin + line for line in body]
    return "\n".join(lines)


def refresh(names: list[str]) -> None:
    """Write the pages of these names, or all of them."""
    os.environ["COLUMNS"] = "120"
    for page in sorted(DOCS.glob("[!_]*/*.rst")):
        name = page.relative_to(DOCS).as_posix()
        if name.startswith("gallery/") or (names and name not in names):
            continue
        before = page.read_text(encoding="utf-8")
        after = refresh_commands(before)
        if ">>>" in after:
            after = refresh_python(after, name)
        if after != before:
            page.write_text(after, encoding="utf-8")
            print(f"{name}: written")


if __name__ == "__main__":
    refresh(sys.argv[1:])
