"""Where models differ and what they cost: every combination on the slices of one run, the reference's.

- Slices are sorted into bins by what the reference says of them: film regime, film parameter, and what its law of the
  full film states to be sorted by (`TractionModel.regimes`); if that states nothing, by what the first compared law
  states, of the reference's slices. Over the bins of a grouping the differences are sums, so their contributions add up
  to the whole.
- The correlation ratio (variance between the bins over the whole variance, weighted by the reference's friction force)
  says how much of a difference's variation a grouping explains.
- Cost is the time of the bound chains, in turns within one process, of each part the least of a few rounds.
"""

import itertools
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups
from rollslip.models import TractionModel
from rollslip.planning.plan import Plan
from rollslip.results.dataset import about
from rollslip.studies.answers import LoadedSlices
from rollslip.studies.validity import quantity
from rollslip_kernels.slices import Slices

if TYPE_CHECKING:
    import xarray as xr

#: Takes from an evaluated table what is to be kept of it.
Keep = Callable[[Slices], Mapping[str, Array]]
#: Limits between little, some and much of what a law states to be sorted by.
LIMITS: Final = (0.1, 1.0)
#: Rounds of timing at most, and the time [s] that is enough for one chain.
_ROUNDS = 20
_ENOUGH = 1.0
#: Slices that are enough to time.
_TIMED = 50_000
#: Standard deviation of a relative difference below which it is the same everywhere.
_ROUNDING = 1e-9
#: Slices of a part at most: so short that some of its rounds run undisturbed, so long that calls do not count.
_PART = 4096


@attrs.frozen(eq=False)
class EvaluatedSlices:
    """The slices that a run evaluates for its curves."""

    parts: list[LoadedSlices]

    @classmethod
    def of(cls, plan: Plan, study: str, result: "xr.Dataset") -> "EvaluatedSlices":
        """Return the slices of a plan's study, with its result; those of one curve in parts of some size."""
        parts = list[LoadedSlices]()
        some = list[LoadedSlices]()
        for one in plan.studies[study].loaded_slices(plan.assemblies[study], result):
            if some and (
                one.curve != some[0].curve
                or sum(each.load.size for each in some) + one.load.size > _PART
            ):
                parts.append(_joined(some))
                some = []
            some.append(one)
        return cls([*parts, _joined(some)])

    @property
    def slices(self) -> int:
        """Number of slices."""
        return sum(part.load.size for part in self.parts)

    @property
    def force(self) -> list[Array]:
        """Force on each slice, for each curve."""
        return self._by_curve([part.force for part in self.parts])

    def _by_curve(self, values: Sequence[Array]) -> list[Array]:
        pairs = list(zip(self.parts, values, strict=True))
        curves = range(1 + max(part.curve for part in self.parts))
        return [
            np.concatenate([value for part, value in pairs if part.curve == curve])
            for curve in curves
        ]

    def evaluate(
        self, made: Plan, keep: Callable[[Slices], Mapping[str, Array]]
    ) -> tuple[dict[str, list[Array]], Array]:
        """Return what is to be kept of a combination's tables, for each curve, and the times [s] of its chain."""
        kept = list[Mapping[str, Array]]()
        seconds = np.zeros(len(self.parts))
        for k, part in enumerate(self.parts):
            raceway = getattr(made.assembly, part.ring)
            columns = {
                "load": part.load,
                "rolling_speed": part.rolling,
                "sliding_speed": part.sliding,
            }
            table = Slices(part.load.size, raceway.conditions, **columns, **part.places)
            begin = time.perf_counter()
            raceway.chain(table)
            seconds[k] = time.perf_counter() - begin
            kept.append(keep(table))
        return {name: self._by_curve([one[name] for one in kept]) for name in kept[0]}, seconds


def _joined(some: Sequence[LoadedSlices]) -> LoadedSlices:
    """Return several parts of one curve as one."""
    if len(some) == 1:
        return some[0]

    def joined(values: Sequence[Any]) -> Array:
        return np.concatenate(
            [np.broadcast_to(of, one.load.shape) for of, one in zip(values, some, strict=True)]
        )

    columns: dict[str, Any] = {
        name: joined([getattr(one, name) for one in some])
        for name in ("load", "rolling", "sliding", "force")
    }
    places = {name: joined([one.places[name] for one in some]) for name in some[0].places}
    return attrs.evolve(some[0], **columns, places=places)


def keep_friction(table: Slices) -> dict[str, Array]:
    """Keep the friction of a table, and not the table."""
    return {"friction": table.friction.copy()}


def law_to_sort_by(tractions: Sequence[TractionModel]) -> TractionModel | None:
    """Return the first law of the full film that states what to sort slices by; None if none does."""
    return next((traction.full_film for traction in tractions if traction.full_film.regimes), None)


def keep_criteria(law: TractionModel | None) -> Keep:
    """Keep friction and what slices are sorted by: film, and what a law states of them; nan where data are missing."""

    def keep(s: Slices) -> dict[str, Array]:
        with np.errstate(all="ignore"):
            stated = (
                {}
                if law is None
                else {name: quantity(law, of, s) for name, (of, _) in law.regimes.items()}
            )
        return keep_friction(s) | {
            "film regime": film_by_regime(*groups(s))[1],
            "film parameter": s.film_thickness / s.conditions.roughness,
            **{name: np.abs(values) for name, values in stated.items()},
        }

    return keep


