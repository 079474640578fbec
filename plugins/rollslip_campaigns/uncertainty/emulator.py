"""Emulate steady slip and drag reserve of samples from the torques of their rollers at a few cage slips.

As functions of the uncertain data, slip and reserve have kinks: where the cage is driven, skids or passes a limit
point. A smooth function of the data misses them where users look. The torque T(S) of the rollers has no such kinks, and
its shape differs little among samples. Method: empirical interpolation (gappy proper orthogonal decomposition).

1. Compute some samples as a whole. Write their loading branches as ln(T - T_0) over logit(S), with T_0 the torque
   without slip, and find the K largest principal components.
2. Choose K slips at which the components are best known: QR with column pivoting (Drmac and Gugercin, SIAM J. Sci.
   Comput. 38, 2016, A631).
3. Of every other sample compute the torques at these slips alone. They give its components, and these its branch.
4. The balance of the branch and the drags gives slip and reserve, with all kinks.
5. Estimate the error by leaving out one computed sample at a time. Take the smallest K whose error is small enough.
"""

import math
from collections.abc import Callable
from typing import Final

import attrs
import numpy as np

from rollslip.results.verdict import SKIDDING_SLIP
from rollslip.search import Array
from rollslip_campaigns.uncertainty.estimators import Estimate
from rollslip_studies.motion.loading_branch import SEARCH

__all__ = ["Basis", "Scale", "balance", "choose_basis", "scales"]

#: Numbers of slips at which the torques of a sample are computed, besides zero. Chosen: of NU 2216 and `turbine` three
#: leave errors of up to 0.3 standard deviations, eight up to 0.05.
_COUNTS: Final = range(4, 9)
#: Error of slip and reserve, relative to their standard deviation, at which no more slips are taken. Chosen: a median
#: of 1024 samples has a standard error of 0.04.
_SMALL_ERROR: Final = 0.03
#: Error up to which the result is accepted with the largest number of slips. Chosen: a 5 % quantile of 1024 samples has
#: a standard error of 0.07.
_MAX_ERROR: Final = 0.1
#: Smallest slip of the grid above zero. Chosen: below it the torque is proportional to the slip, and the logarithm of
#: its small excess shows the tolerance of the search.
_MIN_SLIP: Final = 0.0015
#: Smallest excess of the torque over that without slip, relative to the largest one, of which the logarithm is taken:
#: rounding may leave less than zero. Half and twice the value change smaller excesses alone.
_MIN_EXCESS: Final = 1e-9
#: Standard deviation of samples below which it counts as this: errors of equal samples are relative to it. Chosen: 5 %
#: of a reserve, and of a small slip.
_MIN_DEVIATION: Final = 0.05
#: Range of reserves in which differences count. Chosen: below it the cage skids anyhow, above it hardly anything drags.
_RESERVES: Final = (0.3, 50.0)
#: Range of slips in which differences count. Chosen: below it the cage hardly slips, above it it stands nearly still.
_SLIPS: Final = (3e-4, 0.95)


@attrs.frozen(eq=False, kw_only=True)
class Scale:
    """A scale of a quantity in which errors are about equal, and its inverse."""

    forward: Callable[[Array], Array]
    inverse: Callable[[float], float]

    def widen(self, estimate: Estimate, error: float) -> Estimate:
        """Return a quantile with an interval that includes a further, independent error.

        Half widths of the intervals are added as squares, with twice the further error.

        Parameters
        ----------
        estimate : Estimate
            The quantile with its interval.
        error : float
            Standard error in this scale.
        """
        bounds = np.array(attrs.astuple(estimate))
        value, low, high = self.forward(bounds).tolist()
        if math.isfinite(estimate.low):
            bounds[1] = self.inverse(value - math.hypot(value - low, 2.0 * error))
        if math.isfinite(estimate.high):
            bounds[2] = self.inverse(value + math.hypot(high - value, 2.0 * error))
        return Estimate(estimate.value, min(bounds[1], estimate.low), max(bounds[2], estimate.high))


def _logit(slip: Array) -> Array:
    return np.asarray(np.log(slip / (1.0 - slip)))


def scales() -> tuple[Scale, Scale]:
    """Return the scales of slip, its logit, and reserve, its logarithm."""
    return (
        Scale(
            forward=lambda slips: _logit(np.clip(slips, *_SLIPS)),
            inverse=lambda x: 1.0 / (1.0 + math.exp(-x)),
        ),
        Scale(forward=lambda reserves: np.log(np.clip(reserves, *_RESERVES)), inverse=math.exp),
    )


