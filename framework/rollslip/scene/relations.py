"""Relations between the values of a scene, each with a usual and a possible range.

- Outside the usual range a plan warns (`rollslip.planning.plausibility`); outside the possible range the scene is
  refused.
- The ranges are wide and come from catalogues and handbooks: they detect a wrong unit or a misplaced decimal point, not
  a poor design.
"""

import math
import re
from collections.abc import Callable, Mapping
from functools import partial
from numbers import Real
from typing import Any, Final, TypeAlias

import attrs

from rollslip.fields import FieldError, Span, as_given, format_span
from rollslip.geometry.axial import raceway_diameters
from rollslip.scene.supply import DEEPEST
from rollslip.structure import Location
from rollslip.toml import as_table
from rollslip.units import GRAVITY, format_quantity, likely, unit_given

__all__ = [
    "RELATIONS",
    "Relation",
    "impossible_pressure",
    "impossible_relations",
    "required_axial_load",
    "skf_minimum_load",
    "smallest_tapered_load",
    "tapered_problems",
    "unsupported_axial_load",
]

Scene: TypeAlias = Any
"""A `rollslip.scene.values.Scene`; its tables are read by name here, as relations name them."""

#: Largest roller force times the number of rollers over the radial load [1]: Stribeck's number, with half the rollers
#: loaded. Doubling it raises all pressures that are checked by a factor of 1.4. Handbooks use 5.
_STRIBECK: Final = 5.0
#: Possible pressure [Pa]: at most five times that of the static rating of ISO 76. Doubling the limit would accept loads
#: in a wrong unit. Chosen.
_PRESSURE: Final[Span] = (0, 2e10)
#: Difference of lengths below which two statements of one length agree [m]. Chosen: far below any tolerance, and above
#: the rounding of seven decimals in metres.
_LENGTH_ROUNDING: Final = 2e-7
#: Unit of the speed factor n d_m of catalogues, in which speed limits hardly depend on the size of a bearing.
_SPEED_FACTOR: Final = "mm/min"


@attrs.frozen
class Relation:
    """A quantity that follows from several values of a scene and has a usual and a possible range."""

    #: Table of the value that a message blames: ``operation``.
    table: str
    #: Field of the value that a message blames: ``radial_load``.
    field: str
    #: Returns the quantity of a scene, in `unit`; NaN where it is not defined.
    evaluate: Callable[[Scene], float]
    #: SI unit of the quantity.
    unit: str
    #: Meaning of the quantity, after its value in a sentence: "of the roller diameter".
    meaning: str
    #: Usual range of the quantity.
    usual: Span
    #: Possible range of the quantity.
    possible: Span
    #: Source of the ranges.
    source: str
    #: Usual range where the value is written as a whole number without a unit, possibly not meant in SI units.
    bare: Span | None = None

    def location(self, where: Location) -> Location:
        """Return the location of the blamed value in a scene."""
        return where.at(self.table).at(self.field)

    def written_value(self, raw: Mapping[str, object]) -> object:
        """Return the blamed value as it is written in a raw scene; None if it is not written."""
        return as_table(raw.get(self.table)).get(self.field)

    def attribute(self, scene: Scene) -> "attrs.Attribute[Any]":
        """Return the field of the blamed value."""
        return attrs.fields_dict(type(getattr(scene, self.table)))[self.field]

    def with_value(self, scene: Scene, value: float) -> float:
        """Return the quantity with another blamed value.

        Parameters
        ----------
        scene : Scene
            The scene.
        value : float
            Value in place of the blamed one, in SI units.

        Returns
        -------
        float
            The quantity in `unit`; NaN if the scene cannot have the value.
        """
        table: Any = getattr(scene, self.table)
        try:
            other: Any = attrs.evolve(
                scene, **{self.table: attrs.evolve(table, **{self.field: value})}
            )
        except FieldError:
            return math.nan
        return self.evaluate(other)

    def describe_violation(self, scene: Scene, raw: Mapping[str, object], which: str) -> str:
        """Return a message where the quantity is outside a range; empty where it is inside or not defined.

        Parameters
        ----------
        scene : Scene
            The scene.
        raw : mapping
            The scene as it is written.
        which : str
            Range that is checked: "usual" or "possible".
        """
        written = self.written_value(raw)
        whole = (
            isinstance(written, Real)
            and not isinstance(written, bool)
            and float(written).is_integer()
        )
        span: Span = (
            self.bare
            if which == "usual" and whole and self.bare is not None
            else getattr(self, which)
        )
        amount = self.evaluate(scene)
        if math.isnan(amount) or span[0] <= amount <= span[1]:
            return ""
        attribute = self.attribute(scene)
        unit = attribute.metadata["unit"]
        value: float = getattr(getattr(scene, self.table), self.field)
        given = None if unit is None or written is None else unit_given(written, unit)
        # a clearance in operation is shown as the sum that it follows from
        terms = scene.bearing.mounted if self.field == "radial_clearance" else None
        shown = as_given(value, attribute, given) if terms is None else str(terms)
        text = f"{shown} is {self._format(amount)} {self.meaning}, {self.format_range(span)} is {which}"
        # without an upper limit the value is too small, and any other unit may have been meant
        if unit is None or given is None or math.isinf(span[1]):
            return text
        usual_value: Span = attribute.metadata["usual"]
        meant = likely(
            value,
            given,
            unit,
            lambda other: (
                usual_value[0] <= other <= usual_value[1]
                and self.usual[0] <= self.with_value(scene, other) <= self.usual[1]
            ),
        )
        return text if meant is None else f"{text}; did you mean {meant!r}?"

    def _format(self, amount: float) -> str:
        if self.unit == _SPEED_FACTOR:
            return f"{amount:.2g} {self.unit}"
        return (
            f"{100 * amount:.3g} %" if self.unit == "1" else format_quantity(amount, self.unit, 3)
        )

    def format_range(self, span: Span) -> str:
        """Return a range of the quantity as text."""
        if self.unit == _SPEED_FACTOR:
            return f"at most {self._format(span[1])}"
        if self.unit != "1":
            return format_span(span if span[0] != 0 else (-math.inf, span[1]), self.unit)
        if math.isinf(span[1]):
            return f"at least {100 * span[0]:g} %"
        return f"{100 * span[0]:g} % to {100 * span[1]:g} %"


