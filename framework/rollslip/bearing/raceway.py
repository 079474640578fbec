"""Evaluate the loaded contacts of one raceway: a table of slices, evaluated again and again at changing speeds.

- Rollers, and halves of rollers, that carry the same load are evaluated once and count for all of their images.
- A mean over the slices is weighted by force: the friction coefficient of a raceway is the sum of the friction forces
  over the sum of the normal forces.
- At one rolling and one sliding speed the friction of a slice depends on its load alone, so that the mean is an
  integral over a discrete measure, the force at each load. Its Gauss rule of m loads is exact for every polynomial of
  degree 2 m - 1 and converges fast for a smooth friction law: 16 loads serve for some thousand slices. The abscissa of
  the rule is the square root of the load, to which half width and pressure are proportional.
- The rule is compared with all slices at some speeds, and its loads are doubled until both agree
  (`load_rule`). A law with a kink, such as film model ``regime``, needs many loads.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.chain import Chain, Guarded, Job, along
from rollslip.search import Array as Array  # other modules take it from here
from rollslip_kernels.chain import Bound
from rollslip_kernels.gauss import rules
from rollslip_kernels.slices import PLACES, Conditions, Slices

Ring = Literal["inner", "outer"]
RINGS: tuple[Ring, Ring] = ("inner", "outer")

#: Number of speeds at which a Gauss rule is compared with all slices, evenly over those requested. Halving it may miss
#: a speed at which the law has a kink; doubling it doubles the time of the check. Chosen.
PROBES = 12
#: Largest number of slices that are evaluated as one table. Doubling it doubles the memory, some 4 MB, and saves
#: hardly any calls. Chosen; no result depends on it.
_MAX_TABLE = 32768
#: Slices in the working table of the search for spins, unless a single roller has more: so many stay in the
#: second-level cache. Doubling it changes only the speed. Chosen.
_BLOCK = 2048
#: Slices that the widest vector instructions (AVX-512) take at once: tables are longer by so many, because the last
#: vector of a roller may reach beyond its slices.
_VECTOR_LANES = 8
#: Nodes of the first rule that is tried. Halving it costs one more comparison, doubling it nodes that a smooth law does
#: not need. Chosen: smooth laws of friction need 16.
_MIN_LOADS = 8
#: Largest number of nodes that is tried before all slices are taken. Doubling it helps only laws with kinks, with 256
#: nodes of some thousand slices. Chosen.
_MAX_LOADS = 128
#: Fraction of the force below which a node is dropped: loads that differ by rounding alone give nodes without weight.
#: Doubling it changes nothing; it stands between the rounding of an eigenvector (1e-16) and the tolerance of tables.
_MIN_FRACTION = 1e-13


@attrs.frozen(eq=False)
class Raceway:
    """One raceway: what all of its contacts share, and the laws of their deflection and friction."""

    ring: Ring
    conditions: Conditions
    #: Laws of contact, film and traction: load and speeds -> friction.
    chain: Chain
    #: Law of deflection: approach -> load and stiffness. The approach is measured from `gap`.
    deflection: Chain
    #: Gap of the bodies at which a contact begins to carry, because of its film [m].
    gap: float = 0.0

    def evaluate(
        self, load: Array, rolling_speed: Any, sliding_speed: Any, **places: Any
    ) -> Slices:
        """Return the evaluated slices for loads per length [N/m] and speeds [m/s] that broadcast to them.

        ``places`` are columns with the positions of the slices, which some laws read (`Chain.placed`).
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
    """The loaded slices of one raceway as one table, which is evaluated at changing speeds.

    Parameters
    ----------
    raceway : Raceway
        The raceway and its laws.
    load : ndarray
        Load per length [N/m], (rollers, n).
    widths : ndarray
        Widths of the slices [m], (n,) or (rollers, n).
    orbit : float
        Direction of the orbit, 1 or -1: the sign of the friction along it.
    count : ndarray, optional
        Number of equal rollers that each one stands for, (rollers,); by default one.
    places : mapping of str to ndarray
        ``position`` along the roller [m], (n,), and the other columns of `PLACES` by roller, (rollers,); only where a
        law reads them.
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
        # where both halves of a roller carry the same, one of them is evaluated
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
            name: column_of[column if name == "position" else self.owner]
            for name, column_of in places.items()
        }

    @cached_property
    def slices(self) -> Slices:
        """The table, allocated at the first use."""
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
        _ = self._first, self.carried  # cached properties that both share
        other = LoadedContacts.__new__(LoadedContacts)
        vars(other).update(vars(self), raceway=raceway)
        for cached in ("slices", "_evaluate"):
            vars(other).pop(cached, None)
        return other

    def reduced(self, count: int, *, whole: bool = False) -> "LoadedContacts":
        """Return contacts of at most `count` loads per roller: the Gauss rule of its slices, weighted by their widths.

        The force of a roller is the same, and so are means of what is smooth in the square root of the load. ``whole``
        replaces the slices of all rollers by one rule, for rollers that run at the same speeds.
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
        """Arguments of `rollslip.bearing.chain.along` for speeds [m/s], (n,) of all rollers or (n, rollers) of each."""
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
        """Stage of the chain, a working table, and the arguments of `rollslip_kernels.motion.spin` for a ring.

        The kernel does not check bounds of what was left out; the caller checks them on the result. ``known`` are stage
        and table of other contacts of the raceway that are not used any more; a table that is too small is replaced.
        """
        raceway = self.raceway
        stage, table = known or (raceway.chain.kernel.as_stage(), None)
        # room for two marches through a position at once, in parts where that exceeds a block
        size = (
            min(2 * self.force.size, max(_BLOCK, int(np.diff(self._first).max(initial=0))))
            + _VECTOR_LANES
        )
        if table is None or len(table) < size:
            table = Slices(size, raceway.conditions)
        ring = stage, table, self.load, self.force, self.width, self._first, raceway.chain.resists
        if not raceway.chain.placed:
            return stage, table, ring
        table.places()
        unknown = np.full(self.load.size, np.nan)
        return stage, table, (*ring, np.array([self.places.get(name, unknown) for name in PLACES]))

    def mean(self, pull: Array) -> Array:
        """Mean friction coefficient along the orbit, from friction forces [N]; NaN if there is no load."""
        return self.orbit * pull / self.total if self.total > 0.0 else np.full_like(pull, np.nan)

    def per_roller(self, values: Array) -> Array:
        """Sum of values of slices for every roller, (rollers,)."""
        return np.asarray(
            np.bincount(self.owner, weights=values, minlength=self.rollers), dtype=float
        )

    def means(self, rolling: Array, sliding: Array, tolerance: float) -> Array:
        """Mean friction at many speeds [m/s], (n,), by a Gauss rule with an error below the tolerance."""

        def mean_at(chosen: Any) -> Callable[[Array], Array]:
            u = rolling[chosen]
            V = sliding[chosen]

            def mean(rule: Array) -> Array:
                load, fraction = rule.T
                rows = []
                step = max(1, _MAX_TABLE // load.size)
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
        rule = load_rule(self.load, self.force, mean_at(probes), tolerance)
        return mean_at(slice(None))(rule)


def mean_friction(rings: Sequence[tuple[LoadedContacts, Array, Array]]) -> list[Array]:
    """Return the mean friction of several contacts at rolling and sliding speeds [m/s], (n,) each, in one call."""
    pulls = along([contacts.job(u, V) for contacts, u, V in rings])
    return [contacts.mean(pull) for (contacts, *_), (pull, _) in zip(rings, pulls, strict=True)]


def gauss_rule(load: Array, force: Array, count: int) -> Array:
    """Return the Gauss rule of a force distributed over loads.

    With weights q_k at x_k = sqrt(w_k), Lanczos' recurrence gives the Jacobi matrix of the polynomials that are
    orthogonal over them; its eigenvalues are the nodes x, and the squares of the first components of its eigenvectors
    are their fractions of the weight (`rollslip_kernels.gauss.rules`).

    Parameters
    ----------
    load : ndarray
        Load per length of each slice [N/m], (n,).
    force : ndarray
        Force of each slice [N], (n,): the weights.
    count : int
        Number of nodes m.

    Returns
    -------
    ndarray
        Load per length [N/m] and fraction of the force [1] of each node that has one, (at most m, 2).

    References
    ----------
    G. H. Golub, J. H. Welsch, Calculation of Gauss quadrature rules, Math. Comp. 23 (1969) 221-230.
    """
    nodes, weights = rules(load, force, np.array([0, load.size]), count)
    fraction = weights[0] / force.sum()
    significant = fraction > _MIN_FRACTION
    return np.asarray(np.stack((nodes[0], fraction), axis=1)[significant])


def load_rule(load: Array, force: Array, mean: Callable[[Array], Array], tolerance: float) -> Array:
    """Return the smallest Gauss rule tried whose means by force agree with those over all slices.

    Parameters
    ----------
    load : ndarray
        Load per length of each slice [N/m], (n,).
    force : ndarray
        Force of each slice [N], (n,).
    mean : callable
        Returns the means of friction of a rule, (m, 2), at all probe speeds, (k,).
    tolerance : float
        Allowed difference, relative to the largest mean over all slices [1].

    Returns
    -------
    ndarray
        Load per length [N/m] and fraction of the force [1] of each node, (m, 2); of all slices if no rule agrees.
    """
    whole = np.stack((load, force / force.sum()), axis=1)
    different = np.unique(load).size
    if different > _MIN_LOADS:
        reference = mean(whole)
        scale = float(np.abs(reference).max())
    count = _MIN_LOADS
    while count < min(different, _MAX_LOADS + 1):
        rule = gauss_rule(load, force, count)
        if np.abs(mean(rule) - reference).max() <= tolerance * scale:
            return rule
        count *= 2
    return whole
