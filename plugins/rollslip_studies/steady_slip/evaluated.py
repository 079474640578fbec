"""What other studies take of a steady slip: the resolution of its torques, and slices evaluated there."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

import attrs

from rollslip.bearing.raceway import RINGS
from rollslip.studies.answers import Estimated, Evaluated
from rollslip.studies.study import Study
from rollslip_studies.effective_friction.raceways import unloaded

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly
    from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance

#: Tolerance of the slip of the largest drag, where nothing depends on it.
_ANY_SLIP: Final = 0.1


def estimate_torques(study: Study, assembly: "Assembly", *, cheaper_laws: bool) -> Estimated:
    """Choose slices, instants and laws by torques alone: at which slip the largest of them is does not matter."""
    accuracy = attrs.evolve(assembly.scene.accuracy, critical_slip=_ANY_SLIP)
    there = attrs.evolve(assembly, scene=attrs.evolve(assembly.scene, accuracy=accuracy))
    found = study.estimate(there, cheaper_laws=cheaper_laws)
    errors = {part: {of: error for of, error in some.items() if of != "critical_slip"} for part, some in
              found.errors.items()}  # fmt: skip
    return attrs.evolve(found, errors=errors)


def evaluated_slices(balance: "TorqueBalance", orbits: "Iterable[Orbit]") -> list[Evaluated]:
    """Return the loaded slices of both rings in some motions of the rollers."""
    found = []
    for orbit in orbits:
        for ring, contacts in zip(RINGS, balance.evaluated(orbit), strict=True):
            s = contacts.slices
            found.append(Evaluated(0, ring, s.load, s.rolling_speed, s.sliding_speed, contacts.force, contacts.places))
    return found


def loaded(assembly: "Assembly") -> "Assembly":
    """Refuse a bearing in which nothing drives the rollers; else the difference of two roundings would."""
    if not assembly.load_distribution(2).inner_force.any():
        raise unloaded(assembly.scene, "nothing drives the cage")
    return assembly
