"""The lines of a plan, one for each part of the bearing and its studies, and the sentences before a run."""

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import describe_cage, read_cage
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.registry import find
from rollslip.models import FilmModel, PressureModel, SliceModel
from rollslip.results.curves import or_none
from rollslip.results.text import LOWER_BOUNDS, SWITCHED_OFF, duration_range
from rollslip.scene.supply import PLENTY
from rollslip.scene.values import EXACT, Scene
from rollslip.studies.answers import Part
from rollslip.studies.parts import rings
from rollslip.studies.study import Study
from rollslip.units import GRAVITY, format_quantity

__all__ = [
    "LONG_RUN",
    "bearing_parts",
    "check_parts",
    "cost_sentences",
    "describe_own_cage",
    "describe_resolution",
    "format_time",
    "part_as_dict",
    "study_parts",
    "uses_cage",
]  # fmt: skip

#: Estimated time of a run from which a sentence says so before the run [s]. Chosen: people wait for a minute.
LONG_RUN: Final = 60.0
#: Lower bound on the time of a slice, all stages compiled [s]; measured, an estimate below it is not believed.
_SLICE_TIME: Final = 2e-8
#: Time of the error estimate and the check of validity at least [s], measured by docs/scripts/plan_times.py.
_CHECK_TIME: Final = 0.01
#: Time of both, relative to that of the study; measured likewise. Doubled, plans state a third more for a study and its
#: check.
_CHECK_FRACTION: Final = 0.5


def part_as_dict(part: Part) -> dict[str, Any]:
    """Return a line of a plan as plain values, for JSON; an error that cannot be determined is null."""
    errors = {name: or_none(error) for name, error in part.errors.items()}
    return attrs.asdict(part) | {"errors": errors}


