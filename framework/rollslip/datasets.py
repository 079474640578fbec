"""Bearings and surfaces as values, and named sets of them that plugins ship, each with its source and validity."""

import abc
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import attrs

from rollslip.fields import FieldError, at_least, field, in_range, non_negative, one_of, positive
from rollslip.references import Citation
from rollslip.toml import FrozenTable
from rollslip.units import format_quantity

__all__ = [
    "Bearing",
    "BearingData",
    "Catalogue",
    "Family",
    "Material",
    "OwnCage",
    "Profile",
    "Scatter",
    "Surface",
    "SurfaceData",
]


@attrs.frozen(kw_only=True)
class Material:
    """Material of rings and rollers; the defaults are bearing steel."""

    elastic_modulus: float = field(
        default=208e9, unit="Pa", doc="Young's modulus", validator=positive, usual=(50e9, 500e9), possible=(1e6, 2e12)
    )
    poisson_ratio: float = field(
        default=0.3, unit="1", doc="Poisson's ratio", validator=in_range(0, 0.5), usual=(0.15, 0.45)
    )
    density: float = field(
        default=7800.0, unit="kg/m3", doc="density", validator=positive, usual=(2500, 9000), possible=(1e-12, 25e3)
    )
    specific_heat: float = field(
        default=470.0, unit="J/(kg K)", doc="specific heat", validator=positive, usual=(300, 1200), possible=(50, 1e4)
    )
    thermal_conductivity: float = field(
        default=46.0,
        unit="W/(m K)",
        doc="thermal conductivity",
        validator=positive,
        usual=(5, 150),
        possible=(0.01, 5e3),
    )


@attrs.frozen(kw_only=True)
class Profile:
    """How much the roller's radius drops towards its ends."""

    shape: str = field(
        default="none",
        doc="straight, logarithmic after ISO/TS 16281, a circular crown or the user's own table",
        validator=one_of("none", "iso16281", "circular", "table"),
        bare=True,
    )
    radius: float | None = field(
        default=None,
        unit="m",
        doc="radius of the circular crown",
        validator=attrs.validators.optional(positive),
        usual=(0.05, 1e3),
        possible=(1e-4, 1e9),
    )
    position: tuple[float, ...] = field(
        default=(),
        unit="m",
        doc="places along the roller from its middle, ascending, for the table",
        usual=(-0.15, 0.15),
        possible=(-5, 5),
    )
    drop: tuple[float, ...] = field(
        default=(),
        unit="m",
        doc="drop of the radius at these places",
        validator=attrs.validators.deep_iterable(non_negative),
        usual=(0, 3e-4),
        possible=(0, 0.1),
    )

    def __attrs_post_init__(self) -> None:
        if self.shape == "circular" and self.radius is None:
            raise FieldError("radius", "missing, but required for shape = 'circular', such as '5 m'")
        if self.shape != "circular" and self.radius is not None:
            raise FieldError("radius", f"only read for shape = 'circular', not for {self.shape!r}")
        if self.shape != "table":
            for name in ("position", "drop"):
                if getattr(self, name):
                    raise FieldError(name, f"only read for shape = 'table', not for {self.shape!r}")
            return
        if len(self.position) < 2:
            raise FieldError("position", f"a table needs at least 2 places, not {len(self.position)}")
        if len(self.drop) != len(self.position):
            raise FieldError("drop", f"needs one value for each of {len(self.position)} places, not {len(self.drop)}")
        if any(right <= left for left, right in zip(self.position, self.position[1:], strict=False)):
            raise FieldError("position", "must ascend from one end of the roller to the other")


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
    """What a maker's catalogue lists of the bearing: read by makers' rules of least load and friction torque alone."""

    series: str = field(
        default="", doc='dimension series of ISO 15 as designations have it: "2", "3", "10", "22"', bare=True
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
        doc="SKF's factor k_r of the least load, 0.1 to 0.3 for one row with a cage",
        validator=attrs.validators.optional(positive),
    )
    reference_speed: float | None = field(
        default=None,
        unit="rad/s",
        doc="SKF's reference speed n_r",
        validator=attrs.validators.optional(positive),
    )


