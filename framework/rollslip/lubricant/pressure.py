"""How the oil's viscosity follows pressure: a stage of the oil's own, between film and traction.

- The law belongs to the oil, not to the models: a scene that changes its oil changes the law with it, and every
  traction model, ours or a stranger's, reads the same two columns whatever the law.
- A law says how viscosity *rises* with pressure. eta0 and beta0 at ambient pressure are the oil's, at any law, so that
  laws differ only where pressure comes in.
- A law is a model that a package offers, as contact and film are; what an oil has that names none is `DEFAULT_LAW`.
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

from rollslip.fields import FieldError, choice_of, non_negative, positive
from rollslip.models import SliceModel
from rollslip_kernels.slices import Conditions, Slices

Array = NDArray[np.float64]
NO_SLOPES: Final[Mapping[str, float]] = MappingProxyType({})

#: Law of an oil that names none.
DEFAULT_LAW: Final = "roelands"
#: Which alpha an oil gives: the slope of ln(eta) at no pressure, or alpha* = 1/integral(eta0/eta dp), that of films.
ALPHAS: Final = ("tangent", "film")


class PressureViscosity(SliceModel):
    """Viscosity at the pressure of a slice and the inlet temperature, and its fall with temperature there."""

    writes = frozenset({"film_viscosity", "film_thermoviscosity"})

    @abc.abstractmethod
    def at(self, conditions: Conditions, pressure: ArrayLike) -> tuple[Array, Array]:
        """Return viscosity [Pa s] and its fall -dln(eta)/dT [1/K] at pressures [Pa] of any shape.

        A pressure at which the law has no value is a `DomainError`.
        """

    def coefficient(self, temperature: float) -> float:
        """Return dln(eta)/dp at ambient pressure [1/Pa] if the law itself fixes it, else nan: it is the oil's alpha."""
        return math.nan

    def caution(self) -> str:
        """Return what to say at once to whoever takes the law, a clause; an empty string if there is nothing."""
        return ""

    def of_oil(self, alpha: str = "tangent", factor: float = 1.0) -> "PressureViscosity":
        """Return the law as an oil has it.

        ``alpha`` is one of `ALPHAS`, which a law asks for by `alpha_of_oil`; ``factor`` is that on ln(eta/eta0), which
        it takes by `factor_of_oil`, or refuses.
        """
        mine: Any = self
        own = {
            a.name: a.metadata["of_oil"] for a in attrs.fields(type(mine)) if "of_oil" in a.metadata
        }
        if factor != 1.0 and "factor" not in own.values():
            raise FieldError(
                "pressure_exponent_factor", f"law {self.name!r} takes none; leave it out"
            )
        given = {"alpha": alpha, "factor": factor}
        changes = {
            name: given[what] for name, what in own.items() if getattr(self, name) != given[what]
        }
        law: PressureViscosity = attrs.evolve(mine, **changes) if changes else self
        return law

    def evaluate(self, slices: Slices) -> None:
        """Fill viscosity and its fall with temperature."""
        slices.film_viscosity[...], slices.film_thermoviscosity[...] = self.at(
            slices.conditions, slices.pressure
        )


@cache
def law_of_the_box(name: str) -> type[PressureViscosity]:
    """Return a law that comes with rollslip, by its name; who reads a scene takes those of all packages."""
    points = importlib.metadata.distribution("rollslip").entry_points.select(
        group="rollslip.pressure_viscosity"
    )
    module = importlib.import_module({point.name: point.value for point in points}[name])
    law: type[PressureViscosity] = next(
        m for m in vars(module).values() if getattr(m, "name", None) == name
    )
    return law


def default_law() -> PressureViscosity:
    """Return the law of an oil that names none."""
    return law_of_the_box(DEFAULT_LAW)()


def alpha_of_oil() -> Any:
    """Declare which alpha a law takes, one of `ALPHAS`: no key of a scene, the oil says it."""
    return attrs.field(
        default="tangent",
        kw_only=True,
        validator=choice_of(*ALPHAS),
        metadata={"key": None, "unit": None, "doc": "which alpha the oil gives", "of_oil": "alpha"},
    )


def factor_of_oil() -> Any:
    """Declare the factor on ln(eta/eta0) [1] that a law takes: no key of a scene, the oil says it."""
    return attrs.field(
        default=1.0,
        kw_only=True,
        validator=positive,
        metadata={"key": None, "unit": "1", "doc": "factor on ln(eta/eta0)", "of_oil": "factor"},
    )


def from_oil() -> Any:
    """Declare the part of a model that is the oil's law: not a key of a scene, put in when the bearing is assembled."""
    return attrs.field(
        factory=default_law,
        kw_only=True,
        metadata={"key": None, "unit": None, "doc": "the law of the oil", "from_oil": True},
    )


def slope_of_oil(doc: str) -> Any:
    """Declare a slope with pressure [1] that is the oil's: no key of a scene, put in when the bearing is assembled."""
    return attrs.field(
        default=0.0,
        kw_only=True,
        validator=non_negative,
        metadata={"key": None, "unit": "1", "doc": doc, "slope_of_oil": True},
    )


def with_law(model: Any, law: PressureViscosity, slopes: Mapping[str, float] = NO_SLOPES) -> Any:
    """Return a model with the oil's law and slopes with pressure in it, and its children, where they ask for them."""
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
    """Return the names of a model and its children that read a property of the oil but not its slope with pressure."""
    fields = getattr(type(model), "__attrs_attrs__", ())
    children = [getattr(model, a.name) for a in fields if "kind" in a.metadata]
    if children:  # it reads what they read
        return [one for child in children for one in without_slope(child, name)]
    takes = any(a.name == f"{name}_slope" and a.metadata.get("slope_of_oil") for a in fields)
    return [] if takes or name not in model.reads else [model.name]
