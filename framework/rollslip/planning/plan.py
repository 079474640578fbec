"""The plan of a run: what is modelled, by which model, at which resolution, what is left out, and why.

A plan is made before anything runs, and executed as printed: a run takes the studies and their bearings, at the
resolution that was chosen for them (`rollslip.studies.discretisation.choice`), from the plan.

The cost is estimated before the run. Time is the larger one of the estimate and of a lower bound by the number of
evaluations. Estimates from small parts may err by a factor of two or three, so that nothing is refused for its time.
A result that does not fit into the memory of the machine is refused, because it would end the process, or other work of
the machine, after minutes.
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
from rollslip.catalogue.discovery import naming_package
from rollslip.catalogue.packages import check_required
from rollslip.errors import RollslipError, SceneError, UnknownNameError
from rollslip.planning.lines import (
    bearing_parts,
    check_parts,
    cost_sentences,
    part_as_dict,
    study_parts,
    uses_cage,
)
from rollslip.results.text import LOWER_BOUNDS, duration_range
from rollslip.scene.named import unknown_names
from rollslip.scene.reading import as_scene
from rollslip.scene.values import Scene
from rollslip.structure import Location, raise_problems
from rollslip.studies.answers import Part, ResolutionChoice
from rollslip.studies.study import Study, settings
from rollslip.units import format_quantity

_log = logging.getLogger(__name__)

#: Size of a number in double precision [bytes].
_NUMBER_SIZE: Final = 8


@attrs.frozen(eq=False, kw_only=True, repr=False)
class Plan:
    """The plan of a run: studies with their settings, the bearing of each at its resolution, and lines with reasons."""

    scene: Scene
    assembly: Assembly  #: The bearing as the scene states it.
    studies: dict[str, Study]
    assemblies: Mapping[str, Assembly]  #: Study -> its bearing, which checks what is left out.
    choices: Mapping[str, ResolutionChoice]  #: Study -> its resolution, with estimated errors.
    planning: float  #: Processor time that the plan took [s], without its lines.
    #: Makes the lines when they are first needed, since the time of each part is measured on small parts.
    make_parts: "Callable[[Plan], tuple[Part, ...]]"

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The lines: what is modelled and what is left out, with reasons and estimated costs."""
        return self.make_parts(self)

    @property
    def degrees_of_freedom(self) -> int:
        """Unknowns of the largest system that is solved."""
        studies = [study for study in self.studies.values() if study.is_transient]
        return max(
            study.degrees_of_freedom(self.assembly) for study in studies or self.studies.values()
        )

    @property
    def evaluations(self) -> int:
        """Approximate number of slices to be evaluated."""
        return sum(study.evaluations(self.assemblies[name]) for name, study in self.studies.items())

    def __repr__(self) -> str:
        name = self.scene.source or self.scene.title
        return f"Plan of {name!r}: {', '.join(self.studies)}; {duration_range(self.seconds)}"

    @property
    def seconds(self) -> float:
        """Estimated time of all studies [s]."""
        return sum(part.seconds or 0.0 for part in self.parts)

    def seconds_of(self, study: str) -> float:
        """Return the estimated time of a study [s]."""
        return sum(part.seconds or 0.0 for part in self.parts if part.study == study)

    @property
    def cost_sentences(self) -> list[str]:
        """Sentences to be printed before a run: that it takes long, or requests an error that cannot be reached."""
        return cost_sentences(self.assembly, self.studies, self.seconds, self.evaluations)

    @property
    def cautions(self) -> list[str]:
        """Sentences on all results, to be printed first: whether they are lower bounds, and a caution on the oil."""
        sentences = [self.assembly.lubricant.pressure_viscosity_law.caution()]
        if uses_cage(self.studies) and self.assembly.cage.drags.bound_below:
            sentences.insert(0, LOWER_BOUNDS)
        return [sentence for sentence in sentences if sentence]

    @property
    def models(self) -> tuple[tuple[str, Any], ...]:
        """Kind and model of all that is used, each once; those of a contact first."""
        studies = (pair for study in self.studies.values() for pair in study.models(self.assembly))
        return tuple(dict.fromkeys((*self.assembly.models.items(), *studies)))

    def at(self, study: str, resolution: Resolution) -> "Plan":
        """Return the plan with another resolution for a study; what is left out under a bound stays left out.

        Parameters
        ----------
        study : str
            Name of the study.
        resolution : Resolution
            Its resolution.
        """
        return self._with_choice(study, attrs.evolve(self.choices[study], resolution=resolution))

    def _with_choice(
        self, study: str, choice: ResolutionChoice, has_new_lines: bool = False
    ) -> "Plan":
        """Return the plan with another choice for a study; its lines are the previous ones, or scaled to the choice."""
        assembly = self.assemblies[study].at(choice.resolution).with_bounds(*choice.left_out)
        make_parts = partial(_previous_parts, self)
        if has_new_lines:
            make_parts = partial(_scaled_parts, self, study)
        return attrs.evolve(
            self,
            assemblies={**self.assemblies, study: assembly},
            choices={**self.choices, study: choice},
            make_parts=make_parts,
        )

    def with_reinstated(self, study: str, bound: LeftOut) -> "Plan":
        """Return the plan with a model of a study reinstated that was left out.

        Parameters
        ----------
        study : str
            Name of the study.
        bound : LeftOut
            The bound that was exceeded.
        """
        before = self.choices[study]
        choice = attrs.evolve(
            before,
            resolution=bound.reinstated(before.resolution),
            left_out=tuple(other for other in before.left_out if other is not bound),
        )
        return self._with_choice(study, choice)

    def refined(self, study: str, choice: ResolutionChoice) -> "Plan":
        """Return the plan with another resolution for a study, and lines on it; costs grow with its numbers.

        Parameters
        ----------
        study : str
            Name of the study.
        choice : ResolutionChoice
            The resolution, with its errors and the reason.
        """
        return self._with_choice(study, choice, has_new_lines=True)

    def parts_of(self, study: str) -> list[dict[str, Any]]:
        """Return the lines that concern a study, as plain values."""
        return [part_as_dict(part) for part in self.parts if part.study in ("", study)]

    def lines(self) -> list[dict[str, str]]:
        """Return the lines as text, by heading."""
        return [
            {
                "part": part.part
                + (f" of {part.study}" if part.study and len(self.studies) > 1 else ""),
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
        from rollslip.results.text import html_table

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
                name: attrs.asdict(choice.resolution) for name, choice in self.choices.items()
            },
            "parts": [part_as_dict(part) for part in self.parts],
            "degrees_of_freedom": self.degrees_of_freedom,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
            "planning": self.planning,
        }


