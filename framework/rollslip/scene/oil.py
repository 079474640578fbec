"""Compare the oil of a scene with the laws: properties that laws read and it lacks, and constants that no law reads."""

import math
from collections.abc import Collection, Mapping, Set
from functools import lru_cache
from typing import Any, Final

import attrs

from rollslip.catalogue.registry import available, get_class
from rollslip.errors import did_you_mean, nearest
from rollslip.fields import submodels
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import without_slope
from rollslip.lubricant.table import OilTable
from rollslip.models import SliceModel
from rollslip.scene.values import Scene
from rollslip.structure import Location, raise_problems, structure
from rollslip_kernels.slices import CONDITIONS, Conditions

__all__ = ["check_given", "faulty_constants", "members", "unused_constants"]

#: Kinds of the laws of a contact, for which an oil has constants.
CONTACT_KINDS: Final = ("contact", "film", "pressure", "traction")
#: Typical values of properties that an oil may lack, with their grades, as proposals in messages.
_TYPICAL: Final = {
    "pressure_viscosity": "'18 1/GPa' (mineral oils at 40 degC have 16 to 22 (B), esters 9 to 14 (C))",
    "conductivity": "'0.14 W/(m K)' (oils have 0.13 to 0.15 (C))",
    "eyring_stress": "'5 MPa' (mineral oils have 3 to 8 MPa, esters 2 to 6 MPa (C))",
    "shear_modulus": "'0.3 GPa' (published values go from 0.05 to 1 GPa (C))",
}


def unused_constants(scene: Scene, models: Mapping[str, Any], where: Location) -> list[str]:
    """Return messages on constants in ``[lubricant.models]`` that no law reads.

    Parameters
    ----------
    scene : Scene
        The scene.
    models : mapping
        Models of the contacts by kind; None where one could not be constructed.
    where : Location
        Location of the table, for messages.
    """
    tables = scene.lubricant.data.get("models")
    if not isinstance(tables, Mapping):
        return []
    known = {name for kind in models for name in available(kind)}
    laws = _all_laws(models)
    parameters = {name for law in laws for name in attrs.fields_dict(type(law))}
    messages = list[str]()
    for name, value in tables.items():
        if not isinstance(value, Mapping):
            if name not in parameters and None not in models.values():
                used = ", ".join(law.name for law in laws)
                messages.append(
                    where.at(name).message(f"no law of this scene has such a parameter: {used}")
                )
        elif name not in known:
            unknown = f"no law of a contact is called so{_hint(name, known)}"
            messages.append(where.at(name).message(unknown))
    return messages


def faulty_constants(oil: Lubricant) -> list[str]:
    """Return messages on constants of an oil that no installed law of a contact has, or that their law refuses.

    The quantities whose scatter the oil states are among them.

    Parameters
    ----------
    oil : Lubricant
        The oil.
    """
    classes = {name: get_class(kind, name) for kind in CONTACT_KINDS for name in available(kind)}
    laws: dict[str, Set[str]] = {
        name: attrs.fields_dict(cls).keys() for name, cls in classes.items()
    }
    every = set[str]().union(*laws.values())
    tables = {law: table for law, table in oil.models.items() if isinstance(table, Mapping)}
    choices: dict[str, Collection[str]] = {
        key: laws if key in tables else every for key in oil.models
    }
    choices |= {
        f"{law}.{key}": laws.get(law, table) for law, table in tables.items() for key in table
    }
    unknown = [
        f"{key} is of no law that is installed" + _hint(name, choices[key])
        for key in choices
        if (name := key.rpartition(".")[2]) not in choices[key]
    ]
    problems = _unknown_scatter(oil, {"": attrs.fields_dict(OilTable).keys(), **laws})
    for name, cls in classes.items():
        constants = oil.constants_for(name, laws[name])
        if constants and constants.keys() <= laws[name]:
            structure(cls, constants, Location({}, (name,)), problems)
    refused = [text for text in problems if ": missing, but required" not in text]
    return unknown + refused


def _hint(name: str, known: Collection[str]) -> str:
    """Return the clause with the known names that are similar to a name; empty without one."""
    similar = did_you_mean(nearest(name, known), "")
    return similar and f"; {similar}"


def _unknown_scatter(oil: Lubricant, known: Mapping[str, Collection[str]]) -> list[str]:
    """Return messages on scatter of what no oil and no law has, by names of data and of parameters of each law."""
    quantities = [scatter.quantity for scatter in oil.scatter]
    parts = [quantity.rpartition(".") for quantity in quantities]
    other = available("pressure-viscosity")
    return [
        f"scatter of {quantity}, which no oil and no law that is installed has"
        for quantity, (law, _, name) in zip(quantities, parts, strict=True)
        if law not in other and name not in known.get(law, ())
    ]


def _all_laws(models: Mapping[str, Any]) -> list[Any]:
    """Return models, without None, each followed by its submodels."""
    return [
        law
        for model in models.values()
        if model is not None
        for law in (model, *(child for _, child in submodels(model)))
    ]


@lru_cache(maxsize=64)
def members(reads: tuple[frozenset[str], ...]) -> frozenset[str]:
    """Return the names of the conditions among the members that models read."""
    return frozenset().union(*reads) & CONDITIONS.keys()


def check_given(
    models: tuple[SliceModel, ...], conditions: Conditions, lubricant: Lubricant, where: Location
) -> None:
    """Raise `SceneError` where models read properties of the oil that the scene does not give.

    Parameters
    ----------
    models : tuple of SliceModel
        The models of the contacts.
    conditions : Conditions
        Conditions of the contacts; a property that the oil lacks is NaN.
    lubricant : Lubricant
        The oil.
    where : Location
        Location of the scene, for messages.
    """
    reads = tuple(frozenset(model.reads) for model in models)
    if not any(lubricant.slopes.values()) and not any(
        math.isnan(getattr(conditions, name)) for name in members(reads)
    ):
        return
    problems = [
        where.at("lubricant").message(
            f"oil {lubricant.name!r} gives no {member} ({CONDITIONS[member][1]}, {CONDITIONS[member][0]}), "
            f"which model {model.name!r} needs; {_remedy(member, conditions, lubricant)} or choose another model"
        )
        for model in models
        for member in sorted(model.reads & CONDITIONS.keys())
        if math.isnan(getattr(conditions, member))
    ]
    problems += [
        where.at("lubricant")
        .at(slope)
        .message(
            f"model {name!r} takes one {slope.removesuffix('_slope')} at all pressures; leave the slope out, or choose "
            "another traction model: laws of Eyring fluids at the mean pressure of a slice follow it"
        )
        for slope, value in lubricant.slopes.items()
        if value
        for model in models
        for name in without_slope(model, slope.removesuffix("_slope"))
    ]
    raise_problems(problems)


def _remedy(member: str, conditions: Conditions, lubricant: Lubricant) -> str:
    """Return what to type so that the oil has a property; some laws of viscosity under pressure take no coefficient."""
    law = lubricant.pressure_viscosity_law
    if member.startswith("pressure_") and not math.isnan(law.coefficient(conditions.temperature)):
        return f"{law.name!r} accepts none: take another lubricant.pressure_viscosity_law"
    typical = f" = {_TYPICAL[member]}" if member in _TYPICAL else ""
    return f"give lubricant.{member}{typical},"
