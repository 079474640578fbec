"""Estimate how scattering data change the drag reserve, the steady slip and the minimum load, and the allowable slip.

Method: randomized quasi-Monte Carlo, by sweeps over samples of the uncertain data.

1. Draw samples as points of eight Sobol sequences in turn, each scrambled independently; the differences between the
   sequences give the confidence intervals of the quantiles (`rollslip_campaigns.uncertainty.estimators.quantile`).
2. Compute the study effective-friction for a batch of samples. Each batch has as many samples as all batches before it,
   because a sequence of 2^k points begins with that of 2^(k-1).
3. Estimate the allowable slip. Stop where its interval is narrow enough (``until``) or all samples are computed.
   Without ``until`` all samples are computed in one run.
4. Compute the minimum load for the first samples, and Saltelli's design for Sobol indices, if they are requested.
5. Estimate quantiles, probabilities and rank correlations, and save them as a dataset.

Quantities:

- The *drag reserve* is the limit drag torque of the rollers divided by the drags of the scene
  (`rollslip_studies.motion.loading_branch`). With probability p it is at least its quantile 1 - p. Where skidding does
  not begin in the range it is a lower bound; below 1 the cage skids.
- The *steady slip* is the smallest slip at which rollers and drags are in balance. The *minimum load* is the radial load
  at which the steady slip is the acceptable slip of the scene. Reserve, slips and skidding of a sample follow from one
  loading branch.
- Skidding begins at the slip where the balance of torques has its fold. The slip that is *allowable* with probability p
  is the quantile 1 - p of that slip. The *margin* is the probability that the steady slip is below the slip at which
  skidding begins, sample by sample. This slip does not rank oils: mostly a large limit drag torque makes it small.
- The critical slips of the curves, by the closure of the scene, are reported too: that of a bearing is the smaller one
  of its rings. With epicyclic rollers they are mostly larger than the slip at which skidding begins.
- A slip beyond the range of the study counts as larger than all in it. A point that failed is unknown, and counts as
  the smallest and as the largest value that it could have had (`rollslip_campaigns.uncertainty.estimators`).

All sweeps are in one folder, so that the same command continues an interrupted run. Data that scatter are those of the
scene's table ``[uncertainty]``; without one, what data and fields declare (`rollslip_studies.variation.scatter`). Sobol
indices divide a variance among independent inputs; they are refused for correlated ones, because their sums would have
no meaning.
"""

import json
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.bearing.raceway import Array
from rollslip.errors import SceneError
from rollslip.results.dataset import UNITS, about
from rollslip.results.words import duration_range
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress, requested_engine
from rollslip_campaigns.sweep.sampling import REPLICATES
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_campaigns.uncertainty.estimators import (
    Estimate,
    fraction,
    indices,
    min_samples,
    quantile,
)
from rollslip_campaigns.uncertainty.findings import DRAG, LOAD, RESERVE, SKIDDING, STEADY
from rollslip_campaigns.uncertainty.samples import (
    CRITICAL_SLIP,
    classify_reserves,
    friction_samples,
    minimum_loads,
)
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.variation.scatter import with_scatter

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.uncertainty import UncertaintySettings

__all__ = ["RESULT", "Margin", "expected_seconds", "plan_margin", "run_margin"]

