"""Runs of other versions of the program, in processes of their own: from the folder of a clone, built in place."""

import json
import os
import subprocess
import sys


def surroundings(root):
    """Return what `subprocess.run` takes for a process that uses the version of a folder; it keeps its bytecode."""
    path = os.pathsep.join(str(root / part) for part in ("framework", "plugins", "kernels", ""))
    given = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {
        "env": {**given, "PYTHONPATH": path},
        "cwd": root,
        "check": True,
        "capture_output": True,
    }


def measured(script, root, job):
    """Return what a job of a script takes in the version of a folder, which it prints last as JSON."""
    told = subprocess.run([sys.executable, script, "--job", job], text=True, **surroundings(root))
    return json.loads(told.stdout.splitlines()[-1])
