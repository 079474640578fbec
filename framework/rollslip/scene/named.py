"""What the names in a scene stand for: values of a bearing that plugins offer and of surfaces, and a bearing's cage.

They are filled in before a scene is checked, since it is complete once it is read; only then is a plugin loaded.
"""

from collections.abc import Mapping
from typing import Any, Final

import attrs

from rollslip.datasets import SURFACES
from rollslip.errors import PluginError, UnknownNameError
from rollslip.scene.clearance import FOLLOWS, before_mounting, listed
from rollslip.scene.values import Models, model_kind
from rollslip.structure import Location, bare_key, fields_of, resolved
from rollslip.units import as_written

__all__ = ["NAMED", "surface_name", "unknown_names", "with_named_data", "with_own_cage"]

#: Tables that may start from the values of a named set, and what such a name is of.
NAMED: Final = {"bearing": "a bearing that a plugin offers", "surface": " or ".join(SURFACES)}
#: Keys of models, each the kind that it takes.
_KINDS: Final = frozenset(key for key, _ in fields_of(Models)) - {"separator"}


def with_named_data(
    raw: dict[str, object], where: Location, problems: list[str]
) -> dict[str, object]:
    """Return a raw scene with the values of the data that its tables name; the name itself is no value of a scene."""
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
                data = listed(own, name, data, where.at(kind), problems)
            complete[kind] = filled = _filled(own, data)
            gives = any(filled[key] != own.get(key) for key in filled if key not in FOLLOWS)
            if kind == "bearing":
                before_mounting(filled, own, data)
        except PluginError as error:
            raise type(error)(at.message(str(error))) from error
        if not gives:  # as when a name is set in a scene that spells all values out
            problems.append(
                at.message(
                    f"{name!r} gives nothing, every value is written out; leave out what it gives"
                )
            )
    return complete


def surface_name(written: str) -> str:
    """Return the name that `SURFACES` has for surfaces, however it is spelled."""
    from rollslip.catalogue.discovery import folded  # only a scene that names data needs it

    if (name := next((one for one in SURFACES if folded(one) == folded(written)), None)) is None:
        raise UnknownNameError(
            f"no surface is called {as_written(written)}; there are: {', '.join(SURFACES)}"
        )
    return name


def with_own_cage(raw: Mapping[str, object], complete: dict[str, object]) -> dict[str, object]:
    """Return a raw scene with the cage that its bearing's name stands for, or without one, where it does not say."""
    bearing = raw.get("bearing")
    cage = raw.get("cage", {})
    if not (isinstance(bearing, Mapping) and "name" in bearing and isinstance(cage, Mapping)):
        return complete
    from rollslip.catalogue.discovery import own_cage  # only a scene that names data needs a plugin

    models = raw.get("models", {})
    if (own := own_cage(bearing["name"])) is None or not isinstance(models, Mapping):
        return complete
    apart = models.get("separator", {})
    if not own.make:
        apart = {"model": "none", **apart} if isinstance(apart, Mapping) else apart
        return {**complete, "models": {**models, "separator": apart}}
    if apart not in ({}, "cage", {"model": "cage"}):
        return complete
    guidance = {"guidance": own.guidance} if cage.get("make", own.make) == own.make else {}
    return {**complete, "cage": {"make": own.make, **guidance, **cage}}


def _filled(table: Mapping[str, object], data: Any) -> dict[str, object]:
    """Fill what a table leaves out with given values, but for those that follow from others and follow on."""
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
        elif inner and bare_key(type(value)) is None and isinstance(below := filled[key], Mapping):
            filled[key] = _filled(
                below, value
            )  # a table that may be a bare name is a choice, and taken whole
    return filled


def unknown_names(raw: Mapping[str, object], where: Location) -> list[str]:
    """Return the faults of names of models, studies and the oil, whose tables are read only once all else is right."""
    from rollslip.catalogue.discovery import find

    wanted = [("lubricant", where.at("lubricant").at("name"), raw.get("lubricant"), "name")]
    for table in ("models", "study"):
        below = raw.get(table)
        at = where.at(table)
        for key, given in below.items() if isinstance(below, Mapping) else ():
            if table == "study":
                wanted.append(("study", at.at(key), key, ""))
            elif key in _KINDS:
                several = given if isinstance(given, list | tuple) else (given,)
                wanted += [(model_kind(key), at.at(key), one, "model") for one in several]
    problems = []
    for kind, place, named, key in wanted:
        name = named.get(key) if isinstance(named, Mapping) else named
        try:
            if isinstance(name, str):
                find(kind, name)
        except PluginError as error:
            problems.append(place.message(str(error)))
    return problems