#: Name of the file with the result, in the folder of the sweeps.
RESULT: Final = "uncertainty.nc"
#: Confidence of the intervals that are reported. A higher one widens every interval. Chosen: the usual 95 %.
CONFIDENCE: Final = 0.95
#: Confidence of the intervals of quantiles where the samples end at a width (``until``). Such a stop favours intervals
#: that are narrow by chance, which costs up to 4 % of coverage (docs/tables/margin_coverage.csv): with 0.975 the
#: intervals still hold with 95 %. With 0.95 they would not; closer to 1 they need more samples than necessary.
STOPPING_CONFIDENCE: Final = 0.975
#: Samples of the first batch; a batch ends at 256, 512, 1024, ... samples. Twice as many can make runs with ``until``
#: compute up to 256 samples too many. Chosen: 32 samples of each of eight sequences, a power of two.
_FIRST_BATCH = 256
#: Maximum number of samples with ``until``; it bounds the time of a run whose interval never is as narrow. Twice as many
#: make the interval at the maximum narrower by about 1/sqrt(2), for twice the time. Chosen.
_MAX_SAMPLES = 16384
#: Default number of samples. Twice as many double the time and make intervals of a 1 % quantile narrower by about a
#: third (docs/tables/margin_coverage.csv). 1024 is a power of two that gives this quantile two finite bounds
#: (`rollslip_campaigns.uncertainty.estimators.min_samples`), which 512 does not always.
_DEFAULT_SAMPLES = 1024
#: Default number of samples of the minimum load, for which a point is a search over loads. Twice as many double its
#: time. Chosen: enough for median and 90 % band, not for the bounds of a 99 % quantile.
_DEFAULT_LOADS = 64
#: Smallest number of samples from which a rank correlation is computed; below it, the correlation is NaN. A smaller
#: number would report correlations that are chance. Chosen: with 8 samples the standard error is 1/sqrt(7), about 0.4.
_MIN_RANKED: Final = 8
#: Probabilities of the quantiles that are reported besides those of the requested probability p and 1 - p.
_REPORTED_PROBABILITIES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Predicates that classify a sample: known, beyond a range, unknown; in the order of the variables that count them.
_SAMPLE_KINDS: Final = (np.isfinite, np.isinf, np.isnan)
#: Variables of study effective-friction that the samples need.
_OUTPUTS: Final = (
    "drag_reserve", "steady_cage_slip", "skidding_slip", "limit_drag", "critical_cage_slip", "critical_friction"
)  # fmt: skip


@attrs.frozen(eq=False, kw_only=True)
class Margin:
    """What is asked for, as sweeps over the same uncertain data.

    Attributes
    ----------
    critical : Sweep
        Effective friction on all samples.
    load : Sweep or None
        Least radial loads on the first of them; None without an acceptable slip.
    varied : Sweep or None
        Effective friction on Saltelli's design, for Sobol indices; None if they are not asked for.
    probability : float
        With which the slip is to be below that of running away.
    until : float or None
        Half width of the interval of the allowable slip at which batches end.
    scatter : tuple of str
        What oil and bearing say of their scatter, if that is what the samples are of.
    """

    critical: Sweep
    load: Sweep | None
    varied: Sweep | None
    probability: float
    until: float | None
    scatter: tuple[str, ...]

    @property
    def sweeps(self) -> dict[str, Sweep]:
        """Sweeps that are asked for, by the name of their folder."""
        named = {"critical": self.critical, "load": self.load, "indices": self.varied}
        return {name: one for name, one in named.items() if one is not None}

    @property
    def unusual(self) -> tuple[str, ...]:
        """What is unusual of the values that scatter."""
        return self.critical.unusual

    @property
    def told(self) -> list[str]:
        """What is sampled, and what it costs, in words."""
        planned = dict.fromkeys(f"  {line}" for one in self.sweeps.values() for line in one.planned)
        cost = (
            f"  {name}: {duration_range(of)} of one core"
            for name, of in expected_seconds(self).items()
        )
        return [self.critical.headline, *planned, *cost]

    @property
    def confidence(self) -> float:
        """Confidence with which intervals of quantiles are made, so that they hold with 95 %."""
        return CONFIDENCE if self.until is None else STOPPING_CONFIDENCE

    def quantile(self, values: Array, probability: float) -> Estimate:
        """Return a quantile of samples."""
        return quantile(values, probability, replicates=REPLICATES, confidence=self.confidence)


