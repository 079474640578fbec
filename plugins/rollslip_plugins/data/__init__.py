"""Oils and bearings by name, each with source and range."""

from typing import Final

from rollslip.datasets import Scatter

__all__ = ["PROFILE_DEPTH", "RIB_SCATTER"]

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

#: Scatter of the contacts with ribs of bearings by their designation. Doubling the deviations would double what the
#: ribs' geometry adds to a band.
RIB_SCATTER: Final = (
    Scatter(
        quantity="ribs.height",
        distribution="lognormal",
        parameters={"deviation_of_ln": 0.15},
        grade="(D)",
        source="0.08 to 0.13 of the diameter of a roller, on ribs of 0.2 of it; SKF's term for axial load fits 0.10",
    ),
    Scatter(
        quantity="ribs.opening_angle",
        distribution="lognormal",
        parameters={"deviation_of_ln": 0.4},
        grade="(D)",
        source="0.25 to 1 deg of open ribs; makers do not state theirs",
    ),
)
