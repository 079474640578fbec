"""Where a cage runs away: the fold of the balance of torques between its rollers and what drags it.

- The rollers spin freely: each takes the spin that both rings, its inertia and what resists its rolling leave it. The
  torque with which they then drive the cage, `rollslip.motion.torque_balance`, is the drag that can be carried at that
  cage slip. Over slip it has a maximum. A smaller drag is carried at a smaller slip; where a steady drag grows beyond
  the maximum no slip balances it any more, and the cage falls back until it all but stands: its slip runs away.
- It is the largest drag of study steady-slip with conventional friction, found by a shorter way.
- The maximum is flat and a motion of the rollers is dear, so it is looked for with few slices, the laws that the scene
  names and rollers without inertia, whose balances at all slips are found at once. From there it is climbed with all
  slices, the laws of the plan and inertia. The range ends where a law has no value.
- The maximum belongs to the rollers alone. A drag that falls with slip, as that of the oil on a land at rest does, may
  be in balance with them beyond it: there slip grows steeply with the drag, but stays. One that rises with slip runs
  away before.
- Where the drags of the scene are known, the smallest slip at which the same balance carries them is where the cage
  runs: that of study steady-slip with conventional friction.
"""

import math
from collections.abc import Callable

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.critical import slip_grid
from rollslip.bearing.drags import Drags
from rollslip.bearing.raceway import Array, LoadedContacts, Raceway
from rollslip.errors import ConvergenceError, DomainError
from rollslip.motion.lattice import Torques, highest, maximum
from rollslip.motion.torque_balance import Conventional, Spin, TorqueBalance, effective_curves
from rollslip.units import format_quantity

#: Cage slips, slips with loads of their own, and slices with which the maximum is looked for, at one instant.
_SLIPS, _LOADS, _SLICES = 17, 5, 12
#: Positions of an orbit, at least, on which rollers with inertia are followed.
_POSITIONS = 56
#: Steps by which the maximum is climbed, relative to the slip, and the one at which it is found.
_FIRST, _FOUND = 0.1, 2e-3
_MOST_SLIPS = 24
#: Points that a polynomial goes through near the maximum, and by how much it may miss the torque there.
_FIVE, _SMOOTH = 5, 1e-5
#: Largest cage slip at which it is looked whether the cage runs away where no study says one.
_RANGE = 0.95
#: Share of the largest drag below which a cage is far from running away, whatever effective friction is off.
_FAR = 0.5
#: By how much the quick look may be off, relative to the torque.
_OFF = 0.15
#: Relative accuracy of the slip at which the cage runs.
_RUNS = 1e-4
#: How the status of a cage begins that is driven, and of one that has no balance.
DRIVEN, NOWHERE = "what acts on the cage drives it", "the cage runs at no slip"
#: What a maximum has to stand out by from the end of the range, relative to it; a slip at which the cage hardly turns.
_FLAT, _STANDS = 1e-6, 0.94


@attrs.frozen
class Runaway:
    """The cage slip at which a cage runs away, and the drag [N m] there: NaN where ``status`` says why.

    ``slips`` and ``torques`` [N m] are those among which it was looked for, about where they are.
    """

    slip: float
    drag: float
    status: str
    slips: Array = attrs.field(factory=lambda: np.empty(0), eq=False)
    torques: Array = attrs.field(factory=lambda: np.empty(0), eq=False)


@attrs.frozen
class Running:
    """The least cage slip at which rollers carry the drags of a scene, and their torque [N m]; see ``status``."""

    slip: float
    drag: float
    status: str


def runaway(assembly: Assembly, instants: int, largest: float, allow: str, *, effective: bool = False) -> Runaway:
    """Locate the largest drag that the rollers of a bearing carry, over the cage slips up to the largest.

    Parameters
    ----------
    assembly : Assembly
        The bearing, with slices and laws as they were chosen, without its resistance to rolling.
    instants : int
        Instants of a roller pitch; rollers are followed on 56 positions of the orbit or more.
    largest : float
        Largest cage slip.
    allow : str
        Setting that widens the range, for the status.
    effective : bool
        By the effective friction of the raceways in place of that of every slice.

    Returns
    -------
    Runaway
        Place and height of the maximum; the place is known to about a thousandth of itself where it is flat.
    """
    slips, torques, refusal = scan(assembly, largest, effective=effective)
    found = _largest(assembly, instants, slips, torques, refusal, allow, effective)
    return attrs.evolve(found, slips=slips, torques=torques)


