"""Estimate how scattering data change the drag reserve, the steady slip and the minimum load, and the allowable slip.

Method: randomized quasi-Monte Carlo, by sweeps over samples of the uncertain data.

1. Draw samples as points of eight Sobol sequences in turn, each scrambled independently; the differences between the
   sequences give the confidence intervals of the quantiles (`rollslip_campaigns.uncertainty.estimators.quantile`).
2. Compute the study effective-friction for a batch of samples. Each batch has as many samples as all batches before it,
   because a sequence of 2^k points begins with that of 2^(k-1).
3. Estimate the allowable slip. Stop where its interval is narrow enough (``until``); by default where the 95 %
   intervals of the bounds of slip and reserve have two ends, or where another batch would take too long. A given number
   of samples is computed in one run.
   Of a given number of samples from 512 on only the first ones are computed as a whole, unless all are requested so. Of
   the others the torques of the rollers at a few slips give slip and reserve
   (`rollslip_campaigns.uncertainty.emulator`). Where the error of that is too large more samples are computed as a
   whole, in the end all of them.
4. Compute the minimum load for the first samples, and Saltelli's design for Sobol indices, if they are requested.
5. Estimate quantiles, probabilities and rank correlations, and save them as a dataset.

Quantities:

- The *drag reserve* is the limit drag torque of the rollers divided by the drags of the scene
  (`rollslip_studies.motion.loading_branch`). With probability p it is at least its quantile 1 - p. Where skidding does
  not begin in the range it is a lower bound; below 1 the cage skids.
- The *steady slip* is the smallest slip at which rollers and drags are in balance. The *minimum load* is the radial
  load at which the steady slip is the acceptable slip of the scene. Reserve, slips and skidding of a sample follow from
  one loading branch.
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
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.bearing.raceway import Array
from rollslip.results.dataset import UNITS, about, save, xr
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress
from rollslip_campaigns.sweep.sampling import REPLICATES
from rollslip_campaigns.uncertainty.emulation import (
    EmulatedSamples,
    emulate_samples,
    probability_variables,
)
from rollslip_campaigns.uncertainty.estimators import (
    Estimate,
    estimate_variables,
    indices,
    min_samples,
    rank_correlation,
)
from rollslip_campaigns.uncertainty.findings import (
    DRAG,
    LOAD,
    QUANTITY_UNITS,
    RESERVE,
    SKIDDING,
    STEADY,
)
from rollslip_campaigns.uncertainty.plan import (
    CONFIDENCE,
    FIRST_BATCH,
    UncertaintyPlan,
    torque_sweep,
)
from rollslip_campaigns.uncertainty.samples import (
    CRITICAL_SLIP,
    friction_samples,
)
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["RESULT", "run_uncertainty"]

#: Name of the file with the result, in the folder of the sweeps.
RESULT: Final = "uncertainty.nc"
#: By default no batch of samples begins that would end later than this [s]. Twice as much lets a run of slow points
#: take 20 min for twice as many samples. Chosen: a user waits as long.
_MAX_SECONDS = 600.0
#: Probabilities of the quantiles that are reported besides those of the requested probability p and 1 - p.
_REPORTED_PROBABILITIES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Predicates that classify a sample: known, beyond a range, unknown; in the order of the variables that count them.
_SAMPLE_KINDS: Final = (np.isfinite, np.isinf, np.isnan)


def run_uncertainty(
    plan: UncertaintyPlan,
    folder: Path,
    *,
    print_line: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute the samples that the folder does not have yet, estimate the distributions and save them in the folder.

    Parameters
    ----------
    plan : UncertaintyPlan
        The sweeps and the requested probability.
    folder : Path
        Folder of the sweeps and of the result; a run with the same plan continues there.
    print_line : callable
        Takes a line of text on the progress.
    report : callable
        Takes the progress of the sweep that is computed.

    Returns
    -------
    xarray.Dataset
        As described in `rollslip_campaigns.uncertainty.UncertaintySettings`; NaN is unknown, infinite beyond a range.
    """
    folder.mkdir(parents=True, exist_ok=True)

    def points_of(name: str, sweep: Sweep) -> Points:
        return Points.in_folder(
            sweep, folder / name, lambda text: print_line(f"{name}: {text}"), report
        )

    computed = {name: points_of(name, sweep) for name, sweep in plan.sweeps.items()}

    def compute_samples(name: str, count: int | None = None) -> "xr.Dataset":
        numbers = None if count is None else range(count)
        computed[name].compute(numbers)
        return computed[name].collect(numbers).isel(sample=slice(count))

    def compute_torques(slips: Array, numbers: range) -> "xr.Dataset":
        points = points_of("torques", torque_sweep(plan.critical, slips))
        points.compute(numbers)
        return points.collect(numbers).isel(sample=slice(numbers.start, numbers.stop))

    points = dict[str, xr.Dataset]()
    emulated = None
    if not plan.plain:
        emulated = emulate_samples(
            len(plan.critical.design.samples),
            partial(compute_samples, "critical"),
            compute_torques,
        )
    if emulated is None:
        batches, stop = _compute_batches(plan, compute_samples, print_line)
        count = batches[-1][0]
        critical = compute_samples("critical", count)
    else:
        critical = emulated.critical
        points["torques"] = emulated.torques
        count = critical.sizes["sample"]
        batches = [(count, _allowable(plan, critical))]
        stop = emulated.description
    points = {"critical": critical, **points}
    if plan.load is not None:
        points["load"] = compute_samples("load", len(plan.load.design.samples))
    if plan.varied is not None:
        points["indices"] = compute_samples("indices")
    dataset = _dataset(plan, batches, points, emulated)
    is_bounded = emulated is not None or plan.is_bounded(critical)
    dataset.attrs |= {"stop": stop, "more_samples": 0 if is_bounded else 2 * count}
    save(dataset, folder / RESULT)
    return dataset


