"""Check a scene for unusual values: in its own tables, the oil, the cage, models and studies.

- The usual range of a value is defined with its field (`rollslip.fields.field`), the relations between values in
  `rollslip.scene.relations`.
- Only values that the scene states are checked by their fields. Named data, defaults and estimates are not.
- Where a key takes many values, as in a sweep, there is one message for all of them.
"""

import contextlib
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from numbers import Real
from types import UnionType
from typing import Any, Final, Union, get_args, get_origin

import attrs
import numpy as np

from rollslip.bearing.cage import Cage, implausible_values
from rollslip.catalogue.discovery import ignored_letters
from rollslip.catalogue.registry import get_class, structure_model
from rollslip.errors import PluginError, RollslipError
from rollslip.fields import unusual
from rollslip.lubricant.base_oil import HIGHEST_INDEX, LOWEST_INDEX
from rollslip.lubricant.table import OilTable, deviation_of, index_of, unusual_properties
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.clearance import unused_keys
from rollslip.scene.oil import faulty_constants
from rollslip.scene.relations import RELATIONS
from rollslip.scene.rings import ring_flexibility, rings_of
from rollslip.scene.values import Scene, model_kind
from rollslip.structure import Location, fields_of, resolved, types_of
from rollslip.studies.study import study_class
from rollslip.toml import as_table, parse, split_key
from rollslip.units import UnitError, as_written, format_quantity, quantity, unit_given

__all__ = ["implausible", "implausible_in_sweep"]


#: Angles at which the form of a ring is sampled, one for half a degree: enough for waves of up to 100 lobes.
_FORM_ANGLES: Final = 721
#: Relative deviation of Walther's law from a stated viscosity that is reported. Chosen: twice the reproducibility of
#: viscosity measurements, about 1 %; with a larger one the shown slips differ from those by the stated viscosity.
_POINT_TOLERANCE: Final = 0.02


def implausible(scene: Scene, varied_keys: Collection[str] = ()) -> list[str]:
    """Return messages on unusual values of a scene, with key, value and what was likely meant.

    Parameters
    ----------
    scene : Scene
        The scene.
    varied_keys : collection of str
        Keys that a campaign varies; they are left to `implausible_in_sweep`.
    """
    raw = scene.tables
    where = Location(scene.origins)
    messages = [*_unusual_values(Scene, raw, where)]
    messages += _unusual_values(OilTable, raw.get("lubricant"), where.at("lubricant"))
    messages += _oil(scene, raw, where.at("lubricant"))
    designation = str(as_table(raw.get("bearing")).get("name", ""))
    if ignored := ignored_letters(designation) if designation else "":
        messages.append(
            (where.at("bearing").at("name"), f"{ignored} of {designation!r} has no effect here")
        )
    messages += _unusual_values(Cage, raw.get("cage"), where.at("cage"))
    messages += _models(raw, where)
    for name, table in as_table(raw.get("study")).items():
        with contextlib.suppress(RollslipError):  # a run of the study reports it
            messages += _unusual_values(study_class(name, scene), table, where.at("study").at(name))
    messages += _unusual_relations(scene, raw, where)
    paths = {at.path for at, _ in messages}
    if not any(path[0] == "bearing" for path in paths):  # an unusual bearing makes its cage unusual
        messages += [(at, text) for at, text in implausible_values(scene) if at.path not in paths]
    messages += _clearance(scene, raw, where.at("bearing"))
    return [
        *dict.fromkeys(
            at.message(text)
            for at, text in messages
            if ".".join(map(str, at.path)) not in varied_keys
        )
    ]


