"""Oils and bearings by name, each with source and range."""

from typing import Final

from rollslip.datasets import Scatter

__all__ = ["PROFILE_DEPTH"]

#: Scatter of the depth of an assumed profile: at 5 and 95 % that of an even pressure of 2.1 and 4.3 GPa. Doubling the
#: deviation would double what the profile adds to a band.
PROFILE_DEPTH: Final = Scatter(
    quantity="profile.depth_factor",
    distribution="lognormal",
    parameters={"deviation_of_ln": 0.45},
    grade="(D)",
    source="the drop for an even pressure goes with its square: that of ISO/TS 16281 is made for 3 GPa, and makers "
    "design for 2 to 4 GPa",
)
