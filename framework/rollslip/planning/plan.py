"""The plan: what will be modelled of a scene, with which model, how finely, what is left out, and why.

It is made before anything runs and executed as printed: a run takes its studies and their bearings, at the resolution
that was chosen for them (`rollslip.studies.estimates`), from it.

What it will cost is told before it is spent. Time is that of the estimate, or what the evaluations take at the least,
the larger one; estimates from small parts may be off by a factor of two or three, so nothing is refused for its time. A
result that does not fit into the memory of the machine is refused: it would end the process, or the machine's other
work, after minutes.
"""

import logging
import math
import os
import time
from collections.abc import Collection, Mapping
from functools import partial
from html import escape
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.cage import in_words, read_cage
from rollslip.bearing.resolution import LeftOut, Resolution, error_text
from rollslip.catalogue.packages import check_required
from rollslip.catalogue.registry import find
from rollslip.errors import RollslipError, SceneError, UnknownNameError
from rollslip.models import FilmModel, PressureModel, SliceModel
from rollslip.results.words import LOWER_BOUNDS, SWITCHED_OFF, duration_range
from rollslip.scene.named import unknown_names
from rollslip.scene.reading import load_scene
from rollslip.scene.values import EXACT, Scene
from rollslip.structure import Location
from rollslip.studies.answers import Estimated, Part
from rollslip.studies.parts import rings
from rollslip.studies.study import Study, settings
from rollslip.units import GRAVITY, format_quantity

_log = logging.getLogger(__name__)

#: Time that is told before it is spent [s].
LONG: Final = 60.0
#: Time of a slice at the least, all stages compiled [s], and size of a number [bytes].
_SLICE, _NUMBER = 2e-8, 8


@attrs.frozen(eq=False, kw_only=True, repr=False)
class Plan:
    """What will be modelled: studies with their settings, the bearing of each at its resolution, and why, in lines."""

    scene: Scene
    assembly: Assembly  #: The bearing as the scene states it.
    studies: dict[str, Study]
    assemblies: Mapping[str, Assembly]  #: Study -> its bearing, with a watch over what is left out.
    estimated: Mapping[str, Estimated]  #: Study -> its resolution, with estimated errors.
    parts: tuple[Part, ...]
    degrees_of_freedom: int
    evaluations: int
    planning: float

    def __repr__(self) -> str:
        named, studies = self.scene.source or self.scene.title, ", ".join(self.studies)
        return f"Plan of {named!r}: {studies}; {duration_range(self.seconds)}"

    @property
    def seconds(self) -> float:
        """Estimated cost of all studies."""
        return sum(part.seconds or 0.0 for part in self.parts)

    def seconds_of(self, study: str) -> float:
        """Return the estimated cost of a study."""
        return sum(part.seconds or 0.0 for part in self.parts if part.study == study)

    @property
    def foreseen(self) -> list[str]:
        """What somebody should know before it is run, in words: that it takes long, or asks for what there is not."""
        return foreseen(self.scene, self.studies, self.seconds, self.evaluations)

    @property
    def cautions(self) -> list[str]:
        """What holds of all its results, as a run tells first: whether they are bounds, and a law of the oil."""
        bound = LOWER_BOUNDS if _caged(self.studies) and self.assembly.cage.drags.bound_below else ""
        return [*filter(None, (bound, self.assembly.lubricant.pressure_viscosity_law.caution()))]

    @property
    def models(self) -> tuple[tuple[str, Any], ...]:
        """Kind and model of all that is used, each once: those of a contact first."""
        studies = (pair for study in self.studies.values() for pair in study.models(self.assembly))
        return tuple(dict.fromkeys((*self.assembly.models.items(), *studies)))

    def at(self, study: str, resolution: Resolution) -> "Plan":
        """Return the plan with another resolution for a study; what is left out under a bound stays so."""
        estimated = attrs.evolve(self.estimated[study], resolution=resolution)
        assembly = self.assemblies[study].at(resolution).with_bounds(*estimated.left_out)
        return attrs.evolve(
            self, assemblies={**self.assemblies, study: assembly}, estimated={**self.estimated, study: estimated}
        )

    def taking_back(self, study: str, bound: LeftOut) -> "Plan":
        """Return the plan of a study with what was left out under a bound taken back in."""
        before = self.estimated[study]
        left_out = tuple(one for one in before.left_out if one is not bound)
        estimated = attrs.evolve(before, resolution=bound.taken_back(before.resolution), left_out=left_out)
        return attrs.evolve(self, estimated={**self.estimated, study: estimated}).at(study, estimated.resolution)

    def again(self, study: str, estimated: Estimated) -> "Plan":
        """Return the plan with another resolution for a study, which its lines tell; costs grow with its numbers."""
        few, many = (
            one.slices * (one.instants or 1) for one in (self.estimated[study].resolution, estimated.resolution)
        )
        before = {part.part: many / few * part.seconds for part in self.parts if part.study == study and part.seconds}
        made = attrs.evolve(self, estimated={**self.estimated, study: estimated}).at(study, estimated.resolution)
        lines = [
            attrs.evolve(part, study=study, seconds=before.pop(part.part, None))
            for part in made.studies[study].parts(self.assembly.at(estimated.resolution), estimated, {})
        ]
        own = (part for part in self.parts if part.study == study and part.part in before)
        lines += [attrs.evolve(part, seconds=before[part.part]) for part in own]
        others = [part for part in self.parts if part.study != study]
        return attrs.evolve(made, parts=(*others, *lines))

    def lines(self) -> list[dict[str, str]]:
        """Return what people read of each part, by heading."""
        several = len(self.studies) > 1
        return [
            {
                "part": part.part + (f" of {part.study}" if part.study and several else ""),
                "modelled": "in" if part.included else "out",
                "choice": part.choice,
                "resolution": part.resolution,
                "error": error_text(part.errors),
                "cost": "" if part.seconds is None else format_quantity(part.seconds, "s", 2),
                "reason": part.reason,
            }
            for part in self.parts
        ]

    def _repr_html_(self) -> str:
        from rollslip.results.words import html_table

        lines = self.lines()
        return f"<p>{escape(repr(self))}</p>{html_table([*lines[0]], [[*line.values()] for line in lines])}"

    def as_dict(self) -> dict[str, Any]:
        """Return the plan as plain values, for JSON; an error that cannot be determined is null."""
        return {
            "scene": self.scene.source,
            "studies": {name: attrs.asdict(study) | {"units": _units(study)} for name, study in self.studies.items()},
            "resolutions": {name: attrs.asdict(one.resolution) for name, one in self.estimated.items()},
            "parts": [part_as_dict(part) for part in self.parts],
            "degrees_of_freedom": self.degrees_of_freedom,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
            "planning": self.planning,
        }


