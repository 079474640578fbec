"""Effective friction of a raceway as a table: over the sliding speed, or over sliding and rolling speed.

- mu_e = sum(mu Q)/sum(Q) over the loaded slices of all positions of the orbit at the epicyclic speed (see
  ``effective_friction``), here as a function of what the contact itself knows: its sliding speed V and its rolling
  speed u. Cage slip and roller slip, in which the study states it, are these two for either raceway in other units.
- Over V alone the rolling speed is the epicyclic one. With the rollers near rolling on the outer ring, as most are,
  the rolling speed of neither contact moves by more than a tenth of the sliding speed.
- Friction rises over a small sliding speed V_s and is flat beyond: equal steps of V/(|V| + V_s), one division. Where it
  also depends on u the rise goes with the slide-roll ratio, V_s = S u.
- Friction of a slice depends on its load: thousands of loaded slices are gathered into classes of equal force, as many
  as the tolerance needs.
- A friction law has one second derivative for V < 0 and another for V > 0, so each half is a cubic spline of its own.
- Cells are halved until the friction half-way between nodes is right to the tolerance, relative to the largest at
  that rolling speed.
"""

from collections.abc import Callable
from typing import Final

import attrs
import numpy as np

from rollslip.assembly import Array, Assembly, Raceway
from rollslip.errors import ConvergenceError
from rollslip_kernels import raceway as compiled

#: Largest sliding speed, relative to the epicyclic rolling speed; beyond it friction is held.
_REACH: Final = 8.0
#: Rolling speeds of a map, relative to the epicyclic one; beyond them friction is held.
_ROLLING: Final = (0.1, 3.0)
_FIRST_CELLS, _MOST_CELLS = 16, 4096
_FIRST_ROWS, _MOST_ROWS = 8, 256
_FIRST_CLASSES, _MOST_CLASSES = 16, 1024


@attrs.frozen(eq=False)
class EffectiveTable:
    """A table as ``rollslip_kernels.raceway.effective`` takes it.

    Attributes
    ----------
    nodes : ndarray
        (N, 2) over the sliding speed, (M, N, 4) over rolling and sliding speed.
    limits : tuple of float
        V/(|V| + V_s) of the first and the last node.
    sliding_scale, sliding_ratio : float
        V_s = sliding_scale + sliding_ratio u [m/s].
    row_limits : tuple of float
        u/(u + u_s) of the first and the last row.
    rolling_scale : float
        u_s [m/s].
    error : float
        Largest error half-way between nodes, relative to the largest friction at that rolling speed.
    """

    nodes: Array
    limits: tuple[float, float]
    sliding_scale: float = 0.0
    sliding_ratio: float = 0.0
    row_limits: tuple[float, float] = (0.0, 1.0)
    rolling_scale: float = 1.0
    error: float = 0.0

    @property
    def curve(self) -> tuple[Array, Array] | None:
        """Sliding speeds [m/s] and friction at the nodes; None for a table over two speeds."""
        if self.nodes.ndim != 2:
            return None
        return _speed(np.linspace(*self.limits, self.nodes.shape[0]), self.sliding_scale), self.nodes[:, 0]

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


