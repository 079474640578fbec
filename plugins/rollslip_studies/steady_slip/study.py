"""Study steady-slip: at which cage slips a bearing runs on, found without integrating in time.

- The rollers drive the cage, drags resist it; where both are in balance the slip is steady
  (`motion.torque_balance`). Traction has a maximum, so there are two such slips or none: at the smaller one
  more slip brings more torque and the cage holds it, at the larger one it runs away.
- Steady slips, the slip-drag curve and its maxima all come from one way up (`motion.loading_branch`): the motions of
  the rollers while the drag is raised slowly from none. It goes on until the cage all but stands, whatever the range
  of the curve, so that it is known where the cage runs, and where it runs away.
- The positions of the orbit are doubled until the torque stands still; what the last doubling still moved is reported,
  as is what the inertia of the rollers does.
- Against radial load, speed and temperature the slips are followed through the fold, where stable and unstable ones
  meet: the smallest load that still carries the drag.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly, assemble
from rollslip.bearing.cage import train_play
from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.resolution import Resolution, refined
from rollslip.errors import ConvergenceError, DomainError
from rollslip.fields import FieldError, at_least, in_range, parameter
from rollslip.results.dataset import about
from rollslip.results.words import Status
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
from rollslip.studies.error_estimate import choose_by_curves
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip_studies.motion.loading_branch import LoadingBranch, SteadyMotion
from rollslip_studies.motion.torque_balance import (
    RANGE,
    Orbit,
    TorqueBalance,
    look_along,
    minimum_positions,
    reserve,
    running,
    skidding_onset,
)  # fmt: skip
from rollslip_studies.motion.train import slower_by_play
from rollslip_studies.steady_slip import band
from rollslip_studies.steady_slip.branches import Branch, follow
from rollslip_studies.steady_slip.evaluated import evaluated_slices, film_variables, require_driven
from rollslip_studies.steady_slip.losses import (
    acceptable_reserve,
    estimate_answer_errors,
    loss_variables,
)
from rollslip_studies.steady_slip.minimum_load import (
    RULES,
    minimum_load,
    minimum_loads_of_makers,
    rollers_weight,
)
from rollslip_studies.steady_slip.outputs import MEASURED, OUTPUTS, VARIED, followed_outputs
from rollslip_studies.steady_slip.slip_drag import slip_drag_variables
from rollslip_studies.steady_slip.statuses import (
    describe_no_fold,
    describe_stability,
    describe_steady_status,
)

if TYPE_CHECKING:
    import xarray as xr

#: Instants of a pitch at which doublings give up.
_MAX_POSITIONS: Final = 256
#: And beyond which these go on for no maximum.
_MOST_OF_A_JUMP: Final = 16
#: Slips at which accuracy is judged, relative to the largest.
_JUDGED: Final = (0.02, 0.15, 0.5, 1.0)
#: Share of the tolerances that slices and instants may use.
_FRACTION: Final = 0.5
#: Ways up that a run finds while it doubles instants, slips of one, motions of the rollers of a followed branch, and
#: ways up of a search for a least load at a slip where rollers have several motions.
_WAYS = 2
_SLIPS = 25
_BRANCH = 350
_LOADS = 9
#: What an acceptable slip gives.
_MINIMUM_LOAD: Final = frozenset(
    f"{name}{of}" for name in ("minimum_load", "acceptable_reserve") for of in ("", "_status")
) | {"makers_minimum_load", "makers_status"}


def _range(name: str) -> Any:
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
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"orbits": "a steady motion of the rollers for every slip that is asked for"}
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
        doc="slips of the slip-drag curve, at least; the way up has its own",
        validator=at_least(6),
    )
    inertia: bool = parameter(
        default=True, doc="whether the spin of a roller has inertia along the orbit"
    )
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
        for name in VARIED:
            limits = getattr(self, name)
            if limits and not (len(limits) == 2 and limits[0] < limits[1]):
                raise FieldError(
                    name, f"must be two values that ascend, or empty, not {list(limits)}"
                )

    @property
    def libraries(self) -> tuple[str, ...]:  # type: ignore[override]
        """SciPy where slips are followed; its import takes longer than other runs."""
        followed = any(getattr(self, name) for name in VARIED)
        return ("scipy.optimize", "scipy.interpolate") if followed else ()

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers the slip-drag curve holds at least."""
        return {"points": 4.0 * self.points}

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate."""
        loads = assembly.load_distribution(1)
        require_driven = np.count_nonzero(loads.inner_load) + np.count_nonzero(loads.outer_load)
        per_orbit = 10 * 2 * minimum_positions(assembly)
        followed = sum(bool(getattr(self, name)) for name in VARIED)
        return int(require_driven) * per_orbit * (3 * self.points + 60 + 350 * followed)

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_cage_slip

    @property
    def is_averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        return True

    @property
    def has_nested_positions(self) -> bool:
        """Whether fewer instants are among more; each number is computed for itself."""
        return False

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices, instants and laws by the slip-drag curve."""
        found = choose_by_curves(self, assembly, fraction=_FRACTION, cheaper_laws=cheaper_laws)
        n_positions = max(found.resolution.n_positions or 0, minimum_positions(assembly))
        return attrs.evolve(
            found, resolution=attrs.evolve(found.resolution, n_positions=n_positions)
        )

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return four times as fine a resolution: the finest would take days."""
        return refined(scene, own), "against four times as fine"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of the motions of the rollers, from a few of them."""
        bearing = assembly.with_resistance()
        n_positions = assembly.resolution.n_positions or 2
        balance = TorqueBalance(
            bearing, bearing.cage.drags, n_positions=n_positions, inertia=self.inertia
        )
        followed = _BRANCH * sum(bool(getattr(self, name)) for name in VARIED) / (2 * _SLIPS)
        ways = self.acceptable_slip is not None and balance.has_several(self.acceptable_slip)
        return {"orbits": balance.seconds() * (_WAYS + followed + ways * _LOADS)}

    def without_outputs(self, outputs: frozenset[str]) -> "SteadySlip":
        """Return a study that does not follow the slips against what nobody asked for."""
        dropped: dict[str, object] = {
            name: () for name in VARIED if outputs >= followed_outputs(name).keys()
        }
        if outputs >= _MINIMUM_LOAD:
            dropped["acceptable_slip"] = None
        return self.with_settings(**dropped) if dropped else self

    def compared_values(self, dataset: "xr.Dataset") -> dict[str, ComparedValues]:
        """Return the least steady slip that the cage holds."""
        stable = (
            dataset["stable"].to_numpy() == 1 if "stable" in dataset else np.zeros(0, dtype=bool)
        )
        slip = float(dataset["steady_slip"].to_numpy()[stable][0]) if stable.any() else np.nan
        return {"steady cage slip": ComparedValues([[slip]], str(dataset["status"].item()))}

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return the driving torque, (k, 1, n), each number of instants for itself."""
        bearing = assembly.with_resistance()
        balances = [self._balance(bearing, m) for m in n_positions]
        return np.array([[balance.torques(slip)] for balance in balances])

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate contacts on the way up."""
        look_along(assembly, max(RANGE, self.max_cage_slip), inertia=self.inertia)

    @property
    def validity_state(self) -> str:
        """What state `validity_slices` are at."""
        return "at the steady slip"

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices at the steady slips, or where there is none at that of the largest drag."""
        slips = np.atleast_1d(
            dataset["steady_slip" if "steady_slip" in dataset else "skidding_slip"].to_numpy()
        )
        balance = self._balance(assembly, int(dataset.attrs["n_positions"]))
        return evaluated_slices(
            balance, (balance.orbit(float(slip)) for slip in slips if np.isfinite(slip))
        )

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags.

        Raises
        ------
        SceneError, PluginError
            If the cage is wrong, or they are not there.
        """
        return tuple(("drag", model) for model in assembly.cage.drags)

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the slip-drag curve, the steady slips, and how they go with what is varied.

        Returns
        -------
        xarray.Dataset
            Dimensions (cage_slip,): driving_torque, drag_torque; (steady,): steady_slip, cage_speed, torque, stable,
            stability, multiplier, stored_power, friction_torque; (ring, steady): effective_friction, film_parameter,
            ring_power; (source, steady): loss; (steady, angle): roller_slip; (ring, steady, angle): normal_force, all
            of these one NaN where there is no steady slip; scalars: status, limit_drag, skidding_slip,
            skidding_status, limit_drag_error, _low and _high, jump_slip, largest_torque, largest_torque_slip,
            largest_torque_error, first_maximum_torque, first_maximum_slip. For each varied quantity X, if a branch was
            found, (X_point,): X, X_slip, X_stable, X_fold, X_branch; scalars X_limit, X_limit_slip, X_limit_status.

        Raises
        ------
        SceneError
            If the cage is wrong, or no roller is loaded on the inner ring.
        DomainError
            If a law has no value at any slip, or the epicyclic cage speed is zero.
        ConvergenceError
            If doubling the positions does not settle it.
        """
        assembly = require_driven(assembly).with_resistance()
        balance, errors = self._converged(assembly)
        n_positions = balance.n_positions
        way = self._way(balance)
        steady = [] if balance.rolls_freely else way.find_steady_motions(balance.drag)
        slips = [0.0] if balance.rolls_freely else [one.slip for one in steady]
        states = [balance.orbit_of(one.motion) for one in steady]
        if not states:
            end = min(self.max_cage_slip, way.end)
            states = [
                balance.orbit(slip) for slip in slips or [fraction * end for fraction in _JUDGED]
            ]
        variables, coords, error = slip_drag_variables(
            balance, way, slips, self.max_cage_slip, self.points, self.table
        )
        positions = states[0].roller_slip.size
        variables |= (
            self._steady(balance, way, states, steady) if slips else self._unsteady(positions)
        )
        angle = 2.0 * np.pi * np.arange(positions) / positions
        coords["angle"] = (
            "angle",
            angle,
            about("rad", "position from the line of load, in the sense of the orbit"),
        )
        variables |= film_variables(self, balance, states, steady=bool(slips))
        lost, source = loss_variables(balance, states, steady=bool(slips))
        variables = variables | lost
        coords = coords | source
        variables |= self.variables(
            status=describe_steady_status(balance, way, slips)
        ) | self._reserve(balance)
        for name in VARIED:
            if limits := getattr(self, name):
                found = self._followed(assembly, n_positions, name, limits, slips)
                variables |= _branches(
                    name,
                    limits,
                    found,
                    describe_no_fold(
                        name,
                        limits,
                        found,
                        self.table,
                        self.max_cage_slip,
                        free=balance.rolls_freely,
                    ),
                )
        if self.acceptable_slip is not None:
            variables |= self._minimum_load(assembly, n_positions, self.acceptable_slip)
            kept, known = acceptable_reserve(balance, self.acceptable_slip)
            variables |= self.variables(acceptable_reserve=kept, acceptable_reserve_status=known)
            coords["maker"] = "maker", list(RULES), about("1", "maker of bearings")
        import xarray as xr

        return xr.Dataset(
            variables,
            coords,
            attrs=self.attributes
            | {
                "friction": "conventional",
                "inertia": int(self.inertia),
                "inertia_effect": self._inertia_effect(balance),
                "n_positions": n_positions,
                "curve_error": error,
                "slices": assembly.slices,
                "rollers_weight": rollers_weight(assembly),
                **errors,
                **_by_play(assembly, states),
                **(
                    {}
                    if self.acceptable_slip is None
                    else {"acceptable_slip": self.acceptable_slip}
                ),
            },
        )

    def partial_result(self, assembly: Assembly, outputs: frozenset[str]) -> PartialResult | None:
        """Return steady slips and status, or a least load, as `run` finds them; None if more is asked than these."""
        if outputs <= {"minimum_load", "minimum_load_status"} and self.acceptable_slip is not None:
            return self._minimum_load(
                assembly, self.balance(assembly).n_positions, self.acceptable_slip
            ), {}
        if not outputs <= {"steady_slip", "status"}:
            return None
        _, steady, status = self.steady(assembly)
        known = np.array([one.slip for one in steady] or [np.nan])
        return self.variables(status=status, steady_slip=known), {
            "steady": ("steady", np.arange(known.size), about("1", "steady cage slip"))
        }

    def steady(self, assembly: Assembly) -> tuple[TorqueBalance, list[SteadyMotion], str]:
        """Return the balance of torques of a bearing, its steady slips on the way up, and what was found in words.

        A cage that nothing drags has slip 0, which nothing needs to hold.
        """
        assembly = require_driven(assembly).with_resistance()
        balance = (
            self._doubled(assembly)[0]
            if assembly.resolution.n_positions is None
            else self.balance(assembly)
        )
        way = self._way(balance)
        if balance.rolls_freely:
            found = [
                SteadyMotion(0.0, 0.0, balance.motions.find(np.zeros(1))[0][0], lambda: np.inf)
            ]
        else:
            found = way.find_steady_motions(balance.drag)
        return balance, found, describe_steady_status(balance, way, [one.slip for one in found])

    def balance(self, assembly: Assembly) -> TorqueBalance:
        """Return the balance of torques of a bearing at its instants, with resistance to rolling if it has some."""
        return self._balance(
            assembly, max(assembly.resolution.n_positions or 0, minimum_positions(assembly))
        )

    def _balance(self, assembly: Assembly, n_positions: int) -> TorqueBalance:
        return TorqueBalance(
            assembly, assembly.cage.drags, n_positions=n_positions, inertia=self.inertia
        )

    def _way(self, balance: TorqueBalance) -> LoadingBranch:
        """The way up, until the cage all but stands."""
        return balance.loading_branch(max(RANGE, self.max_cage_slip))

    def _reserve(self, balance: TorqueBalance) -> dict[str, Any]:
        largest = max(RANGE, self.max_cage_slip)
        away = skidding_onset(balance, largest, f"{self.table}.max_cage_slip")
        runs = running(balance, largest)
        kept = reserve(balance, away, runs, largest)
        return self.variables(drag_reserve=kept.factor, reserve_status=kept.status)

    def _converged(self, assembly: Assembly) -> tuple[TorqueBalance, dict[str, float]]:
        """Balance at the instants of the resolution, or at those that settle it, then with the error that is left."""
        if assembly.resolution.n_positions is not None:
            return self.balance(assembly), {}
        balance, moved = self._doubled(assembly, jump=True)
        return balance, {"positions_error": moved}

    def _doubled(self, assembly: Assembly, *, jump: bool = False) -> tuple[TorqueBalance, float]:
        """Double the instants until the torque moves by less than the tolerance, relative to its largest value.

        So long as there are not too many, also until the drag of running away is told to within it.
        """
        tolerance = assembly.scene.accuracy.tolerance
        before = None
        n_positions = minimum_positions(assembly)
        moved = np.inf
        while n_positions <= _MAX_POSITIONS:
            balance = self._balance(assembly, n_positions)
            torque = self._judged(balance)
            if before is not None:
                moved = _moved(before, torque)
                away = self._way(balance).skidding_jump if jump and moved <= tolerance else None
                told = away is None or away.error <= tolerance or n_positions > _MOST_OF_A_JUMP
                if moved <= tolerance and told:
                    return balance, moved
            before = torque
            n_positions = 2 * n_positions
        raise ConvergenceError(
            f"the driving torque still moves by {moved:.1e} (relative) from {n_positions // 4} to {n_positions // 2} "
            f"roller positions within a pitch; raise accuracy.tolerance, which is {tolerance:g}"
        )

    def _judged(self, balance: TorqueBalance) -> Array:
        slips = self.max_cage_slip * np.array(_JUDGED)
        while True:
            try:
                return balance.torques(slips)
            except (
                DomainError,
                ConvergenceError,
            ):  # at the end of the range, which the least slip does not need
                slips = slips[:-1]
                if not slips.size:
                    raise

    def _inertia_effect(self, balance: TorqueBalance) -> float:
        """Largest relative difference of the torque without inertia of the rollers from that with it."""
        torques = [self._judged(balance), self._judged(balance.with_inertia(not self.inertia))]
        inert, free = torques if self.inertia else reversed(torques)
        inert, free = inert[: free.size], free[: inert.size]
        scale = np.abs(inert)
        return float((np.abs(free - inert) / np.where(scale > 0.0, scale, 1.0)).max())

    def _steady(
        self,
        balance: TorqueBalance,
        way: LoadingBranch,
        states: list[Orbit],
        steady: list[SteadyMotion],
    ) -> dict[str, Any]:
        kinds = (
            [describe_stability(way, *one) for one in zip(states, steady, strict=True)]
            if steady
            else ["stable"]
        )
        force = np.stack([state.force for state in states], axis=1)
        traction = np.stack([state.traction for state in states], axis=1)
        total = force.sum(axis=2)
        friction = np.divide(
            traction.sum(axis=2), total, out=np.full_like(total, np.nan), where=total > 0.0
        )
        direction = balance.assembly.kinematics.direction
        return self.variables(
            steady_slip=np.array([s.cage_slip for s in states]),
            cage_speed=np.array(
                [direction * balance.cage_speed(state.cage_slip) for state in states]
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
        """What `_steady` gives where there is no steady slip: nothing, whose status says why."""
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
        """Balances of the bearing by the value of a quantity of the operation; the last one is kept."""

        @lru_cache(maxsize=1)
        def balance(value: float) -> TorqueBalance:
            there = assemble(
                evolve(assembly.scene, {f"operation.{name}": value}), assembly.resolution
            )
            return self._balance(
                there.with_bounds(*assembly.inner.chain.bounds).with_resistance(), n_positions
            )

        return balance

    def _minimum_load(self, assembly: Assembly, n_positions: int, slip: float) -> dict[str, Any]:
        """Return the least radial load of a slip, and what makers ask for."""
        bearing = assembly.with_resistance()

        @lru_cache(maxsize=1)
        def balance(load: float) -> TorqueBalance:
            return self._balance(bearing.at_load(load), n_positions)

        begin = assembly.scene.operation.radial_load
        weight = rollers_weight(assembly)
        load, status, slips = minimum_load(balance, begin, slip, weight)
        makers, statuses = minimum_loads_of_makers(assembly.scene)
        found = self.variables(
            minimum_load=load,
            minimum_load_status=status,
            makers_minimum_load=makers,
            makers_status=statuses,
        )
        found["minimum_load"][2]["floor"] = weight
        if slips:  # a file gives one value back as that
            found["minimum_load"][2]["slips"] = list(slips) if len(slips) > 1 else slips[0]
        return found

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return by how much numbers of the answer are off."""
        finer = finer.with_resistance()
        balance = self.balance(finer)
        return estimate_answer_errors(
            balance, self._balances(finer, balance.n_positions, "radial_load"), dataset
        )

    def _followed(
        self,
        assembly: Assembly,
        n_positions: int,
        name: str,
        limits: tuple[float, float],
        slips: list[float],
    ) -> list[Branch]:
        """Branches of steady slips against a quantity of the operation, that of the least slip first."""
        balance = self._balances(assembly, n_positions, name)

        def at(value: float) -> list[float]:
            one = balance(value)
            return [
                found.slip
                for found in self._way(one).find_steady_motions(one.drag)
                if found.slip > 0.0
            ]

        here = float(getattr(assembly.scene.operation, name))
        starts = [(slip, here) for slip in slips if limits[0] <= here <= limits[1] and slip > 0.0]
        if not starts:
            starts = [(slip, value) for value in limits for slip in at(value)]
        found: list[Branch] = []
        for slip, value in starts:
            if not any(branch.passes(slip, value) for branch in found):
                try:
                    branch = follow(
                        lambda s, p: balance(p).excess(s), (slip, value), limits, self.max_cage_slip
                    )
                except ConvergenceError as error:
                    of = f"followed against {VARIED[name][1]} [{VARIED[name][0]}]"
                    raise ConvergenceError(f"{of}: {error}; narrow {self.table}.{name}") from error
                found.append(branch)
        return found


