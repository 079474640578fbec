"""Values of a scene that have to fit each other, each relation with a range that is usual and one that is possible.

- Outside of what is usual whoever runs the scene is told (`rollslip.planning.plausibility`), outside of what is
  possible it is not read.
- The numbers are those of catalogues and handbooks, taken wide: they catch a slipped unit or decimal, and say nothing
  about whether a bearing is a good one.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial
from numbers import Real
from typing import Any, Final, TypeAlias

import attrs

from rollslip.fields import FieldError, Span, as_given, format_span
from rollslip.scene.supply import DEEPEST
from rollslip.structure import Location
from rollslip.units import GRAVITY, format_quantity, likely, unit_given

__all__ = [
    "RELATIONS",
    "Relation",
    "impossible_pressure",
    "impossible_relations",
    "skf_minimum_load",
]

Scene: TypeAlias = Any
"""A `rollslip.scene.values.Scene`; its tables are read by name here, as relations name them."""

#: Largest roller force over the mean of all, sum F = F_r, where half the rollers carry (Stribeck's number) [1].
_STRIBECK: Final = 5.0
#: Pressure that is possible, five times that of the static rating of ISO 76 at most [Pa].
_PRESSURE: Final[Span] = (0, 2e10)
#: What catalogues tell speeds in that go with the size of a bearing: n d_m.
_SPEED_FACTOR: Final = "mm/min"


@attrs.frozen
class Relation:
    """A value of a scene that has to fit others."""

    #: table, field: The value that is blamed: ``operation.radial_load``.
    table: str
    field: str
    of: Callable[
        [Scene], float
    ]  # returns what it amounts to in a scene, in `unit`; NaN where that cannot be said
    unit: str  # SI unit of it
    words: str  # what it amounts to, in words: "of the roller diameter"
    #: usual, possible: Least and largest of it that are usual, and that are possible.
    usual: Span
    possible: Span
    source: str  # what the ranges rest on
    #: What is usual where a whole number without a unit is written, which may be meant in another unit than SI.
    bare: Span | None = None

    def at(self, where: Location) -> Location:
        """Return the place of the value that is blamed in a scene."""
        return where.at(self.table).at(self.field)

    def written(self, raw: Mapping[str, object]) -> object:
        """Return the value that is blamed as it is written in a raw scene; None if it is not."""
        table = raw.get(self.table)
        return table.get(self.field) if isinstance(table, Mapping) else None

    def attribute(self, scene: Scene) -> "attrs.Attribute[Any]":
        """Return the field of the value that is blamed."""
        return attrs.fields_dict(type(getattr(scene, self.table)))[self.field]

    def with_value(self, scene: Scene, value: float) -> float:
        """Return what it would amount to with another value; NaN if the scene cannot have that."""
        table: Any = getattr(scene, self.table)
        try:
            other: Any = attrs.evolve(
                scene, **{self.table: attrs.evolve(table, **{self.field: value})}
            )
        except FieldError:
            return math.nan
        return self.of(other)

    def fault(self, scene: Scene, raw: Mapping[str, object], which: str) -> str:
        """Say how what a scene amounts to leaves what is "usual", or "possible", of it; nothing where it does not."""
        written = self.written(raw)
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
        amounts = self.of(scene)
        if math.isnan(amounts) or span[0] <= amounts <= span[1]:
            return ""
        attribute = self.attribute(scene)
        unit = attribute.metadata["unit"]
        value: float = getattr(getattr(scene, self.table), self.field)
        given = None if unit is None or written is None else unit_given(written, unit)
        sums = (
            scene.bearing.mounted if self.field == "radial_clearance" else None
        )  # what it follows from
        shown = as_given(value, attribute, given) if sums is None else str(sums)
        said = (
            f"{shown} is {self._shown(amounts)} {self.words}, {self.format_range(span)} is {which}"
        )
        if (
            unit is None or given is None or math.isinf(span[1])
        ):  # of too little nothing is likely: any unit has more
            return said
        of_field: Span = attribute.metadata["usual"]
        meant = likely(
            value,
            given,
            unit,
            lambda other: (
                of_field[0] <= other <= of_field[1]
                and self.usual[0] <= self.with_value(scene, other) <= self.usual[1]
            ),
        )
        return said if meant is None else f"{said}; did you mean {meant!r}?"

    def _shown(self, amounts: float) -> str:
        if self.unit == _SPEED_FACTOR:
            return f"{amounts:.2g} {self.unit}"
        return (
            f"{100 * amounts:.3g} %" if self.unit == "1" else format_quantity(amounts, self.unit, 3)
        )

    def format_range(self, span: Span) -> str:
        """Say from what to what it may go."""
        if self.unit == _SPEED_FACTOR:
            return f"at most {self._shown(span[1])}"
        if self.unit != "1":
            return format_span(span if span[0] != 0 else (-math.inf, span[1]), self.unit)
        if math.isinf(span[1]):
            return f"at least {100 * span[0]:g} %"
        return f"{100 * span[0]:g} % to {100 * span[1]:g} %"


def _pitch(scene: Scene) -> float:
    b = scene.bearing
    return float(b.inner_raceway_diameter + b.outer_raceway_diameter) / 2


def _room_left(scene: Scene) -> float:
    """Play that the diameters leave, less the clearance that is stated, over the diameter of a roller [1].

    NaN where the clearance itself cannot be meant.
    """
    b = scene.bearing
    if abs(b.radial_clearance) > 0.05 * b.roller_diameter:
        return math.nan
    play: float = b.outer_raceway_diameter - b.inner_raceway_diameter - 2 * b.roller_diameter
    return float((play - b.radial_clearance) / b.roller_diameter)


def _speed(scene: Scene, ring: str) -> float:
    """Surface speed of a raceway [m/s]."""
    diameter: float = getattr(scene.bearing, f"{ring}_raceway_diameter")
    speed: float = getattr(scene.operation, f"{ring}_speed")
    return abs(speed) * diameter / 2


def _speed_factor(scene: Scene, ring: str) -> float:
    """Speed of a ring times the diameter of the pitch circle, n d_m [mm/min]."""
    speed: float = getattr(scene.operation, f"{ring}_speed")
    return abs(speed) * 30.0 / math.pi * 1e3 * _pitch(scene)


def _most_loaded(scene: Scene) -> tuple[float, float, float]:
    """Load per length w, radius R and modulus E' of the most loaded contact of the inner ring, as catalogues take it.

    w = 5 F_r/(Z l): half the rollers carry, at no clearance, without profile, tilt and centrifugal force.
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
    """Largest pressure after Hertz [Pa], sqrt(w E'/(2 pi R))."""
    return math.sqrt(load * modulus / (2 * math.pi * radius))


