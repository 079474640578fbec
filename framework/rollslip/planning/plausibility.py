"""What is unusual in a scene, of all that it holds: its own tables, the oil, the cage, models and studies.

Where a key takes many values, as in a sweep, that is said once for all of them.
"""

import contextlib
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rollslip.bearing.cage import Cage, doubts
from rollslip.catalogue.registry import structure_model
from rollslip.errors import RollslipError
from rollslip.fields import unusual
from rollslip.lubricant.base_oil import HIGHEST_INDEX, LOWEST_INDEX
from rollslip.lubricant.table import OilTable, index_of
from rollslip.scene.changes import Quantity, evolve
from rollslip.scene.clearance import unused
from rollslip.scene.plausibility import unusual_model, unusual_relations, unusual_values
from rollslip.scene.rings import rings_of, yielding
from rollslip.scene.values import Scene, model_kind
from rollslip.structure import Location, resolved
from rollslip.studies.study import study_class
from rollslip.toml import parse, split_key
from rollslip.units import as_written, unit_given

__all__ = ["implausible", "implausible_along"]


def implausible(scene: Scene, moved: Collection[str] = ()) -> list[str]:
    """Return what is unusual in a scene, with place, value and what was likely meant; most scenes have nothing.

    What stands at keys that are ``moved`` is left to `implausible_along`.
    """
    raw: Mapping[str, Any] = scene.raw if scene.raw is not None else resolved(scene)
    where = Location(scene.origins)
    found = [*unusual_values(Scene, raw, where)]
    found += unusual_values(OilTable, raw.get("lubricant"), where.at("lubricant"))
    found += _oil(scene, raw, where.at("lubricant"))
    found += unusual_values(Cage, raw.get("cage"), where.at("cage"))
    found += _models(raw, where)
    studies = raw.get("study")
    for name, table in studies.items() if isinstance(studies, Mapping) else ():
        with contextlib.suppress(RollslipError):  # who runs it says so
            found += unusual_values(study_class(name, scene), table, where.at("study").at(name))
    found += unusual_relations(scene, raw, where)
    told = {at.path for at, _ in found}
    if not any(path[0] == "bearing" for path in told):  # of a bearing in doubt none of a cage is
        found += [(at, text) for at, text in doubts(scene) if at.path not in told]
    found += _clearance(scene, raw, where.at("bearing"))
    return [*dict.fromkeys(at.says(told) for at, told in found if ".".join(map(str, at.path)) not in moved)]


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
    kept = [f"{key} = {value}" for key, value in own.items() if key in now and now[key] == before[key]]
    left = [f"{key} = {value}" for key, value in own.items() if key not in now]
    name = now["name"]
    if kept:
        yield where, f"{name!r} keeps what the scene states: {', '.join(kept)}; lubricant={name} alone leaves it out"
    if left:
        yield where, f"{name!r} leaves out what the scene states: {', '.join(left)}; lubricant.name={name} keeps it"


def _clearance(scene: Scene, raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    """Yield what is stated beside a clearance in operation and not used, and that seats leave a preload."""
    for key in unused(raw.get("bearing", {})):
        yield where.at(key), "is not used: bearing.radial_clearance is stated, that in operation"
    b, mounted = scene.bearing, scene.bearing.mounted
    at, uniform = where.at("mounting" if mounted else "radial_clearance"), -b.radial_clearance
    rings = rings_of(
        scene, lambda choice, at: structure_model("ring", {"model": choice.name, **choice.parameters}, at, []), []
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
        formed = next(ring for ring in ("outer", "inner") if getattr(getattr(b, f"{ring}_raceway"), "form", ()))
        by_form = 2.0 * float(rings.form(np.linspace(0.0, 2.0 * np.pi, 721)).max()) + min(uniform, 0.0)
        lobes = max(rings.waves, key=lambda wave: wave[1], default=(2, 0.0, 0.0))[0]  # a table is taken for an oval
        if by_form > 0.0:
            at = at if parts else where.at(f"{formed}_raceway")
            parts.append((by_form, lobes, " by the form" if parts else ""))
    if not parts:
        return
    rigid = [ring for ring in ("outer", "inner") if ring not in stated]
    here = "rings are" if len(rigid) == 2 else f"the {rigid[0]} ring is"
    keys = " and ".join(f"models.{ring}_ring" for ring in rigid)
    how = f": {mounted}" if mounted and uniform > 0.0 else ""
    told, seated = "too large", " (with the housing and shaft of bearing.mounting, or thick ones)"
    with contextlib.suppress(RollslipError):
        shares = []
        for preload, lobes, what in parts:
            bare, held = (100 * one.share(lobes) for one in yielding(b, lobes=lobes, stated=stated))
            shares.append(f"of {preload * 1e6:.3g} um{what} about {bare:.0f} % (bare rings) to {held:.0f} %{seated}")
            seated = ""
        told = f"too large: {' and '.join(shares)} reach the rollers"
    yield (
        at,
        f"the bearing runs preloaded{how}; {here} rigid here, so that forces of rollers are {told}; give {keys}, or "
        "take a looser fit or class",
    )


def _models(raw: Mapping[str, Any], where: Location) -> Iterator[tuple[Location, str]]:
    models, cage = raw.get("models"), raw.get("cage")
    for kind, model in models.items() if isinstance(models, Mapping) else ():
        yield from unusual_model(model_kind(kind), model, where.at("models").at(kind))
    drags = cage.get("drag", ()) if isinstance(cage, Mapping) else ()
    for k, drag in enumerate(drags if isinstance(drags, list | tuple) else ()):
        yield from unusual_model("drag", drag, where.at("cage").at("drag").at(k))


def implausible_along(scene: Scene, of: Quantity, values: Sequence[object], which: str = "values") -> list[str]:
    """Return what is unusual of values that a key of a scene takes, each kind once, with the first value that is.

    What is unusual in the scene by itself is left to `implausible`.
    """
    told_by_itself = {at.path for at, _ in (*unusual_relations(scene, resolved(scene), Location({})), *doubts(scene))}
    first, counts = dict[str, str](), dict[str, int]()
    for value in values:
        for key, told in _unusual_at(scene, of, value, told_by_itself):
            first.setdefault(key, told)
            counts[key] = counts.get(key, 0) + 1
    found = []
    for key, told in first.items():
        among = f"{counts[key]} of {len(values)} {which}"
        at = f"{key}, {among}" if key.startswith(of.key) else f"{key}, at {among} of {of.key}"
        found.append(f"{at}{', the first' if counts[key] > 1 else ''}: {told}" if len(values) > 1 else f"{key}: {told}")
    return found


def _unusual_at(scene: Scene, of: Quantity, value: object, told_by_itself: set[Any]) -> Iterator[tuple[str, str]]:
    """Yield each key that is unusual where a key takes a value, and what is."""
    if of.model:
        for at, told in unusual_model(of.model, value, Location({}, split_key(of.key))):
            yield at.says(""), told
    elif of.unit is not None or of.whole:
        number: Any = of.read(value)
        if told := unusual(of.attribute, number, None if of.unit is None else unit_given(value, of.unit)):
            yield of.key, told
    changed = evolve(scene, {of.key: value})
    raw = resolved(changed) if changed.raw is None else changed.raw
    for at, told in (*unusual_relations(changed, raw, Location({})), *doubts(changed)):
        if at.path not in told_by_itself or at.says("") == of.key:
            yield at.says(""), told