def _largest(
    assembly: Assembly, instants: int, slips: Array, torques: Array, refusal: str, allow: str, effective: bool
) -> Runaway:
    """Climb the maximum from those of a scan."""
    if not slips.size:
        return _unknown(refusal)
    best, end = int(np.argmax(torques)), float(slips[-1])
    if not torques[best] > 0.0:
        return _none(f"the rollers do not drive the cage at any slip up to {end:.4g}: more resists their rolling")
    if best == slips.size - 1 or torques[best] - torques[-1] > _FLAT * torques[best]:
        try:
            balance, start = rollers(assembly, instants, effective=effective), _start(slips, torques)
            found = _shared(balance, start, end) or _climbed(balance.torque, start, end)
        except (DomainError, ConvergenceError) as error:
            return _unknown(str(error))
        if found is not None:
            return Runaway(*found, "found")
    further = f"beyond, {refusal}" if refusal else f"raise {allow} to look further"
    if end > _STANDS and not refusal:
        further = "there it all but stands"
    return _none(
        f"the cage was not found to run away up to a slip of {end:.4g}, where the rollers carry the largest drag, "
        f"{torques[best]:.3g} N m; {further}"
    )


@attrs.frozen
class Reserve:
    """Largest drag that the rollers carry over the drags of a scene; below 1 the cage skids.

    ``status`` begins with one of `FOUND`, `AT_LEAST` and `SKIDS`; else it says why there is none, the factor is NaN.
    """

    factor: float
    status: str


#: The reserve as it is; one that no fold ends; less than the drags; and none.
FOUND, AT_LEAST, SKIDS = "found", "at least", "the cage skids"


def reserve(assembly: Assembly, instants: int, away: Runaway, runs: Running) -> Reserve:
    """Return the reserve of drag: the largest drag over that of the scene where the cage runs.

    Where nothing runs away up to the end of the range, the torque there is carried at least, and over the drags where
    the cage runs, or without slip where these are larger, it is a lower bound: drags that fall with slip, as churning
    does, would let a cage that has slowed down look safe. With a balance it is 1 at least. Where it is not known where
    the cage runs away, the quick look bounds it. Where the cage has no balance, or runs beyond the slip of running
    away, it is less than 1: the torque at the most favourable of the slips that were looked at over the drags there,
    by the quick look where there is no fold.

    Parameters
    ----------
    assembly, instants
        As `runaway` takes them.
    away, runs
        What `runaway` and `running` found.
    """
    if assembly.scene.cage is None or not away.slips.size:
        return Reserve(math.nan, runs.status)
    balance = rollers(assembly, instants)
    if runs.status == FOUND and not runs.slip > away.slip:  # NaN where there is no fold
        if not runs.drag > 0.0:
            return Reserve(math.inf, f"{AT_LEAST}: no torque drags the cage")
        if not math.isnan(away.slip):
            return Reserve(away.drag / runs.drag, FOUND)
        end = float(away.slips[-1])
        said = f"{AT_LEAST}: up to a slip of {end:.4g} the cage does not run away"
        try:
            carried = balance.torque(end)
        except (DomainError, ConvergenceError) as error:
            carried, said = (1.0 - _OFF) * float(away.torques.max()), f"{AT_LEAST}, by a quick look: {error}"
        return Reserve(max(carried / max(runs.drag, -balance.drag(0.0)), 1.0), said)
    if runs.status.startswith(DRIVEN):
        return Reserve(math.inf, f"{AT_LEAST}: {runs.status}")
    if not (runs.status == FOUND or runs.status.startswith(NOWHERE)):
        return Reserve(math.nan, runs.status)
    known = zip((*away.slips.tolist(), away.slip), (*away.torques.tolist(), away.drag), strict=True)
    shares = [torque / -balance.drag(slip) for slip, torque in known if torque > 0.0 and balance.drag(slip) < 0.0]
    return Reserve(min(max(shares, default=0.0), 1.0), f"{SKIDS}: its drags are more than the rollers carry")


@attrs.frozen
class Near:
    """What effective friction leaves unknown near the slip of running away: in words, and relative to the drag."""

    text: str
    off: float


