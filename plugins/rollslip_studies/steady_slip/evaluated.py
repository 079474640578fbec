"""Quantities at steady slips that several studies need: resolution, loaded slices, film regimes, and error estimates.

An error is estimated by one step of the secant method on the torque balance of a finer bearing, from the steady slip of
the coarser one: the step is the error of the slip, and any quantity that depends on the slip is extrapolated linearly
over the same step.
"""

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.regimes import LIGHT, film_by_regime, groups, moes_groups
from rollslip.results.dataset import xr
from rollslip.results.text import SMALLEST_SLIP, Status
from rollslip.studies.answers import LoadedSlices, ResolutionChoice
from rollslip.studies.study import Study
from rollslip_studies.effective_friction.raceways import no_load_error, regime_variables

if TYPE_CHECKING:
    from rollslip.bearing.assembly import Assembly
    from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance

#: Relative tolerance of the skidding slip in a choice of resolution by torques alone, where nothing depends on that
#: slip. It only has to be too large to matter: half or twice as much changes no choice.
_LOOSE_SLIP_TOLERANCE: Final = 0.1
#: Relative step of a slip, or of a load, by which an excess torque is differentiated. Twice as much doubles the error
#: of the slope by curvature, half as much its error by rounding; chosen between both.
SECANT_STEP: Final = 1e-3
#: Number of these steps up to which a quantity is extrapolated, 3 % of the slip. Twice as much trusts the linear
#: extrapolation over 6 %; chosen, as larger errors of the slip exceed any tolerance without it.
_MAX_EXTRAPOLATION: Final = 30.0


def choose_by_torques(
    study: Study, assembly: "Assembly", *, cheaper_laws: bool
) -> ResolutionChoice:
    """Choose slices, roller positions and laws by torques alone, whatever the error of the skidding slip.

    Parameters
    ----------
    study : Study
        The study.
    assembly : Assembly
        The bearing.
    cheaper_laws : bool
        Whether a cheaper law may replace one that it approximates.
    """
    accuracy = attrs.evolve(assembly.scene.accuracy, critical_slip=_LOOSE_SLIP_TOLERANCE)
    there = attrs.evolve(assembly, scene=attrs.evolve(assembly.scene, accuracy=accuracy))
    choice = study.choose_resolution(there, cheaper_laws=cheaper_laws)
    errors = {
        part: {name: error for name, error in by_name.items() if name != "critical_slip"}
        for part, by_name in choice.errors.items()
    }
    return attrs.evolve(choice, errors=errors)


def evaluated_slices(balance: "TorqueBalance", orbits: "Iterable[Orbit]") -> list[LoadedSlices]:
    """Return the loaded slices of both rings in motions of the rollers.

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of the bearing.
    orbits : iterable of Orbit
        The motions.
    """
    found = []
    for orbit in orbits:
        for ring, contacts in zip(RINGS, balance.evaluate_contacts(orbit), strict=True):
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


def estimate_by_secant(
    balance: "TorqueBalance",
    slip: float,
    quantities: "Callable[[Orbit], Array]",
    fraction: float | None = None,
) -> tuple[float, Array]:
    """Return the relative error of a steady slip by one secant step, and quantities extrapolated to the exact slip.

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of a finer bearing than the one that has the slip.
    slip : float
        Steady cage slip of the coarser bearing [-].
    quantities : callable
        Quantities, (n,), in a motion of the rollers.
    fraction : float or None
        Roller slip at the first position, normalised, from which the motion is found; None for the motion on the
        loading branch.
    """
    slips = slip * np.array([1.0, 1.0 + SECANT_STEP])
    if fraction is None:
        orbits = [balance.orbit(cage_slip) for cage_slip in slips.tolist()]
    else:
        found = balance.motions.find(slips, np.full(2, fraction))
        orbits = [balance.orbit_from_motion(motions[0]) for motions in found]
    excess, next_excess = (orbit.torque + balance.drag(orbit.cage_slip) for orbit in orbits)
    steps = excess / (excess - next_excess) if next_excess != excess else math.inf
    here, beyond = map(quantities, orbits)
    return SECANT_STEP * abs(steps), here + min(
        max(steps, -_MAX_EXTRAPOLATION), _MAX_EXTRAPOLATION
    ) * (beyond - here)


