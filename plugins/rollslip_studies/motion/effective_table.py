"""Effective friction of a raceway as a table over the sliding speed.

mu_e = sum(mu Q)/sum(Q) over the loaded slices of all positions of the orbit at the epicyclic speed (see
``effective_friction``). Here it is a function of the sliding speed V of the contact itself, at the epicyclic rolling
speed. With rollers near rolling on the outer ring, as most are, the rolling speed of either contact changes by less
than a tenth of the sliding speed.

1. Gather thousands of loaded slices into classes of equal force, as many as the tolerance requires for friction,
   its slope at no slip and the critical sliding speed, where friction is largest.
2. Map the sliding speed to x = V/(|V| + V_s). Friction rises over a small sliding speed and falls slowly beyond, so
   that equal steps of x resolve both; the index of a cell costs one division and one multiplication.
3. Choose V_s such that the critical sliding speed is a node, whose slope is zero: abscissa and height of the maximum
   are those of the law. Of the V_s that do so take the one with which few cells have the smallest error.
4. Interpolate each half, V < 0 and V > 0, by a cubic spline, because the second derivative of a law jumps at V = 0. The
   slope there is that of the law.
5. Limit the slopes to three times those of the neighbouring chords (Fritsch & Carlson 1980), so that cells are monotone
   and the cubics have as many extrema as their nodes. Where nodes change from rising to falling, the cell towards which
   the slope points contains the extremum and sets no limit, so that the extremum is neither flattened nor shifted
   (after Hyman 1983).
6. Double the number of cells until the error at the quarters of each is within the tolerance, relative to the largest
   friction, and the slope at no slip is that of the law: a rise may be too small for the tolerance and yet be most of
   that slope. A tenth of the tolerance is left to the classes and a tenth to the error between the quarters.

References
----------
F. N. Fritsch, R. E. Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 17 (1980) 238-246.
J. M. Hyman, "Accurate monotonicity preserving cubic interpolation", SIAM J. Sci. Stat. Comput. 4 (1983) 645-654.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Final, Protocol

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Critical, Curve, find_critical_slips
from rollslip.bearing.raceway import RINGS, Array, Raceway
from rollslip.bearing.resolution import COARSER_TABLES
from rollslip.errors import ConvergenceError
from rollslip.results.curves import or_none
from rollslip_kernels.motion import raceway as compiled

# Effects of half and twice a value were measured on 16 curves of shipped scenes, tolerances 1e-3 and 1e-5.

#: Largest sliding speed, relative to the epicyclic rolling speed; beyond it friction is constant. Doubling it adds
#: 18 % of nodes, half of it saves 1 %; chosen.
_MAX_SLIDING: Final = 8.0
#: Number of sliding speeds, over eight decades, by which the maximum of a law is bracketed. Doubling it costs 3 %
#: more evaluations, half of it saves 2 % but may miss a narrow maximum; chosen.
_PROBES: Final = 129
#: Fractions of the largest abscissa at one of which the critical sliding speed becomes a node, the last for steep
#: rises. Denser fractions need more cells; chosen, multiples of 1/16 and halvings of the distance to 1.
_NODE_FRACTIONS: Final = (*(k / 16 for k in range(1, 16)), *(1.0 - 0.5**k for k in range(5, 11)))
#: Numbers of cells by which fractions are compared, more while none has an error below `_CLEAR_ERROR`. Twice as
#: many of the second cost 2 %, half and twice the third have no effect; chosen.
_TRIAL_CELLS: Final = (64, 256, 1024)
#: Error up to which the best fraction is known. Half of it costs 12 % more evaluations, twice as much saves 2 % and
#: chooses another fraction in one of 20 tables; chosen.
_CLEAR_ERROR: Final = 0.01
#: Smallest number of cells. Half as many cost 9 % more evaluations (further doublings), twice as many 35 %.
_FIRST_CELLS: Final = 64
#: Number of cells from which on no slope and no smaller error than the tolerance is aimed at. Half and twice the
#: value have no effect on these tables; chosen, 16 kB per column.
_MAX_CELLS: Final = 4096
#: Number of cells at which a table that misses its tolerance is refused. Half and twice the value have no effect on
#: these tables; chosen, because friction of a fast roller bends far from where it rises.
_LAST_CELLS: Final = 32768
#: Smallest number of classes of load. Half and twice the value change evaluations by 0.2 %; chosen.
_FIRST_CLASSES: Final = 16
#: Number of classes from which on all slices are used. Half and twice the value have no effect on these tables;
#: chosen.
_MAX_CLASSES: Final = 1024
#: Slices evaluated at a time. Twice as many take twice the memory, 2 MB per column; chosen.
_BLOCK_SIZE: Final = 1 << 18
#: Fraction of the tolerance for the cells. Twice the value misses the tolerance by 5 %, half of it needs 39 % more
#: nodes.
_CELLS_FRACTION: Final = 0.8
#: Fraction of the tolerance for the classes. Half and twice the value change evaluations by less than 3 %; chosen.
_CLASSES_FRACTION: Final = 0.1
#: Relative difference up to which either of two maxima among the probes may be the larger one. Half and twice the
#: value have no effect on these tables; chosen, more than the error between two probes.
_EQUAL_MAXIMA: Final = 0.05
#: Relative error of the abscissa of a maximum by rounding: the root of that of the friction, with a factor of about
#: ten. Doubling it doubles a stated error of the critical speed of 1e-7.
_LOCATION_ROUNDING: Final = 1e-7
#: Step of the slope at no slip, relative to the sliding speed at which friction has risen by half. Half and
#: twice the value change nothing but rounding; chosen, in between truncation and rounding.
_SLOPE_STEP: Final = 1e-4
#: Relative difference of the slope at no slip from that of the law from which on the limits of slopes count as
#: active. Half and twice the value have no effect on these tables; chosen, above rounding.
_SLOPE_TOLERANCE: Final = 1e-9

Law = Callable[[Array], Array]


@attrs.frozen(eq=False)
class EffectiveTable:
    """A table as ``rollslip_kernels.motion.raceway.effective`` takes it."""

    nodes: Array  # friction and its slope times the width of a cell, (N, 2)
    limits: tuple[float, float]  # V/(|V| + V_s) of the first and the last node
    sliding_scale: float  # V_s [m/s]
    #: Largest error at the quarters of the cells, relative to the largest friction, plus the error of the classes.
    error: float
    slope_error: float = 0.0  # relative error of the slope at no slip
    #: Sliding speed V > 0 of the largest friction [m/s]; NaN if there is none below half the largest sliding
    #: speed.
    critical_speed: float = math.nan
    #: Relative error of ``critical_speed`` or of the friction there, the larger one; NaN without one.
    critical_error: float = math.nan

    @property
    def record(self) -> dict[str, object]:
        """Size and errors by name, as results store them; NaN is None."""
        values = {
            name: getattr(self, name)
            for name in ("error", "slope_error", "critical_speed", "critical_error")
        }
        known = {name: or_none(value) for name, value in values.items()}
        return {"nodes": [len(self.nodes)], **known}

    @property
    def curve(self) -> tuple[Array, Array]:
        """Sliding speeds [m/s] and friction at the nodes."""
        return _sliding_speed(
            np.linspace(*self.limits, len(self.nodes)), self.sliding_scale
        ), self.nodes[:, 0]

    @cached_property
    def _cubics(self) -> Callable[[Array], Array]:
        from scipy.interpolate import CubicHermiteSpline

        x = np.linspace(*self.limits, len(self.nodes))
        cubics: Callable[[Array], Array] = CubicHermiteSpline(
            x, self.nodes[:, 0], self.nodes[:, 1] / (x[1] - x[0])
        )
        return cubics

    def friction(self, sliding: Array) -> Array:
        """Return the effective friction coefficient at sliding speeds [m/s]; it is constant beyond the table."""
        x = sliding / (np.abs(sliding) + self.sliding_scale)
        return self._cubics(np.clip(x, *self.limits))

    def raceway(self, rollers: int) -> object:
        """Return the compiled raceway of so many rollers."""
        return compiled.effective(rollers, self.nodes, self.limits, self.sliding_scale)


def effective_table(
    assembly: Assembly,
    raceway: Raceway,
    load: Array,
    tolerance: float,
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
        Largest error, relative to the largest friction.
    between_nodes : float
        Fraction, up to 1, of the tolerance between nodes which is aimed at.
    """
    rolling = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    # mirror images are equal to the bit
    distinct, times = np.unique(load[load > 0.0], return_counts=True)
    law, errors = _group_slices(
        raceway, distinct, times.astype(float), rolling, _CLASSES_FRACTION * tolerance
    )
    cells = _CELLS_FRACTION * tolerance
    table = curve_table(law, rolling, cells, between_nodes * cells)
    return attrs.evolve(
        table,
        error=table.error + errors[0],
        slope_error=table.slope_error + errors[1],
        critical_error=table.critical_error + errors[2],
    )


