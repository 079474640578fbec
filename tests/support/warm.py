"""The command line in a process of its own that does not start cold: imports are half of what a short command costs.

Each command is forked from a process that has imported the program and nothing else: no catalogue, no scene, no state
of another command. Tests of start-up itself, of signals and of locales start Python.
"""

import multiprocessing
import os
import tempfile
from pathlib import Path
from subprocess import CompletedProcess

_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(
    [
        "rollslip.cli.main",
        "rollslip.planning.execution",
        "rollslip.results.dataset",
        "rollslip.results.report",
        "xarray",
    ]
)


def _run(arguments, cwd, told):
    """Be the program: its own standard streams, and an exit code."""
    for stream, path in enumerate((os.devnull, *told)):
        opened = os.open(path, os.O_RDWR)
        os.dup2(opened, stream)
        os.close(opened)
    os.chdir(cwd)
    from rollslip.cli import main

    main(list(arguments))


def run(*arguments, cwd):
    """Run the program from a folder; return what it printed with its exit code."""
    with tempfile.TemporaryDirectory() as folder:
        told = [Path(folder, name) for name in ("out", "err")]
        for path in told:
            path.touch()
        process = _FORKING.Process(target=_run, args=(tuple(map(str, arguments)), os.fspath(cwd), told))
        process.start()
        process.join()
        out, err = (path.read_text(encoding="utf-8") for path in told)
    return CompletedProcess(arguments, process.exitcode, out, err)
