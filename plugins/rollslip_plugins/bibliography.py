"""The publications that models and data of the box rest on, by their keys in ``bibliography.bib``."""

from pathlib import Path
from typing import Final

from rollslip.references import Reference, read_bibliography

_WRITTEN: Final = read_bibliography(Path(__file__).with_suffix(".bib"))


def __getattr__(name: str) -> Reference:
    if name not in _WRITTEN:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _WRITTEN[name]
