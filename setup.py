"""Build the compiled kernels; everything else is in pyproject.toml."""

import glob
import os
import re
import sys
from pathlib import Path

from Cython.Distutils import Extension
from setuptools import setup

HERE = "kernels/rollslip_kernels"
# Without the two -fno-...-math flags the block loops do not vectorise; -ffast-math would break exp's rounding. Without
# contraction to fused multiply-adds a kernel gives the same bits on every instruction set.
FLAGS = [] if sys.platform == "win32" else ["-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"]
# ROLLSLIP_BOUNDSCHECK=1 checks every index of a memoryview, for a build under test.
CHECKED = os.environ.get("ROLLSLIP_BOUNDSCHECK") == "1"


def declare_members() -> None:
    """Write the members of rs_slices where Cython reads them: it sees no macros."""
    conditions, columns = (Path(HERE) / "include" / "rollslip.h").read_text().split("#define ROLLSLIP_COLUMNS(X)")
    members = ["size_t n"]
    members += [f"double {name}" for name in re.findall(r"^    X\((\w+),", conditions, re.M)]
    members += [f"double *{name}" for name in re.findall(r"^    X\((\w+),", columns, re.M)]
    path = Path(HERE) / "include" / "rollslip_abi.pxd"
    text = path.read_text()
    lines = "".join(f"        {member}\n" for member in members)
    written = re.sub(r"(ctypedef struct rs_slices:\n)(?: {8}.*\n)+", rf"\g<1>{lines}", text)
    if written != text:
        path.write_text(written)


def kernel(name: str) -> Extension:
    shared = ["*.pxd", "include/*.*", "stages/table.h", "stages/rollslip_blocks.pxd"]
    if name == "stages/simd":  # which alone compiles the laws
        shared.append("stages/*.h")
    if name.startswith("motion/"):
        shared.append("motion/*.pxd")
    # Not cythonize(): with it the sdist loses the .pyx files.
    return Extension(
        f"rollslip_kernels.{name.replace('/', '.')}",
        [f"{HERE}/{name}.pyx"],
        depends=sorted({file for pattern in shared for file in glob.glob(f"{HERE}/{pattern}")}),
        include_dirs=[HERE, f"{HERE}/include"],
        cython_include_dirs=[HERE, f"{HERE}/include", f"{HERE}/stages", f"{HERE}/motion"],
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
    "chain",
    "equilibrium",
    "layout",
    "motion/carried",
    "motion/planar",
    "motion/raceway",
    "motion/rosenbrock",
    "motion/system",
    "stages/blend",
    "stages/contact",
    "stages/drag",
    "stages/film",
    "stages/shear_thinning",
    "stages/simd",
    "stages/stress",
    "stages/thermal_couette",
    "stages/traction",
    "stages/vector_math",
    "stages/viscosity",
)

declare_members()
setup(ext_modules=[kernel(name) for name in KERNELS])
