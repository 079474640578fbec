"""Viscosity of the oil under pressure: the interface of such laws, a stage of the chain between film and traction.

- The law belongs to the oil, not to the models of the contact: a scene that changes its oil changes the law, and every
  traction model, built-in or third-party, reads the same two columns with any law.
- A law describes how viscosity *rises* with pressure. eta0 and beta0 at ambient pressure are properties of the oil for
  every law, so that laws differ only under pressure.
- A law is a model that a package offers, as contact and film models are. An oil without a law has `DEFAULT_LAW`.
"""

import abc
import importlib
import importlib.metadata
import math
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip.fields import choice_of, non_negative, positive, refuse_if
from rollslip.models import SliceModel
from rollslip_kernels.slices import Conditions, Slices

Array = NDArray[np.float64]
NO_SLOPES: Final[Mapping[str, float]] = MappingProxyType({})

#: Name of the law of an oil that states none.
DEFAULT_LAW: Final = "roelands"
#: Definitions of alpha: the slope of ln(eta) at zero pressure, or alpha* = 1/integral(eta0/eta dp) for film formulas.
ALPHAS: Final = ("tangent", "film")


class PressureViscosity(SliceModel):
    """Viscosity at the pressure of a slice and the inlet temperature, and its fall with temperature there."""

    writes = frozenset({"film_viscosity", "film_thermoviscosity"})

    @abc.abstractmethod
    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity [Pa s] and its fall -dln(eta)/dT [1/K] at pressures [Pa] of any shape.

        It raises `DomainError` for a pressure at which the law is not defined.
        """

    def log_kernel(self) -> object | None:
        """Return a compiled form that fills ``film_viscosity`` with ln(eta/(Pa s)), or None: then `kernel` is called.

        A traction law that takes several pressures of a contact requires it. It needs no exponential and overflows at
        no pressure.
        """
        return None

    def coefficient(self, temperature: float) -> float:
        """Return dln(eta)/dp at ambient pressure [1/Pa] if the law determines it; nan if it is the alpha of the oil."""
        return math.nan

    def caution(self) -> str:
        """Return a warning for users of the law, as a clause; empty if there is none."""
        return ""

    def of_oil(self, alpha: str = "tangent", factor: float = 1.0) -> "PressureViscosity":
        """Return the law with the values of an oil.

        ``alpha`` is one of `ALPHAS`, for a law with a field by `alpha_of_oil`; ``factor`` multiplies ln(eta/eta0), for
        a law with a field by `factor_of_oil`, and is refused by other laws.
        """
        law: Any = self
        own = {
            a.name: a.metadata["of_oil"] for a in attrs.fields(type(law)) if "of_oil" in a.metadata
        }
        refuse_if(
            factor != 1.0 and "factor" not in own.values(),
            "pressure_exponent_factor",
            f"law {self.name!r} takes none; leave it out",
        )
        values = {"alpha": alpha, "factor": factor}
        changes = {
            name: values[key] for name, key in own.items() if getattr(self, name) != values[key]
        }
        if changes:
            law = attrs.evolve(law, **changes)
        return law  # type: ignore[no-any-return]

    def evaluate(self, slices: Slices) -> None:
        """Fill the columns of the viscosity and its fall with temperature."""
        slices.film_viscosity[...], slices.film_thermoviscosity[...] = self.at(
            slices.conditions, slices.pressure
        )


@cache
def built_in_law(name: str) -> type[PressureViscosity]:
    """Return a law that comes with rollslip, by its name; the reader of scenes finds those of all packages."""
    points = importlib.metadata.distribution("rollslip").entry_points.select(
        group="rollslip.pressure_viscosity"
    )
    module = importlib.import_module({point.name: point.value for point in points}[name])
    law: type[PressureViscosity] = next(
        m for m in vars(module).values() if getattr(m, "name", None) == name
    )
    return law


def default_law() -> PressureViscosity:
    """Return the law of an oil that states none."""
    return built_in_law(DEFAULT_LAW)()


def alpha_of_oil() -> Any:
    """Declare the definition of alpha that a law uses, one of `ALPHAS`: it is set by the oil and not by a scene."""
    return attrs.field(
        default="tangent",
        kw_only=True,
        validator=choice_of(*ALPHAS),
        metadata={"key": None, "unit": None, "doc": "which alpha the oil gives", "of_oil": "alpha"},
    )


def factor_of_oil() -> Any:
    """Declare the factor on ln(eta/eta0) [1] that a law uses: it is set by the oil and not by a scene."""
    return attrs.field(
        default=1.0,
        kw_only=True,
        validator=positive,
        metadata={"key": None, "unit": "1", "doc": "factor f on ln(eta/eta0)", "of_oil": "factor"},
    )


def from_oil() -> Any:
    """Declare a submodel that is the law of the oil: it is set when the bearing is assembled, and not by a scene."""
    return attrs.field(
        factory=default_law,
        kw_only=True,
        metadata={"key": None, "unit": None, "doc": "the law of the oil", "from_oil": True},
    )


def slope_of_oil(doc: str) -> Any:
    """Declare a slope with pressure [1] of the oil: it is set when the bearing is assembled, and not by a scene."""
    return attrs.field(
        default=0.0,
        kw_only=True,
        validator=non_negative,
        metadata={"key": None, "unit": "1", "doc": doc, "slope_of_oil": True},
    )


def with_law(model: Any, law: PressureViscosity, slopes: Mapping[str, float] = NO_SLOPES) -> Any:
    """Return a model whose fields for the law and slopes of the oil, and those of its submodels, are set."""
    changes: dict[str, Any] = {}
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if attribute.metadata.get("from_oil"):
            changes[attribute.name] = law
        elif attribute.metadata.get("slope_of_oil") and slopes.get(attribute.name, value) != value:
            changes[attribute.name] = slopes[attribute.name]
        elif (
            isinstance(value, SliceModel) and (changed := with_law(value, law, slopes)) is not value
        ):
            changes[attribute.name] = changed
    return attrs.evolve(model, **changes) if changes else model


def without_slope(model: Any, name: str) -> list[str]:
    """Return the names of a model and submodels that read a property of the oil but not its slope with pressure."""
    fields = getattr(type(model), "__attrs_attrs__", ())
    children = [getattr(model, a.name) for a in fields if "kind" in a.metadata]
    if children:  # the model reads what its submodels read
        return [law for child in children for law in without_slope(child, name)]
    takes = any(a.name == f"{name}_slope" and a.metadata.get("slope_of_oil") for a in fields)
    return [] if takes or name not in model.reads else [model.name]
