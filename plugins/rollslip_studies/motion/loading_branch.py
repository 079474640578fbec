"""The way up: the motions that the rollers of a bearing take while the drag on its cage is raised slowly from none.

- Where tractions have passed their maximum a roller sticks to one ring and slides on the other, and mostly it may do so
  on either: an imperfect pitchfork. From small slip goes on one of both motions. The other begins at a fold, and only a
  cage from larger slips ever gets to it. All lie between those of rollers sent round from both ends
  (`rollslip_studies.motion.spins`), which tell whether there is more than one.
- Where a motion ends on the way up, rollers go to the one that they come to from there. At a maximum of the torque the
  slip jumps to the next slip of the way that carries the drag. The cage runs away at the first maximum beyond which the
  slip at least doubles, or nothing in the range carries the drag.
- Where rollers change from ring to ring, positions of the orbit tell a maximum to the first order only. So each is
  looked at once more with four times as many positions; all that this moves is told as its error, since what more of
  them would move falls irregularly.
- Nothing depends on what was asked before: all slips of a way are chosen by the bearing and its range alone.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.search import bracketed, secants, vertex
from rollslip_studies.motion.spins import TWO, Motion, Motions, logit_slip, slip_of

#: Smallest slip; steps of the place of a slip, ln(S/(1 - S)), and the gap to which the end of a motion is found.
_SMALLEST = 1e-4
_STEP = 0.25
_CORNER: Final = _STEP / 512.0
#: Share of a maximum that counts as the same drag, exactness of its height, margin for what lies between slips, and how
#: often these are halved; slips among which a maximum is told.
_CLOSE = 1e-3
_FOUND = 1e-6
_SAFETY = 2.0
_ROUNDS = 14
_MOST = 9
#: Share by which the torque has to fall behind a maximum.
_FALL: Final = 2.0 * _CLOSE
#: Fall that positions may make, which is looked at by more of them.
_SHALLOW: Final = 0.02
#: How many times the positions a maximum is looked at, and loads of a roller there.
_FINER = 4
_FEW = 8
#: Least and largest half width of that look, in places; slips between which a corner is looked for, and how often.
_SAME = 1e-7  # distance of places at which torques are alike but for rounding
_NARROW = 2e-3
_WIDE = 0.1
_BETWEEN = 9
_LOOKS = 2
#: How often a look goes on, twice as far, where the torque still rises at its end.
_FURTHER: Final = 5
#: Exactness of the place that carries a drag again.
_AGAIN: Final = 1e-3
#: Exactness of a steady slip, relative to it and to its torque, and the first step below no slip.
_STEADY = 1e-10
_FASTER = 1e-5
#: What is left where there is no balance, relative, and up to how many times an end one is looked for beside it.
_LEFT = 1e-6
_FARTHEST = 1.25
#: Step of a slip, relative to it, by which the excess torque is differentiated.
_NUDGE: Final = 1e-4


@attrs.frozen
class Jump:
    """A maximum of the torque on the way up, from which the slip jumps."""

    #: slip, drag: Cage slip, and the drag [N m]: with more of it the slip jumps.
    slip: float
    drag: float
    to: float  # slip to which it jumps, NaN if none in the range carries the drag
    error: float  # of the drag, relative: what slips, positions and loads of a roller leave
    #: Share of the drag -> slips between which the torque is within it.
    around: Callable[[float], list[float]] = attrs.field(eq=False, repr=False)

    @property
    def away(self) -> bool:
        """Whether the slip at least doubles, or nothing carries the drag: the cage runs away."""
        return not self.to < 2.0 * self.slip


@attrs.frozen
class Steady:
    """A steady slip on the way up, and the torque that it carries [N m]."""

    slip: float
    torque: float
    motion: Motion = attrs.field(eq=False, repr=False)
    _rise: Callable[[], float] = attrs.field(eq=False, repr=False)

    @cached_property
    def slope(self) -> float:
        """By how much its excess of torque grows with slip [N m].

        The cage holds it where that is above zero: with more slip more torque is left to speed it up.
        """
        return self._rise()


@attrs.frozen(eq=False)
class LoadingBranch:
    """The motions that rollers take while the drag is raised slowly from none; `loading_branch` finds them."""

    _search: "_Search" = attrs.field(repr=False)
    path: list[Motion]  # by growing slip, from a small one to the end of the range
    others: list[Motion]  # motions beside it, that only a cage from larger slips has
    at_rest: float  # torque of the rollers on a cage that does not slip [N m]
    refusal: str = ""  # why the range ends early, empty if it does not

    @property
    def exact(self) -> Motions:
        """Motions on all slices."""
        return self._search.exact

    @cached_property
    def jumps(self) -> list[Jump]:
        """Maxima of the torque from which the slip jumps, by growing slip and drag."""
        found = [self._search.jump(self.path, k) for k in _peaks(self.path)]
        return [jump for jump in found if jump is not None]

    @property
    def describe_skidding(self) -> Jump | None:
        """Where the cage runs away, None if it does nowhere in the range."""
        return next((jump for jump in self.jumps if jump.away), None)

    @property
    def largest(self) -> tuple[float, float]:
        """Slip and torque [N m] of the most that the way carries: at the end of the range where nothing jumps."""
        known = [(one.slip, one.torque) for one in (self.path[-1:] if self.jumps else self.path)]
        return max(known + [(one.slip, one.drag) for one in self.jumps], key=lambda one: one[1])

    @cached_property
    def largest_error(self) -> float:
        """Error of the most that the way carries, relative: of a jump its own, else what finer positions move it by."""
        slip, _ = self.largest
        of_jumps = [jump.error for jump in self.jumps if jump.slip == slip]
        return of_jumps[0] if of_jumps else self._search.missed(self.near(slip))

    @property
    def end(self) -> float:
        """Largest slip."""
        return self.path[-1].slip

    @cached_property
    def curve(self) -> tuple[Array, Array]:
        """Slips from none on and torques there [N m], (n,) each."""
        slips = [0.0]
        torques = [self.at_rest]
        for motion in self.path:
            slips.append(motion.slip)
            torques.append(motion.torque)
        return np.array(slips), np.array(torques)

    def steady(self, drag: Callable[[float], float]) -> list[Steady]:
        """Return the slips, ascending, at which the way balances a drag; the first below zero where the cage is driven.

        Parameters
        ----------
        drag : callable
            Torque of all drags at a cage slip [N m], negative where it resists.
        """
        left = self.at_rest + drag(0.0)
        found = self._driven(drag, left) if left > 0.0 else []
        for k, motion in enumerate(self.path):
            right = motion.torque + drag(motion.slip)
            if (left < 0.0) != (right < 0.0) and (k == 0 or motion.linked):
                known = [motion] if k == 0 else [self.path[k - 1], motion]
                found.append(
                    self._between(
                        known, 0.0 if k == 0 else known[0].slip, motion.slip, drag, left, right
                    )
                )
            left = right
        return found

    def at(self, slips: Sequence[float]) -> list[Motion]:
        """Return the motions of the way at other slips of its range, by the loads of the search."""
        starts = np.array([self.near(slip).fraction[0] for slip in slips])
        return [one for one, *_ in self._search.motions.at(np.array(slips), starts)]

    def near(self, slip: float) -> Motion:
        """Return the motion of the path at the largest slip up to one, from which rollers come to that of this slip."""
        return next((one for one in reversed(self.path) if one.slip <= slip), self.path[0])

    def _driven(self, drag: Callable[[float], float], over: float) -> list[Steady]:
        """The balance of a cage that is faster than its epicyclic speed; none up to twice that."""
        high = 0.0
        low = -_FASTER
        while high > -1.0:
            motion = self.exact.at(np.array([low]))[0][0]
            below = motion.torque + drag(low)
            if below < 0.0:
                return [self._between([motion], low, high, drag, below, over)]
            high = low
            low = max(2.0 * low, -1.0)
            over = below
        return []

    def _between(
        self,
        known: list[Motion],
        low: float,
        high: float,
        drag: Callable[[float], float],
        below: float,
        over: float,
    ) -> Steady:
        """The balance between two slips, beside motions that are known, on all slices."""
        motion = known[0]

        def excess(at: float) -> float:
            nonlocal motion
            near = min(known, key=lambda one: abs(one.slip - at))
            motion = self.exact.at(np.array([at]), near.fraction[:1])[0][0]
            value = motion.torque + drag(at)
            return value if abs(value) > _STEADY * abs(motion.torque) else 0.0

        def rise() -> float:
            beside = motion.slip * np.array([1.0 - _NUDGE, 1.0 + _NUDGE])
            left, right = (one[0] for one in self.exact.at(beside, np.full(2, motion.fraction[0])))
            return (right.torque + drag(right.slip) - left.torque - drag(left.slip)) / (
                right.slip - left.slip
            )

        at = bracketed(excess, low, high, below, over, relative=_STEADY)
        near = min(abs(at - low), abs(high - at)) <= _LEFT * abs(at)
        if near and abs(motion.torque + drag(motion.slip)) > _LEFT * abs(motion.torque):
            # few loads of a roller tell a sign at that end that all slices do not: it lies beside it
            first, last = sorted((at / _FARTHEST, at * _FARTHEST))
            slope = (over - below) / (high - low)
            if (
                secants(excess, at, slope, tolerance=_STEADY * abs(at), within=(first, last))
                is None
            ):
                excess(at)
        return Steady(motion.slip, -drag(motion.slip), motion, rise)


class _Search:
    """The way up, and what is largest on it."""

    def __init__(self, motions: Motions, exact: Motions) -> None:
        self.motions = motions
        self.exact = exact

    def ways(self, slips: Sequence[float]) -> tuple[list[Motion], list[Motion]]:
        """The way up through slips, and motions beside it: all lie between those that either end leads to."""
        motions = self.motions
        n = len(slips)
        pairs = motions.at(np.array(slips))
        others = [motion for pair in pairs if len(pair) > 1 for motion in pair if motion.sure]
        while True:
            way = [pairs[0][0]]
            for k in range(1, n):
                below = way[-1]
                pair = pairs[k]
                if below.sure and not any(
                    one.sure for one in pair
                ):  # neither end settles, what is between them may
                    pair = motions.at(np.array(slips[k : k + 1]), below.fraction[:1])[0]
                way.append(
                    motions.link(
                        below,
                        min(pair, key=lambda one: motions.apart(one.fraction, below.fraction)),
                    )
                )
            two = [k for k in range(1, n) if len(pairs[k]) > 1]
            wrong = None
            if two:
                again = motions.at(
                    np.array([slips[k] for k in two]),
                    np.array([way[k - 1].fraction[0] for k in two]),
                )
                off = (
                    (k, one[0])
                    for k, one in zip(two, again, strict=True)
                    if motions.apart(one[0].fraction, way[k].fraction) >= TWO
                )
                wrong = next(off, None)
            if wrong is None:
                own = {motion.slip: motion.fraction for motion in way}
                return way, [
                    one for one in others if motions.apart(one.fraction, own[one.slip]) >= TWO
                ]
            pairs[wrong[0]] = [wrong[1]]  # and what follows is chosen anew

    def refined(self, way: list[Motion]) -> list[Motion]:
        """Halve intervals beside peaks, and those in which a motion ends, where they may hold more than all below."""
        least = min(0.0, way[0].torque)
        for _ in range(_ROUNDS):
            most = np.maximum.accumulate([motion.torque for motion in way])
            todo = []
            for k, (a, b) in enumerate(itertools.pairwise(way)):
                wide = b.place - a.place
                over = 0.0
                if not b.linked:  # along a motion the torque grows at most with the slip, from what brakes at none
                    over = a.torque + (a.torque - least) * math.expm1(wide)
                    over = max(over, b.torque + (b.torque - least) * 0.5 * wide)
                elif any(_is_peak(way, j) and way[j].torque == most[j] for j in (k, k + 1)):
                    over = (
                        max(a.torque, b.torque)
                        + _SAFETY * max(_bend(way, k), _bend(way, k + 1)) * wide**2 / 8.0
                    )
                if wide > _CORNER and over > max((1.0 + _CLOSE) * most[k + 1], 0.0):
                    todo.append(k)
            if not todo:
                break
            middle = np.array([slip_of(0.5 * (way[k].place + way[k + 1].place)) for k in todo])
            found = self.motions.at(middle, np.array([way[k].fraction[0] for k in todo]))
            for k, (motion, *_) in sorted(zip(todo, found, strict=True), key=lambda one: -one[0]):
                if not motion.sure:  # it only halves the interval
                    motion = attrs.evolve(motion, torque=min(way[k].torque, way[k + 1].torque))
                way[k + 1 : k + 2] = [
                    self.motions.link(way[k], motion),
                    self.motions.link(motion, way[k + 1]),
                ]
        return way

    def jump(self, way: list[Motion], k: int) -> Jump | None:
        """The peak at motion k: a vertex of a polynomial, or a corner; None if more positions know no fall behind."""
        place = way[k].place
        drag = way[k].torque
        beside = way[max(k - 1, 0) : k + 2]
        corner = len(beside) < 3 or not (way[k].linked and way[k + 1].linked)
        error = 1.0 if not corner else _beside(way, k) / drag
        if not corner:
            place, drag, error = self._climbed(self.motions, list(beside))
        on = next((j for j in range(k + 1, len(way)) if way[j].torque > drag), len(way))
        to = self._carried_again(way[on - 1], way[on], drag) if on < len(way) else math.nan
        few = place, drag
        low, high = (logit_slip(slip) for slip in _around(way[:on], k, few, place, _CLOSE))
        error = max(error, way[k].error)
        dip = min(way[k + 1 : on], key=lambda motion: motion.torque)
        finer = (
            self._corner(way, k)
            if corner
            else self._finer(way[k], place, 0.5 * (high - low), dip.place)
        )
        if finer is None:
            error = math.inf
        else:
            at, torque, more = finer
            error = max(error, more) + abs(torque / drag - 1.0)
            place = at
            drag = torque
        # positions alone may have bent it down: a little, or by more where the finer torque rises on to the dip itself
        if dip.torque > (1.0 - _SHALLOW) * drag or place > dip.place - _CORNER:
            bottom = self._at_finer(dip)
            if bottom.sure and bottom.torque >= (1.0 - _FALL) * drag:
                return None
        to = math.nan if math.isnan(to) else slip_of(to)
        around = partial(_around, way[:on], k, few, place)
        return Jump(slip_of(place), drag, to, error, around)

    def _carried_again(self, a: Motion, b: Motion, drag: float) -> float:
        """Place between two motions of the way at which a drag is carried again."""
        if not b.linked:
            return b.place

        def over(place: float) -> float:
            return self.motions.at(np.array([slip_of(place)]), a.fraction[:1])[0][0].torque - drag

        return bracketed(over, a.place, b.place, a.torque - drag, b.torque - drag, tolerance=_AGAIN)

    @cached_property
    def _fine(self) -> Motions:
        return self.exact.like(n_positions=_FINER * self.motions.n_positions, few=_FEW)

    def _climbed(self, motions: Motions, around: list[Motion]) -> tuple[float, float, float]:
        """Place and height of a maximum between motions, by vertices of polynomials, and by how much these miss it."""
        known = {motion.place: motion for motion in around}
        error = math.inf
        while len(known) < _MOST and error > _FOUND:
            at, height = vertex(sorted(known), [known[x].torque for x in sorted(known)])
            near = min(known.values(), key=lambda motion: abs(motion.place - at))
            if abs(near.place - at) < _SAME:
                break
            new = motions.at(np.array([slip_of(at)]), near.fraction[:1])[0][0]
            if not new.sure:
                break
            known[at] = new
            error = abs(new.torque / height - 1.0)
        best = max(known.values(), key=lambda motion: motion.torque)
        return (
            best.place,
            best.torque,
            min(error, _rise(sorted(known), [known[x].torque for x in sorted(known)])),
        )

    def _finer(
        self, near: Motion, place: float, half: float, end: float
    ) -> tuple[float, float, float] | None:
        """The same by four times the positions, up to where it has fallen; None if they do not tell it."""
        half = min(max(half, _NARROW), _WIDE)
        found = dict[float, Motion]()
        places: tuple[float, ...] = (place - half, place, min(place + half, end))
        for _ in range(_FURTHER):
            slips = np.array([slip_of(x) for x in places])
            new = self._fine.at(slips, np.full(slips.size, near.fraction[0]))
            found |= {x: one[0] for x, one in zip(places, new, strict=True) if one[0].sure}
            if len(found) < 2 or max(one.torque for one in found.values()) == 0.0:
                return None
            x = sorted(found)
            half = 2.0 * half
            top = max(x, key=lambda at: found[at].torque)
            if x[0] < top < x[-1] or top == end:
                break
            places = (max(top - half, x[0] - half) if top == x[0] else min(top + half, end),)
            if places[0] in found:
                break
        return self._climbed(self._fine, list(found.values()))

    def _at_finer(self, motion: Motion) -> Motion:
        """A motion by four times the positions."""
        return self._fine.at(np.array([motion.slip]), motion.fraction[:1])[0][0]

    def missed(self, motion: Motion) -> float:
        """What slips, positions and loads of a roller leave of the torque of a motion, relative."""
        finer = self._at_finer(motion)
        off = abs(finer.torque / motion.torque - 1.0) if motion.torque else 0.0
        return max(motion.error, finer.error) + 2.0 * off if finer.sure else math.inf

    def _corner(self, way: list[Motion], k: int) -> tuple[float, float, float] | None:
        """Place and height of the end of a motion by four times the positions; None if they do not tell it."""
        low = way[k].place - _WIDE
        high = way[k].place + _WIDE
        start = way[k].fraction[0]
        best: tuple[float, float, float] | None = None
        for _ in range(_LOOKS):
            places = np.linspace(low, high, _BETWEEN).tolist()
            found = [
                one[0]
                for one in self._fine.at(
                    np.array([slip_of(x) for x in places]), np.full(_BETWEEN, start)
                )
            ]
            torques = [one.torque if one.sure else -math.inf for one in found]
            top = int(np.argmax(torques))
            if not 0 < top < _BETWEEN - 1 or torques[top] == 0.0:
                return best
            low = places[top - 1]
            high = places[top + 1]
            best = (
                places[top],
                torques[top],
                abs(max(torques[top - 1 : top + 2 : 2]) / torques[top] - 1.0),
            )
        return best


def _is_peak(way: list[Motion], k: int) -> bool:
    beside = (*way[max(k - 1, 0) : k], *way[k + 1 : k + 2])
    return (
        way[k].torque >= max((motion.torque for motion in beside), default=0.0)
        and way[k].torque > 0.0
    )


def _around(
    way: list[Motion], k: int, peak: tuple[float, float], known: float, fraction: float
) -> list[float]:
    """Slips up to which the torque is within a share of a peak beside motion k, whose place is known to be another."""
    (place, drag) = peak
    most = math.sqrt(fraction)
    ends = list[float]()
    for step in (-1, 1):
        end = place
        below = 0.0
        j = k if (way[k].place - place) * step > 0.0 else k + step
        while 0 <= j < len(way):
            lower = math.sqrt(
                max(1.0 - way[j].torque / drag, 0.0)
            )  # straight over places on a parabola
            if lower > most:
                if j == k or way[max(j, j - step)].linked:
                    end += (most - below) / (lower - below) * (way[j].place - end)
                break
            end = way[j].place
            below = lower
            j = j + step
        ends.append(slip_of(end + known - place))
    return ends


def _bend(way: list[Motion], k: int) -> float:
    """Second derivative of the torque over the place, without sign; 0 at a gap."""
    if not 0 < k < len(way) - 1 or not (way[k].linked and way[k + 1].linked):
        return 0.0
    a, b, c = way[k - 1 : k + 2]
    rises = (b.torque - a.torque) / (b.place - a.place), (c.torque - b.torque) / (c.place - b.place)
    return 2.0 * abs(rises[1] - rises[0]) / (c.place - a.place)


def _beside(way: list[Motion], k: int) -> float:
    """What the torque may still rise by in the gap beside a corner, by its slope on the other side."""
    sides = list(itertools.pairwise(way))[max(k - 1, 0) : k + 1]
    gaps = [b.place - a.place for a, b in sides if not b.linked]
    slopes = [abs(b.torque - a.torque) / (b.place - a.place) for a, b in sides if b.linked]
    return max(gaps, default=0.0) * max(slopes, default=way[k].torque)


def _rise(x: list[float], y: list[float]) -> float:
    """What a maximum may be over the largest of some values, relative: on either side, by the slope of the other."""
    best = int(np.argmax(y))
    slopes = np.abs(np.diff(y) / np.diff(x))
    if not 0 < best < len(x) - 1:  # it still rises there: as far again
        return float(slopes[0 if best == 0 else -1] * (x[-1] - x[0]) / y[best])
    over = slopes[best - 1] * (x[best + 1] - x[best]), slopes[best] * (x[best] - x[best - 1])
    return float(max(over) / y[best])


def _peaks(way: list[Motion]) -> list[int]:
    """Numbers of motions from which the torque falls before it gets larger."""
    out = list[int]()
    k = 0
    torques = [motion.torque for motion in way]
    while k < len(way):
        on = next((j for j in range(k + 1, len(way)) if torques[j] > torques[k]), len(way))
        if (
            torques[k] > 0.0
            and min(torques[k + 1 : on], default=math.inf) < (1.0 - _FALL) * torques[k]
        ):
            out.append(k)
        k = on
    return out


def _trusted(way: list[Motion]) -> list[Motion]:
    """Without motions that are not sure, and without a single one that neither neighbour goes on to."""
    way = [motion for motion in way if motion.sure]
    last = len(way) - 1
    return [m for k, m in enumerate(way) if m.linked or k in (0, last) or way[k + 1].linked]


def loading_branch(
    motions: Motions, largest: float, exact: Motions, *, steps: int = 0
) -> LoadingBranch:
    """Return the way up of a bearing over the cage slips up to the largest."""
    begin = logit_slip(min(_SMALLEST, 0.5 * largest))
    end = logit_slip(largest)
    refusal = ""
    count = max(math.ceil((end - begin) / _STEP), steps)
    slips = [
        *(slip_of(place) for place in np.linspace(begin, end, count + 1)[:-1].tolist()),
        largest,
    ]
    search = _Search(motions, exact)
    while True:
        try:
            way, others = search.ways(slips)
            way = _trusted(way)
            way = _trusted(search.refined(way)) if way else way
            break
        except (
            DomainError,
            ConvergenceError,
        ) as error:  # at the end of the range a law has no value, or a roller none
            slips = slips[:-1]
            refusal = str(error)
            if not slips:
                raise
    if not way:
        raise ConvergenceError(
            f"the search for the motion of the rollers did not settle at any cage slip up to {slips[-1]:.2%}, so there "
            "is no slip to report; it settles where more load is on the rollers: raise operation.radial_load"
        )
    if way[-1].slip < slips[-1]:
        refusal = "the search for the motion of the rollers does not settle"
    rest = exact.at(np.zeros(1), np.zeros(1))[0][0].torque if motions.resists else 0.0
    return LoadingBranch(search, way, others, rest, refusal)