def _pitch(scene: Scene) -> float:
    """Return the pitch diameter of the rollers [m]."""
    b = scene.bearing
    return float(b.inner_raceway_diameter + b.outer_raceway_diameter) / 2


def _room_left(scene: Scene) -> float:
    """Return the radial play by the diameters minus the stated clearance, over the roller diameter [1].

    NaN where the clearance itself is not plausible, and for tapered rollers, whose axial place decides.
    """
    b = scene.bearing
    if b.contact_angle is not None or abs(b.radial_clearance) > 0.05 * b.roller_diameter:
        return math.nan
    play: float = b.outer_raceway_diameter - b.inner_raceway_diameter - 2 * b.roller_diameter
    return float((play - b.radial_clearance) / b.roller_diameter)


def _speed(scene: Scene, ring: str) -> float:
    """Return the surface speed of a raceway [m/s]."""
    diameter: float = getattr(scene.bearing, f"{ring}_raceway_diameter")
    speed: float = getattr(scene.operation, f"{ring}_speed")
    return abs(speed) * diameter / 2


def _speed_factor(scene: Scene, ring: str) -> float:
    """Return the speed of a ring times the pitch diameter, n d_m [mm/min]."""
    speed: float = getattr(scene.operation, f"{ring}_speed")
    return abs(speed) * 30.0 / math.pi * 1e3 * _pitch(scene)


def _heaviest_contact(scene: Scene) -> tuple[float, float, float]:
    """Return load per length w [N/m], radius R [m] and modulus E' [Pa] of the most heavily loaded inner contact.

    w = 5 F_r/(Z l), as in catalogues: half the rollers are loaded, without clearance, profile, tilt and centrifugal
    force.
    """
    b = scene.bearing
    inner = b.inner_raceway_diameter / 2
    roller = b.roller_diameter / 2
    load: float = _STRIBECK * scene.operation.radial_load / (b.rollers * b.roller_length)
    return (
        load,
        inner * roller / (inner + roller),
        b.material.elastic_modulus / (1 - b.material.poisson_ratio**2),
    )


def _pressure(load: float, radius: float, modulus: float) -> float:
    """Return the largest Hertzian pressure [Pa], sqrt(w E'/(2 pi R))."""
    return math.sqrt(load * modulus / (2 * math.pi * radius))


def impossible_pressure(load: float, radius: float, modulus: float) -> str:
    """Return a message where the Hertzian pressure of a line contact is not possible; empty where it is.

    Parameters
    ----------
    load : float
        Load per length w [N/m].
    radius : float
        Equivalent radius R [m].
    modulus : float
        Equivalent modulus E' [Pa].
    """
    pressure = _pressure(load, radius, modulus)
    if pressure <= _PRESSURE[1]:
        return ""
    limit = format_quantity(_PRESSURE[1], "Pa")
    return (
        f"{format_quantity(pressure, 'Pa', 3)} of pressure after Hertz, at most {limit} is possible"
    )


