"""Basic rating life of ISO 281 and the largest load by it and by the static rating, in closed form."""

import math
from typing import TYPE_CHECKING, Final

from rollslip.studies.rating_life.equivalent_load import (
    dynamic_equivalent_load,
    static_equivalent_load,
)

if TYPE_CHECKING:
    from rollslip.scene.values import Scene

__all__ = ["HOURS", "STATIC_SAFETY", "basic_life", "largest_load"]

#: Life that is required by default [h]. SKF's guideline has 20,000 to 30,000 h for machines that run eight hours a day
#: (C).
HOURS: Final = 20_000.0
#: Static rating over the largest load by default. SKF's guideline has 1 to 3 for roller bearings, by how quietly they
#: have to run (C).
STATIC_SAFETY: Final = 1.5
#: Inverse of the exponent of the life in the load (ISO 281).
_LOAD_EXPONENT: Final = 0.3


def basic_life(scene: "Scene") -> float:
    """Return the time that nine of ten bearings reach [s], (C/P)^(10/3) million revolutions.

    It is infinite without load, and at rest.

    Parameters
    ----------
    scene : Scene
        Bearing, load and speeds.
    """
    from rollslip.studies.rating_life.model import REVOLUTIONS, dynamic_rating

    load = dynamic_equivalent_load(scene)
    speed = abs(scene.operation.inner_speed - scene.operation.outer_speed)
    if load == 0.0 or speed == 0.0:
        return math.inf
    rating, _ = dynamic_rating(scene.bearing)
    revolutions = REVOLUTIONS * (rating / load) ** (1.0 / _LOAD_EXPONENT)
    return float(2.0 * math.pi * revolutions / speed)


def largest_load(scene: "Scene") -> dict[str, float | str]:
    """Return attributes of a result: the largest load with the default life and static safety [N], and which limits it.

    P = C (1e6/N)^(3/10) with N revolutions of the rings relative to each other, and P0 at most C_0/1.5. The load is the
    radial one, or the axial one where there is no radial load; of a tapered bearing both retain their ratio.

    Parameters
    ----------
    scene : Scene
        Bearing and speeds.
    """
    from rollslip.studies.rating_life.model import REVOLUTIONS, dynamic_rating

    speed = abs(scene.operation.inner_speed - scene.operation.outer_speed)
    revolutions = 3600.0 * HOURS * speed / (2.0 * math.pi)
    operation = scene.operation
    # loads over the equivalent ones
    dynamic_ratio = 1.0
    static_ratio = 1.0
    if scene.bearing.contact_angle is not None:
        dynamic_ratio = operation.load / dynamic_equivalent_load(scene)
        static_ratio = operation.load / static_equivalent_load(scene)
    static = scene.bearing.static_rating / STATIC_SAFETY * static_ratio
    rating, _ = dynamic_rating(scene.bearing)
    rating *= dynamic_ratio
    by_life = rating * (REVOLUTIONS / revolutions) ** _LOAD_EXPONENT if revolutions else math.inf
    limit = f"static rating over {STATIC_SAFETY:g}"
    if by_life < static:
        limit = f"{HOURS:,.0f} h by ISO 281"
    return {"largest_load": min(by_life, static), "largest_load_limit": limit}
