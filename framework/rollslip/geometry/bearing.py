"""The bearing as a frozen value: its geometry, catalogue data, mounting and clearance in operation."""

import math
from typing import Any

import attrs

from rollslip.fields import (
    FieldError,
    at_least,
    field,
    in_range,
    non_negative,
    positive,
    refuse_if,
)
from rollslip.geometry.axial import CYLINDRICAL, ContactAngles, Ribs
from rollslip.geometry.surfaces import Material, Profile, Raceway
from rollslip.units import format_quantity

__all__ = [
    "Bearing",
    "Catalogue",
    "MountedClearance",
    "Mounting",
]


def _boundary(what: str) -> Any:
    return field(
        default=None,
        unit="m",
        doc=f"boundary dimension of ISO 15: {what}",
        validator=attrs.validators.optional(positive),
        usual=(3e-3, 4),
        possible=(1e-4, 50),
    )


@attrs.frozen(kw_only=True)
class Catalogue:
    """Catalogue data of a bearing, for makers' rules of minimum load and friction torque."""

    series: str = field(
        default="",
        doc='dimension series of ISO 15 as designations have it: "2", "3", "10", "22"',
        bare=True,
    )
    bore: float | None = _boundary("bore d")
    outside_diameter: float | None = _boundary("outside diameter D")
    width: float | None = _boundary("width B")
    dynamic_rating: float | None = field(
        default=None,
        unit="N",
        doc="basic dynamic load rating C",
        validator=attrs.validators.optional(positive),
    )
    minimum_load_factor: float | None = field(
        default=None,
        unit="1",
        doc="SKF's factor k_r of the minimum load, 0.1 to 0.3 for one row with a cage",
        validator=attrs.validators.optional(positive),
    )
    reference_speed: float | None = field(
        default=None,
        unit="rad/s",
        doc="SKF's reference speed n_r",
        validator=attrs.validators.optional(positive),
    )


def _length(
    doc: str, usual: Any, possible: Any, default: Any = None, validator: Any = None, **others: Any
) -> Any:
    return field(
        default=default,
        unit="m",
        doc=doc,
        usual=usual,
        possible=possible,
        validator=validator,
        **others,
    )


def _expansion(of: str, default: float | None) -> Any:
    return field(
        default=default,
        unit="1/K",
        doc=f"thermal expansion {of}",
        usual=(0, 3e-5),
        possible=(0, 1e-3),
        validator=attrs.validators.optional(non_negative),
    )


def _interference(of: str) -> Any:
    doc = f"interference of {of}, of diameters, before it is smoothed, below zero for play; in place of the fit"
    return _length(doc, (-2e-4, 5e-4), (-1e-2, 1e-2))


def _fit(of: str, usual: str) -> Any:
    return field(default=None, doc=f"fit of {of} by its name in ISO 286; {usual}")


@attrs.frozen(kw_only=True)
class Mounting:
    """Seats and temperatures of the rings, from which the clearance in operation follows."""

    initial_clearance: float | None = _length(
        "clearance before mounting; by default the middle of the clearance class, or what the diameters leave",
        (0, 1e-3),
        (-0.1, 1),
    )
    initial_tolerance: float = _length(
        "width of the range in which the clearance before mounting lies, as that of a class",
        (0, 2e-4),
        (0, 1e-2),
        0.0,
    )
    clearance_deviation: float = _length(
        "what is added to the clearance in operation, as it scatters",
        (-1e-4, 1e-4),
        (-1e-2, 1e-2),
        0.0,
    )
    shaft_fit: str | None = _fit(
        "the shaft", "by default k5 up to a bore of 50 mm, m5 to 100 mm, m6 above"
    )
    housing_fit: str | None = _fit("the housing", "by default H7")
    shaft_interference: float | None = _interference("the inner ring on its shaft")
    housing_interference: float | None = _interference("the outer ring in its housing")
    smoothing: float = field(
        default=0.8,
        unit="1",
        doc="fraction of an interference that remains when its roughness is flattened (C)",
        validator=in_range(0, 1),
        usual=(0.5, 1),
    )
    temperature_difference: float = field(
        default=5.0,
        unit="K/1",
        doc="inner ring and rollers above outer ring, where operation gives no temperature of a ring (D)",
        usual=(-20, 40),
        possible=(-150, 150),
    )
    expansion: float = _expansion("of rings and rollers (B)", 12e-6)
    growth: bool = field(
        default=True,
        doc="whether rings and shaft widen by their centrifugal force, the outer ring by the rollers' too",
    )
    shaft_bore: float = _length("bore of a hollow shaft", (0, 2), (0, 50), 0.0, non_negative)
    housing_outside_diameter: float | None = _length(
        "outside diameter of the housing; by default it is thick",
        (1e-2, 5),
        (1e-4, 100),
        validator=attrs.validators.optional(positive),
    )
    shaft_material: Material | None = field(
        default=None, doc="material of the shaft, by default that of the rings"
    )
    housing_material: Material | None = field(
        default=None, doc="material of the housing, by default that of the rings"
    )
    shaft_expansion: float | None = _expansion("of the shaft, by default that of the rings", None)
    housing_expansion: float | None = _expansion(
        "of the housing, by default that of the rings", None
    )

    def __attrs_post_init__(self) -> None:
        for part in ("shaft", "housing"):
            refuse_if(
                (
                    getattr(self, f"{part}_fit") is not None
                    and getattr(self, f"{part}_interference") is not None
                ),
                f"{part}_interference",
                f"{part}_fit says the same; leave one of them out",
            )


