"""Hydrodynamic traction of an Eyring fluid: Muraki's closed form, the exact Maxwell-Eyring stress, no elasticity."""

import abc
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rollslip.fields import in_range, parameter
from rollslip.hookspecs import hookimpl
from rollslip.models import POSITIVE, Domain, TractionModel
from rollslip.references import KLEBANOV
from rollslip_kernels.slices import Slices
from rollslip_kernels.stages import traction as compiled
from rollslip_plugins.traction.heating import HEATED, flash_factor
from rollslip_plugins.traction.stress import eyring_stress, maxwell_eyring_stress, muraki_stress

Array = NDArray[np.float64]

#: Relative error of the exact law by short series.
_SHORT_SERIES = 1e-6
MURAKI = "Muraki M. (1987, 1992), as cited by Klebanov et al. (2022)."


class _EyringFluid(TractionModel, abc.ABC):
    """Traction mu = tau0 S/p of a stress law S(sigma, D, Phi).

    sigma = eta V/(tau0 h), D = eta u/(Gamma b), Phi = beta zeta tau0^2 h/eta, with eta and beta = -dln(eta)/dT at the
    mean pressure after the oil's law, zeta = flash sqrt(b/(pi u))/sqrt(K rho c) + h/(12 K_f).
    """

    domain: Domain = MappingProxyType({**HEATED, "eyring_stress": POSITIVE, "shear_modulus": POSITIVE})
    reads = frozenset(domain)
    flash: float

    @abc.abstractmethod
    def dimensionless_stress(self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
        """Return the mean shear stress over tau0, S(sigma, D, Phi); arguments broadcast.

        Parameters
        ----------
        strain_rate : array_like
            sigma = eta V/(tau0 h), any sign.
        deborah : array_like
            D = eta u/(Gamma b), >= 0.
        heating : array_like
            Phi = beta zeta tau0^2 h/eta, >= 0.
        """

    def groups(self, slices: Slices) -> Mapping[str, Array]:
        """Return sigma, D and Phi of slices, by the names that `dimensionless_stress` has for them."""
        c, s = slices.conditions, slices
        eta = s.film_viscosity
        zeta = self.flash / (c.effusivity * np.sqrt(np.pi)) * np.sqrt(s.half_width / s.rolling_speed)
        zeta = zeta + s.film_thickness / (12 * c.conductivity)
        # a product, since a power of Python's floats raises where it overflows
        phi = s.film_thermoviscosity * zeta * (c.eyring_stress * c.eyring_stress) * s.film_thickness / eta
        deborah = eta * s.rolling_speed / (c.shear_modulus * s.half_width)
        strain_rate = eta * s.sliding_speed / (c.eyring_stress * s.film_thickness)
        return {"strain_rate": strain_rate, "deborah": deborah, "heating": phi}

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        stress = self.dimensionless_stress(**self.groups(slices))
        slices.friction[...] = slices.conditions.eyring_stress / slices.pressure * stress


@attrs.frozen(kw_only=True)
class Muraki(_EyringFluid):
    """Closed form of Muraki: linear elastic ramp, then an Eyring plateau with mean-stress heating.

    With L = asinh(sigma), a = 1 + Phi sigma: (D Phi/4) y^2 - a y + L = 0 and S = y - D y^2/(4 sigma), and
    S = sigma/D where the ramp does not finish. The misprint in the denominator of Eq. (8) of the paper is corrected,
    and asinh(sigma) stands for ln(2 sigma), which is negative below sigma = 1/2.

    Range: heated films (Phi sigma S not small) come out 14 to 41 % low; D of order 1 up to 32 % off.
    """

    name: ClassVar[str] = "muraki"
    equation: ClassVar[str] = (
        "mu = tau0 S/p, S = y - D y^2/(4 sigma), (D Phi/4) y^2 - (1 + Phi sigma) y + asinh(sigma) = 0"
    )
    references: ClassVar[tuple[str, ...]] = (KLEBANOV, MURAKI)
    solved_by: ClassVar[str | None] = "maxwell-eyring"
    flash: float = flash_factor()

    def dimensionless_stress(self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
        """Return S of the closed form."""
        return muraki_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.muraki(self.flash)


@attrs.frozen(kw_only=True)
class MaxwellEyring(_EyringFluid):
    """Exact solution of the Maxwell-Eyring equation with mean-stress heating, which the closed forms approximate.

    D dS/dX + exp(Phi sigma Sbar) sinh S = sigma, X in [0, 2], S(0) = 0, Sbar the mean of S; solved in closed form
    with dilogarithms and Halley's method to 1e-13, or where `accuracy` allows to 1e-6, in less than half of the time.

    Range: any sigma, D and Phi; heating by the mean stress instead of the local one costs 0 to 4.5 %.
    """

    name: ClassVar[str] = "maxwell-eyring"
    equation: ClassVar[str] = "mu = tau0 S/p, S = mean of S(X) with D dS/dX + exp(Phi sigma S) sinh S(X) = sigma"
    references: ClassVar[tuple[str, ...]] = (
        "Johnson K.L., Tevaarwerk J.L. Shear behaviour of elastohydrodynamic oil films. "
        "Proc. R. Soc. Lond. A 356, 1977, 215-236.",
        KLEBANOV,
    )
    closed_form: ClassVar[str | None] = "muraki"
    flash: float = flash_factor()
    accuracy: float = parameter(
        default=1e-13,
        unit="1",
        validator=in_range(1e-13, 0.1),
        doc="relative error of the friction that is allowed; from 1e-6 on short series serve",
    )

    @property
    def tolerance(self) -> float:  # type: ignore[override]
        """Relative difference allowed between the compiled form and the NumPy form, which is always exact."""
        return min(max(self.accuracy, _EyringFluid.tolerance), _SHORT_SERIES)

    def evaluated_to(self, error: float) -> "MaxwellEyring":
        """Return the same law by short series, where the relative error allows them."""
        return attrs.evolve(self, accuracy=max(self.accuracy, _SHORT_SERIES)) if error >= _SHORT_SERIES else self

    def dimensionless_stress(self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
        """Return S of the exact solution."""
        return maxwell_eyring_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.maxwell_eyring(self.flash, self.accuracy)


@attrs.frozen(kw_only=True)
class Eyring(_EyringFluid):
    """Eyring stress with mean-stress heating and without elasticity: S = asinh(sigma exp(-Phi sigma S)).

    The exact limit D -> 0; needs no shear modulus.
    """

    name: ClassVar[str] = "eyring"
    equation: ClassVar[str] = "mu = tau0 S/p, S = asinh(sigma exp(-Phi sigma S))"
    references: ClassVar[tuple[str, ...]] = (
        "Eyring H. Viscosity, plasticity, and diffusion as examples of absolute reaction rates. "
        "J. Chem. Phys. 4, 1936, 283-291.",
        KLEBANOV,
    )
    solved_by: ClassVar[str | None] = "maxwell-eyring"
    reads = _EyringFluid.reads - {"shear_modulus"}
    domain = MappingProxyType({k: v for k, v in _EyringFluid.domain.items() if k != "shear_modulus"})
    flash: float = flash_factor()

    def dimensionless_stress(self, strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
        """Return S; the Deborah number is accepted and has no effect."""
        return eyring_stress(strain_rate, deborah, heating)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.eyring(self.flash)


@hookimpl
def traction_models() -> list[type[TractionModel]]:
    """Offer the traction models of this module."""
    return [Muraki, MaxwellEyring, Eyring]
