"""Equivalent radial loads of ISO 281 and ISO 76, of cylindrical and tapered rollers, in closed form."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rollslip.scene.values import Scene

__all__ = ["dynamic_equivalent_load", "equivalent_load", "static_equivalent_load"]


def equivalent_load(contact_angle: float, radial_load: float, axial_load: float) -> float:
    """Return the dynamic equivalent radial load P of ISO 281 [N].

    It is the radial load, but for tapered rollers 0.4 F_r + 0.4 F_a cot(a) where F_a/F_r exceeds e = 1.5 tan(a).

    Parameters
    ----------
    contact_angle : float
        Contact angle a of the outer raceway [rad]; 0 for cylindrical rollers.
    radial_load, axial_load : float
        Loads [N].
    """
    tangent = math.tan(contact_angle)
    if contact_angle == 0.0 or axial_load <= 1.5 * tangent * radial_load:
        return radial_load
    return 0.4 * radial_load + 0.4 * axial_load / tangent


def static_equivalent_load(scene: "Scene") -> float:
    """Return the static equivalent radial load P0 of ISO 76 [N].

    It is the radial load, but at least 0.5 F_r + 0.22 F_a cot(a) for tapered rollers.

    Parameters
    ----------
    scene : Scene
        Bearing and loads.
    """
    operation = scene.operation
    if scene.bearing.contact_angle is None:
        return operation.radial_load
    axial = 0.22 * (operation.axial_load or 0.0) / math.tan(scene.bearing.contact_angle)
    return max(operation.radial_load, 0.5 * operation.radial_load + axial)


def dynamic_equivalent_load(scene: "Scene") -> float:
    """Return the dynamic equivalent radial load of a scene [N].

    Parameters
    ----------
    scene : Scene
        Bearing and loads.
    """
    operation = scene.operation
    return equivalent_load(
        scene.bearing.contact_angle or 0.0, operation.radial_load, operation.axial_load or 0.0
    )
