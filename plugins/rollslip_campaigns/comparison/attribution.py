"""Attribute the differences between models to regimes, and measure what the models cost.

1. Take the slices that the run of the reference evaluates, and evaluate them by each combination of models.
2. Sort the slices into bins by the values of the reference: film regime, film parameter, and the criteria that its law
   of the full film states (`TractionModel.regimes`). If that law states none, take the first compared law that does, at
   the slices of the reference.
3. In each bin sum the force on the slices and the difference of friction forces. Within a grouping the bins partition
   the slices, so that their contributions add up to the whole difference.
4. The correlation ratio (variance between the bins over the whole variance, weighted by the friction force of the
   reference) is the fraction of the variation of the difference that a grouping explains.
5. The cost is the time of the bound chains of laws. Combinations take turns within one process, and of each part of the
   slices the smallest time of some rounds counts, because other processes only add to it.
"""

import itertools
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups
from rollslip.models import TractionModel
from rollslip.planning.plan import Plan
from rollslip.results.dataset import about, xr
from rollslip.studies.answers import LoadedSlices
from rollslip.studies.validity import quantity
from rollslip_kernels.slices import Slices

#: Function that extracts columns from an evaluated table.
Extract = Callable[[Slices], Mapping[str, Array]]
#: Limits between little, some and much of a criterion, relative to the value 1 at which a law changes its regime.
#: Doubling both moves slices to lower bins; the sum of all bins stays.
LIMITS: Final = (0.1, 1.0)

#: Rounds over the timed parts at most. Doubling it lowers the smallest times a little further and doubles the time
#: for cheap laws. Chosen.
_MAX_ROUNDS: Final = 20
#: Time [s] after which a chain is not timed again. Chosen; doubling it doubles the time for costly laws.
_MAX_SECONDS: Final = 1.0
#: Slices that are timed; of more work, every n-th part is taken. Doubling it leaves time for fewer rounds. Chosen.
_TIMED_SLICES: Final = 50_000
#: Largest number of slices in a part: so small that some rounds of it run undisturbed by other processes, so large
#: that the time of the call does not count. Chosen.
_PART_SIZE: Final = 4096
#: Standard deviation of a relative difference that is rounding error: below it the difference is constant and no
#: grouping explains it. Chosen far above rounding of double precision and far below differences of models.
_ROUNDING = 1e-9


@attrs.frozen(eq=False)
class EvaluatedSlices:
    """The slices that a run evaluates for its curves, in parts."""

    parts: list[LoadedSlices]

    @classmethod
    def from_result(cls, plan: Plan, study: str, result: "xr.Dataset") -> "EvaluatedSlices":
        """Return the slices of a planned study with its result; slices of one curve are joined up to the part size."""
        parts = list[LoadedSlices]()
        pending = list[LoadedSlices]()
        for loaded in plan.studies[study].loaded_slices(plan.assemblies[study], result):
            size = sum(part.load.size for part in pending) + loaded.load.size
            if pending and (loaded.curve != pending[0].curve or size > _PART_SIZE):
                parts.append(_join(pending))
                pending = []
            pending.append(loaded)
        return cls([*parts, _join(pending)])

    @property
    def slices(self) -> int:
        """The number of slices."""
        return sum(part.load.size for part in self.parts)

    @property
    def force(self) -> list[Array]:
        """The force on each slice [N], for each curve."""
        return self._by_curve([part.force for part in self.parts])

    def _by_curve(self, values: Sequence[Array]) -> list[Array]:
        """Return the values of all parts of each curve in one array."""
        return [
            np.concatenate(
                [value for part, value in zip(self.parts, values, strict=True) if part.curve == k]
            )
            for k in range(1 + max(part.curve for part in self.parts))
        ]

    def evaluate(self, plan: Plan, extract: Extract) -> tuple[dict[str, list[Array]], Array]:
        """Return columns of the slices by a combination of models, for each curve, and the times of its chain.

        Parameters
        ----------
        plan : Plan
            Plan of the combination.
        extract : callable
            Returns the columns of an evaluated table by name; the table itself is reused.

        Returns
        -------
        tuple
            For each name a list over curves of arrays (slices,), and the time [s] of each part, (parts,).
        """
        columns = list[Mapping[str, Array]]()
        seconds = np.zeros(len(self.parts))
        for k, part in enumerate(self.parts):
            raceway = getattr(plan.assembly, part.ring)
            table = Slices(
                part.load.size,
                raceway.conditions,
                load=part.load,
                rolling_speed=part.rolling,
                sliding_speed=part.sliding,
                **part.places,
            )
            start = time.perf_counter()
            raceway.chain(table)
            seconds[k] = time.perf_counter() - start
            columns.append(extract(table))
        return {
            name: self._by_curve([part[name] for part in columns]) for name in columns[0]
        }, seconds


