"""Measure what a law pays for coming through the door, against the same law compiled into the box.

The law is that of docs/example-plugins/rollslip-circular, built by its own setup.py, and compared with

- in the box: the same .pyx file, built with the flags and directives of rollslip's own kernels, in the same chain;
- by hand: the same loop called straight from its module, without capsule, chain, domain and blocks;
- NumPy: its NumPy form, called by the chain, and called straight.

The variants take turns, so that they share what else the machine does, and each counts with its fastest turn. Nothing
is written but the report; a C compiler is all it needs beside rollslip.
"""

import importlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rollslip import Chain, Slices, get_include

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "docs" / "example-plugins" / "rollslip-circular"
SIZES = (1, 16, 256, 1024, 4096, 65536)
TURNS = 40
TURN = 2e-3  # s, at least, for one variant

#: What `by hand` adds to the file of the example: a direct call of its loop.
BY_HAND = """

def by_hand(slices, double limit):
    cdef double[:, :] t = slices._table   # rows may lie apart
    cdef rs_slices s
    s.n = t.shape[1]
    s.sliding_speed = &t[2, 0]
    s.pressure = &t[6, 0]
    s.film_thickness = &t[7, 0]
    s.friction = &t[9, 0]
    s.film_viscosity = &t[10, 0]
    with nogil:
        _evaluate(&s, &limit)
"""

SETUP = """
from Cython.Distutils import Extension
from setuptools import setup

setup(
    name="box",
    ext_modules=[
        Extension(
            "box",
            ["box.pyx"],
            include_dirs=[{include!r}],
            cython_include_dirs=[{include!r}],
            extra_compile_args=["-O3", "-fno-math-errno", "-fno-trapping-math"],
            cython_directives={{
                "language_level": 3,
                "boundscheck": False,
                "wraparound": False,
                "cdivision": True,
                "initializedcheck": False,
            }},
        )
    ],
)
"""


def build(folder: Path) -> None:
    """Build the example as it is, and its law as a built-in kernel, and make both importable."""
    example = folder / "example"
    box = folder / "box"
    shutil.copytree(
        EXAMPLE, example, ignore=shutil.ignore_patterns("build", "*.so", "*.c", "*.egg-info")
    )
    box.mkdir()
    law = (EXAMPLE / "src" / "rollslip_circular" / "_kernel.pyx").read_text(encoding="utf-8")
    (box / "box.pyx").write_text(law + BY_HAND, encoding="utf-8")
    (box / "setup.py").write_text(SETUP.format(include=get_include()), encoding="utf-8")
    for place in (example, box):
        command = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
        subprocess.run(command, cwd=place, check=True, capture_output=True)
    sys.path[:0] = [str(example / "src"), str(box)]


class Form:
    """A model with another kernel, or with none."""

    def __init__(self, law: Any, capsule: object) -> None:
        self.law = law
        self.capsule = capsule

    def __getattr__(self, name: str) -> Any:
        return getattr(self.law, name)

    def kernel(self) -> object:
        return self.capsule


def slices_of(n: int) -> Slices:
    """Slices of a loaded bearing, of all sliding speeds between pure rolling and the limit."""
    spread = np.linspace(0.0, 1.0, n)
    return Slices(
        n,
        pressure=4e8 + 4e8 * spread,
        film_viscosity=0.01 * np.exp(1.2e-8 * (4e8 + 4e8 * spread)),
        film_thickness=4e-7 + 2e-7 * spread,
        sliding_speed=3.0 * spread[::-1],
    )


def fastest(calls: dict[str, Callable[[], Any]]) -> dict[str, float]:
    """Return the time of one call [s] of each variant: of the fastest of their turns."""
    repeats = {}
    for name, call in calls.items():
        call()
        begin = time.perf_counter()
        call()
        repeats[name] = max(1, int(TURN / max(time.perf_counter() - begin, 1e-7)))
    best = dict.fromkeys(calls, np.inf)
    for _ in range(TURNS):
        for name, call in calls.items():
            begin = time.perf_counter()
            for _ in range(repeats[name]):
                call()
            best[name] = min(best[name], (time.perf_counter() - begin) / repeats[name])
    return best


def main() -> None:
    """Build, check that all variants agree, measure, print."""
    with tempfile.TemporaryDirectory() as folder:
        build(Path(folder))
        box = importlib.import_module("box")
        law = importlib.import_module("rollslip_circular.traction").Circular()
        models: dict[str, Any] = {
            "door": law,
            "box": Form(law, box.capsule(law.limit)),
            "NumPy in chain": Form(law, None),
        }
        chains = {name: Chain(model) for name, model in models.items()}
        blocks = {
            0: Chain(models["NumPy in chain"], block=0),
            256: Chain(models["NumPy in chain"], block=256),
        }

        print(
            f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}; ns per slice"
        )
        names = [*chains, "by hand", "NumPy alone"]
        print(
            f"{'n':>7}"
            + "".join(f"{name:>16}" for name in names)
            + f"{'door/box':>10}{'door - by hand':>16}"
        )
        one_slice: dict[str, float] = {}
        for n in SIZES:
            slices = slices_of(n)

            calls: dict[str, Callable[[], Any]] = {
                name: partial(chain, slices) for name, chain in chains.items()
            }
            calls["by hand"] = partial(box.by_hand, slices, law.limit)
            calls["NumPy alone"] = partial(law.evaluate, slices)
            results = {}
            for name, call in calls.items():
                slices.friction[:] = np.nan
                call()
                results[name] = slices.friction.copy()
                np.testing.assert_allclose(results[name], results["door"], rtol=1e-13)
            assert np.array_equal(results["door"], results["box"])
            once = fastest(calls)
            per_slice = {name: 1e9 * seconds / n for name, seconds in once.items()}
            print(
                f"{n:7d}"
                + "".join(f"{per_slice[name]:16.2f}" for name in names)
                + f"{once['door'] / once['box']:10.3f}{per_slice['door'] - per_slice['by hand']:16.2f}"
            )
            if n == 1:
                one_slice = once

        n = SIZES[-1]
        slices = slices_of(n)
        whole = fastest({str(block): partial(chain, slices) for block, chain in blocks.items()})
        per_block = (whole["256"] - whole["0"]) / (n / 256 - 1)
        us = {name: f"{1e6 * seconds:.2f} us" for name, seconds in one_slice.items()}
        print(
            f"one slice: compiled {us['door']}, NumPy {us['NumPy in chain']}, of which evaluate {us['NumPy alone']}"
        )
        print(
            f"a NumPy stage pays {1e6 * per_block:.2f} us for a block, "
            f"beside {1e9 * whole['0'] / n:.1f} ns a slice in one block of {n}"
        )


if __name__ == "__main__":
    main()
