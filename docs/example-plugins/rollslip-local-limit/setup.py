"""Build the compiled form; everything else is in pyproject.toml."""

import sys

import rollslip
from Cython.Distutils import Extension
from setuptools import setup

# Without the two -fno- flags loops do not vectorise; -ffast-math would also change results.
FLAGS = [] if sys.platform == "win32" else ["-O3", "-fno-math-errno", "-fno-trapping-math"]

setup(
    ext_modules=[
        Extension(
            "rollslip_local_limit._kernel",
            ["src/rollslip_local_limit/_kernel.pyx"],
            include_dirs=[rollslip.get_include()],
            cython_include_dirs=[rollslip.get_include()],
            extra_compile_args=FLAGS,
            cython_directives={"language_level": 3, "cdivision": True},
        )
    ]
)
