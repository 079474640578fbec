"""How scattering data move what people act on: reserve of drag, steady slip, least load; and the allowable slip.

- The *reserve* is the largest drag that the rollers carry over the drags of the scene (`motion.loading_branch`). With
  probability p it is at least its quantile 1 - p. Where nothing runs away it is a lower bound; below 1 the cage skids.
- The *steady slip* is the smallest at which rollers and drags are in balance, the *least load* the radial load at which
  it is the acceptable one of the scene. Reserve, slips and running away come of one motion of each sample.
- A cage runs away at the slip where the balance of torques has its fold. The slip that is *allowable* at a probability
  p is its quantile 1 - p. The *margin* is the probability that the steady slip is below that of running away, sample by
  sample. This slip tells no good oil from a bad one: what makes it small is mostly what makes the drag there large.
- The critical slips of the curves, by the closure of the scene, are told beside it: that of a bearing is the smaller of
  those of its rings. With epicyclic rollers they are mostly larger than the slip at which the cage runs away.
- A slip beyond the range of the study is larger than all in it, and counts so. A point that failed is unknown, and
  counts as the worst and as the best that it could have been (`rollslip_campaigns.uncertainty.estimators`).
- Samples are those of eight Sobol sequences in turn, with scramblings of their own, whose differences tell how exact
  the quantiles are. They are looked at in batches, each as many as all before: a sequence of 2^k points begins with
  that of 2^(k-1). Where an interval may end them they are computed so too, else all in one run.
- All is a set of sweeps in one folder, so that the same command goes on where it was stopped.
- Data that scatter are those of the scene's table ``[uncertainty]``; without one what data and fields declare of
  themselves (`rollslip_studies.variation.scatter`).
- Sobol indices share a variance among independent inputs. With correlated ones their sums mean nothing: refused.
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
from rollslip_campaigns.uncertainty.estimators import Estimate, fewest, fraction, indices, quantile
from rollslip_campaigns.uncertainty.findings import DRAG, LOAD, RESERVE, SKIDDING, STEADY
from rollslip_campaigns.uncertainty.samples import LOWEST, fractions_of, minimum_loads, of_friction
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.variation.scatter import with_scatter

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_campaigns.uncertainty import UncertaintySettings

__all__ = ["RESULT", "Margin", "expected_seconds", "plan_margin", "run_margin"]

RESULT: Final = "uncertainty.nc"
CONFIDENCE: Final = 0.95
#: Of quantiles where samples end at a width: that favours intervals which are narrow by chance, and costs up to 4 %.
ENDING: Final = 0.975
#: Samples of the first batch, and the most where batches end by themselves.
_FIRST = 256
_MOST = 16384
_SAMPLES = 1024
_LOADS = 64
#: Fewest samples whose ranks are told.
_RANKED: Final = 8
#: Probabilities of the quantiles that are told beside that of the allowable slip.
_TOLD: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
#: What tells samples that are known, beyond a range, and unknown.
_KNOWN: Final = (np.isfinite, np.isinf, np.isnan)
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
        return CONFIDENCE if self.until is None else ENDING

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
        requested.samples if requested.samples is not None else _SAMPLES if until is None else _MOST
    )
    stated = "acceptable_slip" in scene.study.get(SteadySlip.name, {})
    loads = (
        requested.loads if requested.loads is not None else min(_LOADS, samples) if stated else 0
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
    if not EffectiveFriction.of(scene).skidding_range:
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


def expected_seconds(made: Margin) -> dict[str, float]:
    """Return the time [s] of one core that each sweep needs, if all its points are like the scene without scatter.

    With ``until`` those of running away are the most that there may be.
    """
    return {
        # the first time imports, and makes what samples share
        name: len(sweep.numbers)
        * min(compute(sweep.work, ((0, {}),)).rows[0].seconds for _ in range(2))
        for name, sweep in made.sweeps.items()
    }


def run_margin(
    made: Margin,
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
        for name, one in made.sweeps.items()
    }

    def computed(name: str, count: int | None = None) -> "xr.Dataset":
        numbers = None if count is None else range(count)
        every[name].compute(numbers)
        return every[name].collected(numbers).isel(sample=slice(count))

    batches = list[tuple[int, Estimate]]()
    total = len(made.critical.design.samples)
    count = min(_FIRST, total)
    # where no interval ends them all are computed in one run, for which workers start once
    whole = computed("critical", total) if made.until is None else None
    while True:
        critical = computed("critical", count) if whole is None else whole.isel(sample=slice(count))
        allowed = made.quantile(of_friction(critical)[SKIDDING], 1.0 - made.probability)
        batches.append((count, allowed))
        said(f"{count} samples: {_so_far(allowed)}")
        # more samples make no end known that lies beyond the range
        if count == total or (
            made.until is not None and (allowed.low == math.inf or allowed.half_width <= made.until)
        ):
            break
        count = min(2 * count, total)
    points = {"critical": critical}
    if made.load is not None:
        points["load"] = computed("load", min(len(made.load.design.samples), count))
    if made.varied is not None:
        points["indices"] = computed("indices")
    dataset = _dataset(made, batches, points)
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
    made: Margin, batches: list[tuple[int, Estimate]], points: Mapping[str, "xr.Dataset"]
) -> "xr.Dataset":
    import xarray as xr

    critical = points["critical"]
    n = batches[-1][0]
    values = of_friction(critical)
    variables = dict[str, Any]()
    if STEADY in values:
        slip = values[STEADY]
        away = values[SKIDDING]
        fractions = fractions_of(critical)
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
    probabilities = tuple(sorted({*_TOLD, round(1.0 - made.probability, 12), made.probability}))
    quantiles = np.array(
        [[attrs.astuple(made.quantile(one, p)) for p in probabilities] for one in values.values()]
    )
    over = ("quantity", "probability")
    counts = np.array([[one.size, *(of(one).sum() for of in _KNOWN)] for one in values.values()])
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
            made.critical.design.samples[:n].T,
            about("SI", "value of an uncertain quantity"),
        ),
    }
    acted = [name for name in (RESERVE, STEADY, LOAD, SKIDDING) if name in values]
    ranks = np.array(
        [
            [_ranked(column, values[name]) for name in acted]
            for column in made.critical.design.samples.T
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
        "input": ("input", np.array(made.critical.design.keys), about("1", "what is uncertain")),
    }
    if made.varied is not None:
        found, names = _indices(made, points)
        variables |= found
        coords["indexed"] = ("indexed", np.array(names), about("1", "what the indices are of"))
    ended = {name: Counter(one["status"].to_numpy().tolist()) for name, one in points.items()}
    failed = {name: dict(sorted(counts.items())) for name, counts in ended.items()}
    return xr.Dataset(
        variables, coords, _attributes(made, failed, json.loads(critical.attrs.get("left", "[]")))
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
    if a.size < _RANKED or np.unique(a).size < 2 or np.unique(b).size < 2:
        return math.nan
    return float(spearmanr(a, b).statistic)


def _indices(made: Margin, points: Mapping[str, "xr.Dataset"]) -> tuple[dict[str, Any], list[str]]:
    """Sobol indices of what varies, and its names; what lies beyond the range of its study counts as at its end."""
    d = len(made.critical.design.sampled)
    rows = list[Any]()
    names = list[str]()
    study = EffectiveFriction.of(made.critical.scene)
    seed = made.critical.table.seed
    for name, values in of_friction(points["indices"]).items():
        if name == DRAG or name.startswith(f"{LOWEST},"):
            continue
        last = study.slip_range if name == LOWEST else study.skidding_range
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
    made: Margin, failed: Mapping[str, Mapping[str, int]], left: Sequence[str]
) -> dict[str, Any]:
    sweep = made.critical
    study = EffectiveFriction.of(made.critical.scene)
    warnings = [
        f"{name}: {count} of {sum(counts.values())} points are {status}; they count as the worst and as the best"
        for name, counts in failed.items()
        for status, count in counts.items()
        if status != "ok"
    ]
    if made.scatter:
        warnings.append(
            f"the scene has no table [uncertainty]; the scatter is the one that its data and models come with: "
            f"{'; '.join(made.scatter)}"
        )
    return origin_of_points(
        sweep,
        warnings,
        left,
        study="uncertainty",
        probability=made.probability,
        slip_range=study.skidding_range,
        search_range_hint=search_range_hint(
            f"{study.table}.skidding_range", study.skidding_range, MAX_CAGE_SLIP
        ),
        curves_with=CLOSURES[study.closure],
        confidence=CONFIDENCE,
        fewest_samples=fewest(made.probability, REPLICATES, made.confidence),
        acceptable_slip=SteadySlip.of(sweep.scene).acceptable_slip or "",
        until=made.until if made.until is not None else "",
        points=failed,
    )
