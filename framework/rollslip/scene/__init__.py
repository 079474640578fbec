"""What the user wrote: a scene as frozen, checked values, and how it is read and changed."""

from rollslip.scene.values import (
    Accuracy,
    Bearing,
    FrozenTable,
    LubricantTable,
    Material,
    ModelChoice,
    Models,
    Operation,
    Plugins,
    Profile,
    Scene,
    Surface,
    resolved,
    scene_hash,
)

__all__ = [
    "Accuracy",
    "Bearing",
    "FrozenTable",
    "LubricantTable",
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
