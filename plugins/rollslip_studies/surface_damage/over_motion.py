"""Evaluate measures of damage along a motion: the worst contact at each of some times, and the worst of all.

1. Select stored times: evenly spread ones, and on either ring those at which force, sliding and speed alone make power
   density, energy per pass or flash temperature largest, or the film thinnest.
2. Distribute the stored force of each roller over its slices: where rollers tilt, as in the static equilibrium under
   the load of that time, from which motions with tilted rollers have their loads; else as over an aligned roller.
3. Evaluate the contacts with the models of the scene at the temperatures of that time, and measure them. The friction
   is that of these models on every slice, also if the motion was integrated with effective or constant friction.
4. Measure the worst contacts once more with four times as many slices; a difference beyond the tolerance is reported.

Values between the selected times are not known: the true worst value is at least as bad as the reported one.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.equilibrium import solve_equilibrium
from rollslip.bearing.raceway import RINGS
from rollslip.errors import DomainError, RollslipError
from rollslip.results.dataset import about, xr
from rollslip.results.text import Status
from rollslip.studies.answers import Output
from rollslip.studies.bounds import SLICE_FACTOR
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

Numbers = NDArray[np.int_]

__all__ = ["OVER_MOTION", "over_motion"]

#: Largest number of evenly spread stored times that are measured. Doubled, measures take twice as long and miss less
#: between them. Chosen; step 1 adds the times that matter.
_MAX_POINTS = 101
#: Relative difference of the profile of a roller from its mirror image that is rounding.
_ROUNDING = 1e-9
#: The same, absolute [m]: far below the radius of an atom.
_MIN_DROP = 1e-15
#: Outputs about damage along a motion.
OVER_MOTION: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "worst": Output(
            "measure ring", OWN, "worst value of a measure of damage", status="worst_status"
        ),
        "worst_time": Output("measure ring", "s", "time of the worst value", status="worst_status"),
        "worst_angle": Output(
            "measure ring",
            "rad",
            "orbital position of the roller with the worst value",
            status="worst_status",
        ),
        "worst_place": Output(
            "measure ring",
            "m",
            "position of the worst value along the roller",
            status="worst_status",
        ),
        "worst_status": Output("measure ring", "1", "status of the measure"),
        "worst_over_time": Output(
            "measure ring measured_time",
            OWN,
            "worst value of all contacts at some times",
            status="worst_status",
        ),
        **DESCRIBED,
    }
)


@attrs.frozen(eq=False)
class _WorstValues:
    """Worst values of the measures on both rings, filled in while the times are measured."""

    over_time: NDArray[np.float64]  #: Worst value at each measured time, (measures, rings, times).
    #: Worst value of all times, its time [s], angle [rad] and place along the roller [m], (4, measures, rings).
    extremes: NDArray[np.float64]
    problems: NDArray[Any]  #: Last error of a law or measure, empty without, (measures, rings).

    def measure(
        self, measures: Sequence[DamageModel], bearing: Assembly, state: "xr.Dataset", n: int
    ) -> None:
        """Measure the contacts of a stored time, the n-th of those that are measured."""
        try:
            tilted = _tilted_loads(bearing, state)
        except RollslipError as error:
            self.problems[:] = str(error)
            return
        for i in range(len(RINGS)):
            try:
                loaded = _contacts(bearing, state.isel(ring=i), i, tilted)
            except DomainError as error:
                self.problems[:, i] = str(error)
                continue
            if loaded is None:
                continue
            contacts, owner, column = loaded
            for k, model in enumerate(measures):
                try:
                    values = values_of(model, contacts)
                except DomainError as error:  # the other measures may have values
                    self.problems[k, i] = str(error)
                    continue
                worst = int(np.argmax(harm(model, values)))
                self.over_time[k, i, n] = values[worst]
                if not harm(model, values[worst]) <= harm(model, self.extremes[0, k, i]):
                    angle = state["orbit_angle"].to_numpy()[owner[worst]]
                    place = bearing.position[column[worst]]
                    self.extremes[:, k, i] = values[worst], float(state["time"]), angle, place


def over_motion(
    assembly: Assembly, dataset: "xr.Dataset", bearing_at: Callable[[int], Assembly]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the variables of `OVER_MOTION`, and coordinates; nothing if a scene has no measure of damage.

    Parameters
    ----------
    assembly : Assembly
        The bearing of the scene.
    dataset : xarray.Dataset
        The motion.
    bearing_at : callable
        Returns the bearing at the temperatures of a stored time, by its index.
    """
    if not (measures := damage_of(assembly)):
        return {}, {}
    times = dataset["time"].to_numpy()
    indices = np.linspace(0, times.size - 1, min(times.size, _MAX_POINTS)).round().astype(int)
    selection = "all stored instants"
    if times.size > indices.size:
        indices = np.union1d(indices, _suspects(assembly, dataset))
    shape = len(measures), len(RINGS)
    found = _WorstValues(
        over_time=np.full((*shape, indices.size), np.nan),
        extremes=np.full((4, *shape), np.nan),
        problems=np.full(shape, "", dtype=object),
    )
    for n, index in enumerate(indices.tolist()):
        found.measure(measures, bearing_at(index), dataset.isel(time=index), n)
    if indices.size < times.size:
        selection = f"{indices.size} of {times.size} stored instants"
    status = np.full(shape, "", dtype=object)
    for k, i in np.ndindex(*shape):
        problem = found.problems[k, i]
        if not np.isfinite(found.over_time[k, i]).any():
            status[k, i] = problem or f"no roller is loaded on the {RINGS[i]} ring at {selection}"
            continue
        texts = [f"{Status.FOUND} at {selection}"]
        if problem:
            texts.append(f"at some: {problem}")
        index = int(np.searchsorted(times, found.extremes[1, k, i]))
        error = _slice_error(
            bearing_at(index), dataset.isel(time=index), i, measures[k], found.extremes[0, k, i]
        )
        if error > assembly.scene.accuracy.tolerance:
            texts.append(f"its slices leave about {100.0 * error:.2g} %")
        status[k, i] = "; ".join(texts)
    names = ("worst", "worst_time", "worst_angle", "worst_place")
    variables = dict(zip(names, found.extremes, strict=True)) | described(measures)
    variables["worst_status"] = status.astype(np.str_)
    variables["worst_over_time"] = found.over_time
    return variables, {
        "measure": named(measures),
        "measured_time": ("measured_time", times[indices], about("s", "time")),
    }


