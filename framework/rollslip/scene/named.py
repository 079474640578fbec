"""Fill in the values that names in a scene stand for: data of bearings and surfaces, and the cage of a bearing.

Raceways of tapered rollers are filled in by their pitch diameter.

This is done before a scene is checked, because a scene that is read has all values. Plugins are loaded for names only.
"""

from collections.abc import Mapping
from typing import Any, Final

import attrs

from rollslip.datasets import SURFACES
from rollslip.errors import PluginError, UnknownNameError
from rollslip.geometry.axial import ContactAngles, raceway_diameters
from rollslip.scene.clearance import FOLLOWS, bearing_in_class, set_initial_clearance
from rollslip.scene.values import LISTS_OF_MODELS, Models, model_kind
from rollslip.structure import Location, bare_key, fields_of, resolved
from rollslip.toml import as_list, as_table
from rollslip.units import UnitError, as_written, quantity

__all__ = ["NAMED", "surface_name", "unknown_names", "with_named_data", "with_own_cage"]

#: Table that may start from named data -> meaning of such a name.
NAMED: Final = {"bearing": "a bearing that a plugin offers", "surface": " or ".join(SURFACES)}
#: Keys of ``[models]`` that name a model of a kind.
_KINDS: Final = frozenset(key for key, _ in fields_of(Models)) - {"approach", "separator"}

#: Key of the pitch diameter in a table of a bearing.
_PITCH: Final = "pitch_diameter"
#: Keys of the diameters that follow from it.
_RACEWAYS: Final = ("inner_raceway_diameter", "outer_raceway_diameter")
#: Keys that these follow from -> unit.
_SOURCES: Final = {_PITCH: "m", "roller_diameter": "m", "contact_angle": "rad"}


def with_named_data(
    raw: dict[str, object], where: Location, problems: list[str]
) -> dict[str, object]:
    """Return a raw scene with the values of the data that its tables name, without these names.

    Parameters
    ----------
    raw : dict
        The scene as it is written.
    where : Location
        Location of the scene, for messages.
    problems : list of str
        Faults are added: names whose data are all overridden.
    """
    complete = dict(raw)
    for kind in NAMED:
        table = raw.get(kind)
        at = where.at(kind).at("name")
        if not isinstance(table, Mapping) or "name" not in table:
            continue
        own = {key: value for key, value in table.items() if key != "name"}
        complete[kind] = own
        from rollslip.catalogue.discovery import (
            get_class,
        )  # only a scene that names data needs a plugin

        try:
            if not isinstance(name := table["name"], str):
                if isinstance(name, int) and not isinstance(name, bool):
                    get_class(kind, str(name))  # says what is called so: 6312 is a ball bearing
                problems.append(at.message(f"a text is expected, not {as_written(name)}"))
                continue
            data: Any = (
                SURFACES[surface_name(name)][0] if kind == "surface" else get_class(kind, name).data
            )
            if kind == "bearing":
                data = bearing_in_class(own, name, data, where.at(kind), problems)
            complete[kind] = filled = _filled(own, data)
            has_effect = any(filled[key] != own.get(key) for key in filled if key not in FOLLOWS)
            if kind == "bearing":
                set_initial_clearance(filled, own, data)
        except PluginError as error:
            raise type(error)(at.message(str(error))) from error
        if not has_effect:  # as when a name is set in a scene that states all values
            problems.append(
                at.message(
                    f"{name!r} gives nothing, every value is written out; leave out what it gives"
                )
            )
    return (
        _with_tapered_raceways(raw, complete)
        if _PITCH in as_table(complete.get("bearing"))
        else complete
    )


def surface_name(written: str) -> str:
    """Return the name in `SURFACES` for a name in any spelling; raise `UnknownNameError` where there is none."""
    from rollslip.catalogue.discovery import folded  # only a scene that names data needs it

    for name in SURFACES:
        if folded(name) == folded(written):
            return name
    raise UnknownNameError(
        f"no surface is called {as_written(written)}; there are: {', '.join(SURFACES)}"
    )


