"""The ``[lubricant]`` table of a scene, and the oil that it describes: a shipped one, the user's own, or both."""

import math
from collections.abc import Callable, Mapping

from attrs import asdict, evolve, fields_dict, frozen
from attrs.validators import optional

from rollslip.errors import SceneError
from rollslip.fields import FieldError, field, one_of
from rollslip.lubricant.fits import fit_vogel, fit_walther
from rollslip.lubricant.oil import Lubricant, positive_field
from rollslip.lubricant.pressure import Barus, PressureViscosity, Roelands, Yasutomi
from rollslip.lubricant.temperature import Constant, TemperatureLaw
from rollslip.structure import Location, structure

__all__ = ["OilPoint", "OilTable", "lubricant_from_table"]

_MARGIN = 20.0  # K, by which the validity of a fitted law reaches beyond its points


@frozen(kw_only=True)
class OilPoint:
    """A measured viscosity of an own oil."""

    temperature: float = positive_field("K", "temperature")
    viscosity: float | None = positive_field("Pa s", "dynamic viscosity", None)
    kinematic_viscosity: float | None = positive_field("m2/s", "kinematic viscosity", None)

    def __attrs_post_init__(self) -> None:
        if (self.viscosity is None) == (self.kinematic_viscosity is None):
            raise FieldError("viscosity", "give either viscosity or kinematic_viscosity")


@frozen(kw_only=True)
class OilTable:
    """The ``[lubricant]`` table of a scene as written: what it leaves out is None; see `lubricant_from_table`."""

    name: str | None = field(default=None, doc="a shipped oil, whose data the other keys override")
    description: str | None = field(default=None, doc="what the oil is")
    source: str | None = field(default=None, doc="where the data of this table come from")
    viscosity_law: str | None = field(
        default=None, doc="law through the points", validator=optional(one_of("walther", "vogel"))
    )
    points: tuple[OilPoint, ...] = field(default=(), doc="measured viscosities")
    density: float | None = positive_field("kg/m3", "density, between kinematic and dynamic viscosity", None)
    pressure_viscosity: float | None = positive_field("1/Pa", "pressure-viscosity coefficient, constant", None)
    pressure_viscosity_law: str | None = field(
        default=None,
        doc="how viscosity rises with pressure",
        validator=optional(one_of("barus", "roelands", "yasutomi")),
    )
    yasutomi: Yasutomi | None = field(default=None, doc="constants of Yasutomi's law")
    conductivity: float | None = positive_field("W/(m K)", "thermal conductivity, constant", None)
    eyring_stress: float | None = positive_field("Pa", "Eyring stress", None)
    shear_modulus: float | None = positive_field("Pa", "shear modulus", None)
    minimum_temperature: float | None = positive_field("K", "lowest temperature at which the data hold", None)
    maximum_temperature: float | None = positive_field("K", "highest temperature at which the data hold", None)
    viscosity_factor: float | None = positive_field("1", "factor on the viscosity", None)
    pressure_viscosity_factor: float | None = positive_field("1", "factor on the pressure-viscosity coefficient", None)
    pressure_thermoviscosity_factor: float | None = positive_field("1", "factor on the slope of that coefficient", None)

    def __attrs_post_init__(self) -> None:
        if self.name is None and not self.points:
            raise FieldError("name", "missing; name a shipped oil, or give viscosity_law and points of your own")
        if self.points and self.viscosity_law is None:
            raise FieldError("viscosity_law", "missing; the points need 'walther' or 'vogel'")
        if not self.points and (self.viscosity_law or self.density):
            raise FieldError("points", "missing; viscosity_law and density serve to fit them")
        kinematic = any(point.viscosity is None for point in self.points)
        if self.density is None and (kinematic or self.viscosity_law == "walther"):
            raise FieldError("density", "missing; it stands between kinematic and dynamic viscosity")
        if (self.yasutomi is None) == (self.pressure_viscosity_law == "yasutomi"):
            raise FieldError("yasutomi", "the constants and pressure_viscosity_law = 'yasutomi' need each other")
        if self.yasutomi is not None and self.pressure_viscosity is not None:
            raise FieldError("pressure_viscosity", "not with Yasutomi's law, which fixes it; leave it out")

    @property
    def law(self) -> PressureViscosity | None:
        """Law of viscosity with pressure, None if the table says nothing of it."""
        return self.yasutomi or {"barus": Barus(), "roelands": Roelands()}.get(self.pressure_viscosity_law or "")

    def fit(self) -> TemperatureLaw:
        """Viscosity law through the points."""
        T = [point.temperature for point in self.points]
        density = self.density or math.nan  # only read where it must be given
        eta = [point.viscosity or density * (point.kinematic_viscosity or math.nan) for point in self.points]
        return (
            fit_vogel(T, eta) if self.viscosity_law == "vogel" else fit_walther(T, [v / density for v in eta], density)
        )


