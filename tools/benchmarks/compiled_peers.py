"""The contact chain as loops in Cython and in C, built on the spot with the compiler at hand.

- *Cython* and *C* are scalar loops with the mathematics of the C library and the flags of rollslip's own kernels.
- *C, unfair* has what rollslip may not have: flags that let the compiler change results, and code for this machine
  alone. It is a bound of what a C compiler reaches with the vector functions of the C library (libmvec).
- *C, prototype* is a bound for rollslip's own way, prototype.h: blocks, own vector mathematics, nothing but friction.
"""

import atexit
import functools
import importlib
import os
import re
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np

from constants import Constants, constants

#: Environment variable with the folder of loops that are built already.
BUILT = "ROLLSLIP_BENCHMARK_LOOPS"
HERE = Path(__file__).parent
PROTOTYPE = (
    "-O3",
    "-march=native",
    "-mprefer-vector-width=512",
    "-fno-math-errno",
    "-fno-trapping-math",
)
UNFAIR = ("-O3", "-march=native", "-mprefer-vector-width=512", "-ffast-math")

SETUP = """
from Cython.Distutils import Extension
from setuptools import setup

setup(
    name="loops",
    ext_modules=[
        Extension(
            name, [name + ".pyx"], include_dirs=[".", {here!r}], extra_compile_args=flags, libraries={libraries!r}
        )
        for name, flags in {modules!r}.items()
    ],
)
"""


def own_flags():
    """Return the compiler's flags of rollslip's kernels, as setup.py has them."""
    with mock.patch("setuptools.setup"):
        return tuple(runpy.run_path(str(HERE.parents[1] / "setup.py"))["FLAGS"])


def build(folder):
    """Compile the loops with all sets of flags into a folder."""
    flags = {"loops": [*own_flags()], "loops_unfair": [*UNFAIR], "loops_prototype": [*PROTOTYPE]}
    fields = " ".join(f"double {name};" for name in Constants._fields)
    (folder / "constants.h").write_text(
        f"#pragma once\ntypedef struct {{ {fields} }} constants;\n", encoding="utf-8"
    )
    for name in flags:
        (folder / f"{name}.pyx").write_text(
            (HERE / "loops.pyx").read_text(encoding="utf-8"), encoding="utf-8"
        )
    libraries = [] if os.name == "nt" else ["m"]
    setup = SETUP.format(here=str(HERE), modules=flags, libraries=libraries)
    (folder / "setup.py").write_text(setup, encoding="utf-8")
    command = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(
            "cannot be built: " + " / ".join((done.stdout + done.stderr).strip().splitlines()[-3:])
        )


@functools.cache
def built():
    """Return the folder of the loops: built now, to live as long as the process, or by the process that started it."""
    if folder := os.environ.get(BUILT):
        return Path(folder)
    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    build(Path(folder.name))
    return Path(folder.name)


def module(name):
    """Return a module of the loops."""
    with mock.patch.object(sys, "path", [str(built()), *sys.path]):
        return importlib.import_module(name)


def vector_functions(module):
    """Return the vector functions of the C library that a module calls."""
    found = subprocess.run(
        ["nm", "-D", "-u", module.__file__], capture_output=True, text=True, check=False
    ).stdout
    return sorted(set(re.findall(r"_ZGV\w+?_(\w+)", found)))


def peer(name, form):
    """Return a peer, a form of the loop in a module: a function of film and contacts."""
    loops = module(name)

    def made(film, given):
        friction = np.empty_like(given.load)
        arrays = given.load, given.rolling_speed, given.sliding_speed
        return loops.Loop(form, film, constants(given), *arrays, friction), lambda: friction

    return made