def plan_margin(requested: "UncertaintySettings") -> Margin:
    """Check what is asked for and lay out its samples."""
    scene = requested.given
    probability = requested.probability
    until = requested.until
    indices = requested.indices
    samples = (
        requested.samples if requested.samples is not None else _DEFAULT_SAMPLES if until is None else _MAX_SAMPLES
    )
    stated = "acceptable_slip" in scene.study.get(SteadySlip.name, {})
    loads = (
        requested.loads if requested.loads is not None else min(_DEFAULT_LOADS, samples) if stated else 0
    )
    problems = []
    if not 0.5 <= probability < 1.0:
        problems.append(f"probability: must be from 0.5 to below 1, not {probability:g}")
    if until is not None and not until > 0.0:
        problems.append(f"until: a half width above 0 is expected, such as 0.01, not {until:g}")
    if loads > samples:
        problems.append(
            f"loads: the samples of the minimum load are the first of all {samples}, not {loads}"
        )
    if indices and (indices < 4 or indices & (indices - 1)):
        problems.append(
            f"indices: the design after Saltelli needs a power of two, 4 or more rows, not {indices}"
        )
    if not EffectiveFriction.from_scene(scene).skidding_range:
        problems.append(
            f"study.{EffectiveFriction.name}.skidding_range: a range is needed, such as 0.95, not 0"
        )
    if problems:
        raise SceneError(problems)
    scene, scatter = with_scatter(scene)
    shared: dict[str, Any] = {
        "seed": requested.seed,
        "engine": requested.engine,
        "time_limit": requested.time_limit,
    }
    friction = {"study": EffectiveFriction.name, "output": _OUTPUTS, **shared}
    balance = {"study": SteadySlip.name, "output": ["minimum_load"], **shared}
    critical = plan_sweep(scene, samples=samples, sampling="replicated-sobol", **friction)
    if critical.design.axes:
        keys = ", ".join(axis.key for axis in critical.design.axes)
        raise SceneError(
            [
                f"sweep.over: {keys} is swept, but margins are of one bearing; take rollslip sweep run"
            ]
        )
    if indices and np.any(
        critical.uncertainty.correlation != np.eye(len(critical.uncertainty.distributions))
    ):
        raise SceneError(
            [
                "uncertainty.correlation: Sobol indices need independent inputs, and these are correlated; leave out "
                "the indices, or the correlations"
            ]
        )
    requested_engine(critical)  # refused before a folder is made
    return Margin(
        critical=critical,
        load=plan_sweep(scene, samples=loads, sampling="replicated-sobol", **balance)
        if loads
        else None,
        varied=plan_sweep(scene, samples=indices, sampling="saltelli", **friction)
        if indices
        else None,
        probability=probability,
        until=until,
        scatter=scatter,
    )


def expected_seconds(plan: Margin) -> dict[str, float]:
    """Return the time [s] of one core that each sweep needs, if all its points are like the scene without scatter.

    With ``until`` those of running away are the most that there may be.
    """
    return {
        # the first time imports, and makes what samples share
        name: len(sweep.numbers)
        * min(compute(sweep.work, ((0, {}),)).rows[0].seconds for _ in range(2))
        for name, sweep in plan.sweeps.items()
    }


