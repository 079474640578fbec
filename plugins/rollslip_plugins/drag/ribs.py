"""Friction of roller ends on ribs: a constant coefficient, and the film of an open rib."""

import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import Scatter, non_negative, parameter, positive
from rollslip.models import RibContact, RibModel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_plugins.bibliography import HAMROCK_1977, ZHOU_1991

#: Sliding speed over which boundary friction changes its sign [m/s]. Half and twice the value change slips of an
#: NJ 2312 whose ribs do not slide, near -4.9 %, by 0.5 and 1.1 % of them, and others by less than 1e-7. Chosen, far
#: below sliding speeds of ribs, so that the friction has no jump.
_TRANSITION_SPEED: Final = 0.01
#: Load below which the oil beside the contact counts less and less [N]: a roller that touches no rib drags no oil.
#: Half and twice the value change slips of an NJ 2312 by up to 9e-5 of them. Chosen, far below loads of ribs.
_TOUCHING_LOAD: Final = 1e-3
#: Ratio k of the axes of the ellipse in the film formula, 1 of a circle.
_CIRCLE: Final = 1.0 - 0.61 * math.exp(-0.73)
#: Largest number of Newton's steps for the shear stress, which converge from one side in 3 to 6. Doubling it changes
#: nothing.
_NEWTON_STEPS: Final = 30
#: Step at which they end, over the Eyring stress: near rounding. Doubling it changes nothing but the last digits.
_STRESS_TOLERANCE: Final = 1e-13


@attrs.frozen(kw_only=True)
class ConstantRib(RibModel):
    """One coefficient of friction: F = mu Q tanh(V/V0), V0 = 0.01 m/s.

    For ribs that are closed, so that roller ends touch them at an edge and no film forms, or for a coefficient that was
    measured.

    Symbols:

    - F: friction on the roller's end [N]
    - mu: coefficient (``coefficient``) [1]
    - Q: normal force [N]
    - V: sliding speed [m/s]

    Range: 0.05 to 0.1 of closed ribs (D). SKF's coefficient of full films in cylindrical roller bearings, 0.02, is that
    of all sliding.

    Examples
    --------
    >>> from rollslip_kernels.slices import Conditions
    >>> contact = RibContact(conditions=Conditions(), load=np.array([100.0]), rolling_speed=np.array([1.0]),
    ...                      sliding_speed=np.array([-1.0]))
    >>> ConstantRib(coefficient=0.05).friction(contact)
    array([-5.])
    """

    name: ClassVar[str] = "constant"
    equation: ClassVar[str] = "F = mu Q tanh(V/V0)"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            kind="remark",
            title="No law: a number that is given, made smooth where the rib does not slide. Default 0.05 (D): between "
            "SKF's 0.02 of full films (B) and boundary friction, 0.1 (B).",
        ),
    )

    coefficient: float = parameter(
        default=0.05,
        unit="1",
        validator=non_negative,
        doc="coefficient of friction mu",
        usual=(0, 0.15),
        possible=(0, 1),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 0.5},
            grade="(D)",
            source="0.02 of SKF's full films to 0.1 of boundary friction (B)",
        ),
    )

    def friction(self, contact: RibContact) -> Array:
        """Return the friction [N]."""
        slope = np.tanh(contact.sliding_speed / _TRANSITION_SPEED)
        return np.asarray(self.coefficient * contact.load * slope)