def _units(settings: Any) -> dict[str, str]:
    """Return the unit of each number among settings, those of settings in them too."""
    found = dict[str, str]()
    for one in attrs.fields(type(settings)):
        value, unit = getattr(settings, one.name), one.metadata.get("unit")
        if attrs.has(type(value)):
            found |= _units(value)
        elif unit is not None or (isinstance(value, int | float) and not isinstance(value, bool)):
            found[one.name] = unit or "1"
    return found


def part_as_dict(part: Part) -> dict[str, Any]:
    """Return a line of a plan as plain values; an error that cannot be determined is null."""
    errors = {name: error if math.isfinite(error) else None for name, error in part.errors.items()}
    return attrs.asdict(part) | {"errors": errors}


def _at_once(scene: Scene, study: str | None) -> tuple[dict[str, Study], Assembly]:
    """Return studies and bearing; if one is wrong, with what is wrong of the other and of the cage."""
    problems, found, first = list[str](), list[Any](), list[RollslipError]()
    for make in (partial(settings, scene, study), partial(assemble, scene), partial(read_cage, scene)):
        if len(found) == 2:  # a cage that no study asks for may be wrong
            break
        try:
            found.append(make())
        except (SceneError, UnknownNameError) as error:
            first.append(error)
            problems += error.problems if isinstance(error, SceneError) else [str(error)]
    if first:
        every = dict.fromkeys([*problems, *unknown_names(scene.raw or {}, Location(scene.origins))])
        raise first[0] if len(first) == 1 and len(every) == len({*problems}) else SceneError([*every])
    chosen, stated = found
    return chosen, stated


