"""Surfaces by name; makers print none, so that all of it is recalled of measured bearings, (C)."""

from rollslip.datasets import Surface, SurfaceData
from rollslip.hookspecs import hookimpl

_SOURCE = "Ra as recalled of measured cylindrical roller bearings (C): {}. Makers print none; measure yours."
_VALIDITY = "New, run-in raceways; the roughness that counts lies along the rolling direction."

ground = SurfaceData(
    name="ground",
    description="Ground and honed raceways of a usual bearing, Ra 0.16 um, rollers 0.1 um",
    source=_SOURCE.format("raceways 0.1 to 0.25 um, rollers 0.05 to 0.15 um"),
    validity=_VALIDITY,
    surface=Surface(),
)
superfinished = SurfaceData(
    name="superfinished",
    description="Superfinished raceways of a precision bearing, Ra 0.05 um, rollers 0.03 um",
    source=_SOURCE.format("raceways 0.03 to 0.08 um, rollers 0.02 to 0.05 um"),
    validity=_VALIDITY,
    surface=Surface(inner_raceway_roughness=5e-8, outer_raceway_roughness=5e-8, roller_roughness=3e-8),
)


@hookimpl
def surfaces() -> list[SurfaceData]:
    """Offer the surfaces of this module."""
    return [ground, superfinished]