def _over_half_width(scene: Scene, which: str) -> float:
    """Roughness over the Hertzian half width of the heaviest contact, sqrt(8 w R/(pi E')); NaN without load."""
    load, radius, modulus = _heaviest_contact(scene)
    width = math.sqrt(8 * load * radius / (math.pi * modulus))
    roughness: float = getattr(scene.surface, which)
    return roughness / width if width > 0 else math.nan


def skf_minimum_load(bearing: Any, speed: float) -> float:
    """Return the minimum radial load by SKF's rule.

    F = k_r (6 + 4 n/n_r) (d_m/100)^2 kN with d_m in mm, for one row with a cage (general catalogue 17000, page 509).
    SKF's mean diameter is that of bore and outside; here it is the pitch diameter, up to 1.2 % larger. Without a
    reference speed n_r it is the load at rest, the lower bound of the rule at any speed.

    Parameters
    ----------
    bearing : Bearing
        The bearing, with the values of its catalogue.
    speed : float
        Speed of the inner relative to the outer ring [rad/s].

    Returns
    -------
    float
        Minimum load [N]; NaN where the catalogue does not give the factor k_r.
    """
    given = bearing.catalogue
    if given is None or given.minimum_load_factor is None:
        return math.nan
    pitch = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 2
    fraction = 0.0 if given.reference_speed is None else abs(speed) / given.reference_speed
    return float(1e3 * given.minimum_load_factor * (6.0 + 4.0 * fraction) * (10.0 * pitch) ** 2)


def _rollers_mass(scene: Scene) -> float:
    """Return the mass of all rollers [kg]."""
    b = scene.bearing
    return float(
        b.rollers * b.material.density * math.pi / 4.0 * b.roller_diameter**2 * b.roller_length
    )


def _over_minimum_load(scene: Scene) -> float:
    """Return the radial load over SKF's minimum load [1]; NaN where that is not known."""
    operation = scene.operation
    speed = operation.inner_speed - operation.outer_speed
    return float(operation.radial_load / skf_minimum_load(scene.bearing, speed))


