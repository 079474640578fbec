"""The plan: what will be modelled of a scene, with which model, how finely, what is left out, and why.

It is made before anything runs and executed as printed: a run takes its studies and their bearings, at the resolution
that was chosen for them (`rollslip.studies.error_estimate`), from it.

What it will cost is told before it is spent. Time is that of the estimate, or what the evaluations take at the least,
the larger one; estimates from small parts may be off by a factor of two or three, so nothing is refused for its time. A
result that does not fit into the memory of the machine is refused: it would end the process, or the machine's other
work, after minutes.
"""

import logging
import os
import time
from collections.abc import Callable, Collection, Mapping
from functools import cached_property, partial
from html import escape
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.cage import read_cage
from rollslip.bearing.resolution import LeftOut, Resolution, error_text
from rollslip.catalogue.packages import check_required
from rollslip.errors import RollslipError, SceneError, UnknownNameError
from rollslip.planning.lines import (
    caged,
    check,
    cost_sentences,
    of_bearing,
    of_studies,
    part_as_dict,
)
from rollslip.results.words import LOWER_BOUNDS, duration_range
from rollslip.scene.named import unknown_names
from rollslip.scene.reading import as_scene
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.answers import Part, ResolutionChoice
from rollslip.studies.study import Study, settings
from rollslip.units import format_quantity

_log = logging.getLogger(__name__)

#: Size of a number [bytes].
_NUMBER: Final = 8


