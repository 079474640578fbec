"""The ``[lubricant]`` table of a scene, and the oil that it describes: a shipped one, the user's own, or both.

1. Read the table (`OilTable`) and its law of viscosity under pressure.
2. Collect the properties that it states, as laws of temperature (`_laws`), over those of the named oil.
3. Add properties that the kind of base oil suggests (`OilTable.estimates`).
4. Fit the viscosity to points or to a grade (`OilTable.fit`, `rollslip.lubricant.fits`).
5. Intersect the temperature ranges of all data (`_temperature_range`).
"""

import math
import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any, ClassVar, Final, TypeAlias

from attrs import Attribute, asdict, evolve, fields_dict, frozen
from attrs import field as attrib
from attrs.validators import and_, deep_iterable, optional

from rollslip.errors import SceneError
from rollslip.fields import (
    FieldError,
    Ranges,
    Span,
    choice_of,
    field,
    non_negative,
    own_unit,
    positive,
    refuse_if,
    unusual,
    within_possible,
)
from rollslip.lubricant.base_oil import (
    BASE_OILS,
    ISO_GRADES,
    estimate_properties,
    exponent_factor,
    falling_density,
    viscosity_at_100,
    viscosity_index,
)
from rollslip.lubricant.fits import fit_vogel, fit_walther
from rollslip.lubricant.oil import SLOPES, Lubricant, positive_field, scatter_of
from rollslip.lubricant.pressure import (
    ALPHAS,
    DEFAULT_LAW,
    PressureViscosity,
    built_in_law,
    default_law,
)
from rollslip.lubricant.temperature import Constant, Product, SmoothTable, Table, TemperatureLaw
from rollslip.structure import FrozenTable, Location, structure
from rollslip.units import format_quantity

__all__ = [
    "OilPoint",
    "OilTable",
    "OverTemperature",
    "deviation_of",
    "index_of",
    "lubricant_from_table",
    "unusual_properties",
]

#: Range by which a fitted law is extrapolated beyond its points [K]. Doubling it accepts temperatures at which the law
#: is less certain. Chosen.
_MARGIN = 20.0
#: Range by which Walther's law is extrapolated below its points [K]: from 40 degC to 0 degC, as for the built-in oils,
#: which have this law through 40 and 100 degC. Doubling it accepts temperatures near the pour point, where none holds.
_MARGIN_BELOW = 40.0
#: 40 degC [K], the temperature of ISO 3448 grades.
_AT_40 = 313.15
#: 100 degC [K], the second temperature of the viscosity index.
_AT_100 = 373.15
#: Temperature range of an oil whose properties are constants [K]: any temperature of a scene.
_ANY = (1.0, 1e4)

#: Usual and possible temperatures of oil data [K].
_TEMPERATURE: Final[Ranges] = {"usual": (213.15, 573.15), "possible": (123.15, 1273.15)}
#: Usual and possible factors on properties [1].
_FACTOR: Final[Ranges] = {"usual": (0.1, 10), "possible": (1e-9, 1e9)}
#: Usual and possible dynamic viscosities [Pa s]: from hot jet-engine oils to cold gear oils.
_VISCOSITY: Final[Ranges] = {"usual": (5e-4, 3.0), "possible": (1e-5, 1e6)}
#: Properties that may be constants or tables over temperature.
_PROPERTIES = {
    *SLOPES,
    *SLOPES.values(),
    "density",
    "conductivity",
    "eyring_stress",
    "shear_modulus",
}

_IN_POINTS: Final = (
    "points take it: [{ temperature = '40 degC', kinematic_viscosity = '68 mm2/s' }, ...]"
)


@frozen(kw_only=True)
class OilPoint:
    """A measured viscosity of the user's own oil."""

    #: Key that users write by mistake -> advice.
    advice: ClassVar[Mapping[str, str]] = {
        "viscosity": "kinematic_viscosity takes a kinematic one",
        "nu": "unknown key; write kinematic_viscosity",
    }

    temperature: float = positive_field("K", "temperature", **_TEMPERATURE)
    viscosity: float | None = positive_field("Pa s", "dynamic viscosity", None, **_VISCOSITY)
    kinematic_viscosity: float | None = positive_field(
        "m2/s", "kinematic viscosity", None, usual=(5e-7, 5e-3), possible=(1e-8, 10)
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            (self.viscosity is None) == (self.kinematic_viscosity is None),
            "viscosity",
            "give either viscosity or kinematic_viscosity",
        )


