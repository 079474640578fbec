"""The answer of ``rollslip info`` on a scene: film, pressure, ratings, speeds and clearance, without a run."""

import math

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.equilibrium import is_loaded
from rollslip.bearing.raceway import Raceway
from rollslip.planning.plausibility import implausible
from rollslip.results.answer import Answer, Row
from rollslip.results.text import (
    describe_operation,
    format_force,
    small_load_notes,
    two_digits,
)
from rollslip.scene.values import Scene
from rollslip.studies.rating_life.equivalent_load import static_equivalent_load
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
    bearing = scene.bearing
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
    summary = [f"Lambda {row.text}" for row in rows if row.key == "film_parameter"]
    pressures = [row.text for row in rows if row.key == "pressure"]
    kappa, viscosity = duty.viscosity_ratio
    text = "unknown"
    if math.isfinite(kappa):
        text = two_digits(kappa)
        viscosity = f"{two_digits(1e3 * duty.viscosity)} mPa s"
        summary.append(f"kappa {text}")
    rows.append(Row(key="kappa", label="kappa", value=kappa, text=text, note=viscosity))
    load = static_equivalent_load(scene)
    if load > 0.0:
        safety = bearing.static_rating / load
        note = f"C0 {format_force(bearing.static_rating, bearing.static_rating)} after ISO 76"
        rows.append(Row(key="C0/P", label="C0/P", value=safety, text=two_digits(safety), note=note))
    speed_factor = duty.revolutions * 1e3 * duty.pitch_diameter
    force = float(loads.inner_force.max())
    loaded = int(np.count_nonzero(is_loaded(loads.inner_force[0])))
    cage = kinematics.epicyclic_cage_speed
    rollers = format_quantity(kinematics.epicyclic_roller_speed, "rad/s", 3)
    rows += [
        Row(
            key="n_dm",
            label="n dm",
            value=speed_factor,
            text=two_digits(speed_factor),
            note="mm/min",
        ),
        Row(
            key="loaded_rollers",
            label="rollers loaded",
            value=loaded,
            text=f"{loaded} of {bearing.rollers}",
            note=f"{format_force(force, force)} at most, on the inner ring",
        ),
        Row(
            key="cage_speed",
            label="cage speed",
            value=cage,
            unit="rad/s",
            text=format_quantity(cage, "rad/s", 3),
            note=f"without slip; rollers {rollers}",
        ),
    ]
    if bearing.contact_angle is None:
        rows.append(
            Row(
                key="clearance",
                label="radial clearance",
                value=bearing.radial_clearance,
                unit="m",
                text=f"{two_digits(1e6 * bearing.radial_clearance)} µm",
                note=str(bearing.mounted or "").partition(" = ")[0],
            )
        )
    return Answer(
        summary=", ".join(summary + pressures),
        rows=tuple(rows),
        case=(
            scene.source,
            assembly.lubricant.name,
            *describe_operation(attrs.asdict(scene.operation, recurse=False)).values(),
        ),
        faults=tuple(small_load_notes(implausible(scene))),
        next=commands,
    )


def _contact_rows(assembly: Assembly, largest: dict[str, tuple[float, float]]) -> list[Row]:
    """Return rows of the most loaded contacts, by rolling speed [m/s] and load per length [N/m] of each ring."""
    films = dict[str, float]()
    pressures = dict[str, float]()
    for raceway in assembly.raceways:
        rolling, load = largest[raceway.ring]
        if load > 0.0:
            slices = heaviest_contact(assembly, raceway, rolling, load)
            films[raceway.ring] = float(slices.film_thickness[0]) / raceway.conditions.roughness
            pressures[raceway.ring] = float(slices.pressure[0])
    if not films:
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
