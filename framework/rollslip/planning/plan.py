"""The plan: what will be modelled of a scene, with which model, how finely, what is left out, and why.

It is made before anything runs and executed as printed: a run takes its studies and their bearings, at the resolution
that was chosen for them (`rollslip.planning.estimates`), from it.
"""

import math
import time
from collections.abc import Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.resolution import Resolution
from rollslip.catalogue.packages import check_required
from rollslip.catalogue.registry import find
from rollslip.errors import RollslipError
from rollslip.models import FilmModel, SliceModel
from rollslip.motion.raceway_friction import FRICTION
from rollslip.planning.bounds import LeftOut
from rollslip.planning.cost_estimates import seconds
from rollslip.planning.estimates import Chosen, choose
from rollslip.scene.reading import Where, load_scene
from rollslip.scene.values import Scene
from rollslip.studies.dynamics.study import LEVELS, Dynamics
from rollslip.studies.study import Study, settings


@attrs.frozen(kw_only=True)
class Part:
    """One line of the plan; ``study`` is empty where it is of all of them.

    ``errors`` are the relative errors that it is estimated to leave, result by result, ``seconds`` its estimated cost.
    """

    part: str
    included: bool
    choice: str
    resolution: str
    reason: str
    study: str = ""
    errors: Mapping[str, float] = attrs.field(factory=dict)
    seconds: float | None = None


@attrs.frozen(eq=False, kw_only=True)
class Plan:
    """What will be modelled: studies with their settings, the bearing at the resolution of each, reasons line by line.

    Attributes
    ----------
    assembly : Assembly
        The bearing as the scene states it.
    assemblies : mapping
        Study -> its bearing, with a watch over what is left out.
    chosen : mapping
        Study -> its resolution, with estimated errors.
    """

    scene: Scene
    assembly: Assembly
    studies: dict[str, Study]
    assemblies: Mapping[str, Assembly]
    chosen: Mapping[str, Chosen]
    parts: tuple[Part, ...]
    degrees_of_freedom: int
    evaluations: int
    planning: float

    @property
    def seconds(self) -> float:
        """Estimated cost of all studies."""
        return sum(part.seconds or 0.0 for part in self.parts)

    def seconds_of(self, study: str) -> float:
        """Return the estimated cost of a study."""
        return sum(part.seconds or 0.0 for part in self.parts if part.study == study)

    @property
    def models(self) -> tuple[tuple[str, Any], ...]:
        """Kind and model of all that is used, each once: those of a contact first."""
        studies = (pair for study in self.studies.values() for pair in study.models(self.assembly))
        return tuple(dict.fromkeys((*self.assembly.models.items(), *studies)))

    def at(self, study: str, resolution: Resolution) -> "Plan":
        """Return the plan with another resolution for a study; what is left out under a bound stays so."""
        chosen = attrs.evolve(self.chosen[study], resolution=resolution)
        assembly = self.assemblies[study].at(resolution).watched(*chosen.left_out)
        return attrs.evolve(
            self, assemblies={**self.assemblies, study: assembly}, chosen={**self.chosen, study: chosen}
        )

    def taking_back(self, study: str, bound: LeftOut) -> "Plan":
        """Return the plan of a study with what was left out under a bound taken back in."""
        chosen = self.chosen[study]
        left_out = tuple(one for one in chosen.left_out if one is not bound)
        chosen = attrs.evolve(chosen, resolution=bound.taken_back(chosen.resolution), left_out=left_out)
        return attrs.evolve(self, chosen={**self.chosen, study: chosen}).at(study, chosen.resolution)

    def as_dict(self) -> dict[str, Any]:
        """Return the plan as plain values, for JSON; an error that cannot be told is null."""
        return {
            "scene": self.scene.source,
            "studies": {name: attrs.asdict(study) for name, study in self.studies.items()},
            "resolutions": {name: attrs.asdict(one.resolution) for name, one in self.chosen.items()},
            "parts": [part_as_dict(part) for part in self.parts],
            "degrees_of_freedom": self.degrees_of_freedom,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
            "planning": self.planning,
        }