def plan(
    scene: Scene | str, study: str | None = None, *, cheaper_laws: bool = True, without: Collection[str] = ()
) -> Plan:
    """Plan a scene: the cheapest way that keeps the error it states.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        Only this study, with the scene's settings or its defaults.
    cheaper_laws : bool
        Whether a law may be evaluated more cheaply, or another serve in its place, where the error allows it; where
        models are compared with each other it may not.
    without : collection of str
        Outputs that nobody asked for, which are left out where that saves something.

    Raises
    ------
    SceneError
        If the scene is wrong, all faults that can be found at once, or a result would not fit into memory.
    PluginError
        If a package it requires or a model it names is missing or broken.
    """
    begin = time.process_time()
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    check_required(scene.plugins.require, Location(scene.origins, ("plugins", "require")))
    chosen, stated = _at_once(scene, study)
    studies = {name: one.without(frozenset(without) | _known_better(one, chosen)) for name, one in chosen.items()}
    require_memory(studies, stated)
    estimated = {name: estimate(one, stated, cheaper_laws=cheaper_laws) for name, one in studies.items()}
    studies = {name: one.at(estimated[name].resolution) for name, one in studies.items()}
    assemblies = {name: stated.at(one.resolution).with_bounds(*one.left_out) for name, one in estimated.items()}
    named = dict(scene.raw or {}).get("models", {})
    parts = [_stage(kind, model, named) for kind, model in stated.models.items()]
    parts.append(
        Part(
            part="viscosity at pressure",
            choice=stated.lubricant.pressure_viscosity_law.name,
            resolution="every loaded lamina",
            reason="; ".join(
                filter(
                    None,
                    (f"the law of the oil, {stated.lubricant.name}", stated.lubricant.pressure_viscosity_law.caution()),
                )
            ),
        )
    )
    parts.append(_inlet(stated.film))
    if (mounted := scene.bearing.mounted) is not None:
        clearance = format_quantity(mounted.clearance, "m", 3)
        parts.append(Part(part="clearance", choice=clearance, resolution="in operation", reason=str(mounted)))
    parts.append(rings(stated))
    parts += _pulls(stated)
    for name, one in studies.items():
        assembly = stated.at(estimated[name].resolution)
        try:
            costs = one.cost(assembly)
        except RollslipError:
            costs = {}
        parts += [attrs.evolve(part, study=name) for part in one.parts(assembly, estimated[name], costs)]
    parts += _cage(stated, studies) + _heat(scene, studies) + _damage(scene, studies)
    for part in parts:
        choice = part.choice if part.included else "left out"
        _log.info(": ".join(filter(None, (part.part, choice, part.reason))))
    moving = [one for one in studies.values() if one.in_time] or list(studies.values())
    return Plan(
        scene=scene,
        assembly=stated,
        studies=studies,
        assemblies=assemblies,
        estimated=estimated,
        parts=tuple(parts),
        degrees_of_freedom=max(one.degrees_of_freedom(stated) for one in moving),
        evaluations=sum(one.evaluations(assemblies[name]) for name, one in studies.items()),
        planning=time.process_time() - begin,
    )


def _known_better(study: Study, chosen: Mapping[str, Study]) -> frozenset[str]:
    """Single values that a study of the cage tells by these or other names: one question has one answer."""
    caged = [one for one in chosen.values() if one.with_cage and not study.with_cage]
    told = {name for one in caged for own, output in one.outputs.items() for name in (own, *output.also)}
    same = {name: output for name, output in study.outputs.items() if not output.dims and name in told}
    return frozenset(same) | {output.status for output in same.values()}


def estimate(study: Study, assembly: Assembly, *, cheaper_laws: bool = True) -> Estimated:
    """Return the resolution that a study chooses."""
    try:
        return study.estimate(assembly, cheaper_laws=cheaper_laws)
    except RollslipError as error:
        return Estimated(resolution=assembly.resolution, failed=str(error))


# What it costs, told before it is spent ------------------------------------------------------------------------------


def require_memory(studies: Mapping[str, Study], assembly: Assembly, memory: float | None = None) -> None:
    """Refuse studies whose results do not fit into memory."""
    memory = _memory() if memory is None else memory
    problems = []
    for study in studies.values():
        of = study.numbers(assembly)
        needed = _NUMBER * sum(of.values())
        if needed > memory:
            setting = max(of, key=lambda name: of[name])
            problems.append(
                f"{study.table}.{setting} = {getattr(study, setting):g} asks for at least {_size(needed)} of memory, "
                f"and this machine has {_size(memory)}; lower it"
            )
    if problems:
        raise SceneError(problems)


def own_cage(scene: Scene, studies: Mapping[str, Study]) -> str:
    """Return which cage a bearing has that the scene does not state; nothing where it does, or none takes part."""
    if not _caged(studies) or "mass" in (scene.cage or {}):
        return ""
    cage = read_cage(scene)
    told = "; ".join(in_words(scene, cage))
    return f"the cage is the bearing's own, {told}" if cage.separator.coefficient is None else f"cage: {told}"


def foreseen(scene: Scene, studies: Mapping[str, Study], seconds: float, evaluations: int) -> list[str]:
    """Return in words what somebody should know before a plan is run; empty if there is nothing."""
    said = [
        f"accuracy.{name} = {value:g} is less than the finest of everything leaves, about {EXACT:g} to 1e-05; nothing "
        f'finer is computed than with accuracy.{name} = "exact"'
        if name == "tolerance"
        else f"accuracy.{name} = {value:g} is less than the finest of everything leaves, about {EXACT:g} to 1e-05"
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
            f"this will take {duration_range(seconds)} of the processor, {evaluations:.1e} laminae to evaluate; "
            "Ctrl-C ends it, and rollslip plan says what the time goes to"
        )
    return said