def effective_table(assembly: Assembly, raceway: Raceway, load: Array, tolerance: float, slips: bool) -> EffectiveTable:
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

    Raises
    ------
    ConvergenceError
        If the tolerance is not reached with the most nodes.
    DomainError
        If a law has no value at a speed of the table.
    """
    epicyclic = float(assembly.kinematics.surface_speeds(0.0, 0.0).inner_rolling)
    # the sliding speed at which friction has risen by half
    probe = epicyclic * np.geomspace(1e-7, 1.0, 57)
    classes = _classes(raceway, load[load > 0.0], epicyclic, probe, 0.1 * tolerance)

    def friction(rolling: float, sliding: Array) -> Array:
        return _mean_friction(raceway, classes, rolling, sliding)

    risen = np.abs(friction(epicyclic, probe))
    scale = float(probe[np.argmax(risen >= 0.5 * risen.max())])
    reach = _REACH * epicyclic
    limit = reach / (reach + scale)
    if not slips:
        nodes, error = _curve(lambda x: friction(epicyclic, _speed(x, scale)), limit, tolerance)
        return EffectiveTable(nodes, (-limit, limit), sliding_scale=scale, error=error)
    low, high = (share / (share + 1.0) for share in _ROLLING)

    def at(e: float, x: Array) -> Array:
        u = epicyclic * e / (1.0 - e)
        return friction(u, _speed(x, scale / epicyclic * u))

    nodes, error = _map(at, limit, (low, high), tolerance)
    return EffectiveTable(
        nodes,
        (-limit, limit),
        sliding_ratio=scale / epicyclic,
        row_limits=(low, high),
        rolling_scale=epicyclic,
        error=error,
    )


def _mean_friction(raceway: Raceway, load: Array, rolling: float, sliding: Array) -> Array:
    """Mean friction of slices with loads (c, 2) of load per length and share of the force, at sliding speeds (m,)."""
    if load.size == 0:
        return np.zeros_like(sliding)
    slices = raceway.evaluate(np.tile(load[:, 0], sliding.size), rolling, np.repeat(sliding, load.shape[0]))
    return np.asarray(slices.friction.reshape(sliding.size, -1) @ load[:, 1])


def _classes(raceway: Raceway, load: Array, rolling: float, sliding: Array, tolerance: float) -> Array:
    """Gather slices into as few classes of equal force as leave the friction at some speeds right, (c, 2)."""
    if load.size == 0:
        return np.empty((0, 2))
    load = np.sort(load)
    share = load / load.sum()
    true = _mean_friction(raceway, np.stack((load, share), axis=1), rolling, sliding)
    count = _FIRST_CLASSES
    while count < min(load.size, _MOST_CLASSES):
        number = np.minimum((count * (np.cumsum(share) - 0.5 * share)).astype(int), count - 1)
        whole = np.asarray(np.bincount(number, share, count), dtype=float)
        mean = np.bincount(number, share * load, count) / np.where(whole > 0.0, whole, 1.0)
        found: Array = np.stack((mean, whole), axis=1)[whole > 0.0]
        if _relative(_mean_friction(raceway, found, rolling, sliding) - true, true) <= tolerance:
            return found
        count *= 2
    return np.stack((load, share), axis=1)


def _speed(x: Array, scale: float) -> Array:
    return scale * x / (1.0 - np.abs(x))


def _halves(limit: float, cells: int) -> Array:
    """Nodes from -limit to limit, with 0 exactly among them."""
    half = np.linspace(0.0, limit, cells // 2 + 1)
    return np.concatenate((-half[:0:-1], half))


def _slopes(step: float, values: Array) -> Array:
    """Derivatives times the step along the last axis, each half a spline of its own and the middle their mean."""
    from scipy.interpolate import CubicSpline

    middle = values.shape[-1] // 2
    half = step * np.arange(middle + 1)
    below, above = (
        CubicSpline(half, part, axis=-1)(half, 1) for part in (values[..., : middle + 1], values[..., middle:])
    )
    joint = 0.5 * (below[..., -1:] + above[..., :1])
    return np.asarray(step * np.concatenate((below[..., :-1], joint, above[..., 1:]), axis=-1))


def _between(values: Array, slopes: Array) -> Array:
    """Hermite's cubic half-way between the nodes of the last axis."""
    ends = 0.5 * (values[..., 1:] + values[..., :-1])
    return np.asarray(ends + 0.125 * (slopes[..., :-1] - slopes[..., 1:]))


def _curve(friction: Callable[[Array], Array], limit: float, tolerance: float) -> tuple[Array, float]:
    cells, values = _FIRST_CELLS, friction(_halves(limit, _FIRST_CELLS))
    while cells <= _MOST_CELLS:
        at = _halves(limit, 2 * cells)
        slopes = _slopes(2.0 * limit / cells, values)
        true = friction(at[1::2])
        error = _relative(_between(values, slopes) - true, values)
        if error <= tolerance:
            return np.stack((values, slopes), axis=-1), error
        both = np.empty(2 * cells + 1)
        both[::2], both[1::2] = values, true
        cells, values = 2 * cells, both
    raise _too_coarse(error, tolerance)


def _map(
    friction: Callable[[float, Array], Array], limit: float, rows: tuple[float, float], tolerance: float
) -> tuple[Array, float]:
    from scipy.interpolate import CubicSpline

    cells, count = 2 * _FIRST_CELLS, _FIRST_ROWS
    while cells <= _MOST_CELLS and count <= _MOST_ROWS:
        x, e = _halves(limit, 2 * cells), np.linspace(*rows, 2 * count + 1)
        true = np.array([friction(float(row), x) for row in e])
        values, step = true[::2, ::2], (rows[1] - rows[0]) / count
        slopes = _slopes(2.0 * limit / cells, values)
        rising, twisting = (step * CubicSpline(e[::2], part, axis=0)(e[::2], 1) for part in (values, slopes))
        along = _relative(_between(values, slopes) - true[::2, 1::2], true[::2])
        across = _relative(_between(values.T, rising.T).T - true[1::2, ::2], true[1::2])
        if max(along, across) <= 0.5 * tolerance:
            return np.stack((values, slopes, rising, twisting), axis=-1), along + across
        cells *= 2 if along > 0.5 * tolerance else 1
        count *= 2 if across > 0.5 * tolerance else 1
    raise _too_coarse(max(along, across), tolerance)


def _relative(off: Array, values: Array) -> float:
    """Largest error relative to the largest value of its row."""
    largest = np.abs(values).max(axis=-1)
    return float((np.abs(off).max(axis=-1) / np.where(largest > 0.0, largest, 1.0)).max())


def _too_coarse(error: float, tolerance: float) -> ConvergenceError:
    return ConvergenceError(
        f"the table of effective friction still has a relative error of {error:.1e} with the most nodes; raise "
        f"accuracy.tolerance, which is {tolerance:g}"
    )