def _radial_clearance(bearing: "Bearing") -> float:
    gap = bearing.outer_raceway_diameter - bearing.inner_raceway_diameter - 2 * bearing.roller_diameter
    # The subtraction leaves rounding noise: on a grid of a picometre a nominal clearance of zero is zero (not -0.0).
    return round(gap, 12) + 0.0


@attrs.frozen(kw_only=True)
class Bearing:
    """Geometry and material of a cylindrical roller bearing."""

    rollers: int = field(doc="number of rollers", validator=at_least(3), usual=(6, 200), possible=(3, 10e3))
    roller_diameter: float = field(
        unit="m", doc="roller diameter", validator=positive, usual=(1e-3, 0.15), possible=(1e-5, 5)
    )
    roller_length: float = field(
        unit="m", doc="effective roller length", validator=positive, usual=(2e-3, 0.25), possible=(1e-5, 10)
    )
    inner_raceway_diameter: float = field(
        unit="m", doc="inner raceway diameter", validator=positive, usual=(3e-3, 3), possible=(1e-4, 50)
    )
    outer_raceway_diameter: float = field(
        unit="m", doc="outer raceway diameter", validator=positive, usual=(6e-3, 3.5), possible=(1e-4, 50)
    )
    radial_clearance: float = field(
        default=attrs.Factory(_radial_clearance, takes_self=True),
        unit="m",
        doc="radial internal clearance in operation (full play); from the diameters if left out",
        usual=(-3e-4, 2e-3),
        possible=(-0.1, 1),
    )
    profile: Profile = field(default=Profile(), doc="roller profile")
    material: Material = field(default=Material(), doc="material of rings and rollers")
    catalogue: Catalogue | None = field(
        default=None, doc="what the catalogue lists, for makers' rules of least load and friction torque"
    )

    @property
    def boundaries(self) -> tuple[float, float]:
        """Bore and outside diameter [m]: listed, or estimated half a diameter of a roller from the raceways (D)."""
        listed = self.catalogue or Catalogue()
        bore = max(self.inner_raceway_diameter - self.roller_diameter, 0.5 * self.inner_raceway_diameter)
        return listed.bore or bore, listed.outside_diameter or self.outer_raceway_diameter + self.roller_diameter

    def __attrs_post_init__(self) -> None:
        inner, outer = self.inner_raceway_diameter, self.outer_raceway_diameter
        diameter = self.roller_diameter
        shown = format_quantity(diameter, "m")
        if inner >= outer:
            came = f"{format_quantity(outer, 'm')} must be larger than the inner one, {format_quantity(inner, 'm')}"
            raise FieldError("outer_raceway_diameter", came)
        room = (outer - inner) / 2
        if abs(room - diameter) >= diameter / 2:
            raise FieldError(
                "roller_diameter", f"rollers of {shown} do not fit raceways that are {format_quantity(room, 'm')} apart"
            )
        if abs(self.radial_clearance) >= diameter:
            clearance = format_quantity(self.radial_clearance, "m")
            raise FieldError("radial_clearance", f"must be less than the roller diameter, {shown}, not {clearance}")
        most = math.ceil(math.pi / math.asin(2 * diameter / (inner + outer))) - 1
        if self.rollers > most:
            raise FieldError(
                "rollers",
                f"{self.rollers} rollers of {shown} do not fit on a pitch circle of "
                f"{format_quantity((inner + outer) / 2, 'm')}: at most {most} do",
            )


def _roughness(of: str, default: float) -> Any:
    return field(
        default=default,
        unit="m",
        doc=f"roughness Ra of {of}",
        validator=positive,
        usual=(5e-9, 3e-6),
        possible=(1e-10, 1e-3),
    )


