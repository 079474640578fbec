"""Plant small faults, one at a time, and see whether the tests find them: ``python tests/mutants/plant.py``.

``faults.toml`` lists files, the tests that should see a fault there, and faults: what stands there, what is planted,
which test saw it, having passed without it, and, of one that no test can see, why. What stands there must occur exactly
once in the file. What saw a fault is written into the list, and such a fault is not planted again, so that a run may be
interrupted at any time; ``--again nobody`` plants those again that no test saw.

The work is done on a copy of the tree, whose compiled modules must be up to date (``python setup.py build_ext
--inplace``): only what a fault changes is built again, with -O1, which is faster. Tests run in a fork of this process,
which has imported the libraries once; nothing of rollslip is imported before.
"""

import argparse
import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import attrs
import filelock
import hypothesis
import pytest

HERE = Path(__file__).resolve().parent
TREE = HERE.parents[1]
TABLE = HERE / "faults.toml"
NOBODY = "nobody"  # saw it
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv", ".hypothesis", "build", "_build", "*_cache", "htmlcov"
)
COMPILED = {".pyx", ".pxd", ".h"}
MAX_SECONDS = 600.0  # a fault may make a test endless; a loaded machine makes all of them slow


@attrs.frozen
class Fault:
    file: str
    tests: tuple[str, ...]
    old: str
    new: str
    seen_by: str = (
        ""  # a test, what else ended the tests, or nobody; empty where it was not planted yet
    )
    why: str = ""  # no test can see it

    @property
    def key(self) -> tuple[str, str, str]:
        return self.file, self.old, self.new


def faults() -> list[Fault]:
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return [
        Fault(section["file"], tuple(section["tests"].split()), *fault)
        for section in table["of"]
        for fault in section["faults"]
    ]


def line_of(fault: Fault, text: str) -> int:
    """Return the line that the fault stands in; ValueError if the table does not fit the file."""
    if text.count(fault.old) != 1 or fault.old == fault.new:
        raise ValueError(
            f"{fault.file}: {fault.old!r} occurs {text.count(fault.old)} times, not once: mend its row in faults.toml"
        )
    return text[: text.index(fault.old)].count("\n") + 1


def note(planted: Fault, seen_by: str) -> None:
    """Write into the list what saw a fault: another process may have written in between."""
    with filelock.FileLock(Path(tempfile.gettempdir()) / "rollslip-mutants.lock"):
        lines = TABLE.read_text(encoding="utf-8").splitlines()
        file = ""
        for k, line in enumerate(lines):
            if line.startswith("file = "):
                file = tomllib.loads(line)["file"]
            elif line.startswith("  ["):
                old, new, *_ = tomllib.loads(f"row = {line.strip().removesuffix(',')}")["row"]
                if (file, old, new) == planted.key:
                    row = [old, new, seen_by, *filter(None, [planted.why])]
                    lines[k] = f"  [{', '.join(map(quoted, row))}],"
        TABLE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def quoted(text: str) -> str:
    """Return a text as TOML has it."""
    return (
        json.dumps(text, ensure_ascii=False)
        if "'" in text or not text.isprintable()
        else f"'{text}'"
    )


def _tested(tree: Path, tests: tuple[str, ...], log: Path) -> NoReturn:
    """Run tests in this process, a fork, and end it with their status."""
    status = 70
    try:
        os.setsid()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(out, 1)
        os.dup2(out, 2)
        os.chdir(tree)
        roots = [str(tree / root) for root in ("framework", "plugins", "kernels", ".")]
        sys.path[:0] = roots
        os.environ["PYTHONPATH"] = os.pathsep.join(roots)
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "planted"
        options = [
            "-n0",
            "-x",
            "-q",
            "--tb=line",
            "-pno:cacheprovider",
            "--hypothesis-profile=planted",
        ]
        options += [
            "-Wignore::pytest.PytestAssertRewriteWarning"
        ]  # of hypothesis, which is imported before
        status = int(pytest.main([*options, "--hypothesis-seed=0", *tests]))
        sys.stdout.flush()
    except BaseException:
        traceback.print_exc()
    finally:  # what the process began, such as the folder of the copy, is not this one's to end
        os._exit(status)


def outcome_of(tree: Path, tests: tuple[str, ...]) -> tuple[str, str, float]:
    """Run tests in a fork, to the first failure; return the outcome, the test that failed, the seconds it took."""
    log = tree / "tests.log"
    began = time.monotonic()
    if (child := os.fork()) == 0:
        _tested(tree, tests, log)
    status = None
    try:
        while status is None and time.monotonic() - began < MAX_SECONDS:
            time.sleep(0.05)
            done, raw = os.waitpid(child, os.WNOHANG)
            status = os.waitstatus_to_exitcode(raw) if done else None
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        if status is None:
            os.waitpid(child, 0)
    seconds = time.monotonic() - began
    said = log.read_text(encoding="utf-8", errors="replace")
    if status == 0:
        return "survived", "", seconds
    if status is None:
        return "killed", "does not end", seconds
    if status < 0:
        return "killed", f"ended by {signal.Signals(-status).name}", seconds
    if status not in (1, 2):
        raise SystemExit(f"pytest ended with {status}: {said}")
    failed = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", said, re.MULTILINE)
    return "killed", failed[0] if failed else "cannot be imported", seconds


