"""Interface of models: base classes, domains and ranges of validity of laws, and values that they take from a scene."""

from rollslip.models.domains import (
    FINITE,
    NO_LIMITS,
    NON_NEGATIVE,
    POSITIVE,
    Domain,
    evaluate_arrays,
    in_unit,
    interval,
)
from rollslip.models.scene_values import SCENE_VALUES, from_scene, left_to_scene
from rollslip.models.stages import (
    ContactModel,
    Drag,
    DragModel,
    FilmModel,
    IntegratorModel,
    PocketFriction,
    PressureModel,
    ResistanceModel,
    RibContact,
    RibModel,
    SliceModel,
    TractionModel,
    common_domain,
    submodel,
)
from rollslip.models.validity import (
    ISOTHERMAL,
    MEAN_PRESSURE,
    SMOOTH,
    Tabled,
    Validity,
    in_regime,
)
from rollslip.references import ReferenceValue

__all__ = [
    "FINITE", "ISOTHERMAL", "MEAN_PRESSURE", "NON_NEGATIVE", "NO_LIMITS", "POSITIVE", "SCENE_VALUES", "SMOOTH",
    "ContactModel", "Domain", "Drag", "DragModel", "FilmModel", "IntegratorModel", "PocketFriction", "PressureModel",
    "ReferenceValue", "ResistanceModel", "RibContact", "RibModel", "SliceModel", "Tabled", "TractionModel", "Validity",
    "common_domain", "evaluate_arrays", "from_scene", "in_regime", "in_unit", "interval", "left_to_scene", "submodel",
]  # fmt: skip
