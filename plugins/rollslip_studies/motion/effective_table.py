"""Effective friction of a raceway as a table: over the sliding speed, or over sliding and rolling speed.

- mu_e = sum(mu Q)/sum(Q) over the loaded slices of all positions of the orbit at the epicyclic speed (see
  ``effective_friction``), here as a function of what the contact itself knows: its sliding speed V and its rolling
  speed u. Cage slip and roller slip, in which the study states it, are these two for either raceway in other units.
- Over V alone the rolling speed is the epicyclic one. With the rollers near rolling on the outer ring, as most are,
  the rolling speed of neither contact moves by more than a tenth of the sliding speed.
- Friction rises over a small sliding speed and falls slowly beyond: equal steps of V/(|V| + V_s), one division and one
  multiplication for the index. Where it also depends on u the rise goes with the slide-roll ratio, V_s = S u.
- V_s is free, so it is chosen such that the critical sliding speed, where friction is largest, is a node, whose slope
  is zero: place and height of the maximum are those of the law. Of the V_s that do so the one counts with which few
  cells err least. The slope at V = 0 is the law's, too.
- A law has one second derivative for V < 0 and another for V > 0, so each half is a cubic spline of its own.
- The slopes of a spline are limited to three times those of the chords beside them (Fritsch & Carlson 1980): cells are
  monotone, and the cubics have as many extrema as their nodes. Where nodes turn, the cell towards which the slope there
  points holds the extremum and sets no limit: one that no node hits is neither flattened nor moved (after Hyman 1983).
- In a map this holds along V on the rows. Between them cubics of smooth laws were not seen to turn more often either;
  a corner that wanders from row to row ripples there by the error of the table.
- Friction of a slice depends on its load: thousands of loaded slices are gathered into classes of equal force, as many
  as the tolerance needs to keep friction, slope at no slip and critical speed.
- Cells are halved until friction at the quarters of each is right to the tolerance, relative to the largest at that
  rolling speed, and the slope at no slip is within the limits of its cells: a rise may be too small for the tolerance
  and yet be most of that slope. A tenth of the tolerance is left to the classes and a tenth to what lies between the
  quarters.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Critical, Curve, find_critical_slips
from rollslip.bearing.raceway import RINGS, Array, Raceway
from rollslip.bearing.resolution import COARSER_TABLES
from rollslip.errors import ConvergenceError
from rollslip_kernels.motion import raceway as compiled

#: Largest sliding speed, relative to the epicyclic rolling speed; beyond it friction is held.
_REACH: Final = 8.0
#: Rolling speeds of a map, relative to the epicyclic one, which is a row; beyond them friction is held.
_ROLLING: Final = (1.0 / 11.0, 3.0)
#: Sliding speeds at which laws are looked at before there are nodes, over 8 decades.
_PROBES: Final = 129
#: A speed that is to be a node is at one of these shares of the way to the largest one, the last for steep rises.
_SHARES: Final = (*(k / 16 for k in range(1, 16)), *(1.0 - 0.5**k for k in range(5, 11)))
_FIRST_CELLS = 64
_MAX_CELLS = 4096
#: To what a curve goes on that misses its tolerance with the most: a fast roller bends far from where friction rises.
_LAST_CELLS: Final = 32768
#: Where the first cells err more than this, more of them are needed to tell which mapping is best.
_UNCLEAR = 0.01
_CLEARER = 256
_CLEAR_CELLS = 1024
_FIRST_ROWS = 8
_MAX_ROWS = 256
_FIRST_CLASSES = 16
_MAX_CLASSES = 1024
#: Slices evaluated at a time.
_AT_ONCE: Final = 1 << 18
#: Of the tolerance, for the cells and for the classes.
_CELLS_FRACTION = 0.8
_CLASSES_FRACTION = 0.1
#: Of two maxima among the probes that differ by less, either may be the larger one.
_ALIKE: Final = 0.05
#: What rounding leaves of the place of a maximum.
_PLACE: Final = 1e-7
#: Sliding speed, relative to that at which friction has risen by half, from which the slope at none is taken.
_NEAR: Final = 1e-4
#: What the limits of slopes may leave of the slope at no slip, relative to it.
_SLOPE: Final = 1e-9
#: How what one node has to do with the slope at another falls from node to node, and after how many it is rounding.
_DECAY = math.sqrt(3.0) - 2.0
_DECAYED = 28

Law = Callable[[Array], Array]


@attrs.frozen(eq=False)
class EffectiveTable:
    """A table as ``rollslip_kernels.motion.raceway.effective`` takes it."""

    nodes: Array  # (N, 2) over the sliding speed, (M, N, 4) over rolling and sliding speed
    limits: tuple[float, float]  # V/(|V| + V_s) of the first and the last node
    #: sliding_scale, sliding_ratio: V_s = sliding_scale + sliding_ratio u [m/s].
    sliding_scale: float = 0.0
    sliding_ratio: float = 0.0
    row_limits: tuple[float, float] = (0.0, 1.0)  # u/(u + u_s) of the first and the last row
    rolling_scale: float = 1.0  # u_s [m/s]
    #: Largest error at the quarters of the cells, relative to the largest friction at that rolling speed, and what the
    #: classes add.
    error: float = 0.0
    slope_error: float = (
        0.0  # error of the slope at no slip, relative to it, at the epicyclic rolling speed
    )
    #: Sliding speed V > 0 of the largest friction at the epicyclic rolling speed [m/s]; NaN if there is none below half
    #: the largest sliding speed.
    critical_speed: float = math.nan
    #: Error of ``critical_speed`` or of the friction there, the larger one, relative to it; NaN without one.
    critical_error: float = math.nan

    @property
    def record(self) -> dict[str, object]:
        """Size and errors by name, as results keep them; what has no value is None."""
        names = ("error", "slope_error", "critical_speed", "critical_error")
        values = {name: getattr(self, name) for name in names}
        known = {name: value if math.isfinite(value) else None for name, value in values.items()}
        return {"nodes": list(self.nodes.shape[: self.nodes.ndim - 1]), **known}

    @property
    def curve(self) -> tuple[Array, Array] | None:
        """Sliding speeds [m/s] and friction at the nodes; None for a table over two speeds."""
        if self.nodes.ndim != 2:
            return None
        return _speed(
            np.linspace(*self.limits, self.nodes.shape[0]), self.sliding_scale
        ), self.nodes[:, 0]

    def raceway(self, rollers: int) -> object:
        """Return the compiled raceway of so many rollers."""
        return compiled.effective(
            rollers,
            self.nodes,
            self.limits,
            self.sliding_scale,
            self.sliding_ratio,
            self.row_limits,
            self.rolling_scale,
        )


def effective_table(
    assembly: Assembly,
    raceway: Raceway,
    load: Array,
    tolerance: float,
    slips: bool,
    between_nodes: float = 1.0,
) -> EffectiveTable:
    """Tabulate the effective friction of a raceway.

    Parameters
    ----------
    assembly : Assembly
        The bearing.
    raceway : Raceway
        One of its raceways.
    load : ndarray
        Loads per length of a roller at positions of the orbit [N/m], (K, n).
    tolerance : float
        Largest error, relative to the largest friction at a rolling speed.
    slips : bool
        Over both speeds instead of the sliding speed alone.
    between_nodes : float
        Share of what cubics over the sliding speed alone may leave between nodes that is aimed at, up to 1.
    """
    epicyclic = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    rolling = np.array(
        [epicyclic, *(epicyclic * fraction for fraction in _ROLLING)][: 3 if slips else 1]
    )
    distinct, times = np.unique(
        load[load > 0.0], return_counts=True
    )  # mirror images are equal to the bit
    law, left = _gathered(
        raceway, distinct, times.astype(float), rolling, _CLASSES_FRACTION * tolerance
    )
    cells = _CELLS_FRACTION * tolerance
    if slips:
        table = map_table(law, epicyclic, cells)
    else:
        table = curve_table(partial(law, epicyclic), epicyclic, cells, between_nodes * cells)
    return attrs.evolve(
        table,
        error=table.error + left[0],
        slope_error=table.slope_error + left[1],
        critical_error=table.critical_error + left[2],
    )


class _Recorded(Protocol):
    @property
    def record(self) -> Mapping[str, object]:
        """Size and errors by name."""
        ...


def table_records(tables: Sequence[_Recorded], name: str = "effective_tables") -> dict[str, str]:
    """Return the attribute of a result that says how right its tables of inner and outer raceway are, if it has any."""
    records = dict(zip(RINGS, (table.record for table in tables), strict=False))
    return {name: json.dumps(records)} if records else {}


def curve_table(
    friction: Law, rolling: float, tolerance: float, aim: float | None = None
) -> EffectiveTable:
    """Tabulate friction over the sliding speed.

    Parameters
    ----------
    friction : callable
        Friction coefficients at sliding speeds V [m/s], (m,) each.
    rolling : float
        Rolling speed [m/s], of which the table reaches eight times.
    tolerance : float
        Largest error at the quarters of cells, relative to the largest friction.
    aim : float, optional
        Error down to which nodes are added as long as there are not the most of them, by default the tolerance.
    """
    shape = _shape(friction, rolling)
    scale, limit, fraction = _mapping([(1.0, friction)], shape, rolling)

    def at(x: Array) -> Array:
        return friction(_speed(x, scale))

    cells = _first_cells(fraction)
    fine = at(_halves(limit, 4 * cells))
    while True:
        values = fine[::4]
        slopes = _slopes(
            limit, values, scale * shape.slope, fraction if shape.has_critical else 0.0
        )
        error = _missed(fine, slopes)
        enough = error <= (tolerance if aim is None else aim) and _rises(
            limit, slopes, scale * shape.slope
        )
        if enough or (cells >= _MAX_CELLS and error <= tolerance):
            break
        if cells >= _LAST_CELLS:
            raise _too_coarse(error, tolerance)
        both = np.empty(8 * cells + 1)
        both[::2], both[1::2] = fine, at(_halves(limit, 8 * cells)[1::2])
        cells = 2 * cells
        fine = both
    nodes = np.stack((values, slopes), axis=-1)
    table = EffectiveTable(nodes, (-limit, limit), sliding_scale=scale, error=error)
    return _stated(table, shape, nodes, scale)


def map_table(
    friction: Callable[[float, Array], Array], epicyclic: float, tolerance: float
) -> EffectiveTable:
    """Tabulate friction over rolling and sliding speed.

    Parameters
    ----------
    friction : callable
        Friction coefficients at a rolling speed u and sliding speeds V [m/s], (m,) each.
    epicyclic : float
        Rolling speed [m/s] about which the map is made: an eleventh to three times of it, and eight times the rolling
        speed in V.
    tolerance, Raises
        As for `curve_table`.
    """
    shape = _shape(partial(friction, epicyclic), epicyclic)
    laws = [(fraction, partial(friction, fraction * epicyclic)) for fraction in (1.0, *_ROLLING)]
    scale, limit, fraction = _mapping(laws, shape, epicyclic)
    ratio = scale / epicyclic
    near = _NEAR * shape.half / epicyclic
    low, high = (part / (part + 1.0) for part in _ROLLING)
    cells = _first_cells(fraction)
    rows = _FIRST_ROWS
    while cells <= _MAX_CELLS and rows <= _MAX_ROWS:
        x = _halves(limit, 4 * cells)
        e = np.linspace(low, high, 2 * rows + 1)
        u = epicyclic * e / (1.0 - e)
        true = np.array([friction(speed, _speed(x, ratio * speed)) for speed in u.tolist()])
        rise = [
            ratio * speed * _slope(partial(friction, speed), near * speed)[0]
            for speed in u[::2].tolist()
        ]
        values = true[::2, ::4]
        slopes = _slopes(limit, values, np.array(rise))
        middle = 5 * rows // 8  # the epicyclic row
        slopes[middle] = _slopes(
            limit, values[middle], rise[middle], fraction if shape.has_critical else 0.0
        )
        rising, twisting = (_spline(part.T).T for part in (values, slopes))
        # half-way between the rows
        values_there = _between(values.T, rising.T, 0.5).T
        slopes_there = _between(slopes.T, twisting.T, 0.5).T
        along = _missed(true[::2], slopes)
        across = _relative(values_there - true[1::2, ::4], true[1::2])
        inside = max(
            _relative(_between(values_there, slopes_there, q / 4) - true[1::2, q::4], true[1::2])
            for q in (1, 2, 3)
        )
        error = max(along, across, inside)
        steep = cells < _MAX_CELLS and not _rises(limit, slopes[middle], rise[middle])
        if error <= tolerance and not steep:
            nodes = np.stack((values, slopes, rising, twisting), axis=-1)
            table = EffectiveTable(
                nodes,
                (-limit, limit),
                sliding_ratio=ratio,
                row_limits=(low, high),
                rolling_scale=epicyclic,
                error=error,
            )
            return _stated(table, shape, nodes[middle], scale)
        cells *= 2 if steep or along > 0.5 * tolerance else 1
        rows *= 2 if max(across, inside) > max(0.5 * tolerance, along) else 1
    raise _too_coarse(error, tolerance)


# What is to be kept --------------------------------------------------------------------------------------------------


@attrs.frozen
class _Shape:
    """Slope at no slip and largest friction of a law.

    ``half`` is the sliding speed at which friction has risen by half [m/s], ``slope_error`` that of ``slope``, relative
    to it.
    """

    half: float
    slope: float
    slope_error: float
    critical: Critical

    @property
    def has_critical(self) -> bool:
        return not math.isnan(self.critical.slip)


def _shape(friction: Law, rolling: float) -> _Shape:
    probe = _probe(rolling)
    values = friction(probe)
    risen = np.abs(values)
    half = float(probe[np.argmax(risen >= 0.5 * risen.max())])
    end = int(np.searchsorted(probe, 0.5 * _REACH * rolling)) - 1
    # of maxima of nearly the same height, any may be the largest
    high = values[1:end] >= (1.0 - _ALIKE) * values[: end + 1].max()
    peaks = 1 + np.flatnonzero(
        high & (values[1:end] > values[: end - 1]) & (values[1:end] >= values[2 : end + 1])
    )
    curves = [
        Curve(probe[grid], values[grid], "")
        for grid in ([k - 1, k, k + 1, end] for k in peaks.tolist())
    ]
    maxima = find_critical_slips(
        curves, lambda requested: [*friction(np.concatenate([V for _, V in requested]))[:, None]]
    )
    found = (one for one in maxima if not math.isnan(one.slip))
    critical = max(found, key=lambda one: one.friction, default=Critical(math.nan, math.nan, ""))
    return _Shape(half, *_slope(friction, _NEAR * half), critical)


def _probe(rolling: float) -> Array:
    return rolling * np.geomspace(1e-7, _REACH, _PROBES)


def _slope(friction: Law, near: float) -> tuple[float, float]:
    """Slope at no slip and its relative error: central differences at ``near`` and half of it thrice, extrapolated.

    Friction has terms in V |V|, so that their errors go with all powers of V.
    """
    V = near * 0.5 ** np.arange(4)
    ahead, behind = np.split(friction(np.concatenate((V, -V))), 2)
    difference = (ahead - behind) / (2.0 * V)
    before = math.nan
    for power in (2.0, 4.0, 8.0):
        before = float(difference[-1])
        difference = (power * difference[1:] - difference[:-1]) / (power - 1.0)
    return float(difference[0]), _apart(before, float(difference[0]))


def _apart(value: float, true: float) -> float:
    """Difference relative to the true value."""
    return abs(value - true) / (abs(true) or 1.0)


def _stated(table: EffectiveTable, shape: _Shape, nodes: Array, scale: float) -> EffectiveTable:
    """Return a table with the critical speed and the errors that it leaves of a shape; ``nodes`` (N, 2 or more)."""
    middle = nodes.shape[0] // 2
    limit = table.limits[1]
    slope = float(nodes[middle, 1]) * middle / (limit * scale)
    table = attrs.evolve(table, slope_error=shape.slope_error + _apart(slope, shape.slope))
    if not shape.has_critical:
        return table
    largest = int(np.argmax(nodes[middle:, 0]))
    at = float(_speed(np.array(limit * largest / middle), scale))
    moved = (
        _apart(at, shape.critical.slip),
        _apart(float(nodes[middle + largest, 0]), shape.critical.friction),
    )
    return attrs.evolve(
        table, critical_speed=shape.critical.slip, critical_error=_PLACE + max(moved)
    )


# The mapping ---------------------------------------------------------------------------------------------------------


def _mapping(
    laws: Sequence[tuple[float, Law]], shape: _Shape, rolling: float
) -> tuple[float, float, float]:
    """V_s, the limit of V/(V + V_s), and the share of it at which the critical speed, or else the half-way one, is.

    ``laws`` are those that the cells are to follow, the first one that of the shape, and by what their V_s is longer.
    """
    reach = _REACH * rolling
    node = shape.critical.slip if shape.has_critical else shape.half
    rises = [_slope(law, _NEAR * shape.half * longer)[0] for longer, law in laws]
    fractions = [fraction for fraction in _SHARES if fraction * reach > node]
    for cells in (_FIRST_CELLS, _CLEARER, _CLEAR_CELLS):
        found = list[tuple[float, float, float, float]]()
        for fraction in fractions:
            scale = node * reach * (1.0 - fraction) / (fraction * reach - node)
            limit = reach / (reach + scale)
            error = 0.0
            for (longer, law), rise in zip(laws, rises, strict=True):
                fine = law(_speed(_halves(limit, 4 * cells), scale * longer))
                error = max(error, _missed(fine, _slopes(limit, fine[::4], scale * longer * rise)))
            found.append((error, scale, limit, fraction))
        found.sort(key=lambda one: one[0])
        if found[0][0] <= _UNCLEAR:
            break
        fractions = [
            fraction for *_, fraction in found[: (len(found) + 1) // 2]
        ]  # what is worse is not the best with more
    return found[0][1:]


def _first_cells(fraction: float) -> int:
    """Fewest cells of which a node is at a share of either half."""
    cells = _FIRST_CELLS
    while fraction * cells % 2.0:
        cells *= 2
    return cells


def _speed(x: Array, scale: float) -> Array:
    return np.asarray(scale * x / (1.0 - np.abs(x)))


def _halves(limit: float, cells: int) -> Array:
    """Nodes from -limit to limit, with 0 exactly among them."""
    half = np.linspace(0.0, limit, cells // 2 + 1)
    return np.concatenate((-half[:0:-1], half))


# The cubics ----------------------------------------------------------------------------------------------------------


def _slopes(limit: float, values: Array, rise: Any, fraction: float = 0.0) -> Array:
    """Derivatives times the width of a cell at nodes along the last axis, from splines in each half, limited.

    ``rise`` is the derivative in the middle, and ``fraction`` that of ``limit`` at which friction is largest;
    0 for none.
    """
    middle = values.shape[-1] // 2
    step = limit / middle
    above = _spline(values[..., middle:], step * np.asarray(rise))
    below = _spline(values[..., middle::-1], -step * np.asarray(rise))
    slopes = np.concatenate((-below[..., :0:-1], above), axis=-1)
    if fraction:
        critical = round(fraction * middle)
        slopes[..., middle + critical] = 0.0
        if np.array_equal(values, -values[..., ::-1]):
            slopes[..., middle - critical] = 0.0
    return np.clip(slopes, *_bounds(values, slopes))


def _spline(values: Array, rise: Array | None = None) -> Array:
    """Slopes, times the width of a cell, of the cubic spline through equally spaced nodes on the last axis, at least 4.

    ``rise`` is that of the first node; without it, as at the last node, no knot separates the first two cells. Slopes
    m obey m_k-1 + 4 m_k + m_k+1 = 3 (y_k+1 - y_k-1), of which [1 4 1] has the inverse z^|k| / (2 sqrt 3) with
    z = sqrt(3) - 2; to it z^k and z^(n-k) are added so that the ends are right.
    """
    chord = np.diff(values, axis=-1)
    last = values.shape[-1] - 1
    right = np.zeros(values.shape)
    right[..., 1:-1] = 3.0 * (chord[..., :-1] + chord[..., 1:])
    inverse = _DECAY ** np.abs(np.arange(-_DECAYED, _DECAYED + 1)) / (2.0 * math.sqrt(3.0))
    rows = (np.convolve(row, inverse)[_DECAYED:-_DECAYED] for row in right.reshape(-1, last + 1))
    slopes = np.array(list(rows)).reshape(values.shape)
    ahead = _DECAY ** np.arange(last + 1)
    behind = ahead[::-1]
    far = ahead[-1]
    knotless = 1.0 + 2.0 * _DECAY
    missed = 2.5 * chord[..., -1] + 0.5 * chord[..., -2] - slopes[..., -1] - 2.0 * slopes[..., -2]
    if rise is None:
        missed_first = (
            2.5 * chord[..., 0] + 0.5 * chord[..., 1] - slopes[..., 0] - 2.0 * slopes[..., 1]
        )
        near = knotless
        across = far + 2.0 * ahead[-2]
    else:
        missed_first = rise - slopes[..., 0]
        near = 1.0
        across = far
    of_last = (
        far + 2.0 * ahead[-2]
    )  # what z^k leaves at the last node, as `across` is what z^(n-k) does at the first
    both = near * knotless - across * of_last
    first = missed_first * knotless - across * missed
    second = near * missed - of_last * missed_first
    return np.asarray(
        slopes + (first / both)[..., None] * ahead + (second / both)[..., None] * behind
    )


def _rises(limit: float, slopes: Array, rise: float) -> bool:
    """Whether the slope in the middle is the law's, and not that of the limits: three times the chord beside it."""
    middle = slopes.size // 2
    return _apart(float(slopes[middle]) * middle / limit, rise) <= _SLOPE