@frozen(kw_only=True)
class OverTemperature:
    """A property of an oil as a table over temperature."""

    temperature: tuple[float, ...] = field(
        unit="K",
        doc="rising temperatures, two or more",
        validator=deep_iterable(positive),
        **_TEMPERATURE,
    )
    value: tuple[float, ...] = own_unit("the property at each")

    def __attrs_post_init__(self) -> None:
        refuse_if(
            len(self.temperature) < 2,
            "temperature",
            f"a table needs two or more temperatures, not {len(self.temperature)}",
        )
        refuse_if(
            len(self.value) != len(self.temperature),
            "value",
            f"needs one value for each of {len(self.temperature)}, not {len(self.value)}",
        )
        refuse_if(
            any(low >= high for low, high in pairwise(self.temperature)), "temperature", "must rise"
        )


@frozen
class _Each:
    """Validator: apply a validator to each value of a property."""

    validator: Callable[[Any, Any, Any], object]

    def __call__(self, instance: object, attribute: "Attribute[Any]", value: object) -> None:
        if isinstance(value, OverTemperature):
            for element in value.value:
                self.validator(instance, attribute, element)
        elif value is not None:
            self.validator(instance, attribute, value)


def _property(
    unit: str,
    doc: str,
    *checks: Callable[[Any, Any, Any], object],
    usual: Span,
    possible: Span,
) -> Any:
    """Declare a property of the oil, a constant or a table over temperature, with checks of each value."""
    each = and_(*checks, within_possible)
    return field(
        unit=unit, doc=doc, default=None, validator=_Each(each), usual=usual, possible=possible
    )


Property: TypeAlias = float | OverTemperature | None
#: Reads a law of viscosity under pressure from a name or table, its location, and a list to which faults are added.
ReadLaw: TypeAlias = Callable[[object, Location, list[str]], Any]


