"""Study dynamics: cage and rollers in time, with constant, effective or conventional friction.

- The scene names the level of detail (`LEVELS`), the friction and the integrator, or leaves them to the plan
  (`rollslip_studies.dynamics.choice`); each level is one compiled right-hand side (`rollslip_studies.dynamics.levels`).
- Beside the motion a ledger is integrated: what the rings give, what each group of contacts takes. What it leaves of
  the energy is stored, as the plainest measure of how far a result can be trusted.
- Slip past that of running away, where the balance of torques has its fold (`motion.loading_branch`), is an event,
  located in time, and ends the run if the scene says so; a cage that runs away is a result, not a failure.
- What was computed is kept, however the run ends: the outcome is an attribute in words.
"""

import json
import math
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.bearing.resolution import Resolution, refined
from rollslip.catalogue.registry import find, structure_model
from rollslip.errors import SceneError
from rollslip.fields import (
    FieldError,
    at_least,
    choice_of,
    in_range,
    non_negative,
    parameter,
    positive,
)
from rollslip.models import IntegratorModel
from rollslip.results.dataset import about
from rollslip.scene.values import Scene
from rollslip.structure import Location, resolved
from rollslip.studies.answers import LoadedSlices, Output, Part, ResolutionChoice, RunContext
from rollslip.studies.error_estimate import reference_choice, with_table_tolerance
from rollslip.studies.study import CONTACT_CHOICES, Study
from rollslip.studies.surface_damage.model import damage_of, parts
from rollslip_studies.dynamics import heating, over_time
from rollslip_studies.dynamics.choice import choose_motion, step_tolerance
from rollslip_studies.dynamics.cost import costs_of
from rollslip_studies.dynamics.history.settings import History, HistorySettings
from rollslip_studies.dynamics.history.time_functions import Course
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.moving_bearing import MovingBearing, check_moves, unknowns
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FRICTION, FrictionSettings
from rollslip_studies.dynamics.outputs import OUTPUTS
from rollslip_studies.dynamics.termination import (
    failure_source,
    last_slices,
    outputs_of,
    regimes_of,
    ring_shapes,
    steady_slip_of,
    stored_variables,
    with_cause,
)
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.motion.checkpoints import Checkpoints
from rollslip_studies.motion.time_integration import InitialValueProblem, Trajectory, integrate
from rollslip_studies.surface_damage.over_motion import over_motion

if TYPE_CHECKING:
    import xarray as xr

#: Levels of detail -> what moves.
LEVELS: Final = {
    "cage-set": "cage and rollers' spin; the rollers keep the cage's spacing",
    "pocket": "also every roller within its pocket",
    "planar": "also inner ring and cage in the plane, rollers along the radius",
}
#: Level -> typical step [s] at a tolerance of 1e-5 and evaluations of the rates in it, for estimates of cost.
_STEPS: Final = {"cage-set": (2e-3, 11), "pocket": (4e-5, 17), "planar": (1.1e-5, 26)}
#: Shares of the tolerances that slices and instants may use, and that tables may take.
_FRACTION = 0.5
_TABLES = 0.2
#: Relative tolerance at which rounding begins to govern the steps, 100 times that of numbers.
_MIN_TOLERANCE: Final = 2.3e-14


