"""Films that soften by the heat of their own shear, for any flow law: their members, groups and solution.

- A flow law is written as the fraction t = tau/(eta V/h) of the stress of a cold Newtonian film that it keeps: t is 1
  for slow sliding, is an even function of V, and none of its groups contains the unknown stress.
- With q = beta eta V^2/h, heat that lowers the viscosity is two groups: q phi of the flash temperature phi tau V of
  the surfaces, phi = flash sqrt(b/(pi u))/sqrt(K rho c), and q h/K_f of the conduction across the film.
- A softened law is t = F(t) with a falling F. In log t the residual is increasing and, for all laws here, convex, so
  that Newton's steps from an upper bound descend to the root.
"""

import abc
import math
from collections.abc import Callable
from types import MappingProxyType
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip import models
from rollslip.fields import parameter, positive
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import (
    FINITE,
    NON_NEGATIVE,
    POSITIVE,
    Domain,
    TractionModel,
    Validity,
)
from rollslip.search import Array
from rollslip_kernels.slices import Slices

#: Maximum number of Newton steps; it is never reached, some eight are enough.
MAX_STEPS: Final = 60
#: Value below which a group has no effect on the last bit; it replaces smaller ones, so that quotients are not 0/0.
NO_EFFECT: Final = 1e-17
#: Factor of the flash temperature for the elliptic heat flux of Hertz's contact.
FLASH: Final = 0.97
#: Heat capacity of an oil by volume [J/(m3 K)], 850 to 950 kg/m3 times 1.9 to 2.1 kJ/(kg K) (C).
OIL_HEAT_CAPACITY: Final = 1.8e6

#: Members that heated films read, and their domain.
HEATED: Final[Domain] = MappingProxyType(
    {
        "pressure": POSITIVE,
        "half_width": POSITIVE,
        "film_thickness": POSITIVE,
        "rolling_speed": POSITIVE,
        "sliding_speed": FINITE,
        "film_viscosity": POSITIVE,
        "film_thermoviscosity": NON_NEGATIVE,
        "effusivity": POSITIVE,
        "conductivity": POSITIVE,
    }
)
#: Members that laws at the local pressure read beside those of the oil's law, and their domain.
AT_LOCAL_PRESSURE: Final[Domain] = MappingProxyType(
    {
        **{member: HEATED[member] for member in HEATED if member not in PressureViscosity.writes},
        "eyring_stress": POSITIVE,
        "shear_modulus": POSITIVE,
    }
)


def _flash_excess(ratio: float) -> float:
    """Return by how much surfaces at u + V/2 and u - V/2 are hotter than at u [%], from V/u = 1.9 on as there."""
    x = 0.5 * min(ratio, 1.9)  # at 2 one surface is at rest, and the theory ends
    return 100.0 * (0.5 / math.sqrt(1.0 + x) + 0.5 / math.sqrt(1.0 - x) - 1.0)


#: Validities of laws of the full film: no asperities, the mean pressure for Hertz's, surfaces that both move with u.
NO_ASPERITIES: Final = Validity(
    code="W13",
    quantity="film_parameter",
    low=1.5,
    consequence="asperities carry load, whose friction the law does not have",
    remedy="the law in a blend: traction 'lambda-blend'",
    replacement="lambda-blend.hydrodynamic",
    source="limit of the full film of 'lambda-blend' (C)",
)
#: The same with the law that takes the pressures of the contact.
MEAN_PRESSURE: Final = attrs.evolve(
    models.MEAN_PRESSURE,
    remedy="traction 'maxwell-eyring-local', which takes the pressures of the contact",
    replacement="maxwell-eyring-local",
)
SLOW_SLIDING: Final = Validity(
    code="W12",
    quantity="slide_roll_ratio",
    high=1.0 / 3.0,
    consequence="surfaces at u + V/2 and u - V/2 have a mean flash temperature {error} higher than at u",
    error=_flash_excess,
    remedy="no built-in law is better; the heat of the film itself is not affected",
    source="flash temperature in proportion to 1/sqrt(speed), half of the heat into each surface (Jaeger 1942)",
)


