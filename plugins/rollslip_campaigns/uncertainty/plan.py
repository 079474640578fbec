"""Plan an uncertainty campaign: sweeps over the same uncertain data, and when their batches end."""

import math
from functools import cached_property
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import Array
from rollslip.errors import RollslipError
from rollslip.results.curves import or_none
from rollslip.results.dataset import xr
from rollslip.results.text import Status, duration_range
from rollslip.scene.changes import evolve
from rollslip.structure import raise_problem_if, raise_problems
from rollslip_campaigns.sweep.definition import Sweep
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.sweep.run import requested_engine
from rollslip_campaigns.sweep.sampling import REPLICATES
from rollslip_campaigns.sweep.sweep import plan_sweep
from rollslip_campaigns.uncertainty import UncertaintySettings
from rollslip_campaigns.uncertainty.emulation import (
    TORQUES,
    equivalent_samples,
    is_worthwhile,
)
from rollslip_campaigns.uncertainty.estimators import (
    Estimate,
    quantile,
)
from rollslip_campaigns.uncertainty.findings import (
    RESERVE,
    SKIDDING,
    STEADY,
)
from rollslip_campaigns.uncertainty.samples import (
    friction_samples,
    minimum_loads,
)
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.steady_slip.evaluated import slip_with_play
from rollslip_studies.steady_slip.study import SteadySlip
from rollslip_studies.variation.scatter import with_scatter

__all__ = [
    "CONFIDENCE",
    "FIRST_BATCH",
    "UncertaintyPlan",
    "expected_seconds",
    "plan_uncertainty",
    "torque_sweep",
]

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
FIRST_BATCH: Final = 256
#: Maximum number of samples with ``until``, which bounds the time of a run whose interval stays wider. Twice as many
#: make the interval at the maximum narrower by about 1/sqrt(2), for twice the time. Chosen.
_MAX_SAMPLES = 16384
#: Samples of the first batch where no number is given, at most `FIRST_BATCH`. Twice as many double the time of a
#: default run. Chosen: a power of two above the 72 samples that a 5 % quantile needs for two finite bounds
#: (`rollslip_campaigns.uncertainty.estimators.min_samples`).
_DEFAULT_SAMPLES = 128
#: Default maximum number of samples. Twice as many double the time where points fail, so that intervals stay open.
#: Chosen: three times the 336 samples that a 1 % quantile, the outermost that is usually requested, needs for two
#: finite bounds. Failed samples count as smallest and as largest, so that few of them open such a quantile.
_MAX_DEFAULT_SAMPLES = 1024
#: Default number of samples of the minimum load, for which a point is a search over loads. Twice as many double its
#: time. Chosen: enough for the median. The ends of a 90 % band have two finite bounds from 72 samples on
#: (`rollslip_campaigns.uncertainty.estimators.min_samples`); with 64 only the inner bound of each is finite.
_DEFAULT_LOADS = 64
#: Variables of study effective-friction that the samples need.
_OUTPUTS: Final = ("drag_reserve", "steady_cage_slip", "skidding_slip", "limit_drag")
#: Those that emulated samples do without.
_CRITICAL_OUTPUTS: Final = ("critical_cage_slip", "critical_friction")


@attrs.frozen(eq=False, kw_only=True)
class UncertaintyPlan:
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
        return total if self.until is None else min(FIRST_BATCH, total)

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


def plan_uncertainty(requested: "UncertaintySettings") -> UncertaintyPlan:
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
    return UncertaintyPlan(
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
        f"sweep.over: {', '.join(axis.key for axis in sweep.design.axes)} is swept, but uncertainty is estimated "
        "for one bearing; take rollslip sweep run",
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


def expected_seconds(plan: UncertaintyPlan) -> dict[str, float]:
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
