"""The plan: what will be modelled of a scene, with which model, how finely, what is left out, and why.

It is made before anything runs and executed as printed: a run takes its studies and its bound models from it.
"""

import time
from typing import Any

import attrs
import numpy as np

from rollslip.assembly import Assembly, assemble
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
    effective = "effective-friction" in studies
    loads = assembly.load_distribution(1) if effective else None
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
    parts += [
        _inlet(assembly.film),
        Part(
            part="cage, drag and integrators",
            included=False,
            choice="not loaded",
            resolution="",
            reason="the scene has no study in time",
        ),
    ]
    return Plan(
        scene=scene,
        assembly=assembly,
        studies=studies,
        parts=tuple(parts),
        degrees_of_freedom=2 + (2 if assembly.slices > 1 else 1) * bearing.rollers if effective else 0,
        evaluations=evaluations,
        seconds=evaluations * _seconds_per_slice(assembly),
    )


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