@attrs.frozen(eq=False, kw_only=True)
class Basis:
    """Principal components of loading branches, and the slips at which the torques of a sample give them.

    Attributes
    ----------
    slips : ndarray of float, (P,)
        Cage slips of the branches, ascending from zero.
    unit : float
        Torque to which excesses are relative [N m].
    mean : ndarray of float, (P - 1,)
        Mean logarithm of the excess torque at the slips above zero.
    components : ndarray of float, (K, P - 1)
        Principal components.
    chosen : ndarray of int, (K,)
        Indices of the chosen slips among those above zero, ascending.
    errors : tuple of float
        Standard errors of slip and reserve of a sample, in their scales.
    relative_error : float
        The larger one of both, relative to the standard deviation of the samples.
    """

    slips: Array
    unit: float
    mean: Array
    components: Array
    chosen: Array
    errors: tuple[float, float] = (math.nan, math.nan)
    relative_error: float = math.nan

    @classmethod
    def of_branches(cls, slips: Array, torques: Array, count: int) -> "Basis":
        """Return the basis of branches with a number of components.

        Parameters
        ----------
        slips : ndarray of float, (P,)
            Cage slips, ascending from zero.
        torques : ndarray of float, (n, P)
            Torques of the rollers on the cage [N m].
        count : int
            Number of components K, and of slips besides zero.
        """
        from scipy.linalg import qr

        excess = torques[:, 1:] - torques[:, :1]
        unit = float(excess.max())
        rows = np.log(np.maximum(excess / unit, _MIN_EXCESS))
        mean = rows.mean(axis=0)
        components = np.linalg.svd(rows - mean, full_matrices=False)[2][:count]
        chosen = np.sort(qr(components, mode="r", pivoting=True)[1][:count])
        return cls(slips=slips, unit=unit, mean=mean, components=components, chosen=chosen)

    @property
    def torque_slips(self) -> Array:
        """Slips at which the torques of a sample are computed: zero and the chosen ones, (K + 1,)."""
        return np.asarray(self.slips[np.append(0, 1 + self.chosen)])

    def branches(self, torques: Array) -> Array:
        """Return the loading branches of samples, (N, P), from their torques at `torque_slips` [N m].

        Parameters
        ----------
        torques : ndarray of float, (N, K + 1)
            Torques of the rollers [N m].
        """
        lowest = torques[:, :1]
        excess = np.maximum((torques[:, 1:] - lowest) / self.unit, _MIN_EXCESS)
        differences = np.log(excess) - self.mean[self.chosen]
        scores = np.linalg.solve(self.components[:, self.chosen].T, differences.T).T
        return np.hstack(
            [lowest, lowest + self.unit * np.exp(self.mean + scores @ self.components)]
        )


def choose_basis(
    slips: Array, torques: Array, drags: Array, outcomes: tuple[Array, Array]
) -> Basis | None:
    """Return the basis with the fewest slips whose error is small; None without one whose error is acceptable.

    Parameters
    ----------
    slips : ndarray of float, (P,)
        Cage slips, ascending from zero.
    torques, drags : ndarray of float, (n, P)
        Torques of the rollers on the cage in the computed samples, and those by which the drags resist [N m].
    outcomes : tuple of ndarray of float, (n,) each
        Steady slips, infinite without one, and drag reserves of the computed samples.
    """
    if not all(np.isfinite(values).all() for values in (torques, drags)):
        return None
    if any(np.isnan(values).any() for values in outcomes):
        return None
    grid = np.append(0, np.flatnonzero(slips > _MIN_SLIP))
    slips = slips[grid]
    torques = torques[:, grid]
    drags = drags[:, grid]
    exact = [scale.forward(values) for scale, values in zip(scales(), outcomes, strict=True)]
    basis = None
    # a basis has no more components than samples and slips to find them by, one sample being left out
    for count in range(_COUNTS.start, min(_COUNTS.stop, len(torques), slips.size)):
        predicted = np.empty_like(torques)
        for k in range(len(torques)):
            others = Basis.of_branches(slips, np.delete(torques, k, axis=0), count)
            columns = np.append(0, 1 + others.chosen)
            predicted[k] = others.branches(torques[k : k + 1, columns])[0]
        found = balance(slips, predicted, drags)
        errors = [
            float(np.sqrt(np.mean((scale.forward(values) - known) ** 2)))
            for scale, values, known in zip(scales(), found, exact, strict=True)
        ]
        relative = max(
            error / max(known.std(), _MIN_DEVIATION)
            for error, known in zip(errors, exact, strict=True)
        )
        if basis is None or relative < basis.relative_error:
            basis = attrs.evolve(
                Basis.of_branches(slips, torques, count),
                errors=(errors[0], errors[1]),
                relative_error=relative,
            )
        if relative <= _SMALL_ERROR:
            break
    return basis if basis is not None and basis.relative_error <= _MAX_ERROR else None


