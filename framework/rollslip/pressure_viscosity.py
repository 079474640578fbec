"""Deprecated: the laws of `rollslip.lubricant.pressure` under their former path."""

import warnings

from rollslip.errors import RollslipDeprecationWarning
from rollslip.lubricant.pressure import *  # noqa: F403

warnings.warn(
    "rollslip.pressure_viscosity is deprecated: import from rollslip.lubricant.pressure",
    RollslipDeprecationWarning,
    stacklevel=2,
)
