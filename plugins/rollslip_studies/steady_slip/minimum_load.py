"""The minimum radial load for an acceptable cage slip, and the minimum loads of makers' catalogues.

The minimum load is a property of this bearing, its oil and its drags: the load at which the excess torque, that of the
rollers less the drags, is zero at the acceptable slip. A larger load slips less. Where the excess torque has a higher
maximum at a smaller slip, the cage skids before it reaches the acceptable slip; then it is the load at which that
maximum is zero. The search:

1. Start at the load of the scene, or at 1 N if the scene has none, with the acceptable slip alone.
2. The torque that drives loaded rollers is roughly proportional to the square of the load, so take one step to the load
   at which this would balance the drag, and go on by secants over the square of the load to a step of 1e-4.
3. Where secants fail, widen from the start by factors of 4, up to 1e6, until the sign of the excess torque changes, and
   find the root between by the Illinois method. Without a change of sign any load serves, or none.
4. Below the weight of the rollers stop, because the balance leaves their weight out.
5. At the load found, look for maxima of the excess torque at smaller slips: on a coarse logarithmic grid first, then on
   the loading branch. Take five slips around each maximum.
6. Evaluate the largest excess torque over all these slips, at a maximum by the vertex of a parabola through three.
7. Where it is not zero within the tolerance, repeat from 2 with these slips, up to four times.

The rules of makers are rules of thumb for any oil, speed and cage. They differ by a factor of four to five (bearing NU
2220 at its reference speed: SKF 3.9 kN, Schaeffler 7.4 kN, NTN 17.8 kN). They say what is usual, not what slips.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.geometry.bearing import Bearing, Catalogue
from rollslip.results.text import SWITCHED_OFF, Status
from rollslip.scene.relations import skf_minimum_load
from rollslip.scene.values import Scene
from rollslip.search import illinois_root, polynomial_maximum, secant_root
from rollslip.units import GRAVITY, format_quantity
from rollslip_studies.motion.torque_balance import RANGE, CageTorques, TorqueBalance

__all__ = [
    "RULES",
    "Rule",
    "largest_excess",
    "minimum_load",
    "minimum_loads_of_makers",
    "rollers_weight",
]


# The effects of these constants were measured by 24 searches: in four scenes of the catalogue at acceptable slips of 2
# and 30 %, and with a constant drag of 0.6 N m at 50 to 94 %, where eight loads are those of a maximum.

# The load at which the excess torque is zero:

#: Relative tolerance of the load. Half or twice as much changes loads by up to 1.4e-4. Chosen, far below the digits of
#: an answer.
_LOAD_TOLERANCE: Final = 1e-4
#: The same for rollers with play. Half or twice as much changes nine loads by up to 1.1e-5. Chosen, as the tables of
#: friction are not better.
_SIMILAR_LOAD_TOLERANCE: Final = 1e-3
#: Load at which the search starts where the scene has none [N]. Half or twice as much changes nothing else.
_START_LOAD: Final = 1.0
#: Factor by which the load changes at most in one step. 2 and 8 change loads by less than 3e-5, 8 takes 10 % more time.
#: Chosen.
_WIDENING: Final = 4.0
#: Factor from the start beyond which no load is searched. Twice as much costs one more step where no load serves;
#: chosen, so that from 1 N every load of a bearing is within it.
_MAX_LOAD_FACTOR: Final = 1e6
#: Repetitions with other slips around maxima. Half as many change loads by up to 9e-4, twice as many change none.
_MAX_ROUNDS: Final = 4

# Maxima of the excess torque at slips up to the acceptable one:

#: Points of the logarithmic grid of slips. With the spacing it goes down to 1/310 of the acceptable slip, with half as
#: many points to 1/12. Neither half nor twice as many changed a load. Chosen.
_GRID_POINTS: Final = 25
#: Difference of the logarithms of neighbouring slips. A maximum that is narrower may be stepped over. Neither half nor
#: twice as much changed a load. Chosen.
_GRID_SPACING: Final = 0.25
#: Largest slip of the grid over the acceptable slip, so that a maximum at the acceptable slip is inside. Neither 1.1
#: nor 2.6 changed a load. Chosen.
_GRID_END: Final = 1.3
#: Fraction of the drag that the torque at a maximum of the grid has to exceed for a search on the loading branch: less
#: than 1, as between two points the torque may rise. With twice as much the eight maxima are not found, half as much
#: changes nothing. Chosen.
_DRAG_FRACTION: Final = 0.7
#: The same for maxima on the loading branch, whose points are denser, but of few loads of a roller. The same effects.
_BRANCH_DRAG_FRACTION: Final = 0.9
#: Differences of the logarithm of the slip around a maximum at which all slices are evaluated. Half of them change
#: loads by up to 3e-4, twice of them by 6e-5. Chosen.
_AROUND_MAXIMUM: Final = (-0.2, -0.1, 0.0, 0.1, 0.2)
#: Difference of logarithms below which two slips count as one. Neither half nor twice as much changed a load. Chosen,
#: less than half the spacing of `_AROUND_MAXIMUM`.
_MIN_DIFFERENCE: Final = 0.03

#: Torque balance of a bearing at a radial load [N].
Balances = Callable[[float], TorqueBalance]


def minimum_load(
    balance: Balances, load: float, slip: float, weight: float = 0.0
) -> tuple[float, str, tuple[float, ...]]:
    """Return the minimum radial load [N] for an acceptable slip, its status, and the slips that it is evaluated at.

    The load is NaN where the status says why there is none. The slips are the acceptable one and some around maxima of
    the excess torque before it; there are none where the load is NaN.

    Parameters
    ----------
    balance : callable
        Torque balance of the bearing at a radial load [N].
    load : float
        Load at which the search starts [N].
    slip : float
        Acceptable cage slip [-], above 0.
    weight : float, optional
        Weight of the rollers [N], which the balance leaves out: below it maxima at smaller slips are not searched.
    """
    slips: tuple[float, ...] = (slip,)

    def excess(log: float) -> float:
        return largest_excess(balance(math.exp(log)), slips, slip)[1]

    if balance(load).rolls_freely:
        return math.nan, f"{Status.NO_LOAD_NEEDED}: {SWITCHED_OFF}", ()
    try:
        found = load or _START_LOAD
        at = slip
        over = excess(math.log(found))
        drag = -balance(found).drag(slip)
        for _ in range(_MAX_ROUNDS):
            start = math.log(found)
            found = _load_by_secants(excess, start, over, drag)
            if math.isnan(found):
                found, status = _load_by_bracketing(excess, start, over, slip)
                if status:
                    return math.nan, status, ()
            if found < weight:
                break
            slips = (slip, *_around_maxima(balance(found), slip))
            at, over = largest_excess(balance(found), slips, slip)
            if abs(over) <= 4.0 * _LOAD_TOLERANCE * abs(drag):
                break
        # compiled searches check no validity ranges; an evaluated orbit does
        balance(found).orbit(at)
    except (DomainError, ConvergenceError) as error:
        return math.nan, f"not found: {error}", ()
    return found, Status.FOUND if at == slip else f"{Status.FOUND_AT_SKIDDING} {at:.2g} on", slips


def load_from_known(
    balance: Callable[[float], CageTorques],
    known: float,
    slips: Sequence[float],
    slip: float,
) -> float:
    """Return the minimum radial load [N] near a known one, of a similar balance; NaN where it is not found.

    Tables of friction change from load to load, so that the excess torque jumps by about their error. Secants do not
    converge across a jump through zero: the load is known there as soon as it is bracketed.

    Parameters
    ----------
    balance : callable
        Torque balance of the bearing with play in its pockets, at a radial load [N].
    known : float
        Minimum load without play [N].
    slips : sequence of float
        Cage slips at which it was evaluated [-].
    slip : float
        Acceptable cage slip [-].
    """
    found = dict[float, float]()

    def excess(log: float) -> float:
        found[log] = largest_excess(balance(math.exp(log)), slips, slip)[1]
        return found[log]

    start = math.log(known)
    drag = -balance(known).drag(slip)
    load = _load_by_secants(excess, start, excess(start), drag, _SIMILAR_LOAD_TOLERANCE)
    low = max((log for log, over in found.items() if over < 0.0), default=-math.inf)
    high = min((log for log, over in found.items() if over >= 0.0), default=math.inf)
    if math.isnan(load) and 0.0 < high - low <= _SIMILAR_LOAD_TOLERANCE:
        return math.exp(0.5 * (low + high))
    return load


def largest_excess(
    balance: CageTorques, slips: Sequence[float], slip: float
) -> tuple[float, float]:
    """Return the slip up to a given one with the largest excess torque, and that torque [N m].

    Parameters
    ----------
    balance : TorqueBalance
        Torque balance of the bearing.
    slips : sequence of float
        Cage slips at which it is evaluated [-], among them the given one; a maximum between them is the vertex of the
        parabola through three, over the logarithm of the slip.
    slip : float
        The given slip [-].
    """
    at = np.unique(slips)
    over = balance.torques(at) + np.array([balance.drag(cage_slip) for cage_slip in at.tolist()])
    best = int(np.argmax(over[at <= slip]))
    if 0 < best < at.size - 1 and over[best] >= over[best + 1]:
        log, height = polynomial_maximum(np.log(at[best - 1 : best + 2]), over[best - 1 : best + 2])
        if log < math.log(slip):
            return math.exp(log), height
        best = int(np.flatnonzero(at == slip)[0])
    return float(at[best]), float(over[best])


def _around_maxima(balance: TorqueBalance, slip: float) -> Iterator[float]:
    """Yield slips around maxima of the excess torque that the cage may reach before a slip."""
    upper = max(RANGE, slip)
    slips = _GRID_END * slip * np.exp(-_GRID_SPACING * np.arange(_GRID_POINTS)[::-1])
    slips = slips[slips <= upper]
    if not any(_maxima(balance, slips, balance.torques(slips, reduced=True), _DRAG_FRACTION)):
        return
    path = np.array([(step.slip, step.torque) for step in balance.loading_branch(upper).motions])
    path = path[path[:, 0] <= _GRID_END * slip]
    known = [slip]
    for peak in _maxima(balance, path[:, 0], path[:, 1], _BRANCH_DRAG_FRACTION):
        for step in _AROUND_MAXIMUM:
            near = peak * math.exp(step)
            distance = min(abs(math.log(near / other)) for other in known)
            if near <= upper and distance > _MIN_DIFFERENCE:
                known.append(near)
                yield near


def _maxima(
    balance: TorqueBalance, slips: Array, torques: Array, fraction: float
) -> Iterator[float]:
    """Yield slips with more excess torque than both neighbours, and with a torque above a fraction of the drag."""
    drags = -np.array([balance.drag(slip) for slip in slips.tolist()])
    over = torques - drags
    is_maximum = (over[1:-1] > over[:-2]) & (over[1:-1] >= over[2:])
    yield from slips[1:-1][is_maximum & (torques[1:-1] > fraction * drags[1:-1])].tolist()


def rollers_weight(assembly: Assembly) -> float:
    """Return the weight of all rollers [N]; 0 where the scene gives its direction, so that the loads include it."""
    left_out = assembly.scene.operation.gravity_direction is None
    return GRAVITY * assembly.roller_mass * assembly.scene.bearing.rollers * left_out


def _load_by_secants(
    excess: Callable[[float], float],
    start: float,
    over: float,
    drag: float,
    tolerance: float = _LOAD_TOLERANCE,
) -> float:
    """Return the load [N] at which an excess torque over the logarithm of the load is zero; NaN where secants fail.

    Secants go over the square of the load relative to the start, as the torque is roughly proportional to it. The root
    has to be one at which a larger load leaves more torque.
    """
    max_step = math.log(_WIDENING)
    guess = math.copysign(max_step, -over)
    if over + drag > 0.0 < drag:
        guess = -0.5 * math.log((over + drag) / drag)
    guess = min(max(guess, -max_step), max_step) or _LOAD_TOLERANCE

    def squared(square: float) -> float:
        return excess(start + 0.5 * math.log(square))

    at = math.exp(2.0 * guess)
    value = squared(at)
    slope = (value - over) / (at - 1.0)
    if not slope > 0.0:
        return math.nan
    first = at - value / slope
    farthest = _WIDENING**2
    within = min(at, 1.0) / farthest, max(at, 1.0) * farthest
    if not within[0] <= first <= within[1]:
        return math.nan
    found = secant_root(squared, first, slope, tolerance=tolerance * first, within=within)
    return math.exp(start) * math.sqrt(found[0]) if found and found[1] > 0.0 else math.nan


def _load_by_bracketing(
    excess: Callable[[float], float], start: float, over: float, slip: float
) -> tuple[float, str]:
    """Return the load [N] at which an excess over its logarithm changes its sign; NaN and why there is none."""
    at = before = start
    value = last = over
    widening = math.log(_WIDENING)
    step = -widening if over > 0.0 else widening
    while (value > 0.0) == (over > 0.0):
        if abs(at - start) > math.log(_MAX_LOAD_FACTOR):
            ends = " and ".join(
                format_quantity(math.exp(end), "N", 3) for end in sorted((start, at))
            )
            relation = "less" if over > 0.0 else "more"
            serves = Status.ANY_LOAD if over > 0.0 else Status.NO_LOAD
            return (
                math.nan,
                f"{serves}: between {ends} the steady slip stays {relation} than {slip:g}",
            )
        before = at
        last = value
        at = at + step
        value = excess(at)
    root = illinois_root(excess, before, at, last, value, tolerance=_LOAD_TOLERANCE)
    return math.exp(root), ""


@attrs.frozen
class Rule:
    """Rule of a maker for the minimum radial load."""

    #: Load [N] of a bearing at a relative speed of its rings [rad/s].
    load: Callable[[Bearing, float], float]
    text: str  #: Formula and source.
    grade: str  #: Data quality of the source, A to D.
    takes: tuple[str, ...] = ()  #: Keys of ``bearing.catalogue`` that the rule reads.
    #: Key of ``bearing.catalogue`` without which the load is the one at rest; empty for none.
    grows_with: str = ""

    def requested(self, bearing: Bearing, speed: float) -> tuple[float, str]:
        """Return the load [N] and its status; NaN and the missing keys of the scene where the rule needs them.

        Parameters
        ----------
        bearing : Bearing
            The bearing.
        speed : float
            Relative speed of its rings [rad/s].
        """
        catalogue = bearing.catalogue or Catalogue()
        if bearing.contact_angle is not None:
            return math.nan, "is not one for a tapered bearing"
        missing = [
            f"bearing.catalogue.{key}" for key in self.takes if getattr(catalogue, key) is None
        ]
        if missing:
            return math.nan, f"needs {' and '.join(missing)} of the maker's catalogue"
        load = self.load(bearing, speed)
        if self.grows_with and getattr(catalogue, self.grows_with) is None:
            key = f"bearing.catalogue.{self.grows_with}"
            return load, f"{Status.FOUND_AT_REST}; with speed it grows by {key}"
        return load, Status.FOUND


def _nke(bearing: Bearing, speed: float) -> float:
    """Return the minimum load after NKE [N]."""
    catalogue: Any = bearing.catalogue
    return float(0.02 * catalogue.dynamic_rating)


#: Maker -> its rule. SKF's mean diameter is that of bore and outside, 0 to 1.2 % below the pitch circle.
RULES: Final[Mapping[str, Rule]] = {
    "NTN": Rule(
        lambda bearing, speed: 0.040 * bearing.static_rating,
        "0.040 C0r for roller bearings, catalogue 2203/E, section 8.4",
        "A",
    ),
    "Schaeffler": Rule(
        lambda bearing, speed: bearing.static_rating / 60.0, "C0r/60, recalled, not read", "C"
    ),
    "SKF": Rule(
        skf_minimum_load,
        "k_r (6 + 4 n/n_r) (d_m/100)^2 kN for one row with a cage, catalogue 17000, page 509",
        "A",
        ("minimum_load_factor",),
        "reference_speed",
    ),
    "NKE": Rule(
        _nke,
        "0.02 C for a cylindrical roller bearing with a cage, catalogue",
        "A",
        ("dynamic_rating",),
    ),
}


def minimum_loads_of_makers(scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """Return the minimum load of each of the `RULES` [N], NaN if it is not known, and the statuses, (n,) each."""
    speed = abs(scene.operation.inner_speed - scene.operation.outer_speed)
    loads, statuses = zip(
        *(rule.requested(scene.bearing, speed) for rule in RULES.values()), strict=True
    )
    return np.array(loads), np.array(statuses)
