"""The critical slip: where the friction of a curve is largest, beyond which it falls with slip.

- A search says at which slips it wants the friction, is sent it, and says in the end what it has found. So several
  curves are searched in step, and what they ask for is evaluated in one go: `searched`.
- Where the maximum alone is asked for, most slips of a grid need no more than a rough friction, that of few loads. It
  is held against the exact one at slips all over the range; the difference, and what it may be between them, says which
  slips can be the highest, and whether friction falls before. Friction is exact at those, at their neighbours and at
  the end, so what is found is to the last bit what the whole grid gives. Where that leaves a doubt the whole grid is
  evaluated. Curves on one grid are looked at as rows of one array.
"""

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from functools import cache
from typing import Final, TypeAlias

import attrs
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from rollslip.errors import DomainError

Array = NDArray[np.float64]

#: A maximum that the rest of the curve undercuts by less than this share is rounding, not a falling branch.
_FLAT = 1e-9
#: Up to which slip of a cage it is advised to look, whose range is open at 1; and slide-roll ratio of pure sliding.
MOST_CAGE_SLIP, PURE_SLIDING = 0.99, 2.0
#: Share of a maximum by which friction has to fall behind it so that it is told beside a larger one further on.
_FALL = 1e-3
#: Where a search ends, relative to its interval: the root of the rounding of a value that is 1.
_PLACE = 1e-8
#: Chebyshev's points of an interval, from -1 to 1, and what makes terms of values there.
_NODES: Final = -np.cos(np.pi * (np.arange(12) + 0.5) / 12)
_TERMS: Final = np.linalg.inv(chebyshev.chebvander(_NODES, _NODES.size - 1))
#: Highest terms, and their size relative to the lowest, at which a curve is resolved; steps of Newton's method.
_TAIL, _RESOLVED, _STEPS = 3, 1e-11, 12
_GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))
#: What takes values there to the terms of the slope of the polynomial through them, and of its bend.
_SLOPES: Final = np.vstack((chebyshev.chebder(np.eye(_NODES.size)), np.zeros(_NODES.size))) @ _TERMS
_BENDS: Final = np.vstack((chebyshev.chebder(np.eye(_NODES.size), 2), np.zeros((2, _NODES.size)))) @ _TERMS
#: Slips all over a grid at which a rough curve is held against the exact one.
_HELD: Final = 9
#: Slips on either side of where it is highest that are exact at once.
_BESIDE: Final = 2
_AROUND: Final = np.arange(-_BESIDE, _BESIDE + 1)


def slip_grid(largest: float, points: int) -> Array:
    """Return slips from 0 to the largest, quadratically denser towards 0, where friction rises steeply."""
    return np.asarray(largest * np.linspace(0.0, 1.0, points) ** 2)


@attrs.frozen
class Critical:
    """The largest friction of a curve: ``slip`` and ``friction``, both NaN unless it lies inside the range.

    ``status`` says in words what was found. ``first_slip`` and ``first_friction`` are the first maximum, from which
    friction falls: the largest one too, unless friction rises once more. NaN if friction falls nowhere in the range.
    """

    slip: float
    friction: float
    status: str
    first_slip: float = math.nan
    first_friction: float = math.nan


def look_further(key: str, largest: float, most: float) -> str:
    """Return what to type so that a range of slips goes further: ten times as far, but not beyond the most.

    Empty where the range is at its end already.

    Examples
    --------
    >>> look_further("study.friction-curve.max_slip", 0.3, 2.0)
    '; look further with --set study.friction-curve.max_slip=2'
    """
    to = min(10.0 * largest, most)
    return f"; look further with --set {key}={to:.3g}" if key and to > largest else ""


#: Yields slips, is sent the friction there, and returns the maximum.
_Search: TypeAlias = Generator[Array, Array, Critical]
#: Ends of an interval, and the friction at Chebyshev's points of it.
_Known: TypeAlias = tuple[float, float, Array]
#: Slips, the friction there, and what is known beside.
_Some: TypeAlias = tuple[Array, Array, _Known | None]
#: Returns the friction of curves, by their number, at slips.
Evaluate: TypeAlias = Callable[[list[tuple[int, Array]]], Sequence[Array]]


@attrs.frozen(eq=False)
class Curve:
    """A curve whose largest friction is looked for."""

    #: slip, friction: The curve on a grid, slip ascending, (n,).
    slip: Array
    friction: Array
    allow: str  # key of the setting that widens the range, as it is typed, for the status; empty if there is none
    #: Whether the friction is exact; where it is rough few slips are chosen by it, or all where these leave a doubt.
    exact: bool = True
    most: float = MOST_CAGE_SLIP  # largest slip to look for: of a cage one that still turns


