"""Build the compiled form; everything else is in pyproject.toml."""

import sys

import rollslip
from setuptools import Extension, setup

HERE = "src/rollslip_plain_c_film"
FLAGS = [] if sys.platform == "win32" else ["-O3", "-fno-math-errno", "-fno-trapping-math"]

setup(
    ext_modules=[
        Extension(
            "rollslip_plain_c_film._kernel",
            [f"{HERE}/module.c", f"{HERE}/law.c"],
            depends=[f"{HERE}/law.h"],
            include_dirs=[HERE, rollslip.get_include()],
            extra_compile_args=FLAGS,
        )
    ]
)