def _by_play(assembly: Assembly, states: list[Orbit]) -> dict[str, float]:
    """How much slower play makes a train of rollers without a cage; nothing with one."""
    if assembly.scene.models.neighbour_friction is None:
        return {}
    play = train_play(assembly.scene.bearing)
    orbit = assembly.kinematics.orbit_radius
    return {"train_play": play, "slower_by_play": slower_by_play(play, states[0].force[0], orbit)}


def _moved(before: Array, after: Array) -> float:
    after, before = after[: before.size], before[: after.size]  # as far as laws have values
    return float(np.abs(after - before).max() / (np.abs(after).max() or 1.0))


def _branches(
    name: str, limits: tuple[float, float], branches: list[Branch], describe_no_fold: str
) -> dict[str, Any]:
    limit = branches[0].nearest_fold() if branches else None
    value = np.nan
    slip = np.nan
    status = describe_no_fold
    if limit is not None:
        status = str(Status.FOUND)
        value = float(branches[0].parameter[limit])
        slip = float(branches[0].slip[limit])
    along: dict[str, list[Any]] = {
        name: [b.parameter for b in branches],
        f"{name}_slip": [b.slip for b in branches],
        f"{name}_stable": [b.stable.astype(np.int8) for b in branches],
        f"{name}_fold": [b.at_fold.astype(np.int8) for b in branches],
        f"{name}_branch": [np.full(b.slip.size, k) for k, b in enumerate(branches)],
    }
    values: dict[str, Any] = (
        {key: np.concatenate(each) for key, each in along.items()} if branches else {}
    )
    values |= {f"{name}_limit": value, f"{name}_limit_slip": slip, f"{name}_limit_status": status}
    return SteadySlip.variables(**values)