@attrs.frozen(eq=False, kw_only=True, repr=False)
class Plan:
    """What will be modelled: studies with their settings, the bearing of each at its resolution, and why, in lines."""

    scene: Scene
    assembly: Assembly  #: The bearing as the scene states it.
    studies: dict[str, Study]
    assemblies: Mapping[str, Assembly]  #: Study -> its bearing, with a watch over what is left out.
    choices: Mapping[str, ResolutionChoice]  #: Study -> its resolution, with estimated errors.
    planning: float  #: Processor time that the plan took [s], without its lines.
    #: Makes its lines when they are first asked for, with the time of each part, which is measured on small parts.
    make_parts: "Callable[[Plan], tuple[Part, ...]]"

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Its lines: what is modelled and what is left out, with reasons and estimated costs."""
        return self.make_parts(self)

    @property
    def degrees_of_freedom(self) -> int:
        """Unknowns of the largest system that is solved."""
        moving = [one for one in self.studies.values() if one.is_transient] or list(
            self.studies.values()
        )
        return max(one.degrees_of_freedom(self.assembly) for one in moving)

    @property
    def evaluations(self) -> int:
        """Slices to be evaluated, about."""
        return sum(one.evaluations(self.assemblies[name]) for name, one in self.studies.items())

    def __repr__(self) -> str:
        named = self.scene.source or self.scene.title
        studies = ", ".join(self.studies)
        return f"Plan of {named!r}: {studies}; {duration_range(self.seconds)}"

    @property
    def seconds(self) -> float:
        """Estimated cost of all studies."""
        return sum(part.seconds or 0.0 for part in self.parts)

    def seconds_of(self, study: str) -> float:
        """Return the estimated cost of a study."""
        return sum(part.seconds or 0.0 for part in self.parts if part.study == study)

    @property
    def cost_sentences(self) -> list[str]:
        """What somebody should know before it is run, in words: that it takes long, or asks for what there is not."""
        return cost_sentences(self.assembly, self.studies, self.seconds, self.evaluations)

    @property
    def cautions(self) -> list[str]:
        """What holds of all its results, as a run tells first: whether they are bounds, and a law of the oil."""
        bound = LOWER_BOUNDS if caged(self.studies) and self.assembly.cage.drags.bound_below else ""
        return [*filter(None, (bound, self.assembly.lubricant.pressure_viscosity_law.caution()))]

    @property
    def models(self) -> tuple[tuple[str, Any], ...]:
        """Kind and model of all that is used, each once: those of a contact first."""
        studies = (pair for study in self.studies.values() for pair in study.models(self.assembly))
        return tuple(dict.fromkeys((*self.assembly.models.items(), *studies)))

    def at(self, study: str, resolution: Resolution) -> "Plan":
        """Return the plan with another resolution for a study; what is left out under a bound stays so."""
        return self._refined(study, attrs.evolve(self.choices[study], resolution=resolution))

    def _refined(self, study: str, estimated: ResolutionChoice, scaled: bool = False) -> "Plan":
        """Return the plan with another choice for a study; its lines are those from before, or scaled to it."""
        assembly = self.assemblies[study].at(estimated.resolution).with_bounds(*estimated.left_out)
        return attrs.evolve(
            self,
            assemblies={**self.assemblies, study: assembly},
            choices={**self.choices, study: estimated},
            make_parts=partial(_scaled_parts, self, study)
            if scaled
            else partial(_parts_before, self),
        )

    def with_reinstated(self, study: str, bound: LeftOut) -> "Plan":
        """Return the plan of a study with what was left out under a bound taken back in."""
        before = self.choices[study]
        left_out = tuple(one for one in before.left_out if one is not bound)
        estimated = attrs.evolve(
            before, resolution=bound.reinstated(before.resolution), left_out=left_out
        )
        return self._refined(study, estimated)

    def again(self, study: str, estimated: ResolutionChoice) -> "Plan":
        """Return the plan with another resolution for a study, which its lines tell; costs grow with its numbers."""
        return self._refined(study, estimated, scaled=True)

    def parts_of(self, study: str) -> list[dict[str, Any]]:
        """Return the lines that concern a study, as plain values."""
        return [part_as_dict(part) for part in self.parts if part.study in ("", study)]

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
            "studies": {
                name: attrs.asdict(study) | {"units": _units(study)}
                for name, study in self.studies.items()
            },
            "resolutions": {
                name: attrs.asdict(one.resolution) for name, one in self.choices.items()
            },
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
        value = getattr(settings, one.name)
        unit = one.metadata.get("unit")
        if attrs.has(type(value)):
            found |= _units(value)
        elif unit is not None or (isinstance(value, int | float) and not isinstance(value, bool)):
            found[one.name] = unit or "1"
    return found


def _at_once(scene: Scene, study: str | None) -> tuple[dict[str, Study], Assembly]:
    """Return studies and bearing; if one is wrong, with what is wrong of the other and of the cage."""
    problems = list[str]()
    found = list[Any]()
    first = list[RollslipError]()
    for make in (
        partial(settings, scene, study),
        partial(assemble, scene),
        partial(read_cage, scene),
    ):
        if len(found) == 2:  # a cage that no study asks for may be wrong
            break
        try:
            found.append(make())
        except (SceneError, UnknownNameError) as error:
            first.append(error)
            problems += error.problems if isinstance(error, SceneError) else [str(error)]
    if first:
        every = dict.fromkeys([*problems, *unknown_names(scene.raw or {}, Location(scene.origins))])
        raise (
            first[0] if len(first) == 1 and len(every) == len({*problems}) else SceneError([*every])
        )
    chosen, stated = found
    return chosen, stated


def plan(
    scene: Scene | str,
    study: str | None = None,
    *,
    cheaper_laws: bool = True,
    without: Collection[str] = (),
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
    scene = as_scene(scene)
    if scene.plugins.require:
        check_required(scene.plugins.require, Location(scene.origins, ("plugins", "require")))
    chosen, stated = _at_once(scene, study)
    studies = {
        name: one.without_outputs(frozenset(without) | _known_better(one, chosen))
        for name, one in chosen.items()
    }
    require_memory(studies, stated)
    choices = {
        name: estimate(one, stated, cheaper_laws=cheaper_laws) for name, one in studies.items()
    }
    studies = {name: one.with_resolution(choices[name].resolution) for name, one in studies.items()}
    assemblies = {
        name: stated.at(one.resolution).with_bounds(*one.left_out) for name, one in choices.items()
    }
    made = Plan(
        scene=scene,
        assembly=stated,
        studies=studies,
        assemblies=assemblies,
        choices=choices,
        make_parts=_parts,
        planning=time.process_time() - begin,
    )
    if _log.isEnabledFor(logging.INFO):
        for part in made.parts:
            choice = part.choice if part.included else "left out"
            _log.info(": ".join(filter(None, (part.part, choice, part.reason))))
    return made


def _parts(plan: Plan) -> tuple[Part, ...]:
    """Return the lines of a plan that was just made."""
    stated = plan.assembly
    studies = plan.studies
    parts = of_bearing(stated, studies)
    for name, one in studies.items():
        assembly = stated.at(plan.choices[name].resolution)
        try:
            costs = one.cost(assembly)
        except RollslipError:
            costs = {}
        lines = [*one.parts(assembly, plan.choices[name], costs), *check(one, assembly, costs)]
        parts += [attrs.evolve(part, study=name) for part in lines]
    return (*parts, *of_studies(stated, studies))


def _parts_before(before: Plan, _: Plan) -> tuple[Part, ...]:
    """Return the lines that a plan had before its run."""
    return before.parts


def _scaled_parts(before: Plan, study: str, plan: Plan) -> tuple[Part, ...]:
    """Return the lines of a plan with a finer resolution for a study; costs grow with its numbers."""
    estimated = plan.choices[study]
    few, many = (
        one.slices * (one.n_positions or 1)
        for one in (before.choices[study].resolution, estimated.resolution)
    )
    seconds = {
        part.part: many / few * part.seconds
        for part in before.parts
        if part.study == study and part.seconds
    }
    lines = [
        attrs.evolve(part, study=study, seconds=seconds.pop(part.part, None))
        for part in plan.studies[study].parts(plan.assembly.at(estimated.resolution), estimated, {})
    ]
    own = (part for part in before.parts if part.study == study and part.part in seconds)
    lines += [attrs.evolve(part, seconds=seconds[part.part]) for part in own]
    return (*(part for part in before.parts if part.study != study), *lines)


def _known_better(study: Study, chosen: Mapping[str, Study]) -> frozenset[str]:
    """Single values that a study of the cage tells by these or other names: one question has one answer."""
    caged = [one for one in chosen.values() if one.with_cage and not study.with_cage]
    told = {
        name
        for one in caged
        for own, output in one.outputs.items()
        for name in (own, *output.aliases)
    }
    same = {
        name: output for name, output in study.outputs.items() if not output.dims and name in told
    }
    return frozenset(same) | {output.status for output in same.values()}


def estimate(study: Study, assembly: Assembly, *, cheaper_laws: bool = True) -> ResolutionChoice:
    """Return the resolution that a study chooses."""
    try:
        return study.choose_resolution(assembly, cheaper_laws=cheaper_laws)
    except RollslipError as error:
        return ResolutionChoice(resolution=assembly.resolution, failed=str(error))


# What it costs, told before it is spent ------------------------------------------------------------------------------


def require_memory(
    studies: Mapping[str, Study], assembly: Assembly, memory: float | None = None
) -> None:
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


def _size(number: float) -> str:
    return f"{number / 1e9:.2g} GB"


def _memory() -> float:
    """Memory of this machine [bytes]; without bound where it does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return float("inf")