def copied(tree: Path) -> Path:
    """Return a copy of the tree whose kernels are built quickly, and one with what it was before a fault."""
    pristine = tree.with_name(f"{tree.name}.before")
    for old in (tree, pristine):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(TREE, tree, ignore=LEFT_OUT, symlinks=True)
    setup = tree / "setup.py"
    times = (TREE / "setup.py").stat()
    setup.write_text(setup.read_text(encoding="utf-8").replace('"-O3"', '"-O1"'), encoding="utf-8")
    os.utime(setup, ns=(times.st_atime_ns, times.st_mtime_ns))
    for path in (tree / "kernels").rglob(
        "*.*"
    ):  # a checkout may have written sources later than what was built
        if path.suffix in (".c", ".so"):
            os.utime(path)
    shutil.copytree(tree, pristine, symlinks=True)
    return pristine


def build(tree: Path) -> bool:
    """Build what is older than its sources; whether it could be built."""
    command = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
    return subprocess.run(command, cwd=tree, capture_output=True, check=False).returncode == 0


@contextlib.contextmanager
def planted(fault: Fault, tree: Path, pristine: Path) -> Iterator[bool]:
    """Plant a fault, build what it changes, and take it back, times of files included; whether it could be built."""
    path = tree / fault.file
    text = path.read_text(encoding="utf-8")
    line_of(fault, text)
    path.write_text(text.replace(fault.old, fault.new), encoding="utf-8")
    try:
        yield build(tree) if path.suffix in COMPILED else True
    finally:
        shutil.copy2(pristine / fault.file, path)
        if path.suffix in COMPILED:
            for before in (pristine / "kernels").rglob("*.*"):
                after = tree / before.relative_to(pristine)
                if before.is_file() and after.stat().st_mtime_ns != before.stat().st_mtime_ns:
                    shutil.copy2(before, after)


def prepare() -> None:
    """Set what forks of this process inherit: the profile of hypothesis, one thread of linear algebra, libraries."""
    hypothesis.settings.register_profile(
        "planted",
        max_examples=40,
        database=None,
        deadline=None,  # builds and other work beside take the processor
        phases=[hypothesis.Phase.explicit, hypothesis.Phase.generate],
    )
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[variable] = "1"
    for library in (
        "numpy",
        "scipy.optimize",
        "scipy.integrate",
        "scipy.stats",
        "xarray",
        "h5netcdf",
        "rich.console",
    ):
        __import__(library)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "only", nargs="*", help="plant only faults of files whose path holds one of these words"
    )
    parser.add_argument(
        "--again", choices=[NOBODY, "all"], help="plant again what nobody saw, or all"
    )
    parser.add_argument(
        "--part", default="1/1", help="K/N: every N-th fault from the K-th on, for N processes"
    )
    requested = parser.parse_args()
    part, parts = (int(number) for number in requested.part.split("/"))
    table = faults()
    for fault in table:
        line_of(fault, (TREE / fault.file).read_text(encoding="utf-8"))
    chosen = [
        fault
        for number, fault in enumerate(table)
        if number % parts == part - 1
        and (not fault.seen_by or requested.again in ("all", fault.seen_by))
        and (not requested.only or any(word in fault.file for word in requested.only))
    ]
    print(f"{len(table)} faults are listed, {len(chosen)} are planted now")
    prepare()
    with tempfile.TemporaryDirectory(prefix="rollslip-mutants-") as folder:
        tree = Path(folder) / "tree"
        pristine = copied(tree)
        sound = set[str]()
        failing = set[str]()
        for fault in chosen:
            line = line_of(fault, (tree / fault.file).read_text(encoding="utf-8"))
            with planted(fault, tree, pristine) as built:
                first = (
                    [fault.seen_by] if "::" in fault.seen_by else []
                )  # the test that saw it before soon does again
                outcome, test, took = (
                    outcome_of(tree, (*first, *fault.tests))
                    if built
                    else ("killed", "cannot be built", 0.0)
                )
            if "::" in test and test not in sound | failing:
                (sound if outcome_of(tree, (test,))[0] == "survived" else failing).add(test)
            if test in failing:
                print(
                    f"{test} fails without a fault, too; mend it, then see what finds {fault.new!r} in {fault.file}"
                )
                continue
            note(fault, test or NOBODY)
            print(
                f"{outcome:8} {took:6.1f} s  {fault.file}:{line}  {fault.old!r} -> {fault.new!r}  {test}",
                flush=True,
            )
    tried = [one for one in faults() if one.seen_by]
    unseen = [one for one in tried if one.seen_by == NOBODY]
    left = [one for one in unseen if not one.why]
    print(
        f"{len(tried) - len(unseen)} of {len(tried)} were seen; {len(left)} were not, without a reason in the list"
    )
    sys.exit(bool(left or failing))


if __name__ == "__main__":
    main()