@frozen(kw_only=True)
class OilTable:
    """The ``[lubricant]`` table of a scene as it is written, None for missing keys; see `lubricant_from_table`."""

    advice: ClassVar[Mapping[str, str]] = {
        "viscosity": _IN_POINTS,
        "kinematic_viscosity": f"unknown key; {_IN_POINTS}",
    }

    name: str | None = field(default=None, doc="a shipped oil, whose data the other keys override")
    description: str | None = field(default=None, doc="what the oil is")
    source: str | None = field(default=None, doc="where the data of this table come from")
    viscosity: Property = _property("Pa s", "dynamic viscosity", positive, **_VISCOSITY)
    thermoviscosity: Property = _property(
        "1/K",
        "its fall with temperature beta0 = -dln(eta0)/dT",
        non_negative,
        usual=(3e-3, 0.2),
        possible=(0, 10),
    )
    base_oil: str | None = field(
        default=None,
        doc="kind of base oil, by which an own oil gets what it does not state",
        validator=optional(choice_of(*BASE_OILS)),
    )
    iso_grade: str | None = field(
        default=None, doc="grade of an own oil after ISO 3448, such as 'VG 68'"
    )
    viscosity_index: float | None = field(
        default=None,
        unit="1",
        doc="viscosity index, with iso_grade or one viscosity at 40 degC",
        usual=(0, 300),
        possible=(-200, 500),
        validator=optional(within_possible),
    )
    viscosity_law: str | None = field(
        default=None,
        doc="law through the points, by default walther of an own oil of known base_oil",
        validator=optional(choice_of("walther", "vogel")),
    )
    points: tuple[OilPoint, ...] = field(
        default=(), doc="measured viscosities, in place of viscosity"
    )
    density: Property = _property(
        "kg/m3",
        "density, between kinematic and dynamic viscosity, and for drags",
        positive,
        usual=(600, 2000),
        possible=(100, 2e4),
    )
    pressure_viscosity: Property = _property(
        "1/Pa",
        "pressure-viscosity coefficient alpha",
        positive,
        usual=(2e-9, 6e-8),
        possible=(1e-12, 1e-6),
    )
    pressure_thermoviscosity: Property = _property(
        "1/(Pa K)",
        "its fall with temperature gamma = -dalpha/dT, of any sign",
        usual=(-1e-9, 2e-9),
        possible=(-1e-6, 1e-6),
    )
    pressure_viscosity_kind: str | None = field(
        default=None,
        doc="which alpha pressure_viscosity is: the tangent at no pressure, or that of films, 1/integral(eta0/eta dp)",
        validator=optional(choice_of(*ALPHAS)),
    )
    pressure_viscosity_law: Any = attrib(
        default=None,
        metadata={
            "kind": "pressure-viscosity",
            "unit": None,
            "doc": f"how viscosity rises with pressure, by default {DEFAULT_LAW}",
        },
    )
    conductivity: Property = _property(
        "W/(m K)", "thermal conductivity", positive, usual=(0.05, 0.7), possible=(1e-3, 100)
    )
    eyring_stress: Property = _property(
        "Pa", "Eyring stress", positive, usual=(2e5, 5e7), possible=(100, 1e11)
    )
    shear_modulus: Property = _property(
        "Pa", "shear modulus", positive, usual=(1e6, 1e10), possible=(100, 1e13)
    )
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
    models: FrozenTable | None = field(
        default=None,
        doc="constants of the oil for laws, defaults of their parameters: a table for each law by name; beside these "
        "what all laws have that know the key",
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

    pressure_exponent_factor: float | None = positive_field(
        "1",
        "factor on ln(eta/eta0) under pressure, which leaves the film's alpha",
        None,
        usual=(0.5, 2),
        possible=(0.01, 100),
    )

    def __attrs_post_init__(self) -> None:
        own = self.name is None
        self._check_sources_of_viscosity(own)
        self._check_points(own)
        estimable = self.base_oil is not None and own
        refuse_if(
            self.points and self.viscosity_law is None and not estimable,
            "viscosity_law",
            "missing; the points need 'walther' or 'vogel', or base_oil, of which it is 'walther'",
        )
        refuse_if(
            not self.points and self.viscosity_law,
            "points",
            "missing; viscosity_law serves to fit them",
        )
        refuse_if(
            own and isinstance(self.viscosity, float) and self.thermoviscosity is None,
            "thermoviscosity",
            "missing; one viscosity does not say how it falls with temperature, on which heated films rest; give "
            "it, or points at two temperatures, or iso_grade and base_oil",
        )
        kinematic = any(point.viscosity is None for point in self.points)
        refuse_if(
            (
                self.density is None
                and (kinematic or self.viscosity_law == "walther")
                and not estimable
            ),
            "density",
            "missing; it stands between kinematic and dynamic viscosity; give it, or base_oil",
        )

    def _check_sources_of_viscosity(self, own: bool) -> None:
        """Refuse a table without viscosity, or with two sources of it."""
        refuse_if(
            own and not self.points and self.viscosity is None and self.iso_grade is None,
            "name",
            "missing; name a shipped oil, or give viscosity, or points with kinematic_viscosity, or iso_grade, "
            "with base_oil for what a data sheet does not say",
        )
        refuse_if(
            self.points and self.viscosity is not None,
            "viscosity",
            "not beside points, which are the viscosity; leave one of them out",
        )
        if self.iso_grade is not None:
            refuse_if(
                not own or self.points or self.viscosity is not None,
                "iso_grade",
                "not beside a name, points or viscosity, which say more; leave it out",
            )
            refuse_if(
                self.base_oil is None,
                "base_oil",
                f"missing; a grade alone is not an oil: {', '.join(BASE_OILS)} (kind of base oil)",
            )
        elif self.viscosity_index is not None:
            refuse_if(
                not (own and self._is_point_at_40),
                "viscosity_index",
                "goes with iso_grade, or with one point at 40 degC; leave it out",
            )

    def _check_points(self, own: bool) -> None:
        """Refuse a single point from which the slope with temperature does not follow."""
        if len(self.points) == 1 and self.viscosity_index is None and own:
            point = self.points[0]
            raise FieldError(
                "points",
                f"one viscosity, at {format_quantity(point.temperature, 'K')}, does not say how it falls with "
                "temperature; give a second point at another temperature"
                + (", or viscosity_index" if self._is_point_at_40 else ""),
            )

    @property
    def _is_point_at_40(self) -> bool:
        """Whether the only point is at 40 degC, so that a viscosity index completes it."""
        return len(self.points) == 1 and abs(self.points[0].temperature - _AT_40) < 0.5

    @property
    def grade(self) -> int:
        """Grade of ISO 3448 as a number [mm2/s]."""
        match = re.fullmatch(
            r"(?:ISO)?[\s-]*(?:VG)?[\s-]*(\d+)(?:\.0)?", str(self.iso_grade).strip(), re.IGNORECASE
        )
        if match is None or int(match[1]) not in ISO_GRADES:
            grades = ", ".join(map(str, ISO_GRADES))
            raise FieldError(
                "iso_grade",
                f"{self.iso_grade!r} is not a grade of ISO 3448, such as 'VG 68'; there are {grades}",
            )
        return int(match[1])

    def rho(self) -> TemperatureLaw | None:
        """Return the density [kg/m3], that of the base oil where none is stated; None without both."""
        if self.density is not None:
            return _law(self.density)
        return None if self.base_oil is None else falling_density(*BASE_OILS[self.base_oil].density)

    def nu(self) -> list[tuple[float, float]]:
        """Return temperatures [K] and kinematic viscosities [m2/s] of the table; empty where it has other data."""
        rho = self.rho()
        if self.iso_grade is not None:
            found = [(_AT_40, 1e-6 * self.grade)]
        elif isinstance(self.viscosity, OverTemperature) and rho is not None:
            pairs = zip(self.viscosity.temperature, self.viscosity.value, strict=True)
            return [(T, eta / rho(T)) for T, eta in pairs]
        else:
            points = ((p.temperature, p.kinematic_viscosity, p.viscosity) for p in self.points)
            found = [
                (T, nu if nu else (eta or math.nan) / rho(T))  # type: ignore[misc]
                for T, nu, eta in points
                if nu or rho is not None
            ]
        if len(found) == 1 and self.base_oil is not None:
            index = (
                self.viscosity_index
                if self.viscosity_index is not None
                else BASE_OILS[self.base_oil].viscosity_index
            )
            hot = viscosity_at_100(found[0][1], index)
            refuse_if(
                math.isnan(hot),
                "viscosity_index",
                f"{index:g} is possible of no oil of this viscosity; check both",
            )
            found.append((_AT_100, hot))
        return found

    def fit(self) -> TemperatureLaw:
        """Return the viscosity law through the points, or of the grade."""
        rho = self.rho()
        if self.viscosity_law == "vogel":
            eta = [point.viscosity or rho(point.temperature) * (point.kinematic_viscosity or math.nan)  # type: ignore[misc]
                   for point in self.points]  # fmt: skip
            return fit_vogel([point.temperature for point in self.points], eta)
        temperatures, nu = zip(*self.nu(), strict=True)
        if self.base_oil is not None and self.density is None:
            return Product(fit_walther(temperatures, nu, density=1.0), rho)  # type: ignore[arg-type]
        reference = rho(temperatures[0])  # type: ignore[misc]
        scaled = [rho(T) * v / reference for T, v in zip(temperatures, nu, strict=True)]  # type: ignore[misc]
        return fit_walther(temperatures, scaled, reference)

    def estimates(self) -> tuple[dict[str, Any], str]:
        """Return the properties that the base oil suggests for missing ones, and a sentence on their sources."""
        if self.base_oil is None or self.name is not None:
            return {}, ""
        points = self.nu()
        kinematic = None
        if len(points) > 1:
            kinematic = fit_walther([T for T, _ in points], [nu for _, nu in points], density=1.0)
        stated = {key: getattr(self, key) for key in _PROPERTIES}
        return estimate_properties(self.base_oil, kinematic, stated)


_WHERE = Location({}, ("lubricant",))


def _read_built_in_law(
    raw: object, where: Location, problems: list[str]
) -> PressureViscosity | None:
    """Read a law that comes with rollslip from a name or a table with ``model``; other packages are not searched."""
    if isinstance(raw, PressureViscosity):
        return raw
    table = dict(raw) if isinstance(raw, Mapping) else {"model": raw}
    try:
        return structure(built_in_law(str(table.pop("model", None))), table, where, problems)
    except KeyError as error:
        problems.append(
            where.message(f"no law of viscosity under pressure is called {error.args[0]!r}")
        )
        return None


_OIL_FIELDS: Final = fields_dict(Lubricant).keys()
_TABLE_FIELDS: Final = tuple(fields_dict(OilTable))


def lubricant_from_table(
    data: Mapping[str, object],
    get_named: Callable[[str], Lubricant],
    where: Location = _WHERE,
    read_law: ReadLaw = _read_built_in_law,
) -> Lubricant:
    """Return the oil that the ``[lubricant]`` table of a scene describes.

    With ``name`` all other keys override the data of that shipped oil. Without it the table describes the user's own
    oil, which lacks properties that the table does not state, or has those of its ``base_oil``: then a data sheet is
    sufficient, with viscosities at two temperatures or ``iso_grade``. ``viscosity_law`` is fitted to ``points``, each
    with a ``temperature`` and either a ``viscosity`` or a ``kinematic_viscosity``. The range of the fit is that of the
    points and 20 K beyond, by Walther's law 40 K below, within the range of the named oil, unless
    ``minimum_temperature`` or ``maximum_temperature`` state another one.

    A property is a constant, as papers give it at their working temperature, or a table over temperature,
    ``{ temperature = ["40 degC", "100 degC"], value = ["12 1/GPa", "8 1/GPa"] }``: a smooth curve with its own slope,
    between its ends. A constant replaces the value only: with a constant ``viscosity`` or ``pressure_viscosity`` a
    named oil retains its beta0 or gamma; without a named oil gamma of a constant is zero. ``thermoviscosity`` and
    ``pressure_thermoviscosity`` replace the slopes; `Lubricant.notes` reports where they are not those of the laws. The
    factors are those of `Lubricant`.

    Parameters
    ----------
    data : mapping
        The table as it is written: numbers in SI units, or texts with a unit; its keys are the fields of `OilTable`.
    get_named : callable
        Returns the shipped oil of a name; its exception for an unknown name is passed on.
    where : Location
        Location of the table, for messages; with the origins of a scene they name file and line.
    read_law : callable
        Returns the law of viscosity under pressure of a name or table at a location, and adds faults to a list; by
        default a law that comes with rollslip.

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
    data = _with_grade_as_text(data)
    table = structure(OilTable, data, where, problems)
    law = None
    if table is not None and table.pressure_viscosity_law is not None:
        law = read_law(table.pressure_viscosity_law, where.at("pressure_viscosity_law"), problems)
    if table is None or problems:
        raise SceneError(problems)

    stated = {
        key: value for key in _TABLE_FIELDS if (value := getattr(table, key)) not in (None, ())
    }
    base = None if table.name is None else get_named(table.name)
    changes = {key: value for key, value in stated.items() if key in _OIL_FIELDS}
    changes |= _laws(stated, base)
    if law is not None:
        changes["pressure_viscosity_law"] = law
        _check_alpha_of_law(law, stated, where)
    if base is not None:
        changes |= _models_and_grades(table, base, changes)
    try:
        estimates, note = table.estimates()
        changes = estimates | changes
        changes["source"] = _source(table, stated, base, note)
        if table.points or table.iso_grade is not None:
            changes["viscosity"] = table.fit()
        low, high = _temperature_range(table, stated, base)
        changes = {"minimum_temperature": low, "maximum_temperature": high} | changes
        if base is not None:
            return evolve(base, **changes)
        oil = Lubricant(**{"name": "own oil", "description": "", **changes})
        return _with_scatter(oil, estimates, graded=table.iso_grade is not None)
    except FieldError as error:
        raise SceneError([where.at(error.field).message(error.reason)]) from error
    except ValueError as error:  # from a fit
        raise SceneError([where.at("points").message(str(error))]) from error


def _check_alpha_of_law(law: Any, stated: Mapping[str, Any], where: Location) -> None:
    """Refuse an alpha, or its slope, of an oil whose law of viscosity under pressure determines alpha."""
    if math.isnan(law.coefficient(300.0)):
        return
    for key in ("pressure_viscosity", "pressure_thermoviscosity", "pressure_viscosity_kind"):
        if key in stated:
            reason = f"not with law {law.name!r}, which fixes it; leave it out"
            raise SceneError([where.at(key).message(reason)])


def _models_and_grades(
    table: OilTable, base: Lubricant, changes: Mapping[str, Any]
) -> dict[str, FrozenTable]:
    """Return the constants for laws of a named oil with those of the table, and the grades of unchanged properties."""
    grades = {key: grade for key, grade in base.grades.items() if key not in changes}
    models = dict(base.models)
    for key, constants in (table.models or {}).items():
        own = models.get(key)
        if isinstance(own, Mapping) and isinstance(constants, Mapping):
            constants = FrozenTable({**own, **constants})
        models[key] = constants
    return {"models": FrozenTable(models), "grades": FrozenTable(grades)}


def _source(table: OilTable, stated: Mapping[str, Any], base: Lubricant | None, note: str) -> str:
    """Return the sources of an oil: those of the named one, of the table, its keys, and of estimates."""
    keys = ", ".join(key for key in stated if key not in ("name", "description", "source"))
    parts = (
        base.source if base else None,
        table.source,
        keys and f"Set by the scene: {keys}.",
        note,
    )
    return " ".join(filter(None, parts))


def _temperature_range(
    table: OilTable, stated: Mapping[str, Any], base: Lubricant | None
) -> tuple[float, float]:
    """Return the range of temperatures [K] that the named oil, the fit and all tables have in common."""
    low, high = _ANY if base is None else (base.minimum_temperature, base.maximum_temperature)
    if table.points or table.iso_grade is not None:
        T = [T for T, _ in table.nu()] or [point.temperature for point in table.points]
        low = max(low, min(T) - (_MARGIN if table.viscosity_law == "vogel" else _MARGIN_BELOW))
        high = min(high, max(T) + _MARGIN)
    for key, value in stated.items():
        if isinstance(value, OverTemperature):
            low = max(low, value.temperature[0])
            high = min(high, value.temperature[-1])
            refuse_if(
                low >= high, key, "has no temperatures in common with the rest of the oil's data"
            )
    return low, high


def index_of(data: Mapping[str, object]) -> float:
    """Return the viscosity index of the points of a table ``[lubricant]``; nan where it does not follow from them."""
    table = structure(OilTable, _with_grade_as_text(data), _WHERE, [])
    if table is None or len(points := table.nu()) < 2 or not table.points:
        return math.nan
    try:
        law = fit_walther([T for T, _ in points], [nu for _, nu in points], density=1.0)
        return viscosity_index(law(_AT_40), law(_AT_100))
    except (ValueError, ArithmeticError):  # the reader of the oil reports it
        return math.nan


def deviation_of(data: Mapping[str, object]) -> tuple[float, float]:
    """Return the largest relative deviation of Walther's law from the points of a table, and its temperature [K]."""
    table = structure(OilTable, _with_grade_as_text(data), _WHERE, [])
    if table is None or table.viscosity_law == "vogel" or len(table.points) < 3:
        return 0.0, math.nan
    points = table.nu()
    law = fit_walther([T for T, _ in points], [nu for _, nu in points], density=1.0)
    return max(((law(T) / nu - 1.0, T) for T, nu in points), key=lambda item: abs(item[0]))


def _with_grade_as_text(data: Mapping[str, object]) -> Mapping[str, object]:
    """Return a table whose grade is a text."""
    if isinstance(grade := data.get("iso_grade"), int):  # 68 for "VG 68"
        return {**data, "iso_grade": str(grade)}
    return data


def _with_scatter(oil: Lubricant, estimates: Mapping[str, Any], *, graded: bool) -> Lubricant:
    """Return an own oil with the grades and the scatter of the properties that its base oil suggests."""
    if oil.base_oil is None:
        return oil
    base = BASE_OILS[oil.base_oil]
    middle = oil.at((max(oil.minimum_temperature, 290.0) + min(oil.maximum_temperature, 390.0)) / 2)
    exponent = 0.0
    if math.isfinite(middle.pressure_viscosity) and math.isnan(
        oil.pressure_viscosity_law.coefficient(300.0)
    ):
        exponent = exponent_factor(
            default_law(), base.exponent, middle.viscosity, middle.pressure_viscosity
        )
    scatter = scatter_of(
        0.1 * graded,
        "(B)",
        "ISO 3448 allows a grade 10 % either way",
        base.alpha_scatter if "pressure_viscosity" in estimates else 0.0,
        base.alpha_source,
        exponent,
    )
    relevant = tuple(
        datum
        for datum in scatter
        if datum.quantity in estimates or datum.quantity.endswith("_factor")
    )
    grades = {key: base.grades[key] for key in estimates}
    return evolve(oil, scatter=relevant, grades=FrozenTable({**grades, **oil.grades}))


def _law(value: float | OverTemperature, *, of_any_sign: bool = False) -> TemperatureLaw:
    """Return a stated property as a law of temperature; one that may be zero or negative is linear in its table."""
    if not isinstance(value, OverTemperature):
        return Constant(value)
    if of_any_sign:
        return Table(value.temperature, value.value)
    return SmoothTable(value.temperature, value.value)


def _laws(stated: Mapping[str, Any], base: Lubricant | None) -> dict[str, Any]:
    """Return the laws of stated properties, and the slopes that a named oil retains when a value is a constant."""
    laws: dict[str, Any] = {}
    for key in _PROPERTIES & stated.keys():
        laws[key] = stated[key]
        # constants of the shear properties remain numbers, which can be varied and fitted
        if isinstance(stated[key], OverTemperature) or key not in (
            "eyring_stress",
            "shear_modulus",
        ):
            laws[key] = _law(stated[key], of_any_sign=key in SLOPES)
    for slope, key in SLOPES.items():
        if slope in stated:
            continue
        if key in stated and not isinstance(stated[key], OverTemperature) and base is not None:
            laws[slope] = getattr(base, slope) or _Fall(base, slope)
        elif key in stated or (key == "viscosity" and stated.keys() & {"points", "iso_grade"}):
            laws[slope] = None  # that of the new law
    return laws


def unusual_properties(oil: Lubricant) -> dict[str, str]:
    """Return a message on each property of an oil that no usual oil has, by its key in ``[lubricant]``.

    Data in a wrong unit are recognised so: a viscosity in mPa s in place of Pa s is 1000 times too large.

    Parameters
    ----------
    oil : Lubricant
        The oil, at the temperatures of a data sheet, or the next ones in its range.
    """
    attributes = fields_dict(OilTable)
    messages = dict[str, str]()
    for stated in (_AT_40, _AT_100):
        temperature = min(max(stated, oil.minimum_temperature), oil.maximum_temperature)
        values = asdict(oil.at(temperature))
        if oil.density is not None:
            values["density"] = oil.density(temperature)
        for key, value in values.items():
            message = (
                unusual(attributes[key], value)
                if not math.isnan(value) and key in attributes
                else ""
            )
            if message:
                messages[key] = f"at {format_quantity(temperature, 'K')} {message}"
    return messages


@frozen
class _Fall:
    """Slope of a law of a named oil, which a constant value in the scene does not change."""

    oil: Lubricant
    slope: str

    def __call__(self, T: float) -> float:
        return self.oil.falls(T)[list(SLOPES).index(self.slope)]
