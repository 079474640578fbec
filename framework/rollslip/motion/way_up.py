"""The way up: the motions that the rollers of a bearing take while the drag on its cage is raised slowly from none.

- All rollers see the same orbit, so the periodic spin of one is all, at each cage slip. It solves a scalar equation that
  is periodic in the angle, so its motions are ordered: rollers that are sent round from rolling on the outer ring, and
  from rolling on the inner one, come to the last and the first of them. If these agree there is one motion at that slip.
- Where tractions have passed their maximum a roller sticks to one ring and slides on the other, and mostly it may do so
  on either: an imperfect pitchfork. From small slip goes on one of both motions. The other begins at a fold, and only a
  cage from larger slips ever gets to it.
- Differences over whole positions have motions besides that no roller has: jumps from ring to ring that may stand at
  any position. So a motion counts only if rollers that are *sent round* come to it, by implicit Euler, from one position
  to the first balance of the next; what backward differences of second order make of it is what is told.
- Where a motion ends on the way up, rollers go to the one that they come to from there. At a maximum of the torque the
  slip jumps to the next slip of the way that carries the drag. The cage runs away at the first maximum beyond which the
  slip at least doubles, or nothing in the range carries the drag.
- With resistance to rolling, or friction in the pockets, rollers slip without the cage. Rolling on one ring is no bound
  any more on that side: it goes to where no position of the orbit lets a roller slip more.
- Nothing depends on what was asked before: all slips of a way are chosen by the bearing and its range alone.
"""

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array, LoadedContacts
from rollslip.errors import ConvergenceError, DomainError
from rollslip.motion.torque_balance import SLOW, Conventional, Curved, Effective, Spins, TorqueBalance

#: Cage speeds whose loads are solved, even in centrifugal force, between which loads are linear; loads of a roller.
_LOADS, _FEW = 13, 8
#: Smallest slip; steps of the place of a slip, ln(S/(1 - S)), and the gap to which the end of a motion is found.
_SMALLEST, _STEP = 1e-4, 0.25
_CORNER: Final = _STEP / 512.0
#: Orbits at most, by implicit Euler and by differences of second order; exactness of balances, relative to the bracket,
#: with inertia and without.
_ORBITS, _LONG, _EXACT, _EXACTLY = 8, 24, 1e-6, 1e-12
#: Step, relative to the roller slip, at which a motion is found, and what is left of one that repeats.
_SETTLED, _REPEATS = 1e-7, 1e-3
#: Mean shares, by load, by which motions are two, and up to which one goes on from another.
_TWO, _GOES_ON = 0.02, 0.15
#: Part of the weights of positions that is even where unloaded rollers brake; least roller slip that counts there.
_EVEN, _LEAST = 0.5, 1e-9
#: Torque at an end of the bracket that is rounding, relative to the largest; how wide it gets, in roller slips.
_IDLE, _WIDEST = 1e-12, 64.0
#: Error of a motion of first order beyond which it is left out.
_WRONG = 1e-2
#: Share of a maximum that counts as the same drag, exactness of its height, and margin for what lies between slips.
_CLOSE, _FOUND, _SAFETY, _ROUNDS = 1e-3, 1e-6, 2.0, 14
#: How often positions are told apart once more where the slip jumps, and half the width of that, in places.
_FINER, _BESIDE = 4, 0.04
#: Exactness of a steady slip, relative to it; steps towards one.
_STEADY, _SECANTS = 1e-9, 40
#: Slips with more torque than this share of the largest below are looked at closely.
_FALL: Final = 2.0 * _CLOSE


def place_of(slip: float) -> float:
    """Return the place ln(S/(1 - S)) of a cage slip between 0 and 1."""
    return math.log(slip / (1.0 - slip))


def slip_of(place: float) -> float:
    """Return the cage slip at a place."""
    return 1.0 / (1.0 + math.exp(-place))


