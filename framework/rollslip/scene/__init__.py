"""What the user wrote: a scene as frozen, checked values, and how it is read and changed."""

from rollslip.geometry.bearing import Bearing
from rollslip.geometry.surfaces import Material, Profile, Surface
from rollslip.scene.supply import Lubrication
from rollslip.scene.values import (
    Accuracy,
    LubricantTable,
    ModelChoice,
    Models,
    Operation,
    Plugins,
    Scene,
)
from rollslip.structure import FrozenTable, resolved, scene_hash

__all__ = [
    "Accuracy",
    "Bearing",
    "FrozenTable",
    "LubricantTable",
    "Lubrication",
    "Material",
    "ModelChoice",
    "Models",
    "Operation",
    "Plugins",
    "Profile",
    "Scene",
    "Surface",
    "resolved",
    "scene_hash",
]
