"""The plan: what will be modelled of a scene, with which model, how finely, what is left out, and why.

It is made before anything runs and executed as printed: a run takes its studies and its bound models from it.
"""

import time
from collections.abc import Mapping
from typing import Any

import attrs
import numpy as np

from rollslip.assembly import Assembly, assemble
from rollslip.dynamics import LEVELS, Dynamics
from rollslip.equilibrium import LoadDistribution
from rollslip.errors import DomainError
from rollslip.inventory import check_required
from rollslip.models import FilmModel, SliceModel
from rollslip.reading import Where, load_scene
from rollslip.registry import find
from rollslip.scene import Scene
from rollslip.studies import Study, settings


@attrs.frozen(kw_only=True)
class Part:
    """One line of the plan."""

    part: str
    included: bool
    choice: str
    resolution: str
    reason: str


@attrs.frozen(eq=False, kw_only=True)
class Plan:
    """What will be modelled: the bound bearing, the studies with their settings, and the reasons, line by line."""

    scene: Scene
    assembly: Assembly
    studies: dict[str, Study]
    parts: tuple[Part, ...]
    degrees_of_freedom: int
    evaluations: int
    seconds: float

    @property
    def models(self) -> tuple[tuple[str, Any], ...]:
        """Kind and model of all that is used, each once: those of a contact first."""
        studies = (pair for study in self.studies.values() for pair in study.models(self.assembly))
        return tuple(dict.fromkeys((*self.assembly.models.items(), *studies)))

    def as_dict(self) -> dict[str, Any]:
        """Return the plan as plain values, for JSON."""
        return {
            "scene": self.scene.source,
            "studies": {name: attrs.asdict(study) for name, study in self.studies.items()},
            "parts": [attrs.asdict(part) for part in self.parts],
            "degrees_of_freedom": self.degrees_of_freedom,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
        }


def plan(scene: Scene | str, study: str | None = None) -> Plan:
    """Plan a scene.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of a shipped one, or a file.
    study : str, optional
        Only this study, with the scene's settings or its defaults.

    Raises
    ------
    SceneError
        If the scene is wrong; all faults that can be found at once.
    PluginError
        If a package it requires or a model it names is missing or broken.
    """
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    check_required(scene.plugins.require, Where(scene.origins, ("plugins", "require")))
    studies = settings(scene, study)
    assembly = assemble(scene)
    bearing, tilted = scene.bearing, scene.operation.misalignment != 0.0
    averaged = bool({"effective-friction", "steady-slip", "dynamics"} & studies.keys())
    loads = assembly.load_distribution(1) if averaged else None
    evaluations = sum(one.evaluations(assembly) for one in studies.values())
    named = dict(scene.raw or {}).get("models", {})
    parts = [_stage(kind, model, named) for kind, model in assembly.models.items()]
    parts.append(
        Part(
            part="viscosity at pressure",
            included=True,
            choice=assembly.lubricant.pressure_viscosity_law.name,
            resolution="every loaded slice",
            reason=f"the law of the oil, {assembly.lubricant.name}",
        )
    )
    if assembly.slices == 1:
        parts.append(
            Part(
                part="slices",
                included=False,
                choice="one slice per contact",
                resolution="1",
                reason="straight rollers and aligned rings load a contact evenly along its length",
            )
        )
    else:
        why = " and ".join(["the profile"] * (bearing.profile.shape != "none") + ["the misalignment"] * tilted)
        parts.append(
            Part(
                part="slices",
                included=True,
                choice=f"profile {bearing.profile.shape}",
                resolution=f"{assembly.slices} equal slices",
                reason=f"{why} loads a contact unevenly along its length",
            )
        )
    if loads is not None:
        loaded = int(np.count_nonzero(loads.inner_force[0]))
        parts += [
            Part(
                part="load distribution",
                included=True,
                choice="quasi-static equilibrium of ring and rollers",
                resolution=f"{bearing.rollers} rollers; instants doubled until the curve moves by less than "
                f"{scene.accuracy.tolerance:g}",
                reason="one revolution is much shorter than the cage's transient",
            ),
            Part(
                part="unloaded contacts",
                included=False,
                choice="no friction stage",
                resolution=f"{bearing.rollers - loaded} of {bearing.rollers} on the inner ring",
                reason="they carry nothing, and averaging them in would be wrong",
            ),
        ]
    if assembly.traction.full_film_from is not None:
        slip = max(study.largest_cage_slip for study in studies.values())
        parts.append(_boundary(assembly, assembly.traction.full_film_from, loads, slip))
    parts += [_inlet(assembly.film), *_motion(assembly, studies)]
    return Plan(
        scene=scene,
        assembly=assembly,
        studies=studies,
        parts=tuple(parts),
        degrees_of_freedom=_degrees_of_freedom(assembly, studies),
        evaluations=evaluations,
        seconds=evaluations * _seconds_per_slice(assembly),
    )


