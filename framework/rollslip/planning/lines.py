"""What a plan says: a line for each part of the bearing and its studies, and what somebody should know before a run."""

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.cage import describe_cage, read_cage
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.registry import find
from rollslip.models import FilmModel, PressureModel, SliceModel
from rollslip.results.words import LOWER_BOUNDS, SWITCHED_OFF, duration_range
from rollslip.scene.values import EXACT, Scene
from rollslip.studies.answers import Part
from rollslip.studies.parts import rings
from rollslip.studies.study import Study
from rollslip.units import GRAVITY, format_quantity

__all__ = [
    "LONG",
    "caged",
    "check",
    "cost_sentences",
    "format_time",
    "how_finely",
    "of_bearing",
    "of_studies",
    "own_cage",
    "part_as_dict",
]  # fmt: skip

#: Time that is told before it is spent [s].
LONG: Final = 60.0
#: Time of a slice at the least, all stages compiled [s].
_SLICE: Final = 2e-8
#: Time that it takes to see how far a result is off and to tell it, at the least [s] and relative to that of the study;
#: docs/scripts/plan_times.py.
_CHECK: Final = (0.03, 0.9)


def part_as_dict(part: Part) -> dict[str, Any]:
    """Return a line of a plan as plain values; an error that cannot be determined is null."""
    errors = {name: error if math.isfinite(error) else None for name, error in part.errors.items()}
    return attrs.asdict(part) | {"errors": errors}


