"""Python and the command line in a process that does not start cold: imports are half of what a short command costs.

Each is forked from a process that has imported the program with its models, and what it stores and draws with, and
nothing else: no catalogue, no scene, no state of another command. Tests of start-up itself, of what is imported, of
signals and of locales start Python.
"""

import importlib
import multiprocessing
import os
import pkgutil
import sys
import tempfile
import warnings
from pathlib import Path
from subprocess import CompletedProcess

#: Packages all of whose modules are imported.
_OURS = ("rollslip_studies", "rollslip_plugins", "rollslip_campaigns")
_FORKING = multiprocessing.get_context("forkserver")
_FORKING.set_forkserver_preload(
    [
        "rollslip.cli.main",
        "rollslip.planning.execution",
        "rollslip.results.dataset",
        "rollslip.results.report",
        "matplotlib.backends.backend_svg",
        "matplotlib.figure",
        "xarray",
        "h5netcdf",
        "rich.progress",
        *(
            module.name
            for package in map(importlib.import_module, _OURS)
            for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
        ),
    ]
)
COMMAND = "from rollslip.cli import main; main()"


def _run(code, arguments, cwd, told, paths, environment):
    """Be Python: its own standard streams, arguments, path and environment, and an exit code."""
    for stream, path in enumerate((os.devnull, *told)):
        opened = os.open(path, os.O_RDWR)
        os.dup2(opened, stream)
        os.close(opened)
    os.chdir(cwd)
    if environment is not None:
        os.environ.clear()
        os.environ.update(environment)
        warnings.simplefilter("error")
    sys.argv[1:] = arguments
    sys.path[:0] = paths
    exec(code, {"__name__": "__main__"})


def python(code, *arguments, cwd=".", paths=(), environment=None):
    """Run code; return what it printed with its exit code. With an environment of its own warnings are errors."""
    with tempfile.TemporaryDirectory() as folder:
        told = [Path(folder, name) for name in ("out", "err")]
        for path in told:
            path.touch()
        given = (
            code,
            tuple(map(str, arguments)),
            os.path.abspath(cwd),
            told,
            tuple(map(str, paths)),
            environment,
        )
        process = _FORKING.Process(target=_run, args=given)
        process.start()
        process.join()
        out, err = (path.read_text(encoding="utf-8") for path in told)
    return CompletedProcess(arguments, process.exitcode, out, err)


def run(*arguments, cwd):
    """Run the program from a folder; return what it printed with its exit code."""
    return python(COMMAND, *arguments, cwd=cwd)
