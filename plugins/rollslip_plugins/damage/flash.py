"""Temperatures in a sliding contact: the flash temperature of the surfaces above the bulk, and the sum of both."""

import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.fields import choice_of, parameter, positive, refuse_if
from rollslip.models import submodel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip.studies.surface_damage.model import Contacts, DamageModel
from rollslip_plugins.bibliography import BLOK_1937, CARSLAW_1959, JAEGER_1942
from rollslip_plugins.damage.moving_source import FAST, largest_rise, rise
from rollslip_plugins.damage.sliding import stated_limit

__all__ = ["BulkAndFlash", "ContactTemperature", "FlashTemperature"]

#: Flux in the middle of the contact relative to the mean, times b over the width 2 b.
_MIDDLE: Final = 2.0 / math.pi
#: Peclet number that stands for a fast surface: a larger one changes the rise by less than 1e-6.
_FAST = 1e6
#: Peclet number that replaces smaller ones, so that a surface at rest has a finite rise.
_AT_REST = 1e-300


def _material(
    unit: str, doc: str, usual: tuple[float, float], possible: tuple[float, float]
) -> Any:
    """Return an optional positive parameter of a material."""
    return parameter(
        default=None,
        unit=unit,
        doc=doc,
        validator=attrs.validators.optional(positive),
        usual=usual,
        possible=possible,
    )


@attrs.frozen(kw_only=True)
class FlashTemperature(DamageModel):
    """Largest rise of the temperature of two surfaces over their bulk in a contact, after Blok and Jaeger.

    dT = (2/pi) |mu w V|/(K_1/theta(Pe_1) + K_2/theta(Pe_2)),   Pe_i = v_i b/(2 kappa_i)

    Friction is spread over the contact as Hertz's pressure is, and heats both surfaces to one temperature: 1/dT =
    1/dT_1 + 1/dT_2, with dT_i the rise if all heat went into i. theta is that of a moving source
    (`rollslip_plugins.damage.moving_source`). For fast surfaces theta = 0.8730/sqrt(Pe), which is Blok's formula::

        dT = 1.1115 |mu w V|/[(e_1 sqrt(v_1) + e_2 sqrt(v_2)) sqrt(2 b)]

    and of one material 1.11 |mu w (sqrt(v_1) - sqrt(v_2))|/(e sqrt(2 b)).

    Symbols:

    - dT: rise of temperature [K]
    - mu, w, V: traction coefficient [-], normal force per length [N/m], sliding speed [m/s]
    - b: half width [m]
    - v_i: speed of a surface relative to the contact [m/s]
    - K_i, kappa_i, e_i: thermal conductivity [W/(m K)], diffusivity [m2/s] and effusivity sqrt(K rho c)
      [J/(m2 K s^0.5)] of ring and roller

    Range: ``conduction = "any-speed"`` takes theta at the Peclet numbers of the contact, ``"fast"`` its limit, 0.1 %
    too high at Pe = 10 and 6 % at Pe = 1. Rises are those of smooth half-spaces, in which passes leave no heat. With
    one temperature at every place, which surfaces of different Peclet numbers do not have here, the largest rise
    differs by less than 0.2 % for Pe of 1 and more. A surface that turns back in its contact is taken for one that
    passes as fast.
    """

    name: ClassVar[str] = "flash-temperature"
    equation: ClassVar[str] = "dT = (2/pi) |mu w V|/(K_1/theta(Pe_1) + K_2/theta(Pe_2))"
    references: ClassVar[tuple[Reference, ...]] = (BLOK_1937, JAEGER_1942)
    measure: ClassVar[str] = "flash temperature"
    unit: ClassVar[str] = "K"
    difference: ClassVar[bool] = True
    scope: ClassVar[str] = (
        "heat is counted as made on smooth surfaces: single asperities are hotter, and so is the middle of a thick film"
    )

    conduction: str = parameter(
        default="any-speed",
        doc="rise at the Peclet numbers of the surfaces, or its limit for fast ones",
        validator=choice_of("any-speed", "fast"),
    )
    roller_conductivity: float | None = _material(
        "W/(m K)",
        "thermal conductivity of the rollers, if not that of the bearing's material",
        (5, 150),
        (0.01, 5e3),
    )
    roller_heat_capacity: float | None = _material(
        "J/(m3 K)",
        "heat capacity rho c of the rollers, if not that of the bearing's material",
        (1e6, 6e6),
        (1e2, 1e9),
    )

    def conductors(self, contacts: Contacts) -> tuple[tuple[float, float, Array], ...]:
        """Return conductivity K [W/(m K)], heat capacity rho c [J/(m3 K)] and speed v [m/s] of ring and roller."""
        m = contacts.material
        own = contacts.roller_material
        (ring, roller) = contacts.surface_speeds
        return (m.thermal_conductivity, m.density * m.specific_heat, ring), (
            own.thermal_conductivity
            if self.roller_conductivity is None
            else self.roller_conductivity,
            own.density * own.specific_heat
            if self.roller_heat_capacity is None
            else self.roller_heat_capacity,
            roller,
        )

    def evaluate(self, contacts: Contacts) -> Array:
        """Return the largest rise in every contact [K]."""
        ring, roller = self._conductances(contacts)
        return np.asarray(_MIDDLE * contacts.friction_power / (ring + roller))

    def across(self, contacts: Contacts, places: Array) -> Array:
        """Return the rise of the hotter surface across the contacts [K], (n, m).

        The heat is divided between the surfaces by their largest rises.

        Parameters
        ----------
        contacts : Contacts
            The n contacts.
        places : ndarray, shape (m,)
            Positions x/b across a contact, -1 to 1.
        """
        ring, roller = self._conductances(contacts)
        hotter = np.zeros((len(contacts.slices), np.size(places)))
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # a surface that stands still takes nothing
            for own, there in zip(
                (ring, roller), self._conductances(contacts, np.asarray(places)), strict=True
            ):
                hotter = np.fmax(hotter, own[:, None] / there)
        return np.asarray(self.evaluate(contacts)[:, None] * hotter)

    def _conductances(self, contacts: Contacts, places: Array | None = None) -> tuple[Array, Array]:
        """Return K/theta of ring and roller [W/(m K)]: where their rises are largest, (n,), or at places, (n, m)."""
        fast = self.conduction == "fast"
        conductances = []
        for conductivity, capacity, speed in self.conductors(contacts):
            peclet = 0.5 * speed * contacts.slices.half_width * capacity / conductivity
            with np.errstate(divide="ignore"):  # a surface that stands still takes nothing
                if places is None:
                    theta = FAST / np.sqrt(peclet) if fast else largest_rise(peclet)
                elif fast:
                    theta = rise(_FAST, places) * np.sqrt(_FAST / peclet)[:, None]
                else:
                    theta = rise(np.maximum(peclet, _AT_REST)[:, None], places)
                conductances.append(conductivity / theta)
        return conductances[0], conductances[1]