def _with_tapered_raceways(
    raw: Mapping[str, object], complete: dict[str, object]
) -> dict[str, object]:
    """Return a scene with the raceway diameters of a tapered bearing whose pitch diameter is stated.

    What is wrong with values is reported when they are read.
    """
    table = as_table(complete.get("bearing"))
    own = as_table(raw.get("bearing"))
    if any(key in own for key in _RACEWAYS):
        others = {key: value for key, value in table.items() if key != _PITCH or key in own}
        return {**complete, "bearing": others}
    try:
        pitch, diameter, angle = (quantity(table[key], unit) for key, unit in _SOURCES.items())
        half = table.get("roller_half_angle")
        if not 0.0 < diameter < pitch:
            return complete
        angles = ContactAngles.with_common_apex(angle, diameter / pitch)
        if half is not None:
            angles = ContactAngles(angle, quantity(half, "rad"))
    except (KeyError, UnitError):
        return complete
    diameters = raceway_diameters(pitch, diameter, angles)
    return {**complete, "bearing": {**table, **dict(zip(_RACEWAYS, diameters, strict=True))}}


def with_own_cage(raw: Mapping[str, object], complete: dict[str, object]) -> dict[str, object]:
    """Return a scene with the cage, or the missing cage, of its bearing's designation where it does not state one.

    Parameters
    ----------
    raw : mapping
        The scene as it is written, with the name of the bearing.
    complete : dict
        The scene with named data.
    """
    bearing = raw.get("bearing")
    cage = raw.get("cage", {})
    if not (isinstance(bearing, Mapping) and "name" in bearing and isinstance(cage, Mapping)):
        return complete
    from rollslip.catalogue.discovery import own_cage  # only a scene that names data needs a plugin

    models = raw.get("models", {})
    if (own := own_cage(bearing["name"])) is None or not isinstance(models, Mapping):
        return complete
    separator = models.get("separator", {})
    if not own.make:
        if isinstance(separator, Mapping):
            separator = {"model": "none", **separator}
        return {**complete, "models": {**models, "separator": separator}}
    if separator not in ({}, "cage", {"model": "cage"}):
        return complete
    guidance = {"guidance": own.guidance} if cage.get("make", own.make) == own.make else {}
    return {**complete, "cage": {"make": own.make, **guidance, **cage}}


def _filled(table: Mapping[str, object], data: Any) -> dict[str, object]:
    """Return a table with the named data in place of missing values, except values that follow from others anyway."""
    filled = dict(table)
    for key, attribute in fields_of(type(data)):
        value = getattr(data, attribute.name)
        inner = attrs.has(type(value))
        if key not in filled:
            default: Any = attribute.default
            follows = (
                isinstance(default, attrs.Factory)  # type: ignore[arg-type]
                and default.takes_self
                and default.factory(data) == value
            )
            if value is not None and not follows:
                filled[key] = resolved(value) if inner else value
        # a table that states its bare name is a choice, which named data do not complete
        elif (
            inner
            and isinstance(below := filled[key], Mapping)
            and bare_key(type(value)) not in below
        ):
            filled[key] = _filled(below, value)
    return filled


def unknown_names(raw: Mapping[str, object], where: Location) -> list[str]:
    """Return messages on unknown names of models, studies and the oil, whose tables are read later than the scene.

    Parameters
    ----------
    raw : mapping
        The scene as it is written.
    where : Location
        Location of the scene, for messages.
    """
    from rollslip.catalogue.discovery import find

    wanted = [("lubricant", where.at("lubricant").at("name"), raw.get("lubricant"), "name")]
    for table in ("models", "study"):
        at = where.at(table)
        for key, given in as_table(raw.get(table)).items():
            if table == "study":
                wanted.append(("study", at.at(key), key, ""))
            elif key in _KINDS:
                wanted += [
                    (
                        model_kind(key),
                        at.at(key).at(k) if key in LISTS_OF_MODELS else at.at(key),
                        choice,
                        "model",
                    )
                    for k, choice in enumerate(as_list(given))
                ]
    problems = []
    for kind, location, named, key in wanted:
        name = named.get(key) if isinstance(named, Mapping) else named
        try:
            if isinstance(name, str):
                find(kind, name)
        except PluginError as error:
            problems.append(location.message(str(error)))
    return problems
