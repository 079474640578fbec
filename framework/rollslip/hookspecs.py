"""The hooks a plugin may implement: one per kind, and each only collects what the plugin offers."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from rollslip.datasets import BearingData, SurfaceData
    from rollslip.engine import Engine
    from rollslip.lubricant.oil import Lubricant
    from rollslip.models import ContactModel, DragModel, FilmModel, IntegratorModel, TractionModel

hookspec = pluggy.HookspecMarker("rollslip")
hookimpl = pluggy.HookimplMarker("rollslip")


@hookspec
def contact_models() -> "Iterable[type[ContactModel]]":  # type: ignore[empty-body]
    """Contact models this plugin offers."""


@hookspec
def film_models() -> "Iterable[type[FilmModel]]":  # type: ignore[empty-body]
    """Film models this plugin offers."""


@hookspec
def traction_models() -> "Iterable[type[TractionModel]]":  # type: ignore[empty-body]
    """Traction models this plugin offers."""


@hookspec
def drag_models() -> "Iterable[type[DragModel]]":  # type: ignore[empty-body]
    """Drag models this plugin offers."""


@hookspec
def integrator_models() -> "Iterable[type[IntegratorModel]]":  # type: ignore[empty-body]
    """Integrators this plugin offers."""


@hookspec
def engines() -> "Iterable[type[Engine]]":  # type: ignore[empty-body]
    """Engines of sweeps this plugin offers."""


@hookspec
def lubricants() -> "Iterable[Lubricant]":  # type: ignore[empty-body]
    """Lubricants this plugin offers."""


@hookspec
def bearings() -> "Iterable[BearingData]":  # type: ignore[empty-body]
    """Bearings this plugin offers."""


@hookspec
def surfaces() -> "Iterable[SurfaceData]":  # type: ignore[empty-body]
    """Surfaces this plugin offers."""