_WHERE = Location({}, ("lubricant",))


def lubricant_from_table(
    data: Mapping[str, object], get_named: Callable[[str], Lubricant], where: Location = _WHERE
) -> Lubricant:
    """Make the oil that the ``[lubricant]`` table of a scene describes.

    With ``name`` every other key overrides that shipped oil; without it the table describes an own oil, and what it
    does not give, that oil lacks. ``viscosity_law`` goes through ``points``, each with a ``temperature`` and either a
    ``viscosity`` or a ``kinematic_viscosity``. The fit holds over the span of the points and 20 K beyond, within the
    range of the named oil, unless ``minimum_temperature`` or ``maximum_temperature`` say otherwise.
    ``pressure_viscosity`` is constant, so that gamma is zero. The factors are those of `Lubricant`.

    Parameters
    ----------
    data : mapping
        The table as written: numbers in SI, or strings with a unit; its keys are the fields of `OilTable`.
    get_named : callable
        Returns the shipped oil of a name; what it raises for an unknown one is passed on.
    where : Location
        Place of the table, for messages; with the origins of a scene they name file and line.

    Returns
    -------
    Lubricant
        Its `source` ends with the keys that the scene has set.

    Raises
    ------
    SceneError
        With the problems of the table, each as ``lubricant.KEY: sentence``.

    Examples
    --------
    >>> measured = [
    ...     {"temperature": "40 degC", "kinematic_viscosity": "14 mm2/s"},
    ...     {"temperature": "100 degC", "kinematic_viscosity": "3.4 mm2/s"},
    ... ]
    >>> own = {"viscosity_law": "walther", "density": "950 kg/m3", "points": measured}
    >>> round(lubricant_from_table(own, get_named={}.__getitem__).at(313.15).viscosity, 9)
    0.0133
    """
    problems: list[str] = []
    table = structure(OilTable, data, where, problems)
    if table is None:
        raise SceneError(problems)

    given = {key: value for key, value in asdict(table, recurse=False).items() if value not in (None, ())}
    changes = {key: value for key, value in given.items() if key in fields_dict(Lubricant)}
    if table.law is not None:
        changes["pressure_viscosity_law"] = table.law
    changes |= {key: Constant(given[key]) for key in ("pressure_viscosity", "conductivity") if key in given}
    base = None if table.name is None else get_named(table.name)
    set_here = ", ".join(key for key in given if key not in ("name", "description", "source"))
    origins = (base.source if base else None, table.source, set_here and f"Set by the scene: {set_here}.")
    changes["source"] = " ".join(filter(None, origins))
    try:
        if table.points:
            T = [point.temperature for point in table.points]
            low, high = (0.0, math.inf) if base is None else (base.minimum_temperature, base.maximum_temperature)
            changes = {
                "viscosity": table.fit(),
                "minimum_temperature": max(low, min(T) - _MARGIN),
                "maximum_temperature": min(high, max(T) + _MARGIN),
            } | changes
        return (
            Lubricant(**{"name": "own oil", "description": "", **changes}) if base is None else evolve(base, **changes)
        )
    except FieldError as error:
        raise SceneError([where.at(error.field).says(error.reason)]) from error
    except ValueError as error:  # from a fit
        raise SceneError([where.at("points").says(str(error))]) from error