def _bounds(values: Array, slopes: Array) -> tuple[Array, Array]:
    """Lowest and highest slopes at nodes along the last axis with which no cell has an extremum that these do not show.

    A cubic is monotone if both its slopes have the sign of the chord and are at most three times as steep. Cells that
    hold an extremum, since a node turns and its slope points there or since they are flat between a rise and a fall,
    have a slope of either sign at their ends and with it exactly one.
    """
    rise = np.diff(values, axis=-1)
    sign = np.sign(rise)
    before = sign[..., :-1]
    after = sign[..., 1:]
    turns = before * after < 0.0
    points = np.sign(slopes[..., 1:-1])
    holds = np.zeros(rise.shape, dtype=bool)
    holds[..., 1:] |= turns & (points == before)
    holds[..., :-1] |= turns & (points == after)
    holds[..., 1:-1] |= (sign[..., 1:-1] == 0.0) & (sign[..., :-2] * sign[..., 2:] < 0.0)
    # of each cell for the node before it and for the one after it: one that turns is free in the cell that holds it
    turning = np.zeros(values.shape, dtype=bool)
    turning[..., 1:-1] = turns
    bounds = []
    for low in (True, False):
        least = np.minimum(3.0 * rise, 0.0) if low else np.maximum(3.0 * rise, 0.0)
        free = np.where(sign * (1.0 if low else -1.0) > 0.0, 0.0, -np.inf if low else np.inf)
        ends = []
        for turned in (turning[..., :-1], turning[..., 1:]):
            wide = np.where(turned | (sign == 0.0), -np.inf if low else np.inf, free)
            ends.append(np.where(holds, wide, least))
        at = np.full((2, *values.shape), -np.inf if low else np.inf)
        at[0, ..., :-1], at[1, ..., 1:] = ends
        bounds.append(at.max(axis=0) if low else at.min(axis=0))
    return bounds[0], bounds[1]


