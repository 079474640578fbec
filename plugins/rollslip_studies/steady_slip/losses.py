"""What a bearing loses to friction at its steady slips, its viscosity ratio, and by how much numbers are off.

Slices and instants are chosen by the torque that drives the cage, relative to the largest. Resistance to rolling, the
thinnest film and the load that keeps a slip hang on other slices, and that load on those of another load.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array, LoadedContacts
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about
from rollslip.results.words import Status
from rollslip.studies.error_estimate import JOINT_ORDER, MINIMUM_ERROR_FACTOR
from rollslip.studies.steady_slip.torque import Duty, by_formula
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import Orbit, TorqueBalance
from rollslip_studies.steady_slip.evaluated import SECANT_STEP, estimate_by_secant
from rollslip_studies.steady_slip.minimum_load import largest_excess
from rollslip_studies.steady_slip.outputs import LOSSES, RATIO

if TYPE_CHECKING:
    import xarray as xr

#: Slip and reserve that an answer shows no digits of.
_SMALL = 1e-3
_PLENTY = 1e3
#: What rollers that jump carry falls with the first order.
_OF_JUMPS: Final = 2.0 * (1.0 - 2.0**-JOINT_ORDER)


def loss_variables(
    balance: TorqueBalance, states: Sequence[Orbit], *, steady: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the losses at some states as variables, and their coordinates; NaN where none is steady.

    Beside them stand the friction torques by the formulas that the scene names, which know no slip.
    """
    balances = [power_balance(balance, state) for state in (states if steady else states[:1])]
    power = np.array([[loss.power for loss in one.losses] for one in balances]).T
    turns = abs(
        balance.assembly.scene.operation.inner_speed - balance.assembly.scene.operation.outer_speed
    )
    found = {
        "loss": power,
        "ring_power": np.array([one.rings for one in balances]).T.reshape(len(RINGS), -1),
        "stored_power": np.array([one.stored for one in balances]),
        "friction_torque": power.sum(axis=0) / turns,
    }
    sources = [loss.source for loss in balances[0].losses]
    variables = {
        name: LOSSES[name].variable(values if steady else np.full_like(values, np.nan))
        for name, values in found.items()
    }
    formulas, named = by_formula(balance.assembly)
    for name, value in zip(RATIO, viscosity_ratio(balance.assembly), strict=True):
        variables[name] = RATIO[name].variable(value)
    return variables | formulas, {
        "source": ("source", sources, about("1", "what loses power")),
        **named,
    }


def viscosity_ratio(assembly: Assembly) -> tuple[float, str]:
    """Return kappa = nu/nu_1 and "found", or NaN and what is missing.

    nu_1 = 45000 n^-0.83 d_m^-0.5 below n = 1000/min and 4500 (n d_m)^-0.5 from there on [mm2/s], with the relative
    speed n [1/min] and the pitch diameter d_m [mm], after ISO 281:2007.
    """
    duty = Duty.of(assembly)
    n = duty.revolutions
    d_m = 1e3 * duty.pitch_diameter
    try:
        nu = 1e6 * duty.kinematic_viscosity
    except DomainError as error:
        return math.nan, str(error)
    return nu / ((45000.0 * n**-0.83 if n < 1000.0 else 4500.0 * n**-0.5) * d_m**-0.5), Status.FOUND


def acceptable_reserve(balance: TorqueBalance, slip: float) -> tuple[float, str]:
    """Return the torque of the rollers over the drag at a slip, and "found", or NaN and why there is none."""
    drag = -balance.drag(slip)
    if not drag > 0.0:
        return math.nan, f"nothing drags the cage at a slip of {slip:g}"
    try:
        return float(balance.torques(np.array([slip]))[0]) / drag, Status.FOUND
    except (DomainError, ConvergenceError) as error:
        return math.nan, str(error)


def estimate_answer_errors(
    balance: TorqueBalance, at_load: Callable[[float], TorqueBalance], dataset: "xr.Dataset"
) -> dict[str, float]:
    """Return what is off, relative, by its name; what an answer shows no digits of is left out.

    Parameters
    ----------
    balance : TorqueBalance
        Of the finer bearing.
    at_load : callable
        The same at a radial load [N].
    dataset : Dataset
        The result.
    """
    found = dict[str, float]()
    try:
        with np.errstate(all="ignore"):
            for name, error in _off(balance, at_load, dataset):
                found[name] = error
    except (DomainError, ConvergenceError):  # of a motion beside those that were asked for
        pass
    return {name: error if error == error else math.inf for name, error in found.items()}


