"""Measures of sliding: power on the area of a contact, energy that a pass leaves, and what parts the surfaces."""

import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import DomainError
from rollslip.fields import choice_of, parameter, positive
from rollslip.references import Reference
from rollslip.search import Array
from rollslip.studies.surface_damage.model import Contacts, DamageModel
from rollslip_plugins.bibliography import HAMROCK_ANDERSON_1983, MATVEEVSKY_1965

__all__ = ["FilmParameter", "PassEnergy", "PowerDensity", "allowed"]

#: Ratio of the largest to the mean pressure of Hertz's line contact.
_PEAK: Final = 4.0 / math.pi
#: Film parameter below which smearing was observed (B).
_MIN_FILM_PARAMETER: Final = 1.0


def allowed(unit: str, doc: str, default: float | None = None, **ranges: Any) -> Any:
    """Declare the largest allowed value of a measure.

    Parameters
    ----------
    unit, doc : str
        Unit and description of the parameter.
    default : float, optional
        A published value; None if there is none.
    **ranges
        Usual and possible ranges.
    """
    return parameter(
        default=default, unit=unit, doc=doc, validator=attrs.validators.optional(positive), **ranges
    )


def stated_limit(value: float | None) -> tuple[float, str] | None:
    """Return a limit of the scene with its source; None without one."""
    return None if value is None else (value, "given in the scene")


@attrs.frozen(kw_only=True)
class PowerDensity(DamageModel):
    """Power that sliding turns into heat on the area of a contact, also called friction power intensity.

    q = |mu p V|

    Symbols:

    - q: power density [W/m2]
    - mu: traction coefficient [-]
    - p: mean Hertz pressure [Pa]; with ``over = "maximum"`` the largest, 4/pi of it
    - V: sliding speed [m/s]

    Range: any contact; it is a definition.

    Examples
    --------
    >>> from rollslip import get_model
    >>> get_model("damage", "power-density").unit
    'W/m2'
    """

    name: ClassVar[str] = "power-density"
    equation: ClassVar[str] = "q = |mu p V|"
    references: ClassVar[tuple[Reference, ...]] = (MATVEEVSKY_1965,)
    measure: ClassVar[str] = "sliding power density"
    unit: ClassVar[str] = "W/m2"
    scope: ClassVar[str] = (
        "no limit of it is valid in general: what surfaces bear depends on oil, additives, finish and running-in"
    )

    over: str = parameter(
        default="mean",
        doc="mean pressure of a contact, or its maximum",
        validator=choice_of("mean", "maximum"),
    )
    allowed: float | None = allowed(
        "W/m2",
        "largest power density that is allowed, where it is known",
        usual=(1e5, 1e10),
        possible=(1e-6, 1e15),
    )

    def evaluate(self, contacts: Contacts) -> Array:
        """Return the power density [W/m2]."""
        factor = 1.0 if self.over == "mean" else _PEAK
        return np.asarray(factor * contacts.friction_power / (2.0 * contacts.slices.half_width))

    def across(self, contacts: Contacts, places: Array) -> Array:
        """Return the power density with Hertz's pressure and one traction coefficient [W/m2], (n, m).

        Parameters
        ----------
        contacts : Contacts
            The n contacts.
        places : ndarray, shape (m,)
            Positions x/b across a contact, -1 to 1.
        """
        mean = contacts.friction_power / (2.0 * contacts.slices.half_width)
        return np.asarray(_PEAK * mean[:, None] * np.sqrt(np.maximum(1.0 - places * places, 0.0)))

    @property
    def limit(self) -> tuple[float, str] | None:
        """The power density that is allowed."""
        return stated_limit(self.allowed)


