"""The ``[lubricant]`` table of a scene, and the oil that it describes: a shipped one, the user's own, or both."""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, Final, TypeAlias

from attrs import Attribute, evolve, fields_dict, frozen
from attrs.validators import and_, deep_iterable, optional

from rollslip.errors import SceneError
from rollslip.fields import FieldError, Ranges, Span, field, non_negative, one_of, own_unit, positive, within_possible
from rollslip.lubricant.fits import fit_vogel, fit_walther
from rollslip.lubricant.oil import Lubricant, positive_field
from rollslip.lubricant.pressure import Barus, PressureViscosity, Roelands, Yasutomi
from rollslip.lubricant.temperature import Constant, SmoothTable, Table, TemperatureLaw
from rollslip.structure import FrozenTable, Location, structure

__all__ = ["OilPoint", "OilTable", "OverTemperature", "lubricant_from_table"]

_MARGIN = 20.0  # K, by which the validity of a fitted law reaches beyond its points
_ANY = (1.0, 1e4)  # K: constants are taken at the temperature of the scene, whatever it is

#: Slope -> the property that it belongs to.
_SLOPES = {"thermoviscosity": "viscosity", "pressure_thermoviscosity": "pressure_viscosity"}


#: What is usual, and what is possible, of properties that stand in several tables.
_TEMPERATURE: Final[Ranges] = {"usual": (213.15, 573.15), "possible": (123.15, 1273.15)}
_FACTOR: Final[Ranges] = {"usual": (0.1, 10), "possible": (1e-9, 1e9)}
_VISCOSITY: Final[Ranges] = {"usual": (5e-4, 3.0), "possible": (1e-5, 1e6)}
_PROPERTIES = {*_SLOPES, *_SLOPES.values(), "density", "conductivity", "eyring_stress", "shear_modulus"}


@frozen(kw_only=True)
class OilPoint:
    """A measured viscosity of an own oil."""

    temperature: float = positive_field("K", "temperature", **_TEMPERATURE)
    viscosity: float | None = positive_field("Pa s", "dynamic viscosity", None, **_VISCOSITY)
    kinematic_viscosity: float | None = positive_field(
        "m2/s", "kinematic viscosity", None, usual=(5e-7, 5e-3), possible=(1e-8, 10)
    )

    def __attrs_post_init__(self) -> None:
        if (self.viscosity is None) == (self.kinematic_viscosity is None):
            raise FieldError("viscosity", "give either viscosity or kinematic_viscosity")


@frozen(kw_only=True)
class OverTemperature:
    """A property of an oil as a table over temperature."""

    temperature: tuple[float, ...] = field(
        unit="K", doc="rising temperatures, two or more", validator=deep_iterable(positive), **_TEMPERATURE
    )
    value: tuple[float, ...] = own_unit("the property at each")

    def __attrs_post_init__(self) -> None:
        if len(self.temperature) < 2:
            raise FieldError("temperature", f"a table needs two or more temperatures, not {len(self.temperature)}")
        if len(self.value) != len(self.temperature):
            raise FieldError("value", f"needs one value for each of {len(self.temperature)}, not {len(self.value)}")
        if any(low >= high for low, high in pairwise(self.temperature)):
            raise FieldError("temperature", "must rise")


@frozen
class _Each:
    """Validator: every value of a property is allowed."""

    allowed: Callable[[Any, Any, Any], object]

    def __call__(self, instance: object, attribute: "Attribute[Any]", value: object) -> None:
        for one in value.value if isinstance(value, OverTemperature) else () if value is None else (value,):
            self.allowed(instance, attribute, one)


def _property(
    unit: str,
    doc: str,
    allowed: Callable[[Any, Any, Any], object] | None = positive,
    *,
    usual: Span,
    possible: Span,
) -> Any:
    """Declare a property of the oil: a constant or a table over temperature."""
    each = within_possible if allowed is None else and_(allowed, within_possible)
    return field(unit=unit, doc=doc, default=None, validator=_Each(each), usual=usual, possible=possible)


Property: TypeAlias = float | OverTemperature | None