@attrs.frozen(kw_only=True)
class OpenRibFilm(RibModel):
    """Film on an open rib: friction of film and asperities in the contact, and of the oil beside it.

    F = f [(phi mu_b tanh(V/V0) + (1 - phi) tau/p) Q + eta0 V 2 pi R ln(1 + (s^2 - a^2)/(2 R h))].

    1. Film of Hamrock and Dowson, h = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 e^-0.73) R, with U = eta0 u/(E' R),
       G = alpha E' and W = Q/(E' R^2).
    2. Eyring's stress at the mean Hertz pressure, tau = tau0 asinh(eta V/(tau0 h)), with Roelands' viscosity eta at
       that pressure, which falls with the heat of its own shear, eta e^(-beta zeta tau V).
    3. Asperities carry phi = exp(-1.90 Lambda^0.99) of the load (Zhou and Hoeprich).
    4. Newton's shear of the oil between sphere and plane beside the contact, out to the radius s. It is the larger part
       of an open rib with a full film.

    Symbols:

    - F: friction on the roller's end [N]
    - Q, p, a: normal force [N], mean pressure [Pa] and radius [m] of the contact circle
    - R: radius of the roller's end [m]
    - s: radius up to which oil is sheared, ``reach`` times the height of the contact above the raceway [m]
    - mu_b: coefficient of boundary friction (``boundary_coefficient``) [1]
    - f: factor for calibration and scatter (``factor``), 1 by default [1]
    - u, V: rolling and sliding speed [m/s]; V0 = 0.01 m/s
    - zeta: temperature of the film over tau V, 0.97 sqrt(a/(pi u))/sqrt(K rho c) + h/(12 K_f) [K m2/W]

    Range: ribs that are open by an angle, so that roller ends touch them inside of their edges, and a bath or splash
    that leaves the inlet full of oil. Pressure and film are those of a full circle also where it is larger than the
    rib.

    Raises
    ------
    DomainError
        If the oil has no value that the film needs.
    """

    name: ClassVar[str] = "open-film"
    equation: ClassVar[str] = (
        "F = f [(phi mu_b + (1 - phi) tau/p) Q + eta0 V 2 pi R ln(1 + (s^2 - a^2)/(2 R h))]"
    )
    references: ClassVar[tuple[Reference, ...]] = (HAMROCK_1977, ZHOU_1991)

    boundary_coefficient: float = parameter(
        default=0.1,
        unit="1",
        validator=non_negative,
        doc="coefficient mu_b of boundary friction",
        usual=(0.02, 0.15),
        possible=(0, 1),
    )
    reach: float = parameter(
        default=0.8,
        unit="1",
        validator=positive,
        doc="radius up to which oil beside the contact is sheared, over the height of the contact",
        usual=(0.3, 1.5),
        possible=(1e-3, 10),
    )
    factor: float = parameter(
        default=1.0,
        unit="1",
        validator=non_negative,
        doc="factor on the friction, for calibration and for scatter",
        usual=(0.02, 50),
        possible=(0, 1e4),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 0.5},
            grade="(D)",
            source="oil sheared out to 1.5 or to 2.5 mm, end radii and the supply of oil to ribs are not stated; no "
            "measured friction of single ribs was compared",
        ),
    )

    def friction(self, contact: RibContact) -> Array:
        """Return the friction [N]."""
        c = contact.conditions
        load = contact.load
        V = contact.sliding_speed
        a = np.cbrt(1.5 * load * c.radius / c.modulus)
        pressure = load / (np.pi * a * a)
        film = self.film_thickness(contact)
        asperities = np.exp(-1.90 * (film / c.roughness) ** 0.99)
        boundary = self.boundary_coefficient * np.tanh(V / _TRANSITION_SPEED)
        stress = _stress(contact, pressure, film, a)
        outside = np.maximum((self.reach * c.length) ** 2 - a * a, 0.0)
        factor = 2.0 * np.pi * c.radius * np.log1p(outside / (2.0 * c.radius * film))
        touching = load / (load + _TOUCHING_LOAD)
        friction = (asperities * boundary + (1.0 - asperities) * stress / pressure) * load
        return np.asarray(self.factor * (friction + c.viscosity * V * factor * touching))

    def film_thickness(self, contact: RibContact) -> Array:
        """Return the central film thickness [m], (n,).

        Parameters
        ----------
        contact : RibContact
            Loads, speeds, oil and geometry.
        """
        c = contact.conditions
        speed = c.viscosity * contact.rolling_speed / (c.modulus * c.radius)
        material = c.pressure_viscosity * c.modulus
        load = contact.load / (c.modulus * c.radius**2)
        film = 2.69 * speed**0.67 * material**0.53 * load**-0.067 * _CIRCLE * c.radius
        return np.asarray(film)


def _stress(contact: RibContact, pressure: Array, film: Array, size: Array) -> Array:
    """Return Eyring's stress at mean pressures in films that their own shear heats [Pa], with the sign of sliding."""
    c = contact.conditions
    speed = np.abs(contact.sliding_speed)
    flash = 0.97 / c.effusivity * np.sqrt(size / (np.pi * contact.rolling_speed))
    heating = c.thermoviscosity * (flash + film / (12.0 * c.conductivity)) * speed
    logarithm = math.log(c.viscosity / 6.315e-5)
    exponent = 5.1e-9**-1.0 * c.pressure_viscosity / logarithm
    viscosity = c.viscosity * np.exp(logarithm * ((1.0 + 5.1e-9 * pressure) ** exponent - 1.0))
    cold: Any = viscosity * speed / (c.eyring_stress * film)
    stress = np.zeros_like(cold)
    for _ in range(_NEWTON_STEPS):
        # residual and slope of tau/tau0 - asinh(cold e^(-heating tau)): concave, so that steps from zero stay below
        strain = cold * np.exp(-heating * stress)
        residual = stress / c.eyring_stress - np.arcsinh(strain)
        slope = 1.0 / c.eyring_stress + heating * strain / np.hypot(1.0, strain)
        step = residual / slope
        stress = stress - step
        if not np.abs(step).max(initial=0.0) > _STRESS_TOLERANCE * c.eyring_stress:
            break
    return np.asarray(np.sign(contact.sliding_speed) * stress)