def impossible_pressure(load: float, radius: float, modulus: float) -> str:
    """Say that a load per length [N/m] presses a contact, R [m] and E' [Pa], as none can be; nothing if it does not."""
    pressure = _pressure(load, radius, modulus)
    if pressure <= _PRESSURE[1]:
        return ""
    most = format_quantity(_PRESSURE[1], "Pa")
    return (
        f"{format_quantity(pressure, 'Pa', 3)} of pressure after Hertz, at most {most} is possible"
    )


def _over_half_width(scene: Scene, which: str) -> float:
    """Roughness over Hertz's half width of the most loaded contact, sqrt(8 w R/(pi E')); NaN without load."""
    load, radius, modulus = _most_loaded(scene)
    width = math.sqrt(8 * load * radius / (math.pi * modulus))
    roughness: float = getattr(scene.surface, which)
    return roughness / width if width > 0 else math.nan


def skf_minimum_load(bearing: Any, speed: float) -> float:
    """Return the least radial load [N] that SKF's rule asks for at a speed [rad/s]; NaN where it takes more than given.

    F = k_r (6 + 4 n/n_r) (d_m/100)^2 kN with d_m in mm, for one row with a cage (general catalogue 17000, page 509).
    SKF's mean diameter is that of bore and outside; here it is that of the pitch circle, up to 1.2 % larger. Without a
    reference speed n_r it is the load at rest, the least that the rule asks for at any speed.
    """
    given = bearing.catalogue
    if given is None or given.minimum_load_factor is None:
        return math.nan
    pitch = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 2
    fraction = 0.0 if given.reference_speed is None else abs(speed) / given.reference_speed
    return float(1e3 * given.minimum_load_factor * (6.0 + 4.0 * fraction) * (10.0 * pitch) ** 2)


def _rollers(scene: Scene) -> float:
    """Mass of all rollers [kg]."""
    b = scene.bearing
    return float(
        b.rollers * b.material.density * math.pi / 4.0 * b.roller_diameter**2 * b.roller_length
    )


def _over_minimum_load(scene: Scene) -> float:
    operation = scene.operation
    speed = operation.inner_speed - operation.outer_speed
    return float(operation.radial_load / skf_minimum_load(scene.bearing, speed))


#: What has to fit, the values most likely mistyped first.
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
        lambda scene: _pressure(*_most_loaded(scene)),
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
            scene.operation.radial_load / (GRAVITY * _rollers(scene)) or math.nan
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
    """Return a sentence for each relation that no bearing can have, with its place."""
    return [
        one.at(where).message(told)
        for one in RELATIONS
        if (told := one.fault(scene, raw, "possible"))
    ]