@frozen(kw_only=True)
class OilTable:
    """The ``[lubricant]`` table of a scene as written: what it leaves out is None; see `lubricant_from_table`."""

    name: str | None = field(default=None, doc="a shipped oil, whose data the other keys override")
    description: str | None = field(default=None, doc="what the oil is")
    source: str | None = field(default=None, doc="where the data of this table come from")
    viscosity: Property = _property("Pa s", "dynamic viscosity", positive, **_VISCOSITY)
    thermoviscosity: Property = _property(
        "1/K", "its fall with temperature beta0 = -dln(eta0)/dT", non_negative, usual=(3e-3, 0.2), possible=(0, 10)
    )
    viscosity_law: str | None = field(
        default=None, doc="law through the points", validator=optional(one_of("walther", "vogel"))
    )
    points: tuple[OilPoint, ...] = field(default=(), doc="measured viscosities, in place of viscosity")
    density: Property = _property(
        "kg/m3",
        "density, between kinematic and dynamic viscosity, and for drags",
        usual=(600, 2000),
        possible=(100, 2e4),
    )
    pressure_viscosity: Property = _property(
        "1/Pa", "pressure-viscosity coefficient alpha", usual=(2e-9, 6e-8), possible=(1e-12, 1e-6)
    )
    pressure_thermoviscosity: Property = _property(
        "1/(Pa K)",
        "its fall with temperature gamma = -dalpha/dT, of any sign",
        None,
        usual=(-1e-9, 2e-9),
        possible=(-1e-6, 1e-6),
    )
    pressure_viscosity_law: str | None = field(
        default=None,
        doc="how viscosity rises with pressure",
        validator=optional(one_of("barus", "roelands", "yasutomi")),
    )
    yasutomi: Yasutomi | None = field(default=None, doc="constants of Yasutomi's law")
    conductivity: Property = _property("W/(m K)", "thermal conductivity", usual=(0.05, 0.7), possible=(1e-3, 100))
    eyring_stress: Property = _property("Pa", "Eyring stress", usual=(2e5, 5e7), possible=(100, 1e11))
    shear_modulus: Property = _property("Pa", "shear modulus", usual=(1e6, 1e10), possible=(100, 1e13))
    eyring_stress_slope: float | None = field(
        default=None,
        unit="1",
        doc="rise of the Eyring stress with pressure, from eyring_stress at none",
        validator=optional(non_negative),
        usual=(0, 0.3),
        possible=(0, 100),
    )
    shear_modulus_slope: float | None = field(
        default=None,
        unit="1",
        doc="rise of the shear modulus with pressure",
        validator=optional(non_negative),
        usual=(0, 10),
        possible=(0, 1e4),
    )
    minimum_temperature: float | None = positive_field(
        "K", "lowest temperature at which the data hold", None, **_TEMPERATURE
    )
    maximum_temperature: float | None = positive_field(
        "K", "highest temperature at which the data hold", None, **_TEMPERATURE
    )
    viscosity_factor: float | None = positive_field("1", "factor on the viscosity", None, **_FACTOR)
    pressure_viscosity_factor: float | None = positive_field(
        "1", "factor on the pressure-viscosity coefficient", None, **_FACTOR
    )
    pressure_thermoviscosity_factor: float | None = positive_field(
        "1", "factor on the slope of that coefficient", None, **_FACTOR
    )

    def __attrs_post_init__(self) -> None:
        if self.name is None and not self.points and self.viscosity is None:
            raise FieldError("name", "missing; name a shipped oil, or give viscosity, or viscosity_law and points")
        if self.points and self.viscosity is not None:
            raise FieldError("viscosity", "not beside points, which are the viscosity; leave one of them out")
        if self.points and self.viscosity_law is None:
            raise FieldError("viscosity_law", "missing; the points need 'walther' or 'vogel'")
        if not self.points and self.viscosity_law:
            raise FieldError("points", "missing; viscosity_law serves to fit them")
        if self.name is None and isinstance(self.viscosity, float) and self.thermoviscosity is None:
            raise FieldError(
                "thermoviscosity",
                "missing; one viscosity does not say how it falls with temperature, on which heated films rest",
            )
        kinematic = any(point.viscosity is None for point in self.points)
        if self.density is None and (kinematic or self.viscosity_law == "walther"):
            raise FieldError("density", "missing; it stands between kinematic and dynamic viscosity")
        if (self.yasutomi is None) == (self.pressure_viscosity_law == "yasutomi"):
            raise FieldError("yasutomi", "the constants and pressure_viscosity_law = 'yasutomi' need each other")
        for key in ("pressure_viscosity", "pressure_thermoviscosity") if self.yasutomi is not None else ():
            if getattr(self, key) is not None:
                raise FieldError(key, "not with Yasutomi's law, which fixes it; leave it out")

    @property
    def law(self) -> PressureViscosity | None:
        """Law of viscosity with pressure, None if the table says nothing of it."""
        return self.yasutomi or {"barus": Barus(), "roelands": Roelands()}.get(self.pressure_viscosity_law or "")

    def fit(self) -> TemperatureLaw:
        """Viscosity law through the points."""
        T = [point.temperature for point in self.points]
        density = Constant(math.nan) if self.density is None else _law(self.density)  # only read where it must be given
        eta = [point.viscosity or density(point.temperature) * (point.kinematic_viscosity or math.nan)
               for point in self.points]  # fmt: skip
        if self.viscosity_law == "vogel":
            return fit_vogel(T, eta)
        reference = density(T[0])
        return fit_walther(T, [value / reference for value in eta], reference)


