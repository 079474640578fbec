"""Contacts of one raceway under load, one table of slices that is evaluated again and again.

- Rollers and halves of rollers that carry the same are evaluated once and count for all of their images.
- A mean over the slices is by force: friction of the whole is the sum of the pulls over the sum of the forces.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from rollslip.bearing.assembly import Array, Raceway
from rollslip.bearing.chain import Job
from rollslip.bearing.load_rule import load_rule
from rollslip.bearing.regimes import LIGHT, groups, regime_limits
from rollslip_kernels.slices import Slices

#: At how many speeds few loads are held against all.
PROBES = 12
_TABLE = 32768  # slices in a table at a time


class LoadedContacts:
    """The loaded slices of one raceway, one table that is evaluated again and again.

    Parameters
    ----------
    raceway : Raceway
        The raceway.
    load : ndarray
        Loads per length [N/m] of rollers, (rollers, n).
    widths : ndarray
        Widths of the slices [m], (n,).
    orbit : float
        Direction of the rollers' orbit, 1 or -1.
    count : ndarray, optional
        How many rollers each one stands for, (rollers,); by default one.
    """

    def __init__(self, raceway: Raceway, load: Array, widths: Array, orbit: float, count: Array | None = None) -> None:
        slices = load.shape[1]
        if np.array_equal(load, load[:, ::-1]):  # one half of a roller carries what the other does
            load, widths = load[:, slices // 2 :], 2.0 * widths[slices // 2 :]
            widths[0] /= 1.0 + slices % 2
        loaded = load > 0.0
        self.orbit = orbit
        self.raceway = raceway
        self.rollers = load.shape[0]
        #: number of the roller that each slice belongs to
        self.owner, column = map(np.ascontiguousarray, np.nonzero(loaded))
        #: width [m] of all that each slice stands for
        self.width = widths[column] if count is None else widths[column] * count[self.owner]
        self.force = load[loaded] * self.width
        self.total = float(self.force.sum())
        self.slices = Slices(self.force.size, raceway.conditions, load=load[loaded])
        self._evaluate = raceway.chain.bind(self.slices)

    def friction(self, rolling: Any, sliding: Any) -> Array:
        """Friction coefficient of every slice along the orbit, (N,), at speeds that broadcast to it."""
        self.slices.rolling_speed[:] = rolling
        self.slices.sliding_speed[:] = sliding
        self._evaluate()
        return self.orbit * self.slices.friction

    def job(self, rolling: Array, sliding: Array) -> Job:
        """What `rollslip.bearing.chain.along` takes, for speeds [m/s] (n,) of all rollers, or (n, rollers) of each."""
        u, V = (np.ascontiguousarray(speed.reshape(len(speed), -1)) for speed in (rolling, sliding))
        return self._evaluate, u, V, self.owner, self.force

    def mean(self, pull: Array) -> Array:
        """Mean friction by force along the orbit, of its sums by force [N]; NaN if there is no load."""
        return self.orbit * pull / self.total if self.total > 0.0 else np.full_like(pull, np.nan)

    def per_roller(self, values: Array) -> Array:
        """Sum of values of slices for every roller, (rollers,)."""
        return np.asarray(np.bincount(self.owner, weights=values, minlength=self.rollers), dtype=float)

    def means(self, rolling: Array, sliding: Array, tolerance: float) -> Array:
        """Mean friction at many speeds [m/s], (n,), over as few loads as leave an error below the tolerance."""

        def over(chosen: Any) -> Callable[[Array], Array]:
            u, V = rolling[chosen], sliding[chosen]

            def mean(rule: Array) -> Array:
                load, share = rule.T
                rows, step = [], max(1, _TABLE // load.size)
                for k in range(0, u.size, step):
                    speeds = u[k : k + step], V[k : k + step]
                    slices = self.raceway.evaluate(
                        np.tile(load, speeds[0].size), *(np.repeat(speed, load.size) for speed in speeds)
                    )
                    rows.append(slices.friction.reshape(speeds[0].size, -1) @ share)
                    del slices  # before the next table is made
                return self.orbit * np.concatenate(rows)

            return mean

        if self.total == 0.0:
            return np.full_like(rolling, np.nan)
        probes = np.linspace(0, rolling.size - 1, PROBES).astype(int)
        rule = load_rule(self.slices.load, self.force, over(probes), tolerance)
        return over(slice(None))(rule)

    def regimes(self, rolling: Array) -> tuple[Array, float, float]:
        """Shares of the force by film regime, (4,), and at M < LIGHT, means over rolling speeds, and the largest M.

        The speeds [m/s] are of shape (n,) for all rollers, or (n, rollers).
        """
        share, light, largest = np.zeros(4), 0.0, 0.0
        alike = [(np.ones(self.owner.size, dtype=bool), rolling)]
        for chosen, speed in alike if rolling.ndim == 1 else [(self.owner == k, u) for k, u in enumerate(rolling.T)]:
            order = np.argsort(self.slices.load[chosen])
            if order.size == 0:
                continue
            load = self.slices.load[chosen][order]
            below = np.concatenate(([0.0], np.cumsum(self.force[chosen][order]))) / (self.total * speed.size)
            U, G, W = groups(Slices.of_columns(self.slices.conditions, {"rolling_speed": speed, "load": load}))
            elastic, piezoviscous, both = (below[np.searchsorted(W, at, side="right")] for at in regime_limits(U, G))
            rigid, mixed = np.minimum(elastic, piezoviscous), np.maximum(both, piezoviscous)
            share += [part.sum() for part in (rigid, mixed - piezoviscous, piezoviscous - rigid, below[-1] - mixed)]
            light += float(below[np.searchsorted(W, LIGHT * np.sqrt(2.0 * U))].sum())
            largest = max(largest, float(W[-1] / np.sqrt(2.0 * U.min())))
        return share, light, largest