def _join(parts: Sequence[LoadedSlices]) -> LoadedSlices:
    """Return several parts of one curve as one."""
    if len(parts) == 1:
        return parts[0]

    def concatenate(values: Sequence[Any]) -> Array:
        return np.concatenate(
            [
                np.broadcast_to(value, part.load.shape)
                for value, part in zip(values, parts, strict=True)
            ]
        )

    columns: dict[str, Any] = {
        name: concatenate([getattr(part, name) for part in parts])
        for name in ("load", "rolling", "sliding", "force")
    }
    places = {name: concatenate([part.places[name] for part in parts]) for name in parts[0].places}
    return attrs.evolve(parts[0], **columns, places=places)


def extract_friction(table: Slices) -> dict[str, Array]:
    """Return a copy of the friction in a table."""
    return {"friction": table.friction.copy()}


def extract_criteria(law: TractionModel | None) -> Extract:
    """Return a function that extracts friction, film and the criteria of a law; NaN where data are missing."""

    def extract(s: Slices) -> dict[str, Array]:
        stated: dict[str, Array] = {}
        if law is not None:
            with np.errstate(all="ignore"):
                stated = {name: quantity(law, of, s) for name, (of, _) in law.regimes.items()}
        return extract_friction(s) | {
            "film regime": film_by_regime(*groups(s))[1],
            "film parameter": s.film_thickness / s.conditions.roughness,
            **{name: np.abs(values) for name, values in stated.items()},
        }

    return extract


def seconds_per_slice(
    work: EvaluatedSlices, plans: Mapping[str, Plan], times: Mapping[str, Array]
) -> dict[str, float]:
    """Return the time of the chain of each combination per slice [s].

    Parameters
    ----------
    work : EvaluatedSlices
        Slices of the reference.
    plans : mapping
        Plan of each combination, by label.
    times : mapping
        Times [s] of the first round for each part, by label.

    Returns
    -------
    dict
        Sum over the timed parts of the smallest time of all rounds, over their slices, by label.
    """
    stride = work.slices // _TIMED_SLICES | 1  # odd, since the parts of two rings alternate
    timed = EvaluatedSlices(work.parts[::stride])
    smallest = {label: first[::stride] for label, first in times.items()}
    spent = {label: float(first.sum()) for label, first in smallest.items()}
    for _ in range(_MAX_ROUNDS):
        for label in smallest:
            if spent[label] < _MAX_SECONDS:
                _, seconds = timed.evaluate(plans[label], lambda table: {})
                smallest[label] = np.minimum(smallest[label], seconds)
                spent[label] += float(seconds.sum())
    return {label: float(seconds.sum()) / timed.slices for label, seconds in smallest.items()}


@attrs.frozen(eq=False)
class Bins:
    """Bins of the slices of the reference.

    Attributes
    ----------
    names : mapping
        Descriptions of the bins of each grouping.
    codes : list
        For each curve and grouping the number of the bin of each slice, (slices,).
    """

    names: Mapping[str, tuple[str, ...]]
    codes: list[list[Any]]

    @classmethod
    def from_criteria(
        cls, plan: Plan, criteria: Mapping[str, list[Array]], law: TractionModel | None
    ) -> "Bins":
        """Return the bins of slices by their criteria, except those whose limits or data are missing.

        Parameters
        ----------
        plan : Plan
            Plan of the reference, whose traction states the limits of the film parameter.
        criteria : mapping
            Friction and criteria by name, for each curve (slices,).
        law : TractionModel or None
            The law that states criteria of its regimes.
        """
        traction = plan.assembly.traction
        bins: dict[str, tuple[str, ...]] = {
            "film regime": tuple(f"in the {LONG_NAMES[name]} regime" for name in NAMES)
        }
        limits: dict[str, tuple[float, ...]] = {"film regime": (0.5, 1.5, 2.5)}
        if (full := traction.full_film_from) is not None:
            limits["film parameter"] = (traction.boundary_up_to, full)
            intervals = _ranges("Lambda", limits["film parameter"])
            bins["film parameter"] = tuple(
                f"in {film} film, {interval}"
                for film, interval in zip(("boundary", "mixed", "full"), intervals, strict=True)
            )
        for grouping, (_, symbol) in ({} if law is None else law.regimes).items():
            if not any(np.isnan(values).any() for values in criteria[grouping]):
                limits[grouping] = LIMITS
                bins[grouping] = tuple(f"where {interval}" for interval in _ranges(symbol, LIMITS))
        return cls(
            bins,
            [
                [np.digitize(criteria[name][k], limits[name], right=True) for name in bins]
                for k in range(len(criteria["friction"]))
            ],
        )