def flash_factor() -> float:
    """Declare the factor of the flash temperature of two surfaces that share the heat of the film."""
    factor: float = parameter(
        default=FLASH,
        unit="1",
        validator=positive,
        doc="factor of the flash temperature: 0.97 elliptic heat flux, 0.960 plain mean, 1.001 flux-weighted mean",
        usual=(0.5, 1.5),
        possible=(0, 1e3),
    )
    return factor


def heat_capacity() -> float:
    """Declare the heat capacity of the oil by volume."""
    capacity: float = parameter(
        default=OIL_HEAT_CAPACITY,
        unit="J/(m3 K)",
        validator=positive,
        doc="heat capacity rho_f c_f of the oil by volume",
        usual=(1e6, 3e6),
        possible=(1e3, 1e9),
    )
    return capacity


class HeatedFilm(TractionModel, abc.ABC):
    """Traction mu = t eta V/(h p) with the fraction t of the cold Newtonian stress that a flow law keeps."""

    validity: ClassVar[tuple[Validity, ...]] = (NO_ASPERITIES, MEAN_PRESSURE, SLOW_SLIDING)
    reads = frozenset(HEATED)
    domain = HEATED
    flash: float

    @abc.abstractmethod
    def fraction(self, newtonian: Array, surfaces: Array, across: Array, slices: Slices) -> Array:
        """Return t of slices.

        Parameters
        ----------
        newtonian : array
            Cold Newtonian stress eta |V|/h [Pa].
        surfaces : array
            Softening by the flash temperature of the surfaces, beta phi eta V^2/h [1].
        across : array
            Softening by conduction across the film, beta eta V^2/K_f [1], the Nahme number.
        slices : Slices
            What else the law reads.
        """

    def evaluate(self, slices: Slices) -> None:
        """Fill the traction coefficient."""
        c = slices.conditions
        s = slices
        newtonian = s.film_viscosity * s.sliding_speed / s.film_thickness
        softening = s.film_thermoviscosity * newtonian * s.sliding_speed
        surfaces = (
            self.flash
            / (c.effusivity * np.sqrt(np.pi))
            * np.sqrt(s.half_width / s.rolling_speed)
            * softening
        )
        across = softening * s.film_thickness / c.conductivity
        s.friction[...] = (
            newtonian / s.pressure * self.fraction(np.abs(newtonian), surfaces, across, s)
        )


def mean_softening(surfaces: Array, across: Array) -> Array:
    """Return w = beta zeta eta V^2/h of a film at its mean temperature: viscosity falls by the factor exp(-w t)."""
    return surfaces + across / 12


def softened(law: Callable[[Array], tuple[Array, Array]], fraction: Array) -> Array:
    """Return the solution of t = F(t) by Newton's method in log t.

    Parameters
    ----------
    law : callable
        Function of t that returns F, which falls, and -dlnF/dln t.
    fraction : ndarray
        Upper bound of the solution.
    """
    for _ in range(MAX_STEPS):
        value, fall = law(fraction)
        step = np.log(fraction / value) / (1 + fall)
        fraction = fraction * np.exp(-step)
        if not np.any(
            (1 + fall) * step**2 > 1e-17
        ):  # the error left is below (1 + fall) step^2; NaN also ends
            break
    return fraction


def newtonian_bound(softening: Array) -> Array:
    """Return the fraction of a Newtonian film, t = exp(-w t), to a few percent: no other law keeps more."""
    w = np.maximum(softening, NO_EFFECT)
    x = np.log1p(w)
    # Lambert's W after Iacono and Boyd (2017)
    return np.asarray(x * (1 - np.log1p(x) / (2 + x)) / w)
