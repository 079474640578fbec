"""Check a model of the catalogue in a child process, in which a plugin may crash, hang or exit.

- The child records in a file each check that it starts, and its finding. If the child ends, the parent knows the check
  that was running, and starts another child for the remaining checks.
- The output of the child is that of the plugin; its last line is part of the finding if the child ends.
- The time limit is that of one check. A model that hangs does so in most checks; after two of them the others are not
  run.
- The parent does not import the plugin.
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
from rollslip.testing.findings import (
    NONE_EXPECTED,
    Finding,
    cases_of,
    name_of,
    run_after_prerequisite,
)

#: Number of checks that exceed the time limit before the others are skipped. Doubling it doubles the time that a
#: hanging model takes. Chosen.
MAX_HANGS: Final = 2
#: Name of the check in the finding on a model that cannot be loaded.
LOADING: Final = "loading"


def check_in_subprocess(
    kind: str,
    name: str,
    time_limit: float = 120.0,
    expected_failures: Mapping[str, str] = NONE_EXPECTED,
) -> list[Finding]:
    """Check a model of the catalogue, with its default parameters, in a separate process.

    Parameters
    ----------
    kind, name : str
        As in `rollslip.get_model`.
    time_limit : float, optional
        Longest time of one check [s].
    expected_failures : mapping, optional
        As in `conformance`.

    Returns
    -------
    list of Finding
        A crash, a hang or an exit is a failed check with a message; if the model cannot be loaded, the check has the
        name "loading".

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
            started = [
                note["started"]
                for note in notes
                if "started" in note and note["started"] not in ended
            ]
            if planned is None or not started:  # another child would end there too
                return [
                    *findings,
                    Finding(name, LOADING, "failed", f"{end} while loading or between checks"),
                ]
            model, check = started[0]
            findings.append(Finding(model, check, "failed", f"{end} in {check}"))
            ended += started
            hangs += end.startswith("did not end")
            if hangs == MAX_HANGS:
                rest = [case for case in planned if case not in ended]
                reason = f"not run: {MAX_HANGS} checks did not end within {time_limit:g} s"
                return findings + [Finding(case[0], case[1], "skipped", reason) for case in rest]


def _child(
    folder: Path, order: dict[str, Any], time_limit: float
) -> tuple[list[dict[str, Any]], str | None]:
    """Run one child; return its notes, and a text on how it ended unless it finished its work."""
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
            # hypothesis would otherwise write to the working directory of the user
            env=os.environ | {"HYPOTHESIS_STORAGE_DIRECTORY": str(folder / "hypothesis")},
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
    # the last line of a child that was killed may be incomplete
    messages = [
        json.loads(line)
        for line in notes.read_text().splitlines(keepends=True)
        if line.endswith("\n")
    ]
    if {"done": True} in messages:
        return messages, None
    last = (output.read_text(errors="replace").strip().splitlines() or [""])[-1]
    return messages, (f"did not end within {time_limit:g} s" if hung else _ending(code)) + (
        f" ({last[:200]})" if last else ""
    )


def _ending(code: int) -> str:
    """Return the description of an exit code."""
    if code >= 0:
        return f"left the process with exit code {code}"
    names = {int(number): number.name for number in signal.Signals}
    return f"crashed with signal {-code} ({names.get(-code, 'unknown')})"


def work() -> None:
    """Run the checks of a child process, whose arguments are the file for notes and the order as JSON."""
    path = sys.argv[1]
    order = json.loads(sys.argv[2])
    with open(path, "a", encoding="utf-8") as file:

        def note(**message: object) -> None:
            file.write(json.dumps(message) + "\n")
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
                note(started=case)
                finding, _ = run_after_prerequisite(model, check, reason)
                note(
                    found={
                        "model": case[0],
                        "check": case[1],
                        "status": finding.status,
                        "message": finding.message,
                    }
                )
        note(done=True)
        os._exit(0)  # without the exit functions of the plugin
