"""One raceway: the laws of its contacts, and those of them that are loaded as one table that is evaluated again.

- Rollers and halves of rollers that carry the same are evaluated once and count for all of their images.
- A mean over the slices is by force: friction of the whole is the sum of the pulls over the sum of the forces.
- At one rolling and one sliding speed the friction of a slice depends on its load alone, so that mean is an integral
  over a discrete measure, the force at each load. Its Gauss rule of m loads is exact for every polynomial of degree
  2 m - 1 and converges like one to a smooth friction law: 16 loads serve for some thousand slices. The rule is taken in
  the root of the load: half width and pressure go with it.
- Nothing is believed: the rule is held against all slices at some speeds, and its loads are doubled until it agrees.
  A law with a kink, such as film model ``regime``, needs many, or all the slices.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.chain import Chain, Guarded, Job, along
from rollslip.bearing.quadrature import load_rule
from rollslip_kernels.chain import Bound
from rollslip_kernels.gauss import rules
from rollslip_kernels.slices import PLACES, Conditions, Slices

Array = NDArray[np.float64]
Ring = Literal["inner", "outer"]
RINGS: tuple[Ring, Ring] = ("inner", "outer")

#: At how many speeds few loads are held against all.
PROBES = 12
# slices in a table at a time, where rows go round, and of the widest vectors
_TABLE = 32768
_ROOM = 2048
_LANES = 8


@attrs.frozen(eq=False)
class Raceway:
    """One raceway: what all of its contacts share, and the bound laws they follow."""

    ring: Ring
    conditions: Conditions
    chain: Chain
    deflection: Chain

    def evaluate(
        self, load: Array, rolling_speed: Any, sliding_speed: Any, **places: Any
    ) -> Slices:
        """Return the evaluated slices for loads per length [N/m] and speeds [m/s] that broadcast to them.

        ``places`` are columns that say where they are, as a law may ask (`Chain.placed`).
        """
        slices = Slices(
            load.size,
            self.conditions,
            load=load,
            rolling_speed=rolling_speed,
            sliding_speed=sliding_speed,
            **places,
        )
        self.chain(slices)
        return slices


class LoadedContacts:
    """The loaded slices of one raceway, one table that is evaluated again and again.

    Loads per length [N/m] of rollers are of shape (rollers, n), widths of the slices [m] of (n,), or of (rollers, n).
    The direction of the ``orbit`` is 1 or -1; each roller stands for a ``count`` of them, by default one. If a law
    asks, ``places`` are ``position`` (n,), and of each roller what else `PLACES` has, (rollers,).
    """

    def __init__(
        self,
        raceway: Raceway,
        load: Array,
        widths: Array,
        orbit: float,
        count: Array | None = None,
        places: Mapping[str, Array] = MappingProxyType({}),
    ) -> None:
        slices = load.shape[1]
        first = 0
        # one half of a roller carries what the other does
        if not places and widths.ndim == 1 and np.array_equal(load, load[:, ::-1]):
            first = slices // 2
            load = load[:, first:]
            widths = 2.0 * widths[first:]
            widths[0] /= 1.0 + slices % 2
        loaded = load > 0.0
        self.orbit = orbit
        self.raceway = raceway
        self.rollers = load.shape[0]
        #: number of the roller that each slice belongs to
        self.owner, column = map(np.ascontiguousarray, np.nonzero(loaded))
        #: number of each slice along its roller
        self.column = column + first
        #: width [m] of all that each slice stands for
        own = widths[column] if widths.ndim == 1 else widths[loaded]
        self.width = own if count is None else own * count[self.owner]
        self.force = load[loaded] * self.width
        self.total = float(self.force.sum())
        self.load = load[loaded]
        self.places = {
            name: of[column if name == "position" else self.owner] for name, of in places.items()
        }

    @cached_property
    def slices(self) -> Slices:
        """The table, made when it is first asked for."""
        return Slices(self.force.size, self.raceway.conditions, load=self.load, **self.places)

    @cached_property
    def _evaluate(self) -> "Bound | Guarded":
        return self.raceway.chain.bind(self.slices)

    @cached_property
    def carried(self) -> Array:
        """Force of every roller [N], (rollers,)."""
        return self.per_roller(self.force)

    @cached_property
    def _first(self) -> "NDArray[np.intp]":
        """First slice of every roller, and where the last one ends."""
        return np.searchsorted(self.owner, np.arange(self.rollers + 1))

    def on(self, raceway: Raceway) -> "LoadedContacts":
        """Return the same loads on a raceway of other laws or conditions."""
        _ = self._first, self.carried  # found once for all
        other = LoadedContacts.__new__(LoadedContacts)
        vars(other).update(vars(self), raceway=raceway)
        for made in ("slices", "_evaluate"):
            vars(other).pop(made, None)
        return other

    def fewer(self, count: int, *, whole: bool = False) -> "LoadedContacts":
        """Return contacts of at most so many loads for each roller, to be put `on` a raceway.

        They are the Gauss rule of its slices by their widths: means over a roller of whatever is smooth in the root of
        the load are the same, and its force is. ``whole`` takes all rollers for one, where they run at the same speeds.
        """
        first = self._first[[0, -1]] if whole else self._first
        if self.places or int(np.diff(first).max(initial=0)) <= count:
            return self
        nodes, weights = rules(self.load, self.width, np.ascontiguousarray(first), count)
        return LoadedContacts(self.raceway, nodes, weights, self.orbit)

    def friction(self, rolling: Any, sliding: Any) -> Array:
        """Friction coefficient of every slice along the orbit, (N,), at speeds that broadcast to it."""
        self.slices.rolling_speed[:] = rolling
        self.slices.sliding_speed[:] = sliding
        self._evaluate()
        return self.orbit * self.slices.friction

    def job(self, rolling: Array, sliding: Array) -> Job:
        """What `rollslip.bearing.chain.along` takes, for speeds [m/s] (n,) of all rollers, or (n, rollers) of each."""
        if rolling.ndim == 1:
            return self._evaluate, rolling[:, None], sliding[:, None], self.owner, self.force
        return (
            self._evaluate,
            np.ascontiguousarray(rolling),
            np.ascontiguousarray(sliding),
            self.owner,
            self.force,
        )

    def gathered(
        self, known: tuple[object, Slices] | None = None
    ) -> tuple[object, Slices, tuple[Any, ...]]:
        """Stage of the chain, a table to work in, and what `rollslip_kernels.motion.spin` takes of a ring.

        No bound is looked at there: that is for who evaluates what it finds. Stage and table may be those ``known`` of
        other contacts of the raceway, if these are not used any more; a table that is too small is made anew.
        """
        raceway = self.raceway
        stage, table = known or (raceway.chain.kernel.as_stage(), None)
        # two may be sent at once through a position; what has no room in a table that a cache holds goes in parts
        most = (
            min(2 * self.force.size, max(_ROOM, int(np.diff(self._first).max(initial=0)))) + _LANES
        )
        if table is None or len(table) < most:
            table = Slices(most, raceway.conditions)
        ring = stage, table, self.load, self.force, self.width, self._first, raceway.chain.resists
        if not raceway.chain.placed:
            return stage, table, ring
        table.places()
        unknown = np.full(self.load.size, np.nan)
        return stage, table, (*ring, np.array([self.places.get(name, unknown) for name in PLACES]))

    def mean(self, pull: Array) -> Array:
        """Mean friction by force along the orbit, of its sums by force [N]; NaN if there is no load."""
        return self.orbit * pull / self.total if self.total > 0.0 else np.full_like(pull, np.nan)

    def per_roller(self, values: Array) -> Array:
        """Sum of values of slices for every roller, (rollers,)."""
        return np.asarray(
            np.bincount(self.owner, weights=values, minlength=self.rollers), dtype=float
        )

    def means(self, rolling: Array, sliding: Array, tolerance: float) -> Array:
        """Mean friction at many speeds [m/s], (n,), over as few loads as leave an error below the tolerance."""

        def over(chosen: Any) -> Callable[[Array], Array]:
            u = rolling[chosen]
            V = sliding[chosen]

            def mean(rule: Array) -> Array:
                load, fraction = rule.T
                rows = []
                step = max(1, _TABLE // load.size)
                for k in range(0, u.size, step):
                    speeds = u[k : k + step], V[k : k + step]
                    slices = self.raceway.evaluate(
                        np.tile(load, speeds[0].size),
                        *(np.repeat(speed, load.size) for speed in speeds),
                    )
                    rows.append(slices.friction.reshape(speeds[0].size, -1) @ fraction)
                    del slices  # before the next table is made
                return self.orbit * np.concatenate(rows)

            return mean

        if self.total == 0.0:
            return np.full_like(rolling, np.nan)
        if self.places:
            return self.mean(along([self.job(rolling, sliding)])[0][0])
        probes = np.linspace(0, rolling.size - 1, PROBES).astype(int)
        rule = load_rule(self.load, self.force, over(probes), tolerance)
        return over(slice(None))(rule)


def mean_friction(rings: Sequence[tuple[LoadedContacts, Array, Array]]) -> list[Array]:
    """Return the mean friction of contacts at rolling and sliding speeds, (n,) each, evaluated in one go."""
    pulls = along([contacts.job(u, V) for contacts, u, V in rings])
    return [contacts.mean(pull) for (contacts, *_), (pull, _) in zip(rings, pulls, strict=True)]