class _Recorded(Protocol):
    @property
    def record(self) -> Mapping[str, object]:
        """Size and errors by name."""


def table_records(tables: Sequence[_Recorded], name: str = "effective_tables") -> dict[str, str]:
    """Return the attribute of a result with the errors of its tables of inner and outer raceway, if it has any.

    Parameters
    ----------
    tables : sequence
        Tables with a ``record``, of inner and outer raceway.
    name : str
        Name of the attribute.
    """
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
        Error down to which nodes are added up to 4096 cells, by default the tolerance.
    """
    features = _find_features(friction, rolling)
    scale, limit, fraction = _choose_mapping(friction, features, rolling)

    def sample(x: Array) -> Array:
        return friction(_sliding_speed(x, scale))

    if aim is None:
        aim = tolerance
    cells = _min_cells(fraction)
    fine = sample(_symmetric_nodes(limit, 4 * cells))
    while True:
        values = fine[::4]
        slopes = _slopes(
            limit, values, scale * features.slope, fraction if features.has_critical else 0.0
        )
        error = _quarter_error(fine, slopes)
        is_aim_reached = error <= aim and _has_slope_of_law(limit, slopes, scale * features.slope)
        if is_aim_reached or (cells >= _MAX_CELLS and error <= tolerance):
            break
        if cells >= _LAST_CELLS:
            raise ConvergenceError(
                f"the table of effective friction still has a relative error of {error:.1e} with the most nodes, more "
                f"than the {tolerance:.1e} that are left to it; {COARSER_TABLES}"
            )
        finer = np.empty(8 * cells + 1)
        finer[::2] = fine
        finer[1::2] = sample(_symmetric_nodes(limit, 8 * cells)[1::2])
        cells = 2 * cells
        fine = finer
    nodes = np.stack((values, slopes), axis=-1)
    return _with_stated_errors(EffectiveTable(nodes, (-limit, limit), scale, error), features)


# Features of a law ----------------------------------------------------------------------------------------------------


@attrs.frozen
class _Features:
    """Slope at no slip and largest friction of a law."""

    half: float  # sliding speed at which friction has risen by half [m/s]
    slope: float  # at no slip [s/m]
    slope_error: float  # relative
    critical: Critical  # its slip is a sliding speed [m/s]

    @property
    def has_critical(self) -> bool:
        return not math.isnan(self.critical.slip)


def _find_features(friction: Law, rolling: float) -> _Features:
    """Features of a law at a rolling speed [m/s]."""
    probe = _probe_speeds(rolling)
    values = friction(probe)
    risen = np.abs(values)
    half = float(probe[np.argmax(risen >= 0.5 * risen.max())])
    end = int(np.searchsorted(probe, 0.5 * _MAX_SLIDING * rolling)) - 1
    # of maxima of nearly the same height, any may be the largest
    high = values[1:end] >= (1.0 - _EQUAL_MAXIMA) * values[: end + 1].max()
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
    inside = (maximum for maximum in maxima if not math.isnan(maximum.slip))
    none = Critical(math.nan, math.nan, "")
    critical = max(inside, key=lambda maximum: maximum.friction, default=none)
    return _Features(half, *_slope_at_zero(friction, _SLOPE_STEP * half), critical)


def _probe_speeds(rolling: float) -> Array:
    return rolling * np.geomspace(1e-7, _MAX_SLIDING, _PROBES)


def _slope_at_zero(friction: Law, step: float) -> tuple[float, float]:
    """Slope at no slip and its relative error, by Richardson extrapolation of four central differences.

    Their steps are ``step`` and halvings of it. Friction has terms in V |V|, so that the errors have all powers of V.
    """
    V = step * 0.5 ** np.arange(4)
    ahead, behind = np.split(friction(np.concatenate((V, -V))), 2)
    difference = (ahead - behind) / (2.0 * V)
    previous = math.nan
    for power in (2.0, 4.0, 8.0):
        previous = float(difference[-1])
        difference = (power * difference[1:] - difference[:-1]) / (power - 1.0)
    return float(difference[0]), _relative_difference(previous, float(difference[0]))


def _relative_difference(value: float, true: float) -> float:
    """Difference relative to the true value."""
    return abs(value - true) / (abs(true) or 1.0)


def _with_stated_errors(table: EffectiveTable, features: _Features) -> EffectiveTable:
    """Return a table with the critical speed of a law and the errors of its features."""
    middle = len(table.nodes) // 2
    limit = table.limits[1]
    slope = float(table.nodes[middle, 1]) * middle / (limit * table.sliding_scale)
    largest = int(np.argmax(table.nodes[middle:, 0]))
    speed = float(_sliding_speed(np.array(limit * largest / middle), table.sliding_scale))
    error = max(  # NaN without a critical speed
        _relative_difference(speed, features.critical.slip),
        _relative_difference(float(table.nodes[middle + largest, 0]), features.critical.friction),
    )
    return attrs.evolve(
        table,
        slope_error=features.slope_error + _relative_difference(slope, features.slope),
        critical_speed=features.critical.slip,
        critical_error=_LOCATION_ROUNDING + error,
    )


# The mapping ---------------------------------------------------------------------------------------------------------


def _choose_mapping(
    friction: Law, features: _Features, rolling: float
) -> tuple[float, float, float]:
    """V_s [m/s], the limit of V/(V + V_s), and the fraction of it at which a node is.

    The node is the critical speed, or where there is none the sliding speed at which friction has risen by half.
    """
    reach = _MAX_SLIDING * rolling
    node = features.critical.slip if features.has_critical else features.half
    fractions = [fraction for fraction in _NODE_FRACTIONS if fraction * reach > node]
    for cells in _TRIAL_CELLS:
        trials = list[tuple[float, float, float, float]]()
        for fraction in fractions:
            scale = node * reach * (1.0 - fraction) / (fraction * reach - node)
            limit = reach / (reach + scale)
            fine = friction(_sliding_speed(_symmetric_nodes(limit, 4 * cells), scale))
            slopes = _slopes(limit, fine[::4], scale * features.slope)
            trials.append((_quarter_error(fine, slopes), scale, limit, fraction))
        trials.sort(key=lambda trial: trial[0])
        if trials[0][0] <= _CLEAR_ERROR:
            break
        # what is among the worse half is not the best with more cells
        fractions = [fraction for *_, fraction in trials[: (len(trials) + 1) // 2]]
    return trials[0][1:]


def _min_cells(fraction: float) -> int:
    """Smallest number of cells of which a node is at a fraction of either half."""
    cells = _FIRST_CELLS
    while fraction * cells % 2.0:
        cells *= 2
    return cells


def _sliding_speed(x: Array, scale: float) -> Array:
    return np.asarray(scale * x / (1.0 - np.abs(x)))


def _symmetric_nodes(limit: float, cells: int) -> Array:
    """Equidistant nodes from -limit to limit, with 0 exactly among them."""
    half = np.linspace(0.0, limit, cells // 2 + 1)
    return np.concatenate((-half[:0:-1], half))


# The cubics ----------------------------------------------------------------------------------------------------------


def _slopes(limit: float, values: Array, rise: float, fraction: float = 0.0) -> Array:
    """Derivatives times the width of a cell at nodes, from splines in each half, limited.

    ``rise`` is the derivative in the middle, and ``fraction`` that of ``limit`` at which friction is largest;
    0 for none.
    """
    middle = values.size // 2
    step = limit / middle
    above = _spline(values[middle:], step * rise)
    below = _spline(values[middle::-1], -step * rise)
    slopes = np.concatenate((-below[:0:-1], above))
    if fraction:
        critical = round(fraction * middle)
        slopes[middle + critical] = 0.0
        if np.array_equal(values, -values[::-1]):
            slopes[middle - critical] = 0.0
    return np.clip(slopes, *_slope_bounds(values, slopes))


def _spline(values: Array, rise: float) -> Array:
    """Slopes, times the width of a cell, of the cubic spline through equidistant nodes, at least 4.

    ``rise`` is the slope at the first node. No knot separates the last two cells ("not-a-knot").
    """
    from scipy.interpolate import CubicSpline

    nodes = np.arange(values.size)
    return np.asarray(
        CubicSpline(nodes, values, bc_type=((1, np.array(rise)), "not-a-knot"))(nodes, 1)
    )


def _has_slope_of_law(limit: float, slopes: Array, rise: float) -> bool:
    """Whether the slope at no slip is that of the law, and not its limit, three times the neighbouring chord."""
    middle = slopes.size // 2
    return _relative_difference(float(slopes[middle]) * middle / limit, rise) <= _SLOPE_TOLERANCE


def _slope_bounds(values: Array, slopes: Array) -> tuple[Array, Array]:
    """Lower and upper bounds of slopes at nodes with which no cell has an extremum besides its nodes.

    A cubic is monotone if both its slopes have the sign of the chord and are at most three times as steep. A cell
    contains an extremum where the values turn at one of its nodes and the slope there points into it, or where it is
    flat between a rise and a fall. Its end slopes may have either sign, with which it has exactly one extremum.
    """
    rise = np.diff(values)
    sign = np.sign(rise)
    before = sign[:-1]
    after = sign[1:]
    turns = before * after < 0.0
    points = np.sign(slopes[1:-1])
    has_extremum = np.zeros(rise.shape, dtype=bool)
    has_extremum[1:] |= turns & (points == before)
    has_extremum[:-1] |= turns & (points == after)
    has_extremum[1:-1] |= (sign[1:-1] == 0.0) & (sign[:-2] * sign[2:] < 0.0)
    turning = np.zeros(values.shape, dtype=bool)
    turning[1:-1] = turns
    bounds = []
    for sense, outer, inner in ((-1.0, np.minimum, np.maximum), (1.0, np.maximum, np.minimum)):
        unlimited = sense * np.inf
        monotone = outer(3.0 * rise, 0.0)
        same_sign = np.where(sign * sense < 0.0, 0.0, unlimited)
        at = np.full((2, values.size), unlimited)
        # of each cell for the node before it and for the one after it
        for k, own in enumerate((slice(None, -1), slice(1, None))):
            is_free = turning[own] | (sign == 0.0)
            at[k, own] = np.where(has_extremum, np.where(is_free, unlimited, same_sign), monotone)
        bounds.append(inner.reduce(at, axis=0))
    return bounds[0], bounds[1]


def _interpolate_cells(values: Array, slopes: Array, x: float) -> Array:
    """Cubic Hermite interpolation at a fraction of every cell."""
    rise = np.diff(values)
    without_slopes = values[:-1] + x * x * (3.0 - 2.0 * x) * rise
    return np.asarray(without_slopes + x * (1.0 - x) * ((1.0 - x) * slopes[:-1] - x * slopes[1:]))


def _quarter_error(fine: Array, slopes: Array) -> float:
    """Largest relative error of cubics at the quarters of their cells; ``fine`` has these and the nodes."""
    return max(
        _relative_error(_interpolate_cells(fine[::4], slopes, q / 4) - fine[q::4], fine)
        for q in (1, 2, 3)
    )


def _relative_error(error: Array, values: Array) -> float:
    """Largest error relative to the largest value."""
    return float(np.abs(error).max() / (np.abs(values).max() or 1.0))


# The law -------------------------------------------------------------------------------------------------------------


def _group_slices(
    raceway: Raceway, load: Array, times: Array, rolling: float, tolerance: float
) -> tuple[Law, tuple[float, float, float]]:
    """Mean friction of slices at a rolling speed, by classes of equal force, and the errors of these.

    The slices have ascending loads, each so many ``times``. There are as few classes as the tolerance allows. The
    errors are those of friction, of the slope at no slip and of the maximum.
    """
    fraction = load * times / (load * times).sum()
    whole = _mean_friction(raceway, load, fraction, rolling)
    if load.size <= _FIRST_CLASSES:
        return whole, (0.0, 0.0, 0.0)
    true = whole(_probe_speeds(rolling))
    features = _find_features(whole, rolling)
    count = _FIRST_CLASSES
    while count < min(load.size, _MAX_CLASSES):
        number = np.minimum((count * (np.cumsum(fraction) - 0.5 * fraction)).astype(int), count - 1)
        force = np.asarray(np.bincount(number, fraction, count), dtype=float)
        mean = np.bincount(number, fraction * load, count)[force > 0.0] / force[force > 0.0]
        law = _mean_friction(raceway, mean, force[force > 0.0], rolling)
        error = _relative_error(law(_probe_speeds(rolling)) - true, true)
        reduced = _find_features(law, rolling)
        slope_error = _relative_difference(reduced.slope, features.slope)
        critical_error = _critical_error(reduced, features)
        if max(error, slope_error) <= tolerance and critical_error <= max(
            tolerance, _LOCATION_ROUNDING
        ):
            return law, (error, slope_error, critical_error)
        count *= 2
    return whole, (0.0, 0.0, 0.0)


def _critical_error(features: _Features, true: _Features) -> float:
    """Relative error of critical speed or friction, the larger one; infinite where only one law has a maximum."""
    if features.has_critical != true.has_critical:
        return math.inf
    if not true.has_critical:
        return 0.0
    return max(
        _relative_difference(features.critical.slip, true.critical.slip),
        _relative_difference(features.critical.friction, true.critical.friction),
    )


def _mean_friction(raceway: Raceway, load: Array, fraction: Array, rolling: float) -> Law:
    """Mean friction at a rolling speed of slices with loads per length and fractions of the force."""
    count = max(_BLOCK_SIZE // max(load.size, 1), 1)

    def friction(sliding: Array) -> Array:
        if load.size == 0:
            return np.zeros_like(sliding)
        blocks = []
        for start in range(0, sliding.size, count):
            V = sliding[start : start + count]
            slices = raceway.evaluate(np.tile(load, V.size), rolling, np.repeat(V, load.size))
            # not by BLAS, whose result depends on the number of threads
            blocks.append((slices.friction.reshape(V.size, -1) * fraction).sum(axis=1))
        return np.concatenate(blocks)

    return friction
