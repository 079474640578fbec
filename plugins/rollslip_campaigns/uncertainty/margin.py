"""Estimate how scattering data change the drag reserve, the steady slip and the minimum load, and the allowable slip.

Method: randomized quasi-Monte Carlo, by sweeps over samples of the uncertain data.

1. Draw samples as points of eight Sobol sequences in turn, each scrambled independently; the differences between the
   sequences give the confidence intervals of the quantiles (`rollslip_campaigns.uncertainty.estimators.quantile`).
2. Compute the study effective-friction for a batch of samples. Each batch has as many samples as all batches before it,
   because a sequence of 2^k points begins with that of 2^(k-1).
3. Estimate the allowable slip. Stop where its interval is narrow enough (``until``); by default where the 95 %
   intervals of the bounds of slip and reserve have two ends, or where another batch would take too long. A given number
   of samples is computed in one run.
   Unless all samples are requested as a whole, only the first ones are computed so. Of the others the torques of the
   rollers at a few slips give slip and reserve (`rollslip_campaigns.uncertainty.emulator`). Where the error of that is
   too large more samples are computed as a whole, in the end all of them.
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
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import MAX_CAGE_SLIP, search_range_hint
from rollslip.bearing.raceway import Array
from rollslip.errors import RollslipError
from rollslip.results.curves import or_none
from rollslip.results.dataset import UNITS, about, save, xr
from rollslip.results.text import Status, duration_range
from rollslip.scene.changes import evolve
from rollslip.structure import raise_problem_if, raise_problems
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.result import origin_of_points
from rollslip_campaigns.sweep.run import Progress, requested_engine
from rollslip_campaigns.sweep.sampling import REPLICATES
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_campaigns.uncertainty import UncertaintySettings
from rollslip_campaigns.uncertainty.emulation import (
    TORQUES,
    EmulatedSamples,
    emulate_samples,
    equivalent_samples,
    is_worthwhile,
    probability_variables,
)
from rollslip_campaigns.uncertainty.estimators import (
    Estimate,
    estimate_variables,
    indices,
    min_samples,
    quantile,
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
from rollslip_campaigns.uncertainty.samples import (
    CRITICAL_SLIP,
    friction_samples,
    minimum_loads,
)
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.steady_slip.evaluated import slip_with_play
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.variation.scatter import with_scatter

__all__ = ["RESULT", "Margin", "expected_seconds", "plan_margin", "run_margin"]

#: Name of the file with the result, in the folder of the sweeps.
RESULT: Final = "uncertainty.nc"
#: Confidence of the intervals that are reported. With 99 % intervals of many samples are a third wider. Chosen: the
#: usual 95 %.
CONFIDENCE: Final = 0.95
#: Confidence of the intervals of quantiles where the samples end at a width (``until``). Such a stop favours intervals
#: that are narrow by chance, which costs up to 4 percentage points of coverage (docs/tables/margin_coverage.csv): with
#: 0.975 the intervals still hold with 95 %. With 0.95 they would not; closer to 1 they need more samples than
#: necessary.
STOPPING_CONFIDENCE: Final = 0.975
#: Samples of the first batch where a width is requested (``until``); a batch ends at 256, 512, 1024, ... samples. Twice
#: as many can make such a run compute up to 256 samples too many. Chosen: 32 samples of each of eight sequences, enough
#: for the interval that is compared with the width, and a power of two, as Sobol sequences need.
_FIRST_BATCH = 256
#: Maximum number of samples with ``until``, which bounds the time of a run whose interval stays wider. Twice as many
#: make the interval at the maximum narrower by about 1/sqrt(2), for twice the time. Chosen.
_MAX_SAMPLES = 16384
#: Samples of the first batch where no number is given, at most `_FIRST_BATCH`. Twice as many double the time of a
#: default run. Chosen: a power of two above the 72 samples that a 5 % quantile needs for two finite bounds
#: (`rollslip_campaigns.uncertainty.estimators.min_samples`).
_DEFAULT_SAMPLES = 128
#: Default maximum number of samples. Twice as many double the time where points fail, so that intervals stay open.
#: Chosen: three times the 336 samples that a 1 % quantile, the outermost that is usually requested, needs for two
#: finite bounds, so that two of three samples may fail.
_MAX_DEFAULT_SAMPLES = 1024
#: By default no batch of samples begins that would end later than this [s]. Twice as much lets a run of slow points
#: take 20 min for twice as many samples. Chosen: a user waits as long.
_MAX_SECONDS = 600.0
#: Default number of samples of the minimum load, for which a point is a search over loads. Twice as many double its
#: time. Chosen: enough for the median. The ends of a 90 % band have two finite bounds from 72 samples on
#: (`rollslip_campaigns.uncertainty.estimators.min_samples`); with 64 only the inner bound of each is finite.
_DEFAULT_LOADS = 64
#: Probabilities of the quantiles that are reported besides those of the requested probability p and 1 - p.
_REPORTED_PROBABILITIES: Final = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Predicates that classify a sample: known, beyond a range, unknown; in the order of the variables that count them.
_SAMPLE_KINDS: Final = (np.isfinite, np.isinf, np.isnan)
#: Variables of study effective-friction that the samples need.
_OUTPUTS: Final = ("drag_reserve", "steady_cage_slip", "skidding_slip", "limit_drag")
#: Those that emulated samples do without.
_CRITICAL_OUTPUTS: Final = ("critical_cage_slip", "critical_friction")


@attrs.frozen(eq=False, kw_only=True)
class Margin:
    """The plan of an uncertainty campaign: sweeps over the same uncertain data.

    Attributes
    ----------
    critical : Sweep
        Study effective-friction for all samples.
    load : Sweep or None
        Minimum radial loads for the first samples; None without an acceptable slip.
    varied : Sweep or None
        Study effective-friction on Saltelli's design, for Sobol indices; None if these are not requested.
    probability : float
        Probability with which the slip is to be below the one at which skidding begins.
    until : float or None
        Half width of the interval of the allowable slip at which batches end; None if it does not end them.
    by_default : bool
        Whether batches end where the intervals of the bounds have two ends.
    plain : bool
        Whether all samples are computed as a whole.
    scatter : tuple of str
        Scatter that oil, bearing and models declare, in sentences, if the samples are drawn from it.
    """

    critical: Sweep
    load: Sweep | None
    varied: Sweep | None
    probability: float
    until: float | None
    by_default: bool
    plain: bool
    scatter: tuple[str, ...]

    @property
    def sweeps(self) -> dict[str, Sweep]:
        """Sweeps of the plan, by the name of their folder."""
        sweeps = {"critical": self.critical, "load": self.load, "indices": self.varied}
        return {name: sweep for name, sweep in sweeps.items() if sweep is not None}

    @property
    def unusual(self) -> tuple[str, ...]:
        """Warnings of uncertain values that are implausible."""
        return self.critical.unusual

    @property
    def messages(self) -> list[str]:
        """Lines that describe what is sampled, and an estimate of its cost."""
        planned = dict.fromkeys(
            f"  {line}" for sweep in self.sweeps.values() for line in sweep.planned
        )
        cost = (
            f"  {name}: {duration_range(seconds)} of one core"
            for name, seconds in expected_seconds(self).items()
        )
        return [self.critical.headline, *planned, *cost]

    @property
    def first_batch(self) -> int:
        """Number of samples after which the batches may end."""
        total = len(self.critical.design.samples)
        if self.by_default:
            return min(_DEFAULT_SAMPLES, total)
        return total if self.until is None else min(_FIRST_BATCH, total)

    def is_bounded(self, critical: "xr.Dataset") -> bool:
        """Whether the intervals of the upper bound of the slip and of the lower bound of the reserve have two ends.

        An interval of a quantile beyond a range has no upper end, however many samples there are.

        Parameters
        ----------
        critical : Dataset
            Points of the samples.
        """
        values = self.friction_samples(critical)
        bounds = [(SKIDDING, 1.0 - self.probability)]
        if STEADY in values:
            bounds = [(STEADY, self.probability), (RESERVE, 1.0 - self.probability)]
        return all(
            estimate.low > -math.inf and (estimate.high < math.inf or estimate.value == math.inf)
            for estimate in (self.quantile(values[name], fraction) for name, fraction in bounds)
        )

    @property
    def confidence(self) -> float:
        """Confidence with which intervals of quantiles are computed, so that they hold with 95 %."""
        return CONFIDENCE if self.until is None else STOPPING_CONFIDENCE

    @cached_property
    def _nominal(self) -> "xr.Dataset":
        """Result of study steady-slip at the nominal values of the scene; where it has none, the status says why."""
        assembly = assemble(self.critical.scene)
        study = SteadySlip.from_scene(self.critical.scene)
        try:
            return study.completed(assembly, study.run(assembly))
        except RollslipError as error:
            return xr.Dataset({"play_status": f"{Status.NOT_KNOWN}: {error}"})

    @property
    def play_status(self) -> str:
        """What is known of the play in the pockets; empty with rollers set in the cage."""
        return str(self._nominal["play_status"].item()) if "play_status" in self._nominal else ""

    @property
    def nominal_values(self) -> dict[str, float | None]:
        """Steady slip and drag reserve at the values of the scene by quantity, None where one is not known."""
        names = {STEADY: "steady_slip", RESERVE: "drag_reserve"}
        return {
            quantity: or_none(np.append(self._nominal[name], np.nan).flat[0])
            for quantity, name in names.items()
            if name in self._nominal
        }

    def friction_samples(self, points: "xr.Dataset") -> dict[str, Array]:
        """Return the samples of study effective-friction by quantity, (n,) each, their slips with play in the pockets.

        The samples are of rollers set in the cage. A march of a roller with play takes longer than a sample.

        Parameters
        ----------
        points : Dataset
            Points of a sweep.
        """
        return self.with_play(friction_samples(points))

    def with_play(self, values: dict[str, Array]) -> dict[str, Array]:
        """Return samples by quantity, (n,) each, with the effect of play in the pockets on the slip.

        Parameters
        ----------
        values : dict of str to ndarray
            Samples of rollers set in the cage.
        """
        if STEADY in values:
            with_play = slip_with_play(self._nominal)
            values[STEADY] = np.array([with_play(slip) for slip in values[STEADY].tolist()])
        return values

    def minimum_loads(self, points: "xr.Dataset") -> Array:
        """Return the samples of the minimum load [N], (n,), with play in the pockets by its effect at nominal values.

        Parameters
        ----------
        points : Dataset
            Points of a sweep, of rollers set in the cage.
        """
        loads = minimum_loads(points)
        if float(self._nominal.get("minimum_load_without_play", np.nan)) > 0.0:
            loads *= float(
                self._nominal["minimum_load"] / self._nominal["minimum_load_without_play"]
            )
        return loads

    def quantile(self, values: Array, probability: float) -> Estimate:
        """Return a quantile of samples with its interval.

        Parameters
        ----------
        values : ndarray of float, (n,)
            Samples of one quantity; NaN where unknown, infinite where beyond a range.
        probability : float
            Probability of the quantile.
        """
        return quantile(values, probability, replicates=REPLICATES, confidence=self.confidence)


def plan_margin(requested: "UncertaintySettings") -> Margin:
    """Check the settings and plan the sweeps over the samples."""
    samples, loads = _sample_counts(requested)
    problems = []
    if not 0.5 <= requested.probability < 1.0:
        problems.append(f"probability: must be from 0.5 to below 1, not {requested.probability:g}")
    if requested.until is not None and not requested.until > 0.0:
        problems.append(
            f"until: a half width above 0 is expected, such as 0.01, not {requested.until:g}"
        )
    if loads > samples:
        problems.append(
            f"loads: the samples of the minimum load are the first of all {samples}, not {loads}"
        )
    if requested.indices and (requested.indices < 4 or requested.indices & (requested.indices - 1)):
        problems.append(
            f"indices: the design after Saltelli needs a power of two, 4 or more rows, not {requested.indices}"
        )
    if not EffectiveFriction.from_scene(requested.base_scene).skidding_range:
        problems.append(
            f"study.{EffectiveFriction.name}.skidding_range: a range is needed, such as 0.95, not 0"
        )
    raise_problems(problems)
    scene, scatter = with_scatter(requested.base_scene)
    shared: dict[str, Any] = {
        "seed": requested.seed,
        "engine": requested.engine,
        "time_limit": requested.time_limit,
    }
    outputs = (*_OUTPUTS, *_CRITICAL_OUTPUTS)
    friction = {"study": EffectiveFriction.name, "output": outputs, **shared}
    is_plain = (
        requested.plain or requested.until is not None or not is_worthwhile(requested.samples)
    )
    whole = friction if is_plain else {**friction, "output": (*_OUTPUTS, *TORQUES)}
    critical = plan_sweep(scene, samples=samples, sampling="replicated-sobol", **whole)
    _check_design(critical, requested.indices)
    requested_engine(critical)  # an unusable engine is refused before a folder is made
    if scatter:  # its ends are those that the sources of the data declare
        critical = attrs.evolve(critical, unusual=())
    return Margin(
        critical=critical,
        load=plan_sweep(
            evolve(scene, {f"study.{SteadySlip.name}.pockets": "set"}),
            samples=loads,
            sampling="replicated-sobol",
            study=SteadySlip.name,
            output=["minimum_load"],
            **shared,
        )
        if loads
        else None,
        varied=plan_sweep(scene, samples=requested.indices, sampling="saltelli", **friction)
        if requested.indices
        else None,
        probability=requested.probability,
        until=requested.until,
        by_default=requested.samples is None and requested.until is None,
        plain=is_plain,
        scatter=scatter,
    )


def _sample_counts(requested: "UncertaintySettings") -> tuple[int, int]:
    """Number of all samples, and of those of the minimum load, by default where they are not given."""
    samples = requested.samples
    if samples is None:
        samples = _MAX_DEFAULT_SAMPLES if requested.until is None else _MAX_SAMPLES
    if (loads := requested.loads) is None:
        study = requested.base_scene.study.get(SteadySlip.name)
        loads = min(_DEFAULT_LOADS, samples) if study and "acceptable_slip" in study else 0
    return samples, loads


def _check_design(sweep: Sweep, indices: int) -> None:
    """Refuse axes, which are several bearings, and Sobol indices of correlated inputs."""
    raise_problem_if(
        sweep.design.axes,
        f"sweep.over: {', '.join(axis.key for axis in sweep.design.axes)} is swept, but margins are of one "
        "bearing; take rollslip sweep run",
    )
    correlation = sweep.uncertainty.correlation
    raise_problem_if(
        indices and np.any(correlation != np.eye(len(correlation))),
        "uncertainty.correlation: Sobol indices need independent inputs, and these are correlated; leave out "
        "the indices, or the correlations",
    )


def torque_sweep(sweep: Sweep, slips: Array) -> Sweep:
    """Return the sweep over the same samples that computes the torques of their rollers at some slips alone.

    Parameters
    ----------
    sweep : Sweep
        The sweep over the samples.
    slips : ndarray of float, (K,)
        Cage slips, ascending.
    """
    return plan_sweep(
        evolve(sweep.given, {f"study.{sweep.study}.torque_slips": slips.tolist()}),
        samples=len(sweep.design.samples),
        sampling=sweep.table.sampling,
        study=sweep.study,
        output=TORQUES,
        seed=sweep.table.seed,
        engine=sweep.table.engine,
        time_limit=sweep.table.time_limit,
    )


def expected_seconds(plan: Margin) -> dict[str, float]:
    """Return an estimate of the time [s] of one core for each sweep, from the time of the scene without scatter.

    With ``until`` the estimate of sweep "critical" is an upper bound, for the maximum number of samples. It includes
    emulated samples.
    """
    counts = {name: float(len(sweep.numbers)) for name, sweep in plan.sweeps.items()}
    if not plan.plain:
        counts["critical"] = equivalent_samples(len(plan.critical.numbers))
    return {
        # two runs: the first one includes imports, and what all samples share
        name: counts[name] * min(compute(sweep.work, ((0, {}),)).rows[0].seconds for _ in range(2))
        for name, sweep in plan.sweeps.items()
    }


def run_margin(
    plan: Margin,
    folder: Path,
    *,
    print_line: Callable[[str], None] = lambda text: None,
    report: Callable[[Progress], None] = lambda progress: None,
) -> "xr.Dataset":
    """Compute the samples that the folder does not have yet, estimate the distributions and save them in the folder.

    Parameters
    ----------
    plan : Margin
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


def _allowable(plan: Margin, critical: "xr.Dataset") -> Estimate:
    """Allowable slip of the points of samples that are computed as a whole."""
    return plan.quantile(friction_samples(critical)[SKIDDING], 1.0 - plan.probability)


def _compute_batches(
    plan: Margin,
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
    count = min(_FIRST_BATCH, first)
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


def _stop_reason(plan: Margin, critical: "xr.Dataset", seconds: float) -> str:
    """Return why no more samples are computed by default; empty where more are needed and may be computed.

    Parameters
    ----------
    plan : Margin
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
    plan: Margin,
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
    plan: Margin,
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


def _indices(plan: Margin, points: Mapping[str, "xr.Dataset"]) -> tuple[dict[str, Any], list[str]]:
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
    plan: Margin, status_counts: Mapping[str, Mapping[str, int]], validity: Mapping[str, Any]
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
