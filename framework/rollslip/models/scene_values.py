"""Values that a drag or a law of a contact may take from the scene where they are not set."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

import attrs

__all__ = ["SCENE_VALUES", "from_scene", "left_to_scene"]

#: Name of a value -> SI unit, or None for a text, and meaning.
SCENE_VALUES: Final[Mapping[str, tuple[str | None, str]]] = MappingProxyType(
    {
        "viscosity": ("Pa s", "viscosity of the oil at operation.temperature and ambient pressure"),
        "density": ("kg/m3", "density of the oil"),
        "oil_fraction": ("1", "volume fraction of oil between the rings, of lubrication"),
        "oil_layer": ("m", "oil on both surfaces together before a contact, of lubrication"),
        "rollers": ("1", "number of rollers"),
        "roller_diameter": ("m", "diameter of a roller"),
        "roller_length": ("m", "length of a roller"),
        "orbit_radius": ("m", "radius of the orbit of the rollers"),
        "elastic_modulus": ("Pa", "Young's modulus of rings and rollers"),
        "radial_load": ("N", "radial load of the operation"),
        "temperature": ("K", "temperature of the operation"),
        "guiding_ring": (None, "ring whose land guides the cage"),
        "land_radius": ("m", "radius of the land that guides the cage"),
        "land_width": ("m", "width of that land that oil fills, all rails together"),
        "land_clearance": ("m", "radial clearance between cage and land"),
    }
)


def _given(value: object) -> object | None:
    """Return a value, or None for NaN and an empty text, so that missing values compare equal."""
    return value if value == value and value != "" else None


def from_scene(
    name: str,
    *,
    doc: str,
    validator: Callable[[Any, Any, Any], object] | None = None,
    usual: tuple[float, float] | None = None,
    possible: tuple[float, float] | None = None,
    keywords: Mapping[str, object] | None = None,
) -> Any:
    """Declare a parameter of a drag or a law that is taken from the scene where it is not set: NaN or "" until then.

    Parameters
    ----------
    name
        Name of the value, one of `SCENE_VALUES`, which also state its unit.
    doc, validator, usual, possible, keywords
        As in `rollslip.fields.parameter`; `rollslip.fields.within_possible` is a validator for the possible range.
    """
    unit = SCENE_VALUES[name][0]

    def if_given(instance: object, attribute: "attrs.Attribute[Any]", value: object) -> None:
        if validator is not None and _given(value) is not None:
            validator(instance, attribute, value)

    return attrs.field(
        default=math.nan if unit else "",
        validator=if_given,
        eq=_given,
        metadata={
            "doc": doc,
            "unit": unit,
            "from_scene": name,
            "usual": usual,
            "possible": possible,
            "keywords": keywords or {},
        },
    )


def left_to_scene(model: Any) -> "list[attrs.Attribute[Any]]":
    """Return the parameters of a model that are not set and have to be taken from the scene."""
    own = (a for a in attrs.fields(type(model)) if "from_scene" in a.metadata)
    return [a for a in own if _given(getattr(model, a.name)) is None]
