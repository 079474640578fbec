"""The answer of ``rollslip info`` on a scene: film, pressure, ratings, speeds and clearance, without a run."""

import math

import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.equilibrium import is_loaded
from rollslip.bearing.raceway import Raceway
from rollslip.planning.plausibility import implausible
from rollslip.results.answer import Answer, Row
from rollslip.results.text import (
    force_unit,
    format_force,
    format_plain,
    small_load_notes,
    two_digits,
)
from rollslip.scene.values import Scene
from rollslip.studies.steady_slip.torque import Duty
from rollslip.units import format_quantity
from rollslip_kernels.slices import Slices

__all__ = ["heaviest_contact", "scene_answer"]


def heaviest_contact(assembly: Assembly, raceway: Raceway, rolling: float, load: float) -> Slices:
    """Return the evaluated slice with the largest load on a raceway, without slip.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    raceway : Raceway
        One of its raceways.
    rolling : float
        Rolling speed there [m/s].
    load : float
        Load of the slice per length [N/m].
    """
    places = assembly.places(raceway.ring, np.zeros(1), np.zeros(1)) | {"position": 0.0}
    return raceway.evaluate(np.array([load]), rolling, 0.0, **places)


def scene_answer(scene: Scene, commands: tuple[str, ...]) -> Answer:
    """Return Lambda, kappa, pressure, C0/P, n dm, loaded rollers, cage speed and clearance of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    commands : tuple of str
        Commands for the next step.
    """
    assembly = assemble(scene)
    operation = scene.operation
    kinematics = assembly.kinematics
    duty = Duty.of(assembly)
    loads = assembly.load_distribution()
    speeds = kinematics.surface_speeds(0.0, 0.0)
    rows = _contact_rows(
        assembly,
        {
            "inner": (float(speeds.inner_rolling), float(loads.inner_load.max())),
            "outer": (float(speeds.outer_rolling), float(loads.outer_load.max())),
        },
    )
    kappa, status = duty.viscosity_ratio
    is_known = math.isfinite(kappa)
    text = two_digits(kappa) if is_known else "unknown"
    viscosity = f"{two_digits(1e3 * duty.viscosity)} mPa s" if is_known else status
    rows.append(Row(key="kappa", label="kappa", value=kappa, text=text, note=viscosity))
    rating = scene.bearing.static_rating
    load = operation.radial_load
    if load > 0.0:
        note = f"C0 {format_force(rating, rating)} after ISO 76"
        rows.append(
            Row(
                key="C0/P",
                label="C0/P",
                value=rating / load,
                text=two_digits(rating / load),
                note=note,
            )
        )
    speed_factor = duty.revolutions * 1e3 * duty.pitch_diameter
    rows.append(
        Row(
            key="n_dm",
            label="n dm",
            value=speed_factor,
            text=two_digits(speed_factor),
            note="mm/min",
        )
    )
    force = float(loads.inner_force.max())
    loaded = int(np.count_nonzero(is_loaded(loads.inner_force[0])))
    rows.append(
        Row(
            key="loaded_rollers",
            label="rollers loaded",
            value=loaded,
            text=f"{loaded} of {scene.bearing.rollers}",
            note=f"{format_force(force, force)} at most, on the inner ring",
        )
    )
    cage = kinematics.epicyclic_cage_speed
    rollers = format_quantity(kinematics.epicyclic_roller_speed, "rad/s", 3)
    rows.append(
        Row(
            key="cage_speed",
            label="cage speed",
            value=cage,
            unit="rad/s",
            text=format_quantity(cage, "rad/s", 3),
            note=f"without slip; rollers {rollers}",
        )
    )
    clearance = scene.bearing.radial_clearance
    mounted = scene.bearing.mounted
    rows.append(
        Row(
            key="clearance",
            label="radial clearance",
            value=clearance,
            unit="m",
            text=f"{two_digits(1e6 * clearance)} µm",
            note="" if mounted is None else str(mounted).partition(" = ")[0],
        )
    )
    films = [row for row in rows if row.key == "film_parameter"]
    summary = [f"Lambda {row.text}" for row in films] + [f"kappa {text}"] * is_known
    summary += [row.text for row in rows if row.key == "pressure"]
    unit, factor = force_unit(load)
    speed = operation.inner_speed * 30.0 / math.pi
    outer = operation.outer_speed * 30.0 / math.pi
    return Answer(
        summary=", ".join(summary),
        rows=tuple(rows),
        case=(
            scene.source,
            assembly.lubricant.name,
            f"{format_plain(speed)} rpm"
            + (f" (outer ring {format_plain(outer)} rpm)" if outer else ""),
            f"{format_plain(load * factor)} {unit}",
            f"{format_plain(operation.temperature - 273.15)} °C",
        ),
        faults=tuple(small_load_notes(implausible(scene))),
        next=commands,
    )


def _contact_rows(assembly: Assembly, largest: dict[str, tuple[float, float]]) -> list[Row]:
    """Return rows of the most loaded contacts, by rolling speed [m/s] and load per length [N/m] of each ring."""
    found = {
        raceway.ring: (heaviest_contact(assembly, raceway, *largest[raceway.ring]), raceway)
        for raceway in assembly.raceways
        if largest[raceway.ring][1] > 0.0
    }
    films = {
        ring: float(slices.film_thickness[0]) / raceway.conditions.roughness
        for ring, (slices, raceway) in found.items()
    }
    pressures = {ring: float(slices.pressure[0]) for ring, (slices, _) in found.items()}
    if not found:
        return []
    thinnest = min(films, key=films.__getitem__)
    highest = max(pressures, key=pressures.__getitem__)
    return [
        Row(
            key="film_parameter",
            label="Lambda",
            value=films[thinnest],
            text=two_digits(films[thinnest]),
            note=f"{thinnest} ring, most loaded contact",
        ),
        Row(
            key="pressure",
            label="mean pressure",
            value=pressures[highest],
            unit="Pa",
            text=f"{two_digits(1e-6 * pressures[highest])} MPa",
            note=f"{highest} ring, most loaded contact",
        ),
    ]