def require_driven(assembly: "Assembly") -> "Assembly":
    """Return the bearing; raise `SceneError` if no load drives its rollers, because rounding errors would do so."""
    if not assembly.load_distribution(2).inner_force.any():
        raise no_load_error(assembly.scene, "nothing drives the cage")
    return assembly


def film_variables(
    study: Study, balance: "TorqueBalance", states: "list[Orbit]", *, steady: bool
) -> dict[str, Any]:
    """Return film regimes of the contacts over the orbits, and where slips are steady the smallest film parameter.

    Parameters
    ----------
    study : Study
        The study, which has the outputs.
    balance : TorqueBalance
        Torque balance of the bearing.
    states : list of Orbit
        Motions of the rollers.
    steady : bool
        Whether the states are those at steady slips.
    """
    fraction = np.zeros((2, 4))
    light = np.zeros(2)
    largest = np.zeros(2)
    thinnest = np.full((2, len(states)), np.nan)
    for k, state in enumerate(states):
        for i, contacts in enumerate(balance.evaluate_contacts(state)):
            if contacts.total == 0.0:
                continue
            slices = contacts.slices
            force = contacts.force / contacts.total
            thinnest[i, k] = slices.film_thickness.min() / slices.conditions.roughness
            code = film_by_regime(*groups(slices))[1].astype(int)
            fraction[i] += np.bincount(code, weights=force, minlength=4) / len(states)
            M = moes_groups(slices)[0]
            largest[i] = max(largest[i], M.max())
            light[i] += force[M < LIGHT].sum() / len(states)
    if not steady:
        return regime_variables(fraction, largest, light, ", over the range of slips")
    variables = regime_variables(fraction, largest, light, ", at the steady slips")
    return variables | study.variables(film_parameter=thinnest)


def without_play(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with the answers of rollers set in the cage in place of those with play, where it has both.

    Parameters
    ----------
    dataset : Dataset
        Result of the study.
    """
    if "slip_without_play" not in dataset:
        return dataset
    slips = dataset["steady_slip"].to_numpy().copy()
    slips[0] = float(dataset["slip_without_play"])
    names = ("minimum_load", "acceptable_reserve", "limit_drag", "driving_torque")
    return dataset.assign(steady_slip=dataset["steady_slip"].copy(data=slips)).assign(
        {
            name: dataset[name].copy(data=dataset[f"{name}_without_play"].to_numpy())
            for name in names
            if f"{name}_without_play" in dataset
        }
    )


def slip_with_play(dataset: "xr.Dataset") -> Callable[[float], float]:
    """Return the slip with play in the pockets as a function of that of rollers set in the cage.

    Rollers with and without play carry the same torque at these slips. What changes the slip of rollers set in the
    cage, such as another oil, changes that with play as a drag would that has the same effect. Of one bearing slips by
    four quantities are within 14 % of those that are computed anew (tests/studies/test_band.py).
    It returns the slip itself for a result without play.

    Parameters
    ----------
    dataset : Dataset
        Result of the study.
    """
    if "play_status" not in dataset or dataset["play_status"].item() != Status.FOUND:
        return lambda slip: slip
    with_play = float(dataset["steady_slip"].to_numpy()[0])
    without = float(dataset["slip_without_play"])
    slips = dataset["cage_slip"].to_numpy()
    set_torques = dataset["driving_torque_without_play"].to_numpy()
    torques = dataset["driving_torque"].to_numpy()

    def at_same_torque(slip: float) -> float:
        torque = np.interp(slip, slips, set_torques)
        reaches = np.flatnonzero(torques >= torque)
        if not -SMALLEST_SLIP < slip < slips[-1] or not reaches.size or reaches[0] == 0:
            return slip
        around = [reaches[0] - 1, reaches[0]]
        return max(slip, float(np.interp(torque, torques[around], slips[around])))

    # the curve is interpolated: the slip of the result itself is kept, unless the cage is driven
    factor = with_play / at_same_torque(without) if with_play > 0.0 else 1.0
    return lambda slip: factor * at_same_torque(slip)
