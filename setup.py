"""Build the compiled kernels; everything else is in pyproject.toml."""

import glob
import os
import sys

from Cython.Distutils import Extension
from setuptools import setup

HERE = "kernels/rollslip_kernels"
# Without the two -fno-...-math flags the block loops do not vectorise; -ffast-math would break exp's rounding. Without
# contraction to fused multiply-adds a kernel gives the same bits on every instruction set.
FLAGS = [] if sys.platform == "win32" else ["-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"]
# ROLLSLIP_BOUNDSCHECK=1 checks every index of a memoryview, for a build under test.
CHECKED = os.environ.get("ROLLSLIP_BOUNDSCHECK") == "1"
# What the modules exchange with the stages
SHARED = ("table.h", "rollslip_blocks.pxd")


def kernel(name: str) -> Extension:
    # The formulas in blocks/ are compiled once, in simd.
    blocks = glob.glob(f"{HERE}/blocks/*.*") if name == "simd" else [f"{HERE}/blocks/{seen}" for seen in SHARED]
    # Not cythonize(): with it the sdist loses the .pyx files.
    return Extension(
        f"rollslip_kernels.{name}",
        [f"{HERE}/{name}.pyx"],
        depends=sorted(glob.glob(f"{HERE}/include/*.*") + blocks),
        include_dirs=[HERE, f"{HERE}/include"],
        cython_include_dirs=[f"{HERE}/include", f"{HERE}/blocks"],
        extra_compile_args=FLAGS,
        cython_directives={
            "language_level": 3,
            "boundscheck": CHECKED,
            "wraparound": False,
            "cdivision": True,
            "initializedcheck": CHECKED,
        },
    )


KERNELS = (
    "blend",
    "carried",
    "chain",
    "contact",
    "drag",
    "equilibrium",
    "film",
    "planar",
    "raceway",
    "rheology",
    "rosenbrock",
    "simd",
    "stress",
    "system",
    "traction",
    "vector_math",
    "viscosity",
)

setup(ext_modules=[kernel(name) for name in KERNELS])