@attrs.frozen(eq=False)
class Motion:
    """A motion of the rollers at a steady cage slip.

    Attributes
    ----------
    slip, torque : float
        Cage slip, and mean torque of all rollers on the cage [N m], positive where it drives.
    share : ndarray
        Roller slips along the orbit over ``unit``, which goes with the cage slip, (K,).
    unit : float
        Roller slip of share one.
    sure : bool
        Whether it repeats, is held by the rollers and was found by differences of second order, or is told with its
        error.
    error : float
        What it leaves of the torque, relative, where it is of first order only.
    linked : bool
        Whether it goes on from the motion at the slip below.
    """

    slip: float
    torque: float
    share: Array
    unit: float
    sure: bool
    error: float = 0.0
    linked: bool = True

    @property
    def place(self) -> float:
        """Place of the slip."""
        return place_of(self.slip)

    @property
    def roller_slip(self) -> Array:
        """Roller slips at the positions of the orbit, (K,)."""
        return self.share * self.unit


@attrs.frozen
class Jump:
    """A maximum of the torque on the way up, from which the slip jumps.

    Attributes
    ----------
    slip, drag : float
        Cage slip, and the drag [N m]: with more of it the slip jumps.
    to : float
        Slip to which it jumps, NaN if none in the range carries the drag.
    low, high : float
        Slips between which the torque is within a thousandth of the drag.
    error : float
        Of the drag, relative: what slips, positions and loads of a roller leave.
    corner : bool
        Whether a motion of the rollers begins or ends there.
    """

    slip: float
    drag: float
    to: float
    low: float
    high: float
    error: float
    corner: bool

    @property
    def away(self) -> bool:
        """Whether the slip at least doubles, or nothing carries the drag: the cage runs away."""
        return not self.to < 2.0 * self.slip


@attrs.frozen
class Steady:
    """A steady slip on the way up, the torque that it carries [N m], and whether the cage holds it."""

    slip: float
    torque: float
    held: bool
    motion: Motion = attrs.field(eq=False, repr=False)


