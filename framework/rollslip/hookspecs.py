"""The hooks that a plugin may implement: one per kind, which returns the objects that the plugin offers.

The base class of each kind is in `rollslip.catalogue.kinds`; it is not imported here.
"""

from collections.abc import Callable, Iterable
from typing import Any, Final

import pluggy

hookspec = pluggy.HookspecMarker("rollslip")
hookimpl = pluggy.HookimplMarker("rollslip")

#: Name of a hook -> objects that a plugin offers by it: classes derived from a base class, or its instances.
HOOKS: Final = {
    "contact_models": "Contact models: classes derived from `rollslip.models.ContactModel`.",
    "film_models": "Film models: classes derived from `rollslip.models.FilmModel`.",
    "pressure_models": "Models of the pressure in a film: classes derived from `rollslip.models.PressureModel`.",
    "traction_models": "Traction models: classes derived from `rollslip.models.TractionModel`.",
    "pressure_viscosity_laws": "Laws of viscosity under pressure: classes derived from "
    "`rollslip.lubricant.pressure.PressureViscosity`.",
    "rib_models": "Friction of ribs: classes derived from `rollslip.models.RibModel`.",
    "ring_models": "Models of rings that yield: classes derived from `rollslip.rings.RingModel`.",
    "drag_models": "Drag models: classes derived from one of `rollslip.models.Drag`.",
    "integrator_models": "Integrators: classes derived from `rollslip.models.IntegratorModel`.",
    "thermal_models": "Thermal models: classes derived from `rollslip.studies.thermal_balance.model.ThermalModel`.",
    "damage_models": "Damage models: classes derived from `rollslip.studies.surface_damage.model.DamageModel`.",
    "life_models": "Models of the rating life: classes derived from `rollslip.studies.rating_life.model.LifeModel`.",
    "torque_formulas": "Formulas of the friction torque: classes derived from "
    "`rollslip.studies.steady_slip.torque.TorqueFormula`.",
    "loss_models": "Losses beside the rollers: classes derived from `rollslip.studies.steady_slip.loss.LossModel`.",
    "engines": "Engines of sweeps: classes derived from `rollslip.engine.Engine`.",
    "studies": "Studies: classes derived from `rollslip.studies.study.Study`.",
    "campaigns": "Campaigns: classes derived from `rollslip.planning.campaign.Campaign`.",
    "accounts": "Accounts, one for each study that it offers: values of `rollslip.results.account.Account`.",
    "scene_formats": "File formats of scenes: values of `rollslip.scene.formats.SceneFormat`.",
    "lubricants": "Lubricants: values of `rollslip.lubricant.Lubricant`.",
    "bearings": "Bearings: values of `rollslip.datasets.BearingData`.",
    "measurements": "Data sets: values of `rollslip_campaigns.measurement.Measurement`.",
    "scenes": "Scenes: values of `rollslip.datasets.SceneData`.",
}


def _hook(name: str, offered: str) -> Callable[[], Iterable[Any]]:
    """Return the specification of a hook, a function without arguments as plugins implement it."""

    def hook() -> Iterable[Any]:
        raise NotImplementedError(name)  # pluggy calls the implementations of plugins

    hook.__name__ = name
    hook.__qualname__ = name
    hook.__doc__ = offered
    marked: Callable[[], Iterable[Any]] = hookspec(hook)
    return marked


globals().update({name: _hook(name, offered) for name, offered in HOOKS.items()})
