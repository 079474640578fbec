"""Study effective-friction: friction of each raceway as a whole against cage slip, and the critical cage slip.

- One revolution is one to two orders shorter than the cage's transient, so a raceway acts on the cage through its
  effective friction mu_e = sum(mu_km Q_km)/sum(Q_km) over its *loaded* contacts k and the instants m of a revolution
  (Klebanov et al. 2022); averaging unloaded rollers in is a known mistake. With slices the sum runs over them too.
- Equal rollers repeat after one pitch, so the instants are spread over a pitch and doubled until the curve and its
  maximum stand still; what the last doubling still moved is reported.
- Effective friction is positive where it drives the cage towards its epicyclic speed. With the outer ring driving that
  is against the direction in which rolling speeds are positive, hence the sign in ``LoadedContacts``.
- The map over cage slip and roller slip, which needs no closure, is stored beside the curve.
- The critical slip of a curve is that of its closure. Where the cage runs away, the balance of torques with freely
  spinning rollers on both rings says (`motion.loading_branch`), and it is told first; so does the same balance say at
  which slip the cage runs where the scene gives drags.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import Critical, slip_grid
from rollslip.bearing.equilibrium import LoadDistribution
from rollslip.bearing.raceway import PROBES, RINGS, Array, LoadedContacts
from rollslip.errors import ConvergenceError
from rollslip.fields import at_least, choice_of, in_range, parameter
from rollslip.results.curves import FIRST, Curves
from rollslip.results.dataset import about
from rollslip.studies.answers import LoadedSlices, Measurable, Output, PartialResult, RunContext
from rollslip.studies.error_estimate import MINIMUM_ERROR_FACTOR
from rollslip.studies.study import CONTACT_CHOICES, N_VALIDITY_SLIPS, Study
from rollslip.studies.timing import N_POSITIONS, POINTS, extrapolate_line, processor_time
from rollslip_studies.effective_friction.raceways import (
    REGIMES,
    LoadedRaceways,
    are_confirmed,
    evaluate_together,
    find_critical_together,
    largest_relative_change,
    regime_variables,
)
from rollslip_studies.motion.spins import check_repeats
from rollslip_studies.motion.torque_balance import (
    SkiddingOnset,
    TorqueBalance,
    look_along,
    reserve,
    rollers,
    running,
    skidding_onset,
)

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.scene.values import Scene

#: Doublings start here and give up there.
_FIRST_POSITIONS = 2
_MAX_POSITIONS = 1024


#: Slices from which on costs go with their number, and points of maps on which costs are measured.
_MANY: Final = 128
_MAP: Final = (3, 6)
#: Evaluations in the search for the critical slips of both rings, each of one ring.
_SEARCH: Final = 40
#: Error of the smallest film parameter just before a roller jumps to another balance of forces. It is a bound; it falls
#: only with the number of roller positions, because the jump lies between two of them.
FILM_AT_JUMPS: Final = "film parameter, where rollers jump,"
#: Closure -> what the rollers do, as it is told of a critical slip.
CLOSURES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "epicyclic": "with rollers in pure rolling",
        "outer-rolling": "with rollers that roll on the outer ring",
        "free-roller": "with the roller speed from its balance of moments",
    }
)

#: What the curves and their maxima give.
_OF_CURVES: Final = frozenset(
    {"effective_friction", "critical_cage_slip", "critical_friction", "critical_status", *FIRST}
)
_CURVE: Final = "ring cage_slip"
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
        "first_maximum_slip": Output(
            "ring",
            "1",
            "cage slip from which effective friction first falls",
            status="critical_status",
        ),
        "first_maximum_friction": Output(
            "ring", "1", "effective friction coefficient there", status="critical_status"
        ),
        "skidding_slip": Output(
            "",
            "1",
            "cage slip at which skidding begins",
            status="skidding_status",
            aliases=("skidding_slip",),
        ),
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
        "drag_reserve": Output(
            "", "1", "limit drag torque over the drag of the scene", status="reserve_status"
        ),
        "reserve_status": Output(
            "", "1", "what was found of the reserve: found, at least, or why there is none"
        ),
        "roller_slip": Output(_CURVE, "1", "roller slip, mean over the loaded contacts"),
        "sliding_speed": Output(_CURVE, "m/s", "sliding speed, mean over them"),
        "rolling_speed": Output(_CURVE, "m/s", "rolling speed, mean over them"),
        "film_parameter": Output(_CURVE, "1", "smallest film parameter Lambda"),
        **REGIMES,
        "normal_force": Output("ring roller", "N", "normal force at the first instant"),
        "angle": Output("roller", "rad", "position from the line of load, first instant"),
        "roller_friction": Output(
            "ring roller cage_slip", "1", "friction coefficient of each roller, first instant"
        ),
        "friction_map": Output(
            "ring map_cage_slip map_roller_slip", "1", "effective friction coefficient"
        ),
    }
)
#: What of them takes the whole curve, and not its maxima alone.
_WHOLE_CURVE: Final = frozenset({"effective_friction"})
#: How many times as far a film is off its thinnest to one side as to the other where rollers jump, or the tolerance.
_JUMP: Final = 10.0
#: Error that few loads may leave of the friction of all slices, relative to the tolerance.
_COARSE_FRACTION: Final = 1e-2
#: What is found of running away.
_SKIDDING: Final = frozenset({"skidding_slip", "limit_drag", "skidding_status"})
#: What is found of how the cage runs.
_RESERVE: Final = frozenset({"drag_reserve", "reserve_status"})
_STEADY: Final = frozenset({"steady_cage_slip", "steady_drag", "steady_status"}) | _RESERVE


@attrs.frozen(kw_only=True)
class EffectiveFriction(Study):
    """Friction of each raceway as a whole against cage slip, and the critical cage slip."""

    name: ClassVar[str] = "effective-friction"
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"friction": "effective_friction", "critical_slip": "critical_cage_slip"}
    )
    irreducible_errors: ClassVar[frozenset[str]] = frozenset({FILM_AT_JUMPS})
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    curves_of: ClassVar[Curves] = Curves(
        variable="effective_friction", over="ring", slip="cage_slip", critical="critical_cage_slip"
    )
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "friction": "the models of a contact on every loaded slice, over the slips and in search of the largest",
            "film regimes": "told of every loaded slice, over the slips of the curve",
            "skidding": "the balance of torques of freely spinning rollers, about its maximum and at the drags",
            "map": "the study asks for friction over cage slip and roller slip|over few loads that stand for all "
            "slices",
        }
    )
    shares_resolution: ClassVar[bool] = True
    measured: ClassVar[Mapping[str, Measurable]] = MappingProxyType(
        {
            "critical-slip": Measurable(variable="critical_cage_slip", beyond=True),
            "skidding-slip": Measurable(variable="skidding_slip", beyond=True),
            "limit-drag": Measurable(variable="limit_drag"),
        }
    )

    closure: str = parameter(
        default="free-roller",
        doc="what the rollers spin at",
        validator=choice_of("outer-rolling", "epicyclic", "free-roller"),
    )
    max_cage_slip: float = parameter(
        default=0.4, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    skidding_range: float = parameter(
        default=0.95,
        unit="1",
        doc="largest cage slip up to which skidding is looked for, whatever the curve's; 0 for not",
        validator=in_range(0.0, 0.99),
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
        default=False, doc="store the friction of every roller at the first instant"
    )

    def with_bands(self, scene: "Scene", dataset: "xr.Dataset") -> "xr.Dataset":
        """Return a result with the band of its steady slip, which every slice's friction gives."""
        from rollslip_studies.steady_slip.band import with_bands  # of the few who ask for it

        return with_bands(scene, dataset, "steady_cage_slip")

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices the study will evaluate: curve, maximum, error of the slices, and map."""
        loads = assembly.load_distribution(1)
        half = loads.psi.size // 2 + 1
        contacts = sum(
            LoadedContacts(raceway, load[0, :half], assembly.widths, 1.0).force.size
            for raceway, load in (
                (assembly.inner, loads.inner_load),
                (assembly.outer, loads.outer_load),
            )
        )
        n_positions = 2 * _FIRST_POSITIONS  # at which most curves stand still
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
        """Return how many numbers curves and map hold at least: what is stored of a slip, and the rollers' speeds."""
        rollers = assembly.scene.bearing.rollers
        of_rollers = 6 * (self.closure == "free-roller") + 2 * self.per_roller
        surface = float(self.map_points) * max(2 * self.map_points - 1, 0)
        return {
            "points": float(self.points) * (16 + of_rollers * rollers),
            "map_points": 8.0 * surface,
        }

    def without_outputs(self, outputs: frozenset[str]) -> "EffectiveFriction":
        """Return a study without the map and without running away, which are most of the work, and single rollers."""
        return attrs.evolve(
            self,
            map_points=0 if "friction_map" in outputs else self.map_points,
            skidding_range=0.0 if outputs >= _SKIDDING | _STEADY else self.skidding_range,
            per_roller=self.per_roller and "roller_friction" not in outputs,
        )

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of loads, friction, regimes and map, from few slips, instants and points."""
        resolution = assembly.resolution
        slip = slip_grid(self.max_cage_slip, POINTS[0])[1:]
        some = assembly.at(attrs.evolve(resolution, slices=min(resolution.slices, _MANY)))
        times: dict[str, list[float]] = {
            "load distribution": [],
            "friction": [],
            "film regimes": [],
        }
        for m in N_POSITIONS:
            anew = attrs.evolve(some, load_cache={})
            times["load distribution"].append(processor_time(partial(anew.load_distribution, m), 1))
            raceways = self.loaded(anew, m)
            closure = (
                processor_time(partial(raceways.speeds, slip), 1) / slip.size
            )  # a free roller's spin is a root, found once
            speeds = raceways.speeds(slip)
            one, regimes = (
                processor_time(partial(work, speeds)) / slip.size
                for work in (raceways.evaluated, raceways.regimes)
            )
            times["friction"].append(
                one * (self.points + _SEARCH / 2) + closure * (self.points + _SEARCH / 4)
            )
            times["film regimes"].append(regimes * self.points)
        more = assembly.slices / some.slices
        n_positions = resolution.n_positions or N_POSITIONS[-1]
        costs = {
            part: more * extrapolate_line(N_POSITIONS, each, n_positions)
            for part, each in times.items()
        }
        if self.skidding_range:
            costs["skidding"] = rollers(assembly, n_positions).seconds(self.skidding_range)
        if self.map_points:
            sizes = (_MAP[0] * (2 * _MAP[0] - 1), _MAP[1] * (2 * _MAP[1] - 1))
            maps = [processor_time(partial(raceways.map, self.max_cage_slip, n), 1) for n in _MAP]
            costs["map"] = extrapolate_line(
                sizes, maps, self.map_points * max(2 * self.map_points - 1, 1)
            )
        return costs

    def loaded_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> Iterator[LoadedSlices]:
        """Yield the slices of both rings, slip by slip."""
        yield from self._evaluated(
            assembly, dataset.attrs["n_positions"], dataset["cage_slip"].to_numpy()
        )

    def expected_slices(self, assembly: Assembly) -> tuple[str, list[LoadedSlices]]:
        """Return the slices of both rings at a few slips of the curves, of one instant."""
        slips = np.linspace(
            self.max_cage_slip / N_VALIDITY_SLIPS, self.max_cage_slip, N_VALIDITY_SLIPS
        )
        return "over the curves", [*self._evaluated(assembly, 1, slips)]

    def _evaluated(
        self, assembly: Assembly, n_positions: int, cage_slip: Array
    ) -> Iterator[LoadedSlices]:
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
            first_maximum_friction; scalars, unless it is not looked where the cage runs away: skidding_slip,
            limit_drag, skidding_status, steady_cage_slip, steady_drag, steady_status, drag_reserve, reserve_status;
            (ring, map_cage_slip, map_roller_slip): friction_map; (ring, roller): normal_force at the first instant
            and, on request, (ring, roller, cage_slip): roller_friction, NaN where the roller is not loaded.

        Raises
        ------
        SceneError
            If no roller is loaded on the inner ring.
        DomainError
            If a contact rolls backwards at a cage slip of the range, or a law has no value there.
        ConvergenceError
            If doubling the instants does not settle the curve, or the radial load is lost beside centrifugal forces.
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
        """Return what `run` does of curves, critical slips and running away, for several bearings at once.

        None if more is asked.
        """
        if not outputs <= _OF_CURVES | _SKIDDING | _STEADY:
            return None
        aways = [
            study._balanced(assembly, assembly.resolution.n_positions or _FIRST_POSITIONS, outputs)
            if outputs & (_SKIDDING | _STEADY)
            else {}
            for study, assembly in cases
        ]
        found = dict[int, tuple[Array, Array | None, tuple[Critical, Critical]]]()
        begun = list[tuple[int, Array, LoadedRaceways]]()
        for k, (study, assembly) in enumerate(cases):
            slip = slip_grid(study.max_cage_slip, study.points)
            n_positions = assembly.resolution.n_positions
            if n_positions is None:
                _, (friction, _), critical, _ = study._converged(assembly, slip)
                found[k] = slip, friction, critical
            else:
                begun.append((k, slip, study.loaded(assembly, n_positions)))
        if not outputs & _WHOLE_CURVE:
            maxima = _by_few_loads([(slip, raceways) for _, slip, raceways in begun])
            found |= {
                k: (slip, None, known)
                for (k, slip, _), known in zip(begun, maxima, strict=True)
                if known is not None
            }
        left = [one for one in begun if one[0] not in found]
        curves = evaluate_together(
            [(raceways, raceways.speeds(slip)) for _, slip, raceways in left]
        )
        whole = [
            (raceways, slip, friction)
            for (_, slip, raceways), (friction, _) in zip(left, curves, strict=True)
        ]
        for (k, *_), (_, slip, friction), critical in zip(
            left, whole, find_critical_together(whole), strict=True
        ):
            found[k] = slip, friction, critical
        some = [_curves(*found[k]) for k in range(len(cases))]
        return [(one | away, at) for (one, at), away in zip(some, aways, strict=True)]

    def value_errors(self, finer: Assembly, dataset: "xr.Dataset") -> dict[str, float]:
        """Return by how much the thinnest films of both rings are off, by slices and positions where they are.

        Where rollers jump to another balance between two positions the thinnest film is that just before the jump. It
        is bounded by that of the one position's load at the speeds of the other.
        """
        film = np.where(dataset["film_parameter"] > 0.0, dataset["film_parameter"], np.inf)
        n_positions = finer.resolution.n_positions or 1
        raceways = self.loaded(finer, n_positions)
        here = film.min(axis=1)
        off = 0.0
        jumped = 0.0
        slips = dataset["cage_slip"].to_numpy()[film.argmin(axis=1)]
        tolerance = finer.scene.accuracy.tolerance
        for ring, both in enumerate(raceways.contacts(raceways.speeds(slips))):
            contacts, u, V = both[ring]
            along = raceways.thinnest(contacts, u, V)
            over = along / (least := along[1:-1].min()) - 1.0
            if not (np.isfinite(here[ring]) and 0.0 < least < np.inf):
                continue
            off = max(off, MINIMUM_ERROR_FACTOR * abs(here[ring] / least - 1.0))
            # rollers that all run alike jump nowhere, and other slices see the jump of the run
            for step in (
                (1, -1) if np.ndim(u) and n_positions > dataset.attrs["n_positions"] else ()
            ):
                near, at, far = (over[1 + k : over.size - 1 + k] for k in (-step, 0, step))
                edges = np.flatnonzero(
                    (at <= tolerance)
                    & (far > _JUMP * np.maximum(near, tolerance))
                    & np.isfinite(far)
                )
                if not edges.size:
                    continue
                # all of them at once: each neighbour moves as the position before its jump does
                moves = np.arange(over.size - 2)
                moves[(edges + step) % moves.size] = edges
                as_of = moves[contacts.owner]
                own = np.where(
                    as_of == contacts.owner,
                    np.arange(as_of.size),
                    np.searchsorted(contacts.owner, as_of),
                )
                bounds = raceways.thinnest(contacts, u[own], V[own])[1 + edges + step]
                jumped = max(jumped, float((least / bounds - 1.0).max()))
        return {
            "film parameter": float(off),
            **({FILM_AT_JUMPS: float(jumped)} if jumped else {}),
        }

    def at_positions(self, assembly: Assembly, n_positions: int) -> "xr.Dataset":
        """Return what `run` does, on a given number of instants, but for the errors that instants and slices leave."""
        slip = slip_grid(self.max_cage_slip, self.points)
        raceways, curves, critical = self._on(assembly, slip, n_positions)
        return self._dataset(assembly, raceways, slip, curves, critical)

    def _on(
        self, assembly: Assembly, slip: Array, n_positions: int
    ) -> tuple[LoadedRaceways, tuple[Array, Array], tuple[Critical, Critical]]:
        """Raceways, curves of friction and film, and critical slips on a number of instants."""
        raceways = self.loaded(assembly, n_positions)
        curves = raceways.evaluated(raceways.speeds(slip))
        return raceways, curves, raceways.critical(slip, curves[0])

    @property
    def slip_range(self) -> float:
        """Slip up to which the curves go."""
        return self.max_cage_slip

    @property
    def curves_with(self) -> str:
        """What the rollers do, by the closure."""
        return CLOSURES[self.closure]

    @property
    def is_averaged(self) -> bool:
        """Whether the curves are means over the instants of a pitch."""
        return True

    @property
    def uses_continuation(self) -> bool:
        """Whether rollers may have several balances, of which the one that goes on from smaller slips is taken."""
        return self.closure == "free-roller"

    def sample_other_contacts(self, assembly: Assembly) -> None:
        """Evaluate the corners of the map, and contacts on the way up."""
        if self.map_points:
            self.loaded(assembly, 1).map(self.max_cage_slip, 2)
        if self.skidding_range:
            look_along(assembly, self.skidding_range)

    def curves(self, assembly: Assembly, slip: Array, n_positions: Sequence[int]) -> Array:
        """Return effective friction on few of the instants of a pitch, each a part of the most, (k, 2, n)."""
        raceways = self.loaded(assembly, max(n_positions))
        if len(n_positions) == 1:
            return raceways.curve(slip)[None]
        found = np.empty((len(n_positions), 2, slip.size))
        for k, both in enumerate(raceways.contacts(raceways.speeds(slip))):
            for ring, (contacts, u, V) in enumerate(both):
                pull = contacts.per_roller(contacts.friction(u, V) * contacts.force)
                force = contacts.per_roller(contacts.force)
                for i, m in enumerate(n_positions):  # of every M/m-th position of the orbit
                    some = slice(None, None, max(n_positions) // m)
                    found[i, ring, k] = (
                        pull[some].sum() / force[some].sum() if force[some].any() else np.nan
                    )
        return found

    def skidding_onset(self, assembly: Assembly, n_positions: int) -> SkiddingOnset | None:
        """Return where the cage runs away, up to the largest slip that is looked at; None if it is not looked for."""
        if not self.skidding_range:
            return None
        return self._away(self._rollers(assembly, n_positions))

    def _rollers(self, assembly: Assembly, n_positions: int) -> TorqueBalance:
        check_repeats(assembly, f"with study.{self.name}.skidding_range = 0")
        return rollers(assembly, n_positions)

    def _away(self, balance: TorqueBalance) -> SkiddingOnset:
        return skidding_onset(balance, self.skidding_range, f"study.{self.name}.skidding_range")

    def _balanced(
        self, assembly: Assembly, n_positions: int, outputs: frozenset[str] = _STEADY
    ) -> dict[str, Any]:
        """Variables of running away and of how the cage runs, none where neither is looked for."""
        if not self.skidding_range:
            return {}
        balance = self._rollers(assembly, n_positions)
        away = self._away(balance)
        found = self.variables(
            skidding_slip=away.slip, limit_drag=away.drag, skidding_status=np.array(away.status)
        )
        if outputs & _STEADY:
            runs = running(balance, self.skidding_range)
            found |= self.variables(
                steady_cage_slip=runs.slip,
                steady_drag=runs.drag,
                steady_status=np.array(runs.status),
            )
            if outputs & _RESERVE:
                kept = reserve(balance, away, runs, self.skidding_range)
                found |= self.variables(
                    drag_reserve=kept.factor, reserve_status=np.array(kept.status)
                )
        return found

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags that act on rollers, if there are any and it is looked where the cage runs away."""
        if not self.skidding_range:
            return ()
        return tuple(
            ("drag", drag)
            for drag in assembly.cage.drags
            if drag not in assembly.cage.drags.torques
        )

    def loaded(
        self, assembly: Assembly, n_positions: int, known: LoadDistribution | None = None
    ) -> LoadedRaceways:
        """Return the loaded contacts at a number of instants of a pitch; those at half as many may be known."""
        loads = assembly.load_distribution(n_positions, known=known)
        return LoadedRaceways(assembly, loads, self.closure, self.table, shared=known is None)

    def _converged(
        self, assembly: Assembly, slip: Array
    ) -> tuple[LoadedRaceways, tuple[Array, Array], tuple[Critical, Critical], float]:
        """Double the instants until neither the curves nor the critical slips move by more than the tolerance."""
        tolerance = assembly.scene.accuracy.tolerance
        before: tuple[Array, tuple[Critical, Critical]] | None = None
        known: LoadDistribution | None = None
        n_positions = _FIRST_POSITIONS
        moved = np.inf
        while n_positions <= _MAX_POSITIONS:
            raceways = self.loaded(assembly, n_positions, known)
            known = raceways.distribution
            curves = friction, _ = raceways.evaluated(raceways.speeds(slip))
            critical = raceways.critical(slip, friction)
            if before is not None:
                moved = max(
                    largest_relative_change(before[0], friction),
                    *map(_critical_moved, before[1], critical),
                )
                if moved <= tolerance:
                    return raceways, curves, critical, moved
            before = (friction, critical)
            n_positions = 2 * n_positions
        what = f"effective friction still moves by {moved:.1e} (relative)"
        if np.isinf(moved):
            what = "whether there is a slip at largest traction still changes"
        raise ConvergenceError(
            f"{what} from {_MAX_POSITIONS // 2} to {_MAX_POSITIONS} roller positions within a pitch; raise "
            f"accuracy.tolerance, which is {tolerance:g}"
            + (
                f", or move the end of the range, {self.table}.max_cage_slip"
                if np.isinf(moved)
                else ""
            )
        )

    def _dataset(
        self,
        assembly: Assembly,
        raceways: LoadedRaceways,
        slip: Array,
        curves: tuple[Array, Array],
        critical: tuple[Critical, Critical],
    ) -> "xr.Dataset":
        import xarray as xr

        speeds = raceways.speeds(slip)
        means = raceways.means(speeds)
        (friction, film) = curves
        loads = raceways.distribution
        forces = np.stack([loads.inner_force[0], loads.outer_force[0]])
        found, coords = _curves(slip, friction, critical)
        variables: dict[str, Any] = {
            **found,
            **self.variables(**means, film_parameter=film),
            **regime_variables(*raceways.regimes(speeds)),
            **self.variables(normal_force=forces, angle=loads.psi[0]),
        }
        coords["roller"] = ("roller", np.arange(forces.shape[1]), about("1", "roller"))
        variables |= self._balanced(assembly, int(loads.psi.shape[0]))
        if self.per_roller:
            variables |= self.variables(roller_friction=raceways.per_roller(slip))
        if self.map_points:
            cage, roller, surface = raceways.map(self.max_cage_slip, self.map_points)
            variables |= self.variables(friction_map=surface)
            coords["map_cage_slip"] = ("map_cage_slip", cage, about("1", "cage slip"))
            coords["map_roller_slip"] = ("map_roller_slip", roller, about("1", "roller slip"))
        said = {
            "closure": self.closure,
            "n_positions": int(loads.psi.shape[0]),
            "slices": assembly.slices,
            "force_residual": loads.force_residual,
            "moment_residual": loads.moment_residual,
        }
        return xr.Dataset(variables, coords, attrs=self.attributes | said)