class Motions:
    """Motions of the rollers of one bearing at many cage slips at once.

    Parameters
    ----------
    balance : TorqueBalance
        The bearing, what resists its rollers, friction of its raceways, instants, and whether rollers have inertia.
    largest : float
        Largest cage slip.
    few : int
        Loads that stand for the slices of a roller.
    """

    def __init__(self, balance: TorqueBalance, largest: float, few: int = _FEW) -> None:
        self.balance, self._largest, self._few = balance, largest, few
        bearing, k, friction = balance.assembly, balance.assembly.kinematics, balance.drags.pocket_friction
        self.positions = bearing.scene.bearing.rollers * balance.instants
        self._pocket = 0.0 if friction is None else friction.coefficient
        self.resists = bearing.inner.chain.resists or self._pocket > 0.0
        self._knots = np.linspace(1.0, (1.0 - largest) ** 2, _LOADS)  # centrifugal force, in proportion
        key = ("knots", balance.instants, largest)
        self._loads = bearing.kept(key, balance.instants, self._solved)
        self._on_inner = -k.inner_radius / k.outer_radius
        spin = 0.5 * bearing.roller_mass * k.roller_radius**2 * k.epicyclic_roller_speed
        pace = abs(balance.cage_speed(0.0)) * self.positions / (2.0 * np.pi)
        self._inertia = spin * pace if balance.inertia else 0.0
        self._tables: dict = {}
        self._idle = self._most = 0.0
        carried = sum(ring[0].sum(axis=1) for ring in self._loads)
        weight = self._loads[0].mean(axis=0).sum(axis=1)
        if self.resists:
            weight = _EVEN * carried.sum() / carried.size + (1.0 - _EVEN) * carried
        self._weight = weight / (weight.sum() or 1.0) / (1.0 - self._on_inner)
        if self.resists:  # what rollers slip without slip of the cage
            rest = self._came_to(np.zeros(1), np.zeros((1, 2)))[0][0, 0]
            self._idle, self._most = max(float(np.abs(rest).mean()), _LEAST), float(np.abs(rest).max())

    def _solved(self) -> tuple[Array, Array]:
        """Loads of both rings at the knots, positions in the sense of the orbit, (knots, K, slices)."""
        balance, loads = self.balance, ([], [])
        for force in self._knots.tolist():
            one = balance.loads(1.0 - math.sqrt(force))
            for ring, of in zip(loads, one, strict=True):
                ring.append(of)
        return np.array(loads[0]), np.array(loads[1])

    def unit(self, slips: Array) -> Array:
        """Roller slips of share one: of rolling on the outer ring, and what rollers slip without the cage."""
        return np.abs(self._lag(slips)) + self._idle

    def _lag(self, slips: Array) -> Array:
        return np.asarray(self.balance.assembly.kinematics.roller_slip_outer_rolling(slips))

    def apart(self, one: Array, two: Array) -> float:
        """Mean difference of shares, by load, relative to that of rolling on either ring."""
        return float(self._weight @ np.abs(one - two))

    def _contacts(self, slips: Array) -> tuple[LoadedContacts, LoadedContacts]:
        """Few loads of both rings for each row of positions."""
        force = (1.0 - slips) ** 2
        j = np.clip(_LOADS - 1 - np.searchsorted(self._knots[::-1], force), 0, _LOADS - 2)
        part = ((force - self._knots[j]) / (self._knots[j + 1] - self._knots[j]))[:, None, None]
        widths, inner = self.balance.assembly.widths, self.balance.assembly.inner

        def of(loads: Array) -> LoadedContacts:
            rows = loads[j] * (1.0 - part) + loads[j + 1] * part
            return LoadedContacts(inner, rows.reshape(-1, rows.shape[2]), widths, 1.0).fewer(self._few)

        return of(self._loads[0]), of(self._loads[1])

    def laid_out(self, slips: Array) -> Spins:
        """Compiled torques of rows of positions, one for each cage slip."""
        balance, k = self.balance, self.balance.assembly.kinematics
        key = ("rows", balance.instants, self._largest, self._few, slips.tobytes())
        made = balance.assembly.kept(key, balance.instants * slips.size, lambda: self._contacts(slips))
        rings = [Conventional(of.on(own)) for of, own in zip(made, balance.assembly.raceways, strict=True)]
        frictions = balance.frictions((rings[0], rings[1]))
        given = [one.ring if isinstance(one, Effective) else one.contacts for one in frictions]
        spins = Spins(
            k, self.positions * slips.size, given, slow=SLOW, pocket=self._pocket, tables=self._tables
        )
        spins.kernel.at(*(np.repeat(lead, self.positions) for lead in k.leads(slips)))
        return spins

    def _bracket(self, slips: Array) -> Array:
        """Roller slips of rolling on either ring, (n, 2), the lower one first."""
        lag = self._lag(slips)
        return np.sort(np.stack((lag, lag * self._on_inner), axis=1), axis=1)

    def _ends(self, spins: Spins, slips: Array) -> Array:
        """Roller slips (n, 2) that an orbit never takes a roller from between: what resists only slows rollers."""
        ends = self._bracket(slips)
        if not self.resists:
            return ends
        step = 0.25 * (ends[:, 1] - ends[:, 0]) + 1.25 * self._most
        ends[:, 1] += step
        while True:
            torques, _, how = spins.kernel.torques(np.repeat(ends[:, 1], self.positions))
            spins.ended(how)
            torques = torques.reshape(slips.size, -1)
            short = (torques < -_IDLE * np.abs(torques).max()).any(axis=1) & (ends[:, 1] < _WIDEST)
            if not short.any():
                return ends
            step *= 2.0
            ends[:, 1] += np.where(short, step, 0.0)

    def _came_to(
        self, slips: Array, starts: Array | None, spins: Spins | None = None
    ) -> tuple[Array, Array, Array, Spins]:
        """Roller slips (n, 2, K) that rollers sent round come to, whether both are one, what is left; from both ends."""
        spins = self.laid_out(slips) if spins is None else spins
        starts = self._ends(spins, slips) if starts is None else starts
        exact = _EXACT if self._inertia else _EXACTLY
        found, met, left, how = spins.kernel.sent_round(
            np.arange(slips.size), self.positions, self._inertia * (1.0 - slips), self._bracket(slips),
            self._wide(slips), starts, _ORBITS, exact,
        )  # fmt: skip
        spins.ended(how)
        if how:
            raise ConvergenceError("rollers that are sent round find no balance on their way")
        return found, met, left, spins

    def _wide(self, slips: Array) -> Array:
        return np.asarray((self.unit(slips) + (0.0 if self._idle else 1e-3 * self.resists)) * (1.0 - self._on_inner))

    def at(self, slips: Array, starts: Array | None = None) -> list[list[Motion]]:
        """Motions at cage slips, one or the two between which all others lie: of rollers sent round from both ends.

        From ``starts``, shares at the first position (n,), it is the one that they come to.
        """
        unit = self.unit(slips)
        begin = None if starts is None else np.repeat((starts * unit)[:, None], 2, axis=1)
        found, met, left, spins = self._came_to(slips, begin)
        shares = found / unit[:, None, None]
        two = [
            row
            for row in np.flatnonzero(~met).tolist()
            if starts is None and self.apart(shares[row, 0], shares[row, 1]) >= (_TWO if left[row].max() < _REPEATS else 0.0)
        ]
        rows, which = np.array([*range(slips.size), *two]), np.array([0] * slips.size + [1] * len(two))
        motions = self._settled(spins, slips, rows, found[rows, which], left[rows, which])
        out = [[motion] for motion in motions[: slips.size]]
        for row, motion in zip(two, motions[slips.size :], strict=True):
            if self.apart(out[row][0].share, motion.share) >= _TWO:
                out[row].append(motion)
        return out

    def _settled(self, spins: Spins, slips: Array, rows: Array, came: Array, left: Array) -> list[Motion]:
        """Motions of second order beside those that rollers came to, which are of first."""
        unit, c, K, Z = self.unit(slips), self._inertia * (1.0 - slips), self.positions, self._rollers
        kernel, weight = spins.kernel, self._weight

        def torques(which: Array, at: Array) -> Array:
            _, _, on_cage, _, how = kernel.settled(rows[which], K, c[rows[which]], at, unit[rows[which]], as_guessed=True)
            spins.ended(how)
            return np.asarray(Z * on_cage)

        if not self._inertia:
            torque = torques(np.arange(rows.size), came)
            return [Motion(float(slips[r]), float(T), at / unit[r], float(unit[r]), sure=True)
                    for r, T, at in zip(rows, torque, came, strict=True)]  # fmt: skip
        at, multiplier, torque, held, how = kernel.settled(rows, K, c[rows], came, unit[rows], _SETTLED)
        spins.ended(how)
        torque, error = Z * torque, np.zeros(rows.size)
        moved = np.abs(at - came) @ weight / unit[rows]
        sure = held & (np.abs(multiplier) < 1.0) & ~((left < _REPEATS) & (moved > _GOES_ON))
        todo = np.flatnonzero(~sure)
        if todo.size:  # Newton's method has failed: differences of second order, in order, as rollers go
            which = rows[todo]
            known = np.repeat(came[todo][:, None], 2, axis=1)
            exactly, _, rest, how = kernel.sent_round(
                which, K, c[which], self._bracket(slips)[which], self._wide(slips)[which], np.ascontiguousarray(known[:, :, 0]), _LONG, _SETTLED,
                known,
            )  # fmt: skip
            spins.ended(how)
            repeats = rest[:, 0] <= 100.0 * _SETTLED
            at[todo] = np.where(repeats[:, None], exactly[:, 0], came[todo])
            torque[todo] = torques(todo, at[todo])
            bend = 0.5 * came[todo] - np.roll(came[todo], 1, axis=1) + 0.5 * np.roll(came[todo], 2, axis=1)
            missed = Z * self._lever * c[which] * np.abs(bend).mean(axis=1) / np.maximum(np.abs(torque[todo]), 1e-300)
            error[todo] = np.where(repeats, 0.0, missed)
            sure[todo] = error[todo] < _WRONG
        return [
            Motion(float(slips[r]), float(torque[k]), at[k] / unit[r], float(unit[r]), bool(sure[k]), float(error[k]))
            for k, r in enumerate(rows)
        ]

    @property
    def _rollers(self) -> float:
        return self.balance.sense * self.balance.assembly.scene.bearing.rollers

    @property
    def _lever(self) -> float:
        """By how much of the torque on the spin a change of it goes to the cage."""
        k = self.balance.assembly.kinematics
        return 1.0 + k.outer_radius / k.roller_radius

    def link(self, below: Motion, motion: Motion) -> Motion:
        """Return a motion, marked by whether it goes on from the one at the slip below."""
        return attrs.evolve(motion, linked=self.apart(below.share, motion.share) <= _GOES_ON)


