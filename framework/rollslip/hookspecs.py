"""The hooks a plugin may implement: one per kind, and each only collects what the plugin offers.

What a thing of a kind has to be, its base class says (`rollslip.catalogue.kinds`); nothing of it is imported here.
"""

from collections.abc import Iterable
from typing import Any

import pluggy

hookspec = pluggy.HookspecMarker("rollslip")
hookimpl = pluggy.HookimplMarker("rollslip")


@hookspec
def contact_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Contact models this plugin offers: classes derived from `rollslip.models.ContactModel`."""


@hookspec
def film_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Film models this plugin offers: classes derived from `rollslip.models.FilmModel`."""


@hookspec
def pressure_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Models of the pressure in a film of this plugin: classes derived from `rollslip.models.PressureModel`."""


@hookspec
def traction_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Traction models this plugin offers: classes derived from `rollslip.models.TractionModel`."""


@hookspec
def pressure_viscosity_laws() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Laws of viscosity under pressure: classes derived from `rollslip.lubricant.pressure.PressureViscosity`."""


@hookspec
def ring_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Models of rings that yield of this plugin: classes derived from `rollslip.rings.RingModel`."""


@hookspec
def drag_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Drag models this plugin offers: classes derived from one of `rollslip.models.Drag`."""


@hookspec
def integrator_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Integrators this plugin offers: classes derived from `rollslip.models.IntegratorModel`."""


@hookspec
def thermal_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Thermal models this plugin offers: classes derived from `rollslip.studies.thermal_balance.model.ThermalModel`."""


@hookspec
def damage_models() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Damage models this plugin offers: classes derived from `rollslip.studies.surface_damage.model.DamageModel`."""


@hookspec
def torque_formulas() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Formulas of the friction torque: classes derived from `rollslip.studies.steady_slip.torque.TorqueFormula`."""


@hookspec
def separators() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """What may keep rollers apart: classes derived from `rollslip.bearing.cage.Separator`."""


@hookspec
def engines() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Engines of sweeps this plugin offers: classes derived from `rollslip.engine.Engine`."""


@hookspec
def studies() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Studies this plugin offers: classes derived from `rollslip.studies.study.Study`."""


@hookspec
def campaigns() -> Iterable[type[Any]]:  # type: ignore[empty-body]
    """Campaigns this plugin offers: classes derived from `rollslip.planning.campaign.Campaign`."""


@hookspec
def accounts() -> Iterable[Any]:  # type: ignore[empty-body]
    """Accounts this plugin offers, one for each study that it offers: values of `rollslip.results.account.Account`."""


@hookspec
def scene_formats() -> Iterable[Any]:  # type: ignore[empty-body]
    """File formats of scenes this plugin offers: values of `rollslip.scene.formats.SceneFormat`."""


@hookspec
def lubricants() -> Iterable[Any]:  # type: ignore[empty-body]
    """Lubricants this plugin offers: values of `rollslip.lubricant.Lubricant`."""


@hookspec
def bearings() -> Iterable[Any]:  # type: ignore[empty-body]
    """Bearings this plugin offers: values of `rollslip.datasets.BearingData`."""


@hookspec
def measurements() -> Iterable[Any]:  # type: ignore[empty-body]
    """Data sets this plugin offers: values of `rollslip_campaigns.measurement.Measurement`."""


@hookspec
def surfaces() -> Iterable[Any]:  # type: ignore[empty-body]
    """Surfaces this plugin offers: values of `rollslip.datasets.SurfaceData`."""


@hookspec
def fits() -> Iterable[Any]:  # type: ignore[empty-body]
    """Fits this plugin offers: values of `rollslip.datasets.FitData`."""