def locate(
    curve: Callable[[float], float],
    slip: Array,
    friction: Array,
    allow: str,
    *,
    most: float = MOST_CAGE_SLIP,
    sought: str = "critical slip",
    of: str = "friction",
    many: Callable[[Array], Array] | None = None,
) -> Critical:
    """Locate the largest friction on the continuous curve, not on its grid, and the first maximum before it.

    Parameters
    ----------
    curve : callable
        Friction at one slip.
    slip, friction : ndarray
        The curve on a grid, slip ascending, shape (n,).
    allow : str
        Key of the setting that widens the range, as it is typed, for the status; empty if there is none.
    most : float
        Largest slip to look for: of a cage one that still turns.
    sought, of : str
        What the status calls the slip that is sought, and what is largest there.
    many : callable, optional
        Friction at several slips, where these cost little more than one.

    Returns
    -------
    Critical
        The maximum after Brent's method on the two grid intervals around the best point; the first of equal ones. Its
        place is known to the root of the rounding of the friction, some 1e-8 of the interval, since a maximum is flat.
        With ``many`` it is that of the polynomial through Chebyshev's points of these intervals, where that converges.
        A first maximum is one behind which friction falls by a thousandth on the grid before it is larger again.

    Raises
    ------
    DomainError
        If the curve holds NaN or infinity.
    """
    search = _searching(slip, friction, allow, most=most, sought=sought, of=of, together=many is not None)

    def at(slips: Array) -> Array:
        return many(slips) if many is not None else np.array([curve(one) for one in slips.tolist()])

    (found,) = _in_step([search], lambda asked: [at(slips) for _, slips in asked])
    return found


def searched(curves: Sequence[Curve], evaluate: Evaluate) -> list[Critical]:
    """Return the largest friction of curves, as `locate` does; ``evaluate`` returns it exactly at what is asked for."""
    some: dict[int, _Some] = {k: (one.slip, one.friction, None) for k, one in enumerate(curves) if one.exact}
    some |= _of_few_slips({k: one for k, one in enumerate(curves) if not one.exact}, evaluate)
    searches = [
        _searching(slip, friction, one.allow, most=one.most, beside=beside)
        for one, (slip, friction, beside) in ((one, some[k]) for k, one in enumerate(curves))
    ]
    return _in_step(searches, evaluate)


def _in_step(searches: Sequence[_Search], evaluate: Evaluate) -> list[Critical]:
    """What searches find, each of which goes on when all have what they have asked for."""
    found, asked = dict[int, Critical](), list[tuple[int, Array]]()

    def send(k: int, friction: Array | None) -> None:
        try:
            asked.append((k, next(searches[k]) if friction is None else searches[k].send(friction)))
        except StopIteration as end:
            found[k] = end.value

    for k in range(len(searches)):
        send(k, None)
    while asked:
        answered, values = asked.copy(), evaluate(asked)
        asked.clear()
        for (k, _), friction in zip(answered, values, strict=True):
            send(k, friction)
    return [found[k] for k in range(len(searches))]


def _searching(
    slip: Array,
    friction: Array,
    allow: str,
    *,
    most: float,
    sought: str = "critical slip",
    of: str = "friction",
    together: bool = True,
    beside: _Known | None = None,
) -> _Search:
    """Search the largest friction as `locate` does, asking for it at slips; ``together`` is with several at a time."""
    if not np.isfinite(friction).all():
        bad = int(np.argmin(np.isfinite(friction)))
        raise DomainError(f"the {of} is {friction[bad]} at a slip of {slip[bad]:.4g}: it must be finite all along")
    best = int(np.argmax(friction))
    if not friction[best] > 0.0:
        return Critical(np.nan, np.nan, f"no {sought}: there is no {of} in the range")
    at, largest = yield from _around(slip, friction, best, together, beside)
    found = largest - friction[-1] > _FLAT * largest
    before = np.maximum.accumulate(friction)
    fallen = (before > 0.0) & (friction < (1.0 - _FALL) * before)
    top = int(np.argmax(friction[: int(np.argmax(fallen))])) if fallen.any() else best
    first = (at, largest) if found else (math.nan, math.nan)
    if top < best:
        first = yield from _around(slip, friction, top, together, beside)
    if found:
        return Critical(at, largest, "found", *first)
    rises = friction[-1] - friction[-2] > _FLAT * largest
    what = "still rises at the end of" if rises else "stays at its largest value up to the end of"
    status = f"no {sought}: {of} {what} the range, {slip[-1]:.4g}{look_further(allow, float(slip[-1]), most)}"
    return Critical(np.nan, np.nan, status, *first)