def _allowable(plan: UncertaintyPlan, critical: "xr.Dataset") -> Estimate:
    """Allowable slip of the points of samples that are computed as a whole."""
    return plan.quantile(friction_samples(critical)[SKIDDING], 1.0 - plan.probability)


def _compute_batches(
    plan: UncertaintyPlan,
    compute_samples: Callable[[str, int], "xr.Dataset"],
    print_line: Callable[[str], None],
) -> tuple[list[tuple[int, Estimate]], str]:
    """Compute batches of samples as a whole; return their sizes with the allowable slips, and why they end."""
    start_time = time.monotonic()
    batches = list[tuple[int, Estimate]]()
    total = len(plan.critical.design.samples)
    first = plan.first_batch
    # a given number of samples is computed in one run, for which workers start once
    all_samples = compute_samples("critical", total) if first == total else None
    count = min(FIRST_BATCH, first)
    while True:
        critical = compute_samples("critical", count) if all_samples is None else all_samples
        critical = critical.isel(sample=slice(count))
        allowable = _allowable(plan, critical)
        batches.append((count, allowable))
        print_line(f"{count} samples: {_describe_allowable(allowable)}")
        # the next batch takes about as long as all before it
        seconds = 2.0 * (time.monotonic() - start_time)
        stop = _stop_reason(plan, critical, seconds) if plan.by_default else ""
        # a bound beyond the range stays there, however many samples there are
        is_narrow = plan.until is not None and (
            allowable.low == math.inf or allowable.half_width <= plan.until
        )
        if count == total or is_narrow or stop:
            return batches, stop
        count = min(2 * count, total)


def _stop_reason(plan: UncertaintyPlan, critical: "xr.Dataset", seconds: float) -> str:
    """Return why no more samples are computed by default; empty where more are needed and may be computed.

    Parameters
    ----------
    plan : UncertaintyPlan
        The plan.
    critical : Dataset
        Points of the samples so far.
    seconds : float
        Time [s] at which another batch would end.
    """
    count = critical.sizes["sample"]
    intervals = f"{100.0 * CONFIDENCE:.0f} % intervals"
    if plan.is_bounded(critical):
        return f"{count} samples, enough for {intervals} of all bounds"
    if count == len(plan.critical.design.samples):
        return f"{count} samples, the maximum by default: too few for {intervals} of all bounds"
    if seconds > _MAX_SECONDS:
        minutes = f"{_MAX_SECONDS / 60.0:.0f} min"
        return f"{count} samples within {minutes}, too few for {intervals} of all bounds"
    return ""


def _describe_allowable(allowable: Estimate) -> str:
    """Allowable slip and its interval in one short line, whether or not its bounds lie in the range."""
    if math.isnan(allowable.value):
        return "none has a result"
    beyond = {math.inf: "beyond the range", -math.inf: "not known"}
    value, low, high = (
        beyond.get(slip, f"{100.0 * slip:.4g} %") for slip in attrs.astuple(allowable)
    )
    return f"allowable slip {value}, {100.0 * CONFIDENCE:.0f} %: {low} to {high}"