@attrs.frozen(eq=False)
class WayUp:
    """The motions that rollers take while the drag is raised slowly from none; `way_up` finds them.

    Attributes
    ----------
    path : list of Motion
        By growing slip, from a small one to the end of the range.
    jumps : list of Jump
        Maxima of the torque from which the slip jumps, by growing slip and drag.
    others : list of Motion
        Motions beside it, that only a cage from larger slips has.
    at_rest : float
        Torque of the rollers on a cage that does not slip [N m].
    refusal : str
        Why the range ends early, empty if it does not.
    """

    motions: Motions
    path: list[Motion]
    jumps: list[Jump]
    others: list[Motion]
    at_rest: float
    refusal: str = ""

    @property
    def runs_away(self) -> Jump | None:
        """Where the cage runs away, None if it does nowhere in the range."""
        return next((jump for jump in self.jumps if jump.away), None)

    @property
    def largest(self) -> tuple[float, float]:
        """Slip and torque [N m] of the most that the way carries: at the end of the range where nothing jumps."""
        known = [(one.slip, one.torque) for one in self.path] + [(one.slip, one.drag) for one in self.jumps]
        return max(known, key=lambda one: one[1])

    @property
    def end(self) -> float:
        """Largest slip."""
        return self.path[-1].slip

    @cached_property
    def curve(self) -> tuple[Array, Array]:
        """Slips from none on and torques there [N m], (n,) each."""
        slips, torques = ([0.0], [self.at_rest])
        for motion in self.path:
            slips.append(motion.slip)
            torques.append(motion.torque)
        return np.array(slips), np.array(torques)

    def steady(self, drag: Callable[[float], float]) -> list[Steady]:
        """Return the slips above zero, ascending, at which the way balances a drag.

        Parameters
        ----------
        drag : callable
            Torque of all drags at a cage slip [N m], negative where it resists.

        Returns
        -------
        list of Steady
            The cage holds a slip where with more of it more torque is left to speed it up. A jump over the drag, where
            a motion ends, is none.
        """
        found, below = list[Steady](), self._at_zero()
        left = below[0] + drag(0.0)
        for k, motion in enumerate(self.path):
            right = motion.torque + drag(motion.slip)
            if right == 0.0 or (left < 0.0) != (right < 0.0):
                if k == 0 or motion.linked:
                    found.append(self._between(k, drag, left, right))
            left = right
        return found

    def _at_zero(self) -> tuple[float]:
        return (self.at_rest,)

    def _between(self, k: int, drag: Callable[[float], float], left: float, right: float) -> Steady:
        """The balance between a motion of the path and the one below it: regula falsi (Illinois) on their slips."""
        above = self.path[k]
        low, high = (self.path[k - 1].slip if k else 0.0), above.slip
        held, side, motion, near = right > left, 0, above, above
        below, over = left, right
        for _ in range(_SECANTS):
            at = high if over == 0.0 else high - over * (high - low) / (over - below)
            near = min((m for m in self.path[max(k - 1, 0) : k + 1]), key=lambda m: abs(m.slip - at))
            motion = self.motions.at(np.array([at]), near.share[:1])[0][0]
            value, last = motion.torque + drag(at), (low, high)
            sign = (value < 0.0) == (left < 0.0)
            if sign:
                low, below, over, side = at, value, over * (0.5 if side > 0 else 1.0), 1
            else:
                high, over, below, side = at, value, below * (0.5 if side < 0 else 1.0), -1
            if value == 0.0 or abs(value) <= _STEADY * abs(motion.torque) or high - low <= _STEADY * at or last == (low, high):
                break
        return Steady(motion.slip, motion.torque, held, motion)