def near_running_away(assembly: Assembly, slip: float | None = None) -> Near | None:
    """Say what effective friction leaves unknown of a cage at a slip; None where it is far from running away.

    Effective friction is off by some share of the largest drag. The cage is near where the drag that it carries at the
    slip is less than twice that share below the largest one by either friction. Where it is less than half of it,
    effective friction is not asked: it is off by 23 % at most (docs/tables/runaway_effective_summary.csv).

    Parameters
    ----------
    assembly : Assembly
        The bearing, with few slices.
    slip : float, optional
        The cage slip; by default that at which its drags are carried, or where they are not, that of running away.
    """
    exact = runaway(assembly, 1, _RANGE, "")
    if slip is None:
        slip = running(assembly, 1, exact).slip
        slip = exact.slip if math.isnan(slip) else slip
    carried = rollers(assembly, 1).torque(slip) if slip > 0.0 else 0.0
    if slip < exact.slip and carried < _FAR * exact.drag:
        return None
    simple = runaway(assembly, 1, _RANGE, "", effective=True)
    known = [one for one in (exact, simple) if not math.isnan(one.slip)]
    if not known or math.isnan(slip):
        return None
    off = abs(simple.drag / exact.drag - 1.0) if len(known) == 2 else math.inf
    least = min(known, key=lambda one: one.drag)
    if slip < least.slip and carried < (1.0 - 2.0 * min(off, 0.5)) * least.drag:
        return None
    where = (
        f"with a cage slip of {100.0 * slip:.3g} % the cage is near that of running away, {100.0 * known[0].slip:.3g} %"
    )
    if len(known) < 2:
        return Near(f"{where}, and it does so by one of both frictions alone", off)
    return Near(f"{where}, where effective friction is off by {100.0 * off:.2g} % of the drag", off)


def running(assembly: Assembly, instants: int, away: Runaway) -> Running:
    """Locate the least cage slip at which the rollers of a bearing carry the drags of its scene.

    Parameters
    ----------
    assembly, instants
        As `runaway` takes them.
    away : Runaway
        What it found by conventional friction: slips among which a balance is looked for.

    Returns
    -------
    Running
        The slip is known to a ten-thousandth of itself. Without any drag it is zero.
    """
    balance = rollers(assembly, instants)
    if balance.rolls_freely:
        return Running(0.0, 0.0, "found")
    if not away.slips.size:
        return _not_running(away.status)
    about = dict(zip(map(float, away.slips), map(float, away.torques), strict=True))
    if not math.isnan(away.slip):
        about[away.slip] = away.drag
    slips = [0.0, *sorted(about)]
    try:
        if balance.excess(0.0) > 0.0:
            return _not_running(f"{DRIVEN}: it runs faster than its epicyclic speed")
        found = (k for k, slip in enumerate(slips) if slip and about[slip] + balance.drag(slip) > 0.0)
        high = next(found, max(range(len(slips)), key=lambda k: about.get(slips[k], -math.inf)))
        while balance.excess(slips[high - 1]) > 0.0:
            high -= 1
        while high < len(slips) - 1 and not balance.excess(slips[high]) > 0.0:
            high += 1
        if balance.excess(slips[high]) > 0.0:
            slip = _crossing(balance.excess, slips[high - 1], slips[high])
            return Running(slip, 0.0 - balance.drag(slip), "found")
    except (DomainError, ConvergenceError) as error:
        return _not_running(f"it is not known at which slip the cage runs: {error}")
    most = max(about, key=lambda slip: about[slip])
    drag, carried = (format_quantity(torque, "N m", 3) for torque in (-balance.drag(most), about[most]))
    return _not_running(
        f"{NOWHERE} up to {slips[-1]:.4g}: where the rollers carry most, {carried} at a slip of "
        f"{most:.3g}, the drags of the scene are {drag}"
    )


def _crossing(excess: Callable[[float], float], low: float, high: float) -> float:
    """Where an excess rises through zero: regula falsi, an end that stays twice counts half (Illinois).

    SciPy's would do, but importing it takes longer than all of this.
    """
    below, above, before, at, moved = excess(low), excess(high), 0, high, math.inf
    while below < 0.0 < above and moved > _RUNS * at:
        last, at = at, high - above * (high - low) / (above - below)
        value, moved = excess(at), abs(at - last)
        side = 1 if value > 0.0 else -1
        half = 0.5 if side == before else 1.0
        if side > 0:
            high, above, below = at, value, below * half
        else:
            low, below, above = at, value, above * half
        before = side
    return at if below < 0.0 else low


