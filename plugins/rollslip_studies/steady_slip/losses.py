"""Friction losses of a bearing at its steady slips, its viscosity ratio, and a posteriori errors of an answer.

Slices and roller positions are chosen by the torque that drives the cage, relative to the largest. Rolling resistance,
the thinnest film and the minimum load depend on other slices, and the minimum load on those at another load. So each
number of an answer is evaluated once more on a bearing of a finer resolution, at the slip to which one secant step
leads there; the deviation is the error estimate.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any, Final

import numpy as np

from rollslip.bearing.raceway import Array, LoadedContacts
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about, xr
from rollslip.studies.bounds import JOINT_FACTOR, MINIMUM_ERROR_FACTOR, richardson_factor
from rollslip.studies.steady_slip.torque import Duty, formula_variables
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance, acceptable_reserve
from rollslip_studies.steady_slip.axial.limits import axial_variables
from rollslip_studies.steady_slip.evaluated import SECANT_STEP, estimate_by_secant
from rollslip_studies.steady_slip.minimum_load import largest_excess
from rollslip_studies.steady_slip.outputs import LOSSES, RATIO

#: Slip below which its error is not estimated, because an answer prints "below 0.1 %".
_MIN_ESTIMATED_SLIP: Final = 1e-3
#: Reserve from which on its error is not estimated, because an answer prints "over 1000".
_MAX_ESTIMATED_RESERVE: Final = 1e3
#: Reserve to slipping that its error is relative to at least: below it the cage slips more than is acceptable, whatever
#: its digits. Half of it would refine bearings for the digits of smaller reserves, which are printed as they are.
_MIN_RESERVE: Final = 1.0
#: Factor from the deviation of the limit drag torque, on a bearing of twice the resolution, to its error. Where rollers
#: jump between motions the torque converges with the first order, its error is twice the deviation; the joint order of
#: the other numbers is in their own factor, and is taken out here.
_JUMP_ERROR_FACTOR: Final = richardson_factor(1, JOINT_FACTOR) / richardson_factor(
    1, JOINT_FACTOR, 1.0
)


def loss_variables(
    balance: TorqueBalance, states: Sequence[Orbit], *, steady: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return friction losses, friction torque and viscosity ratio as variables, and their coordinates.

    The friction torques by the formulas that the scene names are among them, and forces of ribs under axial load.
    Losses are NaN where no slip is steady.

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of the bearing.
    states : sequence of Orbit
        Motions of the rollers.
    steady : bool
        Whether the states are those at steady slips.
    """
    balances = [power_balance(balance, state) for state in (states if steady else states[:1])]
    power = np.array([[loss.power for loss in state.losses] for state in balances]).T
    sense = balance.assembly.kinematics.direction
    values = {
        "loss": power,
        "ring_power": np.array([state.rings for state in balances]).T,
        "ring_torque": sense * np.array([state.torques for state in balances]).T,
        "stored_power": np.array([state.stored for state in balances]),
        "friction_torque": np.array([state.friction_torque for state in balances]),
    }
    if balance.assembly.scene.models.loss:
        values["external_torque"] = np.array([state.external_torque for state in balances])
    variables = {
        name: LOSSES[name].variable(value if steady else np.full_like(value, np.nan))
        for name, value in values.items()
    }
    axial, rules = axial_variables(balance, states, steady=steady)
    formulas, named = formula_variables(balance.assembly)
    for name, value in zip(RATIO, Duty.of(balance.assembly).viscosity_ratio, strict=True):
        variables[name] = RATIO[name].variable(value)
    return variables | formulas | axial, {
        "source": (
            "source",
            [loss.source for loss in balances[0].losses],
            about("1", "what loses power"),
        ),
        **named,
        **rules,
    }


def estimate_answer_errors(
    balance: TorqueBalance, at_load: Callable[[float], TorqueBalance], dataset: "xr.Dataset"
) -> dict[str, float]:
    """Return relative errors of the numbers of an answer by name, without numbers that are printed without digits.

    An error is infinite where the number of the finer bearing is not known.

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of a bearing with a finer resolution.
    at_load : callable
        The torque balance of that bearing at a radial load [N].
    dataset : Dataset
        The result.
    """
    found = dict[str, float]()
    # a law may have no value at a slip or load next to those of the result
    with np.errstate(all="ignore"), suppress(DomainError, ConvergenceError):
        for name, error in _errors(balance, at_load, dataset):
            found[name] = error
    return {name: error if error == error else math.inf for name, error in found.items()}


