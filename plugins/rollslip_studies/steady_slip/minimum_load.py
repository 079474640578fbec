"""The least radial load at which a cage slips no more than is named, and those that makers of bearings ask for.

- The first is a property of this bearing, its oil and its drags: the load at which the rollers just drive the cage as
  much as the drags resist it at that slip. A larger load slips less. Where more torque than there is left over at a
  smaller slip, the cage skids before: then it is the load at which that maximum just carries the drag.
- The others are rules of thumb for any oil, speed and cage, and differ among themselves by a factor of four to five
  (bearing NU 2220 at its reference speed: SKF 3.9 kN, Schaeffler 7.4 kN, NTN 17.8 kN). They say what is usual, not what
  slips.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import Array
from rollslip.datasets import Bearing, Catalogue
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.words import SWITCHED_OFF, Status
from rollslip.scene.relations import skf_minimum_load
from rollslip.scene.values import Scene
from rollslip.search import bracketed, secants, vertex
from rollslip.units import GRAVITY, format_quantity
from rollslip_studies.motion.torque_balance import RANGE, TorqueBalance

__all__ = [
    "RULES",
    "Rule",
    "largest_excess",
    "minimum_load",
    "minimum_loads_of_makers",
    "rollers_weight",
    "static_rating",
]

#: By which factor loads are left and right of that of the scene at most, and by which the search widens.
_FARTHEST: Final = 1e6
_WIDER: Final = 4.0
#: Relative accuracy of the load.
_FOUND: Final = 1e-4
#: Load from which the search begins where the scene has none [N].
_ANY: Final = 1.0
#: Slips at which a maximum is looked for, up to how many times the slip, how far apart their logarithms are, and from
#: which share of the drag on: between two of them the torque may rise as they do.
_LOOKED = 25
_BESIDE = 1.3
_APART = 0.25
_CLEAR = 0.7
#: From which share on those of the way up count, which is of few loads of a roller; logarithms of slips around one by
#: which it is told on all slices, and how near these may be to others; how often it is looked for anew.
_RIVAL = 0.9
_AROUND = (-0.2, -0.1, 0.0, 0.1, 0.2)
_NEAR = 0.03
_ROUNDS = 4


Balances = Callable[[float], TorqueBalance]


def minimum_load(
    balance: Balances, load: float, slip: float, weight: float = 0.0
) -> tuple[float, str, tuple[float, ...]]:
    """Return the least radial load [N] that keeps the steady slip at a given one or below, and "found".

    Or NaN and why there is none. Third are the slips by which it is told: that one, and some around maxima of the
    torque before or beside it.

    Parameters
    ----------
    balance : callable
        Balance of torques of the bearing at a radial load [N].
    load : float
        Where the search begins [N].
    slip : float
        The cage slip, above 0.
    weight : float, optional
        That of the rollers [N], which the balance leaves out: below it nothing tells whether the cage skids before.
    """
    slips: tuple[float, ...] = (slip,)

    def excess(log: float) -> float:
        return largest_excess(balance(math.exp(log)), slips, slip)[1]

    if balance(load).rolls_freely:
        return math.nan, f"{Status.NO_LOAD_NEEDED}: {SWITCHED_OFF}", ()
    try:
        found = load or _ANY
        at = slip
        over = excess(math.log(found))
        drag = -balance(found).drag(slip)
        for _ in range(_ROUNDS):
            begin = math.log(found)
            found = _near(excess, begin, over, drag)
            if math.isnan(found):
                found, status = _searched(excess, begin, over, slip)
                if status:
                    return math.nan, status, ()
            if found < weight:
                break
            slips = (slip, *_around_maxima(balance(found), slip))
            at, over = largest_excess(balance(found), slips, slip)
            if abs(over) <= 4.0 * _FOUND * abs(drag):
                break
        balance(found).orbit(
            at
        )  # what the search asks is compiled: here what a plan left out is watched
    except (DomainError, ConvergenceError) as error:
        return math.nan, f"not found: {error}", ()
    return found, Status.FOUND if at == slip else f"{Status.FOUND_AT_SKIDDING} {at:.2g} on", slips


def largest_excess(
    balance: TorqueBalance, slips: Sequence[float], slip: float
) -> tuple[float, float]:
    """Return the slip up to a given one at which most torque is left over to speed the cage up, and that [N m].

    Some slips tell it: that one, and some around maxima, between which it is the vertex of a parabola.
    """
    at = np.unique(slips)
    over = balance.torques(at) + np.array([balance.drag(one) for one in at.tolist()])
    best = int(np.argmax(over[at <= slip]))
    if 0 < best < at.size - 1 and over[best] >= over[best + 1]:
        place, height = vertex(np.log(at[best - 1 : best + 2]), over[best - 1 : best + 2])
        if place < math.log(slip):
            return math.exp(place), height
        best = int(np.flatnonzero(at == slip)[0])
    return float(at[best]), float(over[best])


def _around_maxima(balance: TorqueBalance, slip: float) -> Iterator[float]:
    """Slips around maxima of the torque that is left over, which may be reached before a slip, by few loads."""
    most = max(RANGE, slip)
    slips = _BESIDE * slip * np.exp(-_APART * np.arange(_LOOKED)[::-1])
    slips = slips[slips <= most]
    if not any(_maxima(balance, slips, balance.torques(slips, few=True), _CLEAR)):
        return
    path = [one for one in balance.way(most).path if one.slip <= _BESIDE * slip]
    known = [slip]
    for peak in _maxima(
        balance,
        np.array([one.slip for one in path]),
        np.array([one.torque for one in path]),
        _RIVAL,
    ):
        for one in (peak * math.exp(step) for step in _AROUND):
            if one <= most and min(abs(math.log(one / other)) for other in known) > _NEAR:
                known.append(one)
                yield one


def _maxima(
    balance: TorqueBalance, slips: Array, torques: Array, fraction: float
) -> Iterator[float]:
    """Slips at which more torque is left over than at both next to them, and at least a share of the drag is there."""
    drags = -np.array([balance.drag(one) for one in slips.tolist()])
    over = torques - drags
    inside = (
        (over[1:-1] > over[:-2])
        & (over[1:-1] >= over[2:])
        & (torques[1:-1] > fraction * drags[1:-1])
    )
    yield from slips[1:-1][inside].tolist()


def rollers_weight(assembly: Assembly) -> float:
    """Return the weight of all rollers [N] that the balance of loads leaves out, 0 where the scene says how it acts."""
    left_out = assembly.scene.operation.gravity_direction is None
    return GRAVITY * assembly.roller_mass * assembly.scene.bearing.rollers * left_out


def _near(excess: Callable[[float], float], begin: float, over: float, drag: float) -> float:
    """The load to which secants over its square lead, with which that drives rollers which resists; NaN if nowhere."""
    torque = over + drag
    steps = math.log(_WIDER)
    guess = -0.5 * math.log(torque / drag) if torque > 0.0 < drag else math.copysign(steps, -over)
    guess = min(max(guess, -steps), steps) or _FOUND

    def squared(square: float) -> float:
        return excess(begin + 0.5 * math.log(square))

    at = math.exp(2.0 * guess)
    value = squared(at)
    slope = (value - over) / (at - 1.0)
    if not slope > 0.0:
        return math.nan
    start = at - value / slope
    within = min(at, 1.0) / _WIDER**2, max(at, 1.0) * _WIDER**2
    if not within[0] <= start <= within[1]:
        return math.nan
    found = secants(squared, start, slope, tolerance=_FOUND * start, within=within)
    return math.exp(begin) * math.sqrt(found[0]) if found and found[1] > 0.0 else math.nan


def _searched(
    excess: Callable[[float], float], begin: float, over: float, slip: float
) -> tuple[float, str]:
    """The load at which an excess over its logarithm passes zero, or NaN and why there is none."""
    at = before = begin
    value = last = over
    step = -math.log(_WIDER) if over > 0.0 else math.log(_WIDER)
    while (value > 0.0) == (over > 0.0):
        if abs(at - begin) > math.log(_FARTHEST):
            ends = " and ".join(
                format_quantity(math.exp(end), "N", 3) for end in sorted((begin, at))
            )
            way = "less" if over > 0.0 else "more"
            serves = Status.ANY_LOAD if over > 0.0 else Status.NO_LOAD
            return math.nan, f"{serves}: between {ends} the steady slip stays {way} than {slip:g}"
        before = at
        last = value
        at = at + step
        value = excess(at)
    return math.exp(bracketed(excess, before, at, last, value, tolerance=_FOUND)), ""


def static_rating(bearing: Bearing) -> float:
    """Return the basic static radial load rating C0r [N] of one row of rollers.

    C0r = 44 (1 - D/dm) Z L D after ISO 76, with diameter D and effective length L of a roller and pitch diameter dm in
    mm. Makers' own values differ by some per cent.
    """
    pitch = 0.5 * (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter)
    size = 1e6 * bearing.roller_length * bearing.roller_diameter
    return 44.0 * (1.0 - bearing.roller_diameter / pitch) * bearing.rollers * size


@attrs.frozen
class Rule:
    """A maker's rule of the least radial load: the load [N] by bearing and speed [rad/s], where it is from, its grade.

    ``takes`` are the keys of ``bearing.catalogue`` that it reads, ``grows_with`` one without which it is that at rest.
    """

    load: Callable[[Bearing, float], float]
    text: str
    grade: str
    takes: tuple[str, ...] = ()
    grows_with: str = ""

    def requested(self, bearing: Bearing, speed: float) -> tuple[float, str]:
        """Return the load [N] and "found" or that it is the one at rest; or NaN and what the scene has to give."""
        given = bearing.catalogue or Catalogue()
        missing = [f"bearing.catalogue.{key}" for key in self.takes if getattr(given, key) is None]
        if missing:
            return math.nan, f"needs {' and '.join(missing)} of the maker's catalogue"
        if self.grows_with and getattr(given, self.grows_with) is None:
            return self.load(
                bearing, speed
            ), f"{Status.FOUND_AT_REST}; with speed it grows by bearing.catalogue.{self.grows_with}"
        return self.load(bearing, speed), Status.FOUND


def _nke(bearing: Bearing, speed: float) -> float:
    catalogue: Any = bearing.catalogue
    return float(0.02 * catalogue.dynamic_rating)


#: Maker -> its rule. SKF's mean diameter is that of bore and outside, 0 to 1.2 % below the pitch circle.
RULES: Final[Mapping[str, Rule]] = {
    "NTN": Rule(
        lambda bearing, speed: 0.040 * static_rating(bearing),
        "0.040 C0r for roller bearings, catalogue 2203/E, section 8.4",
        "A",
    ),
    "Schaeffler": Rule(
        lambda bearing, speed: static_rating(bearing) / 60.0, "C0r/60, recalled, not read", "C"
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
    """Return the least load of each of the `RULES` [N], and "found" or what the scene has to give."""
    speed = abs(scene.operation.inner_speed - scene.operation.outer_speed)
    loads, statuses = zip(
        *(rule.requested(scene.bearing, speed) for rule in RULES.values()), strict=True
    )
    return np.array(loads), np.array(statuses)
