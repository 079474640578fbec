"""Build the compiled kernels; everything else is in pyproject.toml."""

import glob
import os
import sys

from Cython.Distutils import Extension
from setuptools import setup

HERE = "kernels/rollslip_kernels"
# Without the two -fno- flags the block loops do not vectorise; -ffast-math would break exp's rounding.
FLAGS = [] if sys.platform == "win32" else ["-O3", "-fno-math-errno", "-fno-trapping-math"]
# ROLLSLIP_BOUNDSCHECK=1 checks every index of a memoryview, for a build under test.
CHECKED = os.environ.get("ROLLSLIP_BOUNDSCHECK") == "1"


def kernel(name: str) -> Extension:
    # Not cythonize(): with it the sdist loses the .pyx files.
    return Extension(
        f"rollslip_kernels.{name}",
        [f"{HERE}/{name}.pyx"],
        depends=sorted(glob.glob(f"{HERE}/include/*.*")),
        include_dirs=[f"{HERE}/include"],
        cython_include_dirs=[f"{HERE}/include"],
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
    "film",
    "planar",
    "raceway",
    "rheology",
    "rosenbrock",
    "stress",
    "system",
    "traction",
    "viscosity",
)

setup(ext_modules=[kernel(name) for name in KERNELS])
