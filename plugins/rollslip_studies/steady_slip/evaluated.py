"""What other studies take of a steady slip: the resolution of its torques, and slices evaluated there."""

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.regimes import LIGHT, film_by_regime, groups, moes_groups
from rollslip.studies.answers import LoadedSlices, ResolutionChoice
from rollslip.studies.study import Study
from rollslip_studies.effective_friction.raceways import regime_variables, unloaded

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly
    from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance

#: Tolerance of the slip of the largest drag, where nothing depends on it.
_ANY_SLIP: Final = 0.1
#: Relative step of a slip by which an excess is differentiated, and how many of them to either side what goes with the
#: slip is taken to be linear.
STEP: Final = 1e-3
_FAR: Final = 30.0


def estimate_torques(study: Study, assembly: "Assembly", *, cheaper_laws: bool) -> ResolutionChoice:
    """Choose slices, instants and laws by torques alone: at which slip the largest of them is does not matter."""
    accuracy = attrs.evolve(assembly.scene.accuracy, critical_slip=_ANY_SLIP)
    there = attrs.evolve(assembly, scene=attrs.evolve(assembly.scene, accuracy=accuracy))
    found = study.choose_resolution(there, cheaper_laws=cheaper_laws)
    errors = {part: {of: error for of, error in some.items() if of != "critical_slip"} for part, some in
              found.errors.items()}  # fmt: skip
    return attrs.evolve(found, errors=errors)


def evaluated_slices(balance: "TorqueBalance", orbits: "Iterable[Orbit]") -> list[LoadedSlices]:
    """Return the loaded slices of both rings in some motions of the rollers."""
    found = []
    for orbit in orbits:
        for ring, contacts in zip(RINGS, balance.evaluated(orbit), strict=True):
            s = contacts.slices
            found.append(
                LoadedSlices(
                    0,
                    ring,
                    s.load,
                    s.rolling_speed,
                    s.sliding_speed,
                    contacts.force,
                    contacts.places,
                )
            )
    return found


def by_secant(
    balance: "TorqueBalance",
    slip: float,
    of: "Callable[[Orbit], Array]",
    fraction: float | None = None,
) -> tuple[float, Array]:
    """Return by how much a steady slip is off that of another balance, relative, and what goes with the slip there.

    Both by one secant, from the motions on the way up or from that of a share of the slip at the first position.
    """
    slips = slip * np.array([1.0, 1.0 + STEP])
    if fraction is None:
        orbits = [balance.orbit(one) for one in slips.tolist()]
    else:
        orbits = [
            balance.orbit_of(each[0]) for each in balance.motions.at(slips, np.full(2, fraction))
        ]
    over, more = (orbit.torque + balance.drag(orbit.cage_slip) for orbit in orbits)
    steps = over / (over - more) if more != over else math.inf
    here, beside = (of(orbit) for orbit in orbits)
    return STEP * abs(steps), here + min(max(steps, -_FAR), _FAR) * (beside - here)


def loaded(assembly: "Assembly") -> "Assembly":
    """Refuse a bearing in which nothing drives the rollers; else the difference of two roundings would."""
    if not assembly.load_distribution(2).inner_force.any():
        raise unloaded(assembly.scene, "nothing drives the cage")
    return assembly


def films(
    study: Study, balance: "TorqueBalance", states: "list[Orbit]", *, steady: bool
) -> dict[str, Any]:
    """Film regimes of the contacts over the orbits, and their smallest film parameter."""
    n = len(states)
    fraction = np.zeros((2, 4))
    light = np.zeros(2)
    largest = np.zeros(2)
    thinnest = np.full((2, n), np.nan)
    for k, state in enumerate(states):
        for i, contacts in enumerate(balance.evaluated(state)):
            if contacts.total == 0.0:
                continue
            slices = contacts.slices
            force = contacts.force / contacts.total
            thinnest[i, k] = slices.film_thickness.min() / slices.conditions.roughness
            code = film_by_regime(*groups(slices))[1].astype(int)
            fraction[i] += np.bincount(code, weights=force, minlength=4) / n
            M = moes_groups(slices)[0]
            largest[i] = max(largest[i], M.max())
            light[i] += force[M < LIGHT].sum() / n
    where = ", at the steady slips" if steady else ", over the range of slips"
    found = regime_variables(fraction, largest, light, where)
    if steady:
        found |= study.variables(film_parameter=thinnest)
    return found
