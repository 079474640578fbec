"""Find the loading branch: motions of the rollers while the drag on the cage is raised from zero, and where they jump.

A *motion* is a periodic solution of the roller spins at a fixed cage slip S. To *march* is to follow rollers in time,
orbit by orbit, from a start until their spins repeat; the branch is not continued by a predictor and corrector.

There may be several motions at a slip. Where the traction of a roller has passed its maximum, the roller may stick to
the inner ring and slide on the outer one, or the other way round: an imperfect pitchfork bifurcation. The motion at
small slips continues on one of both branches. The other branch starts at a fold, which only a cage that comes from
larger slips can reach.

The cage slip *jumps* at a maximum of the torque, where a larger drag has no steady slip nearby. It is a limit point,
with the drag as parameter. There are two kinds: a smooth maximum, and the end of a motion, a fold with S as parameter.
Neighbouring motions tell which it is: beside an end they differ by more than `motion.spins.CONTINUES`, which
`Motion.is_continuous` stores.

The abscissa of the search is x = logit(S) = ln(S/(1 - S)), in which the torque bends about equally at all slips:

1. On a grid uniform in x, find the motions that rollers reach from rolling on either ring, by marching them to a
   periodic solution (`rollslip_studies.motion.spins`). Where both marches agree, the motion is unique.
2. Start at the smallest slip. At each next slip take the motion that is nearest to the previous one, by the
   load-weighted L1 distance of their roller slips.
3. Where there are two motions, march from the previous motion. If that reaches another motion than the nearest one,
   only that motion remains at this slip, and step 2 is repeated.
4. Drop motions that did not converge, and isolated ones.
5. Bisect the intervals beside a maximum of the torque, and those in which a motion ends, while a bound on the torque
   inside exceeds the running maximum by 0.1 %.
6. A motion from which the torque falls by more than 0.2 % before it is exceeded is a candidate for a jump.
7. At a smooth maximum, find the vertex of the polynomial through the samples, at first the three around the largest
   one, evaluate the torque there, and repeat this with the new sample, up to nine samples. At the end of a motion,
   take the last sample.
8. Repeat step 7 with four times as many positions of the orbit, the *finer* ones; those of the search are *coarse*.
   The stated error is the change, undivided, plus the largest error of interpolation and discretisation: Richardson
   extrapolation would divide the change, but errors decrease irregularly with the number of positions. A maximum that
   finer positions do not have is dropped.
9. Find the slip to which the cage jumps: the next one with as much torque as the maximum, both on coarse positions.
10. Skidding starts at the first jump which leads to a slip above `SKIDDING_SLIP`, or after which no slip carries the
    drag. A jump that starts above `SKIDDING_SLIP` counts only if it at least doubles the slip.

The slips are chosen by the bearing and the range alone, so that the result does not depend on earlier calls.
Roots are found by regula falsi (Illinois) and secants, `rollslip.search`, which also limits their number of steps; that
of step 7 is `SearchTolerances.n_samples`. Steps 2 to 5 need no limit: each repetition of step 2 leaves one motion
at a slip that had two, and bisection ends at `SearchTolerances.gap_width`.

References
----------
M. Dowell, P. Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11 (1971) 168-174.
R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. (2010): folds and imperfect pitchforks.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip.search import illinois_root, polynomial_maximum, secant_root
from rollslip_studies.motion.spins import (
    DISTINCT,
    Motion,
    Motions,
    logit_slip,
    slip_from_logit,
)


@attrs.frozen(kw_only=True)
class SearchTolerances:
    """Numbers that control the search for the loading branch.

    Effects of half and twice a value were measured on 79 random bearings of tests/support/loading_branch_scenes.py,
    with 45 jumps, if no other set is named. Their largest torques have a stated error of 0.14 % in the median and
    6.5 % at most. "No effect" means that no slip, torque or jump of these changes, and "within the errors" that
    torques change by less than their error. Each value has a test in tests/motion/test_loading_branch.py which fails
    with half or twice of it, most with a constructed torque.
    """

    #: Smallest cage slip of the grid. Half and twice the value change largest torques by up to 1.3e-3, within the
    #: errors, and the cost by 5 %; chosen, far below the slips of jumps that matter.
    smallest_slip: float = 1e-4
    #: Largest step of the grid in logit(S). Twice the value saves 35 % of the evaluations but misses a jump, and
    #: changes a torque by 2.5 %; half the value costs 75 % more and changes torques within the errors.
    grid_step: float = 0.25
    #: Width in logit(S) at which bisections end: `grid_step` / 512, after nine of them. It is also the distance within
    #: which a slip is at the end of the branch. Half and twice the value change largest torques by up to 4e-5 and 8e-5;
    #: chosen, below `equal_drag`, because a torque in proportion to the slip rises in a gap by the width, relative to
    #: itself.
    gap_width: float = 0.25 / 512.0
    #: Relative difference up to which torques count as equal, so that no interval is bisected for less. The first
    #: samples of a maximum on finer positions are where the torque has fallen by as much. With twice the value the
    #: search passes over a step of the torque in one bearing: its largest torque changes by 4.6 %, and the stated error
    #: of that from 1.3 % to 13 %. Half the value costs 1 % and changes torques by up to 2e-4, in one of 80 other
    #: bearings by 9e-4, within its stated error of 0.8 %.
    equal_drag: float = 1e-3
    #: Safety factor on the second derivative, taken from samples, that bounds the torque in an interval: between them
    #: it may be larger. Half the value passes over the same step as twice `equal_drag`, twice the value costs 1 % and
    #: changes torques by up to 2e-5.
    curvature_factor: float = 2.0
    #: Largest rate -dln(T)/dlogit(S) at which the torque T is assumed to fall behind a gap, where T is in excess of
    #: the resistance without slip (`_bound_in_gap`). Neither half nor twice the value changes a result of 62 random
    #: bearings; chosen, half the rate 1 at which a torque in proportion to the slip rises.
    fall_in_gap: float = 0.5
    #: Relative fall of the torque before it is exceeded from which on a motion is a maximum. Half the value adds a
    #: jump, twice the value drops two; chosen, twice `equal_drag`, because smaller falls are within the errors.
    min_fall: float = 2e-3
    #: Relative fall up to which finer positions check whether there is one. Half the value has no effect, twice the
    #: value costs 0.1 %; chosen, ten times `min_fall`.
    shallow_fall: float = 0.02
    #: Relative difference of a sample and the vertex that predicted it at which the vertex is accepted. Half and
    #: twice the value change torques by up to 2e-6; chosen, far below the errors.
    vertex: float = 1e-6
    #: Largest number of samples of a vertex, and number in a pass on finer positions at the end of a motion. Half as
    #: many leave an error of the torque of 4e-4, twice as many cost up to 18 % and change it by up to 3e-5; chosen: the
    #: polynomial of a vertex begins with three samples, up to six more correct it.
    n_samples: int = 9
    #: Ratio of finer to coarse positions of the orbit. Two instead of four change largest torques by up to 0.5 %,
    #: in four bearings by more than the errors, and the cost of finer positions is proportional; eight change them
    #: by up to 0.2 %.
    position_factor: int = 4
    #: Loads of a Gauss rule that stand for the slices of a roller: in the search, on finer positions, and in the table
    #: of friction of rollers with play. In 18 of 40 random bearings that have jumps, four instead of eight change a
    #: torque by up to 3.7e-3 in 0.8 of the time, and slips with play by up to 1.3 %; sixteen by up to 2.6e-4 in 1.3
    #: times the time. Chosen, so that the change by twice as many is below the stated error of these bearings, 4.5e-4
    #: in the median.
    n_loads: int = 8
    #: Largest half width in logit(S) of the samples on finer positions. Half the value changes torques by up to
    #: 4e-6, twice the value by 4e-8; chosen, below half a step of the grid.
    max_half_width: float = 0.1
    #: How often the samples on finer positions are extended, each time twice as far, where the torque still rises
    #: at their end. Half and twice as many have no effect; chosen, so that they reach a dozen steps of the grid.
    max_extensions: int = 4
    #: Number of passes at the end of a motion, each between the neighbours of the largest sample, which make a step of
    #: 0.025 one of 0.006. The stated error is proportional to the step: one pass states 0.4 % instead of 0.1 %; chosen.
    end_passes: int = 2
    #: Tolerance in logit(S) of the slip after a jump. Twice the value changes that slip by up to 6e-4, half the
    #: value by 4e-7; chosen, below the 0.2 % (median) by which finer positions change that slip.
    regain: float = 1e-3
    #: Tolerance of a steady slip, relative to it, and of its excess torque, relative to the torque. Half and twice
    #: the value change steady slips by up to 6e-11; chosen, near the rounding of the torques.
    steady_slip: float = 1e-10
    #: Relative imbalance of the torques, and relative distance from an end of an interval, from which on a steady
    #: slip is looked for beyond that end. Half and twice the value have no effect; chosen, far above `steady_slip`.
    imbalance: float = 1e-6
    #: Ratio of slips up to which it is looked for there. Half and twice the value have no effect; chosen, about a
    #: step of the grid.
    outside_factor: float = 1.25
    #: Smallest size of a slip that differs from 0. The search for negative slips of a cage that is driven begins with
    #: it. For a cage that rolls or is driven it stands in place of the slip where a search with play begins, and where
    #: a band takes a logarithm. Half and twice the value move bounds below a slip of 0.1 %, which are printed without a
    #: number, and change slips with play of gearbox from 1 to 30 kN by less than 1e-4 of them; chosen, so that five
    #: decades of slips are reached by doubling.
    slip_floor: float = 1e-5
    #: Step of a slip, relative to it, by which the excess torque is differentiated. The error of the slope was
    #: smallest with this value: 5e-9 in 90 % of 45 steady motions, 1e-8 with half (rounding), 2e-8 with twice
    #: (truncation).
    slope_step: float = 1e-4


SEARCH: Final = SearchTolerances()
#: Ratio of the slips after and before a jump, both above `SKIDDING_SLIP`, from which on the jump is the onset of
#: skidding. Half or twice the value moves the onset to another jump in bearings with several. No verdict or reserve
#: depends on it: the cage skids before. Chosen, as a convention.
SKIDDING_RATIO: Final = 2.0


@attrs.frozen
class Jump:
    """A maximum of the torque on the loading branch, from which the slip jumps.

    Slip and drag are those of finer positions of the orbit, which are computed around the maximum alone. The slip after
    the jump is where the torque on the positions of the search regains the maximum on the same positions. With four
    times as many positions in all of the search it changes by 0.2 % in the median of 29 random bearings, by up to 1 %
    in 26 of them, and by 17 % in one whose torque hardly rises there.
    """

    slip: float  # cage slip of the maximum
    drag: float  # torque of the maximum [N m]: with more drag the slip jumps
    slip_after: float  # slip to which the cage jumps, NaN if none in the range carries the drag
    error: float  # of the drag, relative: by the grid of slips, positions of the orbit and loads of a roller
    #: Fraction f -> the slips before and behind the maximum at which the torque is 1 - f times the drag.
    slips_within: Callable[[float], list[float]] = attrs.field(eq=False, repr=False)

    @property
    def is_skidding(self) -> bool:
        """Whether the cage skids after the jump: by its slip there, or because nothing carries the drag."""
        ratio = SKIDDING_RATIO if self.slip > SKIDDING_SLIP else 1.0
        skidding_slip = ratio * max(self.slip, SKIDDING_SLIP)
        return math.isnan(self.slip_after) or self.slip_after >= skidding_slip


@attrs.frozen
class SteadyMotion:
    """A steady slip on the loading branch, and the torque that it carries [N m]."""

    slip: float
    torque: float
    motion: Motion = attrs.field(eq=False, repr=False)
    _compute_slope: Callable[[], float] = attrs.field(eq=False, repr=False)

    @cached_property
    def slope(self) -> float:
        """Derivative of the excess torque with respect to the slip [N m].

        The steady motion is stable where it is positive: with more slip, the rollers accelerate the cage.
        """
        return self._compute_slope()


@attrs.frozen(eq=False)
class LoadingBranch:
    """Motions of the rollers while the drag is raised from zero; `find_loading_branch` finds them."""

    _search: "_Search" = attrs.field(repr=False)
    motions: list[Motion]  # by increasing slip, from a small one to the end of the range
    torque_without_slip: float  # of the rollers on a cage that does not slip [N m]
    refusal: str = ""  # why the range ends early, empty if it does not

    @cached_property
    def jumps(self) -> list[Jump]:
        """Maxima of the torque from which the slip jumps, by increasing slip and drag."""
        candidates = [self._search.find_jump(self.motions, k) for k in _find_maxima(self.motions)]
        return [jump for jump in candidates if jump is not None]

    @property
    def skidding_jump(self) -> Jump | None:
        """The jump at which skidding starts, None if the cage skids nowhere in the range."""
        return next((jump for jump in self.jumps if jump.is_skidding), None)

    @property
    def maximum(self) -> tuple[float, float]:
        """Slip and torque [N m] of the largest torque on the branch, which may be at the end of the range.

        With jumps it is at one of these or at the end: any other torque that exceeds all before it is exceeded behind.
        """
        motions = self.motions[-1:] if self.jumps else self.motions
        candidates = [(motion.slip, motion.torque) for motion in motions]
        candidates += [(jump.slip, jump.drag) for jump in self.jumps]
        return max(candidates, key=lambda candidate: candidate[1])

    @cached_property
    def maximum_error(self) -> float:
        """Relative error of the largest torque: that of its jump, else the change by finer positions."""
        slip, _ = self.maximum
        errors = [jump.error for jump in self.jumps if jump.slip == slip]
        return errors[0] if errors else self._search.estimate_error(self.motion_below(slip))

    @property
    def end(self) -> float:
        """Largest slip."""
        return self.motions[-1].slip

    @cached_property
    def torque_curve(self) -> tuple[Array, Array]:
        """Slips from zero on, and torques there [N m], (n,) each."""
        points = [(motion.slip, motion.torque) for motion in self.motions]
        slips, torques = zip((0.0, self.torque_without_slip), *points, strict=True)
        return np.array(slips), np.array(torques)

    def find_steady_motions(self, drag: Callable[[float], float]) -> list[SteadyMotion]:
        """Return the steady motions of a cage with a drag, by increasing slip.

        The first one has a negative slip where the cage is driven beyond its epicyclic speed.

        Parameters
        ----------
        drag : callable
            Torque of all drags at a cage slip [N m], negative where it resists.
        """
        slips, torques = (values.tolist() for values in self.torque_curve)
        excesses = [torque + drag(slip) for slip, torque in zip(slips, torques, strict=True)]
        steady = self._find_driven_motion(drag, excesses[0]) if excesses[0] > 0.0 else []
        for k, motion in enumerate(self.motions):
            low, high = excesses[k : k + 2]
            if (low < 0.0) != (high < 0.0) and (k == 0 or motion.is_continuous):
                starts = self.motions[max(k - 1, 0) : k + 1]
                steady.append(self._balance(starts, drag, (slips[k], slips[k + 1]), (low, high)))
        return steady

    def interpolate(self, slips: Sequence[float]) -> list[Motion]:
        """Return the motions of the branch at other slips of its range, on few loads of a roller."""
        starts = np.array([self.motion_below(slip).normalised_slip[0] for slip in slips])
        found = self._search.motions.find(np.array(slips), starts)
        return [motions[0] for motions in found]

    def motion_below(self, slip: float) -> Motion:
        """Return the motion at the largest slip up to ``slip``, from which a march stays on the branch."""
        below = (motion for motion in reversed(self.motions) if motion.slip <= slip)
        return next(below, self.motions[0])

    def _find_driven_motion(
        self, drag: Callable[[float], float], upper_excess: float
    ) -> list[SteadyMotion]:
        """The steady motion of a cage that is faster than its epicyclic speed; none beyond twice that speed."""
        high = 0.0
        low = -SEARCH.slip_floor
        while high > -1.0:
            motion = self._search.full_motions.find(np.array([low]))[0][0]
            lower_excess = motion.torque + drag(low)
            if lower_excess < 0.0:
                return [self._balance([motion], drag, (low, high), (lower_excess, upper_excess))]
            high = low
            low = max(2.0 * low, -1.0)
            upper_excess = lower_excess
        return []

    def _balance(
        self,
        start_candidates: list[Motion],
        drag: Callable[[float], float],
        interval: tuple[float, float],
        excesses: tuple[float, float],
    ) -> SteadyMotion:
        """The steady motion in an interval of slips, on all slices, from the excess torques at its ends."""
        excess = _ExcessTorque(self._search.full_motions, drag, start_candidates)
        low, high = interval
        slip = illinois_root(excess, low, high, *excesses, relative=SEARCH.steady_slip)
        motion = excess.motion
        distance = min(abs(slip - low), abs(high - slip))
        if distance <= SEARCH.imbalance * abs(slip) and not excess.is_balanced:
            # few loads of a roller give a sign at that end which all slices do not give: the root may be outside
            first, last = sorted((slip / SEARCH.outside_factor, slip * SEARCH.outside_factor))
            slope = (excesses[1] - excesses[0]) / (high - low)
            tolerance = SEARCH.steady_slip * abs(slip)
            if secant_root(excess, slip, slope, tolerance=tolerance, within=(first, last)):
                motion = excess.motion
        return SteadyMotion(motion.slip, -drag(motion.slip), motion, partial(excess.slope, motion))


@attrs.define
class _ExcessTorque:
    """Torque of the rollers, on all slices, in excess of the drag on the cage [N m], as a function of the slip."""

    motions: Motions
    drag: Callable[[float], float]
    start_candidates: list[Motion]  # rollers are marched from the one at the nearest slip
    motion: Motion = attrs.field(init=False)  # at the last slip that was evaluated

    def __call__(self, slip: float) -> float:
        nearest = min(self.start_candidates, key=lambda motion: abs(motion.slip - slip))
        (self.motion,) = self.motions.find_from([slip], nearest)
        excess = self.motion.torque + self.drag(slip)
        is_rounding = abs(excess) <= SEARCH.steady_slip * abs(self.motion.torque)
        return 0.0 if is_rounding else excess

    @property
    def is_balanced(self) -> bool:
        """Whether the torques balance at the last slip."""
        torque = self.motion.torque
        return not abs(torque + self.drag(self.motion.slip)) > SEARCH.imbalance * abs(torque)

    def slope(self, motion: Motion) -> float:
        """Derivative with respect to the slip at that of a motion [N m], by the central difference."""
        step = SEARCH.slope_step
        slips = motion.slip * np.array([1.0 - step, 1.0 + step])
        left, right = self.motions.find_from(slips, motion)
        rise = right.torque + self.drag(right.slip) - left.torque - self.drag(left.slip)
        return rise / (right.slip - left.slip)


@attrs.frozen
class _Maximum:
    """A maximum of the torque: logit of its slip, the torque [N m], and the relative error of the torque."""

    logit: float
    torque: float
    error: float


@attrs.frozen(eq=False)
class _Search:
    """The search for the loading branch of one bearing and for its jumps."""

    motions: Motions  # on few loads of a roller
    full_motions: Motions  # on all slices

    # The branch -------------------------------------------------------------------------------------------------------

    def follow(self, slips: Sequence[float]) -> list[Motion]:
        """Return the motions of the loading branch at some slips (steps 1 to 3)."""
        candidates = self.motions.find(np.array(slips))
        branch = self._take_nearest(slips, candidates)
        while self._replace_first_mismatch(
            slips, candidates, branch
        ):  # what follows is chosen anew
            branch = self._take_nearest(slips, candidates)
        return branch

    def _take_nearest(self, slips: Sequence[float], candidates: list[list[Motion]]) -> list[Motion]:
        """At each slip, the candidate nearest to the motion at the previous slip."""
        motions = self.motions
        branch = [candidates[0][0]]
        for k in range(1, len(slips)):
            previous = branch[-1]
            pair = candidates[k]
            if previous.converged and not any(motion.converged for motion in pair):
                # neither march from a ring converges, that from the previous motion may
                pair = motions.find_from(slips[k : k + 1], previous)
            nearest = min(
                pair,
                key=lambda motion: motions.distance(
                    motion.normalised_slip, previous.normalised_slip
                ),
            )
            branch.append(motions.mark_continuity(previous, nearest))
        return branch

    def _replace_first_mismatch(
        self, slips: Sequence[float], candidates: list[list[Motion]], branch: list[Motion]
    ) -> bool:
        """Replace the candidates at the first slip at which a march from the previous motion reaches another motion.

        The branch has the nearest motion there. If that converged, a march that did not converge does not replace it.
        If it did not, any march replaces it, because marches from there may converge at the next slips. Return whether
        there is such a slip.
        """
        ambiguous = [k for k in range(1, len(slips)) if len(candidates[k]) > 1]
        if not ambiguous:
            return False
        marched = self.motions.find(
            np.array([slips[k] for k in ambiguous]),
            np.array([branch[k - 1].normalised_slip[0] for k in ambiguous]),
        )
        for k, (motion, *_) in zip(ambiguous, marched, strict=True):
            is_other = (
                self.motions.distance(motion.normalised_slip, branch[k].normalised_slip) >= DISTINCT
            )
            if is_other and (motion.converged or not branch[k].converged):
                candidates[k] = [motion]
                return True
        return False

    def refine(self, branch: list[Motion]) -> list[Motion]:
        """Bisect the intervals which may contain a larger torque than all below (step 5)."""
        resisting_torque = min(0.0, branch[0].torque)
        while intervals := _find_intervals(branch, resisting_torque):
            logits = [0.5 * (branch[k].logit_slip + branch[k + 1].logit_slip) for k in intervals]
            middle = np.array([slip_from_logit(x) for x in logits])
            found = self.motions.find(
                middle, np.array([branch[k].normalised_slip[0] for k in intervals])
            )
            for k, (motion, *_) in reversed(list(zip(intervals, found, strict=True))):
                if not motion.converged:  # it only bisects the interval
                    torque = min(branch[k].torque, branch[k + 1].torque)
                    motion = attrs.evolve(motion, torque=torque)
                branch[k + 1 : k + 2] = [
                    self.motions.mark_continuity(branch[k], motion),
                    self.motions.mark_continuity(motion, branch[k + 1]),
                ]
        return branch

    # Its jumps --------------------------------------------------------------------------------------------------------

    def find_jump(self, branch: list[Motion], k: int) -> Jump | None:
        """The jump from the maximum at motion k (steps 7 to 9); None if finer positions have no such maximum."""
        coarse = self._find_coarse_maximum(branch, k)
        larger = (j for j in range(k + 1, len(branch)) if branch[j].torque > coarse.torque)
        after = next(larger, len(branch))
        slip_after = math.nan
        if after < len(branch):
            slip_after = self._find_regain(branch[after - 1], branch[after], coarse.torque)
        trough = min(branch[k + 1 : after], key=lambda motion: motion.torque)
        maximum = self._find_fine_maximum(branch[:after], k, coarse, trough.logit_slip)
        if self._vanishes_on_finer_positions(maximum, trough):
            return None
        return Jump(
            slip=slip_from_logit(maximum.logit),
            drag=maximum.torque,
            slip_after=slip_after,
            error=maximum.error,
            slips_within=partial(_slips_within, branch[:after], k, coarse, maximum.logit),
        )

    def _find_coarse_maximum(self, branch: list[Motion], k: int) -> _Maximum:
        """The maximum at motion k on the positions of the search: a vertex, or the last motion before a gap."""
        if _is_continuous_on_both_sides(branch, k):
            return self._find_vertex(self.motions, branch[k - 1 : k + 2])
        error = _estimate_rise_in_gap(branch, k) / branch[k].torque
        return _Maximum(branch[k].logit_slip, branch[k].torque, error)

    def _find_fine_maximum(
        self, branch: list[Motion], k: int, coarse: _Maximum, end: float
    ) -> _Maximum:
        """The maximum at motion k on finer positions, with its error; the coarse one where marches do not converge.

        A smooth one is looked for up to the logit ``end``. The first samples are as far apart as the slips at which the
        coarse torque has fallen by `equal_drag`. Without a finer maximum the error of the coarse one is infinite.
        """
        if _is_continuous_on_both_sides(branch, k):
            slips = _slips_within(branch, k, coarse, coarse.logit, SEARCH.equal_drag)
            low, high = (logit_slip(slip) for slip in slips)
            fine = self._find_fine_vertex(branch[k], coarse.logit, 0.5 * (high - low), end)
        else:
            fine = self._find_fine_end(branch[k])
        if fine is None:
            return attrs.evolve(coarse, error=math.inf)
        change = abs(fine.torque / coarse.torque - 1.0)
        error = max(coarse.error, branch[k].error, fine.error)
        return attrs.evolve(fine, error=error + change)

    def _find_regain(self, below: Motion, above: Motion, drag: float) -> float:
        """The slip between two motions of the branch at which a drag is carried again."""
        if not above.is_continuous:
            return slip_from_logit(above.logit_slip)

        def excess(logit: float) -> float:
            (motion,) = self.motions.find_from([slip_from_logit(logit)], below)
            return motion.torque - drag

        logit = illinois_root(
            excess,
            below.logit_slip,
            above.logit_slip,
            below.torque - drag,
            above.torque - drag,
            tolerance=SEARCH.regain,
        )
        return slip_from_logit(logit)

    def _find_vertex(self, motions: Motions, samples: list[Motion]) -> _Maximum:
        """The maximum between samples, by vertices of interpolating polynomials."""
        by_logit = {motion.logit_slip: motion for motion in samples}
        error = math.inf
        while len(by_logit) < SEARCH.n_samples and error > SEARCH.vertex:
            logits = sorted(by_logit)
            logit, height = polynomial_maximum(logits, [by_logit[x].torque for x in logits])
            if logit in by_logit:  # a kink, or the largest sample is at an end
                break
            nearest = min(by_logit.values(), key=lambda motion: abs(motion.logit_slip - logit))
            (motion,) = motions.find_from([slip_from_logit(logit)], nearest)
            if not motion.converged:
                break
            by_logit[logit] = motion
            error = abs(motion.torque / height - 1.0)
        logits = sorted(by_logit)
        best = max(by_logit.values(), key=lambda motion: motion.torque)
        excess = _estimate_excess_over_samples(logits, [by_logit[x].torque for x in logits])
        return _Maximum(best.logit_slip, best.torque, min(error, excess))

    # The same on more positions ---------------------------------------------------------------------------------------

    @cached_property
    def _fine_motions(self) -> Motions:
        n_positions = SEARCH.position_factor * self.motions.n_positions
        return self.full_motions.with_resolution(n_positions, SEARCH.n_loads)

    def _find_fine_vertex(
        self, start: Motion, logit: float, half_width: float, end: float
    ) -> _Maximum | None:
        """A smooth maximum on four times as many positions, up to ``end``; None if marches fail, or nothing drives.

        The first three samples are around the coarse maximum. While the largest one is at an end of all, there is one
        more beyond that end, each time twice as far.
        """
        distance = min(half_width, SEARCH.max_half_width)
        samples = dict[float, Motion]()
        logits = [logit - distance, logit, min(logit + distance, end)]
        for _ in range(1 + SEARCH.max_extensions):
            found = self._fine_motions.find_from([slip_from_logit(x) for x in logits], start)
            samples |= {
                x: motion for x, motion in zip(logits, found, strict=True) if motion.converged
            }
            if len(samples) < 2 or max(motion.torque for motion in samples.values()) <= 0.0:
                return None
            distance *= 2.0
            first, *_, last = sorted(samples)
            top = max(sorted(samples), key=lambda x: samples[x].torque)
            beyond = first - distance if top == first else min(last + distance, end)
            if first < top < last or top == end or beyond in samples:
                break
            logits = [beyond]
        return self._find_vertex(self._fine_motions, list(samples.values()))

    def _find_fine_end(self, motion: Motion) -> _Maximum | None:
        """The end of a motion on four times as many positions; None if the torque is not largest inside the range."""
        low = motion.logit_slip - SEARCH.max_half_width
        high = motion.logit_slip + SEARCH.max_half_width
        n = SEARCH.n_samples
        maximum: _Maximum | None = None
        for _ in range(SEARCH.end_passes):
            logits = np.linspace(low, high, n).tolist()
            found = self._fine_motions.find_from([slip_from_logit(x) for x in logits], motion)
            torques = [fine.torque if fine.converged else -math.inf for fine in found]
            top = int(np.argmax(torques))
            if not 0 < top < n - 1 or torques[top] <= 0.0:
                break
            low = logits[top - 1]
            high = logits[top + 1]
            error = abs(max(torques[top - 1], torques[top + 1]) / torques[top] - 1.0)
            maximum = _Maximum(logits[top], torques[top], error)
        return maximum

    def _vanishes_on_finer_positions(self, maximum: _Maximum, trough: Motion) -> bool:
        """Whether the torque does not fall behind a maximum on finer positions as it does on coarse ones.

        That is computed at the motion with the smallest torque behind the maximum, the trough, where it may be so: the
        fall is small, or the finer torque rises up to the trough.
        """
        is_shallow = trough.torque > (1.0 - SEARCH.shallow_fall) * maximum.torque
        is_at_end = maximum.logit > trough.logit_slip - SEARCH.gap_width
        if not (is_shallow or is_at_end):
            return False
        (fine,) = self._fine_motions.find_from([trough.slip], trough)
        return fine.converged and fine.torque >= (1.0 - SEARCH.min_fall) * maximum.torque

    def estimate_error(self, motion: Motion) -> float:
        """Relative error of the torque of a motion: its own, and twice the change by four times the positions.

        The finer torque is within the change of the exact one, as is stated of a jump (step 8). A jump has the finer
        torque as its result. Here the coarse torque is the result, which differs from the finer one by the change, too.
        """
        (fine,) = self._fine_motions.find_from([motion.slip], motion)
        if not fine.converged:
            return math.inf
        change = abs(fine.torque / motion.torque - 1.0) if motion.torque else 0.0
        return max(motion.error, fine.error) + 2.0 * change


# Intervals and maxima of a branch -------------------------------------------------------------------------------------


def _is_continuous_on_both_sides(branch: list[Motion], k: int) -> bool:
    """Whether motion k continues that at the previous slip, and that at the next slip continues motion k."""
    return 0 < k < len(branch) - 1 and branch[k].is_continuous and branch[k + 1].is_continuous


def _find_intervals(branch: list[Motion], resisting_torque: float) -> list[int]:
    """The first motions of the intervals to bisect, with the torque that resists without slip [N m], at most zero."""
    torques = np.array([motion.torque for motion in branch])
    running_maxima = np.maximum.accumulate(torques)
    next_maxima = np.append(running_maxima[1:], running_maxima[-1])
    is_maximum = (torques > 0.0) & (torques == running_maxima) & (torques == next_maxima)
    intervals = []
    for k, (a, b) in enumerate(itertools.pairwise(branch)):
        bound = 0.0
        if not b.is_continuous:
            bound = _bound_in_gap(a, b, resisting_torque)
        elif is_maximum[k : k + 2].any():
            bound = _bound_at_maximum(branch, k)
        exceeded = (1.0 + SEARCH.equal_drag) * running_maxima[k + 1]
        if b.logit_slip - a.logit_slip > SEARCH.gap_width and bound > max(exceeded, 0.0):
            intervals.append(k)
    return intervals


def _bound_in_gap(a: Motion, b: Motion, resisting_torque: float) -> float:
    """Upper bound of the torque between two motions of which the second does not continue the first [N m].

    The gap may be anywhere between both. Up to it the first motion goes on: its torque, in excess of that which resists
    without slip, grows at most in proportion to the slip, so by less than exp(width). Behind it is the second motion,
    whose excess falls at most at the rate `fall_in_gap`.
    """
    width = b.logit_slip - a.logit_slip
    before = a.torque + (a.torque - resisting_torque) * math.expm1(width)
    behind = b.torque + (b.torque - resisting_torque) * SEARCH.fall_in_gap * width
    return max(before, behind)


def _bound_at_maximum(branch: list[Motion], k: int) -> float:
    """Upper bound of the torque between motions k and k + 1, by its second derivative [N m]."""
    width = branch[k + 1].logit_slip - branch[k].logit_slip
    bend = max(_second_derivative(branch, k), _second_derivative(branch, k + 1))
    torque = max(branch[k].torque, branch[k + 1].torque)
    return torque + SEARCH.curvature_factor * bend * width**2 / 8.0


def _second_derivative(branch: list[Motion], k: int) -> float:
    """Absolute second derivative of the torque with respect to the logit of the slip; 0 at a gap."""
    if not _is_continuous_on_both_sides(branch, k):
        return 0.0
    a, b, c = branch[k - 1 : k + 2]
    left = (b.torque - a.torque) / (b.logit_slip - a.logit_slip)
    right = (c.torque - b.torque) / (c.logit_slip - b.logit_slip)
    return 2.0 * abs(right - left) / (c.logit_slip - a.logit_slip)


def _find_maxima(branch: list[Motion]) -> list[int]:
    """Indices of the motions from which the torque falls before it is exceeded (step 6)."""
    maxima = list[int]()
    k = 0
    torques = [motion.torque for motion in branch]
    while k < len(branch):
        after = next((j for j in range(k + 1, len(branch)) if torques[j] > torques[k]), len(branch))
        smallest_behind = min(torques[k + 1 : after], default=math.inf)
        if torques[k] > 0.0 and smallest_behind < (1.0 - SEARCH.min_fall) * torques[k]:
            maxima.append(k)
        k = after
    return maxima


def _slips_within(
    branch: list[Motion], k: int, maximum: _Maximum, logit: float, fraction: float
) -> list[float]:
    """The two slips between which the torque is within a fraction of the maximum near motion k.

    They are shifted by as much as the logit of the maximum is corrected.
    """
    ends = [_find_fall(branch, k, maximum, math.sqrt(fraction), step) for step in (-1, 1)]
    return [slip_from_logit(end + logit - maximum.logit) for end in ends]


def _find_fall(branch: list[Motion], k: int, maximum: _Maximum, level: float, step: int) -> float:
    """The logit of slip, before (step -1) or behind (1) a maximum, to which the torque has fallen to a level.

    The level is the square root of the relative fall. That root is interpolated linearly, which is exact on a parabola;
    at a gap the last motion before it is taken, and at an end of the branch the last one.
    """
    logit = maximum.logit
    root = 0.0
    # the first sample on this side of the maximum, which lies between samples
    first = k if (branch[k].logit_slip - maximum.logit) * step > 0.0 else k + step
    for j in range(first, len(branch) if step > 0 else -1, step):
        next_root = math.sqrt(max(1.0 - branch[j].torque / maximum.torque, 0.0))
        if next_root > level:
            # the right end of an interval stores whether the motion goes on in it
            right = max(j, j - step)
            if j == k or branch[right].is_continuous:
                logit += (level - root) / (next_root - root) * (branch[j].logit_slip - logit)
            break
        logit = branch[j].logit_slip
        root = next_root
    return logit


def _estimate_rise_in_gap(branch: list[Motion], k: int) -> float:
    """By how much the torque may rise in the gap at the end of a motion [N m], by the slope on its other side.

    Without one it rises in proportion to the slip, so that its slope over the logit is the torque itself.
    """
    sides = list(itertools.pairwise(branch))[max(k - 1, 0) : k + 1]
    gaps = [b.logit_slip - a.logit_slip for a, b in sides if not b.is_continuous]
    slopes = [
        abs(b.torque - a.torque) / (b.logit_slip - a.logit_slip)
        for a, b in sides
        if b.is_continuous
    ]
    return max(gaps, default=0.0) * max(slopes, default=branch[k].torque)


def _estimate_excess_over_samples(x: list[float], y: list[float]) -> float:
    """Relative excess that a maximum may have over the largest sample: on either side, by the slope of the other."""
    best = int(np.argmax(y))
    slopes = np.abs(np.diff(y) / np.diff(x))
    if not 0 < best < len(x) - 1:  # the samples still rise at their end: by as much again
        return float(slopes[0 if best == 0 else -1] * (x[-1] - x[0]) / y[best])
    left = slopes[best] * (x[best] - x[best - 1])
    right = slopes[best - 1] * (x[best + 1] - x[best])
    return float(max(right, left) / y[best])


def _drop_doubtful(branch: list[Motion]) -> list[Motion]:
    """Return the branch without motions that did not converge, and without isolated ones (step 4)."""
    branch = [motion for motion in branch if motion.converged]
    last = len(branch) - 1
    return [
        motion
        for k, motion in enumerate(branch)
        if motion.is_continuous or k in (0, last) or branch[k + 1].is_continuous
    ]


def _grid(max_slip: float) -> list[float]:
    """Slips of the search (step 1); where the range ends below `smallest_slip`, from half of its end."""
    start = logit_slip(min(SEARCH.smallest_slip, 0.5 * max_slip))
    end = logit_slip(max_slip)
    count = math.ceil((end - start) / SEARCH.grid_step)
    logits = np.linspace(start, end, count + 1)[:-1].tolist()
    return [*(slip_from_logit(x) for x in logits), max_slip]


def branch_slips(max_slip: float) -> Array:
    """Return zero and the slips of the search for the loading branch, (n,).

    Parameters
    ----------
    max_slip : float
        Largest cage slip.
    """
    return np.array([0.0, *_grid(max_slip)])


def find_loading_branch(motions: Motions, max_slip: float, full_motions: Motions) -> LoadingBranch:
    """Return the loading branch of a bearing.

    Parameters
    ----------
    motions : Motions
        Motions of the rollers on few loads that stand for their slices, by which the branch is searched.
    max_slip : float
        Largest cage slip, where the range ends unless a law has no value there.
    full_motions : Motions
        The same on all slices, by which steady motions are found.

    Raises
    ------
    ConvergenceError
        If the march of the rollers converges at no slip.
    """
    slips = _grid(max_slip)
    refusal = ""
    search = _Search(motions, full_motions)
    while True:
        try:
            branch = search.follow(slips)
            if branch := _drop_doubtful(branch):
                branch = _drop_doubtful(search.refine(branch))
            break
        except (DomainError, ConvergenceError) as error:
            # at the end of the range a law has no value, or a roller finds no balance
            slips = slips[:-1]
            refusal = str(error)
            if not slips:
                raise
    if not branch:
        raise ConvergenceError(
            f"the search for the motion of the rollers did not converge at any cage slip up to {slips[-1]:.2%}, so "
            "there is no slip to report; it converges where more load is on the rollers: raise operation.radial_load"
        )
    if branch[-1].slip < slips[-1]:
        refusal = "the search for the motion of the rollers does not converge" + (
            refusal and f"; further on, {refusal}"
        )
    torque_without_slip = 0.0
    if motions.resists:
        torque_without_slip = full_motions.find(np.zeros(1), np.zeros(1))[0][0].torque
    return LoadingBranch(search, branch, torque_without_slip, refusal)