@cache
def _held(points: int) -> tuple["NDArray[np.intp]", Array, Array]:
    """Points of a grid at which a rough curve is held against the exact one, and what is straight between them.

    That is at which share of the way from the one before to the one behind the inner ones lie, and by how much each of
    them counts at every point, (held, points).
    """
    at = np.linspace(0.0, points - 1.0, _HELD).round().astype(np.intp)
    counts = np.array([np.interp(np.arange(float(points)), at, one) for one in np.eye(_HELD)])
    return at, (at[1:-1] - at[:-2]) / (at[2:] - at[:-2]), counts


def _nodes(low: float, high: float) -> Array:
    """Chebyshev's points of an interval."""
    return low + 0.5 * (high - low) * (1.0 + _NODES)


def _of_few_slips(curves: Mapping[int, Curve], evaluate: Evaluate) -> dict[int, _Some]:
    """Slips that decide where the largest friction of rough curves is, and the exact friction there, by their number.

    They are all of a grid where few leave a doubt.
    """
    grids = dict[bytes, list[int]]()
    for k, curve in curves.items():
        grids.setdefault(curve.slip.tobytes(), []).append(k)
    some = dict[int, _Some]()
    for own in grids.values():

        def of_rows(asked: list[tuple[int, Array]], own: list[int] = own) -> Sequence[Array]:
            return evaluate([(own[row], at) for row, at in asked])

        few = _few(curves[own[0]].slip, np.array([curves[k].friction for k in own]), of_rows)
        some |= {own[row]: known for row, known in few.items()}
    left = [(k, curve.slip) for k, curve in curves.items() if k not in some]
    if left:
        some |= {k: (slip, exact, None) for (k, slip), exact in zip(left, evaluate(left), strict=True)}
    return some


def _few(slip: Array, rough: Array, evaluate: Evaluate) -> dict[int, _Some]:
    """Slips of a grid that decide where the largest friction is, by rough curves (k, n), and the exact friction there.

    A rough curve is corrected by what it misses at some slips, straight between them. What each of these misses of
    the straight line through its neighbours is twice as far from it, so of a smooth difference four times the error;
    the most of that, and of what the corrected curve misses where it is highest, bounds it. A curve is left out where
    friction may fall before its maximum, where many slips may be the highest, or where the exact friction at these is
    not within the bound. With it comes the friction at Chebyshev's points where the rough one is highest, which is
    mostly asked next.
    """
    curves, points = rough.shape
    if points < 4 * _HELD:
        return {}
    at, share, counts = _held(points)
    sure = np.asarray(np.isfinite(rough).all(axis=1))
    rough, every = np.where(sure[:, None], rough, 0.0), np.arange(curves)
    best = np.clip(rough.argmax(axis=1), _BESIDE, points - 1 - _BESIDE)
    known = np.zeros(rough.shape, dtype=bool)
    known[:, at] = known[:, -2] = True
    known[every[:, None], best[:, None] + _AROUND] = True
    exact, beside = np.zeros(rough.shape), dict[int, _Known]()
    ends = np.stack((slip[best - 1], slip[best + 1]), axis=1).tolist()
    asked = [(k, np.concatenate((slip[known[k]], _nodes(*ends[k])))) for k in np.flatnonzero(sure).tolist()]
    for (k, slips), friction in zip(asked, evaluate(asked), strict=True):
        own = slips.size - _NODES.size
        exact[k, known[k]], beside[k] = friction[:own], (*ends[k], friction[own:])
    with np.errstate(all="ignore"):  # without slip there is no friction either way
        off = exact[:, at] / rough[:, at] - 1.0
        nothing = (exact[:, 0] == 0.0) & (rough[:, 0] == 0.0)
        off[nothing, 0] = off[nothing, 1]
        error = np.abs(off[:, :-2] + share * (off[:, 2:] - off[:, :-2]) - off[:, 1:-1]).max(axis=1) + _FLAT
        guess = rough * (1.0 + off @ counts)
        error = np.maximum(error, _missed(exact, guess, known))
        sure &= 4.0 * error < _FALL
    guess[~sure], error[~sure] = 0.0, 0.0
    best = guess.argmax(axis=1)
    falls = guess < np.minimum(1.0, 1.0 - _FALL + 2.0 * error)[:, None] * np.maximum.accumulate(guess, axis=1)
    sure &= ~(falls & (np.arange(points) <= best[:, None])).any(axis=1)
    highest = guess[every, best]
    wanted = guess >= (highest - 2.0 * error * np.abs(highest))[:, None]
    wanted[:, 1:] |= wanted[:, :-1].copy()
    wanted[:, :-1] |= wanted[:, 1:].copy()
    more = wanted & ~known
    count = more.sum(axis=1)
    sure &= count <= points // 3
    asked = [(k, slip[more[k]]) for k in np.flatnonzero(sure & (count > 0)).tolist()]
    for (k, _), friction in zip(asked, evaluate(asked) if asked else (), strict=True):
        exact[k, more[k]] = friction
    sure &= _missed(exact, guess, more) <= np.where(count > 0, error, np.inf)
    chosen = known | wanted
    return {k: (slip[chosen[k]], exact[k, chosen[k]], beside[k]) for k in np.flatnonzero(sure).tolist()}