def rollers(assembly: Assembly, instants: int, *, effective: bool = False, inertia: bool = True) -> TorqueBalance:
    """Return the balance of torques of a bearing, resistance to rolling and pockets with it, on instants or more."""
    bearing, drags = assembly.with_resistance(), assembly.cage.drags
    instants = max(instants, -(-_POSITIONS // assembly.scene.bearing.rollers))
    curves = effective_curves(bearing, instants) if effective else None
    return TorqueBalance(bearing, drags, instants=instants, effective=curves, inertia=inertia)


def _none(status: str) -> Runaway:
    return Runaway(np.nan, np.nan, status)


def _not_running(status: str) -> Running:
    return Running(np.nan, np.nan, status)


def _unknown(why: str) -> Runaway:
    return _none(f"it is not known where the cage runs away: {why}")


def scan(assembly: Assembly, largest: float, *, effective: bool = False) -> tuple[Array, Array, str]:
    """Return 17 cage slips above zero, torques there, (n,), and what ended the range early; a quick first look.

    Without inertia, on few slices and with the laws of the scene: mostly within a few percent.
    """
    own = assembly.resolution
    few = attrs.evolve(
        own, slices=min(_SLICES, own.slices), quadrature="equal", boundary=True, traction="named", traction_error=0.0
    )
    slips, refusal = slip_grid(largest, _SLIPS + 1)[1:], ""
    # no bound is watched on slips that nobody asked for
    simple = assemble(assembly.scene, few) if assembly.inner.chain.bounds else assembly.at(few)
    while slips.size:
        try:
            if effective:
                balance = rollers(simple, 1, effective=True, inertia=False)
                return slips, np.array([balance.torque(float(slip)) for slip in slips]), refusal
            return slips, free_torques(simple.with_resistance(), simple.cage.drags, 1, slips, _LOADS), refusal
        except (DomainError, ConvergenceError) as error:
            slips, refusal = slips[:-1], str(error)
    return slips, slips, refusal


def free_torques(bearing: Assembly, drags: Drags, instants: int, slip: Array, few: int = 0) -> Array:
    """Return the torque on the cage of rollers without inertia at cage slips above zero, all found at once.

    Parameters
    ----------
    bearing : Assembly
        The bearing, with its resistance to rolling.
    drags : Drags
        What resists the rollers in their pockets.
    instants : int
        Instants of a roller pitch.
    slip : ndarray
        Cage slips S_c, (n,).
    few : int, optional
        At how many of them the loads are found, which are linear over centrifugal force between; by default at all.

    Returns
    -------
    ndarray
        Torque [N m], positive where it drives, (n,).

    Raises
    ------
    DomainError
        If a law has no value there, or the epicyclic cage speed is zero.
    ConvergenceError
        If the loads or the spin of a roller are not found.
    """
    balance = TorqueBalance(bearing, drags, instants=instants, inertia=False)
    half = bearing.scene.bearing.rollers * instants // 2 + 1  # positions k and -k of the orbit carry the same
    if few:
        key = ("free", instants, few, slip.tobytes())
        rings = bearing.kept(key, instants, lambda: _half_orbits(balance, slip, few))
    else:
        rings = _half_orbits(balance, slip, slip.size)
    inner, outer = (Conventional(of.on(own)) for of, own in zip(rings, bearing.raceways, strict=True))
    spin = Spin(balance, np.repeat(slip, half), (inner, outer), half * slip.size)
    torque = spin.on_cage(spin.balanced())[0].reshape(slip.size, half).sum(axis=1)
    return np.asarray(np.sign(bearing.kinematics.epicyclic_cage_speed) * torque / instants)


def _half_orbits(balance: TorqueBalance, slip: Array, few: int) -> tuple[LoadedContacts, LoadedContacts]:
    """Loads on inner and outer ring over half an orbit at each cage slip, solved at few of them."""
    bearing, instants = balance.assembly, balance.instants
    solved = np.unique(np.linspace(0, slip.size - 1, few).astype(int))
    loads = [bearing.load_distribution(instants, balance.cage_speed(float(slip[k]))) for k in solved]
    positions = bearing.scene.bearing.rollers * instants
    half = positions // 2 + 1
    count = np.full(half, 2.0)
    count[0] = 1.0
    count[-1] -= positions % 2 == 0 and positions > 1

    force = balance.cage_speed(0.0) ** 2 * (1.0 - slip) ** 2  # in proportion
    last = np.clip(np.searchsorted(solved, np.arange(slip.size)), 1, solved.size - 1)
    before, after = force[solved[last - 1]], force[solved[last]]
    share = ((force - before) / np.where(after == before, 1.0, after - before))[:, None, None]

    def of(raceway: Raceway, each: list[Array]) -> LoadedContacts:
        halves = np.array([load.swapaxes(0, 1).reshape(positions, -1)[:half] for load in each])
        whole = halves[last - 1] + share * (halves[last] - halves[last - 1]) if few < slip.size else halves
        return LoadedContacts(
            raceway, whole.reshape(-1, bearing.slices), bearing.widths, 1.0, np.tile(count, slip.size)
        )

    return (
        of(bearing.inner, [one.inner_load for one in loads]),
        of(bearing.outer, [one.outer_load for one in loads]),
    )


def _start(slips: Array, torques: Array) -> float:
    """Where the torque of a scan is largest, by the parabola through three of its slips."""
    best = int(np.argmax(torques))
    if not 0 < best < slips.size - 1:
        return float(slips[best])
    (left, at, right), (before, top, after) = (of[best - 1 : best + 2].tolist() for of in (slips, torques))
    fall, rise = (after - top) / (right - at), (top - before) / (at - left)
    return float(at + 0.5 * (rise * (right - at) + fall * (at - left)) / (rise - fall))


def _shared(balance: TorqueBalance, start: float, end: float) -> tuple[float, float] | None:
    """Place and height of the maximum near a start by slips that samples share; None if they do not tell."""
    torques = Torques(balance, end)
    if balance.assembly.inner.chain.bounds or (best := highest(torques, start)) is None:
        return None  # bounds have to be looked at on all slices
    return maximum(torques, best, _FOUND, _SMOOTH)


def _climbed(torque: Callable[[float], float], start: float, end: float) -> tuple[float, float] | None:
    """Place and height of the maximum near a start; None if it is the end of the range.

    Three slips that hold it between them, moved on while they do not; then the vertex of the polynomial through the
    nearest five, until it moves no more. Where the torque has a corner, because a roller changes its motion at once, it
    misses, and intervals are halved.
    """
    step = min(_FIRST, end / start - 1.0) or _FIRST
    start = min(start, end / (1.0 + step))
    known = {slip: torque(slip) for slip in (start * (1.0 - step), start, min(start * (1.0 + step), end))}
    height, smooth = np.nan, True
    while len(known) < _MOST_SLIPS:
        slips = np.array(sorted(known))
        torques = np.array([known[float(slip)] for slip in slips])
        best, last = int(np.argmax(torques)), slips.size - 1
        at, largest = float(slips[best]), float(torques[best])
        if best == last and at >= end:
            if slips[-2] >= (1.0 - _FOUND) * end:
                return None
            to = (1.0 - _FOUND) * end  # it may have a corner on the way
        elif best in (0, last):
            step = min(2.0 * step, 0.5)
            to = min(at * (1.0 + step), end) if best else at * (1.0 - step)
        else:
            below, above = at - slips[best - 1], slips[best + 1] - at
            if max(below, above) <= _FOUND * at:
                return at, largest
            first = min(max(best - _FIVE // 2, 0), max(slips.size - _FIVE, 0))
            near = slice(first, first + _FIVE)
            to, height = _vertex(slips[near], torques[near])
            if smooth and abs(to - at) <= _FOUND * at and height - largest <= _SMOOTH * largest:
                return to, height
            if not smooth or to == at:
                to, height = at + 0.5 * (above if above > below else -below), np.nan
        known[to] = torque(to)
        smooth = not abs(known[to] - height) > _SMOOTH * abs(height) or slips.size < _FIVE
    raise ConvergenceError(f"the torque of the rollers has no maximum that can be located near a slip of {start:.3g}")


def _vertex(slips: Array, torques: Array) -> tuple[float, float]:
    """Place and height of the largest value of the polynomial through points, between the neighbours of the largest."""
    curve, best = np.polynomial.Polynomial.fit(slips, torques, slips.size - 1), int(np.argmax(torques))
    turns = curve.deriv().roots()
    real = np.append(turns.real[np.abs(turns.imag) <= _FLAT * slips[-1]], slips[best])
    inside = real[(real > slips[best - 1]) & (real < slips[best + 1])]
    at = float(inside[np.argmax(curve(inside))])
    return at, float(curve(at))
