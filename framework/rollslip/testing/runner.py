"""Checks a model of the catalogue in a process of its own: a plugin may crash, hang or leave, and that is a finding.

- The child notes in a file which check it begins and what it found. Whatever becomes of it, the parent knows which
  check was running, and starts another child for the checks that remain.
- Nothing goes through the child's output: that belongs to the plugin. Its last line is told when the child dies.
- The time limit is for one check. A model that hangs hangs in most checks, so after two of them the rest is not run.
- The parent imports nothing of the plugin.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from rollslip.catalogue.registry import find, get_model
from rollslip.errors import RollslipError
from rollslip.testing.findings import NONE_EXPECTED, Finding, cases_of, judge, name_of

#: Checks that may run into the time limit before the others are given up.
MAX_HANGS: Final = 2
LOADING: Final = "loading"


def check_in_subprocess(
    kind: str,
    name: str,
    time_limit: float = 120.0,
    expected_failures: Mapping[str, str] = NONE_EXPECTED,
) -> list[Finding]:
    """Check a model of the catalogue, with its default parameters, in a process of its own.

    Parameters
    ----------
    kind, name : str
        As in `rollslip.get_model`.
    time_limit : float, optional
        Seconds that one check may take.
    expected_failures : mapping, optional
        As in `conformance`.

    Returns
    -------
    list of Finding
        A crash, a hang or an exit is a failed check whose message says which; where the model cannot even be loaded,
        the check is called "loading".

    Raises
    ------
    PluginError
        If no package offers the model, or it cannot be used.
    """
    find(kind, name)
    findings: list[Finding] = []
    ended: list[list[str]] = []  # (model, check) of those that must not run again
    hangs = 0
    with tempfile.TemporaryDirectory(prefix="rollslip-check-") as folder:
        order = {"kind": kind, "name": name, "expected_failures": dict(expected_failures)}
        while True:
            notes, end = _child(Path(folder), order | {"ended": ended}, time_limit)
            found = [Finding(**note["found"]) for note in notes if "found" in note]
            findings += found
            ended += [[finding.model, finding.check] for finding in found]
            planned = next((note["planned"] for note in notes if "planned" in note), None)
            if end is None:
                return findings
            begun = [
                note["begun"] for note in notes if "begun" in note and note["begun"] not in ended
            ]
            if planned is None or not begun:  # another child would come no further
                return [
                    *findings,
                    Finding(name, LOADING, "failed", f"{end} while loading or between checks"),
                ]
            findings.append(Finding(begun[0][0], begun[0][1], "failed", f"{end} in {begun[0][1]}"))
            ended += begun
            hangs += end.startswith("did not end")
            if hangs == MAX_HANGS:
                rest = [case for case in planned if case not in ended]
                reason = f"not run: {MAX_HANGS} checks did not end within {time_limit:g} s"
                return findings + [Finding(case[0], case[1], "skipped", reason) for case in rest]


def _child(
    folder: Path, order: dict[str, Any], time_limit: float
) -> tuple[list[dict[str, Any]], str | None]:
    """Run one child; return its notes, and how it ended unless it came to the end of its work."""
    notes = folder / "notes"
    output = folder / "output"
    notes.write_text("")
    with output.open("wb") as stream:
        child = subprocess.Popen(
            [
                sys.executable,
                "-c",
                "from rollslip.testing.runner import work; work()",
                str(notes),
                json.dumps(order),
            ],
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=stream,
            env=os.environ
            | {
                "HYPOTHESIS_STORAGE_DIRECTORY": str(folder / "hypothesis")
            },  # not where the user works
        )
        hung = False
        size = -1
        since = time.monotonic()
        try:
            while child.poll() is None:
                if (now := notes.stat().st_size) != size:
                    size = now
                    since = time.monotonic()
                if time.monotonic() - since > time_limit:
                    hung = True
                    break
                time.sleep(0.02)
        finally:
            child.kill()
            code = child.wait()
    # a line that a dying child could not finish says nothing
    said = [
        json.loads(line)
        for line in notes.read_text().splitlines(keepends=True)
        if line.endswith("\n")
    ]
    if {"done": True} in said:
        return said, None
    last = (output.read_text(errors="replace").strip().splitlines() or [""])[-1]
    return said, (f"did not end within {time_limit:g} s" if hung else _ending(code)) + (
        f" ({last[:200]})" if last else ""
    )


def _ending(code: int) -> str:
    """Return an exit code in words."""
    if code >= 0:
        return f"left the process with exit code {code}"
    names = {int(number): number.name for number in signal.Signals}
    return f"crashed with signal {-code} ({names.get(-code, 'unknown')})"


def work() -> None:
    """Do what a child is for: arguments are the file for the notes and the order as JSON."""
    path = sys.argv[1]
    order = json.loads(sys.argv[2])
    with open(path, "a", encoding="utf-8") as file:

        def note(**said: object) -> None:
            file.write(json.dumps(said) + "\n")
            file.flush()

        try:
            cases = cases_of(get_model(order["kind"], order["name"]), order["expected_failures"])
        except RollslipError as error:
            note(
                found={
                    "model": order["name"],
                    "check": LOADING,
                    "status": "failed",
                    "message": str(error),
                }
            )
            cases = []
        note(planned=[[name_of(model), check.__name__] for model, check, _ in cases])
        for model, check, reason in cases:
            case = [name_of(model), check.__name__]
            if case not in order["ended"]:
                note(begun=case)
                finding, _ = judge(model, check, reason)
                note(
                    found={
                        "model": case[0],
                        "check": case[1],
                        "status": finding.status,
                        "message": finding.message,
                    }
                )
        note(done=True)
        os._exit(0)  # not through what the plugin has left behind for the end of the process