def _errors(
    balance: TorqueBalance, at_load: Callable[[float], TorqueBalance], dataset: "xr.Dataset"
) -> Iterator[tuple[str, float]]:
    """Yield name and relative error of each number of an answer."""
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    if lasting.size and not balance.rolls_freely:
        yield from _steady_errors(balance, dataset.isel(steady=int(lasting[0])))
    acceptable = dataset.attrs.get("acceptable_slip", math.nan)
    if abs(own := float(dataset.get("acceptable_reserve", math.nan))) < _MAX_ESTIMATED_RESERVE:
        finer, _ = acceptable_reserve(balance, acceptable)
        yield "reserve to slipping", abs(own - finer) / max(abs(finer), _MIN_RESERVE)
    if math.isfinite(float(dataset["limit_drag"])):
        yield from _limit_drag_errors(balance, dataset)
    own = float(dataset.get("drag_reserve", math.nan))
    slip = (
        float(dataset["drag_reserve"].attrs.get("slip", math.nan))
        if 0.0 < own < _MAX_ESTIMATED_RESERVE
        else math.nan
    )
    if not math.isnan(slip) and slip != float(dataset["skidding_slip"]):
        carried = own * -balance.drag(slip)
        # of several motions the nearest one: a loading branch on all slices would take far longer
        motions = balance.motions.find(np.array([slip]))[0]
        nearest = min(motions, key=lambda motion: abs(motion.torque - carried))
        yield "reserve to skidding", _relative_error(carried, nearest.torque)
    if "minimum_load" not in dataset:
        return
    load = float(dataset["minimum_load"])
    if load > dataset.attrs.get("rollers_weight", 0.0):
        slips = np.atleast_1d(dataset["minimum_load"].attrs["slips"]).tolist()
        over, more = (
            largest_excess(at_load(value), slips, acceptable)[1]
            for value in (load, (1.0 + SECANT_STEP) * load)
        )
        yield "minimum load", SECANT_STEP * abs(over / (more - over)) if more != over else math.inf


def _steady_errors(balance: TorqueBalance, result: "xr.Dataset") -> Iterator[tuple[str, float]]:
    """Yield the errors of a steady slip by one secant step, and of friction torque and thinnest film at its end."""
    slip = float(result["steady_slip"])
    start = float(result["roller_slip"][0] / balance.motions.slip_scale(np.array([slip]))[0])
    film_factor = 1.0

    def torque_and_film(orbit: Orbit) -> Array:
        nonlocal film_factor
        film, film_factor = min(
            _thinnest(contacts) for contacts in balance.evaluate_contacts(orbit) if contacts.total
        )
        return np.array([power_balance(balance, orbit).friction_torque, film])

    error, (torque, film) = estimate_by_secant(balance, slip, torque_and_film, start)
    yield "friction torque", _relative_error(float(result["friction_torque"]), torque)
    thinnest = float(np.nanmin(result["film_parameter"]))
    yield "film parameter", film_factor * _relative_error(thinnest, film)
    if abs(slip) >= _MIN_ESTIMATED_SLIP:
        yield "cage slip", error


def _thinnest(contacts: LoadedContacts) -> tuple[float, float]:
    """Return the smallest film parameter of a contact, and a factor on its error, above 1 where it is at the end."""
    at = int(contacts.slices.film_thickness.argmin())
    heaviest = contacts.load[contacts.owner == contacts.owner[at]].max()
    film = float(contacts.slices.film_thickness[at] / contacts.slices.conditions.roughness)
    return film, 1.0 if contacts.load[at] == heaviest else MINIMUM_ERROR_FACTOR


def _limit_drag_errors(
    balance: TorqueBalance, dataset: "xr.Dataset"
) -> Iterator[tuple[str, float]]:
    """Yield the error of the limit drag torque at its slip, and of that slip where it leaves its stated range.

    The slip is the vertex of the parabola through both ends of the range and the slip between. Where the slip is at an
    end of the range there is no such error.
    """
    low, slip, high = slips = np.array(
        [float(dataset[name]) for name in ("limit_drag_low", "skidding_slip", "limit_drag_high")]
    )
    torques = balance.torques(slips)
    yield (
        "limit drag torque",
        _JUMP_ERROR_FACTOR * _relative_error(float(dataset["limit_drag"]), torques[1]),
    )
    if not low < slip < high:
        return
    curvature, slope, _ = np.polyfit((slips - slip) / (high - low), torques, 2)
    vertex = slip - 0.5 * slope / curvature * (high - low) if curvature < 0.0 else math.inf
    yield "skidding slip", 0.0 if low <= vertex <= high else abs(vertex / slip - 1.0)


def _relative_error(value: float, finer: float) -> float:
    """Return the deviation of a value from that of a finer bearing, relative to the latter."""
    return abs(value / finer - 1.0)
