"""Blend of two traction models by the film parameter: boundary friction below, hydrodynamic above, both between."""

from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.chain import stage
from rollslip.fields import FieldError, non_negative, parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import POSITIVE, Domain, TractionModel, submodel
from rollslip_kernels import traction as compiled
from rollslip_kernels.slices import COLUMNS, Slices
from rollslip_plugins.boundary import Kragelsky
from rollslip_plugins.hydrodynamic import Muraki


@attrs.frozen(kw_only=True)
class LambdaBlend(TractionModel):
    """Blend by the film parameter Lambda = h/(1.25 sqrt(Ra1^2 + Ra2^2)) after Sakaguchi and Ueno.

    mu = mu_bd below Lambda_bd, mu_hd from Lambda_hd on, and between them
    mu_hd + (mu_bd - mu_hd) ((Lambda - Lambda_hd)/(Lambda_bd - Lambda_hd))^m. A child is evaluated only on the slices
    that need it. The limits 0.01 and 1.5 are of grade C.

    Raises
    ------
    FieldError
        If the limits are not in order.
    """

    name: ClassVar[str] = "lambda-blend"
    equation: ClassVar[str] = "mu = mu_hd + (mu_bd - mu_hd) ((Lambda - Lambda_hd)/(Lambda_bd - Lambda_hd))^m"
    references: ClassVar[tuple[str, ...]] = (
        "Sakaguchi T., Ueno K. Dynamic analysis of cage behavior in a cylindrical roller bearing. "
        "NTN Technical Review 71, 2003.",
    )

    boundary: TractionModel = submodel("traction", factory=Kragelsky, doc="traction model of boundary friction")
    hydrodynamic: TractionModel = submodel("traction", factory=Muraki, doc="traction model of the full film")
    boundary_limit: float = parameter(
        default=0.01, unit="1", validator=non_negative, doc="Lambda_bd: boundary friction alone up to here"
    )
    hydrodynamic_limit: float = parameter(
        default=1.5, unit="1", validator=positive, doc="Lambda_hd: full film from here on"
    )
    exponent: float = parameter(default=6.0, unit="1", validator=positive, doc="power m of the blend")

    def __attrs_post_init__(self) -> None:
        if not self.hydrodynamic_limit > self.boundary_limit:
            raise FieldError(
                "hydrodynamic_limit",
                f"must be above boundary_limit = {self.boundary_limit:g}, not {self.hydrodynamic_limit:g}",
            )

    @property
    def reads(self) -> frozenset[str]:  # type: ignore[override]
        """What the children read, and what makes the film parameter."""
        return self.boundary.reads | self.hydrodynamic.reads | {"film_thickness", "roughness"}

    @property
    def domain(self) -> Domain:  # type: ignore[override]
        """Where both children and the film parameter are defined."""
        both: dict[str, tuple[float, float]] = {"film_thickness": POSITIVE, "roughness": POSITIVE}
        for limits in (self.boundary.domain, self.hydrodynamic.domain):
            for member, (low, high) in limits.items():
                other_low, other_high = both.get(member, (low, high))
                both[member] = (max(low, other_low), min(high, other_high))
        return MappingProxyType(both)

    @property
    def full_film_from(self) -> float:
        """Film parameter from which on no boundary friction takes part."""
        return self.hydrodynamic_limit

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient; each child sees only the slices that need it."""
        film_parameter = slices.film_thickness / slices.conditions.roughness
        band = self.hydrodynamic_limit - self.boundary_limit
        share = np.clip((self.hydrodynamic_limit - film_parameter) / band, 0.0, 1.0) ** self.exponent
        boundary = _where(self.boundary, slices, share > 0)
        hydrodynamic = _where(self.hydrodynamic, slices, share < 1)
        slices.friction[...] = hydrodynamic + (boundary - hydrodynamic) * share

    def kernel(self) -> object:
        """Return the compiled form, with each child's compiled form or a call of its NumPy form."""
        return compiled.lambda_blend(
            stage(self.boundary),
            stage(self.hydrodynamic),
            self.boundary_limit,
            self.hydrodynamic_limit,
            self.exponent,
        )


def _where(model: TractionModel, slices: Slices, needed: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> np.ndarray:
    """Friction of the needed slices after a model, 0 elsewhere."""
    result = np.zeros(needed.shape)
    if np.any(needed):
        # a view on a user's arrays has no more columns than it was given
        columns = {name: getattr(slices, name)[needed] for name in COLUMNS if hasattr(slices, name)}
        part = Slices.of_columns(slices.conditions, columns)
        model.evaluate(part)
        result[needed] = part.friction
    return result


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the blend."""
    return [LambdaBlend]
