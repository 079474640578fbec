"""The oil of a scene held against the laws: what they take of it and it lacks, and what it has that none takes."""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Final

import attrs

from rollslip.catalogue.registry import available
from rollslip.errors import SceneError, nearest
from rollslip.fields import submodels
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import without_slope
from rollslip.models import SliceModel
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip_kernels.slices import CONDITIONS, Conditions

__all__ = ["check_given", "members", "unused_constants"]

#: What oils have of a member that one may lack, with grade.
_LIKELY: Final = {
    "pressure_viscosity": "'18 1/GPa' (mineral oils at 40 degC have 16 to 22 (B), esters 9 to 14 (C))",
    "conductivity": "'0.14 W/(m K)' (oils have 0.13 to 0.15 (C))",
    "eyring_stress": "'5 MPa' (mineral oils have 3 to 8 MPa, esters 2 to 6 MPa (C))",
    "shear_modulus": "'0.3 GPa' (published values go from 0.05 to 1 GPa (C))",
}


def unused_constants(scene: Scene, models: Mapping[str, Any], where: Location) -> list[str]:
    """Say which constants that a scene has of its oil are of no law of a contact, or of none of the scene's laws."""
    tables = scene.lubricant.data.get("models")
    if not isinstance(tables, Mapping):
        return []
    known = {name for kind in models for name in available(kind)}
    laws = [
        law
        for model in models.values()
        if model is not None
        for law in (model, *(child for _, child in submodels(model)))
    ]
    has = {name for law in laws for name in attrs.fields_dict(type(law))}
    said = list[str]()
    for name, value in tables.items():
        if isinstance(value, Mapping) and name not in known:
            near = (
                f"; did you mean {' or '.join(found)}?" if (found := nearest(name, known)) else ""
            )
            said.append(where.at(name).message(f"no law of a contact is called so{near}"))
        elif not isinstance(value, Mapping) and name not in has and None not in models.values():
            used = ", ".join(law.name for law in laws)
            said.append(
                where.at(name).message(f"no law of this scene has such a parameter: {used}")
            )
    return said


@lru_cache(maxsize=64)
def members(reads: tuple[frozenset[str], ...]) -> frozenset[str]:
    """Conditions among what models read."""
    return frozenset().union(*reads) & CONDITIONS.keys()


def check_given(
    models: tuple[SliceModel, ...], conditions: Conditions, lubricant: Lubricant, where: Location
) -> None:
    """Refuse models that read what the scene does not give."""
    reads = tuple(frozenset(model.reads) for model in models)
    if not any(lubricant.slopes.values()) and not any(
        math.isnan(getattr(conditions, name)) for name in members(reads)
    ):
        return
    problems = [
        where.at("lubricant").message(
            f"oil {lubricant.name!r} gives no {member} ({CONDITIONS[member][1]}, {CONDITIONS[member][0]}), "
            f"which model {model.name!r} needs; {_given_by(member, conditions, lubricant)} or choose another model"
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
    if problems:
        raise SceneError(problems)


def _given_by(member: str, conditions: Conditions, lubricant: Lubricant) -> str:
    """What to type to have a member of the oil; a law that fixes what pressure does to viscosity lets none be given."""
    law = lubricant.pressure_viscosity_law
    if member.startswith("pressure_") and not math.isnan(law.coefficient(conditions.temperature)):
        return f"{law.name!r} lets none be given: take another lubricant.pressure_viscosity_law"
    likely = f" = {_LIKELY[member]}" if member in _LIKELY else ""
    return f"give lubricant.{member}{likely},"