@attrs.frozen
class MountedClearance:
    """The clearance in operation as a sum of terms."""

    #: Name and value [m] of each term, the clearance before mounting first.
    terms: tuple[tuple[str, float], ...]
    #: Standard deviation of the clearance [m], of class, seats and rings, each uniform within its tolerance.
    deviation: float
    #: Keys of `Mounting` with assumed values.
    assumed: tuple[str, ...] = ()
    #: Whether the outer ring is rigid, so that its widening by the rollers is a term here.
    rigid: bool = True

    @property
    def clearance(self) -> float:
        """The clearance in operation [m]."""
        return round(math.fsum(size for _, size in self.terms), 12) + 0.0

    def __str__(self) -> str:
        (first, initial), *others = self.terms
        text = f"{initial * 1e6:.4g} {first}"
        for name, size in others:
            if abs(size) >= 5e-8:
                sign = "+" if size > 0.0 else "-"
                shown = abs(size) * 1e6
                text += f" {sign} {shown:.{0 if shown >= 9.95 else 1}f} {name}"
        total = self.clearance * 1e6
        return f"{text} = {total:.3g} um" if abs(total) < 999.5 else f"{text} = {total:.0f} um"


@attrs.frozen(kw_only=True)
class Bearing:
    """Geometry and material of a cylindrical roller bearing, or with a contact angle of a tapered one.

    Diameters of a tapered bearing are those at the middle of the rollers. An axial load displaces its rings until the
    rollers touch, so that it has no clearance.
    """

    rollers: int = field(
        doc="number of rollers", validator=at_least(3), usual=(6, 200), possible=(3, 10e3)
    )
    roller_diameter: float = _length(
        "roller diameter", (1e-3, 0.15), (1e-5, 5), attrs.NOTHING, positive
    )
    roller_length: float = _length(
        "effective roller length", (2e-3, 0.25), (1e-5, 10), attrs.NOTHING, positive
    )
    inner_raceway_diameter: float = _length(
        "inner raceway diameter", (3e-3, 3), (1e-4, 50), attrs.NOTHING, positive
    )
    outer_raceway_diameter: float = _length(
        "outer raceway diameter", (6e-3, 3.5), (1e-4, 50), attrs.NOTHING, positive
    )
    contact_angle: float | None = field(
        default=None,
        unit="rad",
        validator=attrs.validators.optional(positive),
        usual=(0.14, 0.6),
        possible=(0, 1.2),
        doc="contact angle of a tapered roller bearing, that of its outer raceway: e = 1.5 tan(angle) in catalogues",
    )
    stated_pitch_diameter: float | None = _length(
        "pitch diameter of tapered rollers at their middle, in place of both raceway diameters",
        (5e-3, 3.2),
        (1e-4, 50),
        validator=attrs.validators.optional(positive),
        key="pitch_diameter",
    )
    roller_half_angle: float | None = field(
        default=None,
        unit="rad",
        validator=attrs.validators.optional(non_negative),
        usual=(0.008, 0.1),
        possible=(0, 0.5),
        doc="angle between axis and surface of a tapered roller; by default that of cones with a common apex",
    )
    radial_clearance: float = field(
        default=attrs.Factory(
            lambda bearing: bearing.nominal_clearance if bearing.contact_angle is None else 0.0,
            takes_self=True,
        ),
        unit="m",
        doc="radial internal clearance in operation (full play); if left out, what mounting leaves, or the diameters",
        usual=(-3e-4, 2e-3),
        possible=(-0.1, 1),
    )
    clearance_class: str | None = field(
        default=None,
        doc="class of the clearance before mounting (ISO 5753-1), such as C3; by default that of the name",
    )
    mounting: Mounting | None = field(
        default=None, doc="seats and temperatures, which change the clearance"
    )
    inner_raceway: Raceway | None = field(
        default=None, doc="material and form of the inner raceway"
    )
    outer_raceway: Raceway | None = field(
        default=None, doc="material and form of the outer raceway"
    )
    ribs: Ribs | None = field(default=None, doc="ribs for axial load; by default those of the name")
    profile: Profile = field(default=Profile(), doc="roller profile")
    material: Material = field(default=Material(), doc="material of rollers and rings")
    catalogue: Catalogue | None = field(
        default=None,
        doc="what the catalogue lists, for makers' rules of minimum load and friction torque",
    )
    #: Terms of `radial_clearance` in a scene; None where that is stated.
    mounted: MountedClearance | None = attrs.field(
        default=None, eq=False, repr=False, metadata={"key": None}
    )

    @property
    def nominal_clearance(self) -> float:
        """Clearance by the diameters [m]."""
        # rounded to a picometre, because the subtraction has rounding errors; the sum makes -0.0 to 0.0
        return 0.0 + round(
            self.outer_raceway_diameter - self.inner_raceway_diameter - 2 * self.roller_diameter, 12
        )

    @property
    def carries_axial_load(self) -> bool:
        """Whether the bearing has what carries an axial load."""
        return self.contact_angle is not None or self.ribs is not None

    @property
    def angles(self) -> ContactAngles:
        """Angles of the contacts with both rings and of the rollers; all are zero in a cylindrical bearing."""
        if self.contact_angle is None:
            return CYLINDRICAL
        if self.roller_half_angle is not None:
            return ContactAngles(self.contact_angle, self.roller_half_angle)
        ratio = self.roller_diameter / self.pitch_diameter
        return ContactAngles.with_common_apex(self.contact_angle, ratio)

    @property
    def cosines(self) -> tuple[float, float, float]:
        """Cosines of the half angle of a roller and of the contact angles of inner and outer raceway [1]."""
        return (1.0, 1.0, 1.0) if self.contact_angle is None else self.angles.cosines

    def material_of(self, ring: str) -> Material:
        """Return the material of the "inner" or "outer" raceway, by default that of the bearing."""
        raceway: Raceway | None = getattr(self, f"{ring}_raceway")
        return self.material if raceway is None or raceway.material is None else raceway.material

    @property
    def boundaries(self) -> tuple[float, float]:
        """Bore and outside diameter [m], by default half a roller diameter from the raceways (D)."""
        listed = self.catalogue or Catalogue()
        bore = max(
            self.inner_raceway_diameter - self.roller_diameter, 0.5 * self.inner_raceway_diameter
        )
        return (
            listed.bore or bore,
            listed.outside_diameter or self.outer_raceway_diameter + self.roller_diameter,
        )

    @property
    def pitch_diameter(self) -> float:
        """Diameter of the circle on which the centres of the rollers lie without clearance [m]."""
        return 0.5 * (self.inner_raceway_diameter + self.outer_raceway_diameter)

    @property
    def static_rating(self) -> float:
        """Basic static radial load rating C0r [N] of one row of rollers.

        C0r = 44 (1 - D cos(a)/dm) Z L D cos(a) after ISO 76, with diameter D and effective length L of a roller and
        pitch diameter dm in mm, and the contact angle a. Makers' own values differ by some per cent.
        """
        diameter = self.roller_diameter * math.cos(self.angles.outer)
        size = 1e6 * self.roller_length * diameter
        return 44.0 * (1.0 - diameter / self.pitch_diameter) * self.rollers * size

    @property
    def width(self) -> float:
        """Width of the rings [m], by default 1.8 times the length of the rollers (D); it is 1.87 in the 1032930."""
        return (self.catalogue and self.catalogue.width) or 1.8 * self.roller_length

    def __attrs_post_init__(self) -> None:
        inner = self.inner_raceway_diameter
        outer = self.outer_raceway_diameter
        diameter = self.roller_diameter
        refuse_if(
            self.contact_angle is None and (self.stated_pitch_diameter or self.roller_half_angle),
            "contact_angle",
            "missing, but pitch_diameter or roller_half_angle is stated, as of a tapered bearing",
        )
        shown = format_quantity(diameter, "m")
        if inner >= outer:
            reason = f"{format_quantity(outer, 'm')} must be larger than the inner one, {format_quantity(inner, 'm')}"
            raise FieldError("outer_raceway_diameter", reason)
        distance = (outer - inner) / 2
        refuse_if(
            abs(distance - diameter) >= diameter / 2,
            "roller_diameter",
            f"rollers of {shown} do not fit raceways that are {format_quantity(distance, 'm')} apart",
        )
        if self.ribs is not None and self.ribs.height >= diameter / 2:
            height = format_quantity(self.ribs.height, "m")
            raise FieldError(
                "ribs",
                f"height of {height} must be less than the radius of the rollers, {format_quantity(diameter / 2, 'm')}",
            )
        bore, outside = self.boundaries
        for name, value, ring, is_wrong in (
            ("bore", bore, inner, bore >= inner),
            ("outside_diameter", outside, outer, outside <= outer),
        ):
            if is_wrong:
                size = format_quantity(value, "m")
                raise FieldError(
                    "catalogue",
                    f"{name} of {size} leaves nothing of a ring at {format_quantity(ring, 'm')}: leave out "
                    "raceways and rollers that are stated of another bearing, or correct them",
                )
        if abs(self.radial_clearance) >= diameter:
            clearance = format_quantity(self.radial_clearance, "m")
            raise FieldError(
                "radial_clearance",
                f"must be less than the roller diameter, {shown}, not {clearance}",
            )
        capacity = math.ceil(math.pi / math.asin(2 * diameter / (inner + outer))) - 1
        refuse_if(
            self.rollers > capacity,
            "rollers",
            f"{self.rollers} rollers of {shown} do not fit on a pitch circle of "
            f"{format_quantity((inner + outer) / 2, 'm')}: at most {capacity} do",
        )