def _units(settings: Any) -> dict[str, str]:
    """Return the unit of each number among settings, nested ones included."""
    units = dict[str, str]()
    for field in attrs.fields(type(settings)):
        value = getattr(settings, field.name)
        unit = field.metadata.get("unit")
        if attrs.has(type(value)):
            units |= _units(value)
        elif unit is not None or (isinstance(value, int | float) and not isinstance(value, bool)):
            units[field.name] = unit or "1"
    return units


def _studies_and_bearing(scene: Scene, study: str | None) -> tuple[dict[str, Study], Assembly]:
    """Return studies and bearing of a scene; an error has all that is wrong with both, and with the cage."""
    problems = list[str]()
    results = list[Any]()
    errors = list[RollslipError]()
    for make in (
        partial(settings, scene, study),
        partial(assemble, scene),
        partial(read_cage, scene),
    ):
        if len(results) == 2:  # a cage that no study uses may be wrong
            break
        try:
            results.append(make())
        except (SceneError, UnknownNameError) as error:
            errors.append(error)
            problems += error.problems if isinstance(error, SceneError) else [str(error)]
    if errors:
        every = dict.fromkeys([*problems, *unknown_names(scene.raw or {}, Location(scene.origins))])
        if len(errors) == 1 and len(every) == len({*problems}):
            raise errors[0]
        raise SceneError([*every])
    studies, assembly = results
    return studies, assembly


def plan(
    scene: Scene | str,
    study: str | None = None,
    *,
    cheaper_laws: bool = True,
    without: Collection[str] = (),
) -> Plan:
    """Plan a scene: choose the coarsest resolution and the cheapest laws whose errors keep its tolerances.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        Only this study, with the scene's settings or its defaults.
    cheaper_laws : bool
        Whether a law may be left out, or replaced by a cheaper one, where the error allows it; False where models are
        compared with each other.
    without : collection of str
        Outputs that are not needed; they are left out where that saves time.

    Raises
    ------
    SceneError
        If the scene is wrong, all faults that can be found at once, or a result would not fit into memory.
    PluginError
        If a package it requires or a model it names is missing or broken.
    """
    start = time.process_time()
    scene = as_scene(scene)
    if scene.plugins.require:
        check_required(scene.plugins.require, Location(scene.origins, ("plugins", "require")))
    requested, stated = _studies_and_bearing(scene, study)
    studies = {
        name: item.without_outputs(frozenset(without) | _superseded_outputs(item, requested))
        for name, item in requested.items()
    }
    require_memory(studies, stated)
    choices = {
        name: estimate(item, stated, cheaper_laws=cheaper_laws) for name, item in studies.items()
    }
    studies = {
        name: item.with_resolution(choices[name].resolution) for name, item in studies.items()
    }
    made = Plan(
        scene=scene,
        assembly=stated,
        studies=studies,
        assemblies={
            name: stated.at(choice.resolution).with_bounds(*choice.left_out)
            for name, choice in choices.items()
        },
        choices=choices,
        make_parts=_parts,
        planning=time.process_time() - start,
    )
    if _log.isEnabledFor(logging.INFO):
        for part in made.parts:
            text = part.choice if part.included else "left out"
            _log.info(": ".join(filter(None, (part.part, text, part.reason))))
    return made