def _between(values: Array, slopes: Array, fraction: float) -> Array:
    """Hermite's cubics at a share of every cell of the last axis."""
    x = fraction
    rise = np.diff(values, axis=-1)
    part = values[..., :-1] + x * x * (3.0 - 2.0 * x) * rise
    return np.asarray(part + x * (1.0 - x) * ((1.0 - x) * slopes[..., :-1] - x * slopes[..., 1:]))


def _missed(fine: Array, slopes: Array) -> float:
    """Largest relative error of cubics at the quarters of their cells; ``fine`` has these and the nodes."""
    return max(
        _relative(_between(fine[..., ::4], slopes, q / 4) - fine[..., q::4], fine)
        for q in (1, 2, 3)
    )


def _relative(off: Array, values: Array) -> float:
    """Largest error relative to the largest value of its row."""
    largest = np.abs(values).max(axis=-1)
    return float((np.abs(off).max(axis=-1) / np.where(largest > 0.0, largest, 1.0)).max())


def _too_coarse(error: float, tolerance: float) -> ConvergenceError:
    return ConvergenceError(
        f"the table of effective friction still has a relative error of {error:.1e} with the most nodes, more than the "
        f"{tolerance:.1e} that are left to it; {COARSER_TABLES}"
    )


# The law -------------------------------------------------------------------------------------------------------------