def _suspects(assembly: Assembly, dataset: "xr.Dataset") -> list[int]:
    """Return indices of stored times at which measures may be worst on a ring, by proportionalities of line contacts.

    Half width ~ force^0.5 gives, in order: power density, energy per pass of the slower surface, flash temperature
    after Blok, and the reciprocal film thickness after Dowson and Higginson.
    """
    found = list[int]()
    for i in range(len(RINGS)):
        ring = dataset.isel(ring=i)
        force, sliding, traction = (
            ring[name].to_numpy() for name in ("normal_force", "sliding_speed", "traction_force")
        )
        rolling = _rolling_speed(assembly, ring, i)
        loaded = (force > 0.0) & (rolling > 0.0) & np.isfinite(sliding)
        power = np.abs(traction * sliding)
        slower = np.abs(np.abs(rolling) - 0.5 * np.abs(sliding))
        with np.errstate(divide="ignore", invalid="ignore"):
            width = np.sqrt(force)
            indicators = (
                power / width,
                power / slower,
                power / np.sqrt(slower * width),
                force**0.1 / rolling**0.7,
            )
        if not loaded.any():
            continue
        for indicator in indicators:
            found.append(int(np.nanargmax(np.where(loaded, indicator, -np.inf))) // force.shape[1])
    return found


def _slice_error(
    assembly: Assembly, state: "xr.Dataset", i: int, model: DamageModel, worst: float
) -> float:
    """Return the relative difference of the worst value of a measure on a ring from that with more slices."""
    slices = SLICE_FACTOR * assembly.slices if assembly.slices > 1 else 1
    fine_bearing = assembly.at(attrs.evolve(assembly.resolution, slices=slices))
    loaded = _contacts(fine_bearing, state.isel(ring=i), i, _tilted_loads(fine_bearing, state))
    values = np.zeros(0) if loaded is None else values_of(model, loaded[0])
    fine = float(values[np.argmax(harm(model, values))]) if values.size else worst
    return abs(worst / fine - 1.0) if fine else 0.0


def _rolling_speed(assembly: Assembly, state: "xr.Dataset", i: int) -> NDArray[np.float64]:
    """Return the entrainment speed [m/s], with spin w and sliding V r w + V/2 on the inner, r w - V/2 on the outer."""
    radius = assembly.kinematics.direction * assembly.kinematics.roller_radius
    return np.asarray(
        radius * state["roller_speed"].to_numpy() + (0.5 - i) * state["sliding_speed"].to_numpy()
    )


def _tilted_loads(assembly: Assembly, state: "xr.Dataset") -> NDArray[np.float64] | None:
    """Return the loads per length [N/m] on both rings in static equilibrium, (2, Z, n); None if no roller tilts."""
    drop = assembly.drop
    if assembly.scene.operation.misalignment == 0.0 and np.allclose(
        drop, drop[::-1], rtol=_ROUNDING, atol=_MIN_DROP
    ):
        return None
    direction = 0.0
    if "load_direction" in state:
        direction = assembly.kinematics.direction * float(state["load_direction"])
    given: dict[str, Any] = {
        name: float(state[name]) for name in ("radial_load", "radial_clearance") if name in state
    }
    case = attrs.evolve(
        assembly.load_case(1, assembly.centrifugal_force_at(float(state["cage_speed"]))),
        psi=state["orbit_angle"].to_numpy()[None] - direction,
        **given,
    )
    equilibrium = solve_equilibrium(case, assembly.raceways)
    return np.stack((equilibrium.inner_load[0], equilibrium.outer_load[0]))


def _distribute(
    assembly: Assembly, i: int, force: float, tilted: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Return the load per length [N/m] under a force [N], in proportion to that of a tilted roller, or aligned."""
    if tilted is not None and (tilted_force := float(tilted @ assembly.widths)) > 0.0:
        return tilted * (force / tilted_force)
    return balanced_load(assembly, assembly.raceways[i], force)


def _contacts(
    assembly: Assembly, state: "xr.Dataset", i: int, tilted: NDArray[np.float64] | None = None
) -> tuple[Contacts, Numbers, Numbers] | None:
    """Return the evaluated slices on a ring, with the indices of roller and slice of each; None without load."""
    force = state["normal_force"].to_numpy()
    sliding = state["sliding_speed"].to_numpy()
    rolling = _rolling_speed(assembly, state, i)
    loaded = np.flatnonzero((force > 0.0) & (rolling > 0.0) & np.isfinite(sliding))
    if not loaded.size:
        return None
    load = np.array(
        [
            _distribute(assembly, i, float(force[j]), None if tilted is None else tilted[i, j])
            for j in loaded
        ]
    )
    row, column = np.nonzero(load > 0.0)
    owner = loaded[row]
    return (
        Contacts.of(
            assembly,
            RINGS[i],
            assembly.raceways[i].evaluate(load[row, column], rolling[owner], sliding[owner]),
        ),
        owner,
        column,
    )