def _ranges(symbol: str, limits: tuple[float, ...]) -> list[str]:
    """Return the intervals that limits make of a quantity, as inequalities."""
    return [
        f"{symbol} <= {limits[0]:g}",
        *(f"{low:g} < {symbol} <= {high:g}" for low, high in itertools.pairwise(limits)),
        f"{symbol} > {limits[-1]:g}",
    ]


def attribute_differences(
    dataset: "xr.Dataset",
    curve: str,
    reference: str,
    work: EvaluatedSlices,
    friction: Mapping[str, list[Array]],
    bins: Bins,
) -> "xr.Dataset":
    """Add to a comparison the force and the difference of friction of each bin.

    Parameters
    ----------
    dataset : xarray.Dataset
        The comparison.
    curve : str
        Dimension of its curves.
    reference : str
        Label of the reference.
    work : EvaluatedSlices
        Slices of the reference.
    friction : mapping
        Friction coefficients of each combination, for each curve (slices,).
    bins : Bins
        Bins of the slices.

    Returns
    -------
    xarray.Dataset
        The comparison with the differences; NaN for combinations without friction, and in bins without friction force.
    """
    labels = dataset["combination"].to_numpy().tolist()
    sizes = list(map(len, bins.names.values()))
    shape = (len(labels), dataset.sizes[curve])
    first_bins = np.cumsum([0, *sizes[:-1]])
    mean = np.full(shape, np.nan)
    explained = np.full((*shape, len(sizes)), np.nan)
    difference, contribution = np.full((2, *shape, sum(sizes)), np.nan)
    fraction = np.full((dataset.sizes[curve], sum(sizes)), np.nan)
    for j, (force, standard, codes) in enumerate(
        zip(work.force, friction[reference], bins.codes, strict=True)
    ):

        def sum_in_bins(values: Array, codes: list[Any] = codes) -> Array:
            return np.concatenate(
                [np.bincount(code, values, size) for code, size in zip(codes, sizes, strict=True)]
            )

        fraction[j] = sum_in_bins(force) / force.sum()
        weight = force * np.abs(standard)
        weights = sum_in_bins(weight)
        whole = weight.sum()
        positive = weight > 0.0
        if not whole > 0.0:
            continue
        for label, values in friction.items():
            gap = force * np.sign(standard) * (values[j] - standard)
            at = (labels.index(label), j)
            gaps = sum_in_bins(gap)
            mean[at] = gap.sum() / whole
            contribution[at] = gaps / whole
            with np.errstate(invalid="ignore"):
                difference[at] = gaps / weights
            deviation = gap[positive] / weight[positive] - mean[at]
            variance = (weight[positive] * deviation**2).sum()
            between = np.nan_to_num(weights * (difference[at] - mean[at]) ** 2)
            explained[at] = 0.0
            if variance > _ROUNDING**2 * whole:
                explained[at] = np.add.reduceat(between, first_bins) / variance
    dims = ("combination", curve)
    what = f"relative difference from {reference}"
    return dataset.assign(
        mean_difference=(
            dims,
            mean,
            about("1", f"{what} of the friction force summed over the slices of the curve"),
        ),
        bin_fraction=(
            (curve, "bin"),
            fraction,
            about("1", "fraction of the contact force over the curve"),
        ),
        bin_difference=((*dims, "bin"), difference, about("1", f"{what} within the bin")),
        bin_contribution=(
            (*dims, "bin"),
            contribution,
            about("1", "what the bin adds to mean_difference"),
        ),
        explained=(
            (*dims, "grouping"),
            explained,
            about("1", "fraction of the variance of the difference between the bins"),
        ),
    ).assign_coords(
        bin=(
            "bin",
            np.concatenate(list(bins.names.values())),
            about("1", "slices of the reference"),
        ),
        bin_grouping=(
            "bin",
            np.repeat(list(bins.names), sizes),
            about("1", "what they are sorted by"),
        ),
        grouping=("grouping", np.array(list(bins.names)), about("1", "what slices are sorted by")),
    )
