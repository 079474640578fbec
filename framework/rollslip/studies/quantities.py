"""Values of a scene that can be varied: by dotted key, each with unit, meaning and present value.

They are the fields of the assembled bearing, and so include defaults, the parameters of the chosen models and those of
models within them. Lists and tables are not included, since each is several values; of a list of models, such as the
drags of a cage, the parameters of each are.
"""

import contextlib
import types
from collections.abc import Iterator, Mapping
from typing import Any, Union, get_args, get_origin, get_type_hints

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import oil_supply
from rollslip.catalogue.registry import structure_model
from rollslip.errors import RollslipError
from rollslip.lubricant.table import OilTable
from rollslip.scene.changes import KnownQuantities, Quantity
from rollslip.scene.supply import Lubrication
from rollslip.scene.values import LubricantTable, ModelChoice, Scene, Separator, model_kind
from rollslip.structure import Location, fields_of
from rollslip.units import UnitError, quantity

__all__ = ["quantities"]


def quantities(assembly: Assembly, studies: Mapping[str, attrs.AttrsInstance]) -> KnownQuantities:
    """Return the values of a scene that can be varied, by key.

    Parameters
    ----------
    assembly : Assembly
        The bearing of the scene.
    studies : mapping of str to attrs instance
        Studies by name, whose parameters are included.
    """
    scene = assembly.scene
    found = [*_bearing_name(scene)]
    for table in _tables(scene):
        found += _values_of(getattr(scene, table), table)
    # defaults that follow from the kind of supply
    supply = oil_supply(scene, assembly.lubricant)._asdict()
    unstated = {
        a.name for a in attrs.fields(Lubrication) if getattr(scene.lubrication, a.name) is None
    }
    defaults: dict[str, Any] = {name: supply[name] for name in unstated & supply.keys()}
    found += _values_of(attrs.evolve(scene.lubrication, **defaults), "lubrication")
    found += _oil_values(assembly)
    for attribute in attrs.fields(type(scene.models)):
        found += _model_values(assembly, attribute)
    with contextlib.suppress(RollslipError):  # the study that needs a cage reports it
        found += _values_of(assembly.cage, "cage")
        for drag in assembly.cage.drags:
            found += _values_of(drag, f"cage.drag.{drag.name}")
    for name, study in studies.items():
        found += _values_of(study, f"study.{name}")
    return KnownQuantities({quantity.key: quantity for quantity in found})


def _model_values(assembly: Assembly, attribute: "attrs.Attribute[Any]") -> Iterator[Quantity]:
    """Yield the choice of a model in the table ``models``, and its parameters."""
    scene = assembly.scene
    key = f"models.{attribute.name}"
    choice = getattr(scene.models, attribute.name)
    kind = model_kind(attribute.name)
    if kind == "rib":
        if assembly.rib is not None:  # without axial load nothing reads it
            yield _choice(key, attribute, assembly.rib.name, kind)
            yield from _values_of(assembly.rib, key)
    elif isinstance(choice, ModelChoice) and kind != attribute.name:
        yield _choice(key, attribute, choice.name, kind)
        yield from _values_of(_structured(kind, choice), key)
    elif isinstance(choice, ModelChoice):
        yield _choice(key, attribute, choice.name, kind)
        yield from _values_of(assembly.models.get(kind) or _thermal(scene), key)
    elif isinstance(choice, str):
        yield _choice(key, attribute, choice, "")
    elif isinstance(choice, Separator):
        yield _choice(key, attribute, choice.name, "")
        yield from _single_value(
            f"{key}.coefficient",
            float,
            attrs.fields(Separator).coefficient,
            scene.models.neighbour_friction,
        )
    elif isinstance(choice, tuple):  # each of several models has its name in the key
        for model in choice:
            yield from _values_of(_structured(attribute.name, model), f"{key}.{model.name}")


def _structured(kind: str, choice: ModelChoice) -> Any:
    """Return the model that a scene chooses, None if it is wrong."""
    return structure_model(kind, {"model": choice.name, **choice.parameters}, Location({}), [])


def _bearing_name(scene: Scene) -> Iterator[Quantity]:
    """Yield the name of the bearing, if the scene has one: it determines the cage and all that is not stated."""
    table = None if scene.raw is None else scene.raw.get("bearing")
    if isinstance(table, Mapping) and isinstance(name := table.get("name"), str):
        yield Quantity(
            "bearing.name",
            None,
            "name of a bearing that a plugin ships",
            name,
            False,
            attrs.fields_dict(LubricantTable)["name"],
        )


def _tables(scene: Scene) -> list[str]:
    """Return the tables of a scene that contain values; those of oil and models contain names."""
    tables = [a.name for a in attrs.fields(Scene) if attrs.has(type(getattr(scene, a.name)))]
    return [
        name for name in tables if name not in ("lubricant", "lubrication", "models", "plugins")
    ]


def _thermal(scene: Scene) -> Any:
    """Return the thermal model of a scene."""
    from rollslip.studies.thermal_balance.model import thermal_model  # slow to import

    return thermal_model(scene)


def _values_of(instance: Any, prefix: str) -> Iterator[Quantity]:
    """Yield the values of an attrs instance, and of instances within it."""
    kinds = get_type_hints(type(instance))
    for name, attribute in fields_of(type(instance)):
        if attribute.metadata.get("rest"):
            continue
        key = f"{prefix}.{name}"
        value = getattr(instance, attribute.name)
        if model := attribute.metadata.get("kind"):
            yield _choice(key, attribute, value.name, model)
            yield from _values_of(value, key)
        elif attrs.has(type(value)):
            yield from _values_of(value, key)
        else:
            yield from _single_value(key, kinds.get(attribute.name), attribute, value)


def _oil_values(assembly: Assembly) -> Iterator[Quantity]:
    """Yield the values of the oil: those of the scene, else those of the shipped oil that are single numbers."""
    kinds = get_type_hints(OilTable)
    given = dict(assembly.scene.lubricant.data)
    for attribute in attrs.fields(OilTable):
        name = attribute.name
        unit = attribute.metadata.get("unit")
        value: Any = assembly.scene.lubricant.name if name == "name" else given.get(name)
        if unit is not None:
            if value is None:
                value = getattr(assembly.lubricant, name, None)
            try:
                value = None if value is None else quantity(value, unit)
            except UnitError:  # a function of temperature
                value = None
        if kind := attribute.metadata.get("kind"):
            law = assembly.lubricant.pressure_viscosity_law
            yield _choice(f"lubricant.{name}", attribute, law.name, kind)
            yield from _values_of(law, f"lubricant.{name}")
        else:
            yield from _single_value(f"lubricant.{name}", kinds[name], attribute, value)


def _single_value(
    key: str, kind: Any, attribute: "attrs.Attribute[Any]", value: object
) -> Iterator[Quantity]:
    """Yield a value if its type is a number, text or switch."""
    if get_origin(kind) in (Union, types.UnionType):
        kind = next((member for member in get_args(kind) if member is not types.NoneType), kind)
    if kind in (float, int, str, bool) or (kind is Any and not isinstance(value, tuple)):
        unit = (attribute.metadata.get("unit") or "1") if kind is float else None
        yield Quantity(key, unit, attribute.metadata.get("doc", ""), value, kind is int, attribute)


def _choice(key: str, attribute: "attrs.Attribute[Any]", value: object, kind: str) -> Quantity:
    """Return the choice of a model of a kind."""
    return Quantity(key, None, attribute.metadata.get("doc", ""), value, False, attribute, kind)
