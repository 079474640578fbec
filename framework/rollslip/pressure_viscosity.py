"""Deprecated: the laws of `rollslip.lubricant.pressure` under their former path."""

import warnings
from typing import Any

from rollslip.errors import RollslipDeprecationWarning
from rollslip.lubricant import pressure
from rollslip.lubricant.pressure import *  # noqa: F403

warnings.warn(
    "rollslip.pressure_viscosity is deprecated: import from rollslip.lubricant.pressure, and the laws from "
    f"{pressure.law_of_the_box(pressure.DEFAULT_LAW).__module__}",
    RollslipDeprecationWarning,
    stacklevel=2,
)


def __getattr__(name: str) -> Any:
    """Hand on what has moved further."""
    return getattr(pressure, name)