def _gathered(
    raceway: Raceway, load: Array, times: Array, rolling: Array, tolerance: float
) -> tuple[Callable[[float, Array], Array], tuple[float, float, float]]:
    """Gather slices of ascending load, each so many times there, into as few classes as leave what is to be kept.

    Classes are of equal force. Returns mean friction over rolling and sliding speed, and their errors: of friction at
    any of the rolling speeds, and at the first one of the slope at no slip and of the maximum.
    """
    fraction = load * times / (load * times).sum()
    whole = _mean_friction(raceway, load, fraction)
    true = [whole(u, _probe(u)) for u in rolling.tolist()]
    epicyclic = float(rolling[0])
    shape = _shape(partial(whole, epicyclic), epicyclic) if load.size > _FIRST_CLASSES else None
    count = _FIRST_CLASSES
    while shape is not None and count < min(load.size, _MAX_CLASSES):
        number = np.minimum((count * (np.cumsum(fraction) - 0.5 * fraction)).astype(int), count - 1)
        force = np.asarray(np.bincount(number, fraction, count), dtype=float)
        mean = np.bincount(number, fraction * load, count)[force > 0.0] / force[force > 0.0]
        law = _mean_friction(raceway, mean, force[force > 0.0])
        off = max(
            _relative(law(u, _probe(u)) - one, one)
            for u, one in zip(rolling.tolist(), true, strict=True)
        )
        gathered = _shape(partial(law, epicyclic), epicyclic)
        slope = _apart(gathered.slope, shape.slope)
        place = 0.0
        if shape.has_critical != gathered.has_critical:
            place = math.inf
        elif shape.has_critical:
            place = max(
                _apart(gathered.critical.slip, shape.critical.slip),
                _apart(gathered.critical.friction, shape.critical.friction),
            )
        if max(off, slope) <= tolerance and place <= max(tolerance, _PLACE):
            return law, (off, slope, place)
        count *= 2
    return whole, (0.0, 0.0, 0.0)


def _mean_friction(
    raceway: Raceway, load: Array, fraction: Array
) -> Callable[[float, Array], Array]:
    """Mean friction, over rolling and sliding speed, of slices with loads per length and shares of the force."""
    part = max(_AT_ONCE // max(load.size, 1), 1)

    def friction(rolling: float, sliding: Array) -> Array:
        if load.size == 0:
            return np.zeros_like(sliding)
        parts = []
        for begin in range(0, sliding.size, part):
            V = sliding[begin : begin + part]
            slices = raceway.evaluate(np.tile(load, V.size), rolling, np.repeat(V, load.size))
            parts.append(
                (slices.friction.reshape(V.size, -1) * fraction).sum(axis=1)
            )  # not by BLAS, whose threads show
        return np.concatenate(parts)

    return friction
