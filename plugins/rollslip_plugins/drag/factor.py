"""The factor of a drag: 1 by default, so that a known size can be given, and its scatter."""

from typing import Any

from rollslip.fields import Scatter, non_negative, parameter


def scattering_factor(deviation: float, source: str) -> Any:
    """Declare the factor of a drag, with the standard deviation of its logarithm and what that rests on (D)."""
    return parameter(
        default=1.0,
        unit="1",
        validator=non_negative,
        doc="factor on the whole of it, for calibration and for scatter",
        usual=(0.02, 50),
        possible=(0, 1e4),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": deviation},
            grade="(D)",
            source=source,
        ),
    )