class _Search:
    """The way up, and what is largest on it."""

    def __init__(self, motions: Motions) -> None:
        self.motions = motions

    def ways(self, slips: Sequence[float]) -> tuple[list[Motion], list[Motion]]:
        """The way up through slips, and motions beside it: all lie between those that either end leads to."""
        motions, n = self.motions, len(slips)
        pairs = motions.at(np.array(slips))
        others = [motion for pair in pairs if len(pair) > 1 for motion in pair if motion.sure]
        while True:
            way = [pairs[0][0]]
            for pair in pairs[1:]:
                below = way[-1]
                way.append(motions.link(below, min(pair, key=lambda one: motions.apart(one.share, below.share))))
            two = [k for k in range(1, n) if len(pairs[k]) > 1]
            wrong = None
            if two:
                again = motions.at(np.array([slips[k] for k in two]), np.array([way[k - 1].share[0] for k in two]))
                off = (
                    (k, one[0])
                    for k, one in zip(two, again, strict=True)
                    if motions.apart(one[0].share, way[k].share) >= _TWO
                )
                wrong = next(off, None)
            if wrong is None:
                own = {motion.slip: motion.share for motion in way}
                return way, [one for one in others if motions.apart(one.share, own[one.slip]) >= _TWO]
            pairs[wrong[0]] = [wrong[1]]  # and what follows is chosen anew

    def refined(self, way: list[Motion]) -> list[Motion]:
        """Halve intervals beside peaks, and those in which a motion ends, where they may hold more than all below."""
        least = min(0.0, way[0].torque)
        for _ in range(_ROUNDS):
            most, todo = np.maximum.accumulate([motion.torque for motion in way]), []
            for k, (a, b) in enumerate(zip(way[:-1], way[1:], strict=True)):
                wide, over = b.place - a.place, 0.0
                if not b.linked:  # along a motion the torque grows at most with the slip, from what brakes at none
                    over = a.torque + (a.torque - least) * math.expm1(wide)
                    over = max(over, b.torque + (b.torque - least) * 0.5 * wide)
                elif any(_is_peak(way, j) and way[j].torque == most[j] for j in (k, k + 1)):
                    over = max(a.torque, b.torque) + _SAFETY * max(_bend(way, k), _bend(way, k + 1)) * wide**2 / 8.0
                if wide > _CORNER and over > max((1.0 + _CLOSE) * most[k + 1], 0.0):
                    todo.append(k)
            if not todo:
                break
            middle = np.array([slip_of(0.5 * (way[k].place + way[k + 1].place)) for k in todo])
            found = self.motions.at(middle, np.array([way[k].share[0] for k in todo]))
            for k, (motion, *_) in sorted(zip(todo, found, strict=True), key=lambda one: -one[0]):
                if not motion.sure:  # it only halves the interval
                    motion = attrs.evolve(motion, torque=min(way[k].torque, way[k + 1].torque))
                way[k + 1 : k + 2] = [self.motions.link(way[k], motion), self.motions.link(motion, way[k + 1])]
        return way

    def jump(self, way: list[Motion], k: int, to: float) -> Jump:
        """The peak at motion k: the vertex of a polynomial, or a corner."""
        place, drag, around = way[k].place, way[k].torque, way[max(k - 1, 0) : k + 2]
        corner = len(around) < 3 or not (way[k].linked and way[k + 1].linked)
        error = 1.0 if not corner else _beside(way, k) / drag
        known = {motion.place: motion for motion in around}
        while not corner and len(known) < 9 and error > _FOUND:
            at, height = _vertex(sorted(known), [known[x].torque for x in sorted(known)])
            if at in known:
                error = min(error, _FOUND)
                break
            near = min(known.values(), key=lambda motion: abs(motion.place - at))
            new = self.motions.at(np.array([slip_of(at)]), near.share[:1])[0][0]
            if not new.sure:
                break
            known[at] = new
            error = abs(new.torque / height - 1.0)
            place, drag = max((place, drag), (at, new.torque), key=lambda one: one[1])
        level, ends = (1.0 - _CLOSE) * drag, [place, place]
        for side, step in enumerate((-1, 1)):
            for j in range(k, -1 if step < 0 else len(way), step):
                if way[j].torque < level:  # on a parabola through the peak
                    if way[max(j, j - step)].linked:
                        here = way[j - step]
                        share = math.sqrt(max(here.torque - level, 0.0) / (here.torque - way[j].torque))
                        ends[side] = here.place + share * (way[j].place - here.place)
                    break
                ends[side] = way[j].place
        low, high = min(ends[0], place), max(ends[1], place)
        slip, low, high = slip_of(place), slip_of(low), slip_of(high)
        return Jump(slip, drag, math.nan if math.isnan(to) else slip_of(to), low, high, max(error, way[k].error), corner)


