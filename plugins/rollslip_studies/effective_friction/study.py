"""Study effective-friction: friction of each raceway as a whole over the cage slip, and the critical cage slip.

One revolution is one to two orders shorter than the transient of the cage, so that a raceway acts on the cage through
its effective friction mu_e = sum(mu_km Q_km)/sum(Q_km) over its *loaded* contacts k and the roller positions m of a
revolution (Klebanov et al. 2022). A mean over unloaded rollers, too, is a known mistake. With slices the sum is over
them as well. Effective friction is positive where it drives the cage towards its epicyclic speed. With a driving outer
ring that is against the sense in which rolling speeds are positive, hence the sign in ``LoadedContacts``.

1. Equal rollers repeat after one pitch, so the positions are within one pitch. Double them until the curves and their
   maxima change by less than the tolerance; the last change is reported as discretisation error.
2. The critical slip of a curve is that of its maximum, with the closure for the rollers' spin.
3. The map over cage slip and roller slip, which needs no closure, is evaluated beside the curves.
4. Where skidding begins, and at which slip the cage runs with the drags of the scene, follows from the torque balance
   with freely spinning rollers on both rings (`motion.loading_branch`).
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar, Final, Self

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Critical, slip_grid
from rollslip.bearing.equilibrium import LoadDistribution
from rollslip.bearing.raceway import PROBES, RINGS, Array, LoadedContacts
from rollslip.errors import ConvergenceError
from rollslip.fields import at_least, choice_of, in_range, parameter
from rollslip.results.curves import FIRST, Curves
from rollslip.results.dataset import about, xr
from rollslip.scene.values import Scene
from rollslip.studies.answers import LoadedSlices, Measurable, Output, PartialResult, RunContext
from rollslip.studies.bounds import MINIMUM_ERROR_FACTOR
from rollslip.studies.study import CONTACT_CHOICES, N_VALIDITY_SLIPS, Study
from rollslip.studies.timing import N_POSITIONS, POINTS, extrapolate_line, processor_time
from rollslip_studies.effective_friction.raceways import (
    REGIMES,
    LoadedRaceways,
    Maxima,
    find_maxima,
    largest_relative_change,
    regime_variables,
)
from rollslip_studies.motion.loading_branch import branch_slips
from rollslip_studies.motion.orbit_loads import check_repeats
from rollslip_studies.motion.torque_balance import (
    SkiddingOnset,
    TorqueBalance,
    evaluate_on_branch,
    reserve,
    running,
    skidding_onset,
    torque_balance,
)

#: Roller positions within a pitch at which doubling starts. Any small number serves; chosen.
_FIRST_POSITIONS: Final = 2
#: Roller positions above which the run fails. Twice as many take twice the time of the last step; chosen.
_MAX_POSITIONS: Final = 1024

#: Slices up to which the times of a cost estimate are measured; above it they are proportional to the number of slices.
#: Half as many would measure the overhead of a call. Chosen.
_MAX_TIMED_SLICES: Final = 128
#: Points of the two maps whose times are extrapolated linearly. Larger ones cost more than they improve. Chosen.
_TIMED_MAP_POINTS: Final = (3, 6)
#: Evaluations of the search for the critical slips of both rings, each of one ring. The estimated time of the search is
#: proportional to it; four scenes of the catalogue take 2 to 32. Chosen, rather too large.
_SEARCH_EVALUATIONS: Final = 40
#: Error of the smallest film parameter just before a roller jumps to another balance of forces. It is a bound; it falls
#: only with the number of roller positions, because the jump lies between two of them.
FILM_AT_JUMPS: Final = "film parameter, where rollers jump,"
#: Closure -> its name in texts on critical slips.
CLOSURES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "epicyclic": "with rollers in pure rolling",
        "outer-rolling": "with rollers that roll on the outer ring",
        "free-roller": "with the roller speed from its balance of moments",
    }
)

#: Outputs of the maxima of curves, in the order of the fields of `Critical`.
_MAXIMA: Final = (
    *("critical_cage_slip", "critical_friction", "critical_status", *FIRST),
    "critical_slip_bound",
)
#: Outputs of the curves and their maxima.
_CURVE_OUTPUTS: Final = frozenset({"effective_friction", *_MAXIMA})
#: Dimensions of the curves.
_CURVE: Final = "ring cage_slip"
#: Variables of the study by name.
OUTPUTS: Final[Mapping[str, Output]] = MappingProxyType(
    {
        "effective_friction": Output(_CURVE, "1", "effective friction coefficient"),
        "critical_cage_slip": Output(
            "ring",
            "1",
            "cage slip of the largest effective friction",
            status="critical_status",
            default=True,
        ),
        "critical_friction": Output(
            "ring",
            "1",
            "largest effective friction coefficient",
            status="critical_status",
            default=True,
        ),
        "critical_status": Output("ring", "1", "what was found of the slip at largest traction"),
        "critical_slip_bound": Output(
            "ring",
            "1",
            "lower bound of the cage slip at largest traction: that slip, or the end of the range",
            status="critical_status",
            default=True,
        ),
        "first_maximum_slip": Output(
            "ring",
            "1",
            "cage slip from which effective friction first falls",
            status="critical_status",
        ),
        "first_maximum_friction": Output(
            "ring", "1", "effective friction coefficient there", status="critical_status"
        ),
        "skidding_slip": Output("", "1", "cage slip at which skidding begins", status="skidding_status"),
        "limit_drag": Output(
            "",
            "N m",
            "limit drag torque",
            status="skidding_status",
            aliases=("limit_drag_torque",),
        ),
        "skidding_status": Output("", "1", "what was found of skidding"),
        "steady_cage_slip": Output(
            "",
            "1",
            "cage slip at which the drags are carried",
            status="steady_status",
            aliases=("slip", "steady_slip"),
        ),
        "steady_drag": Output("", "N m", "drag torque there", status="steady_status"),
        "steady_status": Output("", "1", "what was found of the slip at which the cage runs"),
        "drag_reserve": Output("", "1", "largest torque over drag before the cage skids", status="reserve_status"),
        "reserve_status": Output("", "1", "what was found of the reserve: found, at least, or why there is none"),
        "driving_torque": Output("torque_slip", "N m", "torque of the rollers on the cage on the loading branch"),
        "drag_torque": Output("branch_slip", "N m", "torque by which the drags resist the cage"),
        "roller_slip": Output(_CURVE, "1", "roller slip, mean over the loaded contacts"),
        "sliding_speed": Output(_CURVE, "m/s", "sliding speed, mean over them"),
        "rolling_speed": Output(_CURVE, "m/s", "rolling speed, mean over them"),
        "film_parameter": Output(_CURVE, "1", "smallest film parameter Lambda"),
        **REGIMES,
        "normal_force": Output("ring roller", "N", "normal force at the first roller position"),
        "angle": Output("roller", "rad", "position from the line of load, first roller position"),
        "roller_friction": Output(
            "ring roller cage_slip",
            "1",
            "friction coefficient of each roller, first roller position",
        ),
        "friction_map": Output("ring map_cage_slip map_roller_slip", "1", "effective friction coefficient"),
    }
)  # fmt: skip
#: Outputs that need the whole curve, and not its maxima alone.
_WHOLE_CURVE: Final = frozenset({"effective_friction"})
#: Ratio of the relative differences of the film parameter from its minimum, at both neighbours of the minimum, above
#: which rollers jump to another motion between them. At a smooth minimum the ratio is near 1. Twice as much misses
#: small jumps; half as much may take an asymmetric minimum for a jump, with a bound that is too large. Chosen.
_JUMP_RATIO: Final = 10.0
#: Outputs of the onset of skidding.
_SKIDDING: Final = frozenset({"skidding_slip", "limit_drag", "skidding_status"})
#: Outputs of the drag reserve.
_RESERVE: Final = frozenset({"drag_reserve", "reserve_status"})
#: Outputs of the steady slip, with the reserve.
_STEADY: Final = frozenset({"steady_cage_slip", "steady_drag", "steady_status"}) | _RESERVE
#: Outputs of the balance of torques over the slip.
_TORQUES: Final = frozenset({"driving_torque", "drag_torque"})
#: All outputs of the balance of torques.
_BALANCE: Final = _SKIDDING | _STEADY | _TORQUES


@attrs.frozen(kw_only=True)
class EffectiveFriction(Study):
    """Friction of each raceway as a whole against cage slip, and the critical cage slip."""

    name: ClassVar[str] = "effective-friction"
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"friction": "effective_friction", "critical_slip": "critical_cage_slip"}
    )
    irreducible_errors: ClassVar[Mapping[str, str]] = MappingProxyType(
        {FILM_AT_JUMPS: "it is that just before one jumps, between two positions"}
    )
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    curves_of: ClassVar[Curves] = Curves(
        variable="effective_friction", over="ring", slip="cage_slip", critical="critical_cage_slip"
    )
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "friction": "the models of a contact on every loaded slice, over the slips and in search of the largest",
            "film regimes": "evaluated for every loaded slice, over the slips of the curve",
            "skidding": "the balance of torques of freely spinning rollers, about its maximum and at the drags",
            "map": "friction over cage slip and roller slip|over few loads with weights in place of all "
            "slices",
        }
    )
    shares_resolution: ClassVar[bool] = True
    measured: ClassVar[Mapping[str, Measurable]] = MappingProxyType(
        {
            "critical-slip": Measurable(variable="critical_cage_slip", missing_is_above=True),
            "skidding-slip": Measurable(variable="skidding_slip", missing_is_above=True),
            "limit-drag": Measurable(variable="limit_drag"),
        }
    )

    closure: str = parameter(
        default="free-roller",
        doc="what the rollers spin at",
        validator=choice_of("outer-rolling", "epicyclic", "free-roller"),
    )
    max_cage_slip: float = parameter(
        default=0.4,
        unit="1",
        doc="largest cage slip, by default less where the slower ring turns as the cage does",
        validator=in_range(0.0, 1.0, open=True),
    )
    skidding_range: float = parameter(
        default=0.95,
        unit="1",
        doc="largest cage slip up to which skidding is searched, whatever the curve's; 0 for no search",
        validator=in_range(0.0, 0.99),
    )
    torque_slips: tuple[float, ...] = parameter(
        default=(), doc="ascending cage slips of driving_torque; none for those of the search"
    )
    points: int = parameter(
        default=101, doc="cage slips of the curve, denser towards zero", validator=at_least(5)
    )
    map_points: int = parameter(
        default=15,
        doc="cage slips, and roller slips either way, of the map; 0 for none",
        validator=at_least(0),
    )
    per_roller: bool = parameter(
        default=False, doc="store the friction of every roller at the first roller position"
    )

    @classmethod
    def from_scene(cls, scene: Scene) -> Self:
        """Return the study with the settings of a scene.

        A contact draws no oil in where the cage turns as fast as its ring. The largest cage slip is a fraction of the
        slip there, unless the scene states it.

        Parameters
        ----------
        scene : Scene
            The scene.
        """
        study = super().from_scene(scene)
        if "max_cage_slip" in scene.study.get(cls.name, {}) or not scene.operation.outer_speed:
            return study
        inner = scene.bearing.inner_raceway_diameter
        outer = scene.bearing.outer_raceway_diameter
        rings = (scene.operation.inner_speed, scene.operation.outer_speed)
        cage = (inner * rings[0] + outer * rings[1]) / (inner + outer)
        # the slower ring that turns as the cage does, if any; without a cage speed a slip is an error of its own
        ends = [1.0 - ring / cage for ring in rings if cage and 0.0 < ring / cage < 1.0]
        return attrs.evolve(study, max_cage_slip=study.max_cage_slip * min(ends, default=1.0))

    def with_bands(self, scene: "Scene", dataset: "xr.Dataset") -> "xr.Dataset":
        """Return a result with the band of its steady slip, as study steady-slip has it.

        Parameters
        ----------
        scene : Scene
            The scene of the result.
        dataset : Dataset
            The result.
        """
        from rollslip_studies.steady_slip.band import with_bands  # a late import: few runs need it

        return with_bands(scene, dataset, "steady_cage_slip")

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate: curve, maximum, error of the slices, and map."""
        loads = assembly.load_distribution(1)
        half = loads.psi.size // 2 + 1
        pairs = zip(assembly.raceways, (loads.inner_load, loads.outer_load), strict=True)
        contacts = sum(
            LoadedContacts(raceway, load[0, :half], assembly.widths, 1.0).force.size
            for raceway, load in pairs
        )
        n_positions = 2 * _FIRST_POSITIONS  # at which most curves converge
        per_point = 12 if self.closure == "free-roller" else 1
        curves = (_FIRST_POSITIONS + n_positions) * (
            self.points + 15
        ) + n_positions // 2 * self.points
        surface = self.map_points * max(2 * self.map_points - 1, 0)
        return (
            contacts * (curves * per_point + n_positions * PROBES * bool(surface))
            + 2 * 16 * surface
        )

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers curves and map have at least: those stored of a slip, and the rollers' speeds."""
        of_rollers = 6 * (self.closure == "free-roller") + 2 * self.per_roller
        surface = float(self.map_points) * max(2 * self.map_points - 1, 0)
        return {
            "points": float(self.points) * (16 + of_rollers * assembly.scene.bearing.rollers),
            "map_points": 8.0 * surface,
        }

    def without_outputs(self, outputs: frozenset[str]) -> "EffectiveFriction":
        """Return a study that does not compute outputs: the map, the torque balance, and single rollers."""
        return attrs.evolve(
            self,
            map_points=0 if "friction_map" in outputs else self.map_points,
            skidding_range=0.0 if outputs >= _SKIDDING | _STEADY else self.skidding_range,
            per_roller=self.per_roller and "roller_friction" not in outputs,
        )

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of loads, friction, regimes and map, extrapolated from coarse evaluations."""
        resolution = assembly.resolution
        slip = slip_grid(self.max_cage_slip, POINTS[0])[1:]
        coarse = assembly.at(
            attrs.evolve(resolution, slices=min(resolution.slices, _MAX_TIMED_SLICES))
        )
        times: dict[str, list[float]] = {
            "load distribution": [],
            "friction": [],
            "film regimes": [],
        }
        for m in N_POSITIONS:
            uncached = attrs.evolve(coarse, load_cache={})
            times["load distribution"].append(
                processor_time(partial(uncached.load_distribution, m), 1)
            )
            raceways = self.loaded(uncached, m)
            # the spin of a free roller is a root, which is found once
            closure = processor_time(partial(raceways.speeds, slip), 1) / slip.size
            speeds = raceways.speeds(slip)
            friction, regimes = (
                processor_time(partial(work, speeds)) / slip.size
                for work in (raceways.evaluated, raceways.regimes)
            )
            times["friction"].append(
                friction * (self.points + _SEARCH_EVALUATIONS / 2)
                + closure * (self.points + _SEARCH_EVALUATIONS / 4)
            )
            times["film regimes"].append(regimes * self.points)
        factor = assembly.slices / coarse.slices
        n_positions = resolution.n_positions or N_POSITIONS[-1]
        costs = {
            part: factor * extrapolate_line(N_POSITIONS, each, n_positions)
            for part, each in times.items()
        }
        if self.skidding_range:
            costs["skidding"] = torque_balance(assembly, n_positions).seconds(self.skidding_range)
        if self.map_points:
            maps = [
                processor_time(partial(raceways.map, self.max_cage_slip, n), 1)
                for n in _TIMED_MAP_POINTS
            ]
            small, large, own = (n * (2 * n - 1) for n in (*_TIMED_MAP_POINTS, self.map_points))
            costs["map"] = extrapolate_line((small, large), maps, own)
        return costs

    def loaded_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> Iterator[LoadedSlices]:
        """Yield the slices of both rings, slip by slip."""
        yield from self._evaluated(
            assembly, dataset.attrs["n_positions"], dataset["cage_slip"].to_numpy()
        )

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return the slices of both rings at a few slips of the curves, at one roller position."""
        slips = np.linspace(
            self.max_cage_slip / N_VALIDITY_SLIPS, self.max_cage_slip, N_VALIDITY_SLIPS
        )
        return "over the curves", [*self._evaluated(assembly, 1, slips)]

    def _evaluated(
        self, assembly: Assembly, n_positions: int, cage_slip: Array
    ) -> Iterator[LoadedSlices]:
        """Yield the slices of both rings at cage slips and a number of roller positions."""
        raceways = self.loaded(assembly, n_positions)
        for both in raceways.contacts(raceways.speeds(cage_slip)):
            for k, (contacts, u, V) in enumerate(both):
                yield LoadedSlices(
                    k, RINGS[k], contacts.slices.load, u, V, contacts.force, contacts.places
                )

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the effective friction curves, the critical cage slip and the map.

        Returns
        -------
        xarray.Dataset
            Dimensions (ring, cage_slip): effective_friction, sliding_speed, rolling_speed, film_parameter (smallest),
            roller_slip; (ring,): critical_cage_slip, critical_friction, critical_status, first_maximum_slip,
            first_maximum_friction; scalars, if skidding is searched: skidding_slip,
            limit_drag, skidding_status, steady_cage_slip, steady_drag, steady_status, drag_reserve, reserve_status;
            (ring, map_cage_slip, map_roller_slip): friction_map; (ring, roller): normal_force at the first
            position and, on request, (ring, roller, cage_slip): roller_friction, NaN where the roller is not loaded.
            Numbers that were not found are NaN, with a status.

        Raises
        ------
        SceneError
            If no roller is loaded on the inner ring.
        DomainError
            If a contact rolls backwards at a cage slip of the range, or a law has no value there.
        ConvergenceError
            If the curve does not converge over the numbers of roller positions, or the radial load is lost among
            centrifugal forces.
        """
        if assembly.resolution.n_positions is not None:
            return self.at_positions(assembly, assembly.resolution.n_positions)
        slip = slip_grid(self.max_cage_slip, self.points)
        raceways, curves, critical, error = self._converged(assembly, slip)
        return self._dataset(assembly, raceways, slip, curves, critical).assign_attrs(
            positions_error=error
        )

    @classmethod
    def run_batch(
        cls, cases: "Sequence[tuple[EffectiveFriction, Assembly]]", outputs: frozenset[str]
    ) -> list[PartialResult] | None:
        """Return curves, critical slips and the onset of skidding of several bearings by one evaluation, as `run` does.

        None for other outputs.

        Parameters
        ----------
        cases : sequence of tuple of EffectiveFriction and Assembly
            Studies and bearings.
        outputs : frozenset of str
            Names of the requested outputs.
        """
        if not outputs <= _CURVE_OUTPUTS | _BALANCE:
            return None
        balances: list[PartialResult] = [({}, {}) for _ in cases]
        if outputs & _BALANCE:
            balances = [
                study._balanced(
                    assembly, assembly.resolution.n_positions or _FIRST_POSITIONS, outputs
                )
                for study, assembly in cases
            ]
        if not outputs & _CURVE_OUTPUTS:
            return balances
        found = dict[int, Maxima]()
        pending = list[tuple[int, Array, LoadedRaceways]]()
        for k, (study, assembly) in enumerate(cases):
            slip = slip_grid(study.max_cage_slip, study.points)
            if (n_positions := assembly.resolution.n_positions) is None:
                _, (friction, _), critical, _ = study._converged(assembly, slip)
                found[k] = slip, friction, critical
            else:
                pending.append((k, slip, study.loaded(assembly, n_positions)))
        found |= find_maxima(pending, whole=bool(outputs & _WHOLE_CURVE))
        results = []
        for k, (balance, slips) in enumerate(balances):
            variables, coords = _curve_variables(*found[k])
            results.append((variables | balance, coords | slips))
        return results

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return relative errors of the smallest film parameter of both rings, from a bearing with a finer resolution.

        Where rollers jump to another motion between two positions, the smallest film is that just before the jump. Its
        error has a bound: the film of the load at the one position with the speeds of the other.

        Parameters
        ----------
        finer : Assembly
            The bearing with the finer resolution.
        dataset : Dataset
            The result.
        """
        film = np.where(dataset["film_parameter"] > 0.0, dataset["film_parameter"], np.inf)
        n_positions = finer.resolution.n_positions or 1
        raceways = self.loaded(finer, n_positions)
        own = film.min(axis=1)
        slips = dataset["cage_slip"].to_numpy()[film.argmin(axis=1)]
        film_error = 0.0
        jump_error = 0.0
        for ring, both in enumerate(raceways.contacts(raceways.speeds(slips))):
            contacts, u, V = both[ring]
            along = raceways.thinnest(contacts, u, V)
            smallest = along[1:-1].min()
            if not (np.isfinite(own[ring]) and 0.0 < smallest < np.inf):
                continue
            film_error = max(film_error, MINIMUM_ERROR_FACTOR * abs(own[ring] / smallest - 1.0))
            # rollers with equal speeds do not jump, and with other slices only the jump of the run counts
            if np.ndim(u) and n_positions > dataset.attrs["n_positions"]:
                for step in (1, -1):
                    jump_error = max(
                        jump_error, _film_error_at_jumps(raceways, both[ring], along, step)
                    )
        errors = {"film parameter": float(film_error)}
        if jump_error:
            errors[FILM_AT_JUMPS] = float(jump_error)
        return errors

    def at_positions(self, assembly: Assembly, n_positions: int) -> "xr.Dataset":
        """Return the result of `run` at a number of roller positions, without discretisation errors.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        n_positions : int
            Roller positions within a pitch.
        """
        slip = slip_grid(self.max_cage_slip, self.points)
        raceways = self.loaded(assembly, n_positions)
        curves = raceways.evaluated(raceways.speeds(slip))
        return self._dataset(assembly, raceways, slip, curves, raceways.critical(slip, curves[0]))

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_cage_slip

    @property
    def curves_with(self) -> str:
        """Name of the closure in texts."""
        return CLOSURES[self.closure]

    @property
    def is_averaged(self) -> bool:
        """Whether the curves are means over the roller positions within a pitch."""
        return True

    @property
    def uses_continuation(self) -> bool:
        """Whether rollers may have several motions, of which the continuation from smaller slips is taken."""
        return self.closure == "free-roller"

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate the corners of the map, and contacts along the loading branch."""
        if self.map_points:
            self.loaded(assembly, 1).map(self.max_cage_slip, 2)
        if self.skidding_range:
            evaluate_on_branch(assembly, self.skidding_range)

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return effective friction at numbers of roller positions, each a divisor of the largest, (k, 2, n)."""
        raceways = self.loaded(assembly, max(n_positions))
        if len(n_positions) == 1:
            return raceways.curve(slip)[None]
        found = np.empty((len(n_positions), 2, slip.size))
        for k, both in enumerate(raceways.contacts(raceways.speeds(slip))):
            for ring, (contacts, u, V) in enumerate(both):
                pull = contacts.per_roller(contacts.friction(u, V) * contacts.force)
                force = contacts.per_roller(contacts.force)
                for i, m in enumerate(n_positions):  # at every M/m-th position of the orbit
                    some = slice(None, None, max(n_positions) // m)
                    found[i, ring, k] = (
                        pull[some].sum() / force[some].sum() if force[some].any() else np.nan
                    )
        return found

    def torque_balance(self, assembly: Assembly, n_positions: int) -> TorqueBalance:
        """Return the torque balance of the bearing; raise `SceneError` where its motion is not periodic."""
        check_repeats(assembly, f"with study.{self.name}.skidding_range = 0")
        return torque_balance(assembly, n_positions)

    def skidding_onset(self, balance: TorqueBalance) -> SkiddingOnset:
        """Return the onset of skidding of a torque balance, up to the largest slip of the search."""
        return skidding_onset(balance, self.skidding_range, f"study.{self.name}.skidding_range")

    def _balanced(
        self, assembly: Assembly, n_positions: int, outputs: frozenset[str] = _STEADY
    ) -> PartialResult:
        """Return variables of the balance of torques, and their coordinates; empty if skidding is not searched."""
        if not self.skidding_range:
            return {}, {}
        balance = self.torque_balance(assembly, n_positions)
        variables, coords = self._torques(balance, outputs) if outputs & _TORQUES else ({}, {})
        if not outputs & (_SKIDDING | _STEADY):
            return variables, coords
        onset = self.skidding_onset(balance)
        variables |= self.variables(
            skidding_slip=onset.slip, limit_drag=onset.drag, skidding_status=np.array(onset.status)
        )
        if outputs & _STEADY:
            runs = running(balance, self.skidding_range)
            variables |= self.variables(
                steady_cage_slip=runs.slip,
                steady_drag=runs.drag,
                steady_status=np.array(runs.status),
            )
            if outputs & _RESERVE:
                to_skidding = reserve(balance, onset, runs, self.skidding_range)
                variables |= self.variables(
                    drag_reserve=to_skidding.factor, reserve_status=np.array(to_skidding.status)
                )
        return variables, coords

    def _torques(self, balance: TorqueBalance, outputs: frozenset[str]) -> PartialResult:
        """Return the torques of rollers and drags over the slip, and their coordinates."""
        grid = branch_slips(self.skidding_range)
        slips = np.array(self.torque_slips) if self.torque_slips else grid
        variables = dict[str, Any]()
        if "driving_torque" in outputs:
            find = balance.torques_from_zero if self.torque_slips else balance.branch_torques
            variables |= self.variables(driving_torque=find(slips))
        if "drag_torque" in outputs:
            drags = np.array([-balance.drag(slip) for slip in grid.tolist()])
            variables |= self.variables(drag_torque=drags)
        return variables, {
            "torque_slip": ("torque_slip", slips, about("1", "cage slip")),
            "branch_slip": ("branch_slip", grid, about("1", "cage slip")),
        }

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags and ribs that act on rollers, if skidding is searched."""
        if not self.skidding_range:
            return ()
        drags = (
            ("drag", drag)
            for drag in assembly.cage.drags
            if drag not in assembly.cage.drags.torques
        )
        return *drags, *assembly.named_ribs

    def loaded(
        self, assembly: Assembly, n_positions: int, known: LoadDistribution | None = None
    ) -> LoadedRaceways:
        """Return the loaded contacts at a number of roller positions within a pitch.

        Parameters
        ----------
        assembly : Assembly
            The bearing.
        n_positions : int
            Roller positions within a pitch.
        known : LoadDistribution or None
            Loads at half as many positions, which are not computed once more.
        """
        loads = assembly.load_distribution(n_positions, known=known)
        return LoadedRaceways(assembly, loads, self.closure, self.table, shared=known is None)

    def _converged(
        self, assembly: Assembly, slip: Array
    ) -> tuple[LoadedRaceways, tuple[Array, Array], tuple[Critical, Critical], float]:
        """Double the roller positions until curves and critical slips change by less than the tolerance.

        Return raceways, curves of friction and film, critical slips, and the last change.
        """
        tolerance = assembly.scene.accuracy.tolerance
        before: tuple[Array, tuple[Critical, Critical]] | None = None
        known: LoadDistribution | None = None
        n_positions = _FIRST_POSITIONS
        change = np.inf
        while n_positions <= _MAX_POSITIONS:
            raceways = self.loaded(assembly, n_positions, known)
            known = raceways.distribution
            curves = friction, _ = raceways.evaluated(raceways.speeds(slip))
            critical = raceways.critical(slip, friction)
            if before is not None:
                changes = map(_critical_change, before[1], critical)
                change = max(largest_relative_change(before[0], friction), *changes)
                if change <= tolerance:
                    return raceways, curves, critical, change
            before = (friction, critical)
            n_positions = 2 * n_positions
        what = f"effective friction still moves by {change:.1e} (relative)"
        hint = ""
        if np.isinf(change):
            what = "whether there is a slip at largest traction still changes"
            hint = f", or move the end of the range, {self.table}.max_cage_slip"
        raise ConvergenceError(
            f"{what} from {_MAX_POSITIONS // 2} to {_MAX_POSITIONS} roller positions within a pitch; raise "
            f"accuracy.tolerance, which is {tolerance:g}{hint}"
        )

    def _dataset(
        self,
        assembly: Assembly,
        raceways: LoadedRaceways,
        slip: Array,
        curves: tuple[Array, Array],
        critical: tuple[Critical, Critical],
    ) -> "xr.Dataset":
        """Return the result of curves, film parameters and critical slips, with map, regimes and torque balance."""
        speeds = raceways.speeds(slip)
        friction, film = curves
        loads = raceways.distribution
        forces = np.stack([loads.inner_force[0], loads.outer_force[0]])
        variables, coords = _curve_variables(slip, friction, critical)
        variables |= self.variables(**raceways.means(speeds), film_parameter=film)
        variables |= regime_variables(*raceways.regimes(speeds))
        variables |= self.variables(normal_force=forces, angle=loads.psi[0])
        coords["roller"] = ("roller", np.arange(forces.shape[1]), about("1", "roller"))
        variables |= self._balanced(assembly, int(loads.psi.shape[0]))[0]
        if self.per_roller:
            variables |= self.variables(roller_friction=raceways.per_roller(slip))
        if self.map_points:
            cage, roller, surface = raceways.map(self.max_cage_slip, self.map_points)
            variables |= self.variables(friction_map=surface)
            coords["map_cage_slip"] = ("map_cage_slip", cage, about("1", "cage slip"))
            coords["map_roller_slip"] = ("map_roller_slip", roller, about("1", "roller slip"))
        attributes = self.attributes | {
            "closure": self.closure,
            "n_positions": int(loads.psi.shape[0]),
            "slices": assembly.slices,
            "force_residual": loads.force_residual,
            "moment_residual": loads.moment_residual,
        }
        return xr.Dataset(variables, coords, attrs=attributes)


def _film_error_at_jumps(
    raceways: LoadedRaceways, ring: tuple[LoadedContacts, Array, Array], along: Array, step: int
) -> float:
    """Return a bound on the relative error of the smallest film where rollers jump between positions; 0 without jumps.

    ``ring`` has contacts, rolling and sliding speeds, ``along`` the film parameter at the positions with a neighbour at
    either end, and ``step`` is 1 or -1, the side of the jump.
    """
    contacts, u, V = ring
    tolerance = raceways.assembly.scene.accuracy.tolerance
    smallest = along[1:-1].min()
    over = along / smallest - 1.0
    near, at, far = (over[1 + k : over.size - 1 + k] for k in (-step, 0, step))
    edges = np.flatnonzero(
        (at <= tolerance) & (far > _JUMP_RATIO * np.maximum(near, tolerance)) & np.isfinite(far)
    )
    if not edges.size:
        return 0.0
    # all jumps at once: the neighbour beyond each jump gets the speeds of the position before it
    source = np.arange(over.size - 2)
    source[(edges + step) % source.size] = edges
    owner = source[contacts.owner]
    own = np.where(
        owner == contacts.owner, np.arange(owner.size), np.searchsorted(contacts.owner, owner)
    )
    bounds = raceways.thinnest(contacts, u[own], V[own])[1 + edges + step]
    return float((smallest / bounds - 1.0).max())


def _curve_variables(
    slip: Array, friction: Array | None, critical: tuple[Critical, Critical]
) -> PartialResult:
    """Return variables and coordinates of the maxima of curves, and of the curves if their friction is known."""
    curves = {} if friction is None else EffectiveFriction.variables(effective_friction=friction)
    columns = map(np.array, zip(*map(attrs.astuple, critical), strict=True))
    return curves | EffectiveFriction.variables(**dict(zip(_MAXIMA, columns, strict=True))), {
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
    }


def _critical_change(before: Critical, after: Critical) -> float:
    """Return the relative change of a critical slip; infinite where only one of both exists."""
    if np.isnan(before.slip) != np.isnan(after.slip):
        return np.inf
    return 0.0 if np.isnan(after.slip) else abs(after.slip / before.slip - 1.0)
