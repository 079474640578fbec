"""Measures of damage along a motion: the worst contact at each of some instants, and the worst of all.

- A motion stores force, sliding and spin of every roller. At some of the stored instants each force is spread over the
  slices as over an aligned roller, the contacts are evaluated with the models of the scene at the temperatures of that
  instant, and measured. Friction is that of these models on every slice, whichever one moved the bearing.
- Between the instants nothing is seen: a worst value is at least as bad as what is told.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS
from rollslip.errors import DomainError
from rollslip.results.dataset import about
from rollslip.studies.answers import Output
from rollslip.studies.surface_damage.model import DESCRIBED, OWN, Contacts, damage_of, described, named, values_of
from rollslip_studies.friction_curve.study import balanced_load

if TYPE_CHECKING:
    import xarray as xr

Numbers = NDArray[np.int_]

__all__ = ["OVER_MOTION", "over_motion"]

#: Stored instants that are measured at most.
_INSTANTS: Final = 101
#: What is known of damage along a motion.
OVER_MOTION: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "worst": Output("measure ring", OWN, "worst value of a measure of damage", status="worst_status"),
        "worst_time": Output("measure ring", "s", "when it was", status="worst_status"),
        "worst_angle": Output("measure ring", "rad", "position of the roller then", status="worst_status"),
        "worst_place": Output("measure ring", "m", "place along the roller then", status="worst_status"),
        "worst_status": Output("measure ring", "1", "what was found of the measure"),
        "worst_over_time": Output(
            "measure ring measured_time", OWN, "worst value of all contacts at some instants", status="worst_status"
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
    instants = np.unique(np.linspace(0, stored - 1, min(stored, _INSTANTS)).round().astype(int))
    shape = len(measures), len(RINGS)
    over, said = np.full((*shape, instants.size), np.nan), np.full(shape, "", dtype=object)
    found = np.full((4, *shape), np.nan)
    times, angles = dataset["time"].to_numpy(), dataset["orbit_angle"].to_numpy()
    for n, instant in enumerate(instants.tolist()):
        at = there(instant)
        for i in range(len(RINGS)):
            try:
                taken = _contacts(at, dataset.isel(time=instant, ring=i), i)
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
                sign = 1.0 if model.worst == "largest" else -1.0
                worst = int(np.argmax(sign * values))
                over[k, i, n] = values[worst]
                if not sign * values[worst] <= sign * found[0, k, i]:
                    place = at.position[column[worst]]
                    found[:, k, i] = values[worst], times[instant], angles[instant, owner[worst]], place
    seen = f"{instants.size} of {stored} stored instants" if instants.size < stored else "all stored instants"
    for k, i in np.ndindex(*shape):
        known = np.isfinite(over[k, i]).any()
        where = f"found at {seen}" if known else f"no roller is loaded on the {RINGS[i]} ring at {seen}"
        said[k, i] = where if not said[k, i] else f"{where}; at some: {said[k, i]}" if known else said[k, i]
    names = ("worst", "worst_time", "worst_angle", "worst_place")
    return dict(zip(names, found, strict=True)) | described(measures) | {
        "worst_status": said.astype(np.str_),
        "worst_over_time": over,
    }, {
        "measure": named(measures),
        "measured_time": ("measured_time", times[instants], about("s", "time")),
    }  # fmt: skip


def _contacts(
    assembly: Assembly, now: "xr.Dataset", i: int
) -> tuple[Contacts, NDArray[np.int_], NDArray[np.int_]] | None:
    """Evaluated slices of the loaded rollers on a ring, with the roller and the place of each; None without any.

    The spin of a roller r w and sliding V give the entrainment r w + V/2 on the inner, r w - V/2 on the outer ring.
    """
    force, sliding = now["normal_force"].to_numpy(), now["sliding_speed"].to_numpy()
    spin = assembly.kinematics.direction * assembly.kinematics.roller_radius * now["roller_speed"].to_numpy()
    rolling = spin + (0.5 - i) * sliding
    carries = np.flatnonzero((force > 0.0) & (rolling > 0.0) & np.isfinite(sliding))
    if not carries.size:
        return None
    raceway = assembly.raceways[i]
    load = np.array([balanced_load(assembly, raceway, float(force[j])) for j in carries])
    row, column = np.nonzero(load > 0.0)
    owner = carries[row]
    slices = raceway.evaluate(load[row, column], rolling[owner], sliding[owner])
    return Contacts.of(assembly, RINGS[i], slices), owner, column
