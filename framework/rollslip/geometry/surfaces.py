"""Materials, profiles, forms and roughness of the surfaces that roll on each other, as frozen values."""

import math
from types import MappingProxyType
from typing import Any, Final

import attrs

from rollslip.fields import at_least, choice_of, field, in_range, non_negative, positive, refuse_if

__all__ = ["PROFILES", "FormPart", "Material", "Profile", "Raceway", "Surface"]


@attrs.frozen(kw_only=True)
class Material:
    """Material of rings and rollers; the defaults are bearing steel."""

    elastic_modulus: float = field(
        default=208e9,
        unit="Pa",
        doc="Young's modulus",
        validator=positive,
        usual=(50e9, 500e9),
        possible=(1e6, 2e12),
    )
    poisson_ratio: float = field(
        default=0.3, unit="1", doc="Poisson's ratio", validator=in_range(0, 0.5), usual=(0.15, 0.45)
    )
    density: float = field(
        default=7800.0,
        unit="kg/m3",
        doc="density",
        validator=positive,
        usual=(2500, 9000),
        possible=(1e-12, 25e3),
    )
    specific_heat: float = field(
        default=470.0,
        unit="J/(kg K)",
        doc="specific heat",
        validator=positive,
        usual=(300, 1200),
        possible=(50, 1e4),
    )
    thermal_conductivity: float = field(
        default=46.0,
        unit="W/(m K)",
        doc="thermal conductivity",
        validator=positive,
        usual=(5, 150),
        possible=(0.01, 5e3),
    )


#: Other name of the shape of a profile -> its name.
PROFILES: Final = MappingProxyType(
    {
        **dict.fromkeys(("logarithmic", "log", "iso/ts 16281", "iso 16281"), "iso16281"),
        **dict.fromkeys(("straight", "cylindrical", "no"), "none"),
    }
)


@attrs.frozen(kw_only=True)
class Profile:
    """Profile of a roller: the drop of its radius towards the ends."""

    shape: str = field(
        default="none",
        doc="straight, logarithmic after ISO/TS 16281, a circular crown or the user's own table",
        validator=choice_of("none", "iso16281", "circular", "table"),
        keywords=PROFILES,
        bare=True,
    )
    radius: float | None = field(
        default=None,
        unit="m",
        doc="radius of the circular crown",
        usual=(0.05, 1e3),
        possible=(1e-4, 1e9),
        validator=attrs.validators.optional(positive),
    )
    depth_factor: float = field(
        default=1.0,
        unit="1",
        validator=positive,
        usual=(0.2, 5),
        possible=(1e-6, 1e6),
        doc="factor of the drop everywhere, so that a depth that is not known can scatter",
    )
    position: tuple[float, ...] = field(
        default=(),
        unit="m",
        usual=(-0.15, 0.15),
        possible=(-5, 5),
        doc="places along the roller from its middle, ascending, for the table",
    )
    drop: tuple[float, ...] = field(
        default=(),
        unit="m",
        usual=(0, 3e-4),
        possible=(0, 0.1),
        doc="drop of the radius at these places",
        validator=attrs.validators.deep_iterable(non_negative),
    )

    def __attrs_post_init__(self) -> None:
        refuse_if(
            self.shape == "circular" and self.radius is None,
            "radius",
            "missing, but required for shape = 'circular', such as '5 m'",
        )
        refuse_if(
            self.shape != "circular" and self.radius is not None,
            "radius",
            f"only read for shape = 'circular', not for {self.shape!r}",
        )
        if self.shape != "table":
            for name in ("position", "drop"):
                refuse_if(
                    getattr(self, name),
                    name,
                    f"only read for shape = 'table', not for {self.shape!r}",
                )
            return
        refuse_if(
            len(self.position) < 2,
            "position",
            f"a table needs at least 2 places, not {len(self.position)}",
        )
        refuse_if(
            len(self.drop) != len(self.position),
            "drop",
            f"needs one value for each of {len(self.position)} places, not {len(self.drop)}",
        )
        refuse_if(
            (
                any(
                    right <= left
                    for left, right in zip(self.position, self.position[1:], strict=False)
                )
            ),
            "position",
            "must ascend from one end of the roller to the other",
        )


@attrs.frozen(kw_only=True)
class FormPart:
    """A part of the form error of a raceway: a wave of lobes, or a table over the angle."""

    lobes: int | None = field(
        default=None,
        doc="waves round the raceway: 2 is an oval; 1 only shifts it",
        validator=attrs.validators.optional(at_least(2)),
        usual=(2, 12),
        possible=(2, 1000),
    )
    amplitude: float = field(
        default=0.0,
        unit="m",
        doc="half the difference of largest and smallest radius",
        validator=non_negative,
        usual=(0, 1e-4),
        possible=(0, 1e-2),
    )
    angle: float = field(
        default=0.0, unit="rad", doc="where a lobe is nearest to the rollers, from the line of load"
    )
    angles: tuple[float, ...] = field(
        default=(), unit="rad", doc="of a table: ascending, within one turn"
    )
    heights: tuple[float, ...] = field(default=(), unit="m", doc="of a table: towards the rollers")
    file: str | None = field(
        default=None,
        doc="full path of a CSV file with the columns 'angle [rad]' and 'height [m]', or in other units",
    )

    def __attrs_post_init__(self) -> None:
        kinds = [
            name for name in ("lobes", "angles", "file") if getattr(self, name) not in (None, ())
        ]
        refuse_if(
            len(kinds) != 1,
            "lobes",
            "give one of lobes (with amplitude), angles (with heights) or file",
        )
        refuse_if(self.lobes is None and self.amplitude != 0.0, "amplitude", "only read with lobes")
        if self.heights or self.angles:
            refuse_if(
                len(self.angles) != len(self.heights) or len(self.angles) < 4,
                "heights",
                (
                    f"a table needs 4 places or more and as many heights, not {len(self.angles)} and "
                    f"{len(self.heights)}"
                ),
            )
            ascending = all(b > a for a, b in zip(self.angles, self.angles[1:], strict=False))
            refuse_if(
                not ascending or self.angles[-1] - self.angles[0] >= 2.0 * math.pi,
                "angles",
                "must ascend within less than one turn: the first follows on the last",
            )


@attrs.frozen(kw_only=True)
class Raceway:
    """Material of a raceway, where it is not that of the bearing, and its form error."""

    without_ring: bool = field(
        default=False,
        doc="whether rollers run on shaft or housing itself, or in a drawn cup: no seat changes the clearance",
    )
    material: Material | None = field(
        default=None,
        doc="material of a shaft or a ring that is not of that of the rollers; of the contact laws lundberg knows it",
    )
    form: tuple[FormPart, ...] = field(
        default=(),
        doc="what is added up: waves, { lobes = 3, amplitude = '25 um', angle = '60 deg' }, and tables",
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
