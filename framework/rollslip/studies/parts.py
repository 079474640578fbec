"""The lines of a plan that several studies have: slices, loads, what is left out, tables and steps."""

import contextlib
from collections.abc import Mapping

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.resolution import Errors, tilting
from rollslip.errors import RollslipError
from rollslip.scene.rings import ring_flexibility
from rollslip.studies.answers import Part, ResolutionChoice


def resolution_reason(assembly: Assembly, estimated: ResolutionChoice) -> str:
    """Return why the numbers of slices and roller positions were chosen."""
    if estimated.failed:
        return f"there are no estimates: {estimated.failed}"
    if estimated.refinement_reason:
        return f"{estimated.refinement_reason}, so it was run again"
    tolerances = " and ".join(
        f"{assembly.scene.accuracy.of(result):g} ({result.replace('_', ' ')})"
        for result in estimated.total
    )
    return (
        f"the fewest whose estimated error keeps {tolerances}"
        if tolerances
        else "the finest of all"
    )


def slices(assembly: Assembly, errors: Errors, why: str) -> Part:
    """Return the line on the slices of a contact along the roller."""
    scene = assembly.scene
    resolution = assembly.resolution
    bearing = scene.bearing
    if assembly.slices == 1:
        return Part(
            part="slices",
            included=False,
            choice="one slice per contact",
            resolution="1",
            reason="straight rollers and aligned rings load a contact evenly along its length",
        )
    uneven = " and ".join(
        ["the profile"] * (bearing.profile.shape != "none")
        + [tilting(scene)] * bool(tilting(scene))
    )
    points = "equal slices" if resolution.quadrature == "equal" else "points of Gauss and Legendre"
    if scene.accuracy.slices is not None:
        why = "accuracy.slices fixes their number"
    return Part(
        part="slices",
        choice=f"profile {bearing.profile.shape}",
        resolution=f"{assembly.slices} {points}",
        reason=f"{uneven} loads a contact unevenly along its length; {why}",
        errors=errors,
    )


def loads(assembly: Assembly, errors: Errors, why: str, seconds: float | None) -> list[Part]:
    """Return the lines on the distribution of the load over rollers and positions, and on unloaded rollers."""
    bearing = assembly.scene.bearing
    n_positions = assembly.resolution.n_positions
    doubled = f"roller positions doubled until the curve changes by less than {assembly.scene.accuracy.tolerance:g}"
    loaded = int(np.count_nonzero(assembly.load_distribution(1).inner_force[0]))
    return [
        Part(
            part="load distribution",
            choice="quasi-static equilibrium of ring and rollers"
            + (", with the films between them" if assembly.inner.gap > 0.0 else ""),
            resolution=f"{bearing.rollers} rollers, "
            + (f"{n_positions} roller positions within a pitch" if n_positions else doubled),
            reason=f"one revolution is much shorter than the cage's transient; {why}",
            errors=errors,
            seconds=seconds,
        ),
        Part(
            part="unloaded contacts",
            included=False,
            choice="no friction stage",
            resolution=f"{bearing.rollers - loaded} of {bearing.rollers} on the inner ring",
            reason="they carry nothing, and averaging them in would be wrong",
        ),
    ]


def friction(assembly: Assembly, estimated: ResolutionChoice) -> list[Part]:
    """Return the lines on boundary friction, on parts left out of a contact, and on a closed form in place of a law."""
    resolution = assembly.resolution
    errors = estimated.errors
    lines = list[Part]()
    limit = assembly.at(attrs.evolve(resolution, boundary=True)).traction.full_film_from
    if limit is not None:
        state = "whether all films are full was not looked at"
        if not resolution.boundary:
            state = "it is checked at every evaluation, and boundary friction is reinstated where a film falls below it"
        elif estimated.compared_laws:
            state = "at the ends of the slips a film parameter is below it"
        lines.append(
            Part(
                part="boundary friction",
                included=resolution.boundary,
                choice="evaluated only on slices that need it",
                reason=f"a film is full from a film parameter of {limit:g}; {state}",
            )
        )
    for name, part, choice in (
        ("inlet_heating", "thermal inlet shear", assembly.film.name),
        ("light_contacts", "pressure", "hertz"),
    ):
        if name in errors:
            lines.append(
                Part(
                    part=part,
                    included=False,
                    choice=choice,
                    reason=f"without it results change by {errors[name]['friction']:.1g} at most, less than its "
                    "fraction of the tolerance; its bound is checked at every evaluation, and it is reinstated beyond",
                    errors=errors[name],
                )
            )
    if "law" in errors:
        lines.append(
            Part(
                part="law of the full film",
                choice=assembly.traction.full_film.name,
                resolution="every loaded slice",
                reason="replaces the law that the scene names; both differ by less than its fraction of the tolerance",
                errors=errors["law"],
            )
        )
    return lines


def tables(assembly: Assembly, errors: Errors, seconds: float | None) -> Part:
    """Return the line on the tables of a bearing in motion."""
    return Part(
        part="tables",
        choice="loads over the orbit, effective friction, slip-drag curve",
        resolution=f"error {assembly.resolution.table_tolerance:.1e}",
        reason="nodes are added until it is kept",
        errors=errors,
        seconds=seconds,
    )


def other_costs(costs: Mapping[str, float], meanings: Mapping[str, str]) -> list[Part]:
    """Return a line for each other part of the cost.

    Parameters
    ----------
    costs : mapping of str to float
        Part -> time [s].
    meanings : mapping of str to str
        Part -> what it is, and its resolution behind a bar.
    """
    lines = []
    for part, seconds in costs.items():
        reason, _, resolution = meanings.get(part, "a part of the study").partition("|")
        lines.append(
            Part(part=part, choice="", resolution=resolution, reason=reason, seconds=seconds)
        )
    return lines


def rings(assembly: Assembly) -> Part:
    """Return the line on flexible rings, with how much they change the loads of rollers, or would change them."""
    scene = assembly.scene
    both = assembly.rings
    effect = ""
    stated = {} if both is None else both.flexible_rings
    with contextlib.suppress(RollslipError):  # no plugin, or no room for a ring
        bare, seated = ring_flexibility(scene.bearing, scene.operation.radial_load, stated=stated)
        effect = f"flexible rings change the loads of rollers by about {100 * seated.change:.2g} %"
        numbers = str(seated)
        if len(stated) < 2:
            effect += f" in their seats, {100 * bare.change:.2g} % bare"
            numbers = f"in their seats {seated}; bare {bare}"
        if not bare.change > scene.accuracy.tolerance:
            effect += ", less than accuracy.tolerance"
        effect += f"; {numbers}"  # reports show what stands before a semicolon
    if both is None:
        return Part(
            part="flexible rings",
            included=False,
            choice="rigid, round",
            reason=effect or "none is named",
        )
    chosen = (("inner", scene.models.inner_ring), ("outer", scene.models.outer_ring))
    formed = len(both.waves) + len(both.tables)
    reason = "one equilibrium of roller loads, bending of the rings and form of the raceways"
    return Part(
        part="rings",
        choice=", ".join(
            f"{ring} {'rigid' if model is None else model.name}" for ring, model in chosen
        ),
        resolution=f"{both.parity.size} shapes of bending, {formed} parts of forms",
        reason="; ".join(filter(None, (reason, effect))),
        errors={"friction": both.left} if both.left else {},
    )