@attrs.frozen(kw_only=True)
class Surface:
    """Roughness of the running surfaces."""

    inner_raceway_roughness: float = _roughness("the inner raceway", 0.16e-6)
    outer_raceway_roughness: float = _roughness("the outer raceway", 0.16e-6)
    roller_roughness: float = _roughness("the rollers", 0.1e-6)


@attrs.frozen(kw_only=True)
class Scatter:
    """How uncertain a datum of an oil or a bearing is, and who says so.

    Parameters
    ----------
    quantity : str
        Key of the table of a scene, ``[lubricant]`` or ``[bearing]``, that scatters.
    distribution : str
        Name of its distribution, as in the table ``[uncertainty]`` of a scene.
    parameters : mapping
        Its parameters there, with units; a centre that is left out is the value of the scene.
    grade : str
        A letter of `rollslip.lubricant.GRADES` in parentheses.
    source : str
        Where it comes from, in a sentence.
    """

    quantity: str
    distribution: str
    parameters: Mapping[str, object] = attrs.field(converter=FrozenTable)
    grade: str
    source: str


@attrs.frozen(kw_only=True)
class BearingData:
    """A bearing that a scene can name: ``[bearing] name = "1032930"``; the other keys of the table change its values.

    Parameters
    ----------
    name : str
        What a scene calls it.
    description : str
        What it is, in one line.
    source : str
        Where the values come from, and which are assumed.
    validity : str
        What they hold for: whether the clearance is one in operation, for example.
    references : tuple of Reference or str
        One citation each, see `rollslip.references`.
    bearing : Bearing
        The values.
    grades : mapping
        A letter of `rollslip.lubricant.GRADES` for each key that is not printed in the source.
    scatter : tuple of Scatter
        What is uncertain of it, for `rollslip uncertainty`.
    """

    name: str
    description: str
    source: str
    validity: str
    references: tuple[Citation, ...] = ()
    bearing: Bearing
    grades: Mapping[str, str] = attrs.field(default=FrozenTable(), converter=FrozenTable)
    scatter: tuple[Scatter, ...] = ()

    @property
    def data(self) -> Bearing:
        """The values."""
        return self.bearing


@attrs.frozen(kw_only=True)
class SurfaceData:
    """Surfaces that a scene can name: ``[surface] name = "ground"``; the other keys of the table change their values.

    Parameters
    ----------
    name, description, source, validity, references
        As in `BearingData`.
    surface : Surface
        The values.
    """

    name: str
    description: str
    source: str
    validity: str
    references: tuple[Citation, ...] = ()
    surface: Surface

    @property
    def data(self) -> Surface:
        """The values."""
        return self.surface


class OwnCage(NamedTuple):
    """The cage that a designation stands for.

    Attributes
    ----------
    make : str
        What it is of: "brass", "steel" or "polyamide".
    guidance : str
        What guides it: "roller", or the land of the "inner" or "outer" ring.
    letters : str
        Those of the designation that say so; empty where it is what makers put into such a bearing.
    """

    make: str
    guidance: str
    letters: str = ""


class Family(abc.ABC):
    """Many named sets of one kind behind one entry point, ``NAME = "module:OBJECT"``; each is made when asked for.

    Attributes
    ----------
    name : str
        That of the entry point.
    description : str
        What it holds, in one line.
    """

    name: str
    description: str

    @property
    @abc.abstractmethod
    def names(self) -> tuple[str, ...]:
        """All names, in the order of a list."""

    @abc.abstractmethod
    def called(self, written: str) -> str | None:
        """Return the name that somebody means who writes it in another way; None if there is none."""

    def cage(self, written: str) -> OwnCage | None:
        """Return the cage of a bearing by its designation; None for one of another family."""
        return None

    def clearance_class(self, written: str) -> str | None:
        """Return the class of radial clearance that a designation says, such as "C3"; None where it says none."""
        return None

    def other(self, written: str) -> str | None:
        """Return what a name is of that is none of these, in words ("a deep groove ball bearing"), where known."""
        return None

    @abc.abstractmethod
    def __getitem__(self, name: str) -> Any:
        """Return the set of this name, one of `names` or what `called` returns."""
