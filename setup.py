"""Build the compiled kernels, on all cores; everything else is in pyproject.toml."""

import glob
import os
import re
import sys
import tempfile
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.errors import CCompilerError, PlatformError

sys.path.insert(0, str(Path(__file__).parent / "kernels"))
from declarations import write_declarations

HERE = "kernels/rollslip_kernels"
# Without the two -fno-...-math flags the block loops do not vectorise; -ffast-math would break exp's rounding. Fused
# multiply-adds stand in the source (RS_FMA) and are not left to the compiler, so that all sets that have them agree.
FLAGS = (
    []
    if sys.platform == "win32"
    else ["-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off"]
)
# Debug symbols are a quarter of the compiler's time and two thirds of a file's size; CFLAGS=-g keeps them.
SYMBOLS = (
    []
    if sys.platform == "win32" or re.search(r"(^| )-g", os.environ.get("CFLAGS", ""))
    else ["-g0"]
)
# ROLLSLIP_BOUNDSCHECK=1 checks every index of a memoryview, for a build under test.
CHECKED = os.environ.get("ROLLSLIP_BOUNDSCHECK") == "1"
# Cython's code of memoryviews, compiled once; without it it stands in every module, and is most of each.
SHARED = "rollslip_kernels._memoryviews"
# The message where the first file does not compile; {error} is that of the compiler.
NOT_COMPILED = """
rollslip: cannot be compiled here: {error}
A C compiler and the headers of Python are needed:
  Debian, Ubuntu  apt install gcc python3-dev
  Fedora          dnf install gcc python3-devel
  macOS           xcode-select --install
  Windows         Build Tools for Visual Studio 2022, "Desktop development with C++"
Without a compiler: pip install a wheel (rollslip-*.whl), or take the image or the conda package;
docs/start/install.rst says how.
"""


def kernel(name: str) -> Extension:
    shared = ["*.pxd", "include/*.*", "stages/*.pxd", "stages/table.h"]
    if name == "stages/simd":  # which alone compiles the laws
        shared.append("stages/*.h")
    if name.startswith("motion/"):
        shared += ["motion/*.pxd", "motion/*.h"]
    return Extension(
        f"rollslip_kernels.{name.replace('/', '.')}",
        [f"{HERE}/{name}.pyx"],
        depends=sorted({file for pattern in shared for file in glob.glob(f"{HERE}/{pattern}")}),
        include_dirs=[HERE, f"{HERE}/include"],
        extra_compile_args=FLAGS + SYMBOLS,
    )


class BuildOnAllCores(build_ext):
    """Translates all modules, then compiles all, each with as many at a time as there are cores, or as -j says.

    Cython is called here and not before `setup`, with which a source distribution would have C and no .pyx files.
    """

    def finalize_options(self):
        super().finalize_options()
        if self.parallel is None:
            self.parallel = (
                len(os.sched_getaffinity(0))
                if hasattr(os, "sched_getaffinity")
                else os.cpu_count() or 1
            )

    def build_extensions(self):
        self.check_compiler()
        extensions = {extension.name: extension for extension in self.extensions}
        extensions[SHARED].sources = [
            f"{HERE}/_memoryviews.c"
        ]  # which is made here, beside the others
        translated = cythonize(
            self.extensions,
            nthreads=self.parallel,  # processes
            force=self.force,
            quiet=not self.verbose,
            include_path=[HERE, f"{HERE}/include", f"{HERE}/stages", f"{HERE}/motion"],
            compiler_directives={
                "language_level": 3,
                "boundscheck": CHECKED,
                "wraparound": False,
                "cdivision": True,
                "initializedcheck": CHECKED,
                "annotation_typing": False,  # annotations are for the stubs
            },
            shared_utility_qualified_name=SHARED,
        )
        for extension in translated:
            extensions[extension.name].sources = extension.sources
        super().build_extensions()

    def check_compiler(self):
        """Compile one line against the headers of Python; exit with what is needed where that fails."""
        with tempfile.TemporaryDirectory() as folder:
            probe = Path(folder, "probe.c")
            probe.write_text("#include <Python.h>\n")
            try:
                self.compiler.compile([str(probe)], output_dir=folder)
            except (CCompilerError, PlatformError) as error:
                sys.exit(NOT_COMPILED.format(error=error))


# What takes longest is begun first.
KERNELS = (
    "stages/simd",
    "motion/rosenbrock",
    "motion/spin",
    "motion/system",
    "motion/leapfrog",
    "motion/planar",
    "chain",
    "motion/carried",
    "motion/raceway",
    "motion/varying",
    "motion/pocket",
    "equilibrium",
    "gauss",
    "layout",
    "stages/blend",
    "stages/contact",
    "stages/drag",
    "stages/film",
    "stages/shear_thinning",
    "stages/stress",
    "stages/thermal_couette",
    "stages/traction",
    "stages/vector_math",
    "stages/viscosity",
)

if __name__ == "__main__":  # where processes are not forked they read this file again
    write_declarations(Path(HERE))
    extensions = [kernel(name) for name in KERNELS]
    extensions.insert(1, Extension(SHARED, [], extra_compile_args=FLAGS + SYMBOLS))
    setup(ext_modules=extensions, cmdclass={"build_ext": BuildOnAllCores})