# Estimates from the samples ------------------------------------------------------------------------------------------


def _dataset(
    plan: UncertaintyPlan,
    batches: list[tuple[int, Estimate]],
    points: Mapping[str, "xr.Dataset"],
    emulated: EmulatedSamples | None,
) -> "xr.Dataset":
    """Dataset of all estimates, from the batches (samples, allowable slip) and the points of each sweep."""
    critical = points["critical"]
    n = batches[-1][0]
    values = plan.friction_samples(critical)
    variables = dict[str, Any]()
    if STEADY in values:
        variables |= probability_variables(critical, values, emulated, CONFIDENCE)
    if emulated is not None:
        values |= plan.with_play(dict(emulated.values))
        n = values[STEADY].size
    if "load" in points:  # the minimum load is the third quantity
        values = {
            **{key: values.pop(key) for key in (RESERVE, STEADY) if key in values},
            LOAD: plan.minimum_loads(points["load"]),
            **values,
        }
    variables |= estimate_variables("allowable", batches[-1][1], "allowable slip")
    variables["allowable_slip"] = variables.pop("allowable")
    probabilities = sorted(
        {*_REPORTED_PROBABILITIES, round(1.0 - plan.probability, 12), plan.probability}
    )
    variables |= _distributions(plan, values, probabilities, n, emulated)
    # convergence: the allowable slip after each batch
    allowable = np.array([attrs.astuple(estimate) for _, estimate in batches])
    acted = [name for name in (RESERVE, STEADY, LOAD, SKIDDING) if name in values]
    ranks = [
        [rank_correlation(column, values[name]) for name in acted]
        for column in plan.critical.design.samples.T
    ]
    variables |= {
        "batch_samples": (
            "batch",
            np.array([count for count, _ in batches]),
            about("1", "samples"),
        ),
        "batch_allowable": ("batch", allowable[:, 0], about("1", "allowable slip")),
        "batch_low": ("batch", allowable[:, 1], about("1", "low end of its interval")),
        "batch_high": ("batch", allowable[:, 2], about("1", "high end of its interval")),
        "input_value": (
            ("input", "sample"),
            plan.critical.design.samples[:n].T,
            about("SI", "value of an uncertain quantity"),
        ),
        "rank_correlation": (
            ("input", "acted"),
            np.array(ranks),
            about("1", "rank correlation of an uncertain quantity with what is acted on"),
        ),
        "strength_correlation": (
            (),
            rank_correlation(values[SKIDDING], values[DRAG]),
            about(
                "1",
                "rank correlation of the slip at which skidding begins and the limit drag torque",
            ),
        ),
    }
    units = {item.key: item.unit or "1" for item in plan.critical.design.sampled}
    coords: dict[str, Any] = {
        "acted": ("acted", np.array(acted), about("1", "what is acted on")),
        "quantity": (
            "quantity",
            np.array(list(values)),
            about("1", "what it is") | {UNITS: json.dumps(QUANTITY_UNITS)},
        ),
        "probability": (
            "probability",
            np.array(probabilities),
            about("1", "fraction of the distribution below"),
        ),
        "input": (
            "input",
            np.array(plan.critical.design.keys),
            about("1", "what is uncertain") | {UNITS: json.dumps(units)},
        ),
    }
    if plan.varied is not None:
        index_variables, names = _indices(plan, points)
        variables |= index_variables
        coords["indexed"] = ("indexed", np.array(names), about("1", "what the indices are of"))
    status_counts = {
        name: dict(sorted(Counter(sweep_points["status"].to_numpy().tolist()).items()))
        for name, sweep_points in points.items()
    }
    return xr.Dataset(
        variables,
        coords,
        _attributes(plan, status_counts, json.loads(critical.attrs.get("validity", "{}"))),
    )