def seconds_per_slice(
    work: EvaluatedSlices, made: Mapping[str, Plan], first: Mapping[str, Array]
) -> dict[str, float]:
    """Return the time [s] of each combination's chain: of each part the least of the first and of further rounds.

    Of much work parts all over the curves are taken, so few that there is time for many rounds.
    """
    every = slice(
        None, None, work.slices // _TIMED | 1
    )  # odd, since the parts of two rings alternate
    some = EvaluatedSlices(work.parts[every])
    least = {label: times[every] for label, times in first.items()}
    spent = {label: float(times.sum()) for label, times in least.items()}
    for _ in range(_ROUNDS):
        for label in least:
            if spent[label] < _ENOUGH:
                _, times = some.evaluate(made[label], lambda table: {})
                least[label], spent[label] = (
                    np.minimum(least[label], times),
                    spent[label] + float(times.sum()),
                )
    return {label: float(times.sum()) / some.slices for label, times in least.items()}


@attrs.frozen(eq=False)
class Bins:
    """Groupings with their bins in words, and for each curve the number of every slice's bin, grouping by grouping."""

    names: Mapping[str, tuple[str, ...]]
    codes: list[list[Any]]

    @classmethod
    def of(cls, made: Plan, found: Mapping[str, list[Array]], law: TractionModel | None) -> "Bins":
        """Sort slices by their criteria, as far as the oil, the traction and the law that states some give them."""
        traction = made.assembly.traction
        bins: dict[str, tuple[str, ...]] = {
            "film regime": tuple(f"in the {LONG_NAMES[name]} regime" for name in NAMES)
        }
        limits: dict[str, tuple[float, ...]] = {"film regime": (0.5, 1.5, 2.5)}
        if (full := traction.full_film_from) is not None:
            limits["film parameter"] = (traction.boundary_up_to, full)
            films = zip(
                ("boundary", "mixed", "full"),
                _ranges("Lambda", limits["film parameter"]),
                strict=True,
            )
            bins["film parameter"] = tuple(f"in {film} film, {words}" for film, words in films)
        for grouping, (_, symbol) in () if law is None else law.regimes.items():
            if not any(np.isnan(values).any() for values in found[grouping]):
                limits[grouping] = LIMITS
                bins[grouping] = tuple(f"where {words}" for words in _ranges(symbol, LIMITS))
        curves = range(len(found["friction"]))
        return cls(
            bins,
            [
                [np.digitize(found[name][k], limits[name], right=True) for name in bins]
                for k in curves
            ],
        )


def _ranges(symbol: str, limits: tuple[float, ...]) -> list[str]:
    between = [f"{low:g} < {symbol} <= {high:g}" for low, high in itertools.pairwise(limits)]
    return [f"{symbol} <= {limits[0]:g}", *between, f"{symbol} > {limits[-1]:g}"]


def attribute_differences(
    dataset: "xr.Dataset",
    curve: str,
    reference: str,
    work: EvaluatedSlices,
    found: Mapping[str, list[Array]],
    by: Bins,
) -> "xr.Dataset":
    """Add to a comparison what each bin holds of the force and of the difference."""
    labels = dataset["combination"].to_numpy().tolist()
    sizes = [len(bins) for bins in by.names.values()]
    each = (len(labels), dataset.sizes[curve])
    begins = np.cumsum([0, *sizes[:-1]])
    mean = np.full(each, np.nan)
    explained = np.full((*each, len(sizes)), np.nan)
    difference, contribution = np.full((2, *each, sum(sizes)), np.nan)
    fraction = np.full((dataset.sizes[curve], sum(sizes)), np.nan)
    for j, (force, standard, codes) in enumerate(
        zip(work.force, found[reference], by.codes, strict=True)
    ):

        def summed(values: Array, codes: list[Any] = codes) -> Array:
            return np.concatenate(
                [np.bincount(code, values, size) for code, size in zip(codes, sizes, strict=True)]
            )

        fraction[j] = summed(force) / force.sum()
        weight = force * np.abs(standard)
        weights = summed(weight)
        whole = weight.sum()
        held = weight > 0.0
        if not whole > 0.0:
            continue
        for label, values in found.items():
            gap = force * np.sign(standard) * (values[j] - standard)
            at = (labels.index(label), j)
            gaps = summed(gap)
            mean[at] = gap.sum() / whole
            contribution[at] = gaps / whole
            with np.errstate(invalid="ignore"):
                difference[at] = gaps / weights
            spread = (weight[held] * (gap[held] / weight[held] - mean[at]) ** 2).sum()
            between = np.nan_to_num(weights * (difference[at] - mean[at]) ** 2)
            explained[at] = (
                np.add.reduceat(between, begins) / spread if spread > _ROUNDING**2 * whole else 0.0
            )
    of = ("combination", curve)
    what = f"relative difference from {reference}"
    return dataset.assign(
        mean_difference=(
            of,
            mean,
            about("1", f"{what} of the friction force summed over the slices of the curve"),
        ),
        bin_fraction=(
            (curve, "bin"),
            fraction,
            about("1", "share of the contact force over the curve"),
        ),
        bin_difference=((*of, "bin"), difference, about("1", f"{what} within the bin")),
        bin_contribution=(
            (*of, "bin"),
            contribution,
            about("1", "what the bin adds to mean_difference"),
        ),
        explained=(
            (*of, "grouping"),
            explained,
            about("1", "share of the difference's variance between the bins"),
        ),
    ).assign_coords(
        bin=(
            "bin",
            np.concatenate(list(by.names.values())),
            about("1", "slices of the reference"),
        ),
        bin_grouping=(
            "bin",
            np.repeat(list(by.names), sizes),
            about("1", "what they are sorted by"),
        ),
        grouping=("grouping", np.array(list(by.names)), about("1", "what slices are sorted by")),
    )