def _unusual_relations(
    scene: Scene, raw: Mapping[str, object], where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield location and text for each unusual relation between values which are usual by themselves."""
    for relation in RELATIONS:
        at = relation.location(where)
        text = relation.describe_violation(scene, raw, "usual")
        if text and not any(_unusual(relation.attribute(scene), relation.written_value(raw), at)):
            yield at, text


def _oil(scene: Scene, raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    """Yield location and text for viscosities that no oil has, and for the effect of a name on the table as written."""
    present: Mapping[str, Any] = {}
    match raw.get("lubricant"):
        case str(name):
            present = {"name": name}
        case Mapping() as table:
            present = table
    yield from _named_oil(present, where)
    index = index_of(present)
    if not (math.isnan(index) or LOWEST_INDEX <= index <= HIGHEST_INDEX):
        yield (
            where.at("points"),
            f"the viscosities make a viscosity index of {index:.0f}, oils have -50 to 300; check them",
        )
    deviation, temperature = deviation_of(present)
    if abs(deviation) > _POINT_TOLERANCE:
        yield (
            where.at("points"),
            f"Walther's law differs by {100.0 * deviation:+.2g} % from the viscosity stated at "
            f"{format_quantity(temperature, 'K')}; check the points, or write viscosity_law = 'vogel', which passes "
            "through three",
        )
    try:
        written = parse(scene.text, "")[0].get("lubricant")
    except (RollslipError, ValueError):  # the text of another program
        return
    if not isinstance(written, Mapping) or present.get("name") in (None, written.get("name")):
        return
    own = {key: as_written(value) for key, value in written.items() if key != "name"}
    retained = [
        f"{key} = {value}"
        for key, value in own.items()
        if key in present and present[key] == written[key]
    ]
    dropped = [f"{key} = {value}" for key, value in own.items() if key not in present]
    name = present["name"]
    if retained:
        yield (
            where,
            f"{name!r} keeps what the scene states: {', '.join(retained)}; lubricant={name} alone leaves it out",
        )
    if dropped:
        yield (
            where,
            f"{name!r} leaves out what the scene states: {', '.join(dropped)}; lubricant.name={name} keeps it",
        )


def _named_oil(present: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    """Yield location and text for unusual data of a named oil that the scene does not replace."""
    with contextlib.suppress(RollslipError):  # the assembly reports a wrong name or oil
        oil = get_class("lubricant", str(present.get("name", "")))
        for key, text in unusual_properties(oil).items():
            if key not in present:
                yield where.at("name"), f"{key} of {oil.name!r}: {text}"
        for text in faulty_constants(oil) if oil.models else ():
            yield where.at("name"), f"constants of {oil.name!r}: {text}"


def _clearance(
    scene: Scene, raw: Mapping[str, Any], where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield location and text for what is stated besides a clearance in operation, and for a preload of rigid rings."""
    for key in unused_keys(raw.get("bearing", {})):
        yield where.at(key), "is not used: bearing.radial_clearance is stated, that in operation"
    rings = rings_of(
        scene,
        lambda choice, at: structure_model(
            "ring", {"model": choice.name, **choice.parameters}, at, []
        ),
        [],
    )
    stated = {} if rings is None else rings.flexible_rings
    for ring, shapes in stated.items() if scene.bearing.mounted else ():
        for key in shapes.departs:
            yield (
                Location(scene.origins).at("models").at(f"{ring}_ring").at(key),
                "is not as in bearing.mounting, from which the clearance in operation follows; state it there alone",
            )
    if len(stated) < 2:
        yield from _preload(scene, rings, stated, where)


def _preload(
    scene: Scene, rings: Any, stated: Mapping[str, Any], where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield location and text for a preload by interference or form where a ring is rigid, which makes it too large."""
    mounted = scene.bearing.mounted
    interference = -scene.bearing.radial_clearance
    at = where.at("mounting" if mounted else "radial_clearance")
    parts = [(interference, 0, "")] if interference > 0.0 else []
    if rings is not None and (rings.waves or rings.tables):
        by_form, lobes, ring = _form_preload(scene, rings, interference)
        if by_form > 0.0:
            if not parts:
                at = where.at(f"{ring}_raceway")
            parts.append((by_form, lobes, " by the form" if parts else ""))
    if not parts:
        return
    rigid = [ring for ring in ("outer", "inner") if ring not in stated]
    subject = "rings are" if len(rigid) == 2 else f"the {rigid[0]} ring is"
    keys = " and ".join(f"models.{ring}_ring" for ring in rigid)
    reason = f": {mounted}" if mounted and interference > 0.0 else ""
    excess = "too large"
    with contextlib.suppress(RollslipError):
        excess = f"too large: {_describe_fractions(scene, parts, stated)} reach the rollers"
    yield (
        at,
        f"the bearing runs preloaded{reason}; {subject} rigid here, so that forces of rollers are {excess}; give "
        f"{keys}, or take a looser fit or class",
    )


def _describe_fractions(
    scene: Scene, parts: Sequence[tuple[float, int, str]], stated: Mapping[str, Any]
) -> str:
    """Return the fractions of preloads [m] that would reach the rollers with flexible rings, bare and seated."""
    note = " (with the housing and shaft of bearing.mounting, or thick ones)"
    texts = []
    for preload, lobes, part in parts:
        bare, seated = (
            100 * flexibility.fraction(lobes)
            for flexibility in ring_flexibility(scene.bearing, lobes=lobes, stated=stated)
        )
        texts.append(
            f"of {preload * 1e6:.3g} um{part} about {bare:.0f} % (bare rings) to {seated:.0f} %{note}"
        )
        note = ""
    return " and ".join(texts)


def _form_preload(scene: Scene, rings: Any, interference: float) -> tuple[float, int, str]:
    """Return the largest preload by the forms of both raceways together [m], its lobes, and a ring that has a form."""
    ring = next(
        ring
        for ring in ("outer", "inner")
        if getattr(getattr(scene.bearing, f"{ring}_raceway"), "form", ())
    )
    form = rings.form(np.linspace(0.0, 2.0 * np.pi, _FORM_ANGLES))
    # a table is taken for an oval
    lobes, *_ = max(rings.waves, key=lambda wave: wave[1], default=(2, 0.0, 0.0))
    return 2.0 * float(form.max()) + min(interference, 0.0), lobes, ring


def _models(raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    """Yield location and text for each unusual parameter of models and drags."""
    for kind, model in as_table(raw.get("models")).items():
        yield from _unusual_model(model_kind(kind), model, where.at("models").at(kind))
    drags = as_table(raw.get("cage")).get("drag", ())
    for k, drag in enumerate(drags if isinstance(drags, list | tuple) else ()):
        yield from _unusual_model("drag", drag, where.at("cage").at("drag").at(k))


def implausible_in_sweep(
    scene: Scene, varied: Quantity, values: Sequence[object], which: str = "values"
) -> list[str]:
    """Return messages on unusual values of a key that is varied, one of each kind, with the first unusual value.

    What is unusual in the scene without the variation is left to `implausible`.

    Parameters
    ----------
    scene : Scene
        The scene.
    varied : Quantity
        The key that is varied.
    values : sequence
        Its values, as written in a scene.
    which : str
        What the values are, in messages: "values tried".
    """
    known_paths = {
        at.path
        for at, _ in (
            *_unusual_relations(scene, resolved(scene), Location({})),
            *implausible_values(scene),
        )
    }
    texts = dict[str, list[str]]()
    for value in values:
        for key, text in _unusual_at(scene, varied, value, known_paths):
            texts.setdefault(key, []).append(text)
    messages = []
    for key, (text, *others) in texts.items():
        if len(values) == 1:
            messages.append(f"{key}: {text}")
            continue
        count = f"{1 + len(others)} of {len(values)} {which}"
        subject = f"{key}, at {count} of {varied.key}"
        if key.startswith(varied.key):
            subject = f"{key}, {count}"
        if others:
            subject += ", the first"
        messages.append(f"{subject}: {text}")
    return messages


def _unusual_at(
    scene: Scene, varied: Quantity, value: object, known_paths: set[Any]
) -> Iterator[tuple[str, str]]:
    """Yield each key that is unusual where the varied key has a value, and a text on it."""
    if varied.model:
        for at, text in _unusual_model(varied.model, value, Location({}, split_key(varied.key))):
            yield at.message(""), text
    elif varied.unit is not None or varied.whole:
        number: Any = varied.read(value)
        unit = None if varied.unit is None else unit_given(value, varied.unit)
        if text := unusual(varied.attribute, number, unit):
            yield varied.key, text
    changed = evolve(scene, {varied.key: value}, si=True)
    for at, text in (
        *_unusual_relations(changed, changed.tables, Location({})),
        *implausible_values(changed),
    ):
        if at.path not in known_paths or at.message("") == varied.key:
            yield at.message(""), text


# Values by their fields ----------------------------------------------------------------------------------------------


def _unusual_values(cls: Any, raw: object, where: Location) -> Iterator[tuple[Location, str]]:
    """Yield location and text for each value of a table that is outside the usual range of its field."""
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
        for inner, table, location in _tables(kinds[attribute.name], value, at):
            yield from _unusual_values(inner, table, location)
            for field in attrs.fields(inner):
                # values of a property over temperature have the usual range of the property
                if field.metadata.get("own_unit"):
                    yield from _unusual(attribute, table.get(field.name), location.at(field.name))
        yield from _unusual(attribute, value, at)


def _unusual_model(kind: str, raw: object, where: Location) -> Iterator[tuple[Location, str]]:
    """Yield location and text for each parameter of a model that is outside the usual range of its field."""
    if isinstance(raw, Mapping) and isinstance(name := raw.get("model"), str):
        try:
            cls = get_class(kind, name)
        except PluginError:  # the constructor of the model reports it
            return
        if attrs.has(cls):
            yield from _unusual_values(cls, raw, where)


def _tables(
    kind: Any, raw: object, where: Location
) -> Iterator[tuple[Any, Mapping[str, object], Location]]:
    """Yield the attrs classes that a value is read as, its tables and their locations."""
    for cls in get_args(kind) if get_origin(kind) in (Union, UnionType, tuple) else (kind,):
        if not attrs.has(cls):
            continue
        if isinstance(raw, Mapping):
            yield cls, raw, where
        elif isinstance(raw, list | tuple):
            for k, table in enumerate(raw):
                if isinstance(table, Mapping):
                    yield cls, table, where.at(k)


def _unusual(
    attribute: "attrs.Attribute[Any]", raw: object, where: Location
) -> Iterator[tuple[Location, str]]:
    """Yield location and text for a number, or each of a list, that is outside the usual range of its field."""
    if isinstance(raw, list | tuple):
        for k, item in enumerate(raw):
            yield from _unusual(attribute, item, where.at(k))
        return
    if (
        isinstance(raw, bool)
        or not isinstance(raw, Real | str)
        or raw in attribute.metadata.get("keywords", ())
    ):
        return
    unit = attribute.metadata.get("unit")
    try:
        value = quantity(raw, unit or "1")
    except UnitError:  # a text in place of a table
        return
    if text := unusual(attribute, value, None if unit is None else unit_given(raw, unit)):
        yield where, text