def balance(slips: Array, torques: Array, drags: Array) -> tuple[Array, Array]:
    """Return steady slip and drag reserve of each sample, (N,), as `rollslip_studies.motion.torque_balance` has them.

    The slip is zero where the cage is driven, and infinite without a balance. Between the slips of the grid torques are
    linear in logit(S), below the first one they are quadratic in S.

    Parameters
    ----------
    slips : ndarray of float, (P,)
        Cage slips, ascending from zero.
    torques, drags : ndarray of float, (N, P)
        Torques of the rollers, and those by which the drags resist [N m].
    """
    rows = np.arange(len(torques))
    logits = _logit(slips[1:])
    excess = torques - drags
    crosses = (excess[:, :-1] < 0.0) & (excess[:, 1:] >= 0.0)
    low = crosses.argmax(axis=1)
    is_driven = excess[:, 0] > 0.0
    is_found = crosses.any(axis=1) & ~is_driven
    below = excess[rows, low]
    part = below / np.where(is_found, below - excess[rows, low + 1], 1.0)
    before = np.maximum(low - 1, 0)
    logit = logits[before] + part * (logits[low] - logits[before])
    steady = np.where(low == 0, _first_root(slips, excess), 1.0 / (1.0 + np.exp(-logit)))
    steady = np.where(is_driven, 0.0, np.where(is_found, steady, np.inf))
    carried = drags[rows, low] + part * (drags[rows, low + 1] - drags[rows, low])
    is_dragged = np.where(is_driven, drags[:, 0], carried) > 0.0

    onset = _skidding_slips(slips, torques)
    limit = np.minimum(onset, SKIDDING_SLIP)
    factor = _largest_ratio(slips, torques, drags, onset)
    reserve = np.where(steady <= limit, np.maximum(factor, 1.0), np.minimum(factor, 1.0))
    is_free = (is_driven | is_found) & ~is_dragged & (steady <= SKIDDING_SLIP)
    return steady, np.where(is_free, np.inf, reserve)


def _first_root(slips: Array, excess: Array) -> Array:
    """Slip below the first one of the grid at which the parabola through three excess torques is zero, (N,)."""
    lowest = np.minimum(excess[:, 0], 0.0)
    slopes = (excess[:, 1:3] - excess[:, :1]) / slips[1:3]
    bend = (slopes[:, 1] - slopes[:, 0]) / (slips[2] - slips[1])
    slope = slopes[:, 0] - bend * slips[1]
    root = np.sqrt(np.maximum(slope**2 - 4.0 * bend * lowest, 0.0))
    return np.asarray(-2.0 * lowest / np.maximum(slope + root, np.finfo(float).tiny))


def _skidding_slips(slips: Array, torques: Array) -> Array:
    """First slip of the grid below `SKIDDING_SLIP` from which the cage skids, infinite without one, (N,).

    It is the slip of a jump that leads beyond `SKIDDING_SLIP`, as for `rollslip_studies.motion.loading_branch.Jump`.
    """
    rows = np.arange(len(torques))
    onset = np.full(len(torques), np.inf)
    for k in reversed(range(1, int((slips < SKIDDING_SLIP).sum()))):
        here = torques[:, k]
        later = torques[:, k + 1 :]
        exceeds = later > here[:, None]
        after = np.where(exceeds.any(axis=1), exceeds.argmax(axis=1), later.shape[1])
        lowest = np.minimum.accumulate(later, axis=1)[rows, np.maximum(after - 1, 0)]
        is_maximum = (here > 0.0) & (here >= torques[:, : k + 1].max(axis=1)) & (after > 0)
        falls = is_maximum & (lowest < (1.0 - SEARCH.min_fall) * here)
        slip_after = np.append(slips[k + 1 :], np.inf)[after]
        onset[falls & (slip_after >= SKIDDING_SLIP)] = slips[k]
    return onset


def _largest_ratio(slips: Array, torques: Array, drags: Array, onset: Array) -> Array:
    """Largest ratio of torque and drag up to the onset of skidding and `SKIDDING_SLIP`, (N,)."""
    rows = np.arange(len(torques))
    ratios = np.where((torques > 0.0) & (drags > 0.0), torques, 0.0) / np.where(
        drags > 0.0, drags, 1.0
    )
    inner = int((slips < SKIDDING_SLIP).sum())
    logits = _logit(slips[inner - 1 : inner + 1])
    part = (_logit(np.array(SKIDDING_SLIP)) - logits[0]) / (logits[1] - logits[0])
    at_end = ratios[:, inner - 1] + part * (ratios[:, inner] - ratios[:, inner - 1])
    points = np.column_stack([ratios[:, 1:inner], at_end])
    points[:, :-1][slips[1:inner] > onset[:, None]] = 0.0
    points[onset < SKIDDING_SLIP, -1] = 0.0
    top = points.argmax(axis=1)
    inside = np.clip(top, 1, points.shape[1] - 3)  # the last interval is shorter
    before, middle, after = (points[rows, inside + step] for step in (-1, 0, 1))
    bend = 2.0 * middle - before - after
    is_vertex = (inside == top) & (after > 0.0) & (bend > 0.0)
    rise = (after - before) ** 2 / (8.0 * np.where(is_vertex, bend, 1.0))
    return np.asarray(points.max(axis=1) + np.where(is_vertex, rise, 0.0))