def of_bearing(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Return the lines of models, oil, clearance, rings and what pulls at the rollers."""
    scene = assembly.scene
    law = assembly.lubricant.pressure_viscosity_law
    named = dict(scene.raw or {}).get("models", {})
    parts = [_stage(kind, model, named) for kind, model in assembly.models.items()]
    reasons = (f"the law of the oil, {assembly.lubricant.name}", law.caution())
    parts.append(
        Part(
            part="viscosity at pressure",
            choice=law.name,
            resolution="every loaded slice",
            reason="; ".join(filter(None, reasons)),
        )
    )
    parts.append(_inlet(assembly.film))
    if (mounted := scene.bearing.mounted) is not None:
        clearance = format_quantity(mounted.clearance, "m", 3)
        parts.append(
            Part(part="clearance", choice=clearance, resolution="in operation", reason=str(mounted))
        )
    weighed = all(study.with_weight for study in studies.values())
    return [*parts, rings(assembly), *_pulls(assembly, weighed)]


def of_studies(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Return the lines of cage, heat and damage, which hang on what is asked."""
    return [
        *_cage(assembly, studies),
        *_heat(assembly.scene, studies),
        *_damage(assembly.scene, studies),
    ]


def format_time(seconds: float, studies: Iterable[Study], assembly: Assembly) -> str:
    """Return how long studies take, and that it may be longer where one may run again."""
    again = any(study.may_run_again(assembly) for study in studies)
    return duration_range(seconds) + ", longer if the check of a result asks for more" * again


def how_finely(resolution: Resolution) -> str:
    """Return of how many slices and positions something is evaluated."""
    slices = resolution.slices
    positions = resolution.n_positions or 1
    fine = f"{slices} slice{'s' * (slices != 1)} of a roller"
    return fine + f", {positions} roller positions within a pitch" * (positions > 1)


def check(study: Study, assembly: Assembly, costs: Mapping[str, float]) -> list[Part]:
    """Return the line of what follows a study whose costs are known, nothing where it is not judged."""
    if not costs or not study.has_error_estimate(assembly):
        return []
    least, times = _CHECK
    own = study.curve_study(assembly) in (
        None,
        study,
    )  # else judged by curves that take nothing of the time in motion
    then = "; beyond its tolerance it runs again, which takes longer" * study.may_run_again(
        assembly
    )
    return [
        Part(
            part="check of the result",
            choice="more slices and positions, range of validity",
            reason=f"tells how far the result is off{then}",
            seconds=least + times * sum(costs.values()) * own,
        )
    ]


def own_cage(scene: Scene, studies: Mapping[str, Study]) -> str:
    """Return which cage a bearing has that the scene does not state; nothing where it does, or none takes part."""
    if not caged(studies) or "mass" in (scene.cage or {}):
        return ""
    cage = read_cage(scene)
    told = "; ".join(describe_cage(scene, cage))
    return (
        f"the cage is the bearing's own, {told}"
        if scene.models.neighbour_friction is None
        else f"cage: {told}"
    )


def cost_sentences(
    assembly: Assembly, studies: Mapping[str, Study], seconds: float, evaluations: int
) -> list[str]:
    """Return in words what somebody should know before a plan is run; empty if there is nothing."""
    scene = assembly.scene
    said = [
        f"accuracy.{name} = {value:g} is less than the finest of everything leaves, about {EXACT:g} to 1e-05"
        + '; nothing finer is computed than with accuracy.tolerance = "exact"'
        * (name == "tolerance")
        for name in ("tolerance", "critical_slip", "friction", "cage_speed")
        if (value := getattr(scene.accuracy, name)) is not None and value < EXACT
    ]
    if told := own_cage(scene, studies):
        said.append(told)
    if held := _held(scene, studies):
        said.append(
            f"models.thermal does not act in {', '.join(held)}: rings, rollers and oil "
            "have the temperatures that operation states"
        )
    seconds = max(seconds, _SLICE * evaluations)
    if seconds > LONG:
        said.append(
            f"this will take {format_time(seconds, studies.values(), assembly)}; {evaluations:.1e} slices to "
            "evaluate; Ctrl-C ends it, and rollslip plan says what the time goes to"
        )
    return said


def caged(studies: Mapping[str, Study]) -> bool:
    """Whether a study tells of the cage."""
    return any(
        study.with_cage or getattr(study, "skidding_range", 0.0) for study in studies.values()
    )


def _cage(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """The drags, where a study asks for the cage."""
    if not any(study.with_cage for study in studies.values()):
        reason = "the scene has no study of cage and rollers in motion"
        return [
            Part(
                part="cage, drag and integrators",
                included=False,
                choice="not loaded",
                reason=reason,
            )
        ]
    named = "drag" in (assembly.scene.cage or {})
    supply = assembly.scene.lubrication.supply
    reason = "cage.drag names it" if named else f"default, of lubrication.supply = {supply!r}"
    choice, known = describe_cage(assembly.scene, assembly.cage)
    parts = [
        Part(part="cage", choice=choice, reason=known),
        *(
            Part(part="drag", choice=one.name, resolution=one.equation, reason=reason)
            for one in assembly.cage.drags
        ),
    ]
    if assembly.cage.drags.bound_below:
        reason = LOWER_BOUNDS if len(parts) > 1 else SWITCHED_OFF
        parts.append(Part(part="rolling resistance", included=False, choice="none", reason=reason))
    return parts


def _heat(scene: Scene, studies: Mapping[str, Study]) -> list[Part]:
    """Which studies find temperatures by the thermal model, where the scene names one."""
    if scene.models.thermal is None:
        return []
    held = _held(scene, studies)
    reason = (
        f"not in {', '.join(held)}, at the temperatures of the operation"
        if held
        else "the scene names it"
    )
    found = any(study.with_heat for study in studies.values())
    return [Part(part="thermal", included=found, choice=scene.models.thermal.name, reason=reason)]


def _damage(scene: Scene, studies: Mapping[str, Study]) -> list[Part]:
    """Which damage models the scene names that no study takes; a study that takes them says so in lines of its own."""
    if any(study.with_damage for study in studies.values()):
        return []
    reason = "no study of this run measures damage"
    return [
        Part(part="damage", included=False, choice=one.name, reason=reason)
        for one in scene.models.damage
    ]


def _held(scene: Scene, studies: Mapping[str, Study]) -> list[str]:
    """Name the studies in which the thermal model of the scene would find temperatures and does not act."""
    if scene.models.thermal is None:
        return []
    from rollslip.studies.thermal_balance.model import thermal_model  # nobody else needs it

    model = thermal_model(scene)
    return (
        [name for name, study in studies.items() if not study.with_heat]
        if model and model.nodes
        else []
    )


def _stage(kind: str, model: SliceModel, named: Any) -> Part:
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


def _pulls(assembly: Assembly, weighed: bool) -> list[Part]:
    """Return what acts on all rollers in one direction, but for the weight that all studies have themselves."""
    o = assembly.scene.operation
    fraction = assembly.weight_fraction
    tolerance = assembly.scene.accuracy.tolerance
    direction = o.gravity_direction
    if (carrier := o.carrier) is not None:
        what = "carrier"
        direction = carrier.direction
        why = "the bearing turns about another axis; the cage's own weight there is its guide's, and left out"
    elif (fraction > tolerance and not weighed) or direction is not None:
        weight = format_quantity(assembly.roller_mass * GRAVITY, "N", 2)
        what = "gravity of rollers"
        why = f"{weight} each, {100.0 * fraction:.2g} % of what presses a roller on average"
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
    choice = f"{force} on each roller, {math.degrees(direction):.3g} deg from the line of load"
    return [Part(part=what, choice=choice, resolution="in the equilibrium", reason=why)]


def _inlet(film: FilmModel) -> Part:
    """What heat and want of oil in the inlet do to the film."""
    heating = film.inlet_heating
    starvation = film.inlet_starvation
    return Part(
        part="thermal inlet shear",
        included=bool(heating),
        choice=(heating or "isothermal inlet")
        + (f", starved by {starvation}" if starvation else ""),
        resolution="every loaded slice" if heating else "",
        reason=f"film model {film.name!r} asks for it"
        if heating
        else "the scene does not ask for it",
    )