#: All relations, in the order of messages: values that are most likely mistyped come first.
RELATIONS: Final = (
    Relation(
        "bearing",
        "radial_clearance",
        lambda scene: scene.bearing.radial_clearance / scene.bearing.roller_diameter,
        "1",
        "of the roller diameter",
        (-0.005, 0.04),
        (-0.05, 0.5),
        "the groups of ISO 5753-1 end at about 2 %; a preload of 2 % presses rollers of 15 mm with 4 GPa (Palmgren)",
    ),
    Relation(
        "bearing",
        "outer_raceway_diameter",
        _room_left,
        "1",
        "of the roller diameter off what inner raceway, rollers and clearance take",
        (-0.05, 0.05),
        (-1, 1),
        "clearances in operation and at rest differ by less than 2 %",
    ),
    Relation(
        "bearing",
        "roller_length",
        lambda scene: scene.bearing.roller_length / scene.bearing.roller_diameter,
        "1",
        "of the roller diameter",
        (0.4, 12),
        (1e-3, 1e3),
        "the longest rollers, needles, are 3 to 10 diameters long (ISO 3096)",
    ),
    Relation(
        "bearing",
        "rollers",
        lambda scene: (
            scene.bearing.rollers * scene.bearing.roller_diameter / (math.pi * _pitch(scene))
        ),
        "1",
        "of the pitch circle filled with rollers",
        (0.3, 1.01),
        (-math.inf, math.inf),
        "bearings with a cage are 60 to 95 % full (D); more than there is room for is refused by itself",
    ),
    Relation(
        "operation",
        "radial_load",
        lambda scene: _pressure(*_heaviest_contact(scene)),
        "Pa",
        "of pressure in the most loaded contact, after Hertz",
        (0, 5e9),
        _PRESSURE,
        "the static rating of ISO 76 is at 4 GPa",
    ),
    Relation(
        "operation",
        "radial_load",
        _over_minimum_load,
        "1",
        "of SKF's catalogue minimum load (bearing.catalogue)",
        (1, math.inf),
        (-math.inf, math.inf),
        "SKF, general catalogue 17000, page 509: F = k_r (6 + 4 n/n_r) (d_m/100)^2 kN; makers' rules differ by a "
        "factor of 4 to 5",
    ),
    Relation(
        "operation",
        "radial_load",
        lambda scene: (
            scene.operation.radial_load / (GRAVITY * _rollers_mass(scene)) or math.nan
            if scene.operation.gravity_direction is None
            else math.nan
        ),
        "1",
        "of the weight of the rollers, which is left out without operation.gravity_direction",
        (1, math.inf),
        (-math.inf, math.inf),
        "from there on weight decides which rollers are loaded; without load clearance does",
    ),
    Relation(
        "operation",
        "axial_load",
        lambda scene: (
            abs(scene.operation.axial_load or 0.0) / (scene.operation.radial_load or math.nan)
            if scene.bearing.contact_angle is None
            else math.nan
        ),
        "1",
        "of the radial load",
        (0, 0.5),
        (-math.inf, math.inf),
        "SKF, general catalogue 17000: ribs of cylindrical roller bearings bear at most half of the radial load",
    ),
    Relation(
        "lubrication",
        "oil_level",
        lambda scene: (
            math.nan if (level := scene.lubrication.oil_level) is None else level / _pitch(scene)
        ),
        "1",
        "of the pitch diameter",
        (0, DEEPEST),
        (0, 2),
        "SKF's bath drag, up to which the oil between the rollers was checked against it: `rollslip.scene.supply`",
    ),
    *(
        Relation(
            "operation",
            f"{ring}_speed",
            partial(_speed, ring=ring),
            "m/s",
            f"of surface speed of the {ring} raceway",
            (-math.inf, math.inf),
            (0, 3e3),
            "main shafts of aero engines reach 3e6 mm/min of bore and speed, 160 m/s at the bore (B)",
        )
        for ring in ("inner", "outer")
    ),
    *(
        Relation(
            "operation",
            f"{ring}_speed",
            partial(_speed_factor, ring=ring),
            _SPEED_FACTOR,
            "of speed times pitch diameter (n d_m)",
            (0, 1.5e6),
            (-math.inf, math.inf),
            "catalogues limit cylindrical roller bearings to 4 to 6e5, spindles reach 1.5e6, aero engines 3e6 (C)",
            bare=(0, 7e5),
        )
        for ring in ("inner", "outer")
    ),
    *(
        Relation(
            "surface",
            f"{part}_roughness",
            partial(_over_half_width, which=f"{part}_roughness"),
            "1",
            "of the contact's half width",
            (0, 0.5),
            (-math.inf, math.inf),
            "where roughness is as large as the contact, Hertz's contact is none (D)",
        )
        for part in ("inner_raceway", "outer_raceway", "roller")
    ),
)


def impossible_relations(scene: Scene, raw: Mapping[str, object], where: Location) -> list[str]:
    """Return a message for each relation outside its possible range.

    Parameters
    ----------
    scene : Scene
        The scene.
    raw : mapping
        The scene as it is written.
    where : Location
        Location of the scene, for messages.
    """
    return [
        relation.location(where).message(text)
        for relation in RELATIONS
        if (text := relation.describe_violation(scene, raw, "possible"))
    ]


def unsupported_axial_load(scene: Scene, raw: Mapping[str, Any], where: Location) -> list[str]:
    """Return a message where the bearing has nothing that carries the axial load of the scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    raw : mapping
        Its tables as they are written, with the name of the bearing.
    where : Location
        Location of the scene, for messages.
    """
    load = scene.operation.axial_load
    if not load:
        return []
    name = str(raw["bearing"].get("name", ""))
    if load < 0.0 and re.search(r"\bNJ", name, re.IGNORECASE):
        text = (
            f"{name} carries an axial load one way alone, that of a load above 0. The other way the second bearing of "
            "the pair carries it: write 0 for this one there, or take a type NUP, which carries both"
        )
    elif scene.bearing.carries_axial_load:
        return []
    else:
        text = (
            f"nothing in this bearing carries {format_quantity(load, 'N')} along its axis: types NU, N, RNU and needle "
            "roller bearings have no ribs on opposite sides of both rings; take a type NJ or NUP, state bearing.ribs, "
            "or leave it out"
        )
    return [where.at("operation").at("axial_load").message(text)]


