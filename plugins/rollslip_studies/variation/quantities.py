"""The values of a scene that can be varied: by dotted key, each with unit, meaning and what it is now.

They are taken from the fields of the bound bearing, so that defaults, the parameters of the models chosen and those of
the models in them are among them. Lists and tables are not: they are no single value; of a list of models, such as the
drags of a cage, the parameters of each are.
"""

import contextlib
import types
from collections.abc import Iterator, Mapping
from typing import Any, Union, get_args, get_origin, get_type_hints

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import supplied
from rollslip.catalogue.registry import structure_model
from rollslip.errors import RollslipError
from rollslip.lubricant.table import OilTable
from rollslip.scene.changes import Known, Quantity
from rollslip.scene.values import LubricantTable, ModelChoice, Scene, Separator, model_kind
from rollslip.structure import Location, fields_of
from rollslip.units import UnitError, quantity

__all__ = ["quantities"]


def quantities(assembly: Assembly, studies: Mapping[str, attrs.AttrsInstance]) -> Known:
    """Return what can be varied of a scene, by key."""
    scene = assembly.scene
    found = [
        *_named(scene),
        *(one for table in _tables(scene) for one in _of(getattr(scene, table), table)),
    ]
    found += _of_supply(assembly)
    found += _of_oil(assembly)
    for attribute in attrs.fields(type(scene.models)):
        kind = attribute.name
        choice = getattr(scene.models, attribute.name)
        if isinstance(choice, ModelChoice) and (of := model_kind(kind)) != kind:
            found.append(_choice(f"models.{kind}", attribute, choice.name, of))
            made = structure_model(
                of, {"model": choice.name, **choice.parameters}, Location({}), []
            )
            found += _of(made, f"models.{kind}")
        elif isinstance(choice, ModelChoice):
            found.append(_choice(f"models.{kind}", attribute, choice.name, kind))
            found += _of(assembly.models.get(kind) or _thermal(scene), f"models.{kind}")
        elif isinstance(choice, Separator):
            key = f"models.{kind}.coefficient"
            field = attrs.fields(Separator).coefficient
            found.append(_choice(f"models.{kind}", attribute, choice.name, ""))
            found += _single(key, float, field, scene.models.neighbour_friction)
        elif isinstance(choice, tuple):  # of several each is told by its name
            for one in choice:
                made = structure_model(
                    kind, {"model": one.name, **one.parameters}, Location({}), []
                )
                found += _of(made, f"models.{kind}.{one.name}")
    with contextlib.suppress(RollslipError):  # the study that needs a cage says so
        found += _of(assembly.cage, "cage")
        for drag in assembly.cage.drags:
            found += _of(drag, f"cage.drag.{drag.name}")
    for name, study in studies.items():
        found += _of(study, f"study.{name}")
    return Known({one.key: one for one in found})


def _named(scene: Scene) -> Iterator[Quantity]:
    """Name of the bearing, where the scene starts from one: its cage and all that is not stated follow."""
    table = None if scene.raw is None else scene.raw.get("bearing")
    if isinstance(table, Mapping) and isinstance(name := table.get("name"), str):
        attribute = attrs.fields_dict(LubricantTable)["name"]
        yield Quantity(
            "bearing.name", None, "name of a bearing that a plugin ships", name, False, attribute
        )


def _tables(scene: Scene) -> list[str]:
    """Tables of a scene that are values themselves; oil and models name what has them."""
    tables = [a.name for a in attrs.fields(Scene) if attrs.has(type(getattr(scene, a.name)))]
    return [
        name for name in tables if name not in ("lubricant", "lubrication", "models", "plugins")
    ]


def _thermal(scene: Scene) -> Any:
    from rollslip.studies.thermal_balance.model import thermal_model  # nobody else needs it

    return thermal_model(scene)


def _of(instance: Any, prefix: str) -> Iterator[Quantity]:
    """Values of an attrs instance and of those in it."""
    kinds = get_type_hints(type(instance))
    for name, attribute in fields_of(type(instance)):
        if attribute.metadata.get("rest"):
            continue
        key = f"{prefix}.{name}"
        value = getattr(instance, attribute.name)
        if model := attribute.metadata.get("kind"):
            yield _choice(key, attribute, value.name, model)
            yield from _of(value, key)
        elif attrs.has(type(value)):
            yield from _of(value, key)
        else:
            yield from _single(key, kinds.get(attribute.name), attribute, value)


def _of_supply(assembly: Assembly) -> Iterator[Quantity]:
    """What follows from the kind of supply, in place of what the scene leaves open."""
    scene = assembly.scene
    known = supplied(scene, assembly.lubricant).starvation_constant
    yield from _of(attrs.evolve(scene.lubrication, starvation_constant=known), "lubrication")


def _of_oil(assembly: Assembly) -> Iterator[Quantity]:
    """Values of the oil: as the scene gives them, else those of the shipped oil that are single numbers."""
    kinds = get_type_hints(OilTable)
    written = dict(assembly.scene.lubricant.data)
    for attribute in attrs.fields(OilTable):
        name = attribute.name
        unit = attribute.metadata.get("unit")
        value: Any = assembly.scene.lubricant.name if name == "name" else written.get(name)
        if unit is not None:
            value = getattr(assembly.lubricant, name, None) if value is None else value
            try:
                value = None if value is None else quantity(value, unit)
            except UnitError:  # a law over temperature
                value = None
        if kind := attribute.metadata.get("kind"):
            law = assembly.lubricant.pressure_viscosity_law
            yield _choice(f"lubricant.{name}", attribute, law.name, kind)
            yield from _of(law, f"lubricant.{name}")
        else:
            yield from _single(f"lubricant.{name}", kinds[name], attribute, value)


def _single(
    key: str, kind: Any, attribute: "attrs.Attribute[Any]", value: object
) -> Iterator[Quantity]:
    if get_origin(kind) in (Union, types.UnionType):
        kind = next((one for one in get_args(kind) if one is not types.NoneType), kind)
    if kind in (float, int, str, bool) or (kind is Any and not isinstance(value, tuple)):
        unit = attribute.metadata.get("unit") or "1" if kind is float else None
        yield Quantity(key, unit, attribute.metadata.get("doc", ""), value, kind is int, attribute)


def _choice(key: str, attribute: "attrs.Attribute[Any]", value: object, kind: str) -> Quantity:
    return Quantity(key, None, attribute.metadata.get("doc", ""), value, False, attribute, kind)