def bearing_parts(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Return the lines of models, oil, clearance, rings and body forces of the rollers.

    Parameters
    ----------
    assembly : Assembly
        The bearing as the scene states it.
    studies : mapping of str to Study
        Studies by name.
    """
    scene = assembly.scene
    law = assembly.lubricant.pressure_viscosity_law
    named = dict(scene.raw or {}).get("models", {})
    parts = [
        *(_stage(kind, model, named) for kind, model in assembly.models.items()),
        Part(
            part="viscosity at pressure",
            choice=law.name,
            resolution="every loaded slice",
            reason="; ".join(
                filter(None, (f"the law of the oil, {assembly.lubricant.name}", law.caution()))
            ),
        ),
        _inlet(assembly.film),
    ]
    if (mounted := scene.bearing.mounted) is not None:
        parts.append(
            Part(
                part="clearance",
                choice=format_quantity(mounted.clearance, "m", 3),
                resolution="in operation",
                reason=str(mounted),
            )
        )
    parts.append(rings(assembly))
    return parts + _body_forces(assembly, all(study.with_weight for study in studies.values()))


def study_parts(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Return the lines of cage, heat and damage, which depend on the studies.

    Parameters
    ----------
    assembly : Assembly
        The bearing as the scene states it.
    studies : mapping of str to Study
        Studies by name.
    """
    parts = [*_cage(assembly, studies), *_heat(assembly.scene, studies)]
    if not any(study.with_damage for study in studies.values()):
        # a study that measures damage has its own lines
        parts += [
            Part(
                part="damage",
                included=False,
                choice=model.name,
                reason="no study of this run measures damage",
            )
            for model in assembly.scene.models.damage
        ]
    return parts


def format_time(
    seconds: float, studies: Iterable[Study], assembly: Assembly, purpose: str = ""
) -> str:
    """Return the time of studies as text, with a note where one of them may run again.

    Parameters
    ----------
    seconds : float
        Estimated time [s].
    studies : iterable of Study
        The studies.
    assembly : Assembly
        The bearing as the scene states it.
    purpose : str, optional
        What the time is for, which follows it.
    """
    text = duration_range(seconds) + purpose
    if any(study.may_run_again(assembly) for study in studies):
        text += ", longer if the check of a result requires more"
    return text


def describe_resolution(resolution: Resolution) -> str:
    """Return the numbers of slices and roller positions of a resolution as text."""
    text = f"{resolution.slices} slices of a roller"
    if resolution.slices == 1:
        text = "1 slice of a roller"
    if (positions := resolution.n_positions or 1) > 1:
        text += f", {positions} roller positions within a pitch"
    return text


def check_parts(study: Study, assembly: Assembly, costs: Mapping[str, float]) -> list[Part]:
    """Return the line on the check of a result, if its error is estimated and the costs of the study are known.

    Parameters
    ----------
    study : Study
        The study with its settings.
    assembly : Assembly
        The bearing at the resolution of the study.
    costs : mapping of str to float
        Part -> estimated time [s].
    """
    if not costs or not study.has_error_estimate(assembly):
        return []
    fraction = 0.0
    if study.curve_study(assembly) in (None, study):
        fraction = _CHECK_FRACTION  # else curves estimate the error, which take no part of the time of the motion
    again = ""
    if study.may_run_again(assembly):
        again = "; beyond its tolerance it runs again, which takes longer"
    return [
        Part(
            part="check of the result",
            choice="more slices and positions, range of validity",
            reason=f"tells how far the result is off{again}",
            seconds=_CHECK_TIME + fraction * sum(costs.values()),
        )
    ]


def describe_own_cage(scene: Scene, studies: Mapping[str, Study]) -> str:
    """Return the cage of a bearing as text, if the scene does not state it and a study uses it; else an empty text.

    Parameters
    ----------
    scene : Scene
        The scene.
    studies : mapping of str to Study
        Studies by name.
    """
    if not uses_cage(studies) or "mass" in (scene.cage or {}):
        return ""
    description = "; ".join(describe_cage(scene, read_cage(scene)))
    if scene.models.neighbour_friction is None:
        return f"the cage is the bearing's own, {description}"
    return f"cage: {description}"


def cost_sentences(
    assembly: Assembly, studies: Mapping[str, Study], seconds: float, evaluations: int
) -> list[str]:
    """Return the sentences to be printed before a plan is run.

    Parameters
    ----------
    assembly : Assembly
        The bearing as the scene states it.
    studies : mapping of str to Study
        Studies by name.
    seconds : float
        Estimated time [s].
    evaluations : int
        Estimated number of slices to be evaluated.
    """
    scene = assembly.scene
    notes = {"tolerance": '; nothing finer is computed than with accuracy.tolerance = "exact"'}
    sentences = [
        f"accuracy.{name} = {getattr(scene.accuracy, name):g} is less than the finest of everything leaves, about "
        f"{EXACT:g} to 1e-05{notes.get(name, '')}"
        for name in ("tolerance", "critical_slip", "friction", "cage_speed")
        if (getattr(scene.accuracy, name) or EXACT) < EXACT
    ]
    if cage := describe_own_cage(scene, studies):
        sentences.append(cage)
    if without_heat := _studies_without_heat(scene, studies):
        sentences.append(
            f"models.thermal does not act in {', '.join(without_heat)}: rings, rollers and oil "
            "have the temperatures that operation states"
        )
    seconds = max(seconds, _SLICE_TIME * evaluations)
    if seconds > LONG_RUN:
        sentences.append(
            f"this will take {format_time(seconds, studies.values(), assembly)}; Ctrl-C ends it, and rollslip plan "
            "says what the time goes to"
        )
    return sentences


def uses_cage(studies: Mapping[str, Study]) -> bool:
    """Whether a study computes anything about the cage."""
    return any(
        study.with_cage or getattr(study, "skidding_range", 0.0) for study in studies.values()
    )


def _cage(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Return the lines of cage and drags, if a study uses them."""
    if not any(study.with_cage for study in studies.values()):
        return [
            Part(
                part="cage, drag and integrators",
                included=False,
                choice="not loaded",
                reason="the scene has no study of cage and rollers in motion",
            )
        ]
    reason = f"default, of lubrication.supply = {assembly.scene.lubrication.supply!r}"
    if "drag" in (assembly.scene.cage or {}):
        reason = "cage.drag names it"
    choice, known = describe_cage(assembly.scene, assembly.cage)
    parts = [
        Part(part="cage", choice=choice, reason=known),
        *(
            Part(part="drag", choice=drag.name, resolution=drag.equation, reason=reason)
            for drag in assembly.cage.drags
        ),
    ]
    if assembly.cage.drags.bound_below:
        reason = LOWER_BOUNDS if len(parts) > 1 else SWITCHED_OFF
        parts.append(Part(part="rolling resistance", included=False, choice="none", reason=reason))
    return parts


def _heat(scene: Scene, studies: Mapping[str, Study]) -> list[Part]:
    """Return the line on the thermal model that a scene names, with the studies that do not use it."""
    if scene.models.thermal is None:
        return []
    reason = "the scene names it"
    if without_heat := _studies_without_heat(scene, studies):
        reason = f"not in {', '.join(without_heat)}, at the temperatures of the operation"
    return [
        Part(
            part="thermal",
            included=any(study.with_heat for study in studies.values()),
            choice=scene.models.thermal.name,
            reason=reason,
        )
    ]


def _studies_without_heat(scene: Scene, studies: Mapping[str, Study]) -> list[str]:
    """Return the studies that do not use the thermal model of a scene, if it has unknown temperatures."""
    if scene.models.thermal is None:
        return []
    from rollslip.studies.thermal_balance.model import (
        thermal_model,
    )  # imported here, since only scenes with a thermal model need it

    model = thermal_model(scene)
    if not (model and model.nodes):
        return []
    return [name for name, study in studies.items() if not study.with_heat]


def _stage(kind: str, model: SliceModel, named: Any) -> Part:
    """Return the line of a model of a contact."""
    offer = find(kind, model.name)
    compiled = "compiled" if model.kernel() is not None else "NumPy"
    if isinstance(model, PressureModel) and model.of_contact:
        compiled = "that of the contact model, no stage"
    return Part(
        part=kind,
        choice=f"{model.name} ({offer.package} {offer.version}, {compiled})",
        resolution="every loaded slice",
        reason="the scene names it" if kind in named else "default",
    )


def _body_forces(assembly: Assembly, has_weight: bool) -> list[Part]:
    """Return the line on the body force of the rollers: of a carrier, or weight that not all studies have."""
    o = assembly.scene.operation
    fraction = assembly.weight_fraction
    tolerance = assembly.scene.accuracy.tolerance
    direction = o.gravity_direction
    if (carrier := o.carrier) is not None:
        what = "carrier"
        direction = carrier.direction
        why = "the bearing turns about another axis; the cage's own weight there is its guide's, and left out"
    elif (fraction > tolerance and not has_weight) or direction is not None:
        weight = format_quantity(assembly.roller_mass * GRAVITY, "N", 2)
        what = "gravity of rollers"
        why = f"{weight} each, {100.0 * fraction:.2g} % of the mean contact force of a roller"
        if direction is None or fraction <= tolerance:
            less = (
                "below the tolerance"
                if fraction <= tolerance
                else "operation.gravity_direction would take it in"
            )
            return [
                Part(
                    part=what, choice=weight, resolution="", reason=f"{why}: {less}", included=False
                )
            ]
    else:
        return []
    force = format_quantity(math.hypot(*assembly.body_force), "N", 2)
    return [
        Part(
            part=what,
            choice=f"{force} on each roller, {math.degrees(direction):.3g} deg from the line of load",
            resolution="in the equilibrium",
            reason=why,
        )
    ]


def _inlet(film: FilmModel) -> Part:
    """Return the line on thermal inlet shear and the oil before the film."""
    choice = film.inlet_heating or "isothermal inlet"
    if film.oil_layer < PLENTY:
        choice += f", an oil layer of {format_quantity(film.oil_layer, 'm', 3)}"
    if not film.inlet_heating:
        reason = "the scene does not ask for it"
        return Part(part="thermal inlet shear", included=False, choice=choice, reason=reason)
    return Part(
        part="thermal inlet shear",
        choice=choice,
        resolution="every loaded slice",
        reason=f"film model {film.name!r} requires it",
    )