def _by_few_loads(
    cases: Sequence[tuple[Array, LoadedRaceways]],
) -> list[tuple[Critical, Critical] | None]:
    """Critical slips of both rings by few loads on slips of their curves; None where all slices say otherwise."""
    few = [raceways.with_reduced_loads() for _, raceways in cases]
    curves = evaluate_together(
        [(own, own.speeds(slip)) for own, (slip, _) in zip(few, cases, strict=True)]
    )
    critical = find_critical_together(
        [
            (own, slip, friction)
            for own, (slip, _), (friction, _) in zip(few, cases, curves, strict=True)
        ]
    )
    held = [
        (own, [_held_at(slip, ring) for ring in both])
        for own, (slip, _), both in zip(few, cases, critical, strict=True)
    ]
    errors = [
        _COARSE_FRACTION * raceways.assembly.scene.accuracy.tolerance for _, raceways in cases
    ]
    return [
        both if agrees else None
        for both, agrees in zip(critical, are_confirmed(held, errors), strict=True)
    ]


def _held_at(slip: Array, critical: Critical) -> Array:
    """Slips at which friction of few loads is held against that of all slices: the maximum and the end."""
    return slip[-1:] if np.isnan(critical.slip) else np.array([critical.slip, slip[-1]])


def _curves(
    slip: Array, friction: Array | None, critical: tuple[Critical, Critical]
) -> PartialResult:
    """Variables of the curves, if they are known as a whole, and their maxima, and their coordinates."""
    curves = {} if friction is None else EffectiveFriction.variables(effective_friction=friction)
    return curves | EffectiveFriction.variables(
        critical_cage_slip=np.array([c.slip for c in critical]),
        critical_friction=np.array([c.friction for c in critical]),
        critical_status=np.array([c.status for c in critical]),
        first_maximum_slip=np.array([c.first_slip for c in critical]),
        first_maximum_friction=np.array([c.first_friction for c in critical]),
    ), {
        "ring": ("ring", np.array(RINGS), about("1", "ring")),
        "cage_slip": ("cage_slip", slip, about("1", "cage slip")),
    }


def _critical_moved(before: Critical, after: Critical) -> float:
    if np.isnan(before.slip) != np.isnan(after.slip):
        return np.inf
    return 0.0 if np.isnan(after.slip) else abs(after.slip / before.slip - 1.0)
