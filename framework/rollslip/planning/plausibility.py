"""What is unusual in a scene, of all that it holds: its own tables, the oil, the cage, models and studies.

- A range of a single value stands beside its field (`rollslip.fields.field`), what has to fit another value in
  `rollslip.scene.relations`.
- Only what somebody wrote is judged by its field: named data, defaults and estimates have other authors.
- Where a key takes many values, as in a sweep, that is said once for all of them.
"""

import contextlib
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from numbers import Real
from types import UnionType
from typing import Any, Union, get_args, get_origin

import attrs
import numpy as np

from rollslip.bearing.cage import Cage, implausible_values
from rollslip.catalogue.registry import get_class, structure_model
from rollslip.errors import PluginError, RollslipError
from rollslip.fields import unusual
from rollslip.lubricant.base_oil import HIGHEST_INDEX, LOWEST_INDEX
from rollslip.lubricant.table import OilTable, index_of
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.clearance import unused
from rollslip.scene.relations import RELATIONS
from rollslip.scene.rings import rings_of, yielding
from rollslip.scene.values import Scene, model_kind
from rollslip.structure import Location, fields_of, resolved, types_of
from rollslip.studies.study import study_class
from rollslip.toml import parse, split_key
from rollslip.units import UnitError, as_written, quantity, unit_given

__all__ = ["implausible", "implausible_along"]


def implausible(scene: Scene, moved: Collection[str] = ()) -> list[str]:
    """Return what is unusual in a scene, with place, value and what was likely meant; most scenes have nothing.

    What stands at keys that are ``moved`` is left to `implausible_along`.
    """
    raw = scene.tables
    where = Location(scene.origins)
    found = [*_unusual_values(Scene, raw, where)]
    found += _unusual_values(OilTable, raw.get("lubricant"), where.at("lubricant"))
    found += _oil(scene, raw, where.at("lubricant"))
    found += _unusual_values(Cage, raw.get("cage"), where.at("cage"))
    found += _models(raw, where)
    studies = raw.get("study")
    for name, table in studies.items() if isinstance(studies, Mapping) else ():
        with contextlib.suppress(RollslipError):  # who runs it says so
            found += _unusual_values(study_class(name, scene), table, where.at("study").at(name))
    found += _unusual_relations(scene, raw, where)
    told = {at.path for at, _ in found}
    if not any(path[0] == "bearing" for path in told):  # of a bearing in doubt none of a cage is
        found += [(at, text) for at, text in implausible_values(scene) if at.path not in told]
    found += _clearance(scene, raw, where.at("bearing"))
    return [
        *dict.fromkeys(
            at.message(told) for at, told in found if ".".join(map(str, at.path)) not in moved
        )
    ]