@attrs.frozen(kw_only=True)
class PassEnergy(DamageModel):
    """Energy that sliding turns into heat on the area of a surface while it passes the contact once.

    e = int |mu p V| dt = |mu w V|/v

    Symbols:

    - e: energy of a pass on the area of the surface [J/m2]
    - mu: traction coefficient [-]
    - p, w: pressure [Pa] and normal force per length [N/m]
    - V: sliding speed [m/s]
    - v: speed of the surface relative to the contact [m/s]; of the slower one, which takes longer, unless ``surface``
      names another

    All of the heat is counted to that surface, whatever fraction of it flows there.

    Range: surfaces that move through their contact.

    Raises
    ------
    DomainError
        If the surface stands still in its contact: then no pass ends.
    """

    name: ClassVar[str] = "pass-energy"
    equation: ClassVar[str] = "e = |mu w V|/v"
    references: ClassVar[tuple[Reference, ...]] = (MATVEEVSKY_1965,)
    measure: ClassVar[str] = "sliding energy of a pass"
    unit: ClassVar[str] = "J/m2"
    scope: ClassVar[str] = (
        "it counts one pass, and nothing of what heals or builds up between passes; no limit of it is valid in general"
    )

    surface: str = parameter(
        default="slower", doc="whose pass is taken", validator=choice_of("slower", "ring", "roller")
    )
    allowed: float | None = allowed(
        "J/m2",
        "largest energy of a pass that is allowed, where it is known",
        usual=(1e-3, 1e6),
        possible=(1e-12, 1e12),
    )

    def evaluate(self, contacts: Contacts) -> Array:
        """Return the energy of a pass [J/m2]."""
        ring, roller = contacts.surface_speeds
        speed = {"ring": ring, "roller": roller}.get(self.surface, np.minimum(ring, roller))
        if not np.all(speed > 0.0):
            raise DomainError(
                f"{self.name}: a surface of the {contacts.ring} contacts stands still while the other slides over it, "
                "and no pass ends; take another slip, or --set models.damage=power-density"
            )
        return np.asarray(contacts.friction_power / speed)

    def across(self, contacts: Contacts, places: Array) -> Array:
        """Return the energy that a point of the surface has received up to each position of its pass [J/m2], (n, m).

        Parameters
        ----------
        contacts : Contacts
            The n contacts.
        places : ndarray, shape (m,)
            Positions x/b across a contact, -1 to 1.
        """
        x = np.clip(places, -1.0, 1.0)
        fraction = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / math.pi
        return np.asarray(self.evaluate(contacts)[:, None] * fraction)

    @property
    def limit(self) -> tuple[float, str] | None:
        """The energy that is allowed."""
        return stated_limit(self.allowed)


@attrs.frozen(kw_only=True)
class FilmParameter(DamageModel):
    """Film parameter: what parts the surfaces, over their roughness.

    Lambda = h/sigma

    Symbols:

    - Lambda: film parameter [-]
    - h: film thickness [m]
    - sigma: composite roughness 1.25 sqrt(Ra1^2 + Ra2^2) [m]

    Range: Hamrock and Anderson report smearing, or deformation with wear, of rolling bearings below Lambda of 1 (grade
    B), whatever the sliding: ``allowed`` is that unless the scene gives another value.
    """

    name: ClassVar[str] = "film-parameter"
    equation: ClassVar[str] = "Lambda = h/sigma"
    references: ClassVar[tuple[Reference, ...]] = (HAMROCK_ANDERSON_1983,)
    measure: ClassVar[str] = "film parameter"
    unit: ClassVar[str] = "1"
    worst: ClassVar[Any] = "smallest"
    scope: ClassVar[str] = (
        "it knows nothing of sliding; running-in smooths surfaces, and additives protect them under thinner films"
    )

    allowed: float | None = allowed(
        "1",
        "least film parameter that is allowed",
        default=_MIN_FILM_PARAMETER,
        usual=(0.05, 10),
        possible=(1e-9, 1e9),
    )

    def evaluate(self, contacts: Contacts) -> Array:
        """Return the film parameter."""
        return np.asarray(contacts.slices.film_thickness / contacts.slices.conditions.roughness)

    @property
    def limit(self) -> tuple[float, str] | None:
        """The least film parameter that is allowed."""
        if self.allowed == _MIN_FILM_PARAMETER:
            return (
                _MIN_FILM_PARAMETER,
                "Hamrock and Anderson (1983), smearing of rolling bearings below it (B)",
            )
        return stated_limit(self.allowed)