def required_axial_load(scene: Scene) -> float:
    """Return the axial load without which a tapered bearing has no equilibrium [N].

    The inner contacts exert sum Q sin(alpha) along the axis and sum Q cos(alpha) cos(psi) in the line of load, so that
    their axial force is at least F_r tan(alpha)/cos(psi) with the roller that is nearest to the line of load, half a
    pitch away at most. Centrifugal forces press on the inclined outer raceway, and take Z F_c tan(alpha) of the load.
    """
    bearing = scene.bearing
    operation = scene.operation
    nearest = math.cos(math.pi / bearing.rollers)
    area = math.pi * bearing.roller_diameter**2 / 4.0
    mass = bearing.material.density * area * bearing.roller_length
    inner = bearing.inner_raceway_diameter
    outer = bearing.outer_raceway_diameter
    orbit = 0.5 * bearing.pitch_diameter
    speed = (inner * operation.inner_speed + outer * operation.outer_speed) / (inner + outer)
    centrifugal = bearing.rollers * mass * orbit * speed * speed
    radial = operation.radial_load / nearest
    return float((radial + centrifugal) * math.tan(bearing.angles.outer))


def smallest_tapered_load(scene: Scene) -> float:
    """Return the smallest load of a tapered bearing, with radial and axial load in their ratio, that holds it [N].

    Below it the centrifugal forces of the rollers, which do not fall with the load, push the rings apart.
    """
    operation = scene.operation
    unloaded = attrs.evolve(scene, operation=attrs.evolve(operation, radial_load=0.0))
    centrifugal = required_axial_load(unloaded)
    left = operation.axial_load - (required_axial_load(scene) - centrifugal)
    return float(operation.load * centrifugal / left)


def tapered_problems(scene: Scene, where: Location) -> list[str]:
    """Return messages on loads and parts that a tapered bearing cannot have.

    Parameters
    ----------
    scene : Scene
        The scene.
    where : Location
        Location of the scene, for messages.
    """
    bearing = scene.bearing
    without_clearance = "an axial load takes up the clearance of a tapered bearing; leave it out"
    refused = [
        ("bearing.radial_clearance", bearing.radial_clearance, without_clearance),
        ("bearing.clearance_class", bearing.clearance_class, without_clearance),
        ("bearing.mounting", bearing.mounting, without_clearance),
        (
            "bearing.ribs.opening_angle",
            bearing.ribs and bearing.ribs.opening_angle,
            "the ends of tapered rollers touch the rib with their radius; state end_radius in its place",
        ),
        (
            "bearing.roller_half_angle",
            bearing.angles.inner <= 0.0,
            "must be less than half the contact angle, so that the inner raceway is a cone, too",
        ),
        ("bearing.pitch_diameter", *_differing_pitch(bearing)),
        ("operation.misalignment", scene.operation.misalignment, _rigid("the tilt of rings")),
        *(
            (
                f"models.{ring}_ring",
                getattr(scene.models, f"{ring}_ring"),
                _rigid("a flexible ring"),
            )
            for ring in ("inner", "outer")
        ),
        *(
            (f"bearing.{ring}_raceway.form", raceway and raceway.form, _rigid("a form error"))
            for ring in ("inner", "outer")
            for raceway in (getattr(bearing, f"{ring}_raceway"),)
        ),
        ("operation.axial_load", *_missing_axial_load(scene)),
    ]
    problems = []
    for key, is_refused, reason in refused:
        if is_refused:
            at = where
            for part in key.split("."):
                at = at.at(part)
            problems.append(at.message(reason))
    return problems


def _rigid(what: str) -> str:
    """Return the message that something is not modelled in a tapered bearing."""
    return f"{what} is not modelled in a tapered bearing; leave it out"


def _differing_pitch(bearing: Any) -> tuple[bool, str]:
    """Return whether stated raceways disagree with the stated pitch diameter, and a message."""
    pitch = bearing.stated_pitch_diameter
    if pitch is None:
        return False, ""
    own = bearing.inner_raceway_diameter, bearing.outer_raceway_diameter
    expected = raceway_diameters(pitch, bearing.roller_diameter, bearing.angles)
    difference = max(abs(a - b) for a, b in zip(own, expected, strict=True))
    inner, outer = (format_quantity(diameter, "m") for diameter in own)
    return difference > _LENGTH_ROUNDING, (
        f"raceways of {inner} and {outer} at the middle of the rollers are stated as well, and do not agree with "
        f"{format_quantity(pitch, 'm')}; leave out one of them"
    )


def _missing_axial_load(scene: Scene) -> tuple[bool, str]:
    """Return whether the axial load does not hold the rings together, and a message."""
    needed = required_axial_load(scene)
    given = scene.operation.axial_load or 0.0
    return given <= needed, (
        f"{format_quantity(given, 'N')} does not hold the rings of a tapered bearing together under "
        f"{format_quantity(scene.operation.radial_load, 'N')} of radial load at this speed, which takes more "
        f"than {format_quantity(needed, 'N', 4)}. An opposed bearing gives what lacks: add its force to the load from "
        "outside"
    )
