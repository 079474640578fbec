"""Choices that a scene leaves open, such as the profile of the rollers, with what each may be instead.

- A choice is open where the scene does not state it, or where ``rollslip new`` assumed it, and where the named bearing
  does not state it: by letters of its designation, or by a datum whose grade is not (D).
- Alternatives that a scene refuses, such as one more roller where there is no room for it, are left out by those that
  evaluate them.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any, Final

import attrs

from rollslip.bearing.cage import CAGE_DESIGNS, read_cage
from rollslip.catalogue.discovery import find, load, own_cage
from rollslip.datasets import SURFACES, Surface
from rollslip.scene.changes import stated_values
from rollslip.scene.supply import SUPPLIES
from rollslip.scene.values import Scene
from rollslip.toml import as_table
from rollslip_studies.variation.scatter import states

__all__ = ["Choice", "open_choices"]

#: Values by key that make an alternative.
_Changes = Mapping[str, object]
#: Shape of a profile -> its name in texts. A crown and a table are the user's own, and are not open.
_PROFILES: Final = {"iso16281": "logarithmic", "none": "none"}
#: Fits on either side of the usual ones: seat -> fits, for rotating and for stationary rings (C).
_FITS: Final = {"shaft": ("j6", "p6"), "housing": ("N7",)}
#: Supplies of oil among which a scene may leave the choice open; users of mist and grease know that they have it.
_OIL_SUPPLIES: Final = ("bath", "splash", "circulating", "jet")
#: Roughness of ground surfaces at the upper end of its usual range (C); see `rollslip.datasets.SURFACES`.
_ROUGH: Final = Surface(
    inner_raceway_roughness=0.25e-6, outer_raceway_roughness=0.25e-6, roller_roughness=0.15e-6
)


@attrs.frozen(kw_only=True)
class Choice:
    """A choice that a scene leaves open."""

    key: str  #: Key in a scene.
    label: str  #: Name in texts.
    present: str  #: What the scene has by default, in texts.
    alternatives: Mapping[str, _Changes]  #: Name of an alternative -> values by key.
    grade: str  #: A letter of `rollslip.lubricant.GRADES` in parentheses.
    source: str  #: Source of the alternatives, in a sentence.


def open_choices(scene: Scene) -> Iterator[Choice]:
    """Yield the choices that a scene leaves open.

    Parameters
    ----------
    scene : Scene
        The scene.
    """
    raw = stated_values(scene)
    name = as_table(scene.tables.get("bearing")).get("name")
    named: Any = load(find("bearing", name)) if isinstance(name, str) else None

    def is_open(key: str) -> bool:
        """Whether the scene does not state the value of a key."""
        return not states(raw, key)

    def is_estimated(key: str) -> bool:
        """Whether neither the scene nor the data of its bearing state a value of the bearing."""
        return is_open(f"bearing.{key}") and (named is None or named.grades.get(key) == "D")

    bearing = scene.bearing
    if is_estimated("profile") and bearing.profile.shape in _PROFILES:
        yield Choice(
            key="bearing.profile",
            label="profile",
            present=_PROFILES[bearing.profile.shape],
            alternatives={
                text: {"bearing.profile": shape}
                for shape, text in _PROFILES.items()
                if shape != bearing.profile.shape
            },
            grade="(D)",
            source="the profile of ISO/TS 16281 for unknown ones, and straight rollers; makers print none",
        )
    own = own_cage(name)
    is_lettered = own is not None and bool(own.letters)
    has_cage = scene.models.neighbour_friction is None
    if has_cage and not is_lettered and is_open("cage.make") and is_open("cage.mass"):
        yield _cage(scene)
    if is_open("lubrication.supply"):
        yield _supply(scene)
    if bearing.mounted is not None:
        yield from _clearance(scene, bearing.mounted.assumed, is_open)
    if is_estimated("rollers"):
        yield Choice(
            key="bearing.rollers",
            label="rollers",
            present=str(bearing.rollers),
            alternatives={
                str(number): {"bearing.rollers": number}
                for number in (bearing.rollers - 1, bearing.rollers + 1)
            },
            grade="(D)",
            source="the number of rollers is estimated, and right within 1",
        )
    if is_open("surface"):
        yield Choice(
            key="surface",
            label="surface",
            present="ground",
            alternatives={
                "superfinished": {"surface": attrs.asdict(SURFACES["superfinished"][0])},
                "rough": {"surface": attrs.asdict(_ROUGH)},
            },
            grade="(C)",
            source="ground: " + "; superfinished: ".join(usual for _, usual in SURFACES.values()),
        )


def _cage(scene: Scene) -> Choice:
    """Return the choice of the make of the cage, with the guidance that goes with it."""
    make = read_cage(scene).make
    return Choice(
        key="cage.make",
        label="cage",
        present=make,
        alternatives={
            other: {"cage.make": other, "cage.guidance": design.guidance}
            for other, design in CAGE_DESIGNS.items()
            if other != make
        },
        grade="(D)",
        source="makes of cages, each with its typical mass, pockets and guidance",
    )


def _supply(scene: Scene) -> Choice:
    """Return the choice of the supply of oil among those that a gearbox may have."""
    supply = scene.lubrication.supply
    return Choice(
        key="lubrication.supply",
        label="supply",
        present=supply,
        alternatives={
            other: {"lubrication.supply": other} for other in _OIL_SUPPLIES if other != supply
        },
        grade="(D)",
        source="; ".join(f"{name}: {SUPPLIES[name].source}" for name in _OIL_SUPPLIES),
    )


def _clearance(scene: Scene, assumed: Collection[str], is_open: Any) -> Iterator[Choice]:
    """Yield the choices of clearance class and fits of a bearing whose clearance in operation follows from them."""
    bearing = scene.bearing
    name = as_table(scene.tables.get("bearing")).get("name")
    is_known = isinstance(name, str) and find("bearing", name).name.partition("-C")[2]
    stated = (is_open("bearing.clearance_class"), is_open("bearing.mounting.initial_clearance"))
    if bearing.clearance_class == "CN" and all(stated) and not is_known:
        yield Choice(
            key="bearing.clearance_class",
            label="clearance class",
            present="CN",
            alternatives={group: {"bearing.clearance_class": group} for group in ("C2", "C3")},
            grade="(C)",
            source="a designation without a class means CN; many bearings in stock and in gearboxes are C3",
        )
    fits = {
        f"{fit} on the {part}" if part == "shaft" else f"{fit} in the {part}": {
            f"bearing.mounting.{part}_fit": fit
        }
        for part, others in _FITS.items()
        if f"{part}_fit" in assumed
        for fit in others
    }
    if fits:
        yield Choice(
            key="bearing.mounting",
            label="fits",
            present="usual",
            alternatives=fits,
            grade="(C)",
            source="fits of light and of heavy loads on a shaft that turns, and of a housing in which the load turns",
        )