def _off(
    balance: TorqueBalance, at_load: Callable[[float], TorqueBalance], dataset: "xr.Dataset"
) -> Iterator[tuple[str, float]]:
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    if lasting.size and not balance.rolls_freely:
        yield from _steady(balance, dataset.isel(steady=int(lasting[0])))
    acceptable = dataset.attrs.get("acceptable_slip", math.nan)
    if abs(own := float(dataset.get("acceptable_reserve", math.nan))) < _PLENTY:
        yield "reserve to slipping", _apart(own, acceptable_reserve(balance, acceptable)[0])
    if math.isfinite(float(dataset["limit_drag"])):
        yield from _largest(balance, dataset)
    elif 0.0 < float(dataset.get("drag_reserve", math.nan)) < _PLENTY:
        slip, own = (float(dataset[name]) for name in ("largest_torque_slip", "largest_torque"))
        # of several motions the one that is meant: a way up on all slices would take far longer
        torques = [motion.torque for motion in balance.motions.at(np.array([slip]))[0]]
        yield "reserve to skidding", _apart(own, min(torques, key=lambda one: abs(one - own)))
    if "minimum_load" not in dataset:
        return
    load = float(dataset["minimum_load"])
    if load > dataset.attrs.get("rollers_weight", 0.0):
        by = np.atleast_1d(dataset["minimum_load"].attrs["slips"]).tolist()
        over, more = (
            largest_excess(at_load(one), by, acceptable)[1]
            for one in (load, (1.0 + SECANT_STEP) * load)
        )
        yield "minimum load", SECANT_STEP * abs(over / (more - over)) if more != over else math.inf


def _steady(balance: TorqueBalance, one: "xr.Dataset") -> Iterator[tuple[str, float]]:
    """What is off at a steady slip: the slip by one secant, friction torque and thinnest film where that leads."""
    slip = float(one["steady_slip"])
    o = balance.assembly.scene.operation
    start = float(one["roller_slip"][0] / balance.motions.unit(np.array([slip]))[0])
    times = 1.0

    def of(orbit: Orbit) -> Array:
        nonlocal times
        film, times = min(
            _thinnest(contacts) for contacts in balance.evaluated(orbit) if contacts.total
        )
        return np.array(
            [power_balance(balance, orbit).total / abs(o.inner_speed - o.outer_speed), film]
        )

    off, (torque, film) = estimate_by_secant(balance, slip, of, start)
    yield "friction torque", _apart(float(one["friction_torque"]), torque)
    yield "film parameter", times * _apart(float(np.nanmin(one["film_parameter"])), film)
    if abs(slip) >= _SMALL:
        yield "cage slip", off


def _thinnest(contacts: LoadedContacts) -> tuple[float, float]:
    """Least film parameter of a contact, and how many times as far off it is where it is at its end, not its middle."""
    at = int(contacts.slices.film_thickness.argmin())
    heaviest = contacts.load[contacts.owner == contacts.owner[at]].max()
    film = float(contacts.slices.film_thickness[at] / contacts.slices.conditions.roughness)
    return film, 1.0 if contacts.load[at] == heaviest else MINIMUM_ERROR_FACTOR


def _largest(balance: TorqueBalance, dataset: "xr.Dataset") -> Iterator[tuple[str, float]]:
    """What is off at the largest drag: itself at its slip, and that slip where it leaves the range in which it is told.

    It is the vertex of a parabola through both ends of that range and the slip between; at an end there is none.
    """
    low, slip, high = slips = np.array(
        [float(dataset[name]) for name in ("limit_drag_low", "skidding_slip", "limit_drag_high")]
    )
    torques = balance.torques(slips)
    yield "largest drag", _OF_JUMPS * _apart(float(dataset["limit_drag"]), torques[1])
    if not low < slip < high:
        return
    curvature, slope, _ = np.polyfit((slips - slip) / (high - low), torques, 2)
    vertex = slip - 0.5 * slope / curvature * (high - low) if curvature < 0.0 else math.inf
    yield "slip of the largest drag", 0.0 if low <= vertex <= high else abs(vertex / slip - 1.0)


def _apart(one: float, finer: float) -> float:
    return abs(one / finer - 1.0)