def _caged(studies: Mapping[str, Study]) -> bool:
    """Whether a study tells of the cage."""
    return any(study.with_cage or getattr(study, "runaway_range", 0.0) for study in studies.values())


def _size(number: float) -> str:
    return f"{number / 1e9:.2g} GB"


def _memory() -> float:
    """Memory of this machine [bytes]; without bound where it does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return float("inf")


# Its lines ------------------------------------------------------------------------------------------------------------


def _cage(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """The drags, where a study asks for the cage."""
    if not any(study.with_cage for study in studies.values()):
        reason = "the scene has no study of cage and rollers in motion"
        return [Part(part="cage, drag and integrators", included=False, choice="not loaded", reason=reason)]
    named = "drag" in (assembly.scene.cage or {})
    supply = assembly.scene.lubrication.supply
    reason = "cage.drag names it" if named else f"default, of lubrication.supply = {supply!r}"
    choice, known = in_words(assembly.scene, assembly.cage)
    parts = [
        Part(part="cage", choice=choice, reason=known),
        *(Part(part="drag", choice=one.name, resolution=one.equation, reason=reason) for one in assembly.cage.drags),
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
    reason = f"not in {', '.join(held)}, at the temperatures of the operation" if held else "the scene names it"
    found = any(study.with_heat for study in studies.values())
    return [Part(part="thermal", included=found, choice=scene.models.thermal.name, reason=reason)]


def _damage(scene: Scene, studies: Mapping[str, Study]) -> list[Part]:
    """Which damage models the scene names that no study takes; a study that takes them says so in lines of its own."""
    if any(study.with_damage for study in studies.values()):
        return []
    reason = "no study of this run measures damage"
    return [Part(part="damage", included=False, choice=one.name, reason=reason) for one in scene.models.damage]


def _held(scene: Scene, studies: Mapping[str, Study]) -> list[str]:
    """Name the studies in which the thermal model of the scene would find temperatures and does not act."""
    if scene.models.thermal is None:
        return []
    from rollslip.studies.thermal_balance.model import thermal_model  # nobody else needs it

    model = thermal_model(scene)
    return [name for name, study in studies.items() if not study.with_heat] if model and model.nodes else []


def _stage(kind: str, model: SliceModel, named: Any) -> Part:
    offer = find(kind, model.name)
    compiled = "compiled" if model.kernel() is not None else "NumPy"
    if isinstance(model, PressureModel) and model.of_contact:
        compiled = "that of the contact model, no stage"
    return Part(
        part=kind,
        choice=f"{model.name} ({offer.package} {offer.version}, {compiled})",
        resolution="every loaded lamina",
        reason="the scene names it" if kind in named else "default",
    )


def _pulls(assembly: Assembly) -> list[Part]:
    """Return what acts on all rollers in one direction."""
    o, share, tolerance = assembly.scene.operation, assembly.weight_share, assembly.scene.accuracy.tolerance
    direction = o.gravity_direction
    if (carrier := o.carrier) is not None:
        what, direction = "carrier", carrier.direction
        why = "the bearing turns about another axis; the cage's own weight there is its guide's, and left out"
    elif share > tolerance or direction is not None:
        weight = format_quantity(assembly.roller_mass * GRAVITY, "N", 2)
        what = "gravity of rollers"
        why = f"{weight} each, {100.0 * share:.2g} % of what presses a roller on average"
        if direction is None or share <= tolerance:
            less = "below the tolerance" if share <= tolerance else "operation.gravity_direction would take it in"
            return [Part(part=what, choice=weight, resolution="", reason=f"{why}: {less}", included=False)]
    else:
        return []
    force = format_quantity(math.hypot(*assembly.body_force), "N", 2)
    choice = f"{force} on each roller, {math.degrees(direction):.3g} deg from the line of load"
    return [Part(part=what, choice=choice, resolution="in the equilibrium", reason=why)]


def _inlet(film: FilmModel) -> Part:
    """What heat and want of oil in the inlet do to the film."""
    heating, starvation = film.inlet_heating, film.inlet_starvation
    return Part(
        part="thermal inlet shear",
        included=bool(heating),
        choice=(heating or "isothermal inlet") + (f", starved by {starvation}" if starvation else ""),
        resolution="every loaded lamina" if heating else "",
        reason=f"film model {film.name!r} asks for it" if heating else "the scene does not ask for it",
    )
