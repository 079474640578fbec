"""Measures of damage along a motion: the worst contact at each of some instants, and the worst of all.

- A motion stores force, sliding and spin of every roller. At some of the stored instants each force is spread over the
  slices, the contacts are evaluated with the models of the scene at the temperatures of that instant, and measured.
  Friction is that of these models on every slice, whichever one moved the bearing.
- Where rollers tilt, a force is spread as that of the roller at its place is in the equilibrium under the load of the
  instant, which motions that know a tilt take their loads from; else as over an aligned roller.
- Stored instants are those of even steps, and on either ring those at which forces, sliding and speeds alone let power
  density, energy of a pass or flash be largest, or a film thinnest. Between them nothing is seen: a worst value is at
  least as bad as what is told.
- The worst contacts are measured again with more slices. What that changes by more than the tolerance is told.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import solve_equilibrium
from rollslip.bearing.raceway import RINGS
from rollslip.errors import DomainError, RollslipError
from rollslip.results.dataset import about
from rollslip.studies.answers import Output
from rollslip.studies.surface_damage.model import (
    DESCRIBED,
    OWN,
    Contacts,
    DamageModel,
    damage_of,
    described,
    harm,
    named,
    values_of,
)
from rollslip_studies.friction_curve.study import balanced_load

if TYPE_CHECKING:
    import xarray as xr

Numbers = NDArray[np.int_]

__all__ = ["OVER_MOTION", "over_motion"]

#: Stored instants of even steps that are measured at most, and how many times as many slices the worst contacts have.
_MAX_POINTS = 101
_FINER = 4
#: What is known of damage along a motion.
OVER_MOTION: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "worst": Output(
            "measure ring", OWN, "worst value of a measure of damage", status="worst_status"
        ),
        "worst_time": Output("measure ring", "s", "when it was", status="worst_status"),
        "worst_angle": Output(
            "measure ring", "rad", "position of the roller then", status="worst_status"
        ),
        "worst_place": Output(
            "measure ring", "m", "place along the roller then", status="worst_status"
        ),
        "worst_status": Output("measure ring", "1", "what was found of the measure"),
        "worst_over_time": Output(
            "measure ring measured_time",
            OWN,
            "worst value of all contacts at some instants",
            status="worst_status",
        ),
        **DESCRIBED,
    }
)


def over_motion(
    assembly: Assembly, dataset: "xr.Dataset", there: Callable[[int], Assembly]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what `OVER_MOTION` names, and coordinates, of the measures of a scene; nothing where it has none."""
    measures = damage_of(assembly)
    if not measures:
        return {}, {}
    stored = dataset.sizes["time"]
    stored_points = np.linspace(0, stored - 1, min(stored, _MAX_POINTS)).round().astype(int)
    if stored > stored_points.size:
        stored_points = np.union1d(stored_points, _suspects(assembly, dataset))
    shape = len(measures), len(RINGS)
    over = np.full((*shape, stored_points.size), np.nan)
    said = np.full(shape, "", dtype=object)
    found = np.full((4, *shape), np.nan)
    times = dataset["time"].to_numpy()
    angles = dataset["orbit_angle"].to_numpy()
    for n, instant in enumerate(stored_points.tolist()):
        at = there(instant)
        now = dataset.isel(time=instant)
        try:
            tilted = _tilted(at, now)
        except RollslipError as error:
            said[:] = str(error)
            continue
        for i in range(len(RINGS)):
            try:
                taken = _contacts(at, now.isel(ring=i), i, tilted)
            except DomainError as error:
                said[:, i] = str(error)
                continue
            if taken is None:
                continue
            contacts, owner, column = taken
            for k, model in enumerate(measures):
                try:
                    values = values_of(model, contacts)
                except DomainError as error:  # of one measure; the others have values
                    said[k, i] = str(error)
                    continue
                worst = int(np.argmax(harm(model, values)))
                over[k, i, n] = values[worst]
                if not harm(model, values[worst]) <= harm(model, found[0, k, i]):
                    place = at.position[column[worst]]
                    found[:, k, i] = (
                        values[worst],
                        times[instant],
                        angles[instant, owner[worst]],
                        place,
                    )
    seen = (
        f"{stored_points.size} of {stored} stored instants"
        if stored_points.size < stored
        else "all stored instants"
    )
    for k, i in np.ndindex(*shape):
        if not np.isfinite(over[k, i]).any():
            said[k, i] = said[k, i] or f"no roller is loaded on the {RINGS[i]} ring at {seen}"
            continue
        told = [f"found at {seen}", *([f"at some: {said[k, i]}"] if said[k, i] else [])]
        instant = int(np.searchsorted(times, found[1, k, i]))
        off = _by_slices(there(instant), dataset.isel(time=instant), i, measures[k], found[0, k, i])
        if off > assembly.scene.accuracy.tolerance:
            told.append(f"its slices leave about {100.0 * off:.2g} %")
        said[k, i] = "; ".join(told)
    names = ("worst", "worst_time", "worst_angle", "worst_place")
    return dict(zip(names, found, strict=True)) | described(measures) | {
        "worst_status": said.astype(np.str_),
        "worst_over_time": over,
    }, {
        "measure": named(measures),
        "measured_time": ("measured_time", times[stored_points], about("s", "time")),
    }  # fmt: skip