@attrs.frozen(kw_only=True)
class Dynamics(Study):
    """Cage and rollers in time, with constant, effective or conventional friction."""

    name: ClassVar[str] = "dynamics"
    outputs: ClassVar[Mapping[str, Output]] = OUTPUTS
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({"cage_speed": "cage_speed"})
    #: Of no one instant.
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {
        "table_tolerance",
        "integrator",
        "integrator_tolerance",
        "friction",
    }
    cost_descriptions: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "tables": "loads over the orbit and effective friction",
            "motion": "the study asks for cage and rollers in time",
            "skidding": "whether the cage skids is reported with every motion",
            "temperatures": "motions along temperatures, until these are those of their losses",
        }
    )
    with_cage: ClassVar[bool] = True
    with_heat: ClassVar[bool] = True
    with_damage: ClassVar[bool] = True
    is_transient: ClassVar[bool] = True

    level: str = parameter(
        default="cage-set",
        doc="what moves; a plan chooses where it is not given",
        validator=choice_of(*LEVELS),
    )
    friction: str = parameter(
        default="effective",
        doc="of every loaded slice (conventional), effective friction of the raceways, or a constant; a plan "
        "chooses between the first two where it is not given",
        validator=choice_of(*FRICTION),
    )
    effective_over: str = parameter(
        default="sliding-speed",
        doc="effective friction over the sliding speed at each raceway, or over cage slip and roller slip",
        validator=choice_of("sliding-speed", "slips"),
    )
    friction_coefficient: float = parameter(
        default=0.05, unit="1", doc="of constant friction", validator=non_negative
    )
    friction_speed: float = parameter(
        default=0.05,
        unit="m/s",
        doc="sliding speed over which constant friction sets in",
        validator=positive,
        usual=(1e-5, 1),
        possible=(1e-12, 1e4),
    )
    duration: float = parameter(
        default=1.0,
        unit="s",
        doc="time to go through",
        validator=positive,
        usual=(1e-4, 1e4),
        possible=(1e-9, 1e9),
    )
    points: int = parameter(
        default=1001, doc="instants stored, evenly spread with both ends", validator=at_least(2)
    )
    cage_slip: float = parameter(
        default=0.0, unit="1", doc="slip of the cage at the start: 1 at rest, 2 backwards"
    )
    roller_slip: float = parameter(
        default=0.0, unit="1", doc="slip of the rollers at the start: 1 at rest"
    )
    integrator: Any = parameter(
        default="rodas5p",
        doc="integrator, by name or as a table with its parameters; a plan chooses where it is not given",
    )
    relative_tolerance: float = parameter(
        default=1e-5,
        unit="1",
        doc="error of a step, relative to the magnitude of an unknown",
        validator=in_range(_MIN_TOLERANCE, 0.1),
    )
    stop_at: str = parameter(
        default="end",
        doc="where the run ends: critical is where skidding begins",
        validator=choice_of("end", "critical"),
    )
    film_limit: float = parameter(
        default=0.0,
        unit="1",
        doc="film parameter whose passing is an event; 0 for none",
        validator=non_negative,
    )
    planar: PlanarSettings | None = attrs.field(
        default=None,
        metadata={"doc": "masses, damping, gravity and load of level planar", "unit": None},
    )
    history: HistorySettings | None = attrs.field(
        default=None,
        metadata={
            "doc": "speeds, load and temperature over time, in place of [operation]",
            "unit": None,
        },
    )

    def __attrs_post_init__(self) -> None:
        if self.film_limit > 0.0 and self.friction != "conventional":
            raise FieldError(
                "film_limit", f"only known to friction = 'conventional', not to {self.friction!r}"
            )

    def at(self, resolution: Resolution) -> "Dynamics":
        """Return the settings with what a resolution says of friction, level, integrator and its tolerance."""
        said: dict[str, Any] = {
            "friction": resolution.friction,
            "level": resolution.level,
            "integrator": resolution.integrator,
            "relative_tolerance": resolution.integrator_tolerance,
        }
        return attrs.evolve(
            self, **{name: value for name, value in said.items() if value is not None}
        )

    def numerical_settings(self, assembly: Assembly) -> Mapping[str, Any]:
        """Return friction, level, integrator and its tolerance, as they are."""
        return {
            "friction": self.friction,
            "level": self.level,
            "integrator": self.method(assembly).name,
            "integrator_tolerance": self.relative_tolerance,
        }

    @property
    def with_weight(self) -> bool:
        """Whether it is at level planar, which has a key of its own for it."""
        return self.level == "planar"

    def curve_study(self, assembly: Assembly) -> EffectiveFriction:
        """Return how the raceways' contacts are averaged, as the scene has it."""
        found = EffectiveFriction.from_scene(assembly.scene)
        rings = assembly.rings
        return (
            attrs.evolve(found, skidding_range=0.0) if rings and rings.turning else found
        )  # where no slip is steady

    def choose_resolution(
        self, assembly: Assembly, *, cheaper_laws: bool = True
    ) -> ResolutionChoice:
        """Choose slices and instants by the effective friction, all else by trial motions; laws stay as they are."""
        averaged = self.curve_study(assembly)
        if assembly.scene.accuracy.exact:
            return self._with_choice(reference_choice(averaged, assembly), assembly)
        estimated = over_time.choose_over_history(
            averaged, assembly, self.course(assembly), _FRACTION
        )
        estimated = self._with_choice(with_table_tolerance(estimated, assembly, _TABLES), assembly)
        if "relative_tolerance" in assembly.scene.study.get(self.name, {}):
            return estimated
        return self._with_steps(estimated, assembly.at(estimated.resolution))

    def _with_choice(self, estimated: ResolutionChoice, assembly: Assembly) -> ResolutionChoice:
        """Friction, level and integrator, where the scene does not name them."""
        given = [*assembly.scene.study.get(self.name, {})]
        history = self.course(assembly)
        settings, named = over_time.fixed_settings(history, given, self.level)
        reasons = over_time.reasons_of_history(history, settings, self.level, given)
        at = assembly.at(estimated.resolution)
        if why := over_time.tabulation_problem(
            history, self.with_settings(**settings).friction, lambda: self.moving(at)
        ):
            settings["friction"] = "conventional"
            reasons["friction"] = why
        choice = choose_motion(self.with_settings(**settings), at, named)
        return attrs.evolve(
            estimated,
            resolution=attrs.evolve(estimated.resolution, **settings, **choice.settings),
            errors={**estimated.errors, **choice.errors},
            reasons={**choice.reasons, **reasons},
        )

    def _with_steps(self, estimated: ResolutionChoice, assembly: Assembly) -> ResolutionChoice:
        """Tolerance of a step, and what it leaves."""
        study = self.at(estimated.resolution)
        tolerance, left = step_tolerance(study, assembly, self._fades(study.level, assembly))
        return attrs.evolve(
            estimated,
            resolution=attrs.evolve(estimated.resolution, integrator_tolerance=tolerance),
            errors={**estimated.errors, "steps": {"cage_speed": left}},
        )

    def _fades(self, level: str, assembly: Assembly) -> bool:
        """Whether it is looked at how errors of the cage speed fade; else they add up over all of the duration."""
        return (
            not self.history
            and level != "cage-set"
            and not (assembly.rings and assembly.rings.turning)
        )

    def verification_resolution(self, scene: Scene, own: Resolution) -> tuple[Resolution, str]:
        """Return four times as fine a resolution: the finest would take days."""
        return refined(scene, own, self.relative_tolerance), "against four times as fine"

    def cost(self, assembly: Assembly) -> Mapping[str, float]:
        """Return the time [s] of tables and motion, from its beginning, and of the slip of running away."""
        at = attrs.evolve(
            assembly.resolution,
            n_positions=assembly.resolution.n_positions or over_time.N_POSITIONS,
        )
        told = attrs.evolve(self.curve_study(assembly), map_points=0).cost(assembly.at(at))
        away = sum(told.values())
        history = self.course(assembly)
        along_it = over_time.history_cost(
            history, lambda: self.moving(assembly), self.curve_study(assembly)
        )
        motion = costs_of(self, assembly)
        return {
            "skidding": away,
            **along_it,
            **motion,
            **heating.heating_cost(self, assembly, motion["motion"]),
        }

    def extra_parts(
        self, assembly: Assembly, estimated: ResolutionChoice, costs: dict[str, float]
    ) -> list[Part]:
        """Return steps, friction, level and integrator."""
        errors = estimated.errors
        fades = self._fades(self.level, assembly)
        offer = find("integrator", self.method(assembly).name)

        def why(setting: str) -> str:
            named = setting in assembly.scene.study.get(self.name, {})
            return estimated.reasons.get(
                setting, f"study.{self.name} names it" if named else "default"
            )

        steps = Part(
            part="steps in time",
            choice=f"relative tolerance {assembly.resolution.integrator_tolerance or 0.0:.1e}",
            resolution="every step",
            reason="two short motions of other tolerances tell what it leaves of the cage speed, "
            + ("two cages that begin apart how long that lasts" if fades else "which adds up")
            + (
                ""
                if self.level == "cage-set"
                else ", and finer ones how far motions come apart in an orbit"
            ),
            errors=errors.get("steps", {}),
            seconds=costs.pop("motion", None) if "steps" in errors else None,
        )
        return [
            *([steps] if "steps" in errors else []),
            *over_time.plan_parts(
                self.course(assembly), lambda: self.moving(assembly), self.name, costs
            ),
            *heating.plan_parts(self, assembly, costs),
            *parts(assembly.scene),
            Part(
                part="friction of the raceways",
                choice=self.friction,
                resolution=self.moving(assembly).evaluation_method,
                reason=why("friction"),
                errors=errors.get("friction", {}),
            ),
            Part(
                part="motion",
                choice=f"level {self.level}: {LEVELS[self.level]}",
                resolution=f"{self.degrees_of_freedom(assembly)} unknowns for {self.duration:g} s",
                reason=why("level"),
                errors=errors.get("level", {}),
            ),
            Part(
                part="integrator",
                choice=f"{offer.name} ({offer.package} {offer.version})",
                resolution=f"relative tolerance {self.relative_tolerance:g}",
                reason=why("integrator"),
            ),
        ]

    def numbers(self, assembly: Assembly) -> Mapping[str, float]:
        """Return how many numbers the stored instants hold at least."""
        return {"points": 4.0 * self.points}

    def evaluations(self, assembly: Assembly) -> int:
        """Return about how many slices it will evaluate in time, from steps such as bearings of this size took."""
        if self.friction != "conventional":
            return 0
        loads = assembly.load_distribution(1)
        loaded = np.count_nonzero(loads.inner_load) + np.count_nonzero(loads.outer_load)
        if not self.moving(assembly).friction.uses_slices:  # but for what is stored
            return int(loaded) * self.points
        step, evaluations = _STEPS[self.level]
        steps = self.duration / step * (1e-5 / self.relative_tolerance) ** 0.2
        return int(loaded) * int(evaluations * steps + self.points)

    def models(self, assembly: Assembly) -> tuple[tuple[str, Any], ...]:
        """Return the drags, the integrator, what temperatures follow from, and what measures damage.

        Raises
        ------
        SceneError, PluginError
            If the cage is wrong, or they are not there.
        """
        drags = (("drag", model) for model in assembly.cage.drags)
        heat = heating.model_of(assembly)
        measures = damage_of(assembly)
        more = [
            *([] if heat is None else [("thermal", heat)]),
            *(("damage", model) for model in measures),
        ]
        return *drags, ("integrator", self.method(assembly)), *more

    @property
    def validity_state(self) -> str:
        """What state `validity_slices` are at."""
        return "at the end of the motion"

    def validity_slices(self, assembly: Assembly, dataset: "xr.Dataset") -> list[LoadedSlices]:
        """Return the slices of the rollers at the last stored instant."""
        then = over_time.final_bearing(assembly, dataset)
        return [] if then is None else last_slices(then, dataset)

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "xr.Dataset":
        """Return the motion, going on from what is kept, and keeping what is computed.

        Returns
        -------
        xarray.Dataset
            Dimensions (time,): cage_speed, cage_slip, energy, energy_residual, angular_momentum, momentum_residual;
            (time, roller): roller_speed, roller_slip, orbit_angle; (ring, time, roller): normal_force, traction_force,
            sliding_speed, film_parameter, NaN without load; (work, time): work_done; (event,): event_time, event_what,
            event_rising; with effective friction its curves (inner_node,): inner_sliding, inner_friction, and so outer,
            and how right they are, attribute effective_tables (`EffectiveTable.record` by ring, JSON), with those of
            conventional friction and of forces at level planar in friction_tables and force_tables; processor time of
            the integration alone [s], attribute integration_seconds;
            at levels pocket and planar (time, roller): pocket_force, pocket_displacement; at level planar (direction,
            time): ring_displacement, cage_displacement, and (time,): land_eccentricity.

        Raises
        ------
        SceneError
            If the cage is wrong, or level planar lacks its settings.
        DomainError, ConvergenceError
            If loads or friction cannot be tabulated.
        """
        dataset = over_time.with_single_values(
            self.at(assembly.resolution)._run(assembly, context or RunContext())
        )
        damage, measures = over_motion(
            assembly, dataset, partial(over_time.bearing_at, assembly, dataset)
        )
        return dataset.assign_coords(measures).assign(self.variables(**damage))

    def _run(self, assembly: Assembly, kept: RunContext) -> "xr.Dataset":
        integrator = self.method(assembly)
        if self.level == "planar":
            self._of_planar(assembly)
        heat = heating.solve_temperatures(self, assembly, kept.progress)
        assembly, history = (
            (assembly, self.course(assembly)) if heat is None else (heat.assembly, heat.history)
        )
        settings = self.curve_study(assembly)
        store = None if kept.store is None else Checkpoints(*attrs.astuple(kept.store))
        raceways = settings.loaded(
            assembly, assembly.resolution.n_positions or over_time.N_POSITIONS
        )
        critical = over_time.critical_of(settings, raceways)
        away = over_time.onset_of(settings, raceways)
        limit = over_time.watched_slip(settings, assembly, history)
        moving = self.moving_along(history, assembly, critical_slip=away.slip, limit=limit)
        times = np.linspace(0.0, self.duration, self.points)
        watch = moving.system.watch
        before = None if store is None else store.load(times, moving.system.n)
        done, parts = (
            (0, 0) if before is None or store is None else (before.t.size, len(store.parts()))
        )

        def keep(number: int, trajectory: Trajectory) -> None:
            if store is not None:
                store.write(parts + number, trajectory)
            if kept.progress is not None:
                t = trajectory.last_t
                kept.progress(
                    f"{t:.4g} of {self.duration:.4g} s",
                    heating.run_fraction(heat, t / self.duration),
                )

        found = integrate(
            self._ivp(
                moving,
                self.relative_tolerance,
                before,
                watch=watch if moving.system.watched else None,
            ),
            integrator,
            times[done:],
            rtol=self.relative_tolerance,
            stop=frozenset(
                {0}
                if self.stop_at == "critical" and not (math.isnan(away.slip) and limit is None)
                else ()
            ),
            first_step=0.0 if before is None else before.last_step,
            state=None if before is None else before.last_state,
            keep=keep,
        )
        found = with_cause(found, moving)
        found = found if before is None else before.then(found)
        # by now models may fail as in the run, or anew
        outputs, found = outputs_of(moving, found)
        slip = (
            1.0
            - (moving.split(found.y)["cage_speed"] / moving.epicyclic_speeds(found.t)[0])[[0, -1]]
        )
        regimes, found = regimes_of(
            raceways, np.clip(np.nan_to_num(slip), 0.0, settings.max_cage_slip), found
        )
        warmed, warmth = heating.temperature_variables(heat, found.t)
        nodes = (
            {}
            if heat is None
            else {"node": ("node", [*heat.model.nodes], about("1", "part of the bearing"))}
        )
        return (
            self._dataset(assembly, moving, found, outputs, integrator)
            .assign(regimes)
            .assign(self.variables(**warmed))
            .assign_coords(nodes)
            .assign_attrs(warmth)
            .assign_attrs(
                {
                    "skidding_slip": away.slip,
                    "limit_drag": away.drag,
                    "skidding_status": away.status,
                    "critical_cage_slip": critical.slip,
                    "critical_status": critical.status,
                    "first_maximum_slip": critical.first_slip,
                    "curves_with": CLOSURES[settings.closure],
                }
            )
        )

    def trial_motion(
        self,
        moving: MovingBearing,
        times: Array,
        tolerance: float,
        before: Trajectory | None = None,
    ) -> Trajectory:
        """Return the motion from its start or from before, at some times [s], nothing watched or kept."""
        found = integrate(
            self._ivp(moving, tolerance, before),
            self.method(moving.assembly),
            times,
            rtol=tolerance,
            first_step=0.0 if before is None else before.last_step,
            state=None if before is None else before.last_state,
        )
        if (
            found.outcome == "interrupted"
        ):  # else what is chosen by trials would take it for a fault of one
            raise KeyboardInterrupt
        return found

    def _ivp(
        self, moving: MovingBearing, error: float, before: Trajectory | None, **own: Any
    ) -> InitialValueProblem:
        absolute, relative = moving.tolerances
        return InitialValueProblem(
            rates=moving.system,
            y=moving.initial(self.cage_slip, self.roller_slip) if before is None else before.last_y,
            t=0.0 if before is None else before.last_t,
            atol=error * absolute,
            relative=relative,
            jacobian=moving.system.jacobian,
            breaks=moving.breaks,
            at_rest=moving.at_rest,
            **own,
        )

    def digest(self, assembly: Assembly) -> str:
        """Return the digest of the file of a history."""
        return "" if (history := self.course(assembly)) is None else history.sha256

    def course(self, assembly: Assembly) -> History | None:
        """Return how the operation goes over time; None where it does not change."""
        return over_time.history_of(self.history, assembly, self.duration, self.table)

    def moving(self, assembly: Assembly) -> MovingBearing:
        """Return the bearing in motion at the temperatures of its scene."""
        return self.moving_along(self.course(assembly), assembly)

    def moving_along(
        self,
        history: History | None,
        assembly: Assembly,
        *,
        critical_slip: float = math.nan,
        limit: Course | None = None,
    ) -> MovingBearing:
        """Return the bearing in motion along a history, in which ``limit`` is the slip that is watched."""
        check_moves(assembly, self.level)
        friction = FrictionSettings(
            name=self.friction,
            effective_over=self.effective_over,
            coefficient=self.friction_coefficient,
            transition=self.friction_speed,
            critical_slip=critical_slip,
            film_limit=self.film_limit or math.nan,
        )
        if history is not None:
            planar = self._of_planar(assembly) if self.level == "planar" else None
            return varying_motion(
                assembly, friction, history, level=self.level, planar=planar, limit=limit
            )
        if self.level == "planar":
            return planar_motion(assembly, self._of_planar(assembly), friction)
        return carried_motion(assembly, friction, level=self.level)

    def _of_planar(self, assembly: Assembly) -> PlanarSettings:
        """Settings of level planar, which a scene that names it must give."""
        if self.planar is None:
            where = Location(assembly.scene.origins, ("study", self.name))
            raise SceneError(
                [
                    where.at("planar").message(
                        "missing, but required for level = 'planar'; give [study.dynamics.planar] with the mass that "
                        "moves with the inner ring, such as inner_ring_mass = '5 kg'"
                    )
                ]
            )
        return self.planar

    def method(self, assembly: Assembly) -> IntegratorModel:
        """Return the integrator.

        Raises
        ------
        SceneError, PluginError
            If its parameters are wrong, or it is not there.
        """
        problems = list[str]()
        where = Location(assembly.scene.origins, ("study", self.name, "integrator"))
        made = structure_model("integrator", self.integrator, where, problems)
        if problems or not isinstance(made, IntegratorModel):
            raise SceneError(problems)
        return made

    def degrees_of_freedom(self, assembly: Assembly) -> int:
        """Number of unknowns, without those of the ledger."""
        return unknowns(self.level, assembly)

    def _dataset(
        self,
        assembly: Assembly,
        moving: MovingBearing,
        found: Trajectory,
        outputs: dict[str, Array],
        integrator: IntegratorModel,
    ) -> "xr.Dataset":
        import xarray as xr

        t = found.t
        cage = moving.split(found.y)["cage_speed"]
        shapes = ring_shapes(moving)
        variables = self.variables(**stored_variables(moving, found, outputs))
        variables["film_parameter"][2]["film_status"] = self._film_status()
        cage_slip = variables["cage_slip"][1]
        works = moving.works(found.y)
        at_positions, of_history = over_time.history_variables(
            self.curve_study(assembly), moving, t, found.y
        )
        variables |= self.variables(**at_positions)
        ended = found.outcome == "finished"  # else a longer run would end there too
        steady, steady_status = steady_slip_of(
            t,
            cage_slip,
            cage,
            assembly.scene.accuracy.tolerance,
            lambda seconds: (
                f"; run longer with --set {self.table}.duration={seconds:.2g}s" if ended else ""
            ),
            f"; store more with --set {self.table}.points={4 * self.points}",
        )
        steady, steady_status = over_time.steady_slip_along(moving, t, (steady, steady_status))
        return xr.Dataset(
            variables,
            {
                "time": ("time", t, about("s", "time")),
                "roller": (
                    "roller",
                    np.arange(assembly.scene.bearing.rollers),
                    about("1", "roller"),
                ),
                "ring": ("ring", np.array(RINGS), about("1", "ring")),
                "work": ("work", np.array(list(works)), about("1", "what the work was done by")),
                "direction": (
                    "direction",
                    np.array(["along", "across"]),
                    about("1", "direction to the line of load"),
                ),
                **(
                    {"shape": ("shape", np.array(shapes), about("1", "shape of a ring"))}
                    if shapes
                    else {}
                ),
            },
            attrs=self.attributes
            | of_history
            | {
                "level": self.level,
                "friction": self.friction,
                "integrator": integrator.name,
                "relative_tolerance": self.relative_tolerance,
                "outcome": found.outcome,
                "outcome_message": found.message,
                "failed_by": failure_source(found),
                "steps": found.steps,
                "rejected": found.rejected,
                "rate_evaluations": found.evaluations,
                "jacobians": found.jacobians,
                "contacts_evaluated": int(moving.system.owner.contacts_evaluated),
                "integration_time": found.wall_time,
                "integration_seconds": found.processor_time,
                "real_time_factor": float(t[-1] - t[0]) / found.wall_time
                if found.wall_time > 0.0
                else math.inf,
                "steady_cage_slip": steady,
                "steady_status": steady_status,
                "drag": json.dumps(
                    [{"name": drag.name, "equation": drag.equation} for drag in assembly.cage.drags]
                ),
                "cage": json.dumps(resolved(assembly.cage), default=str),
                **moving.tables,
                **found.told,
            },
        )

    def _film_status(self) -> str:
        if self.friction == "conventional":
            return "of the loaded slices"
        return f"friction is {self.friction}, which knows no film; --set {self.table}.friction=conventional does"