def _missed(exact: Array, guess: Array, where: "NDArray[np.bool_]") -> Array:
    """By how much guesses miss what is exact somewhere at most, relative to them; where both are zero they do not."""
    size = np.abs(guess)
    with np.errstate(divide="ignore"):
        missed = np.abs(exact - guess) / np.where((size > 0.0) | (exact != 0.0), size, 1.0)
    return np.asarray(np.where(where, missed, 0.0).max(axis=1))


def _around(
    slip: Array, friction: Array, top: int, together: bool, beside: _Known | None
) -> Generator[Array, Array, tuple[float, float]]:
    """Place and value of the largest friction on the two intervals around a point of the grid that tops both."""
    first, last = max(top - 1, 0), min(top + 1, slip.size - 1)
    low, high = float(slip[first]), float(slip[last])
    at, largest = float(slip[top]), float(friction[top])
    if together and first < top < last:
        at_nodes = beside[2] if beside is not None and beside[:2] == (low, high) else (yield _nodes(low, high))
        found = _smooth(at_nodes, low, high)
        if found is not None:
            return found if found[1] > largest else (at, largest)

    # relative to the interval and to the best value, so that no size of either is lost in a tolerance
    known = [((float(slip[k]) - low) / (high - low), float(friction[k]) / largest) for k in (top, first, last)]
    search = _peak(known)
    share = next(search)
    while True:
        value = yield np.array([low + share * (high - low)])
        try:
            share = search.send(float(value[0]) / largest)
        except StopIteration as end:
            share, height = end.value
            break
    if height > 1.0:  # else a kink or a plateau, which the search did not hit
        at, largest = low + share * (high - low), height * largest
    return at, largest


def _smooth(values: Array, low: float, high: float) -> tuple[float, float] | None:
    """Place and size of the largest value inside an interval, of the polynomial through it; None where it has no end.

    Its highest terms tell whether it is the curve: beside a kink they fall too slowly.
    """
    terms = (_TERMS @ values).tolist()
    if not max(map(abs, terms[-_TAIL:])) <= _RESOLVED * abs(terms[0]):
        return None
    slope, bend = (_SLOPES @ values).tolist(), (_BENDS @ values).tolist()
    x = float(_NODES[np.argmax(values)])
    for _ in range(_STEPS):
        rise, curved = _series(x, slope), _series(x, bend)
        step = rise / curved if curved else math.inf
        x -= step
        if not abs(x) < 1.0:
            return None
        if abs(step) <= _PLACE:
            return low + 0.5 * (high - low) * (1.0 + x), _series(x, terms)
    return None


def _series(x: float, terms: Sequence[float]) -> float:
    """Sum of Chebyshev polynomials at x, by Clenshaw's recurrence."""
    one = two = 0.0
    for term in reversed(terms):
        one, two = term + 2.0 * x * one - two, one
    return one - x * two


def _peak(known: list[tuple[float, float]]) -> Generator[float, float, tuple[float, float]]:
    """Largest value between 0 and 1 and its place, by Brent's method: parabolas, or golden sections if those fail.

    It yields places and is sent the values there. ``known`` are the best of three points and both ends. A best point
    that is an end has the largest value unless the curve rises from there.
    """
    (x, fx), (w, fw), (v, fv) = known
    if x in (0.0, 1.0):
        x = abs(x - _PLACE)
        fx = yield x
        if fx <= known[0][1]:
            return known[0]
    low, high, step, before = 0.0, 1.0, 1.0, 1.0
    while max(x - low, high - x) > 2.0 * _PLACE:
        # the parabola through the three best points, unless it leads outside or its steps do not shrink
        r, q = (x - w) * (fx - fv), (x - v) * (fx - fw)
        p, q = (x - v) * q - (x - w) * r, 2.0 * (q - r)
        to = x - p / q if q != 0.0 else math.inf
        if low < to < high and abs(to - x) < 0.5 * abs(before):
            before, step = step, to - x
        else:
            before = (low if x > 0.5 * (low + high) else high) - x
            step = _GOLDEN * before
        u = x + math.copysign(max(abs(step), _PLACE), step)
        if not low < u < high:
            u = 0.5 * (x + (low if u <= low else high))
        fu = yield u
        if fu >= fx:
            low, high = (x, high) if u > x else (low, x)
            (v, fv), (w, fw), (x, fx) = (w, fw), (x, fx), (u, fu)
        else:
            low, high = (low, u) if u > x else (u, high)
            if fu >= fw or w == x:
                (v, fv), (w, fw) = (w, fw), (u, fu)
            elif fu >= fv or v in (x, w):
                v, fv = u, fu
    return x, fx