def _is_peak(way: list[Motion], k: int) -> bool:
    beside = (*way[max(k - 1, 0) : k], *way[k + 1 : k + 2])
    return way[k].torque >= max((motion.torque for motion in beside), default=0.0) and way[k].torque > 0.0


def _bend(way: list[Motion], k: int) -> float:
    """Second derivative of the torque over the place, without sign; 0 at a gap."""
    if not 0 < k < len(way) - 1 or not (way[k].linked and way[k + 1].linked):
        return 0.0
    a, b, c = way[k - 1 : k + 2]
    rises = (b.torque - a.torque) / (b.place - a.place), (c.torque - b.torque) / (c.place - b.place)
    return 2.0 * abs(rises[1] - rises[0]) / (c.place - a.place)


def _beside(way: list[Motion], k: int) -> float:
    """What the torque may still rise by in the gap beside a corner, by its slope on the other side."""
    sides = list(zip(way[:-1], way[1:], strict=True))[max(k - 1, 0) : k + 1]
    gaps = [b.place - a.place for a, b in sides if not b.linked]
    slopes = [abs(b.torque - a.torque) / (b.place - a.place) for a, b in sides if b.linked]
    return max(gaps, default=0.0) * max(slopes, default=way[k].torque)


def _vertex(x: list[float], y: list[float]) -> tuple[float, float]:
    """Place and height of the largest value of the polynomial through the five points nearest to the largest."""
    best = int(np.argmax(y))
    first = max(min(best - 2, len(x) - 5), 0)
    if not 0 < best < len(x) - 1:
        return x[best], y[best]
    at, width = np.array(x[first : first + 5]) - x[best], x[best + 1] - x[best - 1]
    curve = np.polynomial.Polynomial(np.polyfit(at / width, y[first : first + 5], at.size - 1)[::-1])
    turns = curve.deriv().roots()
    turns = turns.real[np.abs(turns.imag) < 1e-9]
    inside = [t for t in turns.tolist() if x[best - 1] < x[best] + width * t < x[best + 1]]
    top = float(max([0.0, *inside], key=curve))
    return x[best] + width * top, float(curve(top))


