"""Choices that a scene leaves open, such as the profile of the rollers, with what each may be instead.

- A choice is open where the scene does not state it, or where ``rollslip new`` assumed it, and where the named bearing
  does not state it: by letters of its designation, or by a datum whose grade is not (D).
- Alternatives that a scene refuses, such as one more roller where there is no room for it, are left out by those that
  evaluate them.
"""

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any, Final

import attrs

from rollslip.bearing.cage import CAGE_DESIGNS, read_cage
from rollslip.catalogue.discovery import find, load, own_cage
from rollslip.datasets import SURFACES
from rollslip.geometry.surfaces import Surface
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
#: Supplies of oil among which a scene may leave the choice open; users of mist and grease know that they have it.
_OIL_SUPPLIES: Final = ("bath", "splash", "circulating", "jet")
#: Coefficients of friction of ribs beside a film: of full films of all contacts, and of boundary friction.
_RIB_COEFFICIENTS: Final = (0.02, 0.1)
#: Classes of clearance beside CN: smaller and larger.
_CLASSES: Final = ("C2", "C3")
#: Name of a fit beside the usual ones -> key and fit: of light and of heavy loads on a shaft that turns, and of a
#: housing in which the load turns (C).
_FITS: Final = {
    "j6 on the shaft": ("shaft_fit", "j6"),
    "p6 on the shaft": ("shaft_fit", "p6"),
    "N7 in the housing": ("housing_fit", "N7"),
}
#: Surfaces beside ground ones, and the upper end of what is usual of these (C); see `rollslip.datasets.SURFACES`.
_SURFACES: Final = {
    "superfinished": SURFACES["superfinished"][0],
    "rough": Surface(
        inner_raceway_roughness=0.25e-6, outer_raceway_roughness=0.25e-6, roller_roughness=0.15e-6
    ),
}
#: Key of a choice -> other keys which make it where a scene states them.
_MADE_BY: Final[Mapping[str, tuple[str, ...]]] = {
    "cage.make": ("cage.mass",),
    "bearing.clearance_class": ("bearing.mounting.initial_clearance",),
}


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
    stated = stated_values(scene)
    name = as_table(scene.tables.get("bearing")).get("name")
    every = (
        _of_bearing(scene, name),
        _of_cage(scene, name),
        _of_clearance(scene, name),
        _of_ribs(scene),
    )
    for choice in chain(*every):
        keys = (choice.key, *_MADE_BY.get(choice.key, ()))
        if choice.alternatives and not any(states(stated, key) for key in keys):
            yield choice


def _of_bearing(scene: Scene, name: Any) -> Iterator[Choice]:
    """Yield the choices of profile and number of rollers where these are estimated, of supply and of roughness."""
    bearing = scene.bearing
    grades = {"profile": "D"}
    if isinstance(name, str):
        grades = load(find("bearing", name)).grades
    if grades.get("profile") == "D" and bearing.profile.shape in _PROFILES:
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
    if grades.get("rollers") == "D":
        numbers = bearing.rollers - 1, bearing.rollers + 1
        yield Choice(
            key="bearing.rollers",
            label="rollers",
            present=str(bearing.rollers),
            alternatives={str(number): {"bearing.rollers": number} for number in numbers},
            grade="(D)",
            source="the number of rollers is estimated, and right within 1",
        )
    supply = scene.lubrication.supply
    yield Choice(
        key="lubrication.supply",
        label="supply",
        present=supply,
        alternatives={
            other: {"lubrication.supply": other} for other in _OIL_SUPPLIES if other != supply
        },
        grade="(D)",
        source="; ".join(f"{other}: {SUPPLIES[other].source}" for other in _OIL_SUPPLIES),
    )
    yield Choice(
        key="surface",
        label="surface",
        present="ground",
        alternatives={name: {"surface": attrs.asdict(other)} for name, other in _SURFACES.items()},
        grade="(C)",
        source="; ".join(f"{name}: {usual}" for name, (_, usual) in SURFACES.items()),
    )


def _of_cage(scene: Scene, name: Any) -> Iterator[Choice]:
    """Yield the choice of the make of a cage, with the guidance that goes with it; none where letters state it."""
    own = own_cage(name)
    if scene.models.neighbour_friction is not None or (own is not None and own.letters):
        return
    make = read_cage(scene).make
    yield Choice(
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


def _of_ribs(scene: Scene) -> Iterator[Choice]:
    """Yield the choice of the friction of ribs, where these carry an axial load."""
    if not scene.operation.axial_load:
        return
    yield Choice(
        key="models.rib",
        label="rib friction",
        present=scene.models.rib_friction.name,
        alternatives={
            str(value): {"models.rib": {"model": "constant", "coefficient": value}}
            for value in _RIB_COEFFICIENTS
        },
        grade="(D)",
        source="0.02 of SKF's full films, and 0.1 of ribs that roller ends touch at an edge (B)",
    )


def _of_clearance(scene: Scene, name: Any) -> Iterator[Choice]:
    """Yield the choices of clearance class and fits, where the clearance in operation follows from them."""
    bearing = scene.bearing
    if (mounted := bearing.mounted) is None:
        return
    if bearing.clearance_class == "CN" and isinstance(name, str):
        yield Choice(
            key="bearing.clearance_class",
            label="clearance class",
            present="CN",
            alternatives={group: {"bearing.clearance_class": group} for group in _CLASSES},
            grade="(C)",
            source="a designation without a class means CN; many bearings in stock and in gearboxes are C3",
        )
    yield Choice(
        key="bearing.mounting.fits",
        label="fits",
        present="usual",
        alternatives={
            text: {f"bearing.mounting.{key}": fit}
            for text, (key, fit) in _FITS.items()
            if key in mounted.assumed
        },
        grade="(C)",
        source="fits of light and of heavy loads on a shaft that turns, and of a housing in which the load turns",
    )
