"""Compiled loops and laws; knows no plugin and imports nothing of the framework."""

from pathlib import Path


def get_include() -> str:
    """Return the folder of ``rollslip.h`` and the shared ``.pxd`` files, for packages that compile against them."""
    return str(Path(__file__).parent / "include")