def part_as_dict(part: Part) -> dict[str, Any]:
    """Return a line of a plan as plain values; an error that cannot be told is null."""
    errors = {name: error if math.isfinite(error) else None for name, error in part.errors.items()}
    return attrs.asdict(part) | {"errors": errors}


def changed(this: Plan, other: Plan) -> list[tuple[Part | None, Part | None]]:
    """Return the parts of two plans that differ in what is modelled or how finely, None where one has no such part."""

    def numbered(plan: Plan) -> dict[tuple[str, str, int], Part]:
        found: dict[tuple[str, str, int], Part] = {}
        for part in plan.parts:
            of = part.study if len(plan.studies) > 1 else ""
            count = sum(key[:2] == (of, part.part) for key in found)
            found[of, part.part, count] = part
        return found

    parts, others = numbered(this), numbered(other)
    pairs = [(parts.get(key), others.get(key)) for key in dict.fromkeys((*parts, *others))]

    def said(part: Part | None) -> tuple[object, ...] | None:
        return None if part is None else (part.included, part.choice, part.resolution)

    return [pair for pair in pairs if said(pair[0]) != said(pair[1])]


def plan(scene: Scene | str, study: str | None = None, *, cheaper_laws: bool = True) -> Plan:
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

    Raises
    ------
    SceneError
        If the scene is wrong; all faults that can be found at once.
    PluginError
        If a package it requires or a model it names is missing or broken.
    """
    begin = time.process_time()
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    check_required(scene.plugins.require, Where(scene.origins, ("plugins", "require")))
    studies = settings(scene, study)
    stated = assemble(scene)
    chosen = {name: choose(one, stated, cheaper_laws=cheaper_laws) for name, one in studies.items()}
    studies = {
        name: one.at(chosen[name].resolution) if isinstance(one, Dynamics) else one for name, one in studies.items()
    }
    assemblies = {name: stated.at(one.resolution).watched(*one.left_out) for name, one in chosen.items()}
    named = dict(scene.raw or {}).get("models", {})
    parts = [_stage(kind, model, named) for kind, model in stated.models.items()]
    parts.append(
        Part(
            part="viscosity at pressure",
            included=True,
            choice=stated.lubricant.pressure_viscosity_law.name,
            resolution="every loaded slice",
            reason=f"the law of the oil, {stated.lubricant.name}",
        )
    )
    parts.append(_inlet(stated.film))
    for name, one in studies.items():
        parts += _parts_of(name, one, stated.at(chosen[name].resolution), chosen[name])
    parts += _motion(stated, studies, chosen)
    return Plan(
        scene=scene,
        assembly=stated,
        studies=studies,
        assemblies=assemblies,
        chosen=chosen,
        parts=tuple(parts),
        degrees_of_freedom=_degrees_of_freedom(stated, studies),
        evaluations=sum(one.evaluations(assemblies[name]) for name, one in studies.items()),
        planning=time.process_time() - begin,
    )


def _parts_of(name: str, study: Study, assembly: Assembly, chosen: Chosen) -> list[Part]:
    """What is particular to a study: its slices, instants, tables and what is left out, with errors and costs."""
    try:
        costs = dict(seconds(study, assembly))
    except RollslipError:
        costs = {}
    scene, resolution, errors = assembly.scene, chosen.resolution, chosen.errors
    if chosen.failed:
        why = f"there are no estimates: {chosen.failed}"
    else:
        share = " and ".join(f"{scene.accuracy.of(result):g} ({result.replace('_', ' ')})" for result in chosen.total)
        why = f"the fewest whose estimated error keeps {share}" if share else "the finest of all"
    parts = [_slices(assembly, errors.get("slices", {}), why)]
    if name != "friction-curve":
        bearing = scene.bearing
        loads = assembly.load_distribution(1)
        doubled = f"instants doubled until the curve moves by less than {scene.accuracy.tolerance:g}"
        parts += [
            Part(
                part="load distribution",
                included=True,
                choice="quasi-static equilibrium of ring and rollers",
                resolution=f"{bearing.rollers} rollers, "
                + (f"{resolution.instants} instants of a pitch" if resolution.instants else doubled),
                reason=f"one revolution is much shorter than the cage's transient; {why}",
                errors=errors.get("instants", {}),
                seconds=costs.pop("load distribution", None),
            ),
            Part(
                part="unloaded contacts",
                included=False,
                choice="no friction stage",
                resolution=f"{bearing.rollers - int(np.count_nonzero(loads.inner_force[0]))} of {bearing.rollers} on "
                "the inner ring",
                reason="they carry nothing, and averaging them in would be wrong",
            ),
        ]
    full = assembly.at(attrs.evolve(resolution, boundary=True)).traction.full_film_from
    if full is not None:
        parts.append(_boundary(resolution, full))
    law = assembly.traction.full_film.name
    if "law" in errors:
        parts.append(
            Part(
                part="law of the full film",
                included=True,
                choice=law if resolution.traction != "named" else f"{law} to {resolution.traction_error:.1e}",
                resolution="every loaded slice",
                reason="serves in place of the one that the scene names, from which it differs by less than its share",
                errors=errors["law"],
            )
        )
    if "tables" in errors:
        parts.append(
            Part(
                part="tables",
                included=True,
                choice="loads over the orbit, effective friction, slip-drag curve",
                resolution=f"error {resolution.table_tolerance:.1e}",
                reason="nodes are added until it is kept",
                errors=errors["tables"],
                seconds=costs.pop("tables", None),
            )
        )
    if "steps" in errors:
        parts.append(
            Part(
                part="steps in time",
                included=True,
                choice=f"relative tolerance {resolution.integrator_tolerance or 0.0:.1e}",
                resolution="every step",
                reason="two short motions of other tolerances tell what it leaves of the cage speed",
                errors=errors["steps"],
                seconds=costs.pop("motion", None),
            )
        )
    parts += [
        Part(part=part, included=True, choice="", resolution=_OVER.get(part, ""), reason=_COSTS[part], seconds=cost)
        for part, cost in costs.items()
    ]
    return [attrs.evolve(part, study=name) for part in parts]


#: Cost of a study that no line above names -> what it is.
_COSTS: Final = {
    "friction": "the models of a contact on every loaded slice, over the slips and in search of the largest",
    "film regimes": "told of every loaded slice, over the slips of the curve",
    "map": "the study asks for friction over cage slip and roller slip",
    "orbits": "a steady motion of the rollers for every slip that is asked for",
    "motion": "the study asks for cage and rollers in time",
    "tables": "loads over the orbit and effective friction",
    "load distribution": "quasi-static equilibrium",
}
_OVER: Final = {"map": "over few loads that stand for all slices"}


def _slices(assembly: Assembly, errors: Mapping[str, float], why: str) -> Part:
    scene, resolution = assembly.scene, assembly.resolution
    bearing, tilted = scene.bearing, scene.operation.misalignment != 0.0
    if assembly.slices == 1:
        return Part(
            part="slices",
            included=False,
            choice="one slice per contact",
            resolution="1",
            reason="straight rollers and aligned rings load a contact evenly along its length",
        )
    uneven = " and ".join(["the profile"] * (bearing.profile.shape != "none") + ["the misalignment"] * tilted)
    points = "equal slices" if resolution.quadrature == "equal" else "points of Gauss and Legendre"
    if scene.accuracy.slices is not None:
        why = "accuracy.slices fixes their number"
    return Part(
        part="slices",
        included=True,
        choice=f"profile {bearing.profile.shape}",
        resolution=f"{assembly.slices} {points}",
        reason=f"{uneven} loads a contact unevenly along its length; {why}",
        errors=errors,
    )


def _boundary(resolution: Resolution, limit: float) -> Part:
    found = (
        "at the ends of the slips a film parameter is below it"
        if resolution.boundary
        else "it is watched at every evaluation, and boundary friction taken back in where one falls below it"
    )
    return Part(
        part="boundary friction",
        included=resolution.boundary,
        choice="evaluated only on slices that need it",
        resolution="",
        reason=f"a film is full from a film parameter of {limit:g}; {found}",
    )


def _degrees_of_freedom(assembly: Assembly, studies: Mapping[str, Study]) -> int:
    """Of the largest system that is solved: the bearing in motion, or at rest."""
    dynamics = studies.get("dynamics")
    if isinstance(dynamics, Dynamics):
        return dynamics.degrees_of_freedom(assembly)
    if studies.keys() & {"effective-friction", "steady-slip"}:
        return 2 + (2 if assembly.slices > 1 else 1) * assembly.scene.bearing.rollers
    return 0


def _motion(assembly: Assembly, studies: Mapping[str, Study], made: Mapping[str, Chosen]) -> list[Part]:
    """Cage, drags and integrator, where a study asks for them."""
    dynamics = studies.get("dynamics")
    if dynamics is None and "steady-slip" not in studies:
        reason = "the scene has no study of cage and rollers in motion"
        return [
            Part(part="cage, drag and integrators", included=False, choice="not loaded", resolution="", reason=reason)
        ]
    parts = []
    if isinstance(dynamics, Dynamics):
        offer, chosen = find("integrator", dynamics.method(assembly).name), made["dynamics"]

        def why(setting: str) -> str:
            named = setting in assembly.scene.study.get("dynamics", {})
            return "study.dynamics names it" if named else chosen.reasons.get(setting, "default")

        parts += [
            Part(
                part="friction of the raceways",
                included=True,
                choice=dynamics.friction,
                resolution=FRICTION[dynamics.friction],
                reason=why("friction"),
                errors=chosen.errors.get("friction", {}),
            ),
            Part(
                part="motion",
                included=True,
                choice=f"level {dynamics.level}: {LEVELS[dynamics.level]}",
                resolution=f"{dynamics.degrees_of_freedom(assembly)} unknowns for {dynamics.duration:g} s",
                reason=why("level"),
                errors=chosen.errors.get("level", {}),
            ),
            Part(
                part="integrator",
                included=True,
                choice=f"{offer.name} ({offer.package} {offer.version})",
                resolution=f"relative tolerance {dynamics.relative_tolerance:g}",
                reason=why("integrator"),
            ),
        ]
    drags = list(assembly.cage.drags)
    parts += [
        Part(part="drag", included=True, choice=model.name, resolution=model.equation, reason="cage.drag names it")
        for model in drags
    ]
    if not drags:
        reason = "cage.drag names none: nothing holds the cage back, and without drag there is no slip"
        parts.append(Part(part="drag", included=False, choice="none", resolution="", reason=reason))
    return parts


def _stage(kind: str, model: SliceModel, named: Any) -> Part:
    offer = find(kind, model.name)
    compiled = "compiled" if model.kernel() is not None else "NumPy"
    return Part(
        part=kind,
        included=True,
        choice=f"{model.name} ({offer.package} {offer.version}, {compiled})",
        resolution="every loaded slice",
        reason="the scene names it" if kind in named else "default",
    )


def _inlet(film: FilmModel) -> Part:
    """What heat and want of oil in the inlet do to the film."""
    heating, starvation = film.inlet_heating, film.inlet_starvation
    return Part(
        part="thermal inlet shear",
        included=bool(heating),
        choice=(heating or "isothermal inlet") + (f", starved by a factor of {starvation:g}" if starvation < 1 else ""),
        resolution="every loaded slice" if heating else "",
        reason=f"film model {film.name!r} asks for it" if heating else "the scene does not ask for it",
    )