def _parts(plan: Plan) -> tuple[Part, ...]:
    """Return the lines of a plan that was just made."""
    stated = plan.assembly
    studies = plan.studies
    parts = bearing_parts(stated, studies)
    for name, study in studies.items():
        assembly = stated.at(plan.choices[name].resolution)
        try:
            costs = study.cost(assembly)
        except RollslipError:
            costs = {}
        lines = study.parts(assembly, plan.choices[name], costs)
        lines += check_parts(study, assembly, costs)
        parts += [attrs.evolve(part, study=name) for part in lines]
    return (*parts, *study_parts(stated, studies))


def _previous_parts(before: Plan, _: Plan) -> tuple[Part, ...]:
    """Return the lines that a plan had before its run."""
    return before.parts


def _scaled_parts(before: Plan, study: str, plan: Plan) -> tuple[Part, ...]:
    """Return the lines of a plan with a finer resolution for a study; costs grow with its numbers."""
    choice = plan.choices[study]
    coarse, fine = (
        resolution.slices * (resolution.n_positions or 1)
        for resolution in (before.choices[study].resolution, choice.resolution)
    )
    seconds = {
        part.part: fine / coarse * part.seconds
        for part in before.parts
        if part.study == study and part.seconds
    }
    lines = [
        attrs.evolve(part, study=study, seconds=seconds.pop(part.part, None))
        for part in plan.studies[study].parts(plan.assembly.at(choice.resolution), choice, {})
    ]
    lines += [
        attrs.evolve(part, seconds=seconds[part.part])
        for part in before.parts
        if part.study == study and part.part in seconds
    ]
    return (*(part for part in before.parts if part.study != study), *lines)


def _superseded_outputs(study: Study, requested: Mapping[str, Study]) -> frozenset[str]:
    """Return the single values of a study which a study of the cage computes, too, by these names or their aliases."""
    better = set[str]()
    for other in requested.values():
        if other.with_cage and not study.with_cage:
            for name, output in other.outputs.items():
                better |= {name, *output.aliases}
    return frozenset(
        superseded
        for name, output in study.outputs.items()
        if not output.dims and name in better
        for superseded in (name, output.status)
    )


def estimate(study: Study, assembly: Assembly, *, cheaper_laws: bool = True) -> ResolutionChoice:
    """Return the resolution that a study chooses, or that of the bearing, with the reason, where it cannot choose.

    Parameters
    ----------
    study : Study
        The study with its settings.
    assembly : Assembly
        The bearing as the scene states it.
    cheaper_laws : bool
        Whether a law may be left out, or replaced by a cheaper one, where the error allows it.
    """
    try:
        with naming_package("study", study):
            return study.choose_resolution(assembly, cheaper_laws=cheaper_laws)
    except RollslipError as error:
        return ResolutionChoice(resolution=assembly.resolution, failed=str(error))


# Memory ------------------------------------------------------------------------------


def require_memory(studies: Mapping[str, Study], assembly: Assembly) -> None:
    """Refuse studies whose results do not fit into memory.

    Parameters
    ----------
    studies : mapping of str to Study
        Studies by name.
    assembly : Assembly
        The bearing as the scene states it.

    Raises
    ------
    SceneError
        If one does not fit.
    """
    memory = _memory()
    problems = []
    for study in studies.values():
        numbers = study.numbers(assembly)
        needed = _NUMBER_SIZE * sum(numbers.values())
        if needed > memory:
            setting = max(numbers, key=numbers.__getitem__)
            problems.append(
                f"{study.table}.{setting} = {getattr(study, setting):g} needs at least {_size(needed)} of memory, "
                f"and this machine has {_size(memory)}; lower it"
            )
    raise_problems(problems)


def _size(number: float) -> str:
    return f"{number / 1e9:.2g} GB"


def _memory() -> float:
    """Return the memory of this machine [bytes]; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return float("inf")