_WHERE = Location({}, ("lubricant",))
_OF_OILS: Final = fields_dict(Lubricant).keys()
_OF_TABLE: Final = tuple(fields_dict(OilTable))


def lubricant_from_table(
    data: Mapping[str, object], get_named: Callable[[str], Lubricant], where: Location = _WHERE
) -> Lubricant:
    """Make the oil that the ``[lubricant]`` table of a scene describes.

    With ``name`` every other key overrides that shipped oil; without it the table describes an own oil, and what it
    does not give, that oil lacks. ``viscosity_law`` goes through ``points``, each with a ``temperature`` and either a
    ``viscosity`` or a ``kinematic_viscosity``. The fit holds over the span of the points and 20 K beyond, within the
    range of the named oil, unless ``minimum_temperature`` or ``maximum_temperature`` say otherwise.

    A property is a constant, as papers give it at their working temperature, or a table over temperature,
    ``{ temperature = ["40 degC", "100 degC"], value = ["12 1/GPa", "8 1/GPa"] }``: a smooth curve, which brings its own
    slope and holds between its ends. A constant replaces the value alone: beside a constant ``viscosity`` or
    ``pressure_viscosity`` a named oil keeps its own beta0 or gamma; without a named oil gamma of a constant is zero.
    ``thermoviscosity`` and ``pressure_thermoviscosity`` replace the slopes; `Lubricant.notes` says where they are not
    those of the laws. The factors are those of `Lubricant`.

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

    given = {key: value for key in _OF_TABLE if (value := getattr(table, key)) not in (None, ())}
    base = None if table.name is None else get_named(table.name)
    changes = {key: value for key, value in given.items() if key in _OF_OILS} | _laws(given, base)
    if table.law is not None:
        changes["pressure_viscosity_law"] = table.law
    set_here = ", ".join(key for key in given if key not in ("name", "description", "source"))
    origins = (base.source if base else None, table.source, set_here and f"Set by the scene: {set_here}.")
    changes["source"] = " ".join(filter(None, origins))
    if base is not None:
        changes["grades"] = FrozenTable({key: grade for key, grade in base.grades.items() if key not in changes})
    try:
        low, high = _ANY if base is None else (base.minimum_temperature, base.maximum_temperature)
        if table.points:
            T = [point.temperature for point in table.points]
            low, high = max(low, min(T) - _MARGIN), min(high, max(T) + _MARGIN)
            changes["viscosity"] = table.fit()
        for key, value in given.items():
            if isinstance(value, OverTemperature):
                low, high = max(low, value.temperature[0]), min(high, value.temperature[-1])
                if low >= high:
                    raise FieldError(key, "has no temperatures in common with the rest of the oil's data")
        changes = {"minimum_temperature": low, "maximum_temperature": high} | changes
        return (
            Lubricant(**{"name": "own oil", "description": "", **changes}) if base is None else evolve(base, **changes)
        )
    except FieldError as error:
        raise SceneError([where.at(error.field).says(error.reason)]) from error
    except ValueError as error:  # from a fit
        raise SceneError([where.at("points").says(str(error))]) from error


def _law(value: float | OverTemperature, *, of_any_sign: bool = False) -> TemperatureLaw:
    """A property as it is given, as a law; one that may be zero or negative is linear between its values."""
    if not isinstance(value, OverTemperature):
        return Constant(value)
    return (Table if of_any_sign else SmoothTable)(value.temperature, value.value)


def _laws(given: Mapping[str, Any], base: Lubricant | None) -> dict[str, Any]:
    """Laws of the properties that are given, and the slopes that a named oil keeps beside a constant."""
    laws: dict[str, Any] = {}
    for key in _PROPERTIES & given.keys():
        constant = not isinstance(given[key], OverTemperature)
        plain = constant and key in ("eyring_stress", "shear_modulus")  # single numbers, which can be varied and fitted
        laws[key] = given[key] if plain else _law(given[key], of_any_sign=key in _SLOPES)
    for slope, key in _SLOPES.items():
        if slope in given:
            continue
        if key in given and not isinstance(given[key], OverTemperature) and base is not None:
            laws[slope] = getattr(base, slope) or _Fall(base, slope)
        elif key in given or (key == "viscosity" and "points" in given):
            laws[slope] = None  # that of the new law
    return laws


@frozen
class _Fall:
    """Slope of a law of a named oil, which a constant of the scene leaves as it is."""

    oil: Lubricant
    slope: str

    def __call__(self, T: float) -> float:
        return self.oil.falls(T)[list(_SLOPES).index(self.slope)]