@attrs.frozen(kw_only=True)
class BulkAndFlash(DamageModel):
    """Base of measures of the contact temperature: the common bulk temperature of two surfaces plus the flash.

    Raises
    ------
    FieldError
        If ``flash`` is no flash temperature.
    """

    unit: ClassVar[str] = "K"

    flash: FlashTemperature = submodel(
        "damage", factory=FlashTemperature, doc="the flash temperature over the bulk"
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            not isinstance(self.flash, FlashTemperature),
            "flash",
            f"must be model 'flash-temperature', not {self.flash.name!r}",
        )

    def _bulk(self, contacts: Contacts) -> Array:
        """Return the common bulk temperature of both surfaces [K], (n,)."""
        ring, roller = (
            np.sqrt(K * capacity * speed) for K, capacity, speed in self.flash.conductors(contacts)
        )
        fraction = ring / (ring + roller)
        return np.asarray(
            fraction * contacts.ring_temperature + (1.0 - fraction) * contacts.roller_temperature
        )

    def evaluate(self, contacts: Contacts) -> Array:
        """Return the largest temperature in every contact [K]."""
        return np.asarray(self._bulk(contacts) + self.flash.evaluate(contacts))

    def across(self, contacts: Contacts, places: Array) -> Array:
        """Return the temperature across the contacts [K], (n, m).

        Parameters
        ----------
        contacts : Contacts
            The n contacts.
        places : ndarray, shape (m,)
            Positions x/b across a contact, -1 to 1.
        """
        return np.asarray(self._bulk(contacts)[:, None] + self.flash.across(contacts, places))


@attrs.frozen(kw_only=True)
class ContactTemperature(BulkAndFlash):
    """Largest temperature of the surfaces in a contact: what the bulk gives, and the flash over it, after Blok.

    T = (m_1 T_1 + m_2 T_2)/(m_1 + m_2) + dT,   m_i = e_i sqrt(v_i)

    Two fast surfaces of different temperatures come to one between them as soon as they touch, weighed by what each
    conducts (two half-spaces brought together; Carslaw and Jaeger, section 2.8), and friction heats them from there.

    Symbols:

    - T: temperature of the surfaces [K]
    - T_i: bulk temperatures of ring and rollers [K]
    - e_i: thermal effusivity [J/(m2 K s^0.5)]
    - v_i: speed of a surface relative to the contact [m/s]
    - dT: flash temperature [K], of ``flash``

    Blok holds this against a temperature of oil and steel beyond which films fail. Such temperatures were found on
    gears and discs, for one oil and finish each: ``allowed`` is none until the scene gives it.

    Range: that of the flash temperature; the common temperature holds for fast surfaces.
    """

    name: ClassVar[str] = "contact-temperature"
    equation: ClassVar[str] = "T = (m_1 T_1 + m_2 T_2)/(m_1 + m_2) + dT, m_i = e_i sqrt(v_i)"
    references: ClassVar[tuple[Reference, ...]] = (BLOK_1937, CARSLAW_1959)
    measure: ClassVar[str] = "contact temperature"
    scope: ClassVar[str] = (
        "critical temperatures were measured on gears and discs, for one oil and finish each; none holds for bearings "
        "in general"
    )

    allowed: float | None = parameter(
        default=None,
        unit="K",
        doc="largest contact temperature that is allowed, where it is known",
        validator=attrs.validators.optional(positive),
        usual=(323.15, 773.15),
        possible=(123.15, 2273.15),
    )

    @property
    def limit(self) -> tuple[float, str] | None:
        """The contact temperature that is allowed."""
        return stated_limit(self.allowed)