def run_margin(
    plan: Margin,
    folder: Path,
    *,
    said: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute what a margin needs, or what is left of it, in its folder, and write the result there."""
    from rollslip.results.dataset import save

    folder.mkdir(parents=True, exist_ok=True)
    every = {
        name: Points.of(one, folder / name, lambda text, name=name: said(f"{name}: {text}"), report)  # type: ignore[misc]
        for name, one in plan.sweeps.items()
    }

    def computed(name: str, count: int | None = None) -> "xr.Dataset":
        numbers = None if count is None else range(count)
        every[name].compute(numbers)
        return every[name].collected(numbers).isel(sample=slice(count))

    batches = list[tuple[int, Estimate]]()
    total = len(plan.critical.design.samples)
    count = min(_FIRST_BATCH, total)
    # where no interval ends them all are computed in one run, for which workers start once
    whole = computed("critical", total) if plan.until is None else None
    while True:
        critical = computed("critical", count) if whole is None else whole.isel(sample=slice(count))
        allowed = plan.quantile(friction_samples(critical)[SKIDDING], 1.0 - plan.probability)
        batches.append((count, allowed))
        said(f"{count} samples: {_so_far(allowed)}")
        # more samples make no end known that lies beyond the range
        if count == total or (
            plan.until is not None and (allowed.low == math.inf or allowed.half_width <= plan.until)
        ):
            break
        count = min(2 * count, total)
    points = {"critical": critical}
    if plan.load is not None:
        points["load"] = computed("load", min(len(plan.load.design.samples), count))
    if plan.varied is not None:
        points["indices"] = computed("indices")
    dataset = _dataset(plan, batches, points)
    save(dataset, folder / RESULT)
    return dataset


def _so_far(allowed: Estimate) -> str:
    """Tell an allowable slip of some samples in short, on whichever side of its range its ends are."""
    if math.isnan(allowed.value):
        return "none has a result"
    value, low, high = (f"{100.0 * end:.4g} %" for end in attrs.astuple(allowed))
    if allowed.value == math.inf:
        value = "beyond the range"
    if allowed.low == -math.inf:
        return f"allowable slip {value}, too few for the low end of its interval"
    if allowed.high == math.inf:
        low = "beyond the range" if allowed.low == math.inf else low
        return f"allowable slip {value}, 95 %: from {low} on"
    return f"allowable slip {value}, 95 %: {low} to {high}"


# What the samples say ------------------------------------------------------------------------------------------------


def _dataset(
    plan: Margin, batches: list[tuple[int, Estimate]], points: Mapping[str, "xr.Dataset"]
) -> "xr.Dataset":
    import xarray as xr

    critical = points["critical"]
    n = batches[-1][0]
    values = friction_samples(critical)
    variables = dict[str, Any]()
    if STEADY in values:
        slip = values[STEADY]
        away = values[SKIDDING]
        fractions = classify_reserves(critical)
        known = ~np.isnan(slip) & ~np.isnan(away)
        margin = fraction(int((slip < away)[known].sum()), int((~known).sum()), n, CONFIDENCE)
        skids = fraction(
            int(fractions["skids"].sum()), int(fractions["unknown"].sum()), n, CONFIDENCE
        )
        variables |= _estimate(
            "margin",
            margin,
            "probability that the steady slip is below that at which skidding begins",
        )
        variables |= _estimate(
            "skidding", skids, "probability that the cage has no balance of torques"
        )
        said = "samples of which the reserve is a lower bound"
        variables["bounded"] = (), int(fractions["bound"].sum()), about("1", said)
    if "load" in points:  # third of what is told
        loads = {LOAD: minimum_loads(points["load"])}
        values = (
            {key: values.pop(key) for key in (RESERVE, STEADY) if key in values} | loads | values
        )
    allowed = batches[-1][1]
    variables |= _estimate("allowable", allowed, "allowable slip")
    variables["allowable_slip"] = variables.pop("allowable")
    table = np.full((len(values), n), np.nan)
    for row, one in zip(table, values.values(), strict=True):
        row[: one.size] = one
    probabilities = tuple(sorted({*_REPORTED_PROBABILITIES, round(1.0 - plan.probability, 12), plan.probability}))
    quantiles = np.array(
        [[attrs.astuple(plan.quantile(one, p)) for p in probabilities] for one in values.values()]
    )
    over = ("quantity", "probability")
    counts = np.array([[one.size, *(of(one).sum() for of in _SAMPLE_KINDS)] for one in values.values()])
    ends = np.array([attrs.astuple(one) for _, one in batches])
    variables |= {
        "value": (
            ("quantity", "sample"),
            table,
            about("1", f"value of a sample, number k of scrambling k mod {REPLICATES}"),
        ),
        "quantile_value": (over, quantiles[..., 0], about("1", "quantile of the known samples")),
        "quantile_low": (over, quantiles[..., 1], about("1", "low end of its 95 % interval")),
        "quantile_high": (over, quantiles[..., 2], about("1", "high end of its 95 % interval")),
        "samples": ("quantity", counts[:, 0], about("1", "samples")),
        "known": ("quantity", counts[:, 1], about("1", "known")),
        "beyond": ("quantity", counts[:, 2], about("1", "beyond")),
        "unknown": ("quantity", counts[:, 3], about("1", "unknown")),
        "batch_samples": (
            "batch",
            np.array([count for count, _ in batches]),
            about("1", "samples"),
        ),
        "batch_allowable": ("batch", ends[:, 0], about("1", "allowable slip")),
        "batch_low": ("batch", ends[:, 1], about("1", "low end of its interval")),
        "batch_high": ("batch", ends[:, 2], about("1", "high end of its interval")),
        "input_value": (
            ("input", "sample"),
            plan.critical.design.samples[:n].T,
            about("SI", "value of an uncertain quantity"),
        ),
    }
    acted = [name for name in (RESERVE, STEADY, LOAD, SKIDDING) if name in values]
    ranks = np.array(
        [
            [_ranked(column, values[name]) for name in acted]
            for column in plan.critical.design.samples.T
        ]
    )
    variables["rank_correlation"] = (
        ("input", "acted"), ranks, about("1", "rank correlation of an uncertain quantity with what is acted on")
    )  # fmt: skip
    variables["strength_correlation"] = (
        (),
        _ranked(values[SKIDDING], values[DRAG]),
        about(
            "1", "rank correlation of the slip at which skidding begins and the limit drag torque"
        ),
    )
    coords: dict[str, Any] = {
        "acted": ("acted", np.array(acted), about("1", "what is acted on")),
        "quantity": (
            "quantity",
            np.array(list(values)),
            about("1", "what it is") | {UNITS: json.dumps({LOAD: "N", DRAG: "N m"})},
        ),
        "probability": (
            "probability",
            np.array(probabilities),
            about("1", "share of the distribution below"),
        ),
        "input": ("input", np.array(plan.critical.design.keys), about("1", "what is uncertain")),
    }
    if plan.varied is not None:
        found, names = _indices(plan, points)
        variables |= found
        coords["indexed"] = ("indexed", np.array(names), about("1", "what the indices are of"))
    ended = {name: Counter(one["status"].to_numpy().tolist()) for name, one in points.items()}
    failed = {name: dict(sorted(counts.items())) for name, counts in ended.items()}
    return xr.Dataset(
        variables, coords, _attributes(plan, failed, json.loads(critical.attrs.get("left", "[]")))
    )


def _estimate(name: str, of: Estimate, doc: str) -> dict[str, Any]:
    ends = {"": of.value, "_low": of.low, "_high": of.high}
    said = {
        "": doc,
        "_low": f"{doc}, low end of its 95 % interval",
        "_high": f"{doc}, high end of its 95 % interval",
    }
    return {f"{name}{end}": ((), value, about("1", said[end])) for end, value in ends.items()}


def _ranked(one: Array, other: Array) -> float:
    """Rank correlation of two samples after Spearman, what is beyond a range ranked there; NaN where there is none."""
    from scipy.stats import spearmanr

    size = min(one.size, other.size)
    known = ~np.isnan(one[:size]) & ~np.isnan(other[:size])
    a = one[:size][known]
    b = other[:size][known]
    if a.size < _MIN_RANKED or np.unique(a).size < 2 or np.unique(b).size < 2:
        return math.nan
    return float(spearmanr(a, b).statistic)


def _indices(plan: Margin, points: Mapping[str, "xr.Dataset"]) -> tuple[dict[str, Any], list[str]]:
    """Sobol indices of what varies, and its names; what lies beyond the range of its study counts as at its end."""
    d = len(plan.critical.design.sampled)
    rows = list[Any]()
    names = list[str]()
    study = EffectiveFriction.of(plan.critical.scene)
    seed = plan.critical.table.seed
    for name, values in friction_samples(points["indices"]).items():
        if name == DRAG or name.startswith(f"{CRITICAL_SLIP},"):
            continue
        last = study.slip_range if name == CRITICAL_SLIP else study.skidding_range
        table = np.where(np.isinf(values), last, values).reshape(-1, d + 2)
        found = indices(table[:, 0], table[:, 1], table[:, 2:].T, seed, CONFIDENCE)
        if found is not None:
            names.append(name)
            rows.append(
                (found.first, found.total, found.used, len(table), int(np.isinf(values).sum()))
            )
    variables: dict[str, Any] = {
        f"indexed_{what}": ("indexed", np.array([row[k] for row in rows]), about("1", said))
        for k, what, said in (
            (2, "rows", "rows of the design that are used"),
            (3, "asked", "rows of the design"),
            (4, "beyond", "samples beyond the range"),
        )
    }
    for k, order in enumerate(("first_order", "total_order")):
        stacked = np.array([row[k] for row in rows]).reshape(len(rows), 3, d)
        for i, end in enumerate(("", "_low", "_high")):
            said = about("1", f"Sobol index, {order.replace('_', ' ')}")
            variables[f"{order}{end}"] = ("indexed", "input"), stacked[:, i], said
    return variables, names


def _attributes(
    plan: Margin, failed: Mapping[str, Mapping[str, int]], left: Sequence[str]
) -> dict[str, Any]:
    sweep = plan.critical
    study = EffectiveFriction.of(plan.critical.scene)
    warnings = [
        f"{name}: {count} of {sum(counts.values())} points are {status}; they count as the worst and as the best"
        for name, counts in failed.items()
        for status, count in counts.items()
        if status != "ok"
    ]
    if plan.scatter:
        warnings.append(
            f"the scene has no table [uncertainty]; the scatter is the one that its data and models come with: "
            f"{'; '.join(plan.scatter)}"
        )
    return origin_of_points(
        sweep,
        warnings,
        left,
        study="uncertainty",
        probability=plan.probability,
        slip_range=study.skidding_range,
        search_range_hint=search_range_hint(
            f"{study.table}.skidding_range", study.skidding_range, MAX_CAGE_SLIP
        ),
        curves_with=CLOSURES[study.closure],
        confidence=CONFIDENCE,
        min_samples=min_samples(plan.probability, REPLICATES, plan.confidence),
        acceptable_slip=SteadySlip.of(sweep.scene).acceptable_slip or "",
        until=plan.until if plan.until is not None else "",
        points=failed,
    )