def _degrees_of_freedom(assembly: Assembly, studies: Mapping[str, Study]) -> int:
    """Of the largest system that is solved: the bearing in motion, or at rest."""
    dynamics = studies.get("dynamics")
    if isinstance(dynamics, Dynamics):
        return dynamics.degrees_of_freedom(assembly)
    if studies.keys() & {"effective-friction", "steady-slip"}:
        return 2 + (2 if assembly.slices > 1 else 1) * assembly.scene.bearing.rollers
    return 0


def _motion(assembly: Assembly, studies: Mapping[str, Study]) -> list[Part]:
    """Cage, drags and integrator, where a study asks for them."""
    dynamics = studies.get("dynamics")
    if dynamics is None and "steady-slip" not in studies:
        reason = "the scene has no study of cage and rollers in motion"
        return [
            Part(part="cage, drag and integrators", included=False, choice="not loaded", resolution="", reason=reason)
        ]
    parts = []
    if isinstance(dynamics, Dynamics):
        offer = find("integrator", dynamics.method(assembly).name)
        parts += [
            Part(
                part="motion",
                included=True,
                choice=f"level {dynamics.level}, friction {dynamics.friction}",
                resolution=f"{dynamics.degrees_of_freedom(assembly)} unknowns for {dynamics.duration:g} s",
                reason=LEVELS[dynamics.level],
            ),
            Part(
                part="integrator",
                included=True,
                choice=f"{offer.name} ({offer.package} {offer.version})",
                resolution=f"relative tolerance {dynamics.relative_tolerance:g}",
                reason="study.dynamics",
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


def _boundary(assembly: Assembly, limit: float, loads: LoadDistribution | None, slip: float) -> Part:
    """Whether friction of the boundary kind is expected: by the thinnest film at either end of the slips."""
    load = (
        max(loads.inner_load.max(), loads.outer_load.max())
        if loads is not None
        else assembly.scene.operation.radial_load / assembly.scene.bearing.roller_length
    )
    speeds = assembly.kinematics.surface_speeds(np.array([0.0, slip]), 0.0)
    try:
        thinnest = min(
            float(raceway.evaluate(np.full(2, load), u, 0.0).film_thickness.min()) / raceway.conditions.roughness
            for raceway, u in zip(assembly.raceways, (speeds.inner_rolling, speeds.outer_rolling), strict=True)
        )
    except DomainError:
        thinnest = np.nan
    needed = not thinnest >= limit
    found = (
        f"up to a cage slip of {slip:g} the smallest film parameter is {thinnest:.3g}, "
        f"{'below' if needed else 'above'} the limit of the full film, {limit:g}"
        if not np.isnan(thinnest)
        else "the film cannot be told before the run"
    )
    return Part(
        part="boundary friction",
        included=needed,
        choice="evaluated only on slices that need it",
        resolution="",
        reason=found,
    )


def _seconds_per_slice(assembly: Assembly) -> float:
    """Time of the chain per slice on this machine, measured on a thousand slices."""
    speeds = assembly.kinematics.surface_speeds(0.05, 0.0)
    load = np.full(1000, 1e4)
    begin = time.perf_counter()
    assembly.inner.evaluate(load, speeds.inner_rolling, speeds.inner_sliding)
    return (time.perf_counter() - begin) / load.size