def _distributions(
    plan: UncertaintyPlan,
    values: Mapping[str, Array],
    probabilities: Sequence[float],
    n: int,
    emulated: EmulatedSamples | None,
) -> dict[str, Any]:
    """Variables of the samples of all quantities, of their quantiles and of the numbers of known and unknown ones."""
    table = np.full((len(values), n), np.nan)
    for row, samples in zip(table, values.values(), strict=True):
        row[: samples.size] = samples

    def estimate(name: str, probability: float) -> Estimate:
        if emulated is None:
            return plan.quantile(values[name], probability)
        return emulated.widen(name, plan.quantile(values[name], probability))

    quantiles = np.array(
        [[attrs.astuple(estimate(name, p)) for p in probabilities] for name in values]
    )
    dims = ("quantity", "probability")
    counts = np.array(
        [
            [samples.size, *(is_kind(samples).sum() for is_kind in _SAMPLE_KINDS)]
            for samples in values.values()
        ]
    )
    whole = counts[:, 0].copy()
    if emulated is not None:
        whole[np.isin(list(values), list(emulated.values))] = emulated.critical.sizes["sample"]
    return {
        "computed": ("quantity", whole, about("1", "samples computed as a whole")),
        "value": (
            ("quantity", "sample"),
            table,
            about("1", f"value of a sample, number k of scrambling k mod {REPLICATES}"),
        ),
        "quantile_value": (dims, quantiles[..., 0], about("1", "quantile of the known samples")),
        "quantile_low": (dims, quantiles[..., 1], about("1", "low end of its 95 % interval")),
        "quantile_high": (dims, quantiles[..., 2], about("1", "high end of its 95 % interval")),
        "samples": ("quantity", counts[:, 0], about("1", "samples")),
        "known": ("quantity", counts[:, 1], about("1", "known")),
        "beyond": ("quantity", counts[:, 2], about("1", "beyond")),
        "unknown": ("quantity", counts[:, 3], about("1", "unknown")),
    }


def _indices(
    plan: UncertaintyPlan, points: Mapping[str, "xr.Dataset"]
) -> tuple[dict[str, Any], list[str]]:
    """Variables of the Sobol indices, and the quantities that have some; infinite values count as the largest."""
    d = len(plan.critical.design.sampled)
    rows = list[Any]()
    names = list[str]()
    study = EffectiveFriction.from_scene(plan.critical.scene)
    for name, values in plan.friction_samples(points["indices"]).items():
        if name == DRAG or name.startswith(f"{CRITICAL_SLIP},"):
            continue
        last = study.slip_range if name == CRITICAL_SLIP else study.skidding_range
        if name == RESERVE:  # of a cage that nothing drags
            last = np.max(values, where=np.isfinite(values), initial=1.0)
        table = np.where(np.isinf(values), last, values).reshape(-1, d + 2)
        estimates = indices(
            table[:, 0], table[:, 1], table[:, 2:].T, plan.critical.table.seed, CONFIDENCE
        )
        if estimates is not None:
            names.append(name)
            rows.append(
                (
                    estimates.first,
                    estimates.total,
                    estimates.used,
                    len(table),
                    int(np.isinf(values).sum()),
                )
            )
    variables: dict[str, Any] = {
        f"indexed_{suffix}": ("indexed", np.array([row[k] for row in rows]), about("1", long_name))
        for k, suffix, long_name in (
            (2, "rows", "rows of the design that are used"),
            (3, "requested", "rows of the design"),
            (4, "beyond", "samples beyond the range"),
        )
    }
    for k, order in enumerate(("first_order", "total_order")):
        stacked = np.array([row[k] for row in rows]).reshape(len(rows), 3, d)
        for i, suffix in enumerate(("", "_low", "_high")):
            variables[f"{order}{suffix}"] = (
                ("indexed", "input"),
                stacked[:, i],
                about("1", f"Sobol index, {order.replace('_', ' ')}"),
            )
    return variables, names


def _attributes(
    plan: UncertaintyPlan,
    status_counts: Mapping[str, Mapping[str, int]],
    validity: Mapping[str, Any],
) -> dict[str, Any]:
    """Attributes of the dataset: origin, warnings, and the settings that its sentences need."""
    study = EffectiveFriction.from_scene(plan.critical.scene)
    warnings = [
        f"{name}: {count} of {sum(counts.values())} points are {status}; they count as the worst and as the best"
        for name, counts in status_counts.items()
        for status, count in counts.items()
        if status != "ok"
    ]
    return origin_of_points(
        plan.critical,
        warnings,
        validity,
        study="uncertainty",
        probability=plan.probability,
        slip_range=study.skidding_range,
        search_range_hint=search_range_hint(
            f"{study.table}.skidding_range", study.skidding_range, MAX_CAGE_SLIP
        ),
        curves_with=CLOSURES[study.closure],
        confidence=CONFIDENCE,
        min_samples=min_samples(plan.probability, REPLICATES, plan.confidence),
        acceptable_slip=SteadySlip.from_scene(plan.critical.scene).acceptable_slip or "",
        play_status=plan.play_status,
        nominal=json.dumps(plan.nominal_values),
        until=plan.until or "",
        scatter="; ".join(plan.scatter),
        points=status_counts,
    )