def _peaks(way: list[Motion]) -> list[tuple[int, float]]:
    """Numbers of motions from which the torque falls before it gets larger, and places where it does, or NaN."""
    out, k, torques = list[tuple[int, float]](), 0, [motion.torque for motion in way]
    while k < len(way):
        on = next((j for j in range(k + 1, len(way)) if torques[j] > torques[k]), len(way))
        if torques[k] > 0.0 and min(torques[k + 1 : on], default=math.inf) < (1.0 - _FALL) * torques[k]:
            to = math.nan
            if on < len(way):
                a, b = way[on - 1 : on + 1]
                part = (torques[k] - a.torque) / (b.torque - a.torque) if b.linked else 1.0
                to = a.place + part * (b.place - a.place)
            out.append((k, to))
        k = on
    return out


def _trusted(way: list[Motion]) -> list[Motion]:
    """Without motions that are not sure, and without a single one that neither neighbour goes on to."""
    way = [motion for motion in way if motion.sure]
    last = len(way) - 1
    return [m for k, m in enumerate(way) if m.linked or k in (0, last) or way[k + 1].linked]


def way_up(balance: TorqueBalance, largest: float, *, steps: int = 0) -> WayUp:
    """Return the way up of a bearing over the cage slips up to the largest.

    Parameters
    ----------
    balance : TorqueBalance
        The bearing, with what resists its rollers and the friction of its raceways; it asks for nothing of its drags.
    largest : float
        Largest cage slip, below 1. A law without a value there shortens the range.
    steps : int, optional
        Steps to begin with, if more than the 0.25 of ln(S/(1 - S)) that they are by default.

    Raises
    ------
    DomainError
        If a law has no value even at the smallest slips, or the epicyclic cage speed is zero.
    ConvergenceError
        If loads are not found.
    """
    begin, end, refusal = place_of(min(_SMALLEST, 0.5 * largest)), place_of(largest), ""
    count = max(math.ceil((end - begin) / _STEP), steps)
    slips = [slip_of(place) for place in np.linspace(begin, end, count + 1).tolist()]
    slips[-1] = largest
    search = _Search(Motions(balance, largest))
    while True:
        try:
            way, others = search.ways(slips)
            way = _trusted(search.refined(_trusted(way)))
            break
        except DomainError as error:  # a law has no value at the end of the range
            slips, refusal = slips[:-1], str(error)
            if not slips:
                raise
    rest = search.motions.at(np.zeros(1), np.zeros(1))[0][0].torque if search.motions.resists else 0.0
    return WayUp(search.motions, way, [search.jump(way, *one) for one in _peaks(way)], others, rest, refusal)