def _suspects(assembly: Assembly, dataset: "xr.Dataset") -> list[int]:
    """Stored instants, by number, at which a measure may be worst on a ring."""
    found = list[int]()
    for i in range(len(RINGS)):
        ring = dataset.isel(ring=i)
        force, sliding, traction = (
            ring[n].to_numpy() for n in ("normal_force", "sliding_speed", "traction_force")
        )
        rolling = _rolling(assembly, ring, i)
        carries = (force > 0.0) & (rolling > 0.0) & np.isfinite(sliding)
        power = np.abs(traction * sliding)
        slower = np.abs(np.abs(rolling) - 0.5 * np.abs(sliding))
        with np.errstate(divide="ignore", invalid="ignore"):
            width = np.sqrt(force)
            worse = (
                power / width,
                power / slower,
                power / np.sqrt(slower * width),
                force**0.1 / rolling**0.7,
            )
        for measure in worse:
            if carries.any():
                found.append(
                    int(np.nanargmax(np.where(carries, measure, -np.inf))) // force.shape[1]
                )
    return found


def _by_slices(
    assembly: Assembly, now: "xr.Dataset", i: int, model: DamageModel, worst: float
) -> float:
    """How far the worst value of a measure on a ring is off that with more slices, relative to that."""
    slices = _FINER * assembly.slices if assembly.slices > 1 else 1
    fine_bearing = assembly.at(attrs.evolve(assembly.resolution, slices=slices))
    taken = _contacts(fine_bearing, now.isel(ring=i), i, _tilted(fine_bearing, now))
    values = np.zeros(0) if taken is None else values_of(model, taken[0])
    fine = float(values[np.argmax(harm(model, values))]) if values.size else worst
    return abs(worst / fine - 1.0) if fine else 0.0


def _rolling(assembly: Assembly, of: "xr.Dataset", i: int) -> NDArray[np.float64]:
    """Entrainment: the spin of a roller r w and sliding V give r w + V/2 on the inner, r w - V/2 on the outer ring."""
    spin = (
        assembly.kinematics.direction
        * assembly.kinematics.roller_radius
        * of["roller_speed"].to_numpy()
    )
    return np.asarray(spin + (0.5 - i) * of["sliding_speed"].to_numpy())


def _tilted(assembly: Assembly, now: "xr.Dataset") -> NDArray[np.float64] | None:
    """Loads per length [N/m] on both rings in equilibrium at an instant, (2, Z, n); None where no roller tilts."""
    drop = assembly.drop
    if assembly.scene.operation.misalignment == 0.0 and np.allclose(
        drop, drop[::-1], rtol=1e-9, atol=1e-15
    ):
        return None
    turned = (
        assembly.kinematics.direction * float(now["load_direction"])
        if "load_direction" in now
        else 0.0
    )
    given: dict[str, Any] = {
        name: float(now[name]) for name in ("radial_load", "radial_clearance") if name in now
    }
    case = attrs.evolve(
        assembly.load_case(1, assembly.centrifugal_force_at(float(now["cage_speed"]))),
        psi=now["orbit_angle"].to_numpy()[None] - turned,
        **given,
    )
    held = solve_equilibrium(case, assembly.raceways)
    return np.stack((held.inner_load[0], held.outer_load[0]))


def _spread(
    assembly: Assembly, i: int, force: float, as_in: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Load per length [N/m] along a roller under a force [N], in proportion to a load or as along an aligned one."""
    held = 0.0 if as_in is None else float(as_in @ assembly.widths)
    if as_in is None or not held > 0.0:
        return balanced_load(assembly, assembly.raceways[i], force)
    return as_in * (force / held)


def _contacts(
    assembly: Assembly, now: "xr.Dataset", i: int, tilted: NDArray[np.float64] | None = None
) -> tuple[Contacts, NDArray[np.int_], NDArray[np.int_]] | None:
    """Evaluated slices of the loaded rollers on a ring, with the roller and the place of each; None without any."""
    force = now["normal_force"].to_numpy()
    sliding = now["sliding_speed"].to_numpy()
    rolling = _rolling(assembly, now, i)
    carries = np.flatnonzero((force > 0.0) & (rolling > 0.0) & np.isfinite(sliding))
    if not carries.size:
        return None
    raceway = assembly.raceways[i]
    along = [None if tilted is None else tilted[i, j] for j in carries]
    load = np.array(
        [_spread(assembly, i, float(force[j]), of) for j, of in zip(carries, along, strict=True)]
    )
    row, column = np.nonzero(load > 0.0)
    owner = carries[row]
    slices = raceway.evaluate(load[row, column], rolling[owner], sliding[owner])
    return Contacts.of(assembly, RINGS[i], slices), owner, column
