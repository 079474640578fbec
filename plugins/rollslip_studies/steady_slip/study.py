"""Study steady-slip: the cage slips at which a bearing runs on, without integration over time.

The rollers drive the cage and drags resist it. Where both torques are in balance the slip is steady
(`motion.torque_balance`). The torque of the rollers has a maximum over the slip, so that there are two such slips or
none: the smaller one is stable, because more slip brings more torque, and the larger one is unstable.

1. Double the roller positions within a pitch until the torques at four slips change by less than the tolerance, and the
   error of the limit drag torque is below it, too. The last change is reported as discretisation error.
2. Find the loading branch (`motion.loading_branch`): the motions of the rollers while the drag is raised from zero. It
   goes on to a cage that hardly turns, whatever the range of the curve, so that steady slips and the onset of skidding
   are known outside that range as well.
3. Steady slips, the slip-drag curve and its maxima are taken from this branch.
4. Evaluate films, losses, the reserves and the minimum load at the smallest stable slip.
5. Find the smallest steady slip, the slip-drag curve, the reserves and the minimum load once more with play in the
   pockets (`steady_slip.play`), which all the above leaves out: a roller crosses its pocket before it drives the cage.
6. On request follow the slips over radial load, speed or temperature through folds, where a stable and an unstable slip
   meet (`steady_slip.branches`), of rollers that are set in the cage: there is, for example, the smallest load at which
   the rollers still carry the drag.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.cage import train_play
from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.resolution import Resolution, reference_resolution, refined
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import FieldError, at_least, choice_of, in_range, parameter
from rollslip.results.dataset import about
from rollslip.results.text import SMALLEST_SLIP, Status
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.studies.answers import (
    ComparedValues,
    LoadedSlices,
    Measurable,
    Output,
    PartialResult,
    ResolutionChoice,
    RunContext,
)
from rollslip.studies.bounds import SLICE_FACTOR, richardson_factor
from rollslip.studies.discretisation.choice import COARSE_POSITIONS, choose_by_curves
from rollslip.studies.rating_life.largest_load import largest_load
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip_studies.effective_friction.raceways import largest_relative_change
from rollslip_studies.motion.loading_branch import LoadingBranch, SteadyMotion
from rollslip_studies.motion.losses import named_losses
from rollslip_studies.motion.torque_balance import (
    RANGE,
    Orbit,
    TorqueBalance,
    acceptable_reserve,
    evaluate_on_branch,
    minimum_positions,
    reserve,
    running,
    skidding_onset,
)  # fmt: skip
from rollslip_studies.motion.train import slower_by_play
from rollslip_studies.steady_slip import band
from rollslip_studies.steady_slip.branches import Branch, describe_no_fold, follow
from rollslip_studies.steady_slip.evaluated import (
    estimate_by_secant,
    evaluated_slices,
    film_variables,
    require_driven,
    without_play,
)
from rollslip_studies.steady_slip.losses import estimate_answer_errors, loss_variables
from rollslip_studies.steady_slip.minimum_load import (
    RULES,
    minimum_load,
    minimum_loads_of_makers,
    rollers_weight,
)
from rollslip_studies.steady_slip.outputs import (
    MEASURED,
    OUTPUTS,
    PLAY_OUTPUTS,
    VARIED,
    followed_outputs,
)
from rollslip_studies.steady_slip.slip_drag import (
    describe_stability,
    describe_steady_status,
    slip_drag_variables,
)

if TYPE_CHECKING:
    import xarray as xr

    from rollslip_studies.steady_slip.play import Play

#: Roller positions within a pitch above which the run fails. Twice as many take twice the time of the last step.
#: Chosen: torques converge long before, unless rollers change their motion between positions.
_MAX_POSITIONS: Final = 256
#: Roller positions above which the error of the limit drag torque no longer causes a further doubling, because the
#: torque at a jump converges with the first order only: twice as many halve that error for twice the time. Chosen.
_MAX_POSITIONS_FOR_LIMIT_DRAG: Final = 16
#: Slips at which changes of the torque are compared, relative to the largest slip of the curve: small ones, where the
#: torque rises, to the end. Three of them or seven led to the same numbers of positions in two scenes. Chosen.
_COMPARED_FRACTIONS: Final = (0.02, 0.15, 0.5, 1.0)
#: Fraction of the tolerances that slices and roller positions may use; the rest is for the errors of single numbers.
#: Twice as much, all of it, leaves nothing for these. Half as much took 3 to 5 instead of 3 to 4 positions and 24 %
#: more time in two scenes, and changed slip and load at the fold by up to 3e-3 at a tolerance of 5 %. Chosen.
_TOLERANCE_FRACTION: Final = 0.5
#: Fraction of the tolerance at which slices aim, whose error of the smallest steady slip would exceed it, as in a run
#: that is made again. Twice as much takes 0.7 times as many slices in three scenes of docs/scripts/play.py, and makes
#: one of these runs again. Chosen.
_SLIP_FRACTION: Final = 0.35
# Numbers of evaluations by which the cost is extrapolated from measured times; an estimate scales with them.

#: Loading branches of a run: those of the last two numbers of positions.
_BRANCHES: Final = 2
#: Motions of a loading branch; four scenes of the catalogue have 50 to 59.
_BRANCH_MOTIONS: Final = 50
#: Motions of the rollers of a followed branch. Four scenes of the catalogue evaluate 94 to 167, each with loads of its
#: own; chosen, rather too large, because loads take time, too.
_FOLLOWED_MOTIONS: Final = 350
#: Loading branches of a search for the minimum load, where rollers have several motions at the acceptable slip. Chosen.
_MINIMUM_LOAD_BRANCHES: Final = 9
#: Loading branches in whose time rollers with play are tabulated and marched: 1.2 to 5.3 in nine scenes of
#: docs/scripts/play.py, 4 in the middle. The estimate of that part is proportional to it.
_PLAY_BRANCHES: Final = 4
#: Outputs that depend on the play of the pockets.
_AFFECTED_BY_PLAY: Final = frozenset(PLAY_OUTPUTS) | {
    "steady_slip",
    "status",
    "cage_speed",
    "torque",
    "driving_torque",
    "limit_drag",
    "skidding_slip",
    "drag_reserve",
    "minimum_load",
    "acceptable_reserve",
}
#: Outputs that an acceptable slip adds.
_MINIMUM_LOAD_OUTPUTS: Final = frozenset(
    f"{name}{suffix}"
    for name in ("minimum_load", "acceptable_reserve")
    for suffix in ("", "_status")
) | {"makers_minimum_load", "makers_status"}


def _range(name: str) -> Any:
    """Return the parameter of the study for the range of an operating condition."""
    unit, what = VARIED[name]
    return parameter(
        default=(),
        unit=unit,
        doc=f"least and largest {what} against which the slips are followed; empty for not",
    )


@attrs.frozen(kw_only=True)
class SteadySlip(Study):
    """The cage slips at which a bearing runs on, found without integrating in time."""

    name: ClassVar[str] = "steady-slip"
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"critical_slip": "skidding_slip", "friction": "limit_drag"}
    )
    # Curves at a few slips are no measure of its values: a slip at a flat maximum has a range, which the vertex through
    # three slips does not show, and where rollers change their motion a curve jumps at a slip of its own
    compared_as_values: ClassVar[frozenset[str]] = frozenset({"critical_slip", "friction"})
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "orbits": "a steady motion of the rollers for every slip",
            "pockets": "tables of friction, and rollers that cross the play of their pockets",
        }
    )
    with_cage: ClassVar[bool] = True
    measured: ClassVar[Mapping[str, Measurable]] = MEASURED
    with_bands = staticmethod(band.with_bands)

    max_cage_slip: float = parameter(
        default=0.9,
        unit="1",
        doc="largest cage slip of the slip-drag curve; it goes further where the answer lies beyond",
        validator=in_range(0.0, 1.0, open=True),
    )
    points: int = parameter(
        default=25,
        doc="slips of the slip-drag curve, at least; the loading branch has its own",
        validator=at_least(6),
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )
    pockets: str = parameter(
        default="play",
        doc="rollers in their pockets: with the play of cage.pocket_clearance, or set in the cage",
        validator=choice_of("play", "set"),
    )
    #: Whether the slip-drag curve is computed with play; a study without that output has none.
    has_curve: bool = attrs.field(default=True, metadata={"key": None})
    acceptable_slip: float | None = parameter(
        default=0.05,
        unit="1",
        doc="acceptable cage slip, of which the minimum load is sought, beside those of catalogues",
        validator=attrs.validators.optional(in_range(0.0, 1.0, open=True)),
    )
    radial_load: tuple[float, ...] = _range("radial_load")
    inner_speed: tuple[float, ...] = _range("inner_speed")
    temperature: tuple[float, ...] = _range("temperature")

    def __attrs_post_init__(self) -> None:
        for name, limits in self._followed_ranges.items():
            if not (len(limits) == 2 and limits[0] < limits[1]):
                raise FieldError(
                    name, f"must be two values that ascend, or empty, not {list(limits)}"
                )

    @property
    def libraries(self) -> tuple[str, ...]:  # type: ignore[override]
        """Modules of SciPy that following slips imports; the import takes longer than a run without it."""
        return ("scipy.optimize", "scipy.interpolate") if self._followed_ranges else ()

    @property
    def _followed_ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value of the operating conditions over which slips are followed, by name."""
        return {name: limits for name in VARIED if (limits := getattr(self, name))}

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers the slip-drag curve has at least."""
        return {"points": 4.0 * self.points}

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate."""
        loads = assembly.load_distribution(1)
        loaded = np.count_nonzero(loads.inner_load) + np.count_nonzero(loads.outer_load)
        per_orbit = 10 * 2 * minimum_positions(assembly)
        slips = 3 * self.points + 60 + _FOLLOWED_MOTIONS * len(self._followed_ranges)
        return int(loaded) * per_orbit * slips

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_cage_slip

    @property
    def is_averaged(self) -> bool:
        """Whether the curves are means over the roller positions within a pitch."""
        return True

    @property
    def has_nested_positions(self) -> bool:
        """Whether coarse roller positions are among fine ones; each number of positions is computed for itself."""
        return False

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, roller positions and laws by the slip-drag curve."""
        choice = choose_by_curves(
            self, assembly, fraction=_TOLERANCE_FRACTION, cheaper_laws=cheaper_laws
        )
        chosen = choice.resolution
        slices = chosen.slices
        accuracy = assembly.scene.accuracy
        if assembly.slices > 1 and accuracy.slices is None and not accuracy.exact:
            error = self._slip_error(assembly, slices, chosen.quadrature) / accuracy.tolerance
            if error > 1.0:
                finer = math.ceil(slices * math.sqrt(error / _SLIP_FRACTION))
                slices = min(finer, reference_resolution(assembly.scene).slices)
        n_positions = max(chosen.n_positions or 0, minimum_positions(assembly))
        return attrs.evolve(
            choice, resolution=attrs.evolve(chosen, slices=slices, n_positions=n_positions)
        )

    def _slip_error(self, assembly: Assembly, slices: int, quadrature: str) -> float:
        """Return the relative error that slices leave in the smallest steady slip; 0 where none is in the range."""
        bearings = (
            assembly.at(attrs.evolve(assembly.resolution, slices=number, quadrature=rule))
            for number, rule in ((slices, quadrature), (SLICE_FACTOR * slices, "gauss"))
        )
        balance, finer = (
            self._balance(bearing.with_resistance(), COARSE_POSITIONS) for bearing in bearings
        )
        slip = running(balance).slip
        if not slip > SMALLEST_SLIP:
            return 0.0
        error, _ = estimate_by_secant(finer, slip, lambda _: np.empty(0))
        return error / richardson_factor(1, SLICE_FACTOR)

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return four times as fine a resolution, because the reference resolution would take days."""
        return refined(scene, own), "against four times as fine"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of the motions of the rollers, extrapolated from a few of them."""
        balance = self._balance(assembly.with_resistance(), assembly.resolution.n_positions or 2)
        branches = _BRANCHES + _FOLLOWED_MOTIONS * len(self._followed_ranges) / _BRANCH_MOTIONS
        if self.acceptable_slip is not None and balance.has_several_motions(self.acceptable_slip):
            branches += _MINIMUM_LOAD_BRANCHES
        branch = balance.seconds()
        costs = {"orbits": branch * branches}
        if self.pockets == "play":
            costs["pockets"] = branch * _PLAY_BRANCHES
        return costs

    def without_outputs(self, outputs: frozenset[str]) -> "SteadySlip":
        """Return a study that does not compute outputs: of followed slips, minimum load, play and its curve."""
        followed = [name for name in VARIED if outputs >= followed_outputs(name).keys()]
        dropped: dict[str, object] = dict.fromkeys(followed, ())
        if outputs >= _MINIMUM_LOAD_OUTPUTS:
            dropped["acceptable_slip"] = None
        if outputs >= _AFFECTED_BY_PLAY:
            dropped["pockets"] = "set"
        dropped["has_curve"] = not outputs >= PLAY_OUTPUTS.keys() | {"driving_torque"}
        return self.with_settings(**dropped)

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the smallest stable slip of rollers set in the cage."""
        dataset = without_play(dataset)
        stable = (
            dataset["stable"].to_numpy() == 1 if "stable" in dataset else np.zeros(0, dtype=bool)
        )
        slip = float(dataset["steady_slip"].to_numpy()[stable][0]) if stable.any() else np.nan
        return {"steady cage slip": ComparedValues([[slip]], str(dataset["status"].item()))}

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return the driving torque [N m] at each number of roller positions, (k, 1, n)."""
        bearing = assembly.with_resistance()
        balances = [self._balance(bearing, number) for number in n_positions]
        return np.array([[balance.torques(slip)] for balance in balances])

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate contacts along the loading branch."""
        evaluate_on_branch(assembly, max(RANGE, self.max_cage_slip), inertia=self.inertia)

    @property
    def validity_state(self) -> str:
        """State of the `validity_slices` in words."""
        return "at the steady slip"

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices at the steady slips; for a result without these at the skidding slip."""
        dataset = without_play(dataset)
        slips = np.atleast_1d(
            dataset["steady_slip" if "steady_slip" in dataset else "skidding_slip"].to_numpy()
        )
        balance = self._balance(assembly, int(dataset.attrs["n_positions"]))
        return evaluated_slices(
            balance, (balance.orbit(float(slip)) for slip in slips if np.isfinite(slip))
        )

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags, the losses beside the rollers, and the friction of ribs under axial load.

        Raises
        ------
        SceneError, PluginError
            If the cage is wrong, or a model is not installed.
        """
        drags = (("drag", model) for model in assembly.cage.drags)
        return *drags, *named_losses(assembly.scene), *assembly.named_ribs

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the slip-drag curve, the steady slips, and these over the operating conditions that are followed.

        All are those of rollers which are set in the cage; `completed` has the play.

        Returns
        -------
        xarray.Dataset
            Dimensions (cage_slip,): driving_torque, drag_torque; (steady,): steady_slip, cage_speed, torque, stable,
            stability, multiplier, stored_power, friction_torque; (ring, steady): effective_friction, film_parameter,
            ring_power, ring_torque; (source, steady): loss; (steady, angle): roller_slip; (ring, steady, angle):
            normal_force, all of these one NaN where there is no steady slip and ``status`` says why; scalars: status,
            limit_drag, skidding_slip, skidding_status, limit_drag_error, _low and _high, jump_slip, largest_torque,
            largest_torque_slip, largest_torque_error, first_maximum_torque, first_maximum_slip, first_jump_slip. For
            each followed condition X, if a branch was found, (X_point,): X, X_slip, X_stable, X_fold, X_branch; scalars
            X_limit, X_limit_slip, X_limit_status.

        Raises
        ------
        SceneError
            If the cage is wrong, or no roller is loaded on the inner ring.
        DomainError
            If a law has no value at any slip, or the epicyclic cage speed is zero.
        ConvergenceError
            If the torque does not converge over the numbers of roller positions.
        """
        assembly = require_driven(assembly).with_resistance()
        balance, errors = self._converged(assembly)
        n_positions = balance.n_positions
        branch = self._loading_branch(balance)
        steady = [] if balance.rolls_freely else branch.find_steady_motions(balance.drag)
        slips = [0.0] if balance.rolls_freely else [motion.slip for motion in steady]
        states = [balance.orbit_from_motion(motion.motion) for motion in steady]
        if not states:
            end = min(self.max_cage_slip, branch.end)
            others = slips or [fraction * end for fraction in _COMPARED_FRACTIONS]
            states = [balance.orbit(slip) for slip in others]
        variables, coords, error = slip_drag_variables(
            balance, branch, slips, self.max_cage_slip, self.points, self.table
        )
        positions = states[0].roller_slip.size
        variables |= (
            self._steady(balance, branch, states, steady) if slips else self._unsteady(positions)
        )
        coords["angle"] = (
            "angle",
            2.0 * np.pi * np.arange(positions) / positions,
            about("rad", "position from the line of load, in the sense of the orbit"),
        )
        variables |= film_variables(self, balance, states, steady=bool(slips))
        losses, sources = loss_variables(balance, states, steady=bool(slips))
        coords |= sources
        variables |= losses
        variables |= self.variables(status=describe_steady_status(balance, branch, slips))
        variables |= self._reserve(balance)
        for name, limits in self._followed_ranges.items():
            branches = self._followed(assembly, n_positions, name, limits, slips)
            no_fold = describe_no_fold(
                name,
                limits,
                branches,
                self.table,
                self.max_cage_slip,
                free=balance.rolls_freely,
            )
            variables |= _branch_variables(name, branches, no_fold)
        attributes = {
            "friction": "conventional",
            "inertia": int(self.inertia),
            "inertia_effect": self._inertia_effect(balance),
            "n_positions": n_positions,
            "curve_error": error,
            "slices": assembly.slices,
            "rollers_weight": rollers_weight(assembly),
            **errors,
            **_play_attributes(assembly, states),
        }
        if self.acceptable_slip is not None:
            variables |= self._minimum_load(balance, self.acceptable_slip)
            factor, status = acceptable_reserve(balance, self.acceptable_slip)
            variables |= self.variables(acceptable_reserve=factor, acceptable_reserve_status=status)
            coords["maker"] = "maker", list(RULES), about("1", "maker of bearings")
            attributes |= {"acceptable_slip": self.acceptable_slip, **largest_load(assembly.scene)}
        import xarray as xr

        return xr.Dataset(variables, coords, attrs=self.attributes | attributes)

    def completed(self, assembly: Assembly, dataset: "xr.Dataset") -> "xr.Dataset":
        """Return the result with play in the pockets, and what it is without.

        Parameters
        ----------
        assembly : Assembly
            The bearing of the result.
        dataset : Dataset
            The result of `run`.
        """
        if self.pockets == "set":
            return dataset
        count = int(dataset["status"].item() == Status.FOUND)
        slips = dataset["steady_slip"].to_numpy()[:count].tolist()
        balance = self._balance(assembly.with_resistance(), int(dataset.attrs["n_positions"]))
        play = self._play(balance, slips)
        return play.completed(dataset, self._at_load(play.set_balance), self.has_curve)

    def partial_result(self, assembly: Assembly, outputs: frozenset[str]) -> PartialResult | None:
        """Return steady slips, or the minimum load, with their status as `run` does; None for other outputs."""
        if outputs <= {"minimum_load", "minimum_load_status"} and self.acceptable_slip is not None:
            balance = self.balance(assembly.with_resistance())
            variables = self._minimum_load(balance, self.acceptable_slip)
            if self.pockets == "play":
                play = self._play(balance, [])
                _, load, attributes = variables["minimum_load"]
                status = variables["minimum_load_status"][1]
                variables |= play.minimum_load(load, status, attributes, self._at_load(balance))
            return variables, {}
        if not outputs <= {"steady_slip", "status"}:
            return None
        balance, steady, status = self.steady(assembly)
        slips = [motion.slip for motion in steady]
        if self.pockets == "play":
            play = self._play(balance, slips)
            slips = play.slips(slips)
            status = play.status or status
        known = np.array(slips or [np.nan])
        return self.variables(status=status, steady_slip=known), {
            "steady": ("steady", np.arange(known.size), about("1", "steady cage slip"))
        }

    def steady(
        self, assembly: Assembly, likely_slip: float = math.inf
    ) -> tuple[TorqueBalance, list[SteadyMotion], str]:
        """Return the torque balance of a bearing, its steady motions on the loading branch, and the status of these.

        A cage that nothing drags has slip 0, which is stable.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        likely_slip : float
            Slip of a similar bearing. The branch is first searched up to a multiple of it, so that larger steady slips
            than the smallest stable one may be missing.
        """
        assembly = require_driven(assembly).with_resistance()
        balance = (
            self._doubled(assembly)[0]
            if assembly.resolution.n_positions is None
            else self.balance(assembly)
        )
        branch, motions = balance.steady_motions(max(RANGE, self.max_cage_slip), likely_slip)
        if balance.rolls_freely:
            rolling = balance.motions.find(np.zeros(1))[0][0]
            motions = [SteadyMotion(0.0, 0.0, rolling, lambda: np.inf)]
        slips = [motion.slip for motion in motions]
        return balance, motions, describe_steady_status(balance, branch, slips)

    def with_play(self, assembly: Assembly, slip: float) -> tuple[float, str]:
        """Return the smallest steady slip with play in the pockets, and what was found of it; see `Play`.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        slip : float
            Its smallest steady slip of rollers set in the cage; NaN without one.
        """
        play = self._play(self.balance(assembly.with_resistance()), [slip])
        return play.slips([slip])[0], play.status or play.found.status

    def balance(self, assembly: Assembly) -> TorqueBalance:
        """Return the torque balance of a bearing at its number of roller positions."""
        return self._balance(
            assembly, max(assembly.resolution.n_positions or 0, minimum_positions(assembly))
        )

    def _balance(self, assembly: Assembly, n_positions: int) -> TorqueBalance:
        """Return the torque balance of a bearing at a number of roller positions within a pitch."""
        return TorqueBalance(
            assembly, assembly.cage.drags, n_positions=n_positions, inertia=self.inertia
        )

    def _loading_branch(self, balance: TorqueBalance) -> LoadingBranch:
        """Return the loading branch up to a cage that hardly turns."""
        return balance.loading_branch(max(RANGE, self.max_cage_slip))

    def _reserve(self, balance: TorqueBalance) -> dict[str, Any]:
        """Return the variables of the drag reserve to skidding."""
        largest = max(RANGE, self.max_cage_slip)
        onset = skidding_onset(balance, largest, f"{self.table}.max_cage_slip")
        to_skidding = reserve(balance, onset, running(balance, largest), largest)
        found = self.variables(drag_reserve=to_skidding.factor, reserve_status=to_skidding.status)
        *value, attributes = found["drag_reserve"]
        found["drag_reserve"] = (*value, attributes | {"slip": to_skidding.slip})
        return found

    def _play(self, balance: TorqueBalance, slips: Sequence[float]) -> "Play":
        """Return the play of the pockets, by the steady slips of rollers set in the cage."""
        # tables of motions in time, which no other run needs
        from rollslip_studies.steady_slip.play import Play

        return Play(
            balance,
            next(iter(slips), np.nan),
            self.acceptable_slip,
            max(RANGE, self.max_cage_slip),
        )

    def _converged(self, assembly: Assembly) -> tuple[TorqueBalance, dict[str, float]]:
        """Return the balance at the positions of the resolution, or at enough of them and its discretisation error."""
        if assembly.resolution.n_positions is not None:
            return self.balance(assembly), {}
        balance, change = self._doubled(assembly, with_limit_drag=True)
        return balance, {"positions_error": change}

    def _doubled(
        self, assembly: Assembly, *, with_limit_drag: bool = False
    ) -> tuple[TorqueBalance, float]:
        """Double the roller positions until the torques change by less than the tolerance, relative to the largest.

        With the limit drag go on until its error is below the tolerance, too, up to a number of positions.
        """
        tolerance = assembly.scene.accuracy.tolerance
        before = None
        n_positions = minimum_positions(assembly)
        change = np.inf
        while n_positions <= _MAX_POSITIONS:
            balance = self._balance(assembly, n_positions)
            torques = self._compared_torques(balance)
            if before is not None:
                size = min(before.size, torques.size)  # laws may have no value at the largest slips
                change = largest_relative_change(before[None, :size], torques[None, :size])
                if change <= tolerance and not (
                    with_limit_drag and self._needs_more_positions(balance)
                ):
                    return balance, change
            before = torques
            n_positions = 2 * n_positions
        raise ConvergenceError(
            f"the driving torque still moves by {change:.1e} (relative) from {n_positions // 4} to {n_positions // 2} "
            f"roller positions within a pitch; raise accuracy.tolerance, which is {tolerance:g}"
        )

    def _needs_more_positions(self, balance: TorqueBalance) -> bool:
        """Whether the error of the limit drag torque exceeds the tolerance and more roller positions are allowed."""
        onset = self._loading_branch(balance).skidding_jump
        if onset is None or balance.n_positions > _MAX_POSITIONS_FOR_LIMIT_DRAG:
            return False
        return not onset.error <= balance.assembly.scene.accuracy.tolerance

    def _compared_torques(self, balance: TorqueBalance) -> Array:
        """Return the torques at the slips that are compared [N m], without those at which a law has no value, (n,)."""
        slips = self.max_cage_slip * np.array(_COMPARED_FRACTIONS)
        while True:
            try:
                return balance.torques(slips)
            except (DomainError, ConvergenceError):  # at the end of the range
                slips = slips[:-1]
                if not slips.size:
                    raise

    def _inertia_effect(self, balance: TorqueBalance) -> float:
        """Return the largest relative difference between the torques without and with inertia of the rollers' spin."""
        other = balance.with_inertia(not self.inertia)
        torques = [self._compared_torques(balance), self._compared_torques(other)]
        inert, free = torques if self.inertia else reversed(torques)
        size = min(inert.size, free.size)
        scale = np.abs(inert[:size])
        return float((np.abs(free[:size] - inert[:size]) / np.where(scale > 0.0, scale, 1.0)).max())

    def _steady(
        self,
        balance: TorqueBalance,
        branch: LoadingBranch,
        states: list[Orbit],
        steady: list[SteadyMotion],
    ) -> dict[str, Any]:
        """Return the variables of steady slips; without a steady motion the cage rolls freely, which is stable."""
        kinds = [
            describe_stability(branch, state, motion)
            for state, motion in zip(states, steady, strict=False)
        ] or ["stable"]
        force = np.stack([state.force for state in states], axis=1)
        traction = np.stack([state.traction for state in states], axis=1)
        total = force.sum(axis=2)
        friction = np.divide(
            traction.sum(axis=2), total, out=np.full_like(total, np.nan), where=total > 0.0
        )
        return self.variables(
            steady_slip=np.array([s.cage_slip for s in states]),
            cage_speed=np.array(
                [
                    balance.assembly.kinematics.direction * balance.cage_speed(state.cage_slip)
                    for state in states
                ]
            ),
            torque=np.array([0.0 - balance.drag(state.cage_slip) for state in states]),
            stable=np.array([kind == "stable" for kind in kinds]).astype(np.int8),
            stability=np.array(kinds),
            multiplier=np.array([s.multiplier for s in states]),
            effective_friction=friction,
            roller_slip=np.stack([s.roller_slip for s in states]),
            normal_force=force,
        )

    def _unsteady(self, positions: int) -> dict[str, Any]:
        """Return the variables of `_steady` where there is no steady slip: NaN."""
        none = np.full(1, np.nan)
        return self.variables(
            steady_slip=none,
            cage_speed=none,
            torque=none,
            stable=np.zeros(1, np.int8),
            stability=np.array(["no steady slip"]),
            multiplier=none,
            effective_friction=np.full((len(RINGS), 1), np.nan),
            film_parameter=np.full((len(RINGS), 1), np.nan),
            roller_slip=np.full((1, positions), np.nan),
            normal_force=np.full((len(RINGS), 1, positions), np.nan),
        )

    def _balances(
        self, assembly: Assembly, n_positions: int, name: str
    ) -> Callable[[float], TorqueBalance]:
        """Return a function from an operating condition to the torque balance there, with a cache of the last one."""

        @lru_cache(maxsize=1)
        def balance(value: float) -> TorqueBalance:
            there = assemble(
                evolve(assembly.scene, {f"operation.{name}": value}, si=True), assembly.resolution
            )
            return self._balance(
                there.with_bounds(*assembly.inner.chain.bounds).with_resistance(), n_positions
            )

        return balance

    def _at_load(self, balance: TorqueBalance) -> Callable[[float], TorqueBalance]:
        """Return a function from a load [N] to the torque balance of the same bearing there; see `Assembly.at_load`."""
        return lambda load: TorqueBalance(
            balance.assembly.at_load(load),
            balance.drags,
            n_positions=balance.n_positions,
            inertia=self.inertia,
            similar=balance,
        )

    def _minimum_load(self, balance: TorqueBalance, slip: float) -> dict[str, Any]:
        """Return the variables of the minimum load for a slip, and of the catalogue minimum loads."""
        scene = balance.assembly.scene
        weight = rollers_weight(balance.assembly)
        at_load = lru_cache(maxsize=1)(self._at_load(balance))
        load, status, slips = minimum_load(at_load, scene.operation.load, slip, weight)
        makers, statuses = minimum_loads_of_makers(scene)
        variables = self.variables(
            minimum_load=load,
            minimum_load_status=status,
            makers_minimum_load=makers,
            makers_status=statuses,
        )
        variables["minimum_load"][2]["floor"] = weight
        if slips:  # a list of one value would be read from a file as that value
            variables["minimum_load"][2]["slips"] = list(slips) if len(slips) > 1 else slips[0]
        return variables

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return relative errors of the numbers of a result by name, from a bearing with a finer resolution.

        Parameters
        ----------
        finer : Assembly
            The bearing with the finer resolution.
        dataset : Dataset
            The result.
        """
        finer = finer.with_resistance()
        balance = self.balance(finer)
        return estimate_answer_errors(balance, self._at_load(balance), without_play(dataset))

    def _followed(
        self,
        assembly: Assembly,
        n_positions: int,
        name: str,
        limits: tuple[float, float],
        slips: list[float],
    ) -> list[Branch]:
        """Return branches of steady slips over an operating condition, that of the smallest slip first."""
        balance = self._balances(assembly, n_positions, name)

        def steady_slips(value: float) -> list[float]:
            """Return the positive steady slips at a value of the condition."""
            there = balance(value)
            motions = self._loading_branch(there).find_steady_motions(there.drag)
            return [motion.slip for motion in motions if motion.slip > 0.0]

        here = float(getattr(assembly.scene.operation, name))
        starts = [(slip, here) for slip in slips if limits[0] <= here <= limits[1] and slip > 0.0]
        if not starts:
            starts = [(slip, value) for value in limits for slip in steady_slips(value)]
        branches: list[Branch] = []
        for slip, value in starts:
            if any(branch.passes(slip, value) for branch in branches):
                continue
            try:
                branch = follow(
                    lambda s, p: balance(p).excess(s), (slip, value), limits, self.max_cage_slip
                )
            except ConvergenceError as error:
                unit, what = VARIED[name]
                raise ConvergenceError(
                    f"followed against {what} [{unit}]: {error}; narrow {self.table}.{name}"
                ) from error
            branches.append(branch)
        return branches


def _play_attributes(assembly: Assembly, states: list[Orbit]) -> dict[str, float]:
    """Return the play of rollers without a cage [m] and the slip that it adds at most; empty with a cage."""
    if assembly.scene.models.neighbour_friction is None:
        return {}
    play = train_play(assembly.scene.bearing)
    orbit = assembly.kinematics.orbit_radius
    return {"train_play": play, "slower_by_play": slower_by_play(play, states[0].force[0], orbit)}


def _branch_variables(name: str, branches: list[Branch], no_fold: str) -> dict[str, Any]:
    """Return the variables of followed branches; ``no_fold`` is the status where the first one has no fold."""
    fold = branches[0].nearest_fold() if branches else None
    value = np.nan
    slip = np.nan
    if fold is not None:
        value = float(branches[0].parameter[fold])
        slip = float(branches[0].slip[fold])
    columns: list[dict[str, Any]] = [
        {
            name: branch.parameter,
            f"{name}_slip": branch.slip,
            f"{name}_stable": branch.stable.astype(np.int8),
            f"{name}_fold": branch.at_fold.astype(np.int8),
            f"{name}_branch": np.full(branch.slip.size, k),
        }
        for k, branch in enumerate(branches)
    ]
    values = dict[str, Any]()
    if columns:
        values = {key: np.concatenate([each[key] for each in columns]) for key in columns[0]}
    values |= {
        f"{name}_limit": value,
        f"{name}_limit_slip": slip,
        f"{name}_limit_status": no_fold if fold is None else str(Status.FOUND),
    }
    return SteadySlip.variables(**values)