def _unusual_relations(
    scene: Scene, raw: Mapping[str, object], where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield place and sentence for each relation that is not usual, but of values that are not by themselves."""
    for relation in RELATIONS:
        at = relation.at(where)
        told = relation.fault(scene, raw, "usual")
        if told and not any(_unusual(relation.attribute(scene), relation.written(raw), at)):
            yield at, told


def _oil(scene: Scene, raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    """Say what viscosities no oil has, and what a name in place of another keeps and leaves of the table as written."""
    now = raw.get("lubricant")
    now = {"name": now} if isinstance(now, str) else now if isinstance(now, Mapping) else {}
    index = index_of(now)
    if not (math.isnan(index) or LOWEST_INDEX <= index <= HIGHEST_INDEX):
        yield (
            where.at("points"),
            f"the viscosities make a viscosity index of {index:.0f}, oils have -50 to 300; check them",
        )
    try:
        before = parse(scene.text, "")[0].get("lubricant")
    except (RollslipError, ValueError):  # the text of another program
        return
    if not isinstance(before, Mapping) or now.get("name") in (None, before.get("name")):
        return
    own = {key: as_written(value) for key, value in before.items() if key != "name"}
    kept = [
        f"{key} = {value}" for key, value in own.items() if key in now and now[key] == before[key]
    ]
    left = [f"{key} = {value}" for key, value in own.items() if key not in now]
    name = now["name"]
    if kept:
        yield (
            where,
            f"{name!r} keeps what the scene states: {', '.join(kept)}; lubricant={name} alone leaves it out",
        )
    if left:
        yield (
            where,
            f"{name!r} leaves out what the scene states: {', '.join(left)}; lubricant.name={name} keeps it",
        )


def _clearance(
    scene: Scene, raw: Mapping[str, Any], where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield what is stated beside a clearance in operation and not used, and that seats leave a preload."""
    for key in unused(raw.get("bearing", {})):
        yield where.at(key), "is not used: bearing.radial_clearance is stated, that in operation"
    b = scene.bearing
    mounted = scene.bearing.mounted
    at = where.at("mounting" if mounted else "radial_clearance")
    uniform = -b.radial_clearance
    rings = rings_of(
        scene,
        lambda choice, at: structure_model(
            "ring", {"model": choice.name, **choice.parameters}, at, []
        ),
        [],
    )
    stated = {} if rings is None else rings.yielding
    for ring, shapes in stated.items() if mounted else ():
        for key in shapes.departs:
            told = "is not as in bearing.mounting, from which the clearance in operation follows; state it there alone"
            yield Location(scene.origins).at("models").at(f"{ring}_ring").at(key), told
    if len(stated) == 2:
        return
    parts = [(uniform, 0, "")] if uniform > 0.0 else []
    if rings is not None and (rings.waves or rings.tables):  # all parts together
        formed = next(
            ring
            for ring in ("outer", "inner")
            if getattr(getattr(b, f"{ring}_raceway"), "form", ())
        )
        by_form = 2.0 * float(rings.form(np.linspace(0.0, 2.0 * np.pi, 721)).max()) + min(
            uniform, 0.0
        )
        lobes = max(rings.waves, key=lambda wave: wave[1], default=(2, 0.0, 0.0))[
            0
        ]  # a table is taken for an oval
        if by_form > 0.0:
            at = at if parts else where.at(f"{formed}_raceway")
            parts.append((by_form, lobes, " by the form" if parts else ""))
    if not parts:
        return
    rigid = [ring for ring in ("outer", "inner") if ring not in stated]
    here = "rings are" if len(rigid) == 2 else f"the {rigid[0]} ring is"
    keys = " and ".join(f"models.{ring}_ring" for ring in rigid)
    how = f": {mounted}" if mounted and uniform > 0.0 else ""
    told = "too large"
    seated = " (with the housing and shaft of bearing.mounting, or thick ones)"
    with contextlib.suppress(RollslipError):
        fractions = []
        for preload, lobes, what in parts:
            bare, held = (
                100 * one.fraction(lobes) for one in yielding(b, lobes=lobes, stated=stated)
            )
            fractions.append(
                f"of {preload * 1e6:.3g} um{what} about {bare:.0f} % (bare rings) to {held:.0f} %{seated}"
            )
            seated = ""
        told = f"too large: {' and '.join(fractions)} reach the rollers"
    yield (
        at,
        f"the bearing runs preloaded{how}; {here} rigid here, so that forces of rollers are {told}; give {keys}, or "
        "take a looser fit or class",
    )


def _models(raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    models = raw.get("models")
    cage = raw.get("cage")
    for kind, model in models.items() if isinstance(models, Mapping) else ():
        yield from _unusual_model(model_kind(kind), model, where.at("models").at(kind))
    drags = cage.get("drag", ()) if isinstance(cage, Mapping) else ()
    for k, drag in enumerate(drags if isinstance(drags, list | tuple) else ()):
        yield from _unusual_model("drag", drag, where.at("cage").at("drag").at(k))


def implausible_along(
    scene: Scene, of: Quantity, values: Sequence[object], which: str = "values"
) -> list[str]:
    """Return what is unusual of values that a key of a scene takes, each kind once, with the first value that is.

    What is unusual in the scene by itself is left to `implausible`.
    """
    told_by_itself = {
        at.path
        for at, _ in (*_unusual_relations(scene, resolved(scene), Location({})), *implausible_values(scene))
    }
    first = dict[str, str]()
    counts = dict[str, int]()
    for value in values:
        for key, told in _unusual_at(scene, of, value, told_by_itself):
            first.setdefault(key, told)
            counts[key] = counts.get(key, 0) + 1
    found = []
    for key, told in first.items():
        among = f"{counts[key]} of {len(values)} {which}"
        at = f"{key}, {among}" if key.startswith(of.key) else f"{key}, at {among} of {of.key}"
        found.append(
            f"{at}{', the first' if counts[key] > 1 else ''}: {told}"
            if len(values) > 1
            else f"{key}: {told}"
        )
    return found


def _unusual_at(
    scene: Scene, of: Quantity, value: object, told_by_itself: set[Any]
) -> Iterator[tuple[str, str]]:
    """Yield each key that is unusual where a key takes a value, and what is."""
    if of.model:
        for at, told in _unusual_model(of.model, value, Location({}, split_key(of.key))):
            yield at.message(""), told
    elif of.unit is not None or of.whole:
        number: Any = of.read(value)
        if told := unusual(
            of.attribute, number, None if of.unit is None else unit_given(value, of.unit)
        ):
            yield of.key, told
    changed = evolve(scene, {of.key: value})
    for at, told in (*_unusual_relations(changed, changed.tables, Location({})), *implausible_values(changed)):
        if at.path not in told_by_itself or at.message("") == of.key:
            yield at.message(""), told


# Values by their fields ----------------------------------------------------------------------------------------------


def _unusual_values(cls: Any, raw: object, where: Location) -> Iterator[tuple[Location, str]]:
    """Yield place and sentence for each value of a raw table that its field does not call usual."""
    if not isinstance(raw, Mapping):
        return
    kinds = types_of(cls)
    for key, attribute in fields_of(cls):
        if key not in raw:
            continue
        value = raw[key]
        at = where.at(key)
        if (kind := attribute.metadata.get("kind")) is not None:
            yield from _unusual_model(kind, value, at)
            continue
        for inner, table, place in _tables(kinds[attribute.name], value, at):
            yield from _unusual_values(inner, table, place)
            for a in attrs.fields(inner):
                if a.metadata.get(
                    "own_unit"
                ):  # a property over temperature: its values are those of the property
                    yield from _unusual(attribute, table.get(a.name), place.at(a.name))
        yield from _unusual(attribute, value, at)


def _unusual_model(kind: str, raw: object, where: Location) -> Iterator[tuple[Location, str]]:
    """Yield place and sentence for each parameter of a model that its field does not call usual."""
    if isinstance(raw, Mapping) and isinstance(name := raw.get("model"), str):
        try:
            cls = get_class(kind, name)
        except PluginError:  # who makes the model says so
            return
        if attrs.has(cls):
            yield from _unusual_values(cls, raw, where)


def _tables(
    kind: Any, raw: object, where: Location
) -> Iterator[tuple[Any, Mapping[str, object], Location]]:
    """Yield the attrs classes that a value is read as, its tables and their places."""
    for one in get_args(kind) if get_origin(kind) in (Union, UnionType, tuple) else (kind,):
        if attrs.has(one) and isinstance(raw, Mapping):
            yield one, raw, where
        elif attrs.has(one) and isinstance(raw, list | tuple):
            yield from (
                (one, table, where.at(k))
                for k, table in enumerate(raw)
                if isinstance(table, Mapping)
            )


def _unusual(
    attribute: "attrs.Attribute[Any]", raw: object, where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield place and sentence for a number, or for each of a list, that its field does not call usual."""
    if isinstance(raw, list | tuple):
        for k, one in enumerate(raw):
            yield from _unusual(attribute, one, where.at(k))
        return
    if (
        isinstance(raw, bool)
        or not isinstance(raw, Real | str)
        or raw in attribute.metadata.get("words", ())
    ):
        return
    unit = attribute.metadata.get("unit")
    try:
        value = quantity(raw, unit or "1")
    except UnitError:  # a text in place of a table
        return
    if told := unusual(attribute, value, None if unit is None else unit_given(raw, unit)):
        yield where, told
